// tools/loop/unknown.h - what the photos of a round left open although the next design rests on it.
//
// Depth and the places of the lamps that the design uses stop it unless they are determined: a design for a depth or a
// lamp that is known only weakly is a guess too. Roughness and the machine's map stop it where the photos do not tell
// them at all; where they tell them weakly, that is said. Lamps that no picture uses (one that was put somewhere for a
// photo) stop nothing.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/scene/bench.h"
#include "burin/scene/verdict.h"
#include "tools/loop/stages.h"

namespace burin {

/// One parameter that is not determined, or only weakly.
struct UnknownParameter {
  std::string name;  ///< as in bench.json: "depth_um"
  Verdict verdict;
};

/// Of a measured bench, what stops another design. `lamps`: those that the design uses, as this bench calls them.
std::vector<UnknownParameter> unknown_in(const Bench& measured, const std::set<std::string>& lamps);

/// A note for each number that stops nothing although the photos tell it only weakly, with its sigma. `file`: the
/// bench's.
std::vector<Finding> weakly_known_in(const Bench& measured, const std::filesystem::path& file);

/// What a round told, against what the next design needs.
struct ToldByRound {
  std::vector<UnknownParameter> open;      ///< stops it
  std::vector<UnknownParameter> accepted;  ///< would, but a person said to go on: now, then, or in loop.toml
  std::vector<Finding> weak;               ///< by weakly_known_in()
};

/// Of a measured round. `accepted`: what the command line says, beside what is known. Throws Error where bench.json or
/// what it is matched with (tools/round_names.h) cannot be read. Lamps that are not matched yet are not looked at:
/// whoever designs asks which they are.
ToldByRound told_by_round(const LoopProject& loop, int round, const std::vector<std::string>& accepted = {});

/// What is not known, why, and which photo would tell: one parameter a line, each with a line for the photo.
std::string in_words(const std::vector<UnknownParameter>& unknown);

/// "depth_um is not determined", "alpha, depth_um are not determined; light.lamp.position_mm is determined only
/// weakly".
std::string in_short(const std::vector<UnknownParameter>& unknown);

}  // namespace burin
