// tools/loop/say.h - what a project is, for people: its rounds, stages and what comes next.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/loop/state.h"
#include "tools/loop/unknown.h"
#include "tools/rounds_quality.h"

namespace burin {

/// "burin loop PROJECT" and more words, to be pasted.
std::string loop_line(const Project& project, const std::string& more = "");

/// A line a stage under a line a round; stages that are not begun are left out. `brief`: a line for each round of which
/// all is done. `at_work`: a loop works here, so that what is begun is being made.
std::string table_of(const LoopProject& loop, const std::vector<StageState>& states, bool brief = false,
                     bool at_work = false);

/// What `burin loop` will do, ask or refuse next, in a sentence with the command.
std::string next_of(const LoopProject& loop, const std::vector<StageState>& states);

/// The question that a stage raises: what changed, and what --again and --keep would do. Half a sentence, and its
/// remedy.
struct LoopQuestion {
  std::string what, remedy;
};
LoopQuestion question_of(const LoopProject& loop, const StageState& state);

/// All that is asked at once, by states of one project: one command answers it, with an --again for each stage, since
/// each alone would be refused for the others. Throws Error for none.
LoopQuestion question_of(const LoopProject& loop, const std::vector<StageState>& states);

/// What stops another design behind a measured round: the photo that is missing, or --accept-unknown. `photo`: which
/// photo, behind "the photo".
LoopQuestion question_of(const LoopProject& loop, int round, const std::vector<UnknownParameter>& open,
                         const std::string& photo = "named above");

/// How long a design may take, where loop.toml says so: a design that was ended early is ended so again. Empty where
/// it does not, else half a sentence to stand behind a command that designs anew.
std::string time_limit_in_words(const LoopProject& loop);

/// The last photographed board and the next one, where that one is not worth its hours (tools/rounds_quality.h), as the
/// project's report has it. Nothing where it is, or nobody knows.
std::optional<NextBoard> last_board(const Project& project);

/// What a person has to do with the board of that round: carve, photograph, put the photos into the round's folder.
std::string your_turn(const LoopProject& loop, int round);

}  // namespace burin
