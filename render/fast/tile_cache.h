// burin/render/fast/tile_cache.h - the tiles of grids that are rendered in turn, kept from one to the next: what
// photos' fits render again and again. May be asked by several threads at once.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>

#include "burin/render/fast/tiled_grid.h"

namespace burin {

class TileCache {
 public:
  /// Those of the grids longest unused go where all would need more than `most_bytes`.
  explicit TileCache(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// The tiles of a grid: made where they are not there.
  std::shared_ptr<const TiledGrid> of(const std::shared_ptr<const FootprintGrid>& grid);

 private:
  struct Kept {
    std::weak_ptr<const FootprintGrid> grid;
    std::shared_ptr<const TiledGrid> tiles;
  };
  std::size_t most_bytes_, bytes_ = 0;
  std::mutex mutex_;
  std::list<Kept> kept_;  ///< last used first
};

}  // namespace burin
