// tools/loop/say.h - descriptions of a project for people: rounds, stages and the next step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/loop/state.h"
#include "tools/loop/unknown.h"
#include "tools/rounds_quality.h"

namespace burin {

/// "burin loop PROJECT" and more words, ready to paste.
std::string loop_line(const Project& project, const std::string& more = "");

/// Returns one line per round and one per begun stage. `brief`: only one line for a finished round. `at_work`: a
/// running loop is making the begun stages.
std::string table_of(const LoopProject& loop, const std::vector<StageState>& states, bool brief = false,
                     bool at_work = false);

/// Returns the next action, question or refusal of `burin loop`, as a sentence with the command.
std::string next_of(const LoopProject& loop, const std::vector<StageState>& states);

/// Question that a stage raises: its changes, and the effects of --again and --keep. Half a sentence, and its remedy.
struct LoopQuestion {
  std::string what, remedy;
};
LoopQuestion question_of(const LoopProject& loop, const StageState& state);

/// Combines the questions of one project's states. One command answers all, with an --again per stage, since a single
/// --again would be refused because of the others. Throws Error for no states.
LoopQuestion question_of(const LoopProject& loop, const std::vector<StageState>& states);

/// Question about unknown parameters of a measured round, which stop the next design: the missing photo, or
/// --accept-unknown. `photo`: continues "the photo".
LoopQuestion question_of(const LoopProject& loop, int round, const std::vector<UnknownParameter>& open,
                         const std::string& photo = "named above");

/// Returns the design's time limit in loop.toml as half a sentence behind a command that repeats the design, because
/// the limit would end it early again. Empty without a limit.
std::string time_limit_in_words(const LoopProject& loop);

/// Returns the latest photographed board and the next one, if another board gains too little (tools/rounds_quality.h).
/// Uses the project's report. Returns nothing if another board pays or the gain is unknown.
std::optional<NextBoard> last_board(const Project& project);

/// Returns the user's tasks for that round's board: carve, photograph, put the photos into the round's folder.
std::string your_turn(const LoopProject& loop, int round);

}  // namespace burin
