#include "burin/calib/photo/spot_choice.h"

#include <algorithm>

#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/effect_choice.h"
#include "burin/calib/photo/held_out_gains.h"
#include "burin/calib/photo/normal_system.h"
#include "burin/calib/photo/photo_fit.h"

namespace burin {

void make_spot(const Board& board, double exponent, double* spot) {
  spot[0] = 0.5 * board.size_mm.x();
  spot[1] = 0.5 * board.size_mm.y();
  spot[2] = exponent;
}

namespace {

// chi^2 of a fitted spotlight's falloff, and of the falloff times its aim's distance from the board's middle, against
// the scatter between places of the board. A bare lamp lacks only these two. Falloff itself differs between places: at
// the bare lamp's optimum it would count as their scatter.
double chi_squared_of_spot(const Problem& data, const Stage& stage, const State& state, std::size_t light) {
  const EffectEquations equations = effect_equations(data, stage, state, {});
  const ViewEquations& e = equations.views;
  const Eigen::MatrixXd inverse = safe_inverse(equations.H, e.free),
                        covariance = inverse * (e.tiles * e.tiles.transpose() + e.prior_scatter) * inverse;
  double middle[3];
  make_spot(*data.model.board, 0, middle);
  const double* const spot = state.block(unknown::spot, light);
  const Eigen::Vector3d beside(spot[0] - middle[0], spot[1] - middle[1], 1), terms = spot[2] * beside;
  Eigen::Matrix3d by_spot = spot[2] * Eigen::Matrix3d::Identity(), C;
  by_spot.col(2) = beside;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      C(a, b) = covariance(global_index(unknown::spot + a, light), global_index(unknown::spot + b, light));
  return chi_squared(terms, by_spot * C * by_spot.transpose());
}

}  // namespace

bool choose_spots(const Stage& stage, Problem& data, State& state, std::vector<Eigen::VectorXd>& pointed_to,
                  const Progress& progress) {
  constexpr std::size_t kFewestViews = 3;
  const std::size_t lights = state.lamps.size();
  const std::vector<bool> were_spots = data.is_spot, held = free_unknowns(data, stage, lights);
  if (std::count(were_spots.begin(), were_spots.end(), false) == 0) return false;
  // Starts from a negligible falloff: light depends linearly on it, and on it times the aim's displacement.
  constexpr double kHardly = 0.01;
  State hardly = state;
  for (std::size_t light = 0; light < lights; ++light) {
    if (were_spots[light]) continue;
    data.is_spot[light] = true;
    make_spot(*data.model.board, kHardly, hardly.block(unknown::spot, light));
  }
  const EffectEquations equations = effect_equations(data, stage, hardly, {});
  data.is_spot = were_spots;
  if (equations.views.H.size() < kFewestViews) return false;
  const Eigen::VectorXd bare = -safe_inverse(equations.H, held) * equations.g;
  for (std::size_t light = 0; light < lights; ++light) {
    if (were_spots[light]) continue;
    std::vector<bool> free = held;
    std::vector<Eigen::Index> added;
    for (int i = 0; i < 3; ++i) {
      added.push_back(global_index(unknown::spot + i, light));
      free[static_cast<std::size_t>(added.back())] = true;
    }
    const Eigen::VectorXd as_spot = -safe_inverse(equations.H, free) * equations.g;
    const double exponent = kHardly + as_spot[added.back()];
    const Gain held_out = gain_of(held_out_gains(equations.views, equations.H, equations.g, held, added));
    if (!(exponent > kLeastFalloff) || !(held_out.sum > held_out.standard_error)) continue;
    constexpr int kIterations = 8;
    constexpr double kMostForetold = 10;  // beyond it, the prediction from a bare lamp is inaccurate
    State trial = state;
    data.is_spot[light] = true;
    make_spot(*data.model.board, std::min(exponent, kMostForetold), trial.block(unknown::spot, light));
    const std::vector<double> before = costs_of_photos(data, state);
    solve(data, stage, kIterations, 1e-5, trial, progress, "trying a lamp that shines less to the side");
    const Gain gain = gain_between(before, costs_of_photos(data, trial));
    constexpr double kChi2 = 40;  // 30 was the most of nine bare lamps, 54 the least of two spots
    if (gain.sum > gain.standard_error && trial.block(unknown::spot, light)[2] > kLeastFalloff &&
        chi_squared_of_spot(data, stage, trial, light) > kChi2) {
      state = std::move(trial);
      continue;
    }
    data.is_spot[light] = false;
    pointed_to.push_back(as_spot - bare);
  }
  return data.is_spot != were_spots;
}

}  // namespace burin
