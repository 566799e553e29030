#include "render/fast_view.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "render/error.h"
#include "render/exact_view.h"
#include "render/groove.h"
#include "render/pixel_shading.h"

namespace burin {
namespace {

constexpr int kTile = 32;
constexpr int kTilePixels = kTile * kTile;
/// Scratches are handed to threads in at most this many parts, whatever the number of threads.
constexpr std::size_t kMostChunks = 64;
constexpr std::size_t kLeastChunk = 256;

/// What a pair needs of its pixel, in one cache line.
struct alignas(64) PixelRecord {
  std::array<float, 4> x{}, y{};  // counter-clockwise, mm from the tile's origin
  float h_x = 0, h_y = 0, h_z = 1;
  float tan2_i = 0, tan2_o = 0;
};

/// What a pair needs of its scratch, in double.
struct ScratchLine {
  std::uint32_t id = 0;  // place among the caller's scratches
  float rim = 0, alpha = 0;
  Eigen::Vector2d p0{0, 0}, x{1, 0};  // y along it is (-x.y, x.x)
  double per_mm = 0, length_mm = 0;
  double width_um = 0, depth_um = 0;

  Eigen::Vector2d y() const { return {-x.y(), x.x()}; }
};

/// Pixels of one tile's row that a scratch touches: local places offset .. offset + count - 1.
struct TileSpan {
  std::uint32_t tile, line;
  std::uint16_t offset, count;
};

struct Run {
  std::uint32_t line = 0, pair_begin = 0, pair_count = 0;  // pairs counted from the tile's first
};

/// By its scratch's ends and material.
struct RunGradient {
  Eigen::Vector2d p0{0, 0}, p1{0, 0};
  double width_um = 0, depth_um = 0, alpha = 0;
};

/// A pair that an end may bound, and its derivatives by the ends moved along.
struct EndPair {
  std::uint32_t pair;
  std::array<float, 4> by_end;  // light: first, second; area: first, second
};

/// dE / d(Dhat G) and dE / d(groove area) of a pixel.
struct PixelWeight {
  float light = 0, area = 0;
};

struct Tile {
  Eigen::Vector2d origin{0, 0};
  std::size_t span_begin = 0, run_begin = 0, pair_begin = 0;
  std::size_t span_end = 0, run_end = 0, pair_end = 0;
};

struct Counts {
  std::uint32_t spans = 0, runs = 0, pairs = 0;
};

struct Chunk {
  std::vector<PixelSpan> found;
  std::vector<TileSpan> spans;
  std::vector<Counts> counts;         // by tile; then where this chunk's share begins in the tile
  std::vector<std::uint32_t> latest;  // by tile: the line whose run is open, plus one
};

struct Workspace {
  PairBatch batch;
  std::array<std::uint16_t, PairBatch::kCapacity> place;
  std::array<float, kTilePixels> light, area;
};

std::uint32_t interleave(std::uint32_t v) {
  v &= 0xffff;
  v = (v | (v << 8)) & 0x00ff00ff;
  v = (v | (v << 4)) & 0x0f0f0f0f;
  v = (v | (v << 2)) & 0x33333333;
  return (v | (v << 1)) & 0x55555555;
}

}  // namespace

struct FastView::Data {
  const ViewScene& scene;
  const PixelIndex& index;
  const int channels;
  const BatchKernel kernel;
  int tiles_x = 0, tiles_y = 0;

  // By tile * kTilePixels + place in the tile.
  std::vector<PixelRecord> records;
  std::vector<float> inv_area, base, base_slope, ambient_on;
  std::vector<float> factor;  // channels a pixel: F intensity direct
  std::vector<float> covered;
  std::array<float, 3> ambient{};
  Eigen::Vector2d low{0, 0}, high{1, 1};  // of the footprints

  // Of the last forward().
  BatchMode mode = BatchMode::value;
  std::vector<std::uint64_t> keys, keys_room;
  std::vector<ScratchLine> lines;
  std::vector<Chunk> chunks;
  std::vector<Tile> tiles;
  std::vector<TileSpan> spans;
  std::vector<Run> runs;
  std::size_t pair_count = 0;
  std::vector<std::uint16_t> pair_place;
  std::vector<float> pair_light;
  std::vector<Eigen::Array4f> pair_ends;      // light: shift, turn; area: shift, turn
  std::vector<Eigen::Array4f> pair_material;  // light: width, alpha, rim; area: rim
  std::vector<std::vector<EndPair>> ends;     // by tile
  tbb::enumerable_thread_specific<std::unique_ptr<Workspace>> workspaces{[] { return std::make_unique<Workspace>(); }};

  Data(const ViewScene& s, const PixelIndex& i, int c, SimdWidth width)
      : scene(s), index(i), channels(c), kernel(batch_kernel(width)) {}

  void make_tiles();
  void make_lines(const Scratches& scratches);
  void sort_spans();
  void render_tile(std::size_t t, Image& radiance);
  void finish_batch(Workspace& w, Tile& tile, std::size_t pair, std::vector<EndPair>& tile_ends);
  /// visit(x, y of the picture, index by tile and place) for the pixels of a tile.
  template <typename Visit>
  void each_pixel(std::size_t t, const Visit& visit) const {
    const int x0 = static_cast<int>(t % tiles_x) * kTile, y0 = static_cast<int>(t / tiles_x) * kTile;
    const int x1 = std::min(x0 + kTile, scene.grid.width()), y1 = std::min(y0 + kTile, scene.grid.height());
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) visit(x, y, t * kTilePixels + (y - y0) * kTile + (x - x0));
  }
};

void FastView::Data::make_tiles() {
  const FootprintGrid& grid = scene.grid;
  tiles_x = (grid.width() + kTile - 1) / kTile;
  tiles_y = (grid.height() + kTile - 1) / kTile;
  tiles.resize(static_cast<std::size_t>(tiles_x) * tiles_y);
  ends.resize(tiles.size());
  const std::size_t n = tiles.size() * kTilePixels;
  records.resize(n);
  inv_area.assign(n, 0);
  base.assign(n, 0);
  base_slope.assign(n, 0);
  ambient_on.assign(n, 0);
  covered.assign(n, 0);
  factor.assign(n * channels, 0);
  const std::array<double, 3> a = ambient_radiance(scene, channels);
  for (int c = 0; c < 3; ++c) ambient[c] = static_cast<float>(a[c]);

  std::vector<Eigen::Vector2d> tile_low(tiles.size(), Eigen::Vector2d::Constant(1e300)),
      tile_high(tiles.size(), Eigen::Vector2d::Constant(-1e300));
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
    each_pixel(t, [&](int x, int y, std::size_t) {
      if (!index.has_footprint()[static_cast<std::size_t>(y) * grid.width() + x]) return;
      for (const Eigen::Vector2d& q : footprint_corners_mm(grid, x, y)) {
        tile_low[t] = tile_low[t].cwiseMin(q);
        tile_high[t] = tile_high[t].cwiseMax(q);
      }
    });
    if (!(tile_low[t].x() <= tile_high[t].x())) return;
    tiles[t].origin = 0.5 * (tile_low[t] + tile_high[t]);
    each_pixel(t, [&](int x, int y, std::size_t i) {
      const std::size_t pixel = static_cast<std::size_t>(y) * grid.width() + x;
      if (!index.has_footprint()[pixel]) return;
      auto q = footprint_corners_mm(grid, x, y);
      const double area = signed_area_mm2(q);
      if (area < 0) std::swap(q[1], q[3]);
      const PixelShading p = shade_pixel(scene, pixel);
      if (!p.visible) return;
      ambient_on[i] = 1;
      if (!p.lit) return;
      PixelRecord& r = records[i];
      for (int k = 0; k < 4; ++k) {
        r.x[k] = static_cast<float>(q[k].x() - tiles[t].origin.x());
        r.y[k] = static_cast<float>(q[k].y() - tiles[t].origin.y());
      }
      r.h_x = static_cast<float>(p.h_face.x());
      r.h_y = static_cast<float>(p.h_face.y());
      r.h_z = static_cast<float>(p.h_face.z());
      r.tan2_i = static_cast<float>((1 - p.cos_i * p.cos_i) / (p.cos_i * p.cos_i));
      r.tan2_o = static_cast<float>((1 - p.cos_o * p.cos_o) / (p.cos_o * p.cos_o));
      inv_area[i] = static_cast<float>(1 / std::abs(area));
      base[i] = static_cast<float>(p.base);
      const Shadowing g = shadowing(p.cos_i, p.cos_o, scene.material.base_alpha);
      const BaseLobe lobe = base_lobe(p.h_face.z(), scene.material.base_alpha);
      base_slope[i] = static_cast<float>(lobe.dD_dalpha * g.G + lobe.D * g.dG_dalpha);
      const std::array<double, 3> f = channel_factors(scene, p.cos_ho, channels);
      for (int c = 0; c < channels; ++c) factor[i * channels + c] = static_cast<float>(f[c] * p.direct);
    });
  });
  low.setConstant(1e300);
  high.setConstant(-1e300);
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    low = low.cwiseMin(tile_low[t]);
    high = high.cwiseMax(tile_high[t]);
  }
}

/// Frames of all scratches, in the order of a Morton curve through their middles (ties by place).
void FastView::Data::make_lines(const Scratches& s) {
  const std::size_t n = s.size();
  keys.resize(n);
  keys_room.resize(n);
  const Eigen::Vector2d scale = 65535 * (high - low).cwiseMax(1e-300).cwiseInverse();
  for (std::size_t i = 0; i < n; ++i) {
    const double u = (0.5 * (s.x0_mm[i] + s.x1_mm[i]) - low.x()) * scale.x();
    const double v = (0.5 * (s.y0_mm[i] + s.y1_mm[i]) - low.y()) * scale.y();
    const auto quantised = [](double q) { return static_cast<std::uint32_t>(std::clamp(q, 0.0, 65535.0)); };
    keys[i] = (static_cast<std::uint64_t>(interleave(quantised(u)) | (interleave(quantised(v)) << 1)) << 32) | i;
  }
  // Radix sort by the curve's 32 bits, 11 at a time; stable, so ties stay in place order.
  for (const int shift : {32, 43, 54}) {
    std::array<std::size_t, 2049> begin{};
    for (const std::uint64_t key : keys) ++begin[((key >> shift) & 2047) + 1];
    for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
    for (const std::uint64_t key : keys) keys_room[begin[(key >> shift) & 2047]++] = key;
    keys.swap(keys_room);
  }
  lines.resize(n);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 1024), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t k = range.begin(); k < range.end(); ++k) {
      const auto i = static_cast<std::uint32_t>(keys[k]);
      ScratchLine& l = lines[k];
      l.id = i;
      l.width_um = s.width_um.empty() ? scene.tool_width_um : s.width_um[i];
      l.depth_um = s.depth_um.empty() ? scene.material.depth_um : s.depth_um[i];
      l.alpha = static_cast<float>(std::min(1.0, s.alpha.empty() ? scene.material.alpha : s.alpha[i]));
      l.rim = static_cast<float>(groove_rim(l.width_um, l.depth_um));
      l.per_mm = 2000 / l.width_um;
      l.p0 = {s.x0_mm[i], s.y0_mm[i]};
      const Eigen::Vector2d d = Eigen::Vector2d(s.x1_mm[i], s.y1_mm[i]) - l.p0;
      l.length_mm = d.norm();
      l.x = l.length_mm > 0 ? Eigen::Vector2d(d.y(), -d.x()) / l.length_mm : Eigen::Vector2d(1, 0);
    }
  });
}

/// Spans of all scratches, by tile and within a tile by line.
void FastView::Data::sort_spans() {
  const std::size_t n = lines.size();
  const std::size_t chunk_count = std::clamp<std::size_t>((n + kLeastChunk - 1) / kLeastChunk, 1, kMostChunks);
  chunks.resize(chunk_count);
  tbb::parallel_for(std::size_t{0}, chunk_count, [&](std::size_t c) {
    Chunk& chunk = chunks[c];
    chunk.spans.clear();
    chunk.counts.assign(tiles.size(), {});
    chunk.latest.assign(tiles.size(), 0);
    for (std::size_t k = n * c / chunk_count; k < n * (c + 1) / chunk_count; ++k) {
      const ScratchLine& l = lines[k];
      if (!(l.length_mm > 0)) continue;
      chunk.found.clear();
      index.find({l.p0, l.p0 + l.length_mm * l.y(), l.rim / l.per_mm}, chunk.found);
      for (const PixelSpan& span : chunk.found) {
        const int row = span.row / kTile, in_row = span.row % kTile;
        for (int begin = span.begin; begin < span.end;) {
          const int column = begin / kTile, end = std::min(span.end, (column + 1) * kTile);
          const auto tile = static_cast<std::uint32_t>(row * tiles_x + column);
          const auto count = static_cast<std::uint16_t>(end - begin);
          chunk.spans.push_back(
              {tile, static_cast<std::uint32_t>(k), static_cast<std::uint16_t>(in_row * kTile + begin % kTile), count});
          Counts& counts = chunk.counts[tile];
          ++counts.spans;
          counts.pairs += count;
          if (chunk.latest[tile] != k + 1) {
            chunk.latest[tile] = static_cast<std::uint32_t>(k + 1);
            ++counts.runs;
          }
          begin = end;
        }
      }
    }
  });

  std::size_t span = 0, run = 0, pair = 0;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    Tile& tile = tiles[t];
    tile.span_begin = span;
    tile.run_begin = run;
    tile.pair_begin = pair;
    for (Chunk& chunk : chunks) {
      const Counts counts = chunk.counts[t];
      chunk.counts[t].spans = static_cast<std::uint32_t>(span - tile.span_begin);
      span += counts.spans;
      run += counts.runs;
      pair += counts.pairs;
    }
    tile.span_end = span;
    tile.run_end = run;
    tile.pair_end = pair;
  }
  spans.resize(span);
  runs.resize(run);
  pair_count = pair;
  tbb::parallel_for(std::size_t{0}, chunk_count, [&](std::size_t c) {
    Chunk& chunk = chunks[c];
    for (const TileSpan& s : chunk.spans) spans[tiles[s.tile].span_begin + chunk.counts[s.tile].spans++] = s;
  });
}

/// Runs the kernel on what the workspace's batch holds; `pair` is where its first pair goes.
void FastView::Data::finish_batch(Workspace& w, Tile& tile, std::size_t pair, std::vector<EndPair>& tile_ends) {
  PairBatch& b = w.batch;
  kernel(b, mode);
  for (int k = 0; k < b.count; ++k) {
    w.light[w.place[k]] += b.light[k];
    w.area[w.place[k]] += b.area[k];
  }
  std::memcpy(&pair_place[pair], w.place.data(), b.count * sizeof(std::uint16_t));
  std::memcpy(&pair_light[pair], b.light, b.count * sizeof(float));
  if (mode != BatchMode::value) {
    for (int k = 0; k < b.count; ++k)
      pair_ends[pair + k] = {b.light_shift[k], b.light_turn[k], b.area_shift[k], b.area_turn[k]};
    for (int k = 0; k < b.end_count; ++k)
      tile_ends.push_back({static_cast<std::uint32_t>(pair - tile.pair_begin + b.end_lane[k]),
                           {b.light_first[k], b.light_second[k], b.area_first[k], b.area_second[k]}});
  }
  if (mode == BatchMode::material)
    for (int k = 0; k < b.count; ++k)
      pair_material[pair + k] = {b.light_width[k], b.light_alpha[k], b.light_rim[k], b.area_rim[k]};
  b.count = 0;
}

void FastView::Data::render_tile(std::size_t t, Image& radiance) {
  Workspace& w = *workspaces.local();
  PairBatch& b = w.batch;
  Tile& tile = tiles[t];
  std::vector<EndPair>& tile_ends = ends[t];
  tile_ends.clear();
  w.light.fill(0);
  w.area.fill(0);
  b.count = 0;

  std::size_t pair = tile.pair_begin, run = tile.run_begin;
  int filled = 0;  // lanes whose scratch is in place
  std::array<float, 8> constants{};
  const std::array<float*, 8> targets{b.across_x,  b.across_y,   b.per_mm, b.t_origin,
                                      b.first_end, b.second_end, b.alpha,  b.rim};
  const auto fill_scratch = [&] {
    // Whole vectors of 16; what they write too far is written again.
    for (std::size_t c = 0; c < constants.size(); ++c)
      for (int k = filled; k < b.count; k += 16)
        Eigen::Map<Eigen::Array<float, 16, 1>>(targets[c] + k).setConstant(constants[c]);
    filled = b.count;
  };
  // Pixels are met in no order: have the tile near before the first is needed.
  const PixelRecord* tile_records = &records[t * kTilePixels];
  for (int k = 0; k < kTilePixels; ++k) __builtin_prefetch(tile_records + k);
  constexpr std::size_t kAhead = 12;  // spans
  std::uint32_t line = ~0U;
  std::size_t written = pair;
  for (std::size_t s = tile.span_begin; s < tile.span_end; ++s) {
    const TileSpan& span = spans[s];
    if (s + kAhead < tile.span_end) {
      const auto* next = reinterpret_cast<const char*>(&lines[spans[s + kAhead].line]);
      __builtin_prefetch(next);
      __builtin_prefetch(next + 64);
    }
    if (span.line != line) {
      fill_scratch();
      line = span.line;
      const ScratchLine& l = lines[line];
      const Eigen::Vector2d o = tile.origin - l.p0;
      const double foot_mm = l.y().dot(o);
      constants = {static_cast<float>(l.x.x()),
                   static_cast<float>(l.x.y()),
                   static_cast<float>(l.per_mm),
                   static_cast<float>(l.per_mm * l.x.dot(o)),
                   static_cast<float>(-l.per_mm * foot_mm),
                   static_cast<float>(l.per_mm * (l.length_mm - foot_mm)),
                   l.alpha,
                   l.rim};
      runs[run++] = {line, static_cast<std::uint32_t>(pair - tile.pair_begin), 0};
    }
    runs[run - 1].pair_count += span.count;
    for (int k = 0; k < span.count; ++k) {
      if (b.count == PairBatch::kCapacity) {
        fill_scratch();
        finish_batch(w, tile, written, tile_ends);
        written = pair;
        filled = 0;
      }
      const int n = b.count++;
      const std::uint16_t place = static_cast<std::uint16_t>(span.offset + k);
      const PixelRecord& r = tile_records[place];
      w.place[n] = place;
      for (int q = 0; q < 4; ++q) {
        b.x[q][n] = r.x[q];
        b.y[q][n] = r.y[q];
      }
      b.h_x[n] = r.h_x;
      b.h_y[n] = r.h_y;
      b.h_z[n] = r.h_z;
      b.tan2_i[n] = r.tan2_i;
      b.tan2_o[n] = r.tan2_o;
      ++pair;
    }
  }
  fill_scratch();
  if (b.count > 0) finish_batch(w, tile, written, tile_ends);

  each_pixel(t, [&](int x, int y, std::size_t i) {
    const std::size_t place = i - t * kTilePixels;
    const float c = w.area[place] * inv_area[i];
    covered[i] = c;
    const float lobes = w.light[place] * inv_area[i] + (1 - std::min(1.0F, c)) * base[i];
    float* out = &radiance.data[(static_cast<std::size_t>(y) * radiance.width + x) * channels];
    for (int k = 0; k < channels; ++k) out[k] = factor[i * channels + k] * lobes + ambient_on[i] * ambient[k];
  });
}

FastView::FastView(const ViewScene& scene, const PixelIndex& index, int channels, SimdWidth width)
    : data_(std::make_unique<Data>(scene, index, channels, width)) {
  check_view(scene, channels);
  data_->make_tiles();
}

FastView::~FastView() = default;

std::size_t FastView::pair_count() const { return data_->pair_count; }

void FastView::forward(const Scratches& scratches, BatchMode mode, Image& radiance) {
  Data& d = *data_;
  d.mode = mode;
  if (radiance.width != d.scene.grid.width() || radiance.height != d.scene.grid.height() ||
      radiance.channels != d.channels)
    radiance = Image(d.scene.grid.width(), d.scene.grid.height(), d.channels);
  d.make_lines(scratches);
  d.sort_spans();
  d.pair_place.resize(d.pair_count);
  d.pair_light.resize(d.pair_count);
  d.pair_ends.resize(mode == BatchMode::value ? 0 : d.pair_count);
  d.pair_material.resize(mode == BatchMode::material ? d.pair_count : 0);
  tbb::parallel_for(std::size_t{0}, d.tiles.size(), [&](std::size_t t) { d.render_tile(t, radiance); });
}

void FastView::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  const Data& d = *data_;
  if (d.mode == BatchMode::value)
    fail("ViewRenderer::backward", "there is no Jacobian", "call forward_with_jacobian() first");
  std::vector<RunGradient> by_run(d.runs.size());
  std::vector<double> by_base_alpha(d.tiles.size(), 0);
  tbb::parallel_for(std::size_t{0}, d.tiles.size(), [&](std::size_t t) {
    const Tile& tile = d.tiles[t];
    std::array<PixelWeight, kTilePixels> weight;
    d.each_pixel(t, [&](int x, int y, std::size_t i) {
      const float* in = &dE_dradiance.data[(static_cast<std::size_t>(y) * dE_dradiance.width + x) * d.channels];
      float by_lobes = 0;
      for (int c = 0; c < d.channels; ++c) by_lobes += in[c] * d.factor[i * d.channels + c];
      const std::size_t place = i - t * kTilePixels;
      weight[place].light = by_lobes * d.inv_area[i];
      weight[place].area = d.covered[i] < 1 ? -by_lobes * d.base[i] * d.inv_area[i] : 0.0F;
      by_base_alpha[t] += static_cast<double>(by_lobes) * (1 - std::min(1.0F, d.covered[i])) * d.base_slope[i];
    });
    const std::vector<EndPair>& tile_ends = d.ends[t];
    std::size_t end = 0;
    for (std::size_t r = tile.run_begin; r < tile.run_end; ++r) {
      const Run& run = d.runs[r];
      const ScratchLine& l = d.lines[run.line];
      Eigen::Array4f sum = Eigen::Array4f::Zero(), material = Eigen::Array4f::Zero();
      for (std::size_t k = tile.pair_begin + run.pair_begin; k < tile.pair_begin + run.pair_begin + run.pair_count;
           ++k) {
        const float wl = weight[d.pair_place[k]].light, wa = weight[d.pair_place[k]].area;
        sum += Eigen::Array4f(wl, wl, wa, wa) * d.pair_ends[k];
        if (d.mode == BatchMode::material) material += Eigen::Array4f(wl, wl, wl, wa) * d.pair_material[k];
      }
      double by_first = 0, by_second = 0;
      for (; end < tile_ends.size() && tile_ends[end].pair < run.pair_begin + run.pair_count; ++end) {
        const PixelWeight& w = weight[d.pair_place[tile.pair_begin + tile_ends[end].pair]];
        const std::array<float, 4>& e = tile_ends[end].by_end;
        by_first += w.light * e[0] + w.area * e[2];
        by_second += w.light * e[1] + w.area * e[3];
      }
      const double shift = (static_cast<double>(sum[0]) + sum[2]) * l.per_mm;
      const double turn = (static_cast<double>(sum[1]) + sum[3]) / l.length_mm;
      const double foot = l.y().dot(tile.origin - l.p0) / l.length_mm;
      RunGradient& g = by_run[r];
      g.p0 = l.x * (shift * (1 - foot) + turn) + l.y() * (by_first * l.per_mm);
      g.p1 = l.x * (shift * foot - turn) + l.y() * (by_second * l.per_mm);
      if (d.mode == BatchMode::material) {
        const double rim_by_depth = std::exp(-2 * l.depth_um / l.width_um) / (l.width_um * l.rim);
        const double rims = static_cast<double>(material[2]) + material[3];
        g.depth_um = rim_by_depth * rims;
        g.width_um = (material[0] + l.rim * material[3] - l.depth_um * rim_by_depth * rims) / l.width_um;
        g.alpha = material[1];
      }
    }
  });

  for (const double v : by_base_alpha) gradients.shared_base_alpha += v;
  // Runs come in tile order; each scratch's are added up in that order.
  for (std::size_t r = 0; r < d.runs.size(); ++r) {
    const RunGradient& g = by_run[r];
    const std::uint32_t s = d.lines[d.runs[r].line].id;
    gradients.x0_mm[s] += g.p0.x();
    gradients.y0_mm[s] += g.p0.y();
    gradients.x1_mm[s] += g.p1.x();
    gradients.y1_mm[s] += g.p1.y();
    if (d.mode != BatchMode::material) continue;
    gradients.width_um[s] += g.width_um;
    gradients.depth_um[s] += g.depth_um;
    gradients.alpha[s] += g.alpha;
    gradients.shared_width_um += g.width_um;
    gradients.shared_depth_um += g.depth_um;
    gradients.shared_alpha += g.alpha;
  }
}

void FastView::add_contributions(std::vector<double>& contribution) const {
  const Data& d = *data_;
  for (const Tile& tile : d.tiles) {
    const std::size_t t = &tile - d.tiles.data();
    for (std::size_t r = tile.run_begin; r < tile.run_end; ++r) {
      const Run& run = d.runs[r];
      double sum = 0;
      for (std::size_t k = tile.pair_begin + run.pair_begin; k < tile.pair_begin + run.pair_begin + run.pair_count;
           ++k) {
        const std::size_t i = t * kTilePixels + d.pair_place[k];
        double weight = 0;
        for (int c = 0; c < d.channels; ++c) weight += d.factor[i * d.channels + c];
        sum += weight / d.channels * d.inv_area[i] * d.pair_light[k];
      }
      contribution[d.lines[run.line].id] += sum;
    }
  }
}

}  // namespace burin
