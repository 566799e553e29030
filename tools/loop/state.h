// tools/loop/state.h - what of a loop project holds, and what is out of date because of what: known from records and
// contents, before anything is done.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/content_hash.h"
#include "tools/loop/record.h"
#include "tools/loop/stages.h"

namespace burin {

/// One difference between what a stage was made from, or left, and what is there now.
struct StageChange {
  enum class Kind { input, output, option };
  enum class How {
    changed,
    gone,
    added,
    unused  ///< still there, but it would not be made from it any more
  };
  Kind kind = Kind::input;
  How how = How::changed;
  std::string name;      ///< a path relative to the project, or an option
  std::string was, now;  ///< an option's values
};

struct StageState {
  enum class Condition {
    not_begun,
    not_recorded,  ///< files lie there, and nothing says what they were made from
    stopped,       ///< begun and not ended: killed, or failed; it begins anew
    interrupted,   ///< ended early with what it had
    done           ///< and up to date if `changes` is empty
  };
  StageOfRound at;
  Condition condition = Condition::not_begun;
  std::vector<StageChange> changes;  ///< that no --keep has settled
  std::optional<MadeRecord> record;
  bool photographed = false;  ///< the round's board is in the metal and was seen

  bool up_to_date() const { return condition == Condition::done && changes.empty(); }
  bool changed(StageChange::Kind kind) const;
};

/// The stage as it is now. Where what it would be made from cannot be told (a design.json that is being edited), what
/// it was made from is compared.
StageState state_of(const LoopProject& loop, const StageOfRound& at, ContentHashes& hashes);

/// All stages of the rounds that there are, and of the round after the last measured one; the whole loop's report last.
std::vector<StageState> states_of(const LoopProject& loop, ContentHashes& hashes);

/// The files as a record names them.
FileHashes hashes_of(const Project& project, const std::set<std::filesystem::path>& files, ContentHashes& hashes);
FileHashes hashes_of(const Project& project, const std::vector<std::filesystem::path>& files, ContentHashes& hashes);

/// After `burin check carve` was run by hand on a round, under the loop's own settings: the page is the loop's, made
/// from what is there now. Nothing where the loop has not come to that stage yet.
void record_check(const LoopProject& loop, int round, bool good);

/// Whether a person has to say `--again` or `--keep` before the loop goes on; else what is out of date is made anew
/// (measurements of photos, and what follows from a stage made anew) or stays as it is in the metal.
bool needs_answer(const StageState& state);

/// The same among all states: not while the round before is still to be measured anew, since only then is known what
/// the design rests on; and not of design, tool path or board while an earlier one of them in that round is itself to
/// be made, or was ended early.
bool needs_answer_now(const StageState& state, const std::vector<StageState>& states);

/// Design, tool path and board: each is made from the one before it in its round.
bool is_carving(StageKind stage);

/// Whether it is out of date because the carving stage before it in its round was made anew: it is then made anew
/// without a question.
bool follows(const StageState& state);

/// Of states that raise questions those to be asked: what a carving stage rests on, those behind it in the round rest
/// on too, so that one question a round is enough.
std::vector<StageState> without_followers(const std::vector<StageState>& asking);

/// Whether the stage would be made anew without a question.
bool is_made_by_itself(const StageState& state);

/// "board.json changed, photos/a.png and 2 more are new, option machine was grbl and is linuxcnc".
std::string in_words(const std::vector<StageChange>& changes);

/// "done", "out of date: ...", "not begun", ...
std::string in_words(const StageState& state);

}  // namespace burin
