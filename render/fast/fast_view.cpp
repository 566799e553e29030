#include "burin/render/fast/fast_view.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/machine_clones.h"
#include "burin/render/exact/exact_view.h"
#include "burin/render/fast/curve_kernel.h"
#include "burin/render/fast/groove_strips.h"
#include "burin/render/fast/grow.h"
#include "burin/render/fast/lamp_curves.h"
#include "burin/render/fast/render_workspace.h"
#include "burin/render/pixel_shading.h"
#include "burin/render/scene_parts.h"
#include "burin/scene/groove.h"

namespace burin {

namespace {

/// Light of a tile's pixels for a light of 1: the sums of their grooves and the remaining plain face. `open`: the
/// remaining share of the face. `covered_base`: the plain face's light if nothing of it remains, else 0. Returns
/// whether any `covered_base` is not 0.
BURIN_MACHINE_CLONES bool lobes_of_pixels(const float* sums, const float* inv_area, const float* base, float* open,
                                          float* lobes, float* covered_base) {
  int some = 0;
  for (int k = 0; k < kTilePixels; ++k) {
    const float covered = sums[2 * k + 1] * inv_area[k];
    open[k] = covered < 1 ? 1 - covered : 0.0F;
    covered_base[k] = covered < 1 ? 0.0F : base[k];
    some |= covered_base[k] > 0 ? 1 : 0;
    lobes[k] = sums[2 * k] * inv_area[k] + open[k] * base[k];
  }
  return some != 0;
}

BURIN_MACHINE_CLONES void multiply(const float* a, const float* b, int n, float* out) {
  for (int k = 0; k < n; ++k) out[k] = a[k] * b[k];
}

// Light of grooves of any cross-section under a lamp (docs/model.md 8.6), and their strips.
struct Sections {
  GrooveProfile profile;
  LampCurves lamp;
  double least_alpha = 0;  // lower bound of the roughness for the leans
  GrooveStrips::Shapes shapes;
  GrooveStrips strips;

  ScratchLines lines_of(const Scratches& scratches, const CurveTables* curves);
};

// `curves`: tabulated curves, which define the nodes; null: the lamp's curves.
ScratchLines Sections::lines_of(const Scratches& scratches, const CurveTables* curves) {
  constexpr double kWider = 1.02, kRougher = 0.98;
  const double rim = strips.measure(shapes);
  if (curves != nullptr) {
    shapes.burr_rim = static_cast<float>(curves->half_count) * curves->step;
    return strips.make(scratches, shapes);
  }
  const double least = *std::min_element(shapes.alpha.begin(), shapes.alpha.end()) * std::min(1.0, profile.across);
  if (lamp.leans.half_count * static_cast<double>(lamp.leans.step) < rim || least < least_alpha || least_alpha == 0) {
    least_alpha = kRougher * least;
    lamp.leans = section_leans(profile, shapes.tool_width_um, kWider * rim, least_alpha);
    shapes.burr_rim = static_cast<float>(lamp.leans.half_count) * lamp.leans.step;
  }
  return strips.make(scratches, shapes);
}

// Sums over a strip's runs: by its first and last end across and along, mm^-1.
struct StripGradient {
  double across_first = 0, across_last = 0, along_first = 0, along_last = 0, alpha = 0;

  void add_to(ScratchGradients& gradients, std::size_t scratch, const StripDirection& across) const {
    gradients.x0_mm[scratch] += across.x * across_first - across.y * along_first;
    gradients.y0_mm[scratch] += across.y * across_first + across.x * along_first;
    gradients.x1_mm[scratch] += across.x * across_last - across.y * along_last;
    gradients.y1_mm[scratch] += across.y * across_last + across.x * along_last;
  }
};

// Derivatives by the scratch's depth and width, um. A groove has those of its rim in t and of the scale of its t (log).
// A burr has those of its middle's offset (mm across).
struct StripByShape {
  std::size_t scratch = 0;
  double rim_by_depth = 0, rim_by_width = 0, scale_by_width = 0, aside_by_depth = 0, aside_by_width = 0;
};

}  // namespace

std::shared_ptr<RenderWorkspace> make_render_workspace(std::size_t most_jacobian_bytes,
                                                       std::shared_ptr<TileCache> tiles) {
  return std::make_shared<RenderWorkspace>(most_jacobian_bytes, std::move(tiles));
}

struct FastView::Data {
  const int channels;
  const TileKernels& kernels;
  const CurveKernels& curve_kernels;
  const std::shared_ptr<RenderWorkspace> workspace;
  const std::shared_ptr<const TiledGrid> grid;
  const double tool_width_um, shared_depth_um, shared_alpha;

  std::vector<TileShading> shading;           // by tile; empty with curves
  std::shared_ptr<const CurveTables> curves;  // null: light comes from the lamp, by its lobe or by `sections`
  std::unique_ptr<Sections> sections;         // walls of any shape
  // By tile * kTilePixels + place in the tile.
  std::vector<float> base;
  std::vector<float> base_slope;      // by base_alpha; empty without material
  std::vector<float> factor;          // channels per pixel: F intensity direct
  std::vector<float> half;            // with sections: x and y of the half vector of the lamp's first point
  std::vector<std::uint8_t> visible;  // empty without ambient light
  std::array<float, 3> ambient{};

  // From the last forward().
  KernelMode mode = KernelMode::value;
  std::size_t pair_count = 0;
  std::shared_ptr<const GrooveShapes> shapes;
  std::vector<float> alpha;  // one each, or one for all

  Data(const ViewScene& scene, int c, SimdWidth width, std::shared_ptr<RenderWorkspace> r)
      : channels(c),
        kernels(tile_kernels(width)),
        curve_kernels(burin::curve_kernels(width)),
        workspace(std::move(r)),
        grid(workspace->tiles_of(scene.grid)),
        tool_width_um(scene.tool_width_um),
        shared_depth_um(scene.material.depth_um),
        shared_alpha(scene.material.alpha) {}

  void start_shading(const ViewScene& scene, bool material);
  void shade(const ViewScene& scene, bool material);
  void shade(const ViewScene& scene, const PlainFace& face, bool material);
  void shade_sections(const ViewScene& scene, bool material);
  void make_sections(const ViewScene& scene);
  void sort_scratches(const Scratches& scratches);
  void evaluate(std::size_t t, TileTask task, const TilePlaces& places, RenderWorkspace::Work& w,
                const TileJacobian& to) const;
  TilePlaces evaluate_tile(std::size_t t, const TileTask& task, bool keep, RenderWorkspace::Work& w, TileJacobian& to);
  void render_tile(std::size_t t, Image& radiance);
  double differentiate_tile(std::size_t t, const Image& dE_dradiance);
  double rim_by_depth(std::size_t scratch) const;
  StripByShape by_shape_of(std::size_t strip) const;
  RunUnits units_of(std::size_t strip) const;
  void add_burr(std::size_t burr, const StripGradient& by, ScratchGradients& gradients) const;
  template <typename T>
  static double number_of(const std::vector<T>& each, std::size_t scratch) {
    return each[each.size() == 1 ? 0 : scratch];
  }
  double width_of(std::size_t scratch) const { return number_of(shapes->width_um, scratch); }
  double depth_of(std::size_t scratch) const { return number_of(shapes->depth_um, scratch); }

  TileTask task_of(std::size_t t) const {
    const GridTile& tile = grid->index.tiles()[t];
    return {&grid->lattice[t],
            grid->corners.empty() ? nullptr : &grid->corners[t],
            shading.empty() ? nullptr : &shading[t],
            nullptr,
            &base[t * kTilePixels],
            workspace->runs.of(t),
            workspace->runs.shapes(t),
            workspace->runs.count(t),
            grid->index.blocks(tile),
            grid->index.valid_rows(t),
            mode,
            false,
            false,
            workspace->most_runs,
            workspace->most_pairs};
  }

  /// visit(pixels, place in the tile and index in the picture of the first) for the rows of a tile.
  template <typename Visit>
  void each_row(std::size_t t, const Visit& visit) const {
    grid->each_row(t, [&](int n, std::size_t place, int x, int y) {
      visit(n, place, static_cast<std::size_t>(y) * grid->width + x);
    });
  }
};

/// Dark pixels, and the ambient light.
void FastView::Data::start_shading(const ViewScene& scene, bool material) {
  const std::size_t n = grid->tiles() * kTilePixels;
  const std::array<double, 3> a = ambient_radiance(scene, channels);
  for (int c = 0; c < 3; ++c) ambient[c] = static_cast<float>(a[c]);
  base.assign(n, 0);
  if (material) base_slope.assign(n, 0);
  factor.assign(n * channels, 0);
  if (a != std::array<double, 3>{}) visible.assign(n, 0);
}

void FastView::Data::shade(const ViewScene& scene, bool material) {
  start_shading(scene, material);
  shading.resize(grid->tiles());
  tbb::parallel_for(std::size_t{0}, grid->tiles(), [&](std::size_t t) {
    grid->each_pixel(t, [&](int x, int y, std::size_t place) {
      const std::size_t i = t * kTilePixels + place;
      const std::size_t pixel = static_cast<std::size_t>(y) * grid->width + x;
      if (!grid->index.has_footprint()[pixel]) return;
      const PixelShading p = shade_pixel(scene, pixel);
      if (!p.visible) return;
      if (!visible.empty()) visible[i] = 1;
      if (!p.lit) return;
      shading[t].at[place][0] = static_cast<float>(p.h_face.x());
      shading[t].at[place][1] = static_cast<float>(p.h_face.y());
      shading[t].at[place][2] = static_cast<float>((1 - p.cos_i * p.cos_i) / (p.cos_i * p.cos_i));
      shading[t].at[place][3] = static_cast<float>((1 - p.cos_o * p.cos_o) / (p.cos_o * p.cos_o));
      base[i] = static_cast<float>(p.base);
      const std::array<double, 3> f = channel_factors(scene, p.cos_ho, channels);
      for (int c = 0; c < channels; ++c) factor[i * channels + c] = static_cast<float>(f[c] * p.direct);
      if (!material) return;
      base_slope[i] = static_cast<float>(burin::base_slope(p, scene.material.base_alpha, scene.material.grain));
    });
  });
}

void FastView::Data::shade(const ViewScene& scene, const PlainFace& face, bool material) {
  const std::size_t n = grid->tiles() * kTilePixels;
  base.assign(n, 0);
  if (material) base_slope.assign(n, 0);
  factor.assign(n, 0);
  tbb::parallel_for(std::size_t{0}, grid->tiles(), [&](std::size_t t) {
    grid->each_pixel(t, [&](int x, int y, std::size_t place) {
      const std::size_t i = t * kTilePixels + place, pixel = static_cast<std::size_t>(y) * grid->width + x;
      if (!grid->index.has_footprint()[pixel]) return;
      const Eigen::Vector3d way = scene.camera_center_mm - scene.grid->center_mm[pixel];
      if (!(way.dot(scene.grid->normal[pixel]) > 0)) return;
      if (!scene.hidden_from_light.empty() && scene.hidden_from_light[pixel] != 0) return;
      factor[i] = 1;
      base[i] = face.light[pixel];
      if (material) base_slope[i] = face.by_base_alpha[pixel];
    });
  });
}

void FastView::Data::make_sections(const ViewScene& scene) {
  sections = std::make_unique<Sections>();
  sections->profile = scene.material.profile;
  sections->shapes.profile = &sections->profile;
  sections->shapes.tool_width_um = tool_width_um;
}

// In curves, light is the mean of the channels, also for the plain face; `factor` is a channel's ratio to it.
void FastView::Data::shade_sections(const ViewScene& scene, bool material) {
  start_shading(scene, material);
  half.assign(2 * base.size(), 0);
  const std::vector<ScenePart> parts = scene_parts(scene);
  tbb::parallel_for(std::size_t{0}, grid->tiles(), [&](std::size_t t) {
    grid->each_pixel(t, [&](int x, int y, std::size_t place) {
      const std::size_t i = t * kTilePixels + place;
      const std::size_t pixel = static_cast<std::size_t>(y) * grid->width + x;
      if (!grid->index.has_footprint()[pixel]) return;
      double sum = 0, slope = 0;
      bool is_lit = false;
      for (const ScenePart& part : parts) {
        const PixelShading p = shade_pixel(part.scene, pixel);
        if (p.visible && !visible.empty()) visible[i] = 1;
        if (!p.visible || !p.lit) continue;
        const double mono = channel_factors(part.scene, p.cos_ho, 1)[0], light = part.share * mono * p.direct;
        sum += light * p.base;
        if (material) slope += light * burin::base_slope(p, scene.material.base_alpha, scene.material.grain);
        if (is_lit || !(mono > 0)) continue;
        is_lit = true;
        half[2 * i] = static_cast<float>(p.h_face.x());
        half[2 * i + 1] = static_cast<float>(p.h_face.y());
        const std::array<double, 3> f = channel_factors(part.scene, p.cos_ho, channels);
        for (int c = 0; c < channels; ++c) factor[i * channels + c] = static_cast<float>(f[c] / mono);
      }
      base[i] = static_cast<float>(sum);
      if (material) base_slope[i] = static_cast<float>(slope);
    });
  });
  make_sections(scene);
  sections->lamp.across = static_cast<float>(scene.material.profile.across);
  sections->lamp.fits = lamp_fits(scene, *grid);
}

/// Evaluates the tile's pairs, by lobes or curves.
void FastView::Data::evaluate(std::size_t t, TileTask task, const TilePlaces& places, RenderWorkspace::Work& w,
                              const TileJacobian& to) const {
  if (curves == nullptr && sections == nullptr) {
    kernels.evaluate(task, places, w.tile, w.pairs, to);
    return;
  }
  task.curves = &w.curves;
  if (curves == nullptr) {
    curve_kernels.make_lamp_curves(sections->lamp, task, places, t, w.curves);
  } else {
    const int left = static_cast<int>(t % grid->index.tiles_x()) * kTile,
              top = static_cast<int>(t / grid->index.tiles_x()) * kTile;
    curve_kernels.make_curves(*curves, task, places, left, top, w.curves);
  }
  curve_kernels.evaluate(task, places, w.tile, w.pairs, to);
}

void FastView::Data::sort_scratches(const Scratches& s) {
  shapes = workspace->shapes_of(s, tool_width_um, shared_depth_um);
  alpha.resize(s.alpha.empty() ? 1 : s.alpha.size());
  for (std::size_t i = 0; i < alpha.size(); ++i)
    alpha[i] = static_cast<float>(std::min(1.0, s.alpha.empty() ? shared_alpha : s.alpha[i]));
  if (sections != nullptr) {
    sections->shapes.width_um = shapes->width_um;
    sections->shapes.depth_um = shapes->depth_um;
    sections->shapes.alpha = alpha;
    workspace->sort(grid, sections->lines_of(s, curves.get()));
    return;
  }
  workspace->sort(grid, lines_of(s, shapes->per_mm, shapes->rim, alpha));
}

/// Finds and evaluates a tile's pairs. `to` is their Jacobian: kept on request if space is left, else in `w` until the
/// next tile.
TilePlaces FastView::Data::evaluate_tile(std::size_t t, const TileTask& task, bool keep, RenderWorkspace::Work& w,
                                         TileJacobian& to) {
  const TilePlaces places = workspace->places_of(t, task, kernels, w.found);
  const std::size_t first = t * kTilePixels, count = places.begin[task.run_count];
  if (keep) to = workspace->keep_jacobian(mode, count);
  const TileJacobian kept = to;
  if (to.shift == nullptr) to = RenderWorkspace::make_jacobian(mode, count, w, task.by_half_vector);
  evaluate(t, task, places, w, to);
  to.ends = w.pairs.ends.data();
  to.end_count = w.pairs.ends.size();
  const bool some_covered =
      lobes_of_pixels(w.tile.sums, &grid->inv_area[first], &base[first], w.open, w.lobes, w.covered_base);
  if (mode != KernelMode::value && some_covered) kernels.cover(task, places, w.covered_base, w.tile, to);
  if (keep) workspace->keep_ends(t, kept, w.pairs.ends);
  return places;
}

void FastView::Data::render_tile(std::size_t t, Image& radiance) {
  RenderWorkspace::Work& w = *workspace->work.local();
  const TileTask task = task_of(t);
  // Pixels are accessed in random order, so prefetch all.
  const auto fetch = [](const auto* what) {
    for (std::size_t k = 0; k < sizeof(*what); k += 64) __builtin_prefetch(reinterpret_cast<const char*>(what) + k);
  };
  if (task.corners != nullptr) fetch(task.corners);
  if (task.shading != nullptr) fetch(task.shading);
  TileJacobian jacobian;
  evaluate_tile(t, task, mode != KernelMode::value, w, jacobian);
  const bool with_slope = mode == KernelMode::material;
  each_row(t, [&](int n, std::size_t place, std::size_t pixel) {
    const std::size_t i = t * kTilePixels + place;
    const float *lobes = w.lobes + place, *f = &factor[i * channels];
    float* out = &radiance.data[pixel * channels];
    if (with_slope) multiply(w.open + place, &base_slope[i], n, &workspace->open_slope[i]);
    if (channels == 1) {
      multiply(f, lobes, n, out);
    } else {
      for (int k = 0; k < n; ++k)
        for (int c = 0; c < channels; ++c) out[k * channels + c] = f[k * channels + c] * lobes[k];
    }
    if (!visible.empty())
      for (int k = 0; k < n; ++k)
        for (int c = 0; c < channels; ++c) out[k * channels + c] += static_cast<float>(visible[i + k]) * ambient[c];
  });
}

/// Writes the gradients of the tile's runs to the workspace; returns dE / d base_alpha through the tile.
double FastView::Data::differentiate_tile(std::size_t t, const Image& dE_dradiance) {
  RenderWorkspace::Work& w = *workspace->work.local();
  const TileTask task = task_of(t);
  TileJacobian jacobian = workspace->jacobian[t];
  TilePlaces places;
  if (jacobian.shift != nullptr) {
    places = workspace->places_of(t, task, kernels, w.found);
  } else {  // no space was left: evaluate again
    places = evaluate_tile(t, task, false, w, jacobian);
  }
  const bool material = mode == KernelMode::material;
  double by_base_alpha = 0;
  each_row(t, [&](int n, std::size_t place, std::size_t pixel) {
    const std::size_t i = t * kTilePixels + place;
    const float *in = &dE_dradiance.data[pixel * channels], *f = &factor[i * channels], *inv_area = &grid->inv_area[i];
    alignas(64) float by_lobes[kTile] = {};
    if (channels == 1) {
      multiply(in, f, n, by_lobes);
    } else {
      for (int k = 0; k < n; ++k)
        for (int c = 0; c < channels; ++c) by_lobes[k] += in[k * channels + c] * f[k * channels + c];
    }
    multiply(by_lobes, inv_area, n, w.weight + place);
    if (!material) return;
    float by_slope = 0;
    for (int k = 0; k < n; ++k) by_slope += by_lobes[k] * workspace->open_slope[i + k];
    by_base_alpha += by_slope;
  });
  kernels.gather(task, places, w.weight, jacobian,
                 &workspace->by_run[static_cast<std::size_t>(workspace->runs.begin(t)) * run_gradients(mode)]);
  return by_base_alpha;
}

/// d(rim) / d(depth) of a groove; the paper's rim is sqrt(1 - exp(-2 d / wt)).
double FastView::Data::rim_by_depth(std::size_t scratch) const {
  const double width = width_of(scratch), depth = depth_of(scratch);
  if (sections == nullptr) {
    const double rim = number_of(shapes->rim, scratch);
    return (1 - rim * rim) / (width * rim);
  }
  return 2 / GrooveStrips::unit_um(sections->profile, tool_width_um, width) *
         half_width_slope(sections->profile, width, depth);
}

StripByShape FastView::Data::by_shape_of(std::size_t strip) const {
  const GrooveStrips* const strips = sections != nullptr ? &sections->strips : nullptr;
  const bool is_burr = strips != nullptr && strip >= strips->grooves;
  const std::size_t s = is_burr ? strips->owner[strip - strips->grooves] : strip;
  const double width = width_of(s), depth = depth_of(s);
  // A section with its own radius does not scale with the width.
  const double scale = sections != nullptr && sections->profile.tip_radius_um > 0 ? 0 : 1 / width;
  StripByShape out;
  out.scratch = s;
  if (is_burr) {
    const double slope = half_width_slope(sections->profile, width, depth),
                 aside = std::copysign(1e-3, strips->aside_mm[strip - strips->grooves]);
    out.aside_by_depth = aside * slope;
    out.aside_by_width = scale * aside * (half_width_um(sections->profile, width, depth) - depth * slope);
  } else {
    out.rim_by_depth = rim_by_depth(s);
    out.scale_by_width = scale;
    out.rim_by_width = -scale * depth * out.rim_by_depth;
  }
  return out;
}

/// For scratches with their own values, derivatives are by a common factor.
RunUnits FastView::Data::units_of(std::size_t strip) const {
  const StripByShape by = by_shape_of(strip);
  const double depth = shapes->depth_um.size() == 1 ? 1 : depth_of(by.scratch) / shared_depth_um,
               width = shapes->width_um.size() == 1 ? 1 : width_of(by.scratch) / tool_width_um;
  RunUnits out;
  out.rim_by_depth = static_cast<float>(depth * by.rim_by_depth);
  out.aside_by_depth = static_cast<float>(depth * by.aside_by_depth);
  out.scale_by_width = static_cast<float>(width * by.scale_by_width);
  out.rim_by_width = static_cast<float>(width * by.rim_by_width);
  out.aside_by_width = static_cast<float>(width * by.aside_by_width);
  if (alpha.size() > 1) out.by_alpha = static_cast<float>(alpha[by.scratch] / shared_alpha);
  return out;
}

/// A burr moves with its groove, and outwards as the groove becomes deeper or wider.
void FastView::Data::add_burr(std::size_t burr, const StripGradient& by, ScratchGradients& gradients) const {
  const GrooveStrips& strips = sections->strips;
  const std::uint32_t s = strips.owner[burr];
  const StripDirection& x = workspace->runs.across(strips.grooves + burr);
  // An offset strip moves along as the groove turns.
  const double along = by.along_first + by.along_last, turned = strips.aside_mm[burr] / x.length_mm * along;
  StripGradient{by.across_first + turned, by.across_last - turned, by.along_first, by.along_last}.add_to(gradients, s,
                                                                                                         x);
  if (mode != KernelMode::material) return;
  const StripByShape aside = by_shape_of(strips.grooves + burr);
  const double across = by.across_first + by.across_last, by_depth = aside.aside_by_depth * across,
               by_width = aside.aside_by_width * across;
  gradients.depth_um[s] += by_depth;
  gradients.width_um[s] += by_width;
  gradients.alpha[s] += by.alpha;
  gradients.shared_depth_um += by_depth;
  gradients.shared_width_um += by_width;
  gradients.shared_alpha += by.alpha;
}

FastView::FastView(const ViewScene& scene, int channels, bool material, SimdWidth width,
                   std::shared_ptr<RenderWorkspace> workspace)
    : data_(std::make_unique<Data>(scene, channels, width, std::move(workspace))) {
  if (scene.material.profile.is_paper() && scene.light.size.is_point())
    data_->shade(scene, material);
  else
    data_->shade_sections(scene, material);
}

FastView::FastView(const ViewScene& scene, const PlainFace& face, bool material, SimdWidth width,
                   std::shared_ptr<RenderWorkspace> workspace)
    : data_(std::make_unique<Data>(scene, 1, width, std::move(workspace))) {
  data_->shade(scene, face, material);
  if (!scene.material.profile.is_paper()) data_->make_sections(scene);
}

FastView::~FastView() = default;

void FastView::set_curves(std::shared_ptr<const CurveTables> curves) { data_->curves = std::move(curves); }

bool FastView::has_lamp_curves() const { return data_->sections != nullptr && data_->curves == nullptr; }

bool FastView::has_jacobian() const { return data_->workspace->owner == this && data_->mode != KernelMode::value; }

bool FastView::is_smooth() const {
  constexpr double kMost = 0.02;  // of the roughness: largest fit error for curves
  const Sections* s = data_->sections.get();
  return s == nullptr || s->lamp.fits.error < kMost * data_->shared_alpha * std::min(1.0, s->profile.across);
}

std::size_t FastView::pair_count() const { return data_->pair_count; }

void FastView::forward(const Scratches& scratches, KernelMode mode, Image& radiance) {
  Data& d = *data_;
  RenderWorkspace& workspace = *d.workspace;
  d.mode = mode;
  workspace.owner = this;
  if (radiance.width != d.grid->width || radiance.height != d.grid->height || radiance.channels != d.channels)
    radiance = Image(d.grid->width, d.grid->height, d.channels);
  const std::size_t tiles = d.grid->tiles();
  if (workspace.jacobian.size() < tiles) workspace.jacobian.resize(tiles);
  if (mode == KernelMode::material && workspace.open_slope.size() < tiles * kTilePixels)
    workspace.open_slope.resize(tiles * kTilePixels);
  workspace.jacobian_store.clear();
  d.sort_scratches(scratches);
  tbb::parallel_for(std::size_t{0}, tiles, [&](std::size_t t) { d.render_tile(t, radiance); });
  d.pair_count = 0;
  for (std::size_t t = 0; t < tiles; ++t) {
    d.pair_count += workspace.pair_count[t];
    workspace.most_pairs = std::max<std::size_t>(workspace.most_pairs, workspace.pair_count[t]);
  }
}

void FastView::pixel_slopes(const Scratches& scratches, std::vector<PixelSlopes>& out) {
  Data& d = *data_;
  RenderWorkspace& workspace = *d.workspace;
  d.mode = KernelMode::material;
  workspace.owner = nullptr;  // no backward pass is possible
  out.assign(static_cast<std::size_t>(d.grid->width) * d.grid->height, {});
  d.sort_scratches(scratches);
  const bool one_shape = d.shapes->width_um.size() == 1 && d.shapes->depth_um.size() == 1 && d.alpha.size() == 1 &&
                         (d.sections == nullptr || d.sections->strips.burrs() == 0) && scratches.size() > 0;
  tbb::parallel_for(std::size_t{0}, d.grid->tiles(), [&](std::size_t t) {
    RenderWorkspace::Work& w = *workspace.work.local();
    TileTask task = d.task_of(t);
    task.by_half_vector = true;
    TileJacobian jacobian;
    const TilePlaces places = d.evaluate_tile(t, task, false, w, jacobian);
    grow_to(w.units, task.run_count);
    for (std::uint32_t r = 0; r < task.run_count; ++r)
      w.units[r] = one_shape && r > 0 ? w.units[0] : d.units_of(workspace.runs.scratch(t, r));
    w.slopes.assign(static_cast<std::size_t>(kPixelSlopes) * kTilePixels, 0);
    std::array<float, kTilePixels> half_x{}, half_y{};
    for (std::size_t k = 0; k < kTilePixels; ++k) {
      const float* const h = d.shading.empty() ? &d.half[2 * (t * kTilePixels + k)] : d.shading[t].at[k];
      half_x[k] = h[0];
      half_y[k] = h[1];
    }
    d.kernels.spread(task, places, jacobian, w.units.data(), half_x.data(), half_y.data(), w.slopes.data());
    d.each_row(t, [&](int n, std::size_t place, std::size_t pixel) {
      for (int k = 0; k < n; ++k) {
        PixelSlopes& to = out[pixel + k];
        to.light = w.tile.sums[2 * (place + k)];
        to.area_mm2 = w.tile.sums[2 * (place + k) + 1];
        std::copy_n(&w.slopes[kPixelSlopes * (place + k)], kPixelSlopes, to.by.begin());
      }
    });
  });
}

void FastView::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  Data& d = *data_;
  RenderWorkspace& workspace = *d.workspace;
  if (d.mode == KernelMode::value)
    fail("ViewRenderer::backward", "there is no Jacobian", "call forward_with_jacobian() first");
  if (workspace.owner != this)
    fail("ViewRenderer::backward", "another view has been rendered in the same workspace since",
         "call backward() before the next view's forward_with_jacobian()");
  const std::size_t tiles = d.grid->tiles();
  const bool material = d.mode == KernelMode::material;
  const std::size_t numbers = run_gradients(d.mode), needed = workspace.runs.total() * numbers;
  grow_to(workspace.by_run, needed + 1);
  workspace.by_tile.resize(tiles);
  tbb::parallel_for(std::size_t{0}, tiles,
                    [&](std::size_t t) { workspace.by_tile[t] = d.differentiate_tile(t, dE_dradiance); });
  for (const double v : workspace.by_tile) gradients.shared_base_alpha += v;
  // The runs of a scratch are summed in tile order.
  workspace.by_chunk.assign(workspace.runs.chunk_count(), Eigen::Array3d::Zero());
  const GrooveStrips* strips = d.sections != nullptr ? &d.sections->strips : nullptr;
  std::vector<StripGradient> by_burr(strips != nullptr ? strips->burrs() : 0);
  const auto add = [&](std::size_t chunk, std::uint32_t s, std::span<const std::uint32_t> runs) {
    const auto sum_of = [&](std::size_t from) {
      std::array<double, 4> sum{};
      for (const std::uint32_t r : runs) {
        const float* by = &workspace.by_run[r * numbers + from];
        for (int i = 0; i < 4; ++i) sum[i] += by[i];
      }
      return sum;
    };
    const std::array<double, 4> sum = sum_of(0);
    const StripDirection& x = workspace.runs.across(s);
    const std::array<double, 4> by_shape = material ? sum_of(4) : std::array<double, 4>{};
    const double at_second = sum[1] / x.length_mm;
    const StripGradient by{sum[0] - at_second, at_second, sum[2], sum[3], by_shape[2]};
    if (strips != nullptr && s >= strips->grooves) {
      by_burr[s - strips->grooves] = by;
      return;
    }
    by.add_to(gradients, s, x);
    if (!material) return;
    const StripByShape shape = d.by_shape_of(s);
    const double by_depth = shape.rim_by_depth * by_shape[1],
                 by_width = shape.scale_by_width * by_shape[0] + shape.rim_by_width * by_shape[1];
    gradients.width_um[s] += by_width;
    gradients.depth_um[s] += by_depth;
    gradients.alpha[s] += by.alpha;
    workspace.by_chunk[chunk] += Eigen::Array3d(by_width, by_depth, by.alpha);
  };
  workspace.runs.each_scratch(add, [&](std::uint32_t run) { __builtin_prefetch(&workspace.by_run[run * numbers]); });
  for (const Eigen::Array3d& v : workspace.by_chunk) {
    gradients.shared_width_um += v[0];
    gradients.shared_depth_um += v[1];
    gradients.shared_alpha += v[2];
  }
  for (std::size_t k = 0; k < by_burr.size(); ++k) d.add_burr(k, by_burr[k], gradients);
}

void FastView::add_contributions(std::vector<double>& contribution) const {
  const Data& d = *data_;
  RenderWorkspace& workspace = *d.workspace;
  if (workspace.owner != this)
    fail("ViewRenderer::add_contributions", "another view has been rendered in the same workspace since",
         "call add_contributions() before the next view's forward()");
  // Light is not stored per pair, so evaluate it again, tile by tile.
  std::vector<float>& by_run = workspace.by_run;
  grow_to(by_run, workspace.runs.total());
  tbb::parallel_for(std::size_t{0}, d.grid->tiles(), [&](std::size_t t) {
    RenderWorkspace::Work& w = *workspace.work.local();
    TileTask task = d.task_of(t);
    task.mode = KernelMode::value;
    task.keep_light = true;
    const TilePlaces places = workspace.places_of(t, task, d.kernels, w.found);
    d.evaluate(t, task, places, w, {});
    for (std::uint32_t r = 0; r < task.run_count; ++r) {
      double sum = 0;
      for (std::uint32_t k = places.begin[r]; k < places.begin[r + 1]; ++k) {
        const std::size_t i = t * kTilePixels + places.place[k];
        double weight = 0;
        for (int c = 0; c < d.channels; ++c) weight += d.factor[i * d.channels + c];
        sum += weight / d.channels * d.grid->inv_area[i] * w.pairs.light[k];
      }
      by_run[workspace.runs.begin(t) + r] = static_cast<float>(sum);
    }
  });
  const GrooveStrips* strips = d.sections != nullptr ? &d.sections->strips : nullptr;
  std::vector<double> of_burr(strips != nullptr ? strips->burrs() : 0, 0);
  workspace.runs.each_scratch(
      [&](std::size_t, std::uint32_t s, std::span<const std::uint32_t> runs) {
        double& to = strips != nullptr && s >= strips->grooves ? of_burr[s - strips->grooves] : contribution[s];
        for (const std::uint32_t r : runs) to += by_run[r];
      },
      [&](std::uint32_t run) { __builtin_prefetch(&by_run[run]); });
  for (std::size_t k = 0; k < of_burr.size(); ++k) contribution[strips->owner[k]] += of_burr[k];
}

}  // namespace burin
