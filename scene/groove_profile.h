// burin/scene/groove_profile.h - the cross-section of grooves that are not the paper's: an arc, a rounded V, burrs
// beside them, roughness that differs along and across. Frame: scratch (y along it, x across it, z out of the metal).
// Units: um. docs/model.md 2.5 to 2.8, 3.7, and 4.24 to 4.26.
//
// d (depth_um) is always the depth under the face. The radius at the bottom is a quarter of the tool's width, as it is
// for the paper's cross-section (docs/model.md 2), unless the profile has its own.
#pragma once

#include <vector>

namespace burin {

/// What a groove is across, beside its depth and the tool's width.
struct GrooveProfile {
  /// paper: docs/model.md 2.1. rounded_v: an arc of a circle up to the flanks' slope, straight from there.
  enum class Kind { paper, rounded_v };
  Kind kind = Kind::paper;
  /// Of a rounded V: how steep its flanks are. Grooves too shallow for flanks are arcs.
  double flank_deg = 45;
  /// Radius at the bottom; 0: a quarter of the tool's width.
  double tip_radius_um = 0;
  /// Burrs: parabolas beside the groove, left and right of the way carved.
  double burr_left_um = 0, burr_right_um = 0, burr_width_um = 10;
  /// Roughness across the groove over that along it (Material::alpha).
  double across = 1;

  bool has_burrs() const { return burr_left_um != 0 || burr_right_um != 0; }
  /// The paper's cross-section: its closed form holds.
  bool is_paper() const { return kind == Kind::paper && across == 1 && !has_burrs(); }
  bool operator==(const GrooveProfile&) const = default;
};

/// A part of the cross-section of which the wall's lean is monotonic in x: x from `from_um` to `to_um`, the wall's
/// normal leaning by `from_lean` to `to_lean` (radians; the normal is (-sin, 0, cos) of it: a wall that rises to the
/// right leans by a positive angle). `shape` says how x goes with the lean within it.
struct ProfileBand {
  /// circle: dx ~ cos(lean); paper: dx ~ 1 / cos^2(lean / 2); parabola: dx ~ 1 / cos^2(lean); flank: one lean
  enum class Shape { circle, paper, parabola, flank };
  Shape shape = Shape::flank;
  double from_um = 0, to_um = 0, from_lean = 0, to_lean = 0;
  double from_by_depth = 0, to_by_depth = 0;            ///< d(from_um, to_um) / d(depth_um)
  double from_lean_by_depth = 0, to_lean_by_depth = 0;  ///< d(lean) / d(depth_um)
  double from_by_width = 0, to_by_width = 0;            ///< d(from_um, to_um) / d(width_um)
  double depth_for_width = 0;  ///< leans change with the tool's width as they do with so many times the depth
  double from_sine = 0, from_cosine = 1, to_sine = 0, to_cosine = 1;  ///< of the leans, which every pixel asks for
};

/// Half-width w where the wall meets the face, burrs not counted: the profile's w(d), um.
double half_width_um(const GrooveProfile& profile, double width_um, double depth_um);

/// The depth of a groove of that half-width, um: half_width_um() the other way around.
double depth_at_half_width_um(const GrooveProfile& profile, double width_um, double half_width_um);

/// d(half_width_um) / d(depth_um).
double half_width_slope(const GrooveProfile& profile, double width_um, double depth_um);

/// The wall's lean at x from the middle of a groove that is deep enough to reach there, radians. It does not depend on
/// how deep.
double wall_lean(const GrooveProfile& profile, double width_um, double x_um);
/// The lean at x from the middle of a burr so high, radians.
double burr_lean(double height_um, double width_um, double x_um);
/// Where a groove's curve ends and its flanks begin, um; infinity where there are none.
double flank_begin_um(const GrooveProfile& profile, double width_um);

/// Whether grooves so deep have flanks; else an arc is all there is of a rounded V. Not of the paper's.
bool reaches_flanks(const GrooveProfile& profile, double width_um, double depth_um);

/// The whole section, left to right; arcs and burrs are cut into bands at most `widest_um` wide.
std::vector<ProfileBand> profile_bands(const GrooveProfile& profile, double width_um, double depth_um,
                                       double widest_um = 15);

/// The section's outermost x, burrs included: left (negative) and right, um.
struct ProfileReach {
  double left_um, right_um;
};
ProfileReach profile_reach(const GrooveProfile& profile, double width_um, double depth_um);

}  // namespace burin
