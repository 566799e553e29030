// tools/loop/round_depth.h - depth of a round's grooves after photos measured the machine's depths. The design uses the
// depth in board.json. The machine then gets the commanded depth for it, within its depth table (docs/model.md 7.4).
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "tools/loop/options.h"
#include "tools/project.h"

namespace burin {

struct RoundDepth {
  /// Commanded and measured depth of the rounds before, with the measurement's sigma.
  double told_um = 0, made_um = 0, sigma_um = 0;
  double wanted_um = 0;   ///< in board.json
  double depth_um = 0;    ///< of the design: as wanted, or the nearest in the machine's table
  double command_um = 0;  ///< commanded for it

  bool as_wanted() const { return std::abs(depth_um - wanted_um) < 0.01; }
};

/// Computes the depth of round `number`. Returns nothing without a measured depth, and if the measured depth agrees
/// with the commanded one within two sigmas or 3 %. Throws Error for unreadable files.
std::optional<RoundDepth> depth_of_round(const Project& project, const LoopOptions& options, int number);

/// Returns a sentence with the measured depth, the design's depth and the commanded one, with their sigmas.
std::string in_words(const RoundDepth& depth);

}  // namespace burin
