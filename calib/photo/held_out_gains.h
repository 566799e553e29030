// burin/calib/photo/held_out_gains.h - what more unknowns would be worth to photos that did not help to find them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/calib/photo/normal_system.h"

namespace burin {

/// By how much each view's cost falls when the terms `added` are fitted to the other views. All other unknowns (`free`)
/// follow the terms as the whole of the views has them: without the one photo that pins down the depth, say, the others
/// would tell little of anything, and nothing of the field. H and g: all views' together.
std::vector<double> held_out_gains(const ViewEquations& e, const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                                   const std::vector<bool>& free, const std::vector<Eigen::Index>& added);

/// The views' gains together.
struct Gain {
  double sum = 0, standard_error = 0;
};
Gain gain_of(const std::vector<double>& of_views);
/// Of views' costs with less and with more.
Gain gain_between(const std::vector<double>& less, const std::vector<double>& more);

}  // namespace burin
