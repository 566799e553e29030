#include "render/fast_view.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "render/error.h"
#include "render/exact_view.h"
#include "render/groove.h"
#include "render/pixel_shading.h"
#include "render/render_room.h"

namespace burin {

std::shared_ptr<RenderRoom> make_render_room() { return std::make_shared<RenderRoom>(); }

struct FastView::Data {
  const ViewScene& scene;
  const PixelIndex& index;
  const int channels;
  const TileKernels& kernels;
  const std::shared_ptr<RenderRoom> room;

  std::vector<TilePixels> pixels;  // by tile
  // By tile * kTilePixels + place in the tile.
  std::vector<float> inv_area, base, base_slope, ambient_on;
  std::vector<float> factor;  // channels a pixel: F intensity direct
  std::array<float, 3> ambient{};

  // Of the last forward().
  KernelMode mode = KernelMode::value;
  std::size_t scratch_count = 0, pair_count = 0;
  std::vector<double> width_um, depth_um;  // one each, or one of all
  std::vector<float> per_mm, rim, alpha;   // the same

  Data(const ViewScene& s, const PixelIndex& i, int c, SimdWidth width, std::shared_ptr<RenderRoom> r)
      : scene(s), index(i), channels(c), kernels(tile_kernels(width)), room(std::move(r)) {}

  void make_pixels();
  void sort_scratches(const Scratches& scratches);
  void render_tile(std::size_t t, Image& radiance);
  double differentiate_tile(std::size_t t, const Image& dE_dradiance);
  double width_of(std::size_t scratch) const { return width_um[width_um.size() == 1 ? 0 : scratch]; }
  double depth_of(std::size_t scratch) const { return depth_um[depth_um.size() == 1 ? 0 : scratch]; }

  TileTask task_of(std::size_t t) const {
    const GridTile& tile = index.tiles()[t];
    return {&pixels[t],
            room->runs.of(t),
            room->runs.count(t),
            index.blocks(tile),
            tile.all_valid ? nullptr : tile.valid_rows.data(),
            mode};
  }

  /// visit(pixels, place in the tile and number in the picture of the first) for the rows of a tile.
  template <typename Visit>
  void each_row(std::size_t t, const Visit& visit) const {
    const int x0 = static_cast<int>(t % index.tiles_x()) * kTile, y0 = static_cast<int>(t / index.tiles_x()) * kTile;
    const int x1 = std::min(x0 + kTile, scene.grid.width()), y1 = std::min(y0 + kTile, scene.grid.height());
    for (int y = y0; y < y1; ++y)
      visit(x1 - x0, static_cast<std::size_t>(y - y0) * kTile, static_cast<std::size_t>(y) * scene.grid.width() + x0);
  }

  /// visit(x, y of the picture, place in the tile) for the pixels of a tile.
  template <typename Visit>
  void each_pixel(std::size_t t, const Visit& visit) const {
    const int x0 = static_cast<int>(t % index.tiles_x()) * kTile, y0 = static_cast<int>(t / index.tiles_x()) * kTile;
    const int x1 = std::min(x0 + kTile, scene.grid.width()), y1 = std::min(y0 + kTile, scene.grid.height());
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) visit(x, y, static_cast<std::size_t>(y - y0) * kTile + (x - x0));
  }
};

void FastView::Data::make_pixels() {
  const FootprintGrid& grid = scene.grid;
  const std::size_t tile_count = index.tiles().size(), n = tile_count * kTilePixels;
  pixels.resize(tile_count);
  inv_area.assign(n, 0);
  base.assign(n, 0);
  base_slope.assign(n, 0);
  ambient_on.assign(n, 0);
  factor.assign(n * channels, 0);
  const std::array<double, 3> a = ambient_radiance(scene, channels);
  for (int c = 0; c < 3; ++c) ambient[c] = static_cast<float>(a[c]);

  tbb::parallel_for(std::size_t{0}, tile_count, [&](std::size_t t) {
    const Eigen::Vector2d& origin = index.tiles()[t].origin_mm;
    each_pixel(t, [&](int x, int y, std::size_t place) {
      const std::size_t i = t * kTilePixels + place;
      const std::size_t pixel = static_cast<std::size_t>(y) * grid.width() + x;
      if (!index.has_footprint()[pixel]) return;
      const auto q = footprint_corners_mm(grid, x, y);
      const double area = signed_area_mm2(q);
      const PixelShading p = shade_pixel(scene, pixel);
      float* shading = pixels[t].shading[place];
      const std::array<int, 4> corners{0, 1, TilePixels::kCorners + 1, TilePixels::kCorners};
      for (int k = 0; k < 4; ++k) {
        float* corner = pixels[t].corner[place / kTile * TilePixels::kCorners + place % kTile + corners[k]];
        corner[0] = static_cast<float>(q[k].x() - origin.x());
        corner[1] = static_cast<float>(q[k].y() - origin.y());
      }
      if (!p.visible) return;
      ambient_on[i] = 1;
      if (!p.lit) return;
      shading[0] = static_cast<float>(p.h_face.x());
      shading[1] = static_cast<float>(p.h_face.y());
      shading[2] = static_cast<float>((1 - p.cos_i * p.cos_i) / (p.cos_i * p.cos_i));
      shading[3] = static_cast<float>((1 - p.cos_o * p.cos_o) / (p.cos_o * p.cos_o));
      inv_area[i] = static_cast<float>(1 / std::abs(area));
      base[i] = static_cast<float>(p.base);
      const Shadowing g = shadowing(p.cos_i, p.cos_o, scene.material.base_alpha);
      const BaseLobe lobe = base_lobe(p.h_face.z(), scene.material.base_alpha);
      base_slope[i] = static_cast<float>(lobe.dD_dalpha * g.G + lobe.D * g.dG_dalpha);
      const std::array<double, 3> f = channel_factors(scene, p.cos_ho, channels);
      for (int c = 0; c < channels; ++c) factor[i * channels + c] = static_cast<float>(f[c] * p.direct);
    });
  });
}

void FastView::Data::sort_scratches(const Scratches& s) {
  scratch_count = s.size();
  const auto keep = [](const std::vector<double>& own, double shared, std::vector<double>& to) {
    if (own.empty())
      to.assign(1, shared);
    else
      to.assign(own.begin(), own.end());
  };
  keep(s.width_um, scene.tool_width_um, width_um);
  keep(s.depth_um, scene.material.depth_um, depth_um);
  const std::size_t widths = std::max(width_um.size(), depth_um.size());
  per_mm.resize(widths);
  rim.resize(widths);
  for (std::size_t i = 0; i < widths; ++i) {
    per_mm[i] = static_cast<float>(2000 / width_of(i));
    rim[i] = static_cast<float>(groove_rim(width_of(i), depth_of(i)));
  }
  alpha.resize(s.alpha.empty() ? 1 : s.alpha.size());
  for (std::size_t i = 0; i < alpha.size(); ++i)
    alpha[i] = static_cast<float>(std::min(1.0, s.alpha.empty() ? scene.material.alpha : s.alpha[i]));
  room->runs.sort(index, {s.size(),
                          s.x0_mm.data(),
                          s.y0_mm.data(),
                          s.x1_mm.data(),
                          s.y1_mm.data(),
                          {per_mm.data(), widths == 1},
                          {rim.data(), widths == 1},
                          {alpha.data(), s.alpha.empty()}});
}

void FastView::Data::render_tile(std::size_t t, Image& radiance) {
  RenderRoom::Work& w = *room->work.local();
  TilePairs& pairs = room->pairs[t];
  const TileTask task = task_of(t);
  // Pixels are met in no order: have them near before the first is needed.
  const char* near = reinterpret_cast<const char*>(&pixels[t]);
  for (std::size_t k = 0; k < sizeof(TilePixels); k += 64) __builtin_prefetch(near + k);
  kernels.evaluate(task, w.tile, pairs);
  each_row(t, [&](int n, std::size_t place, std::size_t pixel) {
    const std::size_t i = t * kTilePixels + place;
    const float *sums = w.tile.sums + 2 * place, *f = &factor[i * channels];
    float* out = &radiance.data[pixel * channels];
    alignas(64) float lobes[kTile];
    for (int k = 0; k < n; ++k) {
      const float c = sums[2 * k + 1] * inv_area[i + k], open = 1 - std::min(1.0F, c);
      w.base[place + k] = c < 1 ? base[i + k] : 0.0F;
      room->open_slope[i + k] = open * base_slope[i + k];
      lobes[k] = sums[2 * k] * inv_area[i + k] + open * base[i + k];
    }
    for (int k = 0; k < n; ++k)
      for (int c = 0; c < channels; ++c)
        out[k * channels + c] = f[k * channels + c] * lobes[k] + ambient_on[i + k] * ambient[c];
  });
  kernels.combine(mode, pairs.begin[task.run_count], w.base, w.tile, pairs);
}

/// Puts the gradients of the tile's runs into the room; returns dE / d base_alpha through the tile.
double FastView::Data::differentiate_tile(std::size_t t, const Image& dE_dradiance) {
  RenderRoom::Work& w = *room->work.local();
  double by_base_alpha = 0;
  each_row(t, [&](int n, std::size_t place, std::size_t pixel) {
    const std::size_t i = t * kTilePixels + place;
    const float *in = &dE_dradiance.data[pixel * channels], *f = &factor[i * channels];
    alignas(64) float by_lobes[kTile] = {};
    if (channels == 1) {
      for (int k = 0; k < n; ++k) by_lobes[k] = in[k] * f[k];
    } else {
      for (int k = 0; k < n; ++k)
        for (int c = 0; c < channels; ++c) by_lobes[k] += in[k * channels + c] * f[k * channels + c];
    }
    float by_slope = 0;
    for (int k = 0; k < n; ++k) {
      w.weight[place + k] = by_lobes[k] * inv_area[i + k];
      by_slope += by_lobes[k] * room->open_slope[i + k];
    }
    by_base_alpha += by_slope;
  });
  std::array<float*, kRunGradients> to{};
  for (int i = 0; i < (mode == KernelMode::material ? kRunGradients : 4); ++i)
    to[i] = room->by_run[i].data() + room->runs.begin(t);
  kernels.gather(task_of(t), w.weight, room->pairs[t], to);
  return by_base_alpha;
}

FastView::FastView(const ViewScene& scene, const PixelIndex& index, int channels, SimdWidth width,
                   std::shared_ptr<RenderRoom> room)
    : data_(std::make_unique<Data>(scene, index, channels, width, std::move(room))) {
  check_view(scene, channels);
  data_->make_pixels();
}

FastView::~FastView() = default;

std::size_t FastView::pair_count() const { return data_->pair_count; }

void FastView::forward(const Scratches& scratches, KernelMode mode, Image& radiance) {
  Data& d = *data_;
  RenderRoom& room = *d.room;
  d.mode = mode;
  room.owner = this;
  if (radiance.width != d.scene.grid.width() || radiance.height != d.scene.grid.height() ||
      radiance.channels != d.channels)
    radiance = Image(d.scene.grid.width(), d.scene.grid.height(), d.channels);
  const std::size_t tiles = d.index.tiles().size();
  if (room.pairs.size() < tiles) room.pairs.resize(tiles);
  if (room.open_slope.size() < tiles * kTilePixels) room.open_slope.resize(tiles * kTilePixels);
  d.sort_scratches(scratches);
  tbb::parallel_for(std::size_t{0}, tiles, [&](std::size_t t) { d.render_tile(t, radiance); });
  d.pair_count = 0;
  for (std::size_t t = 0; t < tiles; ++t) d.pair_count += room.pairs[t].begin[room.runs.count(t)];
}

void FastView::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  Data& d = *data_;
  RenderRoom& room = *d.room;
  if (d.mode == KernelMode::value)
    fail("ViewRenderer::backward", "there is no Jacobian", "call forward_with_jacobian() first");
  if (room.owner != this)
    fail("ViewRenderer::backward", "another view has been rendered in the same room since",
         "call backward() before the next view's forward_with_jacobian()");
  const std::size_t tiles = d.index.tiles().size();
  const bool material = d.mode == KernelMode::material;
  for (int i = 0; i < (material ? kRunGradients : 4); ++i)
    if (room.by_run[i].size() < room.runs.total()) room.by_run[i].resize(room.runs.total() + room.runs.total() / 4);
  room.by_tile.resize(tiles);
  tbb::parallel_for(std::size_t{0}, tiles,
                    [&](std::size_t t) { room.by_tile[t] = d.differentiate_tile(t, dE_dradiance); });
  for (const double v : room.by_tile) gradients.shared_base_alpha += v;
  // A scratch's runs are added up in tile order.
  room.by_chunk.assign(room.runs.chunk_count(), Eigen::Array3d::Zero());
  room.runs.each_scratch([&](std::size_t chunk, std::uint32_t s, std::span<const std::uint32_t> runs) {
    const auto sum = [&](int i) {
      double v = 0;
      for (const std::uint32_t r : runs) v += room.by_run[i][r];
      return v;
    };
    const StripDirection& x = room.runs.across(s);
    const double at_second = sum(1) / x.length_mm, at_first = sum(0) - at_second, first = sum(2), second = sum(3);
    gradients.x0_mm[s] += x.x * at_first - x.y * first;
    gradients.y0_mm[s] += x.y * at_first + x.x * first;
    gradients.x1_mm[s] += x.x * at_second - x.y * second;
    gradients.y1_mm[s] += x.y * at_second + x.x * second;
    if (!material) return;
    // The rim is sqrt(1 - exp(-2 d / wt)).
    const double width = d.width_of(s), depth = d.depth_of(s), by_rim = sum(5);
    const double rim_by_depth = std::exp(-2 * depth / width) / (width * groove_rim(width, depth));
    const double by_depth = rim_by_depth * by_rim, by_width = (sum(4) - depth * by_depth) / width;
    gradients.width_um[s] += by_width;
    gradients.depth_um[s] += by_depth;
    const double by_alpha = sum(6);
    gradients.alpha[s] += by_alpha;
    room.by_chunk[chunk] += Eigen::Array3d(by_width, by_depth, by_alpha);
  });
  for (const Eigen::Array3d& v : room.by_chunk) {
    gradients.shared_width_um += v[0];
    gradients.shared_depth_um += v[1];
    gradients.shared_alpha += v[2];
  }
}

void FastView::add_contributions(std::vector<double>& contribution) const {
  const Data& d = *data_;
  RenderRoom& room = *d.room;
  if (room.owner != this)
    fail("ViewRenderer::add_contributions", "another view has been rendered in the same room since",
         "call add_contributions() before the next view's forward()");
  // Light is not kept pair by pair: it is found again, tile by tile.
  std::vector<float>& by_run = room.by_run[0];
  if (by_run.size() < room.runs.total()) by_run.resize(room.runs.total());
  tbb::parallel_for(std::size_t{0}, d.index.tiles().size(), [&](std::size_t t) {
    RenderRoom::Work& w = *room.work.local();
    TileTask task = d.task_of(t);
    task.mode = KernelMode::value;
    task.keep_light = true;
    d.kernels.evaluate(task, w.tile, w.pairs);
    for (std::uint32_t r = 0; r < task.run_count; ++r) {
      double sum = 0;
      for (std::uint32_t k = w.pairs.begin[r]; k < w.pairs.begin[r + 1]; ++k) {
        const std::size_t i = t * kTilePixels + w.pairs.place[k];
        double weight = 0;
        for (int c = 0; c < d.channels; ++c) weight += d.factor[i * d.channels + c];
        sum += weight / d.channels * d.inv_area[i] * w.pairs.light[k];
      }
      by_run[room.runs.begin(t) + r] = static_cast<float>(sum);
    }
  });
  room.runs.each_scratch([&](std::size_t, std::uint32_t s, std::span<const std::uint32_t> runs) {
    for (const std::uint32_t r : runs) contribution[s] += by_run[r];
  });
}

}  // namespace burin
