// tools/wall/lay_wall.h - from wall.json to one loop project per board, and the boards' couplings in files.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/image.h"
#include "burin/optimize/target.h"
#include "tools/wall/wall_file.h"

namespace burin {

/// laid.json: the boards were laid out from this wall.json.
struct LaidWall {
  std::string key;                 ///< wall_key()
  std::vector<std::string> blank;  ///< boards that stay dark in all views; they have no project
  bool is_blank(const std::string& board) const;
};

/// settled.json: one exposure per view, and the scratches of each board.
struct SettledWall {
  std::string key;
  std::vector<double> exposures;
  std::map<std::string, int> scratches;
};

/// Writes the projects of all boards, and laid.json. Boards' own records show the loop which results became outdated.
/// Throws Error for missing pictures, and as the commands that read the boards' files.
LaidWall lay_wall(const Wall& wall);

/// Throws Error if the boards are not laid out, or from another wall.json.
LaidWall read_laid(const std::filesystem::path& wall_folder);

/// Nothing before burin wall settle, and after a change of wall.json.
std::optional<SettledWall> read_settled(const std::filesystem::path& wall_folder, const std::string& key);

/// Writes settled.json, then the design.json of each board.
void write_settled(const Wall& wall, const LaidWall& laid, const SettledWall& settled);

/// Gives a board's design.json its settled exposures and scratches. The rest of the file, and a file that has them,
/// stay as they are.
void settle_design(const Wall& wall, std::size_t index, const SettledWall& settled);

/// Largest value of a picture. Parts of pictures below `kBlackTone` (sRGB-encoded) count as black.
float brightest(const Image& image);
inline constexpr float kBlackTone = 0.02F;

/// Scratches of a board before the wall is settled: by its area, or by the hours.
int preview_scratches(const Wall& wall, std::size_t index);

/// The part of a picture (linear light) within a rectangle, given in its pixels from the upper left corner. Pixels are
/// averaged over their area; outside of the picture it is black.
Image part_of_picture(const Image& linear, const Eigen::Vector2d& min_px, const Eigen::Vector2d& max_px, int width,
                      int height);

/// The part of a wall's picture on a rectangle of the wall (mm, y up), sRGB-encoded, with about the picture's pixels.
/// Its sides have the rectangle's ratio.
Image picture_on_board(const Image& linear, const LaidPicture& laid, const WallArea& wall, const WallArea& board);

}  // namespace burin
