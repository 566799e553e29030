// burin/calib/light/paper_equation.h - one piece of a tag's paper against the model: its weighted residual, and its
// derivatives by all unknowns of a problem.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/calib/photo/photo_problem.h"

namespace burin {

struct PaperEquation {
  double residual = 0;
  Eigen::VectorXd row;  ///< derivatives, in the order of global_index(); 0 for what is not `free`
};
PaperEquation paper_equation(const Problem& data, State& state, const LightSample& sample,
                             const std::vector<bool>& free);

}  // namespace burin
