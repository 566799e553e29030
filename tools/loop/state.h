// tools/loop/state.h - validity of a loop project's results, and the causes of outdated ones. Records and contents
// determine it before any work.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/content_hash.h"
#include "tools/loop/record.h"
#include "tools/loop/stages.h"

namespace burin {

/// One difference between a stage's record and the present files or options.
struct StageChange {
  enum class Kind { input, output, option };
  enum class How {
    changed,
    gone,
    added,
    unused  ///< still there, but no input of the stage any more
  };
  Kind kind = Kind::input;
  How how = How::changed;
  std::string name;      ///< a path relative to the project, or an option
  std::string was, now;  ///< an option's values
};

struct StageState {
  enum class Condition {
    not_begun,
    not_recorded,  ///< files exist, but no record of their inputs
    stopped,       ///< begun and not ended (killed or failed); it will be repeated
    interrupted,   ///< ended early with a result
    done           ///< up to date if `changes` is empty
  };
  StageOfRound at;
  Condition condition = Condition::not_begun;
  std::vector<StageChange> changes;  ///< without accepted ones (--keep)
  std::optional<MadeRecord> record;
  bool photographed = false;  ///< the round's board is carved and photographed

  bool up_to_date() const { return condition == Condition::done && changes.empty(); }
  bool changed(StageChange::Kind kind) const;
};

/// Returns the present state of a stage. If its present inputs are unknown (a design.json during editing), compares the
/// recorded ones.
StageState state_of(const LoopProject& loop, const StageOfRound& at, ContentHashes& hashes);

/// Returns the stages of all existing rounds and of the round after the latest measured one. The whole loop's report is
/// last.
std::vector<StageState> states_of(const LoopProject& loop, ContentHashes& hashes);

/// Hashes files under their names in a record.
FileHashes hashes_of(const Project& project, const std::set<std::filesystem::path>& files, ContentHashes& hashes);
FileHashes hashes_of(const Project& project, const std::vector<std::filesystem::path>& files, ContentHashes& hashes);

/// Records a manual `burin check carve` of a round under the loop's own settings, so that its page is the loop's. Does
/// nothing before the loop reaches that stage.
void record_check(const LoopProject& loop, int round, bool good);

/// Returns true if the user must choose `--again` or `--keep` first. Otherwise outdated measurements, and stages that
/// depend on repeated ones, are repeated. Carved results stay unchanged.
bool needs_answer(const StageState& state);

/// needs_answer() among all states. False while the round before must be measured again, because the design's inputs
/// depend on it. False for design, tool path or board while an earlier one of them in that round is to be made or was
/// ended early.
bool needs_answer_now(const StageState& state, const std::vector<StageState>& states);

/// Design, tool path and board: each depends on the one before it in its round.
bool is_carving(StageKind stage);

/// Returns true if it is outdated because the carving stage before it in its round was repeated. It is then repeated
/// without a question.
bool follows(const StageState& state);

/// Keeps only the first question of each round's carving stages: later stages depend on the same inputs.
std::vector<StageState> without_followers(const std::vector<StageState>& asking);

/// Returns true if the stage is repeated without a question.
bool is_made_by_itself(const StageState& state);

/// "board.json changed; photos/a.png is new".
std::string in_words(const std::vector<StageChange>& changes);

/// "done", "out of date: ...", "not begun", ...
std::string in_words(const StageState& state);

}  // namespace burin
