// burin/render/fast/tile_runs.h - scratches sorted into the tiles of a grid, with one run per tile that a scratch may
// touch.
//
// A tile's runs are in the order of the scratches, and a scratch's runs are in tile order, for any number of threads.
// Memory persists from one sort() to the next.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "burin/render/fast/pixel_index.h"
#include "burin/render/fast/tile.h"

namespace burin {

/// One number per scratch, or one for all.
template <typename T>
struct Each {
  const T* values = nullptr;
  bool shared = true;

  T operator[](std::size_t i) const { return values[shared ? 0 : i]; }
};

/// Straight grooves: their ends on the board, 2 / wt, and |t| <= rim across them. The caller owns the arrays.
struct ScratchLines {
  std::size_t count = 0;
  const double *x0_mm = nullptr, *y0_mm = nullptr, *x1_mm = nullptr, *y1_mm = nullptr;
  Each<float> per_mm, rim, alpha;
  const std::uint8_t* part = nullptr;  ///< RunShape::part per scratch; null: 0
};

/// Unit vector across a scratch: (d.y, -d.x) / length for d from its first end to its second. (-y, x) runs along it.
struct StripDirection {
  double x = 0, y = 0, length_mm = 0;
};

class TileRuns {
 public:
  void sort(const PixelIndex& index, const ScratchLines& lines);

  std::uint32_t count(std::size_t tile) const { return begin_[tile + 1] - begin_[tile]; }
  std::uint32_t begin(std::size_t tile) const { return begin_[tile]; }
  std::uint32_t total() const { return begin_.back(); }
  /// The runs of a tile; readable one beyond the last.
  const TileRun* of(std::size_t tile) const { return &runs_[begin_[tile]]; }
  RunShapes shapes(std::size_t tile) const { return {&shapes_[shared_shape_ ? 0 : begin_[tile]], shared_shape_}; }
  std::uint32_t scratch(std::size_t tile, std::uint32_t run) const { return scratch_[begin_[tile] + run]; }

  const StripDirection& across(std::size_t scratch) const { return across_[scratch]; }

  std::size_t chunk_count() const { return chunks_.size(); }
  /// visit(chunk, scratch, numbers of its runs in tile order), chunks of scratches in parallel. The division into
  /// chunks depends on the number of scratches alone. Run numbers count over all tiles. fetch(run) precedes each visit
  /// by a few runs and prefetches its scattered memory.
  template <typename Visit, typename Fetch>
  void each_scratch(const Visit& visit, const Fetch& fetch) const;

 private:
  /// Largest number of parts of the scratches, for any number of threads.
  static constexpr std::size_t kMostChunks = 64, kLeastChunk = 256;

  struct Entry {
    std::uint32_t tile, scratch;
  };
  struct Chunk {
    std::vector<std::uint32_t> touched;
    std::size_t entry_count = 0;
    std::vector<Entry> entries;         // in scratch order; may be longer than the used part
    std::vector<std::uint32_t> slots;   // of the entries: number of the run
    std::vector<std::uint32_t> counts;  // by tile; later the position of this chunk's next run of the tile
    std::size_t first = 0, last = 0;
  };

  void find_tiles(const PixelIndex& index, const ScratchLines& lines, Chunk& chunk);
  void make_runs(const PixelIndex& index, const ScratchLines& lines, Chunk& chunk);

  std::vector<Chunk> chunks_;
  std::vector<std::uint32_t> begin_;  // by tile, one more
  std::vector<TileRun> runs_;         // by tile, one more
  bool shared_shape_ = true;
  std::vector<RunShape> shapes_;  // one, or as runs_
  std::vector<std::uint32_t> scratch_;
  std::vector<StripDirection> across_;  // by scratch
};

template <typename Visit, typename Fetch>
void TileRuns::each_scratch(const Visit& visit, const Fetch& fetch) const {
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t c) {
    constexpr std::size_t kAhead = 24;
    const Chunk& chunk = chunks_[c];
    std::size_t fetched = 0;
    for (std::size_t e = 0; e < chunk.entry_count;) {
      for (; fetched < std::min(e + kAhead, chunk.entry_count); ++fetched) fetch(chunk.slots[fetched]);
      const std::size_t from = e;
      const std::uint32_t scratch = chunk.entries[e].scratch;
      while (e < chunk.entry_count && chunk.entries[e].scratch == scratch) ++e;
      visit(c, scratch, std::span(chunk.slots).subspan(from, e - from));
    }
  });
}

}  // namespace burin
