// tools/loop/say.h - what a project is, for people: its rounds, stages and what comes next.
#pragma once

#include <string>
#include <vector>

#include "tools/loop/state.h"

namespace burin {

/// "burin loop PROJECT" and more words, to be pasted.
std::string loop_line(const Project& project, const std::string& more = "");

/// A line a stage under a line a round; stages that are not begun are left out behind the first of them.
std::string table_of(const LoopProject& loop, const std::vector<StageState>& states);

/// What `burin loop` will do or ask next, in a sentence with the command.
std::string next_of(const LoopProject& loop, const std::vector<StageState>& states);

/// The question that a stage raises: what changed, and what --again and --keep would do. Half a sentence, and its
/// remedy.
struct LoopQuestion {
  std::string what, remedy;
};
LoopQuestion question_of(const LoopProject& loop, const StageState& state);

/// What a person has to do with the board of that round: carve, photograph, put the photos into the round's folder.
std::string your_turn(const LoopProject& loop, int round);

}  // namespace burin
