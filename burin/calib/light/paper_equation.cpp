#include "burin/calib/light/paper_equation.h"

#include <ceres/autodiff_cost_function.h>

#include <array>

namespace burin {

PaperEquation paper_equation(const Problem& data, State& state, const LightSample& sample,
                             const std::vector<bool>& free) {
  using PaperCost = ceres::AutoDiffCostFunction<PaperResidual, 1, 1, 3, 3, 1, 3, 1>;
  const PaperCost cost_function(new PaperResidual(paper_residual(data, sample)));
  const std::array<const double*, 6> blocks{state.block(unknown::ambient, 0),
                                            state.block(unknown::vignette, 0),
                                            state.block(unknown::lamp_position, sample.light),
                                            state.block(unknown::log_intensity, sample.light),
                                            state.block(unknown::spot, sample.light),
                                            state.log_paper};
  constexpr std::array<int, 6> kFirst{unknown::ambient,       unknown::vignette, unknown::lamp_position,
                                      unknown::log_intensity, unknown::spot,     -1};
  std::array<std::array<double, 3>, 6> jacobian{};
  std::array<double*, 6> jacobians{};
  for (int b = 0; b < 6; ++b) jacobians[b] = jacobian[b].data();
  PaperEquation out;
  cost_function.Evaluate(blocks.data(), &out.residual, jacobians.data());
  out.row = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(free.size()));
  for (int b = 0; b < 6; ++b)
    for (int i = 0; i < cost_function.parameter_block_sizes()[b]; ++i) {
      const int at = kFirst[b] < 0 ? kSharedUnknowns : global_index(kFirst[b] + i, sample.light);
      if (free[at]) out.row[at] = jacobian[b][i];
    }
  return out;
}

}  // namespace burin
