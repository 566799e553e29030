#include "burin/simulate/groove_section.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace burin {
namespace {

// Height over the lowest point and slope of the tool's outline, x from its axis.
struct Outline {
  double height, slope;
};
Outline outline(const GrooveSection& s, double x) {
  const double a = std::abs(x), sign = x < 0 ? -1 : 1;
  if (!s.round_v) {  // docs/model.md 2.1
    const double t = a / (2 * s.radius_um);
    return {-2 * s.radius_um * std::log1p(-t * t), sign * 2 * t / (1 - t * t)};
  }
  const double steep = s.radius_um * s.flank_slope / std::hypot(1, s.flank_slope);  // end of the arc
  if (a <= steep) {
    const double root = std::sqrt(s.radius_um * s.radius_um - a * a);
    return {s.radius_um - root, sign * a / root};
  }
  const double arc = s.radius_um - std::sqrt(s.radius_um * s.radius_um - steep * steep);
  return {arc + (a - steep) * s.flank_slope, sign * s.flank_slope};
}

}  // namespace

GrooveSection section_of(const GrooveProfile& profile, double width_um, double depth_um) {
  GrooveSection s;
  s.paper = profile.is_paper();
  s.round_v = profile.kind == GrooveProfile::Kind::rounded_v;
  s.radius_um = profile.tip_radius_um > 0 ? profile.tip_radius_um : width_um / 4;
  s.flank_slope = std::tan(profile.flank_deg * std::numbers::pi / 180);
  s.depth_um = depth_um;
  s.across = profile.across;
  s.burr_um[0] = profile.burr_left_um;
  s.burr_um[1] = profile.burr_right_um;
  s.burr_width_um = profile.burr_width_um;
  // Bisection for the outline's intersection with the face: the outline is monotonic.
  double low = 0, high = s.round_v ? s.radius_um + depth_um / std::max(s.flank_slope, 1e-3) : 2 * s.radius_um;
  if (s.round_v) high = std::max(high, s.radius_um);
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (outline(s, middle).height < depth_um ? low : high) = middle;
  }
  s.half_width_um = low;
  s.reach_um = low + (std::max(s.burr_um[0], s.burr_um[1]) > 0 ? s.burr_width_um : 0);
  return s;
}

std::optional<SectionPoint> section_at(const GrooveSection& s, double x) {
  const double a = std::abs(x);
  if (a <= s.half_width_um) {
    const Outline o = outline(s, x);
    return SectionPoint{o.height - s.depth_um, std::atan(o.slope)};
  }
  const double h = s.burr_um[x < 0 ? 0 : 1], beyond = a - s.half_width_um;
  if (!(h > 0) || beyond >= s.burr_width_um) return std::nullopt;
  // A parabola: 0 at both its feet, h in the middle.
  const double u = 2 * beyond / s.burr_width_um - 1;
  const double slope_outwards = -4 * h * u / s.burr_width_um;
  return SectionPoint{h * (1 - u * u), std::atan(x < 0 ? -slope_outwards : slope_outwards)};
}

}  // namespace burin
