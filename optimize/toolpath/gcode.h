// burin/optimize/toolpath/gcode.h - a planned path as files of G-code, by the blocks of the machine's profile.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/planned_path.h"
#include "burin/optimize/toolpath/toolpath_check.h"

namespace burin {

/// One file of G-code: it sets up units and modes and lifts the tool before it moves, so that carving may begin with
/// any part. The profile's `head` comes first, then comments, then Burin's own lines and the profile's blocks.
struct GcodePart {
  std::string text;
  std::size_t first = 0, count = 0;  ///< which of Toolpath::scratches it carves
  double duration_s = 0;             ///< by replaying it (burin/optimize/toolpath/toolpath_check.h)
};

/// Files of at most about part_s each (0: as few as the profile's max_lines allows), each replayed and found to carve
/// its scratches once. Throws Error for a block of the profile with a placeholder that nobody knows, and for max_lines
/// that leave no room for a scratch.
std::vector<GcodePart> gcode_parts(const Toolpath& path, const MachineProfile& machine, double part_s = 0);

/// A file's text, read back from the disk. Throws Error, calling it `name`, where that is not `text`, byte by byte.
std::string read_back(const std::filesystem::path& written, std::string_view text, const std::string& name);

/// Reads a file back from the disk, byte by byte, and replays it whole, comments and all. Throws Error where it is not
/// `text`, where the replay cannot follow it, or where it has no end; `name` is what errors call it.
Replay replay_written(const std::filesystem::path& written, std::string_view text, const Toolpath& path,
                      const MachineProfile& machine, const std::string& name);

/// Throws Error unless a replay carves the scratches of a part, each once and as planned.
void fail_unless_carves(const Replay& replay, const Toolpath& path, const GcodePart& part,
                        const MachineProfile& machine, const std::string& name);

/// A way round all scratches at safe height, at the carving feed.
std::string frame_gcode(const Toolpath& path, const MachineProfile& machine);

}  // namespace burin
