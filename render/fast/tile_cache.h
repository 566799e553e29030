// burin/render/fast/tile_cache.h - storage for the tiles of grids that are rendered in turn, as fits to photos do.
// Several threads may use it at once.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>

#include "burin/render/fast/tiled_grid.h"

namespace burin {

class TileCache {
 public:
  /// Beyond `most_bytes` it drops the tiles of the least recently used grids.
  explicit TileCache(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// The tiles of a grid, made if absent.
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
