#include "burin/render/surroundings/table_range.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "burin/render/fast/groove_strips.h"
#include "burin/scene/groove.h"
#include "burin/scene/groove_profile.h"

namespace burin {
namespace {

constexpr double kAlphaRatio = 1.05;  // ratio of the roughnesses of neighboring tables

struct Wanted {
  double least, most, rim;
};

Wanted wanted(const ViewScene& scene, const Scratches& s) {
  Wanted out{scene.material.alpha, scene.material.alpha, 0};
  if (!s.alpha.empty()) {
    const auto [low, high] = std::minmax_element(s.alpha.begin(), s.alpha.end());
    out.least = *low;
    out.most = *high;
  }
  const auto each = [](const std::vector<double>& own, const double& shared) {
    return own.empty() ? std::span(&shared, 1) : std::span<const double>(own);
  };
  const auto widths = each(s.width_um, scene.tool_width_um), depths = each(s.depth_um, scene.material.depth_um);
  if (!scene.material.profile.is_paper()) {
    out.rim = GrooveStrips().measure({&scene.material.profile, scene.tool_width_um, widths, depths, {}});
    return out;
  }
  for (std::size_t i = 0; i < std::max(widths.size(), depths.size()); ++i)
    out.rim = std::max(out.rim, groove_rim(widths[widths.size() == 1 ? 0 : i], depths[depths.size() == 1 ? 0 : i]));
  return out;
}

// Largest lean of the walls.
double steepest_wall(const ViewScene& scene, double rim) {
  const GrooveProfile& profile = scene.material.profile;
  const double highest = std::max(profile.burr_left_um, profile.burr_right_um);
  const double burr = highest > 0 ? burr_lean(highest, profile.burr_width_um, -0.5 * profile.burr_width_um) : 0;
  return std::max(burr, wall_lean(profile, scene.tool_width_um, 0.5 * rim * scene.tool_width_um));
}

}  // namespace

TableRange table_range(const ViewScene& scene, const Scratches& scratches, bool by_alpha) {
  const auto [least, most, rim] = wanted(scene, scratches);
  TableRange out;
  if (scene.material.profile.is_paper()) {
    out.steepest_t = out.rim = std::min(0.99, 1.02 * rim);
  } else {
    out.rim = 1.02 * rim;
    out.steepest_t = std::min(0.99, std::tan(0.5 * steepest_wall(scene, out.rim)));
  }
  if (!by_alpha && !(most > least * (1 + 1e-9))) {
    out.alphas = {least};
    return out;
  }
  const double spread = std::log(most / least);
  const int steps = std::max(0, static_cast<int>(std::ceil(spread / std::log(kAlphaRatio))));
  for (int k = -1; k <= steps + 1; ++k)
    out.alphas.push_back(std::min(1.0, least * std::exp(steps > 0 ? spread * k / steps : k * std::log(kAlphaRatio))));
  while (out.alphas.size() > 1 && out.alphas[out.alphas.size() - 2] >= 1) out.alphas.pop_back();
  while (out.alphas.size() < 3) out.alphas.insert(out.alphas.begin(), out.alphas.front() / kAlphaRatio);
  return out;
}

bool serves(const TableRange& range, const ViewScene& scene, const Scratches& scratches) {
  const auto [least, most, rim] = wanted(scene, scratches);
  return !range.alphas.empty() && rim <= range.rim && least >= range.alphas.front() * (1 - 1e-9) &&
         most <= range.alphas.back() * (1 + 1e-9);
}

}  // namespace burin
