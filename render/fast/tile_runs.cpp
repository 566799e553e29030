#include "burin/render/fast/tile_runs.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "burin/base/machine_clones.h"
#include "burin/render/fast/grow.h"

namespace burin {
namespace {

constexpr int kBlock = 256;  // scratches per block: plain loops over arrays, which the compiler vectorizes

/// Zero for a scratch without length.
BURIN_MACHINE_CLONES void find_directions(const double* x0, const double* y0, const double* x1, const double* y1, int n,
                                          StripDirection* across) {
  for (int i = 0; i < n; ++i) {
    const double dx = x1[i] - x0[i], dy = y1[i] - y0[i];
    const double length = std::sqrt(dx * dx + dy * dy);
    const double per_length = length > 0 ? 1 / length : 0;
    across[i] = {dy * per_length, -dx * per_length, length};
  }
}

/// A block of scratches as input of its boxes.
struct BlockLines {
  const double *x0, *y0, *x1, *y1;
  const StripDirection* across;
  const double* half;  ///< half widths, mm
  int n;
};

/// Boxes around a block's scratches in pixels.
struct PixelBoxes {
  alignas(64) double u_low[kBlock], u_high[kBlock], v_low[kBlock], v_high[kBlock];
  bool good[kBlock];  // false: only PixelIndex::find_tiles() can find the tiles
};

BURIN_MACHINE_CLONES void affine_boxes(const GridMap& map, const BlockLines& l, PixelBoxes& box) {
  const double* const H = map.lattice_from_board.data();  // column by column
  for (int i = 0; i < l.n; ++i) {
    const double ua = H[0] * l.x0[i] + H[3] * l.y0[i], ub = H[0] * l.x1[i] + H[3] * l.y1[i];
    const double va = H[1] * l.x0[i] + H[4] * l.y0[i], vb = H[1] * l.x1[i] + H[4] * l.y1[i];
    const double pad_u = std::abs(H[0] * l.across[i].x + H[3] * l.across[i].y) * l.half[i];
    const double pad_v = std::abs(H[1] * l.across[i].x + H[4] * l.across[i].y) * l.half[i];
    box.u_low[i] = std::min(ua, ub) - pad_u + H[6];
    box.u_high[i] = std::max(ua, ub) + pad_u + H[6];
    box.v_low[i] = std::min(va, vb) - pad_v + H[7];
    box.v_high[i] = std::max(va, vb) + pad_v + H[7];
  }
  std::fill_n(box.good, l.n, map.exists);
}

BURIN_MACHINE_CLONES void perspective_boxes(const GridMap& map, const BlockLines& l, PixelBoxes& box) {
  const double* const H = map.lattice_from_board.data();
  for (int i = 0; i < l.n; ++i) {
    const double qx = (H[0] * l.across[i].x + H[3] * l.across[i].y) * l.half[i];
    const double qy = (H[1] * l.across[i].x + H[4] * l.across[i].y) * l.half[i];
    const double qw = (H[2] * l.across[i].x + H[5] * l.across[i].y) * l.half[i];
    const double ua = H[0] * l.x0[i] + H[3] * l.y0[i] + H[6], ub = H[0] * l.x1[i] + H[3] * l.y1[i] + H[6];
    const double va = H[1] * l.x0[i] + H[4] * l.y0[i] + H[7], vb = H[1] * l.x1[i] + H[4] * l.y1[i] + H[7];
    const double wa = H[2] * l.x0[i] + H[5] * l.y0[i] + H[8], wb = H[2] * l.x1[i] + H[5] * l.y1[i] + H[8];
    box.good[i] = map.exists && std::min(wa, wb) - std::abs(qw) > 0.5 * map.w_min;
    // The four corners.
    const double w1 = 1 / (wa - qw), w2 = 1 / (wa + qw), w3 = 1 / (wb - qw), w4 = 1 / (wb + qw);
    const double u1 = (ua - qx) * w1, u2 = (ua + qx) * w2, u3 = (ub - qx) * w3, u4 = (ub + qx) * w4;
    const double v1 = (va - qy) * w1, v2 = (va + qy) * w2, v3 = (vb - qy) * w3, v4 = (vb + qy) * w4;
    box.u_low[i] = std::min(std::min(u1, u2), std::min(u3, u4));
    box.u_high[i] = std::max(std::max(u1, u2), std::max(u3, u4));
    box.v_low[i] = std::min(std::min(v1, v2), std::min(v3, v4));
    box.v_high[i] = std::max(std::max(v1, v2), std::max(v3, v4));
  }
}

/// These boxes in tiles, cut to the grid. Empty (high below low) for a scratch off the grid.
struct TileBoxes {
  alignas(64) int column0[kBlock], column1[kBlock], row0[kBlock], row1[kBlock];
};

BURIN_MACHINE_CLONES void tile_boxes(const PixelBoxes& in, int n, double pad_px, double columns, double rows,
                                     TileBoxes& out) {
  constexpr double kPerTile = 1.0 / kTile;
  const double pad = pad_px * kPerTile;
  // Clamped first (NaN to the lower limit), so that a cast rounds down. Positions off the grid give a box without
  // tiles.
  for (int i = 0; i < n; ++i) {
    out.column0[i] = static_cast<int>(std::min(std::max(0.0, in.u_low[i] * kPerTile - pad), columns));
    out.column1[i] = static_cast<int>(std::min(std::max(-1.0, in.u_high[i] * kPerTile + pad), columns - 0.5) + 1) - 1;
    out.row0[i] = static_cast<int>(std::min(std::max(0.0, in.v_low[i] * kPerTile - pad), rows));
    out.row1[i] = static_cast<int>(std::min(std::max(-1.0, in.v_high[i] * kPerTile + pad), rows - 0.5) + 1) - 1;
  }
}

}  // namespace

void TileRuns::find_tiles(const PixelIndex& index, const ScratchLines& lines, Chunk& chunk) {
  const std::span<const GridTile> tiles = index.tiles();
  chunk.counts.assign(tiles.size(), 0);
  chunk.touched.reserve(tiles.size());  // upper bound for one scratch
  chunk.entry_count = 0;
  const auto make_room = [&](std::size_t more) {
    if (chunk.entries.size() < chunk.entry_count + more) chunk.entries.resize(2 * chunk.entry_count + more + kBlock);
  };
  // No branch: the next entry overwrites an invalid one.
  const auto add = [&](std::size_t scratch, std::uint32_t tile, bool really) {
    const std::uint32_t one = really && tiles[tile].block_begin != tiles[tile].block_end ? 1 : 0;
    chunk.entries[chunk.entry_count] = {tile, static_cast<std::uint32_t>(scratch)};
    chunk.counts[tile] += one;
    chunk.entry_count += one;
  };
  PixelBoxes pixels;
  TileBoxes boxes;
  alignas(64) double half[kBlock];
  for (std::size_t first = chunk.first; first < chunk.last; first += kBlock) {
    const int n = static_cast<int>(std::min<std::size_t>(kBlock, chunk.last - first));
    StripDirection* across = &across_[first];
    const BlockLines block{
        lines.x0_mm + first, lines.y0_mm + first, lines.x1_mm + first, lines.y1_mm + first, across, half, n};
    find_directions(block.x0, block.y0, block.x1, block.y1, n, across);
    for (int i = 0; i < n; ++i) half[i] = lines.rim[first + i] / lines.per_mm[first + i];
    if (index.map().affine)
      affine_boxes(index.map(), block, pixels);
    else
      perspective_boxes(index.map(), block, pixels);
    tile_boxes(pixels, n, index.map().error_px, index.tiles_x(), index.tiles_y(), boxes);
    for (int i = 0; i < n; ++i) {
      if (!(across[i].length_mm > 0)) continue;
      const std::size_t s = first + i;
      const int columns = boxes.column1[i] - boxes.column0[i] + 1, rows = boxes.row1[i] - boxes.row0[i] + 1;
      if (pixels.good[i] && std::min(columns, rows) <= 1) {
        if (std::min(columns, rows) <= 0) continue;
        // A row or a column of tiles, seldom more than two.
        const int count = columns * rows;
        const auto at = static_cast<std::uint32_t>(boxes.row0[i] * index.tiles_x() + boxes.column0[i]);
        const auto step = static_cast<std::uint32_t>(rows == 1 ? 1 : index.tiles_x());
        make_room(static_cast<std::size_t>(count) + 1);
        add(s, at, true);
        add(s, count > 1 ? at + step : at, count > 1);
        for (int k = 2; k < count; ++k) add(s, at + static_cast<std::uint32_t>(k) * step, true);
        continue;
      }
      chunk.touched.clear();
      index.find_tiles({lines.x0_mm[s], lines.y0_mm[s]}, {lines.x1_mm[s], lines.y1_mm[s]},
                       {across[i].x * half[i], across[i].y * half[i]}, chunk.touched);
      make_room(chunk.touched.size());
      for (const std::uint32_t t : chunk.touched) add(s, t, true);
    }
  }
  if (chunk.slots.size() < chunk.entry_count) chunk.slots.resize(chunk.entries.size());
}

void TileRuns::make_runs(const PixelIndex& index, const ScratchLines& lines, Chunk& chunk) {
  const std::span<const GridTile> tiles = index.tiles();
  for (std::size_t e = 0; e < chunk.entry_count; ++e) {
    const Entry& entry = chunk.entries[e];
    const std::size_t s = entry.scratch;
    const StripDirection& across = across_[s];
    const Eigen::Vector2d& origin = tiles[entry.tile].origin_mm;
    const double ox = origin.x() - lines.x0_mm[s], oy = origin.y() - lines.y0_mm[s];
    const double foot_mm = across.x * oy - across.y * ox;  // along is (-y, x)
    const float per_mm = lines.per_mm[s];
    const std::uint32_t slot = chunk.counts[entry.tile]++;
    chunk.slots[e] = slot;
    scratch_[slot] = entry.scratch;
    const double t_origin = per_mm * (across.x * ox + across.y * oy);
    const auto x = static_cast<float>(across.x), y = static_cast<float>(across.y), t = static_cast<float>(t_origin);
    runs_[slot] = {x,
                   y,
                   t,
                   static_cast<float>(-per_mm * foot_mm),
                   static_cast<float>(per_mm * (across.length_mm - foot_mm)),
                   static_cast<float>(across.x - x),
                   static_cast<float>(across.y - y),
                   static_cast<float>(t_origin - t)};
    if (!shared_shape_)
      shapes_[slot] = {per_mm, lines.rim[s], lines.alpha[s],
                       static_cast<float>(lines.part != nullptr ? lines.part[s] : 0)};
  }
}

void TileRuns::sort(const PixelIndex& index, const ScratchLines& lines) {
  const std::size_t tiles = index.tiles().size();
  across_.resize(lines.count);
  chunks_.resize(std::clamp<std::size_t>((lines.count + kLeastChunk - 1) / kLeastChunk, 1, kMostChunks));
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t c) {
    chunks_[c].first = lines.count * c / chunks_.size();
    chunks_[c].last = lines.count * (c + 1) / chunks_.size();
    find_tiles(index, lines, chunks_[c]);
  });
  begin_.resize(tiles + 1);
  std::uint32_t run = 0;
  for (std::size_t t = 0; t < tiles; ++t) {
    begin_[t] = run;
    for (Chunk& chunk : chunks_) {
      const std::uint32_t here = chunk.counts[t];
      chunk.counts[t] = run;
      run += here;
    }
  }
  begin_[tiles] = run;
  grow_to(runs_, run + 1);
  grow_to(scratch_, run + 1);
  shared_shape_ = lines.per_mm.shared && lines.rim.shared && lines.alpha.shared;
  grow_to(shapes_, shared_shape_ ? 1 : run + 1);
  if (shared_shape_ && lines.count > 0) shapes_[0] = {lines.per_mm[0], lines.rim[0], lines.alpha[0], 0};
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t c) { make_runs(index, lines, chunks_[c]); });
}

}  // namespace burin
