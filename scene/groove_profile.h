// burin/scene/groove_profile.h - cross-sections other than the paper's: an arc, a rounded V, burrs next to the groove,
// anisotropic roughness.
// Frame: scratch (y along it, x across it, z out of the metal). Units: um. docs/model.md 2.5 to 2.8, 3.7, and 4.24 to
// 4.26.
//
// d (depth_um) is always the depth under the face. The radius at the bottom is a quarter of the tool's width, as for
// the paper's cross-section (docs/model.md 2), unless the profile has its own.
#pragma once

#include <vector>

namespace burin {

/// Shape of a groove's cross-section, without its depth and the tool's width.
struct GrooveProfile {
  /// paper: docs/model.md 2.1. rounded_v: a circular arc that continues tangentially in straight flanks.
  enum class Kind { paper, rounded_v };
  Kind kind = Kind::paper;
  /// Slope of a rounded V's flanks. Grooves too shallow for flanks are arcs.
  double flank_deg = 45;
  /// Radius at the bottom; 0: a quarter of the tool's width.
  double tip_radius_um = 0;
  /// Burrs: parabolas next to the groove, left and right of the carving direction.
  double burr_left_um = 0, burr_right_um = 0, burr_width_um = 10;
  /// Ratio of the roughnesses across the groove and along it (Material::alpha).
  double across = 1;

  /// True if either side has a burr.
  bool has_burrs() const { return burr_left_um != 0 || burr_right_um != 0; }
  /// True for the paper's cross-section, which has a closed form.
  bool is_paper() const { return kind == Kind::paper && across == 1 && !has_burrs(); }
  /// True if all numbers are equal.
  bool operator==(const GrooveProfile&) const = default;
};

/// A part of the cross-section with a monotonic lean of the wall: x from `from_um` to `to_um`, lean from `from_lean` to
/// `to_lean`, radians. The wall's normal is (-sin, 0, cos) of the lean: a wall that rises to the right has a positive
/// one. `shape` relates x and lean within the band.
struct ProfileBand {
  /// circle: dx ~ cos(lean); paper: dx ~ 1 / cos^2(lean / 2); parabola: dx ~ 1 / cos^2(lean); flank: one lean
  enum class Shape { circle, paper, parabola, flank };
  Shape shape = Shape::flank;
  double from_um = 0, to_um = 0, from_lean = 0, to_lean = 0;
  double from_by_depth = 0, to_by_depth = 0;            ///< d(from_um, to_um) / d(depth_um)
  double from_lean_by_depth = 0, to_lean_by_depth = 0;  ///< d(lean) / d(depth_um)
  double from_by_width = 0, to_by_width = 0;            ///< d(from_um, to_um) / d(width_um)
  double depth_for_width = 0;  ///< derivatives of the leans by width are those by depth times this factor
  /// Sines and cosines of the leans, precomputed because every pixel needs them.
  double from_sine = 0, from_cosine = 1, to_sine = 0, to_cosine = 1;
};

/// Half-width w at which the wall meets the face, without burrs: the profile's w(d), um.
double half_width_um(const GrooveProfile& profile, double width_um, double depth_um);

/// The depth of a groove with this half-width, um: the inverse of half_width_um().
double depth_at_half_width_um(const GrooveProfile& profile, double width_um, double half_width_um);

/// d(half_width_um) / d(depth_um).
double half_width_slope(const GrooveProfile& profile, double width_um, double depth_um);

/// The wall's lean at x from the groove's middle, radians. It does not depend on the depth, if the groove reaches x.
double wall_lean(const GrooveProfile& profile, double width_um, double x_um);
/// The lean at x from the middle of a burr, radians.
double burr_lean(double height_um, double width_um, double x_um);
/// Transition from a groove's curve to its flanks, um; infinity for a profile without flanks.
double flank_begin_um(const GrooveProfile& profile, double width_um);

/// True if a groove of this depth has flanks; a shallower rounded V is only an arc. Not for the paper's profile.
bool reaches_flanks(const GrooveProfile& profile, double width_um, double depth_um);

/// The whole section, left to right. Arcs and burrs are split into bands at most `widest_um` wide.
std::vector<ProfileBand> profile_bands(const GrooveProfile& profile, double width_um, double depth_um,
                                       double widest_um = 15);

/// The section's outermost x, burrs included: left (negative) and right, um.
struct ProfileReach {
  double left_um, right_um;
};
ProfileReach profile_reach(const GrooveProfile& profile, double width_um, double depth_um);

}  // namespace burin
