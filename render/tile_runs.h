// render/tile_runs.h - scratches sorted into the tiles of a grid: one run for each tile that a scratch may touch.
//
// A tile's runs are in the order of the scratches, and so is a scratch's list of runs in tile order, whatever the
// number of threads. Room is kept from one sort() to the next.
#pragma once

#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/pairs.h"
#include "render/tile.h"

namespace burin {

/// Where a scratch lies. Across it is x; along it, from its first end, (-x.y, x.x).
struct StripFrame {
  Eigen::Vector2d p0_mm{0, 0}, p1_mm{0, 0}, x{1, 0};
  double length_mm = 0;

  Eigen::Vector2d y() const { return {-x.y(), x.x()}; }
};
inline StripFrame strip_frame(const Eigen::Vector2d& p0_mm, const Eigen::Vector2d& p1_mm) {
  StripFrame f{p0_mm, p1_mm};
  const Eigen::Vector2d d = p1_mm - p0_mm;
  f.length_mm = d.norm();
  if (f.length_mm > 0) f.x = Eigen::Vector2d(d.y(), -d.x()) / f.length_mm;
  return f;
}

/// A scratch with its cross-section: per_mm is 2 / wt, |t| <= rim.
struct ScratchLine {
  StripFrame frame;
  double per_mm = 1;
  float rim = 1, alpha = 1;
};

/// A scratch as a tile sees it.
inline TileRun tile_run(const StripFrame& f, double per_mm, float rim, float alpha, const Eigen::Vector2d& origin_mm) {
  const Eigen::Vector2d o = origin_mm - f.p0_mm;
  const double foot_mm = f.y().dot(o);
  return {static_cast<float>(f.x.x()),
          static_cast<float>(f.x.y()),
          static_cast<float>(per_mm),
          static_cast<float>(per_mm * f.x.dot(o)),
          static_cast<float>(-per_mm * foot_mm),
          static_cast<float>(per_mm * (f.length_mm - foot_mm)),
          alpha,
          rim};
}

class TileRuns {
 public:
  /// line(i) gives scratch i of `count` as a ScratchLine; called from several threads.
  template <typename Line>
  void sort(const PixelIndex& index, std::size_t count, const Line& line);

  std::uint32_t count(std::size_t tile) const { return begin_[tile + 1] - begin_[tile]; }
  std::uint32_t begin(std::size_t tile) const { return begin_[tile]; }
  std::uint32_t total() const { return begin_.back(); }
  /// The runs of a tile; readable one beyond the last.
  const TileRun* of(std::size_t tile) const { return &runs_[begin_[tile]]; }
  std::uint32_t scratch(std::size_t tile, std::uint32_t run) const { return scratch_[begin_[tile] + run]; }

  std::size_t chunk_count() const { return chunks_.size(); }
  /// visit(chunk, scratch, numbers of its runs in tile order), chunks of scratches side by side. How scratches are
  /// divided into chunks depends on their number alone. Numbers count over all tiles.
  template <typename Visit>
  void each_scratch(const Visit& visit) const;

 private:
  /// Scratches are handed to threads in at most this many parts, whatever the number of threads.
  static constexpr std::size_t kMostChunks = 64, kLeastChunk = 256;

  struct Entry {
    std::uint32_t tile, scratch;
  };
  struct Chunk {
    std::vector<std::uint32_t> touched;
    std::vector<ScratchLine> lines;     // of this chunk's scratches
    std::vector<Entry> entries;         // in scratch order
    std::vector<std::uint32_t> slots;   // of the entries: number of the run
    std::vector<std::uint32_t> counts;  // by tile; then where this chunk's next run of the tile goes
    std::size_t first = 0, last = 0;
  };

  std::vector<Chunk> chunks_;
  std::vector<std::uint32_t> begin_;  // by tile, one more
  std::vector<TileRun> runs_;         // by tile, one more
  std::vector<std::uint32_t> scratch_;
};

template <typename Line>
void TileRuns::sort(const PixelIndex& index, std::size_t count, const Line& line) {
  const std::span<const GridTile> tiles = index.tiles();
  chunks_.resize(std::clamp<std::size_t>((count + kLeastChunk - 1) / kLeastChunk, 1, kMostChunks));
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t c) {
    Chunk& chunk = chunks_[c];
    chunk.first = count * c / chunks_.size();
    chunk.last = count * (c + 1) / chunks_.size();
    chunk.entries.clear();
    chunk.lines.clear();
    chunk.counts.assign(tiles.size(), 0);
    for (std::size_t i = chunk.first; i < chunk.last; ++i) {
      const ScratchLine& l = chunk.lines.emplace_back(line(i));
      chunk.touched.clear();
      index.find_tiles(l.frame.p0_mm, l.frame.p1_mm, l.frame.x * (l.rim / l.per_mm), chunk.touched);
      for (const std::uint32_t t : chunk.touched) {
        chunk.entries.push_back({t, static_cast<std::uint32_t>(i)});
        ++chunk.counts[t];
      }
    }
    chunk.slots.resize(chunk.entries.size());
  });

  begin_.resize(tiles.size() + 1);
  std::uint32_t run = 0;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    begin_[t] = run;
    for (Chunk& chunk : chunks_) {
      const std::uint32_t here = chunk.counts[t];
      chunk.counts[t] = run;
      run += here;
    }
  }
  begin_[tiles.size()] = run;
  if (runs_.size() < run + 1) {
    runs_.resize(run + run / 4 + 1);
    scratch_.resize(runs_.size());
  }
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t c) {
    Chunk& chunk = chunks_[c];
    for (std::size_t e = 0; e < chunk.entries.size(); ++e) {
      const Entry& entry = chunk.entries[e];
      const ScratchLine& l = chunk.lines[entry.scratch - chunk.first];
      const std::uint32_t slot = chunk.counts[entry.tile]++;
      chunk.slots[e] = slot;
      scratch_[slot] = entry.scratch;
      runs_[slot] = tile_run(l.frame, l.per_mm, l.rim, l.alpha, tiles[entry.tile].origin_mm);
    }
  });
}

template <typename Visit>
void TileRuns::each_scratch(const Visit& visit) const {
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t c) {
    const Chunk& chunk = chunks_[c];
    for (std::size_t e = 0; e < chunk.entries.size();) {
      const std::size_t from = e;
      const std::uint32_t scratch = chunk.entries[e].scratch;
      while (e < chunk.entries.size() && chunk.entries[e].scratch == scratch) ++e;
      visit(c, scratch, std::span(chunk.slots).subspan(from, e - from));
    }
  });
}

}  // namespace burin
