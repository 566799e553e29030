// tools/loop/carved_board.h - protects the commanded values of a carved and photographed board: tool width, groove
// depth and roughness. If the user changes them in the project's board.json, that board's photos no longer measure the
// machine's response to them. Corrections of the tags are always allowed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/project.h"

namespace burin {

/// One value of the project's board.json that differs from the round's board.
struct ToldOtherwise {
  std::string field;           ///< "material.depth_um"
  double now = 0, then = 0;    ///< in the project's board.json; in the round's board
  std::filesystem::path told;  ///< the file with `then`
};

/// Compares with a photographed round: its board.json (or the latest one in former/) and the commanded values in its
/// measured bench.json. Returns nothing if neither exists. Throws Error for an unreadable board.json.
std::vector<ToldOtherwise> told_otherwise(const Project& project, int round);

/// in_words() names each value with both files; told_again() is the remedy: it restores the carved values.
std::string in_words(const std::vector<ToldOtherwise>& numbers);
std::string told_again(const Project& project, const std::vector<ToldOtherwise>& numbers);

/// Throws Error, naming both files, if there are such values.
void require_told_as_carved(const Project& project, int round);

}  // namespace burin
