// render/render_room.h - the buffers that views work in: runs, pairs with their Jacobian, and a thread's room. They
// grow to the largest iteration and are kept. Views that are rendered and differentiated one after the other may share
// one, so that memory grows with the pairs of one view and not of all.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "render/tile_kernel.h"
#include "render/tile_runs.h"

namespace burin {

class RenderRoom {
 public:
  const void* owner = nullptr;  ///< the view whose pairs these are
  TileRuns runs;
  std::vector<TilePairs> pairs;                          ///< by tile
  std::vector<float> open_slope;                         ///< by tile and place: d (plain face's lobe) / d base_alpha
  std::array<std::vector<float>, kRunGradients> by_run;  ///< of the backward pass
  std::vector<double> by_tile;                           ///< by base_alpha
  std::vector<Eigen::Array3d> by_chunk;                  ///< of scratches: by width, depth, alpha

  /// A thread's own.
  struct Work {
    TileRoom tile;
    TilePairs pairs;  // of a tile whose pairs are not kept
    float base[kTilePixels] = {}, weight[kTilePixels] = {};
  };
  tbb::enumerable_thread_specific<std::unique_ptr<Work>> work{[] { return std::make_unique<Work>(); }};
};

}  // namespace burin
