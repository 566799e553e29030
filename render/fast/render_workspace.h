// burin/render/fast/render_workspace.h - work buffers of views: runs, pairs with their Jacobian, and buffers per
// thread. They grow to the largest iteration and persist. Views that are rendered and differentiated one after the
// other may share a workspace, so memory grows with the pairs of one view and not of all. Common data of several views
// is computed once: a grid's tiles, and the runs and places of pairs of unmoved scratches.
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

/// Widths and depths of grooves, one each or one for all; for the paper's grooves also the numbers of TileRun.
struct GrooveShapes {
  std::vector<double> width_um, depth_um;
  std::vector<float> per_mm, rim;  ///< of each different groove
};

class RenderWorkspace {
 public:
  /// If a tile's arrays do not fit into `most_jacobian_bytes`, the backward pass evaluates the tile again. Tiles of
  /// grids come from `tiles`; without it the workspace keeps those of the last grid.
  explicit RenderWorkspace(std::size_t most_jacobian_bytes, std::shared_ptr<TileCache> tiles = nullptr);

  /// The tiles of a grid. The object persists for a grid as long as a view uses it.
  std::shared_ptr<const TiledGrid> tiles_of(const std::shared_ptr<const FootprintGrid>& grid);

  /// Shapes of scratches. `width_um` and `depth_um` apply to scratches without their own. The last shapes persist,
  /// because successive photos show the same board.
  std::shared_ptr<const GrooveShapes> shapes_of(const Scratches& scratches, double width_um, double depth_um);

  /// Sorts scratches into tiles, unless the last call had the same scratches.
  void sort(const std::shared_ptr<const TiledGrid>& grid, const ScratchLines& lines);

  /// The pairs of a tile, stored or computed. `found` must outlive them.
  TilePlaces places_of(std::size_t tile, const TileTask& task, const TileKernels& kernels, FoundPlaces& found);

  /// Memory for the Jacobian of a tile's `count` pairs in the mode, without storage. `work` holds it until the next
  /// call.
  struct Work;
  /// `by_half_vector`: with the derivatives of TileTask::by_half_vector.
  static TileJacobian make_jacobian(KernelMode mode, std::size_t count, Work& work, bool by_half_vector = false);
  /// As make_jacobian(), but stored until the next forward(), or without arrays if no space is left.
  TileJacobian keep_jacobian(KernelMode mode, std::size_t count);
  /// Adds the ends to the result of keep_jacobian() and stores it; stores nothing if no space is left for the ends.
  void keep_ends(std::size_t tile, TileJacobian jacobian, const std::vector<EndPair>& ends);

  const void* owner = nullptr;  ///< the view whose Jacobian this is
  TileRuns runs;
  std::vector<std::uint32_t> pair_count;      ///< by tile
  std::size_t most_runs = 0, most_pairs = 0;  ///< of any tile so far
  std::vector<TileJacobian> jacobian;         ///< by tile
  ByteStore jacobian_store;                   ///< of the last forward()
  std::vector<float> open_slope;              ///< by tile and place: d (plain face's lobe) / d base_alpha
  std::vector<float> by_run;                  ///< of the backward pass: run_gradients() numbers per run
  std::vector<double> by_tile;                ///< by base_alpha
  std::vector<Eigen::Array3d> by_chunk;       ///< of scratches: by width, depth, alpha

  /// Buffers of one thread.
  struct Work {
    TileBuffers tile;
    FoundPlaces found;
    TilePairs pairs;
    TileCurves curves;
    std::vector<float> jacobian;  // of a tile without space in the store
    float open[kTilePixels] = {}, lobes[kTilePixels] = {}, covered_base[kTilePixels] = {};
    float weight[kTilePixels] = {};
    std::vector<RunUnits> units;  // of a tile's runs
    std::vector<float> slopes;    // kPixelSlopes for each place
  };
  tbb::enumerable_thread_specific<std::unique_ptr<Work>> work{[] { return std::make_unique<Work>(); }};

 private:
  bool is_sorted(const TiledGrid* grid, const ScratchLines& lines) const;

  std::shared_ptr<const GrooveShapes> shapes_;
  std::shared_ptr<TileCache> tiles_;  ///< a private one holds the last grid alone
  // Scratches and grid of `runs` and places.
  std::shared_ptr<const TiledGrid> sorted_grid_;
  std::array<std::vector<double>, 4> sorted_ends_mm_;
  std::array<std::vector<float>, 3> sorted_shape_;
  std::vector<TilePlaces> places_;  // by tile
  ByteStore place_store_;
};

}  // namespace burin
