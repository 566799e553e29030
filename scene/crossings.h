// burin/scene/crossings.h - grooves that cut into each other: the remaining parts of scratches at crossings. Frame:
// board, mm. docs/model.md 7.6, 7.10.
//
// By default the renderer adds the light of crossing scratches. A pressed groove replaces an earlier one and interrupts
// it. Cut grooves leave the lower of their surfaces, independent of their order. Towards a crossing each cut groove
// becomes narrower, as if it were shallower, because the other one has removed its rims. Crossings::deepest cuts center
// lines under other grooves, in steps of the width. The remaining area is exact for grooves that cross fully, at any
// angle, and right on average for grooves that touch or overlap sideways. Burrs remain outside all other grooves,
// independent of the order.
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

/// Crossing rule: light and areas of crossing grooves add, only the last carved groove remains, or the lowest surface
/// remains.
enum class Crossings { add, last, deepest };

/// The rule in words, such as "the lower surface is seen".
std::string_view in_words(Crossings crossings);

/// Names in files and options.
inline constexpr std::array<std::pair<Crossings, std::string_view>, 3> kCrossingsNames{
    {{Crossings::add, "add"}, {Crossings::last, "last"}, {Crossings::deepest, "deepest"}}};

/// An end of a piece of a scratch.
struct PieceEnd {
  using Boundary = LineBoundary;  ///< cause of the end
  double at = 0;                  ///< along the scratch: 0 its first end, 1 its last
  Boundary boundary = Boundary::own_end;
  std::uint32_t cutter = 0;  ///< the row of the groove that cuts it
  /// Distance of the cutting line from the middle of that groove, um, and its change per um of additional depth of this
  /// groove and of the other.
  double reach_um = 0, reach_by_depth = 0, reach_by_cutter_depth = 0;
};

/// Scratches::left of a piece with its whole width whose burrs are over another groove.
inline constexpr double kAllButBurrs = 1 - 1e-9;

/// The pieces that crossings leave of scratches, in carving order.
struct VisiblePieces {
  /// Pieces carry width, depth and alpha if their sources do. A narrowed piece has the depth that gives its width
  /// (`left` is the remaining fraction).
  Scratches pieces;
  std::vector<std::uint32_t> source;  ///< the source row of each piece
  std::vector<PieceEnd> begin, end;   ///< of each piece
};

/// A part of a groove's width along its whole length. `from` and `to` are fractions: of the half-width, from -1 at the
/// left rim to 1 at the right one; of a burr's width, from 0 at the rim.
struct Lane {
  /// The part of a groove that a lane covers.
  enum class Part : std::uint8_t { groove, left_burr, right_burr };
  Part part = Part::groove;
  double from = 0, to = 0;

  /// True for the same part of the same groove.
  bool operator==(const Lane&) const = default;
};

/// Remaining parts of each groove: for every lane and every cell along the groove, the visible fraction of its length.
/// Pieces are equally wide to the left and right. Lanes are cut at their own places: an oblique crossing removes one
/// side earlier.
struct VisibleLanes {
  std::vector<Lane> lanes;         ///< of each groove, from left to right, burrs last
  std::vector<std::size_t> first;  ///< first cell of each groove, and one more entry; a groove's cells are equally long
  std::vector<float> share;        ///< lane by lane of each cell
  /// Derivative by the logarithm of the depth of all grooves; empty if equally low walls bound the visible parts,
  /// because those bounds do not move.
  std::vector<float> share_by_depth;
};

/// Lanes across a groove: `count` lanes, and two per burr.
std::vector<Lane> lanes_across(const GrooveProfile& profile, int count);

/// The middle of a lane, um to the right of the groove's middle, and the lane's width there.
struct LanePlace {
  double middle_um = 0, width_um = 0;
};
LanePlace lane_place(const Lane& lane, double half_width_um, double burr_width_um);

/// Computes the parts of each groove that later grooves (Crossings::last) or all others (Crossings::deepest) leave, in
/// cells of about `cell_mm`. `order` is the rank of each groove in carving order. Widths and depths as in
/// visible_pieces().
VisibleLanes visible_lanes(const Scratches& grooves, std::span<const std::uint32_t> order, double tool_width_um,
                           double depth_um, const GrooveProfile& profile, Crossings rule, int count, double cell_mm);

/// Number of steps in which Crossings::deepest removes a groove's width: the usual and the largest. A crossing leaves
/// up to 2 steps - 1 additional pieces. If grooves cover a fraction c of the board, the visible area of walls of one
/// lean is wrong by up to c / (2 steps). The mean over all leans is right.
inline constexpr int kCrossingSteps = 3, kMostCrossingSteps = 8;

/// Number of steps that keeps this error below 4.5 % for a covered fraction of the board; at most kMostCrossingSteps.
int crossing_steps_for(double covered);

/// Cuts scratches by all later ones (Crossings::last), or by all others (Crossings::deepest, in `steps` of their
/// width). Widths and depths come from the scratches, otherwise from the two arguments. Throws Error if the pieces
/// outnumber the scratches by more than limit::kCuts. Throws Error before any work for more than limit::kNear pairs of
/// near scratches.
VisiblePieces visible_pieces(const Scratches& carved, double tool_width_um, double depth_um,
                             const GrooveProfile& profile = {}, Crossings rule = Crossings::last,
                             int steps = kCrossingSteps);

/// True if that rule, with the usual steps, makes more than `most` pieces, or if too many scratches are near each
/// other.
bool are_more_pieces(const Scratches& carved, double tool_width_um, double depth_um, const GrooveProfile& profile,
                     Crossings rule, std::size_t most);

/// Approximate number of pieces of Crossings::deepest, with the usual steps, for grooves in random directions all over
/// an area. Together they cross (2 / pi) (sum of lengths)^2 / area others. Each crossing adds two pieces, up to five if
/// crossings are few and one if they are dense.
double expected_pieces(const Scratches& scratches, double area_mm2);
/// Number of pieces that crossings add, for grooves with this total length.
double expected_pieces(double length_mm, double area_mm2);

}  // namespace burin
