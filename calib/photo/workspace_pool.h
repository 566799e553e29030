// burin/calib/photo/workspace_pool.h - the renderer's workspaces that photos share: as many as photos are rendered at
// the same time, however many photos there are. Of many cut grooves one takes a gigabyte.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "burin/render/view_renderer.h"

namespace burin {

class WorkspacePool : public std::enable_shared_from_this<WorkspacePool> {
 public:
  /// A free workspace until the pointer goes: the one that rendered this grid last, if it is there, which still has its
  /// tiles and the pairs of its scratches. Several threads may ask at once.
  std::shared_ptr<RenderWorkspace> borrow(const FootprintGrid* grid);

 private:
  struct Free {
    const FootprintGrid* last = nullptr;
    std::shared_ptr<RenderWorkspace> workspace;
  };
  std::mutex mutex_;
  std::vector<Free> free_;
  std::shared_ptr<TileCache> tiles_ = make_tile_cache();  ///< photos are rendered in turn, many times each
};

}  // namespace burin
