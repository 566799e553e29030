#include "burin/scene/groove_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "burin/scene/groove.h"

namespace burin {
namespace {

using Shape = ProfileBand::Shape;

double tip_radius_um(const GrooveProfile& profile, double width_um) {
  return profile.tip_radius_um > 0 ? profile.tip_radius_um : width_um / 4;
}

// The right half of the groove: the arc's end (its lean, its x), and the point at which the wall meets the face, each
// with its derivative by depth. In a groove too shallow for flanks, the arc ends at the rim.
struct HalfSection {
  double arc_lean, arc_lean_by_depth = 0, arc_um, arc_by_depth = 0, rim_um, rim_by_depth;
  bool flank = false;
};

HalfSection half_section(const GrooveProfile& profile, double width_um, double depth_um) {
  const double R = tip_radius_um(profile, width_um);
  if (profile.kind == GrooveProfile::Kind::paper) {
    const double rim = groove_rim(4 * R, depth_um), lean = 2 * std::atan(rim);
    const double rim_by_depth = std::exp(-depth_um / (2 * R)) / (4 * R * rim);
    return {
        lean, 2 * rim_by_depth / (1 + rim * rim), 2 * R * rim, 2 * R * rim_by_depth, 2 * R * rim, 2 * R * rim_by_depth};
  }
  const double flank = profile.flank_deg * std::numbers::pi / 180, arc_depth = R * (1 - std::cos(flank));
  if (depth_um <= arc_depth) {
    const double lean = std::acos(1 - depth_um / R), x = R * std::sin(lean);
    const double lean_by_depth = 1 / (R * std::sin(lean)), x_by_depth = std::cos(lean) / std::sin(lean);
    return {lean, lean_by_depth, x, x_by_depth, x, x_by_depth};
  }
  const double x = R * std::sin(flank), tangent = std::tan(flank);
  return {flank, 0, x, 0, x + (depth_um - arc_depth) / tangent, 1 / tangent, true};
}

// x of a lean on the groove's own curve.
double x_at(const GrooveProfile& profile, double width_um, double lean) {
  const double R = tip_radius_um(profile, width_um);
  return profile.kind == GrooveProfile::Kind::paper ? 2 * R * std::tan(lean / 2) : R * std::sin(lean);
}

// A parabola of height h over x from `from` to `from + width`: it rises from the left and falls to the right.
void add_burr(double h, double width, double from, double moves, double widest_um, std::vector<ProfileBand>& out) {
  if (!(h > 0)) return;
  // Two halves at least: the part near the groove blends into its wall.
  const int bands = std::max(2, static_cast<int>(std::ceil(width / widest_um)));
  for (int k = 0; k < bands; ++k) {
    ProfileBand band;
    band.shape = Shape::parabola;
    band.from_um = from + k * width / bands;
    band.to_um = from + (k + 1) * width / bands;
    band.from_lean = burr_lean(h, width, width * k / bands - width / 2);
    band.to_lean = burr_lean(h, width, width * (k + 1) / bands - width / 2);
    band.from_by_depth = band.to_by_depth = moves;
    out.push_back(band);
  }
}

}  // namespace

double half_width_um(const GrooveProfile& profile, double width_um, double depth_um) {
  if (profile.is_paper()) return half_width_um(width_um, depth_um);
  return half_section(profile, width_um, depth_um).rim_um;
}

double flank_begin_um(const GrooveProfile& profile, double width_um) {
  if (profile.kind == GrooveProfile::Kind::paper) return std::numeric_limits<double>::infinity();
  return tip_radius_um(profile, width_um) * std::sin(profile.flank_deg * std::numbers::pi / 180);
}

bool reaches_flanks(const GrooveProfile& profile, double width_um, double depth_um) {
  return half_width_um(profile, width_um, depth_um) > flank_begin_um(profile, width_um);
}

double depth_at_half_width_um(const GrooveProfile& profile, double width_um, double half_width_um) {
  const double R = tip_radius_um(profile, width_um), t = half_width_um / (2 * R);
  if (profile.kind == GrooveProfile::Kind::paper) return -2 * R * std::log1p(-t * t);
  const double flank = profile.flank_deg * std::numbers::pi / 180, arc_um = flank_begin_um(profile, width_um);
  if (half_width_um <= arc_um) return R - std::sqrt(R * R - half_width_um * half_width_um);
  return R * (1 - std::cos(flank)) + (half_width_um - arc_um) * std::tan(flank);
}

double half_width_slope(const GrooveProfile& profile, double width_um, double depth_um) {
  return half_section(profile, width_um, depth_um).rim_by_depth;
}

double wall_lean(const GrooveProfile& profile, double width_um, double x_um) {
  const double R = tip_radius_um(profile, width_um);
  if (profile.kind == GrooveProfile::Kind::paper) return 2 * std::atan(x_um / (2 * R));
  const double arc_um = flank_begin_um(profile, width_um);
  return std::asin(std::clamp(x_um, -arc_um, arc_um) / R);
}

double burr_lean(double height_um, double width_um, double x_um) {
  return std::atan(-8 * height_um * x_um / (width_um * width_um));
}

ProfileReach profile_reach(const GrooveProfile& profile, double width_um, double depth_um) {
  const double w = half_width_um(profile, width_um, depth_um);
  return {-w - (profile.burr_left_um > 0 ? profile.burr_width_um : 0),
          w + (profile.burr_right_um > 0 ? profile.burr_width_um : 0)};
}

std::vector<ProfileBand> profile_bands(const GrooveProfile& profile, double width_um, double depth_um,
                                       double widest_um) {
  const HalfSection half = half_section(profile, width_um, depth_um);
  std::vector<ProfileBand> out;
  add_burr(profile.burr_left_um, profile.burr_width_um, -half.rim_um - profile.burr_width_um, -half.rim_by_depth,
           widest_um, out);
  const auto flank = [&](int side) {
    if (!half.flank) return;
    ProfileBand band;
    band.shape = Shape::flank;
    band.from_lean = band.to_lean = side * half.arc_lean;
    band.from_um = side < 0 ? -half.rim_um : half.arc_um;
    band.to_um = side < 0 ? -half.arc_um : half.rim_um;
    (side < 0 ? band.from_by_depth : band.to_by_depth) = side * half.rim_by_depth;
    out.push_back(band);
  };
  flank(-1);
  const int bands = std::max(2, static_cast<int>(std::ceil(2 * half.arc_um / widest_um)));
  for (int k = 0; k < bands; ++k) {
    ProfileBand band;
    band.shape = profile.kind == GrooveProfile::Kind::paper ? Shape::paper : Shape::circle;
    const double a = 2.0 * k / bands - 1, b = 2.0 * (k + 1) / bands - 1;
    band.from_lean = a * half.arc_lean;
    band.to_lean = b * half.arc_lean;
    band.from_um = x_at(profile, width_um, band.from_lean);
    band.to_um = x_at(profile, width_um, band.to_lean);
    const double R = tip_radius_um(profile, width_um);
    const auto x_by_lean = [&](double lean) {
      return profile.kind == GrooveProfile::Kind::paper ? R / std::pow(std::cos(lean / 2), 2) : R * std::cos(lean);
    };
    band.from_lean_by_depth = a * half.arc_lean_by_depth;
    band.to_lean_by_depth = b * half.arc_lean_by_depth;
    band.from_by_depth = x_by_lean(band.from_lean) * band.from_lean_by_depth;
    band.to_by_depth = x_by_lean(band.to_lean) * band.to_lean_by_depth;
    out.push_back(band);
  }
  flank(1);
  add_burr(profile.burr_right_um, profile.burr_width_um, half.rim_um, half.rim_by_depth, widest_um, out);
  // A section without its own radius scales as a whole with width and depth; burrs move with its rims.
  const bool grows = profile.tip_radius_um == 0;
  for (ProfileBand& band : out) {
    if (grows) {
      const bool is_burr = band.shape == Shape::parabola;
      const double side = std::copysign(half.rim_um, band.to_um);
      band.from_by_width = ((is_burr ? side : band.from_um) - depth_um * band.from_by_depth) / width_um;
      band.to_by_width = ((is_burr ? side : band.to_um) - depth_um * band.to_by_depth) / width_um;
      band.depth_for_width = -depth_um / width_um;
    }
    band.from_sine = std::sin(band.from_lean);
    band.from_cosine = std::cos(band.from_lean);
    band.to_sine = std::sin(band.to_lean);
    band.to_cosine = std::cos(band.to_lean);
  }
  return out;
}

}  // namespace burin
