// burin/render/footprint/lobe_nodes.h - the lobe of docs/model.md 4.25 at many psi, by SIMD vectors.
#pragma once

namespace burin {

/// Results of lobe_nodes() per psi; all arrays have `count` entries.
struct LobeNodes {
  double* r2;        ///< cos^2 psi + s^2 sin^2 psi
  double* cos_lean;  ///< lean: angle of the wall
  /// Cosine and sine of the lean minus the lean of h; both null if unused.
  double* cos_away;
  double* sin_away;
};

/// tan(lean - lean of h) = s tan(psi), psi from -pi/2 to pi/2. `sine_h`, `cosine_h`: of the lean of h. Error 1e-15.
void lobe_nodes(int count, const double* psi, double s, double sine_h, double cosine_h, const LobeNodes& out);

}  // namespace burin
