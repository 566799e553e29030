// tools/loop/unknown.h - parameters of the next design that a round's photos left undetermined.
//
// Undetermined or weakly determined depths and lamp places of the design stop it: such a design would be a guess.
// Undetermined roughness and machine map stop it too; weakly determined ones give a note. Lamps of no picture (placed
// for a photo only) stop nothing.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/scene/bench.h"
#include "burin/scene/verdict.h"
#include "tools/loop/stages.h"

namespace burin {

/// One undetermined or weakly determined parameter.
struct UnknownParameter {
  std::string name;  ///< as in bench.json: "depth_um"
  Verdict verdict;
};

/// Returns the parameters of a measured bench that stop the next design. `lamps`: the design's lamps, by their names in
/// this bench.
std::vector<UnknownParameter> unknown_in(const Bench& measured, const std::set<std::string>& lamps);

/// Returns a note, with the sigma, for each weakly determined parameter that stops nothing. `file`: the bench's.
std::vector<Finding> weakly_known_in(const Bench& measured, const std::filesystem::path& file);

/// Open parameters of a measured round.
struct ToldByRound {
  std::vector<UnknownParameter> open;  ///< stops the next design
  /// would stop it, but the user accepted it: on this command line, earlier, or in loop.toml
  std::vector<UnknownParameter> accepted;
  std::vector<Finding> weak;  ///< by weakly_known_in()
};

/// Checks a measured round. `accepted`: from the command line, in addition to earlier ones. Throws Error if bench.json
/// or the inputs of its matching (tools/round_names.h) are unreadable. Skips unmatched lamps; the design asks for their
/// names.
ToldByRound told_by_round(const LoopProject& loop, int round, const std::vector<std::string>& accepted = {});

/// Returns, per parameter, a line with the reason and a line with the missing photo.
std::string in_words(const std::vector<UnknownParameter>& unknown);

/// "depth_um is not determined", "alpha, depth_um are not determined; light.lamp.position_mm is determined only
/// weakly".
std::string in_short(const std::vector<UnknownParameter>& unknown);

}  // namespace burin
