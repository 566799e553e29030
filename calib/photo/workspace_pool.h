// burin/calib/photo/workspace_pool.h - shares the renderer's workspaces among photos: as many as photos are rendered at
// the same time. With many cut grooves one takes a gigabyte.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "burin/render/view_renderer.h"

namespace burin {

class WorkspacePool : public std::enable_shared_from_this<WorkspacePool> {
 public:
  /// A free workspace, until the pointer is destroyed. The last one to render this grid is preferred: it still holds
  /// the grid's tiles and the pairs of its scratches. Thread-safe.
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
