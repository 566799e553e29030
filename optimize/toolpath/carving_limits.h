// burin/optimize/toolpath/carving_limits.h - carving limits of a board and a machine: rules, check and repair.
//
// Frame: board, mm. The rules, each exact:
//   area      both ends lie in the board's carve area
//   keep-out  the groove (its line widened by its half-width) avoids every keep-out and the tags' paper
//   length    from end to end, shortest to longest
//   step      both commanded ends (through the inverse of the measured map) lie on multiples of the step in x and in y
//             (up to the file's five decimals)
//   distance  two scratches that do not cross keep this distance between their lines
//   overlap   the sum of a groove's parts covered by other grooves is at most this share of it
//   grooves   no place lies in more than this many grooves
//   width     wt is the tool's: a scratch with a width of its own has that one
// Scratches already in the metal (Scratches::carved) are not judged, but count for their neighbors' distance and
// overlap.
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

/// All limits for carving with a machine on a board.
struct CarvingLimits {
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};  ///< the carve area
  std::vector<KeepOut> keep_out;               ///< places within the area or partly so, the tags' paper included
  MachineLimits machine;
  double width_um = 0;  ///< the tool's
  double depth_um = 0;  ///< of grooves without a depth of their own
  Eigen::Matrix<double, 2, 3> affine = Eigen::Matrix<double, 2, 3>::Identity();  ///< commanded -> carved
};

/// Largest distance of an end on a step from the multiple: the file's five decimals, through the machine's map.
inline constexpr double kOnStep_mm = 3e-5;

/// The rules for this board and machine. `affine` is the bench's machine.affine, `depth_um` its material's.
CarvingLimits carving_limits(const Board& board, const MachineLimits& machine, double depth_um,
                             const Eigen::Matrix<double, 2, 3>& affine);

/// True if any rule concerns pairs of scratches (distance, overlap, grooves).
bool has_pair_rules(const MachineLimits& machine);

enum class Rule { area, keep_out, shortest, longest, step, distance, overlap, grooves, width };
inline constexpr std::size_t kRules = 9;

/// Name for people: "keep-out", "shortest length".
const char* rule_name(Rule rule);

/// Result of a check, with the remedy.
struct LimitsCheck {
  std::array<std::size_t, kRules> broken{};  ///< number of scratches in violation of each rule
  std::string first;                         ///< the first in the file: its row and fault
  std::string remedy;

  /// True if no rule is broken.
  bool good() const;
};

/// Judges every scratch. `edge_tolerance_mm` is the permitted excess of ends beyond the carve area.
LimitsCheck check_limits(const Scratches& scratches, const CarvingLimits& limits, double edge_tolerance_mm = 0);

/// Throws Error if rules concern pairs of scratches, and these are so dense that their check or repair would take hours
/// (limit::kNear). Fast.
void fail_if_crowded(const Scratches& scratches, const CarvingLimits& limits);

/// Throws Error with the first fault and the number of each kind, unless the check is good.
void fail_unless_good(const LimitsCheck& check, const std::string& name);

/// Projects a scratch to the rules that concern it alone (area, keep-out, length), with a small move. It moves the
/// scratch into the area, cuts it at a keep-out, and lengthens or shortens it about its middle. If this fails, it
/// restores the previous ends if they obey. Otherwise it leaves the scratch unchanged and returns false.
bool confine(Scratches& scratches, std::size_t index, const CarvingLimits& limits, const Eigen::Vector2d& a_before_mm,
             const Eigen::Vector2d& b_before_mm);

/// Scratches within all rules.
struct Mended {
  Scratches scratches;                        ///< ends on steps, or on the file's decimals without a step
  std::vector<std::size_t> rows;              ///< rows of the input, one per kept scratch, ascending
  std::array<std::size_t, kRules> dropped{};  ///< by their unsatisfied rule
  std::vector<std::optional<Rule>> broken;    ///< rule of each dropped scratch of the input
  double moved_mm = 0;                        ///< largest move of an end of a kept scratch
};

/// Repairs scratches: confines each, puts its ends on steps, and keeps them one by one in the order of their marginal
/// contribution. A scratch that would break a pair rule with kept ones is moved, lengthened or shortened by up to 2.4
/// times the least distance, or cut to no less than half its length. If this fails, it is dropped. `worth` has one
/// value per scratch, or is empty for the file's order. Scratches already in the metal stay unchanged.
Mended mend(const Scratches& scratches, const CarvingLimits& limits, std::span<const double> worth = {});

/// "12 for their length, 3 for overlap", or nothing.
std::string dropped_text(const std::array<std::size_t, kRules>& dropped);

}  // namespace burin
