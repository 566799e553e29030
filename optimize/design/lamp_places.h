// burin/optimize/design/lamp_places.h - best positions of lamps of different colors, by the angles between the half
// vectors of all views under all their lights. docs/model.md 3.4, docs/light.md. Frame: board, mm; angles in radians.
//
// A scratch serves the view and the lamp whose half vector it crosses at a right angle. It shows part of its light
// (lobe(), modulo 180 degrees) for every other half vector with a nearby projection. N views under M lamps need N M
// directions, at best 180 / (N M) degrees apart, with half vectors that tilt up to the grooves' cutoff angle.
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

/// A view under one of its lights. Lights of the same name are one lamp: it moves for all its views, or stays if one of
/// them may not move.
struct ServedGlint {
  GlintView glint;
  std::string light;
  bool may_move = true;  ///< the light is a lamp whose position may change
};

/// Quality of the lamps' positions.
struct LampAngles {
  double least_apart = 0;    ///< smallest angle between the scratches of any two, pi / 2 if there is only one
  double worst_ghost = 0;    ///< largest crosstalk: share of its light that a scratch for one view sends to another
  std::size_t a = 0, b = 0;  ///< the pair of worst_ghost
};
/// The angles at a point of the board, over the pairs with a movable lamp.
LampAngles angles_of(const std::vector<ServedGlint>& served, const Eigen::Vector2d& p_mm, double alpha);

/// A better position of a lamp, at the same distance from the middle of the question.
struct LampPlace {
  std::string light;
  Eigen::Vector3d position_mm{0, 0, 0};  ///< whole mm
};

/// The carve area, and its grooves.
struct LampQuestion {
  Eigen::Vector2d min_mm{0, 0}, max_mm{1, 1};
  double alpha = 0.04;
  double steepest = 0.5;  ///< cutoff angle of the grooves' walls
  Eigen::Vector2d middle_mm() const { return (min_mm + max_mm) / 2; }
};

/// Positions of the movable lamps with the least sharing of scratches in the middle; eyes and other lamps stay. Half
/// vectors tilt less than the steepest wall all over the area, and stay away from the mirror direction in its middle.
/// Lamps are at least 15 degrees above the face, preferably clear of heads. The search goes lamp by lamp over a lattice
/// of directions, from several starts (fewer for many lamps). The same question gives the same answer. Empty if there
/// are no such positions, or more than 40 half vectors.
std::vector<LampPlace> better_lamps(const std::vector<ServedGlint>& served, const LampQuestion& question);

/// Reports the angles as a note. If scratches share more than a tenth of their light (kGhost), it warns and adds better
/// positions, if any. Nothing if no lamp may move.
std::vector<Finding> check_lamps(const std::vector<ServedGlint>& served, const LampQuestion& question);

/// check_lamps() for a design on a bench: its views in color under each of their lamps, and its other views. Lamps of
/// views in color may move, unless they shine on a gray view together with others. Throws Error for missing entries of
/// the bench.
std::vector<Finding> lamps_in_color(const DesignSpec& spec, const Board& board, const Bench& bench);

}  // namespace burin
