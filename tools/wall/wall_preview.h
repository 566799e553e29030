// tools/wall/wall_preview.h - preview of one board of a wall: a few quick designs, and the kilobytes of them that the
// couplings need (burin/optimize/wall/wall_shares.h). WALL/previews/BOARD.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "burin/optimize/wall/wall_shares.h"
#include "tools/wall/lay_wall.h"

namespace burin {

/// Designs a board with half, once and twice the scratches of its share, at its own exposures, in few iterations.
/// Writes previews/BOARD.json and a picture per view. No clock ends it: the same wall gives the same bits. Throws
/// Stopped (tools/stop_signal.h) after a request to stop.
void make_preview(const Wall& wall, const LaidWall& laid, std::size_t index);

/// The preview of a board; nothing if there is none of this wall.json.
std::optional<BoardPreview> read_preview(const std::filesystem::path& wall_folder, const std::string& board,
                                         const std::string& key);

}  // namespace burin
