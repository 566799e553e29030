// tools/loop/turn.h - turning a loop project on: first what is known of it, then what a person decides, then the work.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tools/loop/stages.h"
#include "tools/loop/state.h"

namespace burin {

/// What a person says to one `burin loop`.
struct LoopAnswers {
  std::vector<std::string> again;  ///< "design" (of the last round that has one), "round-02/refine"
  bool keep = false;               ///< go on with what is out of date, changed by hand or ended early, as it is
  std::vector<std::string> accept_unknown;
  int simulated_rounds = 1;
  bool another = false;  ///< carve the next board although it would gain hardly anything
};

/// Turns it until a person has to act, or all simulated rounds are done; says all of it. Throws Error where it has to
/// stop: a question without an answer, a stage that was ended early, a parameter that is not determined.
void turn_loop(const LoopProject& loop, const LoopAnswers& answers);

}  // namespace burin
