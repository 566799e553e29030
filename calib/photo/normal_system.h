// burin/calib/photo/normal_system.h - computes the normal equations of a whole problem at one state, with cameras, bow
// and lens ("geometry") eliminated, and takes one Gauss-Newton step. Frame: board, mm. Unknowns are in the order of
// global_index().
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "burin/calib/photo/normal_matrices.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/scene/bench.h"

namespace burin {

/// Form of the robust loss in H: Gauss-Newton weights, which lead to the optimum, or the loss' own curvature there,
/// which gives the effect of scores on the optimum. The curvature is less by a fifth for normal errors, and by a half
/// for errors with long tails, as of grooves near their cut-off.
enum class Information { weights, curvature };

/// Every photo's equations under each of several models, the problem's own first: [model][photo]. The models differ in
/// their loss and in groove-to-groove variation. Derivatives, which take the time, are rendered once. `look`, if given,
/// is called with each photo's index and derivatives, several at a time.
std::vector<std::vector<PhotoEquations>> equations_of_photos(
    const Problem& data, const Stage& stage, const State& state, const std::vector<ModelData>& models,
    const std::function<void(std::size_t, const PhotoSlopes&)>& look = {});

/// `equations`: of all photos, from equations_of_photos().
NormalSystem normal_system(const Problem& data, const Stage& stage, const State& state, Information information,
                           const std::vector<PhotoEquations>& equations);

/// The views' own normal equations at `state`, for the free unknowns of `stage`; their sum and the priors' are the
/// problem's.
struct ViewEquations {
  std::vector<Eigen::MatrixXd> H;
  std::vector<Eigen::VectorXd> g;
  Eigen::VectorXd prior, prior_g;  ///< the priors' information (a diagonal) and score
  std::vector<bool> free;
  std::vector<std::size_t> view;  ///< index into the bench's views
  Eigen::MatrixXd tiles;          ///< scores (J^T W r) summed over squares of the board, one column per square
  Eigen::MatrixXd prior_information, prior_scatter;  ///< of all priors, the geometry's included; of their scores
  double cost = 0;
};
ViewEquations view_equations(const Problem& data, const Stage& stage, const State& state);

/// One Gauss-Newton step, near the optimum, of the free unknowns of `stage` together with all poses, the bow and the
/// lens (geometry_prior.h). Moves `state` and `bench`'s poses, bow and lenses. Afterwards the problem's photos must be
/// rebuilt from views with the bench's lenses (take_lenses).
void joint_step(Problem& data, const Stage& stage, State& state, Bench& bench);

}  // namespace burin
