#include "burin/render/exact/exact_view.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "burin/base/error.h"
#include "burin/render/brdf.h"
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

double footprint_area_mm2(const FootprintGrid& grid, std::size_t pixel,
                          const std::array<Eigen::Vector2d, 4>& corners_mm) {
  const double area = std::abs(signed_area_mm2(corners_mm));
  const bool is_good =
      std::isfinite(area) && area > 0 && grid.center_mm[pixel].allFinite() && grid.normal[pixel].allFinite();
  return is_good ? area : 0;
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
        pixels.area_mm2[i] = footprint_area_mm2(grid, i, footprint_corners_mm(grid, c, r));
        if (pixels.area_mm2[i] > 0) pixels.shading[i] = shade_pixel(scene, i);
      }
    }
  });
  return pixels;
}

void ExactView::forward(const Scratches& scratches, PixelPairs pairs, bool keep_jacobian, Image& radiance) {
  const FootprintGrid& grid = *scene_.grid;
  const int channels = pixels_.channels;
  pairs_ = std::move(pairs);
  scratch_count_ = scratches.size();
  const std::vector<ScratchFrame> frames =
      scratch_frames(scratches, scene_.tool_width_um, scene_.material, widest_band_um_);
  pair_light_mm2_.assign(pairs_.scratch.size(), 0);
  jacobian_.assign(keep_jacobian ? pairs_.scratch.size() : 0, {});
  covered_.assign(pixels_.size(), 0);
  radiance = Image(grid.width(), grid.height(), channels);
  radiance_.assign(radiance.data.size(), 0);
  const std::array<double, 3> ambient = ambient_radiance(scene_, channels);

  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, pixels_.size(), 256), [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const PixelShading& p = pixels_.shading[i];
          const double area = pixels_.area_mm2[i];
          if (!(area > 0) || !p.visible) continue;
          double light = 0, groove_area = 0;
          if (p.lit) {
            const auto corners =
                footprint_corners_mm(grid, static_cast<int>(i % grid.width()), static_cast<int>(i / grid.width()));
            for (std::size_t k = pairs_.begin[i]; k < pairs_.begin[i + 1]; ++k) {
              const ScratchFrame& f = frames[pairs_.scratch[k]];
              const Quad q = in_scratch(f, corners);
              const Eigen::Vector3d h = in_scratch(f, p.h_face);
              const Shadowing g = shadowing(p.cos_i, p.cos_o, f.groove.alpha);
              FootprintValue value;
              if (keep_jacobian) {
                const FootprintGradient d = pair_integral_gradient(f, q, h);
                value = d.value;
                const PairGradient light_by = to_board(f, q, h, d.dDhat_dcorner, d.dDhat_dhalf, d.dDhat_dlength_mm);
                const PairGradient area_by =
                    to_board(f, q, h, d.darea_dcorner, Eigen::Vector3d::Zero(), d.darea_dlength_mm);
                jacobian_[k].light = {g.G * light_by.p0.x(),
                                      g.G * light_by.p0.y(),
                                      g.G * light_by.p1.x(),
                                      g.G * light_by.p1.y(),
                                      g.G * d.dDhat_dwidth_um,
                                      g.G * d.dDhat_ddepth_um,
                                      g.G * d.dDhat_dalpha + g.dG_dalpha * value.Dhat_mm2};
                jacobian_[k].area = {area_by.p0.x(), area_by.p0.y(),    area_by.p1.x(),
                                     area_by.p1.y(), d.darea_dwidth_um, d.darea_ddepth_um};
              } else {
                value = pair_integral(f, q, h);
              }
              pair_light_mm2_[k] = g.G * value.Dhat_mm2;
              light += pair_light_mm2_[k];
              groove_area += value.area_mm2;
            }
          }
          covered_[i] = groove_area / area;
          const double lobes = light / area + (1 - std::min(1.0, covered_[i])) * p.base;
          const std::array<double, 3> factor = channel_factors(scene_, p.cos_ho, channels);
          for (int c = 0; c < channels; ++c) radiance_[i * channels + c] = factor[c] * p.direct * lobes + ambient[c];
        }
      });
  std::copy(radiance_.begin(), radiance_.end(), radiance.data.begin());
}

template <typename Visit>
void ExactView::gather(const Visit& visit) const {
  std::vector<std::size_t> begin(scratch_count_ + 1, 0);
  for (const std::uint32_t s : pairs_.scratch) ++begin[s + 1];
  for (std::size_t s = 0; s < scratch_count_; ++s) begin[s + 1] += begin[s];
  struct Entry {
    std::size_t pair, pixel;
  };
  std::vector<Entry> entries(pairs_.scratch.size());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i + 1 < pairs_.begin.size(); ++i)
    for (std::size_t k = pairs_.begin[i]; k < pairs_.begin[i + 1]; ++k) entries[next[pairs_.scratch[k]]++] = {k, i};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scratch_count_, 64),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t s = range.begin(); s < range.end(); ++s)
                        for (std::size_t e = begin[s]; e < begin[s + 1]; ++e)
                          visit(s, entries[e].pair, entries[e].pixel);
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
