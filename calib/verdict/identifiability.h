// burin/calib/verdict/identifiability.h - identifiability report: status of every parameter of a setup as determined,
// weakly determined, or not determined by the photos.
//
// The status compares a parameter's sigma (from the covariance, with priors) with two limits: below the first it is
// determined, below the second weakly, otherwise not. A test checks the sigma first: balanced halves of the photos
// (burin/calib/verdict/half_samples.h) are solved separately, to first order. If they differ by more than chance allows
// for this sigma (once in a thousand cases), the verdict reports it and the sigma grows until they agree. Poses are
// tested by halves of their tags. The depth of the grooves has an additional condition: half vectors on both sides of
// the grooves' cut-off (docs/model.md 2.4).
// Frame: board, mm.
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

/// The judged parameters by their name in the verdict, as linear combinations of a problem's unknowns.
using Combinations = std::map<std::string, std::vector<Eigen::VectorXd>>;

/// Judges "lens", "poses" (and "pose.VIEW" for views worse than determined), "board.tags" and "board.bow_mm". Increases
/// the views' center sigmas if their tags contradict each other. Combinations are of BundleEquations' columns.
Combinations judge_geometry(const BoardSolution& geometry, const Board& board, bool fixed_lens, Bench& bench);

/// Judges "alpha", "depth_um", "base_alpha", "machine.affine", "ambient", "sensor.vignette", "sensor.psf_sigma_px" and,
/// for each lamp, "light.ID.position_mm", ".intensity", ".axis" and ".falloff_exponent". `bench` has the fitted values
/// and their sigmas. The function removes sigmas of undetermined parameters, and increases sigmas that halves
/// contradict. Combinations are of the unknowns in the order of global_index().
Combinations judge_light(const Problem& data, const State& state, const Uncertainty& uncertainty, const Stage& stage,
                         Bench& bench);

/// Normal equations of light in parts, for half_samples(). A part is a view: all photos with one pose. Views whose
/// first photos share a lamp form pairs, by similar tilt of their half vectors.
EquationsInParts light_in_parts(const Problem& data, const State& state, const Uncertainty& uncertainty);

/// Covariance of the affine map (one row of it: x, y, 1) that best maps the tags' true centers to their prior. It is
/// the uncertainty of the board's own frame, which photos of tags and scratches cannot determine. mm^2.
Eigen::Matrix3d tag_frame_covariance(const Board& board);

/// Pairs of scratch and photo near the groove's cut-off: numbers of half vectors that lean less, and more, across the
/// scratch than its steepest normal, 2 atan(T). Only scratches that could glint count: h is within 2 alpha of the plane
/// across. Pairs so near the edge that alpha blurs it do not count.
struct Straddle {
  std::size_t inside = 0, outside = 0;
  bool both() const {
    constexpr std::size_t kFewest = 25;
    return inside >= kFewest && outside >= kFewest;
  }
};
/// Counts for one photo under one lamp, at the middles of the scratches.
Straddle straddle_of(const Carved& carved, const Surface& surface, double alpha, double depth_um, double tool_width_um,
                     const Eigen::Vector3d& lamp_mm, const Eigen::Vector3d& camera_mm,
                     const GrooveProfile& profile = {});

/// Counts over all photos of a problem.
Straddle straddle_of(const Problem& data, const State& state);

}  // namespace burin
