// burin/optimize/design/glint.h - the closed form of a scratch's glint in a view. Checks (glint_check.h) and initial
// guesses use it. Frame: board, mm; angles in radians.
//
// A groove's normals are in the plane across it. It glints if the half vector h is in this plane too: the scratch must
// run at right angles to h's projection on the board. Turned by delta from this direction, h leaves the plane by hy =
// sin(lean) sin(delta). Integrating the GGX lobe over the groove's curved wall gives
//   light(delta) / light(0) = (1 + (sin(lean) sin(delta) / alpha)^2)^(-3/2),
// with `lean` the angle of h from the board's normal (tilt). If h tilts further than the groove's steepest normal, 2
// atan(T) (docs/model.md 2.4), only the lobe's tail remains. reach() is the covered lobe fraction of the wall,
//   1/2 + (atan(x) + x / (1 + x^2)) / pi,  x = (2 atan(T) - lean) / alpha.
// Both are exact for small alpha on a groove without edges. docs/model.md 3.4 and 3.6.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/board_face.h"

namespace burin {

/// Effective half vectors under other lights than one lamp, on a lattice over an area. lobe() uses them for the falloff
/// of a scratch's light as it turns (burin/optimize/design/direction_light.h measures them). The length of `shadow` is
/// the sine of h's tilt for the grooves' roughness.
struct GlintField {
  int side = 1;  ///< lattice points along each side of the area
  Eigen::Vector2d min_mm{0, 0}, max_mm{1, 1};
  /// Projections of h on the board, row by row from min_mm, at the middles of the lattice's cells.
  std::vector<Eigen::Vector2d> shadow;
  Eigen::Vector2d at(const Eigen::Vector2d& p_mm) const;
};

/// Camera and lamp of one view, which define h.
struct GlintView {
  std::string name;
  Eigen::Vector3d camera_mm{0, 0, 0}, light_mm{0, 0, 0};
  std::shared_ptr<const BoardFace> face{};    ///< of a curved board; none: flat
  std::shared_ptr<const GlintField> field{};  ///< for other lights than one lamp
  bool of_one_lamp_on_a_flat_face() const { return face == nullptr && field == nullptr; }
};
/// The glint of a design's view on a bench. Throws Error for a view or lamp missing in the bench.
GlintView glint_of(const DesignView& view, const Bench& bench);

/// The half vector, of any length, at a point of the flat board (z = 0). On a curved face it is in the face's own
/// frame, in which grooves run as on the flat board (docs/model.md 1.1). Under other lights than one lamp it is the
/// half vector of the closest equivalent lamp (GlintField).
Eigen::Vector3d half_vector_at(const GlintView& view, const Eigen::Vector3d& p_mm);

/// Tilt and azimuth of h at a point.
struct Lean {
  double angle = 0;                  ///< from the board's normal, 0 .. pi/2
  double azimuth = 0;                ///< of h's projection on the board, from x towards y
  double scratch_direction() const;  ///< of a glinting scratch here: azimuth + 90 degrees
};
Lean lean_at(const GlintView& view, const Eigen::Vector3d& p_mm);

/// Light of a scratch turned by `turn` from its best direction, relative to the light there.
double lobe(double lean, double turn, double alpha);

/// Argument of the lobe, h . u / alpha, at p for a scratch of direction u (of length 1): 0 in its best direction.
double lobe_place(const GlintView& view, const Eigen::Vector2d& p_mm, const Eigen::Vector2d& u, double alpha);

/// Difference of two scratches' orientations, modulo 180 degrees: 0 .. pi/2.
double turn_between(double a, double b);

/// Crosstalk: share of its light that a scratch for one half vector shows at the other, the larger of both cases.
double ghost_of(const Lean& a, const Lean& b, double alpha);

/// The turn at which the lobe falls to `part` (0..1) of its maximum; at most pi/2.
double turn_for(double lean, double part, double alpha);

/// Covered lobe fraction of a groove of steepest slope `steepest` (2 atan(T)), 0..1.
double reach(double lean, double steepest, double alpha);

/// The depth, um, of the groove whose cutoff angle is `lean`: T = tan(lean / 2), docs/model.md 2.2 and 2.4. It is at
/// most the depth of T^2 = 0.99.
double depth_for_lean_um(double lean, double width_um);

/// Shape of a board's groove at a place.
struct GrooveShape {
  double depth_um = 0, alpha = 0;
  GrooveProfile profile{};
};
using GrooveAt = std::function<GrooveShape(const Eigen::Vector2d& p_mm)>;

}  // namespace burin
