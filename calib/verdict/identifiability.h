// burin/calib/verdict/identifiability.h - what the photos determine, weakly, or not at all: a verdict on every
// parameter of a bench.
//
// A parameter is judged by its sigma (from the covariance, priors included) against two limits: below the first it is
// determined, below the second weakly, else not. The sigma itself is put to a test first: balanced halves of the photos
// (burin/calib/verdict/half_samples.h) are solved each for itself, to first order, and if they differ from one another
// by more than chance allows for that sigma (once in a thousand times), the verdict says so and the sigma grows until
// they do not. Poses are tested by halves of their tags. The depth of the grooves has a condition of its own: half
// vectors on both sides of the grooves' cut-off (docs/model.md 2.4). Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "burin/calib/geometry/board_solver.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/verdict/half_samples.h"
#include "burin/calib/verdict/photo_uncertainty.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"

namespace burin {

/// What was judged, by its name in the verdict: the linear combinations of a problem's unknowns that it is made of.
using Combinations = std::map<std::string, std::vector<Eigen::VectorXd>>;

/// Judges "lens", "poses" (and "pose.VIEW" where one is worse than determined), "board.tags", "board.bow_mm"; widens
/// the views' center sigmas where their tags contradict each other. Combinations are of BundleEquations' columns.
Combinations judge_geometry(const BoardSolution& geometry, const Board& board, bool fixed_lens, Bench& bench);

/// Judges "alpha", "depth_um", "base_alpha", "machine.affine", "ambient", "sensor.vignette", "sensor.psf_sigma_px" and,
/// for each lamp, "light.ID.position_mm", ".intensity", ".axis" and ".falloff_exponent". `bench` holds the fitted
/// values and their sigmas; those of what is not determined at all are taken away, those that halves contradict grow.
/// Combinations are of the unknowns in the order of global_index().
Combinations judge_light(const Problem& data, const State& state, const Uncertainty& uncertainty, const Stage& stage,
                         Bench& bench);

/// Light's normal equations in parts, for half_samples(): one part a view (all photos that share a pose), paired within
/// the lamp of its first photo with the view whose half vector leans most alike.
EquationsInParts light_in_parts(const Problem& data, const State& state, const Uncertainty& uncertainty);

/// Covariance of the affine map (one row of it: x, y, 1) that best takes the tags' true centers to the believed ones:
/// how well the board's own frame is known, which photos of tags and scratches cannot tell. mm^2.
Eigen::Matrix3d tag_frame_covariance(const Board& board);

/// Pairs of scratch and photo near the groove's cut-off: how many half vectors lean less, and how many more, across the
/// scratch than its steepest normal, 2 atan(T). Only scratches that could glint count: h within 2 alpha of the plane
/// across, and pairs so near the edge that alpha blurs it do not.
struct Straddle {
  std::size_t inside = 0, outside = 0;
  bool both() const {
    constexpr std::size_t kFewest = 25;
    return inside >= kFewest && outside >= kFewest;
  }
};
/// For one photo under one lamp, at the middles of the scratches.
Straddle straddle_of(const Carved& carved, const Surface& surface, double alpha, double depth_um, double tool_width_um,
                     const Eigen::Vector3d& lamp_mm, const Eigen::Vector3d& camera_mm,
                     const GrooveProfile& profile = {});

/// Over all photos of a problem.
Straddle straddle_of(const Problem& data, const State& state);

}  // namespace burin
