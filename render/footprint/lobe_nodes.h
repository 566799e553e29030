// burin/render/footprint/lobe_nodes.h - the lobe of docs/model.md 4.25 at many psi together, by packets.
#pragma once

namespace burin {

/// What lobe_nodes() finds for each psi; arrays as long as there are.
struct LobeNodes {
  double* r2;        ///< cos^2 psi + s^2 sin^2 psi
  double* cos_lean;  ///< of the lean
  double* cos_away;  ///< of the lean less that of h; both null where nobody asks
  double* sin_away;
};

/// tan(lean - lean of h) = s tan(psi), psi from -pi/2 to pi/2. `sine_h`, `cosine_h`: of h's own lean. Good to 1e-15.
void lobe_nodes(int count, const double* psi, double s, double sine_h, double cosine_h, const LobeNodes& out);

}  // namespace burin
