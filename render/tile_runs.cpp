#include "render/tile_runs.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace burin {
namespace {

constexpr int kBlock = 256;  // scratches that are worked on in one go: plain loops over arrays, which become vectors

/// Zero where a scratch has no length.
void find_directions(const ScratchLines& l, std::size_t first, std::size_t last, StripDirection* across) {
  for (std::size_t i = first; i < last; ++i) {
    const double dx = l.x1_mm[i] - l.x0_mm[i], dy = l.y1_mm[i] - l.y0_mm[i];
    const double length = std::sqrt(dx * dx + dy * dy);
    const double per_length = length > 0 ? 1 / length : 0;
    across[i] = {dy * per_length, -dx * per_length, length};
  }
}

/// Boxes around a block's scratches in units of tiles, cut to the grid. Empty (high below low) where one misses it.
struct TileBoxes {
  alignas(64) int column0[kBlock], column1[kBlock], row0[kBlock], row1[kBlock];
  bool good[kBlock];  // else only PixelIndex::find_tiles() knows

  void make(const PixelIndex& index, const ScratchLines& l, const StripDirection* across, std::size_t first, int n) {
    const GridMap& map = index.map();
    const Eigen::Matrix3d& H = map.lattice_from_board;
    const double *x0 = l.x0_mm + first, *y0 = l.y0_mm + first, *x1 = l.x1_mm + first, *y1 = l.y1_mm + first;
    alignas(64) double u_low[kBlock], u_high[kBlock], v_low[kBlock], v_high[kBlock], half[kBlock];
    for (int i = 0; i < n; ++i) half[i] = l.rim[first + i] / l.per_mm[first + i];
    const auto widen = [&](int i, double u, double v, double w, double side) {
      const double qx = H(0, 0) * across[i].x + H(0, 1) * across[i].y,
                   qy = H(1, 0) * across[i].x + H(1, 1) * across[i].y;
      const double qw = H(2, 0) * across[i].x + H(2, 1) * across[i].y;
      const double per_w = 1 / (w + side * qw);
      const double a = (u + side * qx) * per_w, b = (v + side * qy) * per_w;
      u_low[i] = std::min(u_low[i], a);
      u_high[i] = std::max(u_high[i], a);
      v_low[i] = std::min(v_low[i], b);
      v_high[i] = std::max(v_high[i], b);
    };
    if (map.affine) {
      for (int i = 0; i < n; ++i) {
        const double ua = H(0, 0) * x0[i] + H(0, 1) * y0[i], ub = H(0, 0) * x1[i] + H(0, 1) * y1[i];
        const double va = H(1, 0) * x0[i] + H(1, 1) * y0[i], vb = H(1, 0) * x1[i] + H(1, 1) * y1[i];
        const double pad_u = std::abs(H(0, 0) * across[i].x + H(0, 1) * across[i].y) * half[i];
        const double pad_v = std::abs(H(1, 0) * across[i].x + H(1, 1) * across[i].y) * half[i];
        u_low[i] = std::min(ua, ub) - pad_u + H(0, 2);
        u_high[i] = std::max(ua, ub) + pad_u + H(0, 2);
        v_low[i] = std::min(va, vb) - pad_v + H(1, 2);
        v_high[i] = std::max(va, vb) + pad_v + H(1, 2);
        good[i] = map.exists;
      }
    } else {
      for (int i = 0; i < n; ++i) {
        const double wa = H(2, 0) * x0[i] + H(2, 1) * y0[i] + H(2, 2), wb = H(2, 0) * x1[i] + H(2, 1) * y1[i] + H(2, 2);
        const double side = std::abs(H(2, 0) * across[i].x + H(2, 1) * across[i].y) * half[i];
        good[i] = map.exists && std::min(wa, wb) - side > 0.5 * map.w_min;
        u_low[i] = v_low[i] = 1e300;
        u_high[i] = v_high[i] = -1e300;
        for (const double s : {-half[i], half[i]}) {
          widen(i, H(0, 0) * x0[i] + H(0, 1) * y0[i] + H(0, 2), H(1, 0) * x0[i] + H(1, 1) * y0[i] + H(1, 2), wa, s);
          widen(i, H(0, 0) * x1[i] + H(0, 1) * y1[i] + H(0, 2), H(1, 0) * x1[i] + H(1, 1) * y1[i] + H(1, 2), wb, s);
        }
      }
    }
    // Clamped first, so that a cast rounds down: below the grid or beyond it gives a box without tiles.
    constexpr double kPerTile = 1.0 / kTile;
    const double pad = map.error_px * kPerTile, columns = index.tiles_x(), rows = index.tiles_y();
    for (int i = 0; i < n; ++i) {
      column0[i] = static_cast<int>(std::clamp(u_low[i] * kPerTile - pad, 0.0, columns));
      column1[i] = static_cast<int>(std::clamp(u_high[i] * kPerTile + pad, -1.0, columns - 0.5) + 1) - 1;
      row0[i] = static_cast<int>(std::clamp(v_low[i] * kPerTile - pad, 0.0, rows));
      row1[i] = static_cast<int>(std::clamp(v_high[i] * kPerTile + pad, -1.0, rows - 0.5) + 1) - 1;
    }
  }
};

}  // namespace

void TileRuns::find_tiles(const PixelIndex& index, const ScratchLines& lines, Chunk& chunk) {
  const std::span<const GridTile> tiles = index.tiles();
  chunk.entries.clear();
  chunk.counts.assign(tiles.size(), 0);
  const auto add = [&](std::size_t scratch, std::uint32_t tile) {
    if (tiles[tile].block_begin == tiles[tile].block_end) return;
    chunk.entries.push_back({tile, static_cast<std::uint32_t>(scratch)});
    ++chunk.counts[tile];
  };
  find_directions(lines, chunk.first, chunk.last, across_.data());
  TileBoxes boxes;
  for (std::size_t first = chunk.first; first < chunk.last; first += kBlock) {
    const int n = static_cast<int>(std::min<std::size_t>(kBlock, chunk.last - first));
    const StripDirection* across = &across_[first];
    boxes.make(index, lines, across, first, n);
    for (int i = 0; i < n; ++i) {
      if (!(across[i].length_mm > 0)) continue;
      const std::size_t s = first + i;
      const int columns = boxes.column1[i] - boxes.column0[i], rows = boxes.row1[i] - boxes.row0[i];
      if (boxes.good[i] && std::min(columns, rows) <= 0) {
        for (int row = boxes.row0[i]; row <= boxes.row1[i]; ++row)
          for (int column = boxes.column0[i]; column <= boxes.column1[i]; ++column)
            add(s, static_cast<std::uint32_t>(row * index.tiles_x() + column));
        continue;
      }
      chunk.touched.clear();
      const double half = lines.rim[s] / lines.per_mm[s];
      index.find_tiles({lines.x0_mm[s], lines.y0_mm[s]}, {lines.x1_mm[s], lines.y1_mm[s]},
                       {across[i].x * half, across[i].y * half}, chunk.touched);
      for (const std::uint32_t t : chunk.touched) add(s, t);
    }
  }
  chunk.slots.resize(chunk.entries.size());
}

void TileRuns::make_runs(const PixelIndex& index, const ScratchLines& lines, Chunk& chunk) {
  const std::span<const GridTile> tiles = index.tiles();
  for (std::size_t e = 0; e < chunk.entries.size(); ++e) {
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
    runs_[slot] = {static_cast<float>(across.x),
                   static_cast<float>(across.y),
                   per_mm,
                   static_cast<float>(per_mm * (across.x * ox + across.y * oy)),
                   static_cast<float>(-per_mm * foot_mm),
                   static_cast<float>(per_mm * (across.length_mm - foot_mm)),
                   lines.alpha[s],
                   lines.rim[s]};
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
  if (runs_.size() < run + 1) {
    runs_.resize(run + run / 4 + 1);
    scratch_.resize(runs_.size());
  }
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t c) { make_runs(index, lines, chunks_[c]); });
}

}  // namespace burin
