// burin/calib/photo/held_out_gains.h - gains of additional unknowns in photos held out of their fit.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/calib/photo/normal_system.h"

namespace burin {

/// Decrease of each view's cost when the terms `added` are fitted to the other views. All other unknowns (`free`)
/// follow the terms as in the fit to all views. Without the one photo that determines the depth, say, the others would
/// constrain little of anything, and nothing of the field. H and g: all views' together.
std::vector<double> held_out_gains(const ViewEquations& e, const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                                   const std::vector<bool>& free, const std::vector<Eigen::Index>& added);

/// The views' gains together.
struct Gain {
  double sum = 0, standard_error = 0;
};
Gain gain_of(const std::vector<double>& of_views);
/// Gain between views' costs with fewer and with more terms.
Gain gain_between(const std::vector<double>& less, const std::vector<double>& more);

}  // namespace burin
