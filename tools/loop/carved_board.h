// tools/loop/carved_board.h - what a carved and photographed board was told stays what it was told: its tool's width,
// the depth and the roughness of its grooves. Where a person writes others into the project's board.json, the photos of
// that board do not measure what the machine makes of them. Corrected tags are welcome at any time.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/project.h"

namespace burin {

/// One number that the project's board.json says otherwise than the board of a round was told.
struct ToldOtherwise {
  std::string field;           ///< "material.depth_um"
  double now = 0, then = 0;    ///< in the project's board.json; when that board was carved
  std::filesystem::path told;  ///< where `then` stands
};

/// Those of a photographed round: against its board.json (or the one that was moved to former/ last) and what its
/// measured bench.json has as told. Nothing where neither is there. Throws Error for a board.json that cannot be read.
std::vector<ToldOtherwise> told_otherwise(const Project& project, int round);

/// "material.depth_um is 13, but round-01/board.json, which is carved and photographed, has 11"; and what to do.
std::string in_words(const std::vector<ToldOtherwise>& numbers);
std::string told_again(const Project& project, const std::vector<ToldOtherwise>& numbers);

/// Throws Error, naming both files, where there are such numbers.
void require_told_as_carved(const Project& project, int round);

}  // namespace burin
