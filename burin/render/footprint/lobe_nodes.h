// burin/render/footprint/lobe_nodes.h - the lobe of docs/model.md 4.25 at many psi together, by packets.
#pragma once

namespace burin {

/// tan(lean - lean of h) = s tan(psi), psi from -pi/2 to pi/2: for each psi the factor r2 = cos^2 psi + s^2 sin^2 psi,
/// and the cosine of the lean. `sine_h`, `cosine_h`: of h's own lean. Good to 1e-15.
void lobe_nodes(int count, const double* psi, double s, double sine_h, double cosine_h, double* r2, double* cos_lean);

}  // namespace burin
