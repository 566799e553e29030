#include "burin/calib/light/lamp_fit.h"

#include <ceres/ceres.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "burin/scene/lamp_size.h"

namespace burin {
namespace {

constexpr int kShared = 5;

template <typename T>
LampModel<T> lamp_of(const T* position, const T* log_intensity, const T* spot) {
  LampModel<T> lamp;
  lamp.position_mm = Eigen::Matrix<T, 3, 1>(position[0], position[1], position[2]);
  lamp.log_intensity = log_intensity[0];
  lamp.aim_mm = Eigen::Matrix<T, 2, 1>(spot[0], spot[1]);
  lamp.exponent = spot[2];
  return lamp;
}

bool is_finite(double v) { return std::isfinite(v); }
template <int N>
bool is_finite(const ceres::Jet<double, N>& v) {
  return std::isfinite(v.a) && v.v.allFinite();
}

// log(model / photo) over its expected error. Logarithms, since brightness covers three decades from highlight to
// shade.
struct LogResidual {
  const LightSample* sample;
  double albedo, f0, weight;

  // `coat`: the face's grain, or the paper's gloss.
  template <typename T>
  T radiance_under(const LampModel<T>& lamp, const T* shared, const T* coat) const {
    using std::exp;
    if (sample->kind == SampleKind::face) return face_radiance(lamp, shared[1], T(exp(shared[0])), coat, f0, *sample);
    return paper_radiance(lamp, shared[1], albedo, *sample, {}, PaperGloss<T>{coat[0], coat[1]});
  }

  template <typename T>
  bool operator()(const T* position, const T* log_intensity, const T* spot, const T* shared, const T* coat,
                  T* residual) const {
    return of_radiance(radiance_under(lamp_of(position, log_intensity, spot), shared, coat), shared, residual);
  }

  template <typename T>
  bool of_radiance(const T& radiance, const T* shared, T* residual) const {
    using std::log;
    const T value = vignette_at(shared + 2, sample->radius2) * radiance;
    if (!(value > T(0))) return false;  // a step too far: Ceres takes a shorter one
    residual[0] = weight * log(value / sample->value);
    return is_finite(residual[0]);
  }
};

// LogResidual with an unmodeled lamp in addition.
struct StrayResidual {
  LogResidual of_point;
  double distance_mm;
  Eigen::Vector2d center_mm;

  template <typename T>
  bool operator()(const T* position, const T* log_intensity, const T* spot, const T* shared, const T* coat,
                  const T* stray, T* residual) const {
    const T dark[2] = {shared[0], T(0)};  // ambient light counts once
    const T radiance = of_point.radiance_under(lamp_of(position, log_intensity, spot), shared, coat) +
                       of_point.radiance_under(stray_of(stray, distance_mm, center_mm), dark, coat);
    return of_point.of_radiance(radiance, shared, residual);
  }
};

// LogResidual of an area light: by seven points of an ellipse (Radon's rule of the fifth degree).
struct AreaResidual {
  LogResidual of_point;
  Eigen::Matrix<double, 3, 2> across;  // across_axis()

  template <typename T>
  bool operator()(const T* position, const T* log_intensity, const T* spot, const T* shared, const T* coat,
                  const T* area, T* residual) const {
    LampModel<T> lamp = lamp_of(position, log_intensity, spot);
    T radiance(0);
    for (int k = 0; k < 7; ++k) {
      const double radius = k == 0 ? 0 : std::sqrt(2. / 3), angle = k * std::numbers::pi / 3;
      const double u = radius * std::cos(angle), v = radius * std::sin(angle);
      const T x = area[0] * u + area[1] * v, y = area[1] * u + area[2] * v;
      for (int i = 0; i < 3; ++i) lamp.offset_mm[i] = x * across(i, 0) + y * across(i, 1);
      const double share = k == 0 ? 0.25 : 0.125;
      radiance += share * of_point.radiance_under(lamp, shared, coat);
    }
    return of_point.of_radiance(radiance, shared, residual);
  }
};

struct SharedPrior {
  double log_base_alpha;

  template <typename T>
  bool operator()(const T* shared, T* residual) const {
    constexpr double kSigmaBaseAlpha = 1.0;  // wide: it matters only without information from photos
    residual[0] = (shared[0] - log_base_alpha) / kSigmaBaseAlpha;
    for (int i = 0; i < 3; ++i) residual[1 + i] = shared[2 + i] / kVignettePriorSigma[i];
    return true;
  }
};

struct SpotPrior {
  Eigen::Vector2d center_mm;
  double reach_mm;

  template <typename T>
  bool operator()(const T* spot, T* residual) const {
    residual[0] = (spot[0] - center_mm.x()) / reach_mm;
    residual[1] = (spot[1] - center_mm.y()) / reach_mm;
    return true;
  }
};

Eigen::Matrix<double, 3, 2> across_axis_of(const LampBlocks& lamp) {
  return across_axis((Eigen::Vector3d(lamp.spot[0], lamp.spot[1], 0) - lamp.place()).normalized(), 0);
}

// Adds paper and face as Ceres' residual blocks on `at`. Returns a flag for each lamp with any.
std::vector<bool> add_samples(const LampData& data, const LampFitOptions& options, LampParameters& at,
                              ceres::Problem& problem) {
  std::vector<bool> used(at.lamps.size(), false);
  std::vector<Eigen::Matrix<double, 3, 2>> across;  // held: it rotates little while a lamp moves
  for (const LampBlocks& lamp : at.lamps) across.push_back(across_axis_of(lamp));
  std::size_t face_seen = 0;
  for (const LightSample& sample : data.samples) {
    if (options.only_light >= 0 && sample.light != static_cast<std::size_t>(options.only_light)) continue;
    if (!(sample.value > 0)) continue;
    if (sample.kind == SampleKind::face && face_seen++ % options.stride != 0) continue;
    const double relative = sample.sigma / sample.value;
    const double weight = 1 / std::sqrt(relative * relative + data.model_error * data.model_error);
    LampBlocks& lamp = at.lamps[sample.light];
    used[sample.light] = true;
    const LogResidual residual{&sample, paper_albedo(*data.board, sample.kind), data.f0, weight};
    double* const coat = sample.kind == SampleKind::face ? at.grain : at.gloss;
    auto* const loss = new ceres::HuberLoss(2.0);
    if (lamp.has_area()) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<AreaResidual, 1, 3, 1, 3, kShared, 2, 3>(
                                   new AreaResidual{residual, across[sample.light]}),
                               loss, lamp.position, lamp.log_intensity, lamp.spot, at.shared, coat, lamp.area);
    } else if (at.stray_distance_mm > 0) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<StrayResidual, 1, 3, 1, 3, kShared, 2, 3>(
                                   new StrayResidual{residual, at.stray_distance_mm, data.center_mm}),
                               loss, lamp.position, lamp.log_intensity, lamp.spot, at.shared, coat, at.stray);
    } else {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<LogResidual, 1, 3, 1, 3, kShared, 2>(new LogResidual(residual)), loss,
          lamp.position, lamp.log_intensity, lamp.spot, at.shared, coat);
    }
  }
  return used;
}

// Sets priors and bounds of the parameters shared by paper, face and photos; holds the ones not requested.
void hold_shared(const LampFitOptions& options, LampParameters& at, ceres::Problem& problem) {
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SharedPrior, 4, kShared>(new SharedPrior{at.shared[0]}),
                           nullptr, at.shared);
  if (problem.HasParameterBlock(at.grain)) {
    constexpr double kMostGrain = 1.2;  // one roughness ten times the other
    for (int i = 0; i < 2; ++i) {
      problem.SetParameterLowerBound(at.grain, i, -kMostGrain);
      problem.SetParameterUpperBound(at.grain, i, kMostGrain);
    }
    if (at.grain[0] == 0 && at.grain[1] == 0) problem.SetParameterBlockConstant(at.grain);
  }
  if (problem.HasParameterBlock(at.gloss)) {
    if (at.gloss[0] == 0) {
      problem.SetParameterBlockConstant(at.gloss);
    } else {
      constexpr double kMostGloss = 0.2, kLeastAlpha = 0.05, kMostAlpha = 0.8;
      problem.SetParameterLowerBound(at.gloss, 0, 1e-6);
      problem.SetParameterUpperBound(at.gloss, 0, kMostGloss);
      problem.SetParameterLowerBound(at.gloss, 1, kLeastAlpha);
      problem.SetParameterUpperBound(at.gloss, 1, kMostAlpha);
    }
  }
  if (problem.HasParameterBlock(at.stray)) {
    constexpr double kMostSlope = 6, kMostLogarithm = 46;
    for (int i = 0; i < 3; ++i) {
      problem.SetParameterLowerBound(at.stray, i, i < 2 ? -kMostSlope : -kMostLogarithm);
      problem.SetParameterUpperBound(at.stray, i, i < 2 ? kMostSlope : kMostLogarithm);
    }
  }
  problem.SetParameterLowerBound(at.shared, 0, std::log(kSmoothestFace));
  problem.SetParameterUpperBound(at.shared, 0, 0);
  problem.SetParameterLowerBound(at.shared, 1, 0);
  if (!options.fit_vignette) problem.SetManifold(at.shared, new ceres::SubsetManifold(kShared, {2, 3, 4}));
}

// Sets priors and bounds of one lamp.
void hold_lamp(const LampData& data, bool given_area, bool is_spot, LampBlocks& lamp, ceres::Problem& problem) {
  problem.SetParameterLowerBound(lamp.position, 2, 0.05 * data.reach_mm);
  if (lamp.has_area() && given_area) problem.SetParameterBlockConstant(lamp.area);
  if (!is_spot) {
    problem.SetParameterBlockConstant(lamp.spot);
    return;
  }
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<SpotPrior, 2, 3>(new SpotPrior{data.center_mm, data.reach_mm}), nullptr,
      lamp.spot);
  problem.SetParameterLowerBound(lamp.spot, 2, 1e-3);
  problem.SetParameterUpperBound(lamp.spot, 2, 200);
}

void fill_covariance(const std::vector<bool>& used, ceres::Problem& problem, LampFit& fit) {
  fit.position_covariance.assign(used.size(), Eigen::Matrix3d::Constant(-1));
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  options.null_space_rank = -1;
  ceres::Covariance covariance(options);
  const double* const shared = fit.blocks.shared;
  std::vector<std::pair<const double*, const double*>> wanted{{shared, shared}};
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) wanted.emplace_back(fit.blocks.lamps[i].position, fit.blocks.lamps[i].position);
  if (!covariance.Compute(wanted, &problem)) return;
  Eigen::Matrix<double, kShared, kShared, Eigen::RowMajor> of_shared;
  covariance.GetCovarianceBlock(shared, shared, of_shared.data());
  fit.shared_sigma = of_shared.diagonal().cwiseMax(0).cwiseSqrt();
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> block;
    covariance.GetCovarianceBlock(fit.blocks.lamps[i].position, fit.blocks.lamps[i].position, block.data());
    fit.position_covariance[i] = block;
  }
}

}  // namespace

LampFit fit_lamp_parameters(const LampData& data, const LampParameters& start, const std::vector<bool>& spot,
                            const LampFitOptions& options) {
  LampFit fit;
  fit.blocks = start;
  ceres::Problem problem;
  const std::vector<bool> used = add_samples(data, options, fit.blocks, problem);
  if (std::none_of(used.begin(), used.end(), [](bool u) { return u; })) return fit;
  hold_shared(options, fit.blocks, problem);
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) hold_lamp(data, data.given_area[i], spot[i], fit.blocks.lamps[i], problem);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = options.iterations;
  solver.logging_type = ceres::SILENT;
  solver.num_threads = 1;  // sums in one order: the same bits in every run
  // With bounds, each step has a line search: by costs alone, since a cubic would need all derivatives again.
  solver.line_search_interpolation_type = ceres::QUADRATIC;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  fit.usable = summary.IsSolutionUsable() && std::isfinite(summary.final_cost);
  fit.cost = summary.final_cost;
  if (options.covariance && fit.usable) fill_covariance(used, problem, fit);
  return fit;
}

LampFit best_lamp_fit(const LampData& data, std::span<const LampParameters> starts, const std::vector<bool>& spot,
                      const LampFitOptions& options) {
  std::vector<LampFit> fits(starts.size());
  tbb::parallel_for(std::size_t{0}, starts.size(),
                    [&](std::size_t i) { fits[i] = fit_lamp_parameters(data, starts[i], spot, options); });
  LampFit best;
  for (LampFit& fit : fits)
    if (fit.usable && fit.cost < best.cost) best = std::move(fit);
  return best;
}

std::optional<double> log_residual(const LampData& data, const LampParameters& at, const LightSample& sample) {
  const LampBlocks& b = at.lamps[sample.light];
  const LogResidual residual{&sample, paper_albedo(*data.board, sample.kind), data.f0, 1};
  double r = 0;
  const double* coat = sample.kind == SampleKind::face ? at.grain : at.gloss;
  const bool lit = b.has_area() ? AreaResidual{residual, across_axis_of(b)}(b.position, b.log_intensity, b.spot,
                                                                            at.shared, coat, b.area, &r)
                   : at.stray_distance_mm > 0 ? StrayResidual{residual, at.stray_distance_mm, data.center_mm}(
                                                    b.position, b.log_intensity, b.spot, at.shared, coat, at.stray, &r)
                                              : residual(b.position, b.log_intensity, b.spot, at.shared, coat, &r);
  return lit ? std::optional(r) : std::nullopt;
}

}  // namespace burin
