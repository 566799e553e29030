#include "burin/calib/photo/workspace_pool.h"

#include <algorithm>
#include <utility>

namespace burin {

std::shared_ptr<RenderWorkspace> WorkspacePool::borrow(const FootprintGrid* grid) {
  std::shared_ptr<RenderWorkspace> workspace;
  {
    const std::scoped_lock lock(mutex_);
    auto found = std::find_if(free_.begin(), free_.end(), [&](const Free& f) { return f.last == grid; });
    if (found == free_.end() && !free_.empty()) found = std::prev(free_.end());
    if (found != free_.end()) {
      workspace = std::move(found->workspace);
      free_.erase(found);
    }
  }
  if (workspace == nullptr) workspace = make_render_workspace(kUsualJacobianBytes, tiles_);
  RenderWorkspace* const lent = workspace.get();
  return {lent, [pool = shared_from_this(), grid, workspace = std::move(workspace)](RenderWorkspace*) mutable {
            const std::scoped_lock lock(pool->mutex_);
            pool->free_.push_back({grid, std::move(workspace)});
          }};
}

}  // namespace burin
