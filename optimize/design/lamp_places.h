// burin/optimize/design/lamp_places.h - where lamps of different colors stand best: by the angles between the half
// vectors of all views under all their lights. docs/model.md 3.4, docs/light.md. Frame: board, mm; angles in radians.
//
// A scratch serves the view and the lamp whose half vector it runs across, and shows part of its light (lobe(), counted
// modulo 180 degrees) wherever another half vector's shadow lies near. N views under M lamps want N M directions, at
// best 180 / (N M) degrees apart, with half vectors that lean as far as the grooves reach.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// A view under one of its lights; lights of the same name are one lamp, which moves for all that it serves, or stays
/// where one of them may not move.
struct ServedGlint {
  GlintView glint;
  std::string light;
  bool may_move = true;  ///< the light is a lamp that may be put elsewhere
};

/// How well lamps stand.
struct LampAngles {
  double least_apart = 0;    ///< between the scratches of any two, pi / 2 where there is only one
  double worst_ghost = 0;    ///< part of its light that a scratch made for one shows in another
  std::size_t a = 0, b = 0;  ///< whose that is
};
/// At a place of the board, counting the pairs of which a lamp may move.
LampAngles angles_of(const std::vector<ServedGlint>& served, const Eigen::Vector2d& p_mm, double alpha);

/// A lamp where it would stand better, at the same distance from the place asked for.
struct LampPlace {
  std::string light;
  Eigen::Vector3d position_mm{0, 0, 0};  ///< whole mm
};

/// The area that is carved, and the grooves in it.
struct LampQuestion {
  Eigen::Vector2d min_mm{0, 0}, max_mm{1, 1};
  double alpha = 0.04;
  double steepest = 0.5;  ///< of the grooves' walls
  Eigen::Vector2d middle_mm() const { return (min_mm + max_mm) / 2; }
};

/// Places for the lamps that may move with which scratches share least in the middle, eyes and other lamps as they are:
/// half vectors lean less than the steepest wall all over the area (and more than what counts as near the mirror
/// direction in its middle), lamps stand at least 15 degrees above the face, and better where nobody's head is.
/// Searched lamp by lamp over a lattice of directions, from several beginnings (fewer for many); same question, same
/// answer. Empty where there are no such places, or more than 40 half vectors.
std::vector<LampPlace> better_lamps(const std::vector<ServedGlint>& served, const LampQuestion& question);

/// What the angles are, as a note; with a warning, and better places if there are any, where scratches share more than
/// a tenth of their light (kGhost). Nothing where no lamp may move.
std::vector<Finding> check_lamps(const std::vector<ServedGlint>& served, const LampQuestion& question);

/// The same for a design on a bench: its views in color under each of their lamps, and its other views. Lamps of views
/// in color may move, but not those that shine on a view in gray together with others. Throws Error for what the bench
/// lacks.
std::vector<Finding> lamps_in_color(const DesignSpec& spec, const Board& board, const Bench& bench);

}  // namespace burin
