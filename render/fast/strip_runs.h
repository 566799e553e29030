// burin/render/fast/strip_runs.h - strips of any width sorted into a grid's tiles, with a search for their pairs.
// Frame: board, mm.
#pragma once

#include <tbb/parallel_for.h>

#include <cstddef>
#include <span>
#include <vector>

#include "burin/render/fast/pixel_index.h"
#include "burin/render/fast/tile_kernel.h"
#include "burin/render/fast/tile_runs.h"

namespace burin {

/// The task of a search for a tile's pairs.
inline TileTask finding(const PixelIndex& index, const TileRuns& runs, std::size_t t) {
  TileTask task;
  task.runs = runs.of(t);
  task.shapes = runs.shapes(t);
  task.run_count = runs.count(t);
  task.blocks = index.blocks(index.tiles()[t]);
  task.valid_rows = index.valid_rows(t);
  return task;
}

/// Strips as lines with |t| <= 1 across them, sorted into tiles.
class StripRuns {
 public:
  StripRuns(const PixelIndex& index, std::span<const Strip> strips) : per_mm_(strips.size()) {
    for (std::vector<double>* v : {&x0_, &y0_, &x1_, &y1_}) v->resize(strips.size());
    for (std::size_t i = 0; i < strips.size(); ++i) {
      x0_[i] = strips[i].p0_mm.x();
      y0_[i] = strips[i].p0_mm.y();
      x1_[i] = strips[i].p1_mm.x();
      y1_[i] = strips[i].p1_mm.y();
      per_mm_[i] = static_cast<float>(1 / strips[i].half_width_mm);
      same_width_ = same_width_ && per_mm_[i] == per_mm_[0];
    }
    sort(index);
  }
  void sort(const PixelIndex& index) {
    runs_.sort(
        index,
        {x0_.size(), x0_.data(), y0_.data(), x1_.data(), y1_.data(), {per_mm_.data(), same_width_}, {&one_}, {&one_}});
  }
  const TileRuns& runs() const { return runs_; }

  /// visit(tile, its places), tiles in parallel.
  template <typename Visit>
  void each_tile(const PixelIndex& index, SimdWidth simd, const Visit& visit) const {
    const TileKernels& kernels = tile_kernels(simd);
    tbb::parallel_for(std::size_t{0}, index.tiles().size(), [&](std::size_t t) {
      if (runs_.count(t) == 0) return;
      thread_local FoundPlaces found;
      kernels.find(finding(index, runs_, t), found);
      visit(t, found.places());
    });
  }

 private:
  std::vector<double> x0_, y0_, x1_, y1_;
  std::vector<float> per_mm_;
  bool same_width_ = true;
  const float one_ = 1;
  TileRuns runs_;
};

}  // namespace burin
