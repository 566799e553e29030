// burin/optimize/design/glint.h - which scratches glint for which view: the closed form that checks (glint_check.h) and
// starting points rest on. Frame: board, mm; angles in radians.
//
// A groove's normals lie in the plane across it, so it glints where the half vector h does too: the scratch must run
// at right angles to h's shadow on the board. Turned by delta from there, h leaves that plane by
// hy = sin(lean) sin(delta), and integrating the GGX lobe over the groove's curved wall gives
//   light(delta) / light(0) = (1 + (sin(lean) sin(delta) / alpha)^2)^(-3/2),
// `lean` being h's angle from the board's normal. If h leans further than the groove's steepest normal,
// 2 atan(T) (docs/model.md 2.4), only the lobe's tail is left: reach() is the part of the lobe that the wall holds,
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

/// Under other lights than one lamp: which way h's shadow would run, at a lattice of places over an area, for lobe() to
/// say how a scratch's light falls as it turns (burin/optimize/design/direction_light.h measures it). Its length is the
/// sine of h's lean for the roughness that grooves have.
struct GlintField {
  int side = 1;  ///< places along each side of the area
  Eigen::Vector2d min_mm{0, 0}, max_mm{1, 1};
  std::vector<Eigen::Vector2d> shadow;  ///< row by row, from min_mm; places in the middles of their cells
  Eigen::Vector2d at(const Eigen::Vector2d& p_mm) const;
};

/// Camera and lamp of one view: what h depends on.
struct GlintView {
  std::string name;
  Eigen::Vector3d camera_mm{0, 0, 0}, light_mm{0, 0, 0};
  std::shared_ptr<const BoardFace> face{};    ///< where the board is curved; none: flat
  std::shared_ptr<const GlintField> field{};  ///< where it is not one lamp that shines
  bool of_one_lamp_on_a_flat_face() const { return face == nullptr && field == nullptr; }
};
/// Those of a design on a bench. Throws Error for a view or lamp that the bench lacks.
GlintView glint_of(const DesignView& view, const Bench& bench);

/// The half vector, of any length, at a place of the flat board (z = 0); on a curved face as the face's own frame has
/// it, in which grooves run as on the flat board (docs/model.md 1.1); under other lights than one lamp that of the lamp
/// that comes closest (GlintField).
Eigen::Vector3d half_vector_at(const GlintView& view, const Eigen::Vector3d& p_mm);

/// h at a point, seen as an angle from the board's normal and the direction of its shadow.
struct Lean {
  double angle = 0;                  ///< from the board's normal, 0 .. pi/2
  double azimuth = 0;                ///< of h's shadow on the board, from x towards y
  double scratch_direction() const;  ///< that glints here: azimuth + 90 degrees
};
Lean lean_at(const GlintView& view, const Eigen::Vector3d& p_mm);

/// Light of a scratch turned by `turn` from the direction that glints best, relative to that best.
double lobe(double lean, double turn, double alpha);

/// h . u / alpha, where that lobe of a scratch of direction u (of length 1) stands at p: 0 where it glints best.
double lobe_place(const GlintView& view, const Eigen::Vector2d& p_mm, const Eigen::Vector2d& u, double alpha);

/// Difference of two scratches' orientations, which count modulo 180 degrees: 0 .. pi/2.
double turn_between(double a, double b);

/// Part of its light that a scratch made for one half vector shows at another, for whichever of the two that is more.
double ghost_of(const Lean& a, const Lean& b, double alpha);

/// The turn at which the lobe has fallen to `part` (0..1) of its best; at most pi/2.
double turn_for(double lean, double part, double alpha);

/// Part of the lobe that a groove of steepest slope `steepest` (2 atan(T)) holds, 0..1.
double reach(double lean, double steepest, double alpha);

/// The depth, um, whose steepest normal leans that far: T = tan(lean / 2), docs/model.md 2.2 and 2.4. At most what
/// T^2 = 0.99 asks for.
double depth_for_lean_um(double lean, double width_um);

/// Of the groove that a scratch of a board becomes at a place.
struct GrooveShape {
  double depth_um = 0, alpha = 0;
  GrooveProfile profile{};
};
using GrooveAt = std::function<GrooveShape(const Eigen::Vector2d& p_mm)>;

}  // namespace burin
