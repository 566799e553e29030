// burin/optimize/toolpath/carving_limits.h - what may be carved on a board by a machine: the rules, whether scratches
// obey them, and scratches made to obey them.
//
// Frame: board, mm. The rules, each exact:
//   area      both ends lie in the board's carve area
//   keep-out  the groove (its line widened by its half-width) stays off every keep-out and off the tags' paper
//   length    from end to end, shortest to longest
//   step      both ends, taken back through the machine's measured map to what it is told, lie on multiples of the step
//             in x and in y (as well as the file's five decimals tell)
//   distance  two scratches that do not cross keep this distance between their lines
//   overlap   the parts of a groove that other grooves take, added up over them, are no more than this share of it
//   grooves   no place lies in more than this many grooves
//   width     wt is the tool's: a scratch with a width of its own has that one
// What is in the metal already (Scratches::carved) is not judged, but counts for its neighbors' distance and overlap.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "burin/optimize/machine_profile.h"
#include "burin/scene/board.h"
#include "burin/scene/scratches.h"

namespace burin {

/// What a machine can carve on a board, in one place.
struct CarvingLimits {
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};  ///< the carve area
  std::vector<KeepOut> keep_out;               ///< the tags' paper included; only what reaches into the area
  MachineLimits machine;
  double width_um = 0;  ///< the tool's
  double depth_um = 0;  ///< of grooves without a depth of their own
  Eigen::Matrix<double, 2, 3> affine = Eigen::Matrix<double, 2, 3>::Identity();  ///< told to the machine -> carved
};

/// How near to a multiple of the step an end counts as on it: the file's five decimals, through the machine's map.
inline constexpr double kOnStep_mm = 3e-5;

/// The rules for this board and machine. `affine` is the bench's machine.affine, `depth_um` its material's.
CarvingLimits carving_limits(const Board& board, const MachineLimits& machine, double depth_um,
                             const Eigen::Matrix<double, 2, 3>& affine);

/// Whether any rule concerns pairs of scratches (distance, overlap, grooves).
bool has_pair_rules(const MachineLimits& machine);

enum class Rule { area, keep_out, shortest, longest, step, distance, overlap, grooves, width };
inline constexpr std::size_t kRules = 9;

/// A word for it: "keep-out", "shortest length".
const char* rule_name(Rule rule);

/// Whether scratches can be carved, and what to do if not.
struct LimitsCheck {
  std::array<std::size_t, kRules> broken{};  ///< scratches that break each rule
  std::string first;                         ///< the first in the file: which row, what is wrong
  std::string remedy;

  /// Whether no rule is broken.
  bool good() const;
};

/// Judges every scratch. `edge_tolerance_mm`: by how much ends may leave the carve area.
LimitsCheck check_limits(const Scratches& scratches, const CarvingLimits& limits, double edge_tolerance_mm = 0);

/// Throws Error where rules concern pairs of scratches, and these lie so near one another that judging or mending them
/// would take hours (limit::kNear). Quick.
void fail_if_crowded(const Scratches& scratches, const CarvingLimits& limits);

/// Throws Error with the first fault and how many there are of each kind, unless the check is good.
void fail_unless_good(const LimitsCheck& check, const std::string& name);

/// Moves a scratch, as little as is easy, to where it obeys the rules that concern it alone (area, keep-out, length):
/// into the area, cut off at a keep-out, lengthened or shortened about its middle. Where that does not help it takes
/// the ends it had before if those obey; otherwise it stays as it came and false is returned.
bool confine(Scratches& scratches, std::size_t index, const CarvingLimits& limits, const Eigen::Vector2d& a_before_mm,
             const Eigen::Vector2d& b_before_mm);

/// Scratches within all rules.
struct Mended {
  Scratches scratches;                        ///< ends on steps, or on the file's decimals where there is no step
  std::vector<std::size_t> rows;              ///< of the scratches given, for each kept one, ascending
  std::array<std::size_t, kRules> dropped{};  ///< by the rule that they could not obey
  std::vector<std::optional<Rule>> broken;    ///< of each scratch given: the rule it was dropped for
  double moved_mm = 0;                        ///< the farthest that an end of a kept one moved
};

/// Confines each scratch, puts its ends on steps, and keeps one after the other, the worthiest first. One that would
/// break a rule of pairs with those kept before goes aside, grows or shrinks by up to 2.4 times the least distance, or
/// is cut off to no less than half its length; where that does not help it is dropped. `worth`: one each, or empty for
/// the file's order. What is in the metal already is kept as it is.
Mended mend(const Scratches& scratches, const CarvingLimits& limits, std::span<const double> worth = {});

/// "12 for their length, 3 for overlap", or nothing.
std::string dropped_text(const std::array<std::size_t, kRules>& dropped);

}  // namespace burin
