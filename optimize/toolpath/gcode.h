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

/// One file of G-code. It sets units and modes and lifts the tool before it moves, so carving may begin with any part.
/// The profile's `head` comes first, then comments, then Burin's own lines and the profile's blocks.
struct GcodePart {
  std::string text;
  std::size_t first = 0, count = 0;  ///< range of Toolpath::scratches
  double duration_s = 0;             ///< from its replay (burin/optimize/toolpath/toolpath_check.h)
};

/// Files of at most about part_s each (0: as few as the profile's max_lines allows). The replay of each carves its
/// scratches once. Throws Error for an unknown placeholder in a block of the profile, and for max_lines without room
/// for a scratch.
std::vector<GcodePart> gcode_parts(const Toolpath& path, const MachineProfile& machine, double part_s = 0);

/// Reads a file's text back from the disk. Throws Error with `name` unless it equals `text` byte by byte.
std::string read_back(const std::filesystem::path& written, std::string_view text, const std::string& name);

/// Reads a file back from the disk byte by byte and replays it whole, comments included. Throws Error if it differs
/// from `text`, if the replay cannot follow it, or if it has no end; `name` is its name in errors.
Replay replay_written(const std::filesystem::path& written, std::string_view text, const Toolpath& path,
                      const MachineProfile& machine, const std::string& name);

/// Throws Error unless a replay carves the scratches of a part, each once and as planned.
void fail_unless_carves(const Replay& replay, const Toolpath& path, const GcodePart& part,
                        const MachineProfile& machine, const std::string& name);

/// A path around all scratches at safe height, at the carving feed.
std::string frame_gcode(const Toolpath& path, const MachineProfile& machine);

}  // namespace burin
