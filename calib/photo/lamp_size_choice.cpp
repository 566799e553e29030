#include "burin/calib/photo/lamp_size_choice.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "burin/calib/geometry/information.h"
#include "burin/calib/light/lamp_model.h"
#include "burin/calib/photo/effect_choice.h"
#include "burin/calib/photo/held_out_gains.h"
#include "burin/calib/photo/normal_system.h"
#include "burin/calib/photo/photo_fit.h"

namespace burin {
namespace {

constexpr double kLarge = 0.04;  // a lamp's radius over its distance

// The size of such a lamp, in squares of the unit.
double large_size2(const Problem& data, const State& state, std::size_t light) {
  const double distance_mm = Eigen::Vector3d::Map(state.block(unknown::lamp_position, light)).norm();
  return std::pow(kLarge * distance_mm / size_unit_mm(*data.model.board), 2);
}

// True if a step to the optimum with sizes, to first order, has a large lamp.
bool would_be_large(const Problem& data, const State& state, const Eigen::VectorXd& step) {
  for (std::size_t light = 0; light < state.lamps.size(); ++light)
    if (seeks_size(data, light) && step[global_index(unknown::size2, light)] > large_size2(data, state, light))
      return true;
  return false;
}

// True if any lamp's area affects glints more than its middle alone; otherwise unmodeled effects mask its sides.
bool any_shows(const Problem& data, const State& state) {
  const auto shared = [&](int i) { return state.shared[i]; };
  const double roughness = std::exp(std::min(shared(unknown::log_alpha) + std::min(0.0, shared(unknown::log_across)),
                                             shared(unknown::log_base_alpha)));
  for (std::size_t light = 0; light < state.lamps.size(); ++light) {
    const double reach_mm =
        size_unit_mm(*data.model.board) * std::sqrt(std::max(0.0, state.block(unknown::size2, light)[0]));
    if (!is_small_lamp(reach_mm, Eigen::Vector3d::Map(state.block(unknown::lamp_position, light)).norm(), roughness))
      return true;
  }
  return false;
}

// A fit decides about sides, so its threshold is lower than for a test without a fit.
constexpr double kWorthATry = 10;  // chi^2: once in a hundred and fifty times by chance, of two numbers

// Fits the unknowns of `more` in addition to the stage's. Takes the fit if it explains photos better by more than their
// scatter, and by more than `share` of their cost. `trial` is the initial guess, and then the result.
bool fits_better(const Problem& data, const Stage& more, double share, const Progress& progress, State& trial,
                 Stage& stage, State& state) {
  constexpr int kIterations = 15;
  const std::vector<double> before = costs_of_photos(data, state);
  solve(data, more, kIterations, 1e-4, trial, progress, "trying the lamp's size");
  const Gain gain = gain_between(before, costs_of_photos(data, trial));
  const double whole = std::accumulate(before.begin(), before.end(), 0.0);
  if (!(gain.sum > share * whole) || !(gain.sum > gain.standard_error)) return false;
  state = trial;
  stage = more;
  return true;
}

}  // namespace

bool any_large_lamp(const Problem& data, const State& state) {
  for (std::size_t light = 0; light < state.lamps.size(); ++light)
    if (state.block(unknown::size2, light)[0] > large_size2(data, state, light)) return true;
  return false;
}

bool choose_large_lamps(const Problem& data, Stage& stage, State& state, const Progress& progress) {
  const EffectEquations asked = effect_equations(data, stage, state, {Group::lamp_size});
  const Eigen::VectorXd step = -safe_inverse(asked.H, free_unknowns(data, asked.all, state.lamps.size())) * asked.g;
  if (!would_be_large(data, state, step)) return false;
  constexpr double kShare = 0.03;  // as for groove profiles
  Stage with = stage;
  with.free(Group::lamp_size);
  State trial = state;
  // An apparent grain of the face may come from the lamp: it is tested again with known size.
  with.hold({Group::grain});
  trial.shared[unknown::grain] = trial.shared[unknown::grain + 1] = 0;
  double widest2 = 0;
  for (std::size_t light = 0; light < trial.lamps.size(); ++light) {
    if (!seeks_size(data, light)) continue;
    const double large = large_size2(data, state, light), foretold = step[global_index(unknown::size2, light)];
    trial.block(unknown::size2, light)[0] = std::max(large, foretold);
    widest2 = std::max(widest2, std::pow(kLarge, 2) * std::max(1.0, foretold / large));
  }
  // Removes the lamp size's contribution (10.2) from roughnesses.
  constexpr double kLeastLeft = 0.3;
  for (const int i : {unknown::log_alpha, unknown::log_base_alpha}) {
    const double alpha2 = std::exp(2 * trial.shared[i]);
    trial.shared[i] += 0.5 * std::log(std::max(kLeastLeft, 1 - 0.25 * widest2 / alpha2));
  }
  if (fits_better(data, with, kShare, progress, trial, stage, state)) {
    choose_sides(data, stage, state, progress);
    return true;
  }
  // A long panel is not a disk: with a disk, views along it and across contradict each other.
  with.free(Group::lamp_sides);
  return fits_better(data, with, kShare, progress, trial, stage, state);
}

bool choose_sides(const Problem& data, Stage& stage, State& state, const Progress& progress) {
  if (!any_shows(data, state)) return false;
  const EffectEquations asked = effect_equations(data, stage, state, {Group::lamp_sides});
  if (!photos_ask_for(data, state, asked, Group::lamp_sides, {.chi2 = kWorthATry})) return false;
  constexpr double kShare = 0.01;
  Stage with = stage;
  with.free(Group::lamp_sides);
  State trial = state;
  return fits_better(data, with, kShare, progress, trial, stage, state);
}

}  // namespace burin
