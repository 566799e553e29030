#include "burin/render/fast/tile_cache.h"

#include <algorithm>
#include <utility>

#include "burin/render/view_scene.h"

namespace burin {

std::shared_ptr<TileCache> make_tile_cache(std::size_t most_bytes) { return std::make_shared<TileCache>(most_bytes); }

std::shared_ptr<const TiledGrid> TileCache::of(const std::shared_ptr<const FootprintGrid>& grid) {
  {
    const std::scoped_lock lock(mutex_);
    const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.grid.lock() == grid; });
    if (found != kept_.end()) {
      kept_.splice(kept_.begin(), kept_, found);
      return kept_.front().tiles;
    }
  }
  auto tiles = std::make_shared<const TiledGrid>(*grid);
  const std::scoped_lock lock(mutex_);
  kept_.push_front({grid, tiles});
  bytes_ += tiles->bytes();
  const auto drop = [&](std::list<Kept>::iterator at) {
    bytes_ -= at->tiles->bytes();
    return kept_.erase(at);
  };
  for (auto at = std::next(kept_.begin()); at != kept_.end();) at = at->grid.expired() ? drop(at) : std::next(at);
  while (bytes_ > most_bytes_ && kept_.size() > 1) drop(std::prev(kept_.end()));
  return tiles;
}

}  // namespace burin
