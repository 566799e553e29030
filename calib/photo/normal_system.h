// burin/calib/photo/normal_system.h - the normal equations of a whole problem at one state, cameras, bow and lens
// ("geometry") eliminated; one Gauss-Newton step of everything. Frame: board, mm. Unknowns are in the order of
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

/// What stands in H for the robust loss: Gauss and Newton's weights, which lead to the optimum, or the loss' own
/// curvature there, which says how far scores move the optimum. That is less by a fifth for normal errors, by a half
/// where errors have long tails, as those of grooves near their cut-off have.
enum class Information { weights, curvature };

/// Every photo's equations under each of some models, which differ in their loss and in how much grooves differ, the
/// problem's own first: [model][photo]. Slopes, which take the time, are rendered once; `look`, if given, is called
/// with each photo's index and slopes, several at a time.
std::vector<std::vector<PhotoEquations>> equations_of_photos(
    const Problem& data, const Stage& stage, const State& state, const std::vector<ModelData>& models,
    const std::function<void(std::size_t, const PhotoSlopes&)>& look = {});

/// `equations`: of all photos, from equations_of_photos().
NormalSystem normal_system(const Problem& data, const Stage& stage, const State& state, Information information,
                           const std::vector<PhotoEquations>& equations);

/// The views' own normal equations at `state`, of all that `stage` frees; their sum and the priors' are the problem's.
struct ViewEquations {
  std::vector<Eigen::MatrixXd> H;
  std::vector<Eigen::VectorXd> g;
  Eigen::VectorXd prior, prior_g;  ///< the priors' information (a diagonal) and score
  std::vector<bool> free;
  std::vector<std::size_t> view;  ///< index into the bench's views
  Eigen::MatrixXd tiles;          ///< scores (J^T W r) summed over squares of the board, a column a square
  Eigen::MatrixXd prior_information, prior_scatter;  ///< all priors', the geometry's among them; of their scores
  double cost = 0;
};
ViewEquations view_equations(const Problem& data, const Stage& stage, const State& state);

/// One Gauss-Newton step of what `stage` frees and of all poses, the bow and the lens together (geometry_prior.h), from
/// near the optimum. Moves `state` and `bench`'s poses, bow and lenses; the problem's photos must be made anew
/// afterwards, from views with the bench's lenses (take_lenses).
void joint_step(Problem& data, const Stage& stage, State& state, Bench& bench);

}  // namespace burin
