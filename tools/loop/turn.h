// tools/loop/turn.h - one run of a loop project: its state, the user's decisions, then the work.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tools/facts.h"
#include "tools/loop/stages.h"
#include "tools/loop/state.h"

namespace burin {

/// The user's options of one `burin loop`.
struct LoopAnswers {
  std::vector<std::string> again;  ///< "design" (of the latest round that has one), "round-02/refine"
  bool keep = false;               ///< accept outdated, manually changed or interrupted results
  std::vector<std::string> accept_unknown;
  int simulated_rounds = 1;
  bool another = false;  ///< carve the next board in spite of a negligible gain
};

/// What turn_loop() would do now, stage by stage, up to the first question or photos to take. Changes nothing.
Report dry_run(const LoopProject& loop, const LoopAnswers& answers);

/// Runs the loop until the user has to act, or all simulated rounds are done. Prints all steps. Throws Error for a
/// question without an answer, a stage that ended early, and an undetermined parameter.
void turn_loop(const LoopProject& loop, const LoopAnswers& answers);

}  // namespace burin
