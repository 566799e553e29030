// burin/render/fast/render_workspace.h - the buffers that views work in: runs, pairs with their Jacobian, and a
// thread's own. They grow to the largest iteration and are kept. Views that are rendered and differentiated one after
// the other may share one, so that memory grows with the pairs of one view and not of all. What several views have in
// common is made once: a grid's tiles, and, while the scratches stay where they are, the runs and places of their
// pairs.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "burin/render/fast/byte_store.h"
#include "burin/render/fast/curve_tables.h"
#include "burin/render/fast/tile_cache.h"
#include "burin/render/fast/tile_kernel.h"
#include "burin/render/fast/tile_runs.h"
#include "burin/render/fast/tiled_grid.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Widths and depths of grooves, one each or one of all, and of the paper's what runs are made of (TileRun).
struct GrooveShapes {
  std::vector<double> width_um, depth_um;
  std::vector<float> per_mm, rim;  ///< of each different groove
};

class RenderWorkspace {
 public:
  /// A tile whose arrays no longer fit into `most_jacobian_bytes` is not kept, and evaluated again on the way back.
  /// Tiles of grids come from `tiles`, or are kept of the last grid.
  explicit RenderWorkspace(std::size_t most_jacobian_bytes, std::shared_ptr<TileCache> tiles = nullptr);

  /// The tiles of a grid; the same for the same grid as long as a view uses them.
  std::shared_ptr<const TiledGrid> tiles_of(const std::shared_ptr<const FootprintGrid>& grid);

  /// Of scratches; `width_um` and `depth_um` are those of scratches without their own. Kept as long as they are asked
  /// for again: photo after photo shows the same board.
  std::shared_ptr<const GrooveShapes> shapes_of(const Scratches& scratches, double width_um, double depth_um);

  /// Sorts scratches into tiles, unless these are the ones that lie there since the last time.
  void sort(const std::shared_ptr<const TiledGrid>& grid, const ScratchLines& lines);

  /// The pairs of a tile: as kept, or found anew. `found` must outlive them.
  TilePlaces places_of(std::size_t tile, const TileTask& task, const TileKernels& kernels, FoundPlaces& found);

  /// Memory for the Jacobian of a tile's `count` pairs in the mode, where nothing is kept of any: `work` holds it until
  /// the next.
  struct Work;
  /// `by_half_vector`: with what TileTask::by_half_vector asks for.
  static TileJacobian make_jacobian(KernelMode mode, std::size_t count, Work& work, bool by_half_vector = false);
  /// The same where it is kept until the next forward(), or without arrays where no space is left.
  TileJacobian keep_jacobian(KernelMode mode, std::size_t count);
  /// Completes what keep_jacobian() made with its ends and keeps it; with nothing where no space is left for those.
  void keep_ends(std::size_t tile, TileJacobian jacobian, const std::vector<EndPair>& ends);

  const void* owner = nullptr;  ///< the view whose Jacobian this is
  TileRuns runs;
  std::vector<std::uint32_t> pair_count;      ///< by tile
  std::size_t most_runs = 0, most_pairs = 0;  ///< of any tile so far
  std::vector<TileJacobian> jacobian;         ///< by tile
  ByteStore jacobian_store;                   ///< of the last forward()
  std::vector<float> open_slope;              ///< by tile and place: d (plain face's lobe) / d base_alpha
  std::vector<float> by_run;                  ///< of the backward pass: run_gradients() a run
  std::vector<double> by_tile;                ///< by base_alpha
  std::vector<Eigen::Array3d> by_chunk;       ///< of scratches: by width, depth, alpha

  /// A thread's own.
  struct Work {
    TileBuffers tile;
    FoundPlaces found;
    TilePairs pairs;
    TileCurves curves;
    std::vector<float> jacobian;  // of a tile for which there is no space
    float open[kTilePixels] = {}, lobes[kTilePixels] = {}, covered_base[kTilePixels] = {};
    float weight[kTilePixels] = {};
    std::vector<RunUnits> units;  // of a tile's runs
    std::vector<float> slopes;    // kPixelSlopes for each place
  };
  tbb::enumerable_thread_specific<std::unique_ptr<Work>> work{[] { return std::make_unique<Work>(); }};

 private:
  bool is_sorted(const TiledGrid* grid, const ScratchLines& lines) const;

  std::shared_ptr<const GrooveShapes> shapes_;
  std::shared_ptr<TileCache> tiles_;  ///< its own knows the last grid alone
  // The scratches and the grid that `runs` and places were made for.
  std::shared_ptr<const TiledGrid> sorted_grid_;
  std::array<std::vector<double>, 4> sorted_ends_mm_;
  std::array<std::vector<float>, 3> sorted_shape_;
  std::vector<TilePlaces> places_;  // by tile
  ByteStore place_store_;
};

}  // namespace burin
