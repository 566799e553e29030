// tools/wall/work_wall.h - the work on a wall: previews, couplings, and the loops of its boards, by any number of
// processes (tools/wall/claim.h).
#pragma once

#include <chrono>
#include <filesystem>

#include "tools/facts.h"

namespace burin {

struct WallWorkOptions {
  std::chrono::seconds stale{120};  ///< after which a silent worker's board is taken over
  bool retry = false;               ///< also take boards whose work failed
};

/// Takes the next stage of the next free board until none is left. Waits while others work on stages that the rest
/// depends on. Throws Error for another version or SIMD width than the other workers', and for a wall.json that was
/// changed meanwhile. The report fails if boards failed.
Report work_on_wall(const std::filesystem::path& folder, const WallWorkOptions& options);

/// Solves the couplings from the previews of all boards. Throws Error if one is missing.
Report settle_wall(const std::filesystem::path& folder);

/// Who does what, and what is left.
Report wall_status(const std::filesystem::path& folder);

}  // namespace burin
