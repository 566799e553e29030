// burin/simulate/microfacets.h - reflection of a rough surface from textbook formulas, independent of the renderer,
// which the simulated camera validates. GGX facets (Walter et al., EGSR 2007, Eqn. 33), Smith's shadowing by its Lambda
// (Heitz, JCGT 3(2) 2014, Eqn. 72), each direction separately as in the paper's Eqn. 3, and Schlick's Fresnel term.
// Angles are with the facets' mean normal.
#pragma once

#include <cmath>
#include <numbers>

namespace burin {

/// Density per solid angle of facets whose normals tilt by acos(cos_lean); 0 below the horizon.
inline double facets_leaning(double cos_lean, double roughness) {
  if (cos_lean <= 0) return 0;
  const double c2 = cos_lean * cos_lean, tan2 = (1 - c2) / c2, a2 = roughness * roughness;
  return 1 / (std::numbers::pi * a2 * c2 * c2 * std::pow(1 + tan2 / a2, 2));
}

/// Share of the facets with a free view to a direction, among facets that face it; 0 below the horizon.
inline double share_unshadowed(double cos_direction, double roughness) {
  if (cos_direction <= 0) return 0;
  const double tan_direction = std::sqrt(1 - cos_direction * cos_direction) / cos_direction;
  return 1 / (1 + (std::hypot(1, roughness * tan_direction) - 1) / 2);
}

/// Share of the facets with a free view to both lamp and eye.
inline double share_lit_and_seen(double cos_lamp, double cos_eye, double roughness) {
  return share_unshadowed(cos_lamp, roughness) * share_unshadowed(cos_eye, roughness);
}

/// Reflected share at an angle of incidence, from the share f0 at normal incidence.
inline double fresnel_share(double cos_incidence, double f0) {
  return std::lerp(f0, 1.0, std::pow(1 - cos_incidence, 5));
}

}  // namespace burin
