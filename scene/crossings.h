// burin/scene/crossings.h - grooves that cut into each other: what is left of scratches where they cross.
// Frame: board, mm. docs/model.md 7.6, 7.10.
//
// The renderer adds what crossing scratches send. A groove that is pressed replaces an earlier one, which is
// interrupted. Of grooves that are cut, the lower surface is left, whichever came first: towards a crossing each
// becomes narrower, as if it were shallower, because the other has taken its rims. Cutting center lines where others
// cover them, in steps of the width, keeps the area that is left exactly for grooves that cross fully, at any angle,
// and is right on average for those that touch or overlap sideways. Burrs are left where no other groove is, whichever
// came first.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "burin/scene/groove_profile.h"
#include "burin/scene/line_cuts.h"
#include "burin/scene/scratches.h"

namespace burin {

/// What happens where grooves cross: their light and areas add, only the groove carved last is left, or the lower
/// surface of all is.
enum class Crossings { add, last, deepest };

/// "the lower surface is seen"
std::string_view in_words(Crossings crossings);

/// As files and options name them.
inline constexpr std::array<std::pair<Crossings, std::string_view>, 3> kCrossingsNames{
    {{Crossings::add, "add"}, {Crossings::last, "last"}, {Crossings::deepest, "deepest"}}};

/// Where a piece of a scratch begins or ends.
struct PieceEnd {
  using Boundary = LineBoundary;  ///< what ends it there
  double at = 0;                  ///< along the scratch: 0 its first end, 1 its last
  Boundary boundary = Boundary::own_end;
  std::uint32_t cutter = 0;  ///< the row of that groove
  /// How far from the middle of that groove the line along it lies, um, and what it moves as this groove, or that one,
  /// becomes a um deeper.
  double reach_um = 0, reach_by_depth = 0, reach_by_cutter_depth = 0;
};

/// Scratches::left of a piece that has its whole width, but whose burrs lie over another groove.
inline constexpr double kAllButBurrs = 1 - 1e-9;

/// The pieces of scratches that others leave, in carving order.
struct VisiblePieces {
  /// Width, depth and alpha are those of the source where it carries them; what is left of a groove that others
  /// narrow has the depth that makes it as wide (`left` says how much that is).
  Scratches pieces;
  std::vector<std::uint32_t> source;  ///< the row that each is a piece of
  std::vector<PieceEnd> begin, end;   ///< of each
};

/// A part of a groove's width that runs along all of it. `from` and `to` are shares: of the half-width, from -1 at the
/// left rim to 1 at the right one; of a burr's width, from 0 at the rim.
struct Lane {
  enum class Part : std::uint8_t { groove, left_burr, right_burr };
  Part part = Part::groove;
  double from = 0, to = 0;

  bool operator==(const Lane&) const = default;
};

/// What other grooves leave of each: of every lane, cell by cell along the groove, the share of its length that is
/// seen. Unlike pieces, which are as wide to the left as to the right, lanes are cut where they lie: a groove that
/// crosses another aslant takes one side earlier.
struct VisibleLanes {
  std::vector<Lane> lanes;         ///< of each groove, from left to right, burrs last
  std::vector<std::size_t> first;  ///< cell of each groove, and one more; its cells are equally long
  std::vector<float> share;        ///< lane by lane of each cell
  /// By the logarithm of the depth of all grooves; empty where walls that are equally low bound what is seen, which
  /// stay where they are.
  std::vector<float> share_by_depth;
};

/// Across a groove: so many lanes, and two for each burr.
std::vector<Lane> lanes_across(const GrooveProfile& profile, int count);

/// The middle of a lane, um to the right of the groove's, and how wide it is there.
struct LanePlace {
  double middle_um = 0, width_um = 0;
};
LanePlace lane_place(const Lane& lane, double half_width_um, double burr_width_um);

/// Lays what later grooves (Crossings::last), or all others (Crossings::deepest), leave of each, in cells about so
/// long. `order`: the rank of each in carving order. Widths and depths as in visible_pieces().
VisibleLanes visible_lanes(const Scratches& grooves, std::span<const std::uint32_t> order, double tool_width_um,
                           double depth_um, const GrooveProfile& profile, Crossings rule, int count, double cell_mm);

/// In how many steps Crossings::deepest takes a groove's width: the usual number; and the most. A crossing leaves up to
/// 2 steps - 1 pieces more. Where grooves cover a share c of the board, walls of one lean show up to c / (2 steps) more
/// or less than they should, and in the mean over all leans as much as they should.
inline constexpr int kCrossingSteps = 3, kMostCrossingSteps = 8;

/// As many steps as keep that below 4.5 % where grooves cover this share of the board, as far as kMostCrossingSteps do.
int crossing_steps_for(double covered);

/// Cuts scratches by all later ones (Crossings::last), or by all others (Crossings::deepest, in `steps` of their
/// width). Widths and depths come from the scratches, else from the two numbers given. Throws Error where that makes
/// more than limit::kCuts pieces more than there are scratches, and before any work where they lie near one another
/// more than limit::kNear times.
VisiblePieces visible_pieces(const Scratches& carved, double tool_width_um, double depth_um,
                             const GrooveProfile& profile = {}, Crossings rule = Crossings::last,
                             int steps = kCrossingSteps);

/// Whether that rule, by the usual steps, cuts them into more pieces than `most`, or they lie too near one another.
bool are_more_pieces(const Scratches& carved, double tool_width_um, double depth_um, const GrooveProfile& profile,
                     Crossings rule, std::size_t most);

/// About how many pieces Crossings::deepest makes, by the usual steps, of grooves that lie in any direction all over an
/// area, each crossing (2 / pi) (all their lengths)^2 / area others together: two a crossing, up to five where
/// crossings are few and one where they crowd.
double expected_pieces(const Scratches& scratches, double area_mm2);
/// What crossings add to the count of grooves that are this long together.
double expected_pieces(double length_mm, double area_mm2);

}  // namespace burin
