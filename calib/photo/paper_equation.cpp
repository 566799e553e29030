#include "burin/calib/photo/paper_equation.h"

#include <ceres/autodiff_cost_function.h>

#include <array>

#include "burin/calib/photo/lamp_unknowns.h"
#include "burin/calib/photo/stray_light.h"

namespace burin {

namespace {

// Reflection of an unmodeled light by paper.
double stray_on_paper(const Problem& problem, const Unknowns& x, const LightSample& sample, double albedo) {
  if (!has_stray(x)) return 0;
  const Light light = stray_light(x, problem.model.board->size_mm);
  const LampModel<double> lamp{light.position_mm, std::log(light.intensity.mean()), {0, 0}, 0};
  const std::vector<LampPoint> points = lamp_points(light);
  return paper_radiance(lamp, 0.0, albedo, sample, points, {problem.coat.f0, problem.coat.alpha});
}

}  // namespace

PaperResidual paper_residual(const Problem& problem, const State& state, const LightSample& sample) {
  const double error = std::hypot(sample.sigma, kPaperError * sample.value);
  PaperResidual out{&sample, paper_albedo(*problem.model.board, sample.kind), 1 / error, problem.coat, {}};
  out.stray = stray_on_paper(problem, state.of(sample.light), sample, out.albedo);
  Light lamp;
  put_lamp(state.of(sample.light), problem.given_size.empty() ? LampSize() : problem.given_size[sample.light],
           size_unit_mm(*problem.model.board), lamp);
  if (!lamp.size.is_point()) out.points = lamp_points(lamp);
  return out;
}

PaperEquation paper_equation(const Problem& data, const State& state, const LightSample& sample,
                             const std::vector<bool>& free) {
  using PaperCost = ceres::AutoDiffCostFunction<PaperResidual, 1, 1, 3, 3, 1, 2, 1, 1>;
  const PaperCost cost_function(new PaperResidual(paper_residual(data, state, sample)));
  // The unknowns of PaperResidual, in its order; the last is the paper's own.
  constexpr std::array<int, 7> kFirst{unknown::ambient,       unknown::vignette, unknown::lamp_position,
                                      unknown::log_intensity, unknown::spot,     unknown::spot + 2,
                                      unknown::log_paper};
  std::array<const double*, 7> blocks{};
  std::array<std::array<double, 3>, 7> jacobian{};
  std::array<double*, 7> jacobians{};
  for (std::size_t b = 0; b < kFirst.size(); ++b) {
    blocks[b] = state.block(kFirst[b], sample.light);
    jacobians[b] = jacobian[b].data();
  }
  PaperEquation out;
  cost_function.Evaluate(blocks.data(), &out.residual, jacobians.data());
  out.row = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(free.size()));
  for (std::size_t b = 0; b < kFirst.size(); ++b)
    for (int i = 0; i < cost_function.parameter_block_sizes()[b]; ++i) {
      const int at = kFirst[b] == unknown::log_paper ? kPaperIndex : global_index(kFirst[b] + i, sample.light);
      if (free[at]) out.row[at] = jacobian[b][i];
    }
  return out;
}

}  // namespace burin
