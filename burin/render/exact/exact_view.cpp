#include "burin/render/exact/exact_view.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string>

#include "burin/render/brdf.h"
#include "burin/render/error.h"
#include "burin/render/exact/scratch_pair.h"

namespace burin {
std::array<double, 3> channel_factors(const ViewScene& scene, double cos_ho, int channels) {
  std::array<double, 3> f{};
  for (int c = 0; c < 3; ++c) f[c] = schlick_F(cos_ho, scene.material.f0[c]) * scene.light.intensity[c];
  if (channels == 1) f[0] = (f[0] + f[1] + f[2]) / 3;
  return f;
}

std::array<double, 3> channel_factor_slopes(const ViewScene& scene, double cos_ho, int channels) {
  std::array<double, 3> f{};
  const double m = 1 - cos_ho, m4 = m * m * m * m;
  for (int c = 0; c < 3; ++c) f[c] = -5 * m4 * (1 - scene.material.f0[c]) * scene.light.intensity[c];
  if (channels == 1) f[0] = (f[0] + f[1] + f[2]) / 3;
  return f;
}

std::array<double, 3> ambient_radiance(const ViewScene& scene, int channels) {
  std::array<double, 3> a{};
  for (int c = 0; c < 3; ++c) a[c] = scene.ambient[c] * scene.material.f0[c];
  if (channels == 1) a[0] = (a[0] + a[1] + a[2]) / 3;
  return a;
}

void check_view(const ViewScene& scene, int channels) {
  check_scene_values(scene.camera_center_mm, scene.light, scene.material, scene.tool_width_um, scene.ambient);
  if (channels != 1 && channels != 3)
    fail("RenderOptions", "channels is " + std::to_string(channels), "it must be 1 or 3");
  if (scene.grid == nullptr) fail("scene.grid", "there is none", "make it with camera_grid or board_grid");
  const FootprintGrid& grid = *scene.grid;
  const auto n = static_cast<std::size_t>(std::max(grid.width(), 0)) * std::max(grid.height(), 0);
  const std::size_t corners = static_cast<std::size_t>(grid.width() + 1) * (grid.height() + 1);
  if (n == 0 || grid.corner_x_mm.size() != corners || grid.corner_y_mm.size() != corners ||
      grid.center_mm.size() != n || grid.normal.size() != n || (!grid.x_axis.empty() && grid.x_axis.size() != n))
    fail("scene.grid", "it is empty, or its arrays do not fit its window", "make it with camera_grid or board_grid");
  const std::size_t hidden = scene.hidden_from_light.size();
  if (hidden != 0 && hidden != n && hidden != n * (1 + scene.light.also.size()))
    fail("scene.hidden_from_light", "it does not fit the grid's pixels",
         "make it with hidden_pixels, or leave it empty");
}

PixelShading shade_pixel(const ViewScene& scene, std::size_t pixel) {
  PixelShading p = shade_pixel(scene.grid->center_mm[pixel], scene.grid->normal[pixel], scene.camera_center_mm,
                               scene.light, scene.material.base_alpha, scene.material.grain,
                               scene.grid->x_axis.empty() ? nullptr : &scene.grid->x_axis[pixel]);
  if (!scene.hidden_from_light.empty() && scene.hidden_from_light[pixel]) {
    p.lit = false;
    p.direct = p.base = 0;
  }
  return p;
}

ViewPixels view_pixels(const ViewScene& scene, int channels) {
  check_view(scene, channels);
  const FootprintGrid& grid = *scene.grid;
  const auto n = static_cast<std::size_t>(grid.width()) * grid.height();
  ViewPixels pixels;
  pixels.channels = channels;
  pixels.shading.resize(n);
  pixels.area_mm2.assign(n, 0);
  tbb::parallel_for(tbb::blocked_range<int>(0, grid.height()), [&](const tbb::blocked_range<int>& rows) {
    for (int r = rows.begin(); r < rows.end(); ++r) {
      for (int c = 0; c < grid.width(); ++c) {
        const std::size_t i = static_cast<std::size_t>(r) * grid.width() + c;
        const double area = std::abs(signed_area_mm2(footprint_corners_mm(grid, c, r)));
        if (!(std::isfinite(area) && area > 0 && grid.center_mm[i].allFinite() && grid.normal[i].allFinite())) continue;
        pixels.area_mm2[i] = area;
        pixels.shading[i] = shade_pixel(scene, i);
      }
    }
  });
  return pixels;
}

ExactView::ExactView(const ViewScene& scene, const ViewPixels& pixels, BandLightBy band_light)
    : scene_(scene), pixels_(pixels), band_light_(band_light) {
  if (band_light_ == BandLightBy::pixel) return;
  // By pixels' own size: where one ends within a band, the band's light is shared out evenly.
  constexpr double kOfPixel = 1.0 / 16, kMost = 10;
  double least = 1e300;
  for (const double area : pixels_.area_mm2)
    if (area > 0) least = std::min(least, area);
  widest_band_um_ = std::clamp(1000 * kOfPixel * std::sqrt(least), widest_band_um_, kMost * widest_band_um_);
}

ExactView::SeenPixel ExactView::seen_pixel(std::size_t pixel) const {
  const FootprintGrid& grid = *scene_.grid;
  const PixelShading& p = pixels_.shading[pixel];
  SeenPixel out;
  out.is_lit = pixels_.area_mm2[pixel] > 0 && p.visible && p.lit;
  if (!out.is_lit) return out;
  out.corners_mm =
      footprint_corners_mm(grid, static_cast<int>(pixel % grid.width()), static_cast<int>(pixel / grid.width()));
  out.h_face = p.h_face;
  out.cos_i = p.cos_i;
  out.cos_o = p.cos_o;
  return out;
}

// One pair's light, area and derivatives: of a pixel that is lit.
void ExactView::set_pair(std::size_t pair, const SeenPixel& p, const ScratchFrame& f, const LightsAlong* along,
                         BandLights& lights) {
  const Quad q = in_scratch(f, p.corners_mm);
  const Eigen::Vector3d h = in_scratch(f, p.h_face);
  const Shadowing g = shadowing(p.cos_i, p.cos_o, f.groove.alpha);
  const bool with_jacobian = !jacobian_.empty(), known = along != nullptr && along->at(h, with_jacobian, lights);
  FootprintValue value;
  if (with_jacobian) {
    const FootprintGradient d =
        known ? profile_integral_gradient(f.groove, *f.bands, lights, q) : pair_integral_gradient(f, q, h);
    value = d.value;
    const PairGradient light_by = to_board(f, q, h, d.dDhat_dcorner, d.dDhat_dhalf, d.dDhat_dlength_mm);
    const PairGradient area_by = to_board(f, q, h, d.darea_dcorner, Eigen::Vector3d::Zero(), d.darea_dlength_mm);
    jacobian_[pair].light = {g.G * light_by.p0.x(),
                             g.G * light_by.p0.y(),
                             g.G * light_by.p1.x(),
                             g.G * light_by.p1.y(),
                             g.G * d.dDhat_dwidth_um,
                             g.G * d.dDhat_ddepth_um,
                             g.G * d.dDhat_dalpha + g.dG_dalpha * value.Dhat_mm2};
    jacobian_[pair].area = {area_by.p0.x(), area_by.p0.y(),    area_by.p1.x(),
                            area_by.p1.y(), d.darea_dwidth_um, d.darea_ddepth_um};
  } else {
    value = known ? profile_integral(f.groove, *f.bands, lights, q) : pair_integral(f, q, h);
  }
  pair_light_mm2_[pair] = g.G * value.Dhat_mm2;
  pair_area_mm2_[pair] = value.area_mm2;
}

void ExactView::set_pairs_by_pixel(const std::vector<ScratchFrame>& frames) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels_.size(), 256), [&](const auto& range) {
    BandLights lights;
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      if (const SeenPixel p = seen_pixel(i); p.is_lit)
        for (std::size_t k = pairs_.begin[i]; k < pairs_.begin[i + 1]; ++k)
          set_pair(k, p, frames[pairs_.scratch[k]], nullptr, lights);
  });
}

// Pieces of one cut groove follow one another, and lie on one line: what is known of a section's light along that line
// serves all pieces that have it.
void ExactView::set_pairs_by_line(const std::vector<ScratchFrame>& frames) {
  if (seen_.empty()) {
    seen_.resize(pixels_.size());
    tbb::parallel_for(std::size_t{0}, seen_.size(), [&](std::size_t i) { seen_[i] = seen_pixel(i); });
  }
  const GrooveEntries by_groove = entries_by_groove();
  const auto on_one_line = [](const ScratchFrame& a, const ScratchFrame& b) {
    constexpr double kSame = 1e-7;
    return a.groove.alpha == b.groove.alpha && (a.y - b.y).squaredNorm() < kSame * kSame &&
           std::abs(a.x.dot(b.p0 - a.p0)) < kSame;
  };
  std::vector<std::size_t> line_begin;
  for (std::size_t s = 0; s < frames.size(); ++s)
    if (s == 0 || !on_one_line(frames[line_begin.back()], frames[s])) line_begin.push_back(s);
  line_begin.push_back(frames.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, line_begin.size() - 1, 16), [&](const auto& range) {
    std::map<const std::vector<ProfileBand>*, std::pair<LightsAlong, std::vector<Eigen::Vector3d>>> sections;
    BandLights lights;
    for (std::size_t line = range.begin(); line < range.end(); ++line) {
      sections.clear();
      for (std::size_t s = line_begin[line]; s < line_begin[line + 1]; ++s) {
        std::vector<Eigen::Vector3d>& half = sections[frames[s].bands.get()].second;
        for (const Entry& e : by_groove.of(s))
          if (seen_[e.pixel].is_lit) half.push_back(in_scratch(frames[s], seen_[e.pixel].h_face));
      }
      const ScratchFrame& first = frames[line_begin[line]];
      for (auto& [bands, known] : sections)
        known.first.set(first.groove, *bands, first.across, known.second, !jacobian_.empty());
      for (std::size_t s = line_begin[line]; s < line_begin[line + 1]; ++s)
        for (const Entry& e : by_groove.of(s))
          if (seen_[e.pixel].is_lit)
            set_pair(e.pair, seen_[e.pixel], frames[s], &sections[frames[s].bands.get()].first, lights);
    }
  });
}

void ExactView::forward(const Scratches& scratches, PixelPairs pairs, bool keep_jacobian, Image& radiance) {
  const FootprintGrid& grid = *scene_.grid;
  const int channels = pixels_.channels;
  pairs_ = std::move(pairs);
  scratch_count_ = scratches.size();
  const std::vector<ScratchFrame> frames =
      scratch_frames(scratches, scene_.tool_width_um, scene_.material, widest_band_um_);
  pair_light_mm2_.assign(pairs_.scratch.size(), 0);
  pair_area_mm2_.assign(pairs_.scratch.size(), 0);
  jacobian_.assign(keep_jacobian ? pairs_.scratch.size() : 0, {});
  if (band_light_ == BandLightBy::knots && !frames.empty() && frames.front().bands != nullptr)
    set_pairs_by_line(frames);
  else
    set_pairs_by_pixel(frames);
  covered_.assign(pixels_.size(), 0);
  radiance = Image(grid.width(), grid.height(), channels);
  radiance_.assign(radiance.data.size(), 0);
  const std::array<double, 3> ambient = ambient_radiance(scene_, channels);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels_.size(), 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const PixelShading& p = pixels_.shading[i];
      const double area = pixels_.area_mm2[i];
      if (!(area > 0) || !p.visible) continue;
      double light = 0, groove_area = 0;
      if (p.lit)
        for (std::size_t k = pairs_.begin[i]; k < pairs_.begin[i + 1]; ++k) {
          light += pair_light_mm2_[k];
          groove_area += pair_area_mm2_[k];
        }
      covered_[i] = groove_area / area;
      const double lobes = light / area + (1 - std::min(1.0, covered_[i])) * p.base;
      const std::array<double, 3> factor = channel_factors(scene_, p.cos_ho, channels);
      for (int c = 0; c < channels; ++c) radiance_[i * channels + c] = factor[c] * p.direct * lobes + ambient[c];
    }
  });
  std::copy(radiance_.begin(), radiance_.end(), radiance.data.begin());
}

ExactView::GrooveEntries ExactView::entries_by_groove() const {
  GrooveEntries out;
  out.begin.assign(scratch_count_ + 1, 0);
  for (const std::uint32_t s : pairs_.scratch) ++out.begin[s + 1];
  for (std::size_t s = 0; s < scratch_count_; ++s) out.begin[s + 1] += out.begin[s];
  out.entries.resize(pairs_.scratch.size());
  std::vector<std::size_t> next(out.begin.begin(), out.begin.end() - 1);
  for (std::size_t i = 0; i + 1 < pairs_.begin.size(); ++i)
    for (std::size_t k = pairs_.begin[i]; k < pairs_.begin[i + 1]; ++k)
      out.entries[next[pairs_.scratch[k]]++] = {static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(i)};
  return out;
}

template <typename Visit>
void ExactView::gather(const Visit& visit) const {
  const GrooveEntries by_groove = entries_by_groove();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scratch_count_, 64), [&](const auto& range) {
    for (std::size_t s = range.begin(); s < range.end(); ++s)
      for (const Entry& e : by_groove.of(s)) visit(s, e.pair, e.pixel);
  });
}

void ExactView::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  if (jacobian_.size() != pairs_.scratch.size())
    fail("ViewRenderer::backward", "there is no Jacobian", "call forward_with_jacobian() first");
  const int channels = pixels_.channels;
  std::vector<double> by_light(pixels_.size(), 0), by_area(pixels_.size(), 0);
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const PixelShading& p = pixels_.shading[i];
    if (!(pixels_.area_mm2[i] > 0) || !p.lit) continue;
    const std::array<double, 3> factor = channel_factors(scene_, p.cos_ho, channels);
    double by_lobes = 0;
    for (int c = 0; c < channels; ++c) by_lobes += dE_dradiance.data[i * channels + c] * factor[c] * p.direct;
    by_light[i] = by_lobes / pixels_.area_mm2[i];
    if (covered_[i] < 1) by_area[i] = -by_lobes * p.base / pixels_.area_mm2[i];
    gradients.shared_base_alpha +=
        by_lobes * (1 - std::min(1.0, covered_[i])) * base_slope(p, scene_.material.base_alpha, scene_.material.grain);
  }
  std::vector<std::array<double, 7>> sums(scratch_count_, std::array<double, 7>{});
  gather([&](std::size_t s, std::size_t pair, std::size_t pixel) {
    const PairJacobian& j = jacobian_[pair];
    for (int k = 0; k < 6; ++k) sums[s][k] += by_light[pixel] * j.light[k] + by_area[pixel] * j.area[k];
    sums[s][6] += by_light[pixel] * j.light[6];
  });
  for (std::size_t s = 0; s < scratch_count_; ++s) {
    gradients.x0_mm[s] += sums[s][0];
    gradients.y0_mm[s] += sums[s][1];
    gradients.x1_mm[s] += sums[s][2];
    gradients.y1_mm[s] += sums[s][3];
    gradients.width_um[s] += sums[s][4];
    gradients.depth_um[s] += sums[s][5];
    gradients.alpha[s] += sums[s][6];
    gradients.shared_width_um += sums[s][4];
    gradients.shared_depth_um += sums[s][5];
    gradients.shared_alpha += sums[s][6];
  }
}

void ExactView::add_contributions(std::vector<double>& contribution) const {
  const int channels = pixels_.channels;
  std::vector<double> weight(pixels_.size(), 0);
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const PixelShading& p = pixels_.shading[i];
    if (!(pixels_.area_mm2[i] > 0) || !p.lit) continue;
    const std::array<double, 3> factor = channel_factors(scene_, p.cos_ho, channels);
    for (int c = 0; c < channels; ++c) weight[i] += factor[c] * p.direct / pixels_.area_mm2[i] / channels;
  }
  gather([&](std::size_t s, std::size_t pair, std::size_t pixel) {
    contribution[s] += weight[pixel] * pair_light_mm2_[pair];
  });
}

}  // namespace burin
