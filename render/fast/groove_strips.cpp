#include "burin/render/fast/groove_strips.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace burin {
namespace {

// The number of scratch i, from one for each or one for all.
template <typename Numbers>
auto own(const Numbers& each, std::size_t i) {
  return each[each.size() == 1 ? 0 : i];
}

}  // namespace

ScratchLines lines_of(const Scratches& s, std::span<const float> per_mm, std::span<const float> rim,
                      std::span<const float> alpha) {
  const auto each = [](std::span<const float> of) { return Each<float>{of.data(), of.size() == 1}; };
  return {s.size(),       s.x0_mm.data(), s.y0_mm.data(), s.x1_mm.data(),
          s.y1_mm.data(), each(per_mm),   each(rim),      each(alpha)};
}

double GrooveStrips::measure(const Shapes& shapes) {
  const std::size_t different = std::max(shapes.width_um.size(), shapes.depth_um.size());
  half_um_.resize(different);
  struct Known {
    double width_um = 0, depth_um = 0, half_um = 0;
  };
  std::array<Known, 4> known;  // pieces of one groove are consecutive, and few of its depths differ
  std::size_t oldest = 0;
  double most = 0;
  for (std::size_t i = 0; i < different; ++i) {
    const double width = own(shapes.width_um, i), depth = own(shapes.depth_um, i);
    const Known* same = std::find_if(known.begin(), known.end(),
                                     [&](const Known& k) { return k.width_um == width && k.depth_um == depth; });
    if (same == known.end()) {
      Known& next = known[oldest++ % known.size()];
      next = {width, depth, half_width_um(*shapes.profile, width, depth)};
      most = std::max(most, 2 / unit_um(*shapes.profile, shapes.tool_width_um, width) * next.half_um);
      same = &next;
    }
    half_um_[i] = same->half_um;
  }
  return most;
}

ScratchLines GrooveStrips::make(const Scratches& s, const Shapes& shapes) {
  const GrooveProfile& profile = *shapes.profile;
  grooves = s.size();
  owner.clear();
  aside_mm.clear();
  const bool has_burrs = profile.has_burrs();
  const std::size_t sections = has_burrs ? grooves : half_um_.size();
  per_mm_.resize(sections);
  rim_.resize(sections);
  for (std::size_t i = 0; i < sections; ++i) {
    const double unit = unit_um(profile, shapes.tool_width_um, own(shapes.width_um, i));
    per_mm_[i] = static_cast<float>(2000 / unit);
    rim_[i] = static_cast<float>(2 / unit * own(half_um_, i));
  }
  if (!has_burrs) return lines_of(s, per_mm_, rim_, shapes.alpha);
  x0_ = s.x0_mm;
  y0_ = s.y0_mm;
  x1_ = s.x1_mm;
  y1_ = s.y1_mm;
  part_.assign(grooves, static_cast<std::uint8_t>(SectionPart::groove));
  if (shapes.alpha.size() == 1)
    alpha_.assign(grooves, shapes.alpha[0]);
  else
    alpha_.assign(shapes.alpha.begin(), shapes.alpha.end());
  across_.resize(grooves);
  for (std::size_t i = 0; i < grooves; ++i) {
    const double dx = s.x1_mm[i] - s.x0_mm[i], dy = s.y1_mm[i] - s.y0_mm[i], length2 = dx * dx + dy * dy;
    across_[i].setZero();
    if (!s.is_narrowed(i) && length2 > 0) across_[i] = Eigen::Vector2d(dy, -dx) / std::sqrt(length2);
  }
  for (const SectionPart part : {SectionPart::left_burr, SectionPart::right_burr}) {
    const bool left = part == SectionPart::left_burr;
    if ((left ? profile.burr_left_um : profile.burr_right_um) == 0) continue;
    for (std::size_t i = 0; i < grooves; ++i) {
      if (across_[i].isZero(0)) continue;
      const double aside = (left ? -1e-3 : 1e-3) * (own(half_um_, i) + 0.5 * profile.burr_width_um);
      const double ax = aside * across_[i].x(), ay = aside * across_[i].y();
      owner.push_back(static_cast<std::uint32_t>(i));
      aside_mm.push_back(aside);
      x0_.push_back(s.x0_mm[i] + ax);
      y0_.push_back(s.y0_mm[i] + ay);
      x1_.push_back(s.x1_mm[i] + ax);
      y1_.push_back(s.y1_mm[i] + ay);
      per_mm_.push_back(static_cast<float>(2000 / profile.burr_width_um) * shapes.burr_rim);
      rim_.push_back(shapes.burr_rim);
      alpha_.push_back(alpha_[i]);
      part_.push_back(static_cast<std::uint8_t>(part));
    }
  }
  return {x0_.size(),           x0_.data(),
          y0_.data(),           x1_.data(),
          y1_.data(),           {per_mm_.data(), false},
          {rim_.data(), false}, {alpha_.data(), false},
          part_.data()};
}

}  // namespace burin
