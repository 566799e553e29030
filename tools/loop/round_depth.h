// tools/loop/round_depth.h - how deep a round's grooves are designed, once photos measured what the machine makes of a
// depth: as deep as board.json wants them. The machine is then told the depth that makes that one, as far as its depth
// table reaches. docs/model.md 7.4.
#pragma once

#include <optional>
#include <string>

#include "tools/loop/options.h"
#include "tools/project.h"

namespace burin {

struct RoundDepth {
  double told_um = 0, made_um = 0,
         sigma_um = 0;    ///< of the rounds before: told the machine, and measured, with its sigma
  double wanted_um = 0;   ///< board.json's
  double depth_um = 0;    ///< designed: as wanted, or as near as the machine's table allows
  double command_um = 0;  ///< told for it
};

/// Of the round `number`. Nothing where no depth was measured, or what was measured is what was told: within two
/// sigmas, or 3 %. Throws Error for files that cannot be read.
std::optional<RoundDepth> depth_of_round(const Project& project, const LoopOptions& options, int number);

/// "the machine makes 10.3 +- 0.1 um of 14 um that it is told: this board is designed 14 um deep, and told 19.0 um for
/// it ...".
std::string in_words(const RoundDepth& depth);

}  // namespace burin
