// render_with_derivatives(): radiance and its derivatives by all parameters of a photo. docs/model.md 5.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "burin/base/error.h"
#include "burin/render/exact/exact_sums.h"
#include "burin/render/exact/exact_view.h"
#include "burin/render/fast/fast_view.h"
#include "burin/render/fast/pixel_slopes.h"
#include "burin/render/lanes_view.h"
#include "burin/render/parts_derivatives.h"
#include "burin/render/radiance_chain.h"
#include "burin/render/view_renderer.h"

namespace burin {
namespace {

// Sums of the pixels from float SIMD vectors; empty if half vectors bend too much for them.
struct FastSums {
  std::vector<PixelSlopes> pixels;
  bool in_lamps_unit = false;  // light includes the lamp's strength

  static std::optional<FastSums> of(const ViewScene& scene, const Scratches& scratches, const RenderOptions& options,
                                    std::shared_ptr<RenderWorkspace> workspace) {
    if (options.use_double) return std::nullopt;
    FastView view(scene, 1, false, options.simd, workspace != nullptr ? std::move(workspace) : make_render_workspace());
    if (!view.is_smooth()) return std::nullopt;
    FastSums out;
    view.pixel_slopes(scratches, out.pixels);
    out.in_lamps_unit = view.has_lamp_curves();
    return out;
  }
};

}  // namespace

RadianceDerivatives render_with_derivatives(const ViewScene& scene, const CameraView& camera, const Carved& carved,
                                            std::span<const SceneParameter> parameters, const RenderOptions& options,
                                            const std::shared_ptr<RenderWorkspace>& workspace) {
  if (!scene.light.size.is_point())
    return mean_with_derivatives(scene_parts(scene), camera, carved, parameters, options, workspace);
  const Scratches& scratches = carved.scratches;
  check_scratches(scratches);
  const int channels = options.channels;
  check_view(scene, channels);
  const FootprintGrid& grid = *scene.grid;
  std::optional<LanesView> lanes;
  if (carved.lanes != nullptr) {
    if (!takes_lanes(scene) || std::ranges::find(parameters, SceneParameter::width_um) != parameters.end())
      fail("render_with_derivatives", "grooves in lanes have no derivative by width, and lie on a sheet under a lamp",
           "cut them into pieces");
    lanes.emplace(scene, 1);
    lanes->find_slopes({scratches, *carved.lanes});
  }
  const std::optional<FastSums> fast = lanes ? std::nullopt : FastSums::of(scene, scratches, options, workspace);
  const ExactPairs exact = fast || lanes ? ExactPairs{} : exact_pairs(scene, scratches);

  RadianceDerivatives result;
  result.radiance = Image(grid.width(), grid.height(), channels);
  result.d_radiance.assign(parameters.size(), Image(grid.width(), grid.height(), channels));
  const std::array<double, 3> ambient = ambient_radiance(scene, channels);
  const RadianceChain chain(scene, camera, std::any_of(parameters.begin(), parameters.end(), [](SceneParameter p) {
                              return p == SceneParameter::grain_c || p == SceneParameter::grain_s;
                            }));
  const auto render_pixel = [&](std::size_t i) {
    const auto corners =
        footprint_corners_mm(grid, static_cast<int>(i % grid.width()), static_cast<int>(i / grid.width()));
    const double area = footprint_area_mm2(grid, i, corners);
    if (area == 0) return;
    const PixelShading p = shade_pixel(scene, i);
    if (!p.visible) return;
    for (int c = 0; c < channels; ++c) result.radiance.data[i * channels + c] = static_cast<float>(ambient[c]);
    if (!p.lit) return;
    GrooveSums sums;
    if (lanes) {
      sums = lanes->sums_of(i, p, corners, area);
    } else if (fast) {
      if (fast->pixels[i].area_mm2 > 0) {
        const double strength = fast->in_lamps_unit ? channel_factors(scene, p.cos_ho, 1)[0] * p.direct : 1;
        sums = groove_sums(fast->pixels[i], strength > 0 ? 1 / strength : 0, p, corners, area, scene.material.alpha);
      }
    } else {
      sums = exact_sums(scene, scratches, exact, i, p, corners, area, !parameters.empty());
    }
    const double Q = p.direct * (sums.light_mm2 / area + (1 - std::min(1.0, sums.area_mm2 / area)) * p.base);
    const auto factor = channel_factors(scene, p.cos_ho, channels);
    const auto slope = channel_factor_slopes(scene, p.cos_ho, channels);
    for (int c = 0; c < channels; ++c) {
      const std::size_t at = i * channels + c;
      result.radiance.data[at] = static_cast<float>(factor[c] * Q + ambient[c]);
      if (parameters.empty()) continue;
      BySceneParameter by{};
      chain.run({p, grid.normal[i], grid.center_mm[i], corners, area}, sums, factor[c], slope[c], by);
      for (std::size_t k = 0; k < parameters.size(); ++k)
        result.d_radiance[k].data[at] = static_cast<float>(by[static_cast<int>(parameters[k])]);
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, grid.center_mm.size(), 256),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i) render_pixel(i);
                    });
  return result;
}

}  // namespace burin
