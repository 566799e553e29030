#include "burin/calib/light/lamp.h"

#include <ceres/ceres.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "burin/render/median.h"
#include "burin/render/parameter_name.h"

namespace burin {
namespace {

constexpr int kPosition = 3, kSpot = 3, kShared = 5;  // shared: log base_alpha, ambient, v1, v2, v3

// The fit's parameters, in the arrays that Ceres moves.
struct LampBlocks {
  double position[kPosition] = {0, 0, 1};
  double log_intensity[1] = {0};
  double spot[kSpot] = {0, 0, 0};  // aim x, aim y, exponent
};

struct Blocks {
  std::vector<LampBlocks> lamps;
  double shared[kShared] = {0, 0, 0, 0, 0};
  double grain[2] = {0, 0};  // FaceGrain's c and s
};

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

// log(model / photo) over its expected error: brightness runs over three decades between highlight and shade.
struct LogResidual {
  const LightSample* sample;
  double albedo, f0, weight;

  template <typename T>
  bool operator()(const T* position, const T* log_intensity, const T* spot, const T* shared, const T* grain,
                  T* residual) const {
    using std::exp;
    using std::log;
    const LampModel<T> lamp = lamp_of(position, log_intensity, spot);
    const T radiance = sample->kind == SampleKind::face
                           ? face_radiance(lamp, shared[1], T(exp(shared[0])), grain, f0, *sample)
                           : paper_radiance(lamp, shared[1], albedo, *sample);
    const T value = vignette_at(shared + 2, sample->radius2) * radiance;
    if (!(value > T(0))) return false;  // a step too far: Ceres takes a shorter one
    residual[0] = weight * log(value / sample->value);
    return is_finite(residual[0]);
  }
};

struct SharedPrior {
  double log_base_alpha;

  template <typename T>
  bool operator()(const T* shared, T* residual) const {
    constexpr double kSigmaBaseAlpha = 1.0;  // wide: it matters only where photos say nothing
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

struct Fit {
  Blocks blocks;
  double cost = 0;
  bool usable = false;
  std::vector<Eigen::Matrix3d> position_covariance;
  double log_base_alpha_sigma = 0;
};

struct Data {
  std::span<const LightSample> samples;
  const Board* board;
  double f0 = 1, reach_mm = 1;
  Eigen::Vector2d center_mm{0, 0};
  double model_error = 0.02;
};

// Fits from `start`. With `only_light` >= 0 only that lamp's samples count; `stride` thins them. `spot[i]`: lamp i is
// one.
Fit run_fit(const Data& data, const Blocks& start, const std::vector<bool>& spot, int only_light, std::size_t stride,
            bool fit_vignette, int iterations, bool with_covariance) {
  Fit fit;
  fit.blocks = start;
  ceres::Problem::Options problem_options;
  ceres::Problem problem(problem_options);
  std::vector<bool> used(start.lamps.size(), false);
  std::size_t face_seen = 0;
  for (const LightSample& sample : data.samples) {
    if (only_light >= 0 && sample.light != static_cast<std::size_t>(only_light)) continue;
    if (!(sample.value > 0)) continue;
    if (sample.kind == SampleKind::face && face_seen++ % stride != 0) continue;
    const double relative = sample.sigma / sample.value;
    const double weight = 1 / std::sqrt(relative * relative + data.model_error * data.model_error);
    LampBlocks& lamp = fit.blocks.lamps[sample.light];
    used[sample.light] = true;
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<LogResidual, 1, kPosition, 1, kSpot, kShared, 2>(
                                 new LogResidual{&sample, paper_albedo(*data.board, sample.kind), data.f0, weight}),
                             new ceres::HuberLoss(2.0), lamp.position, lamp.log_intensity, lamp.spot, fit.blocks.shared,
                             fit.blocks.grain);
  }
  if (std::none_of(used.begin(), used.end(), [](bool u) { return u; })) return fit;
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SharedPrior, 4, kShared>(new SharedPrior{start.shared[0]}),
                           nullptr, fit.blocks.shared);
  constexpr double kMostGrain = 1.2;  // one roughness ten times the other
  for (int i = 0; i < 2; ++i) {
    problem.SetParameterLowerBound(fit.blocks.grain, i, -kMostGrain);
    problem.SetParameterUpperBound(fit.blocks.grain, i, kMostGrain);
  }
  if (start.grain[0] == 0 && start.grain[1] == 0) problem.SetParameterBlockConstant(fit.blocks.grain);
  problem.SetParameterLowerBound(fit.blocks.shared, 0, std::log(0.01));
  problem.SetParameterUpperBound(fit.blocks.shared, 0, 0);
  problem.SetParameterLowerBound(fit.blocks.shared, 1, 0);
  if (!fit_vignette) problem.SetManifold(fit.blocks.shared, new ceres::SubsetManifold(kShared, {2, 3, 4}));
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    LampBlocks& lamp = fit.blocks.lamps[i];
    problem.SetParameterLowerBound(lamp.position, 2, 0.05 * data.reach_mm);
    if (spot[i]) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<SpotPrior, 2, kSpot>(new SpotPrior{data.center_mm, data.reach_mm}), nullptr,
          lamp.spot);
      problem.SetParameterLowerBound(lamp.spot, 2, 1e-3);
      problem.SetParameterUpperBound(lamp.spot, 2, 200);
    } else {
      problem.SetParameterBlockConstant(lamp.spot);
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = iterations;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;  // sums in one order: the same bits in every run
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  fit.usable = summary.IsSolutionUsable() && std::isfinite(summary.final_cost);
  fit.cost = summary.final_cost;
  if (with_covariance && fit.usable) {
    fit.position_covariance.assign(used.size(), Eigen::Matrix3d::Constant(-1));
    ceres::Covariance::Options covariance_options;
    covariance_options.algorithm_type = ceres::DENSE_SVD;
    covariance_options.null_space_rank = -1;
    ceres::Covariance covariance(covariance_options);
    std::vector<std::pair<const double*, const double*>> wanted{{fit.blocks.shared, fit.blocks.shared}};
    for (std::size_t i = 0; i < used.size(); ++i)
      if (used[i]) wanted.emplace_back(fit.blocks.lamps[i].position, fit.blocks.lamps[i].position);
    if (covariance.Compute(wanted, &problem)) {
      Eigen::Matrix<double, kShared, kShared, Eigen::RowMajor> shared;
      covariance.GetCovarianceBlock(fit.blocks.shared, fit.blocks.shared, shared.data());
      fit.log_base_alpha_sigma = std::sqrt(shared(0, 0));
      for (std::size_t i = 0; i < used.size(); ++i) {
        if (!used[i]) continue;
        Eigen::Matrix<double, 3, 3, Eigen::RowMajor> block;
        covariance.GetCovarianceBlock(fit.blocks.lamps[i].position, fit.blocks.lamps[i].position, block.data());
        fit.position_covariance[i] = block;
      }
    }
  }
  return fit;
}

// The intensity that a lamp at `position` must have for the white paper to be as bright as it is: the samples' median.
double log_intensity_for(const Data& data, std::size_t light, const Eigen::Vector3d& position, double& log_spread) {
  std::vector<double> ratios;
  LampModel<double> lamp{position, 0, {0, 0}, 0};
  for (const LightSample& sample : data.samples) {
    if (sample.light != light || sample.kind != SampleKind::white_paper || !(sample.value > 0)) continue;
    const double unit = paper_radiance(lamp, 0.0, data.board->tags.white_albedo, sample);
    if (unit > 0) ratios.push_back(std::log(sample.value / unit));
  }
  if (ratios.empty()) {
    log_spread = 0;
    return 0;
  }
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  log_spread = *most - *least;
  return median_of(ratios);
}

// Where lamps may be: shading's closed form, and a ring around the board at two heights and distances.
std::vector<Eigen::Vector3d> starts_for(const Data& data, std::size_t light) {
  std::map<int, std::vector<double>> white, black;
  std::map<int, Eigen::Vector3d> where;
  for (const LightSample& sample : data.samples) {
    if (sample.light != light || sample.kind == SampleKind::face) continue;
    (sample.kind == SampleKind::white_paper ? white : black)[sample.tag].push_back(sample.value);
    where[sample.tag] = sample.p_board;
  }
  std::vector<Eigen::Vector3d> p;
  std::vector<double> shading;
  for (auto& [tag, values] : white) {
    if (!black.count(tag)) continue;
    const double s = median_of(values) - median_of(black[tag]);
    if (!(s > 0)) continue;
    p.push_back(where[tag]);
    shading.push_back(s);
  }
  std::vector<Eigen::Vector3d> starts;
  if (const auto seed = lamp_from_shading(p, shading)) starts.push_back(*seed);
  for (const double elevation_deg : {30., 60.})
    for (int i = 0; i < 8; ++i) {
      const double azimuth = 2 * std::numbers::pi * i / 8, elevation = elevation_deg * std::numbers::pi / 180;
      const Eigen::Vector3d direction(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                                      std::sin(elevation));
      starts.push_back(Eigen::Vector3d(data.center_mm.x(), data.center_mm.y(), 0) + 2 * data.reach_mm * direction);
    }
  return starts;
}

}  // namespace

std::optional<Eigen::Vector3d> lamp_from_shading(std::span<const Eigen::Vector3d> p_board,
                                                 std::span<const double> shading) {
  const auto count = static_cast<Eigen::Index>(p_board.size());
  if (count < 5) return std::nullopt;
  // s^(-2/3) = K (|p|^2 - 2 p.L + |L|^2) on a plane z = const, unknowns K, K Lx, K Ly, K |L|^2 (Lz above that plane).
  Eigen::MatrixXd A(count, 4);
  Eigen::VectorXd b(count);
  const double unit = p_board[0].norm() + 1;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector2d p = p_board[i].head<2>() / unit;
    b[i] = std::pow(shading[i], -2. / 3);
    A.row(i) = Eigen::Vector4d(p.squaredNorm(), -2 * p.x(), -2 * p.y(), 1).transpose() / b[i];
    b[i] = 1;  // rows are relative errors
  }
  const Eigen::Vector4d x = A.colPivHouseholderQr().solve(b);
  if (!(x[0] > 0)) return std::nullopt;
  const Eigen::Vector2d lateral(x[1] / x[0], x[2] / x[0]);
  const double height2 = x[3] / x[0] - lateral.squaredNorm();
  if (!(height2 > 0)) return std::nullopt;
  return Eigen::Vector3d(unit * lateral.x(), unit * lateral.y(), unit * std::sqrt(height2) + p_board[0].z());
}

namespace {

// Places of a bent board may turn away from a start, where only ambient light explains that they are not black.
double ambient_to_start(const Data& data, std::size_t light, const Eigen::Vector3d& start) {
  constexpr double kLittle = 0.02;  // of what paper and face show
  std::vector<double> values;
  bool turns_away = false;
  for (const LightSample& sample : data.samples) {
    if (sample.light != light || !(sample.value > 0)) continue;
    values.push_back(sample.value);
    turns_away = turns_away || (start - sample.p_board).dot(sample.normal) <= 0;
  }
  return turns_away ? kLittle * median_of(std::move(values)) : 0;
}

// A bare lamp from each start, by that lamp's own samples; the best. Not usable where there are too few samples, or no
// lamp explains them, which is told.
Fit fit_from_starts(const Data& data, const Blocks& blocks, std::size_t light, const std::string& id,
                    std::vector<Finding>& findings) {
  constexpr std::size_t kFewestSamples = 8, kMostSamples = 1500;
  std::size_t count = 0, white = 0;
  for (const LightSample& s : data.samples) {
    count += s.light == light;
    white += s.light == light && s.kind == SampleKind::white_paper;
  }
  Fit best;
  if (white < kFewestSamples) {
    findings.push_back(
        make_warning("light " + id + ": only " + std::to_string(white) + " unclipped pieces of white tag paper",
                     "add a shorter exposure"));
    if (count < kFewestSamples) return best;
  }
  const std::vector<bool> no_spot(blocks.lamps.size(), false);
  const std::size_t stride = 1 + count / kMostSamples;
  for (const Eigen::Vector3d& start : starts_for(data, light)) {
    Blocks from = blocks;
    LampBlocks& lamp = from.lamps[light];
    Eigen::Vector3d::Map(lamp.position) = start;
    double spread = 0;
    lamp.log_intensity[0] = log_intensity_for(data, light, start, spread);
    lamp.spot[0] = data.center_mm.x();
    lamp.spot[1] = data.center_mm.y();
    from.shared[1] = ambient_to_start(data, light, start);
    Fit fit = run_fit(data, from, no_spot, static_cast<int>(light), stride, false, 40, false);
    if (fit.usable && (!best.usable || fit.cost < best.cost)) best = std::move(fit);
  }
  if (!best.usable)
    findings.push_back(make_warning("light " + id + ": no lamp explains the brightness of paper and face"));
  return best;
}

// Takes lamps that are none for spots one after the other, where that explains much more. Where it explains a little
// more, `moved_mm` tells how far the lamp would be from where it is: photos then do not say which it is.
void try_spots(const Data& data, const std::vector<bool>& usable, std::vector<bool>& spot, Fit& fit,
               std::vector<Eigen::Vector3d>& moved_mm) {
  for (std::size_t light = 0; light < usable.size(); ++light) {
    if (!usable[light] || spot[light]) continue;
    std::vector<bool> with_spot = spot;
    with_spot[light] = true;
    // A tenth of the samples says from which exponent to start.
    constexpr std::size_t kThin = 10;
    Fit thin;
    for (const double exponent : {2., 8., 25.}) {
      Blocks from = fit.blocks;
      from.lamps[light].spot[0] = data.center_mm.x();
      from.lamps[light].spot[1] = data.center_mm.y();
      from.lamps[light].spot[2] = exponent;
      Fit candidate = run_fit(data, from, with_spot, -1, kThin, true, 60, false);
      if (candidate.usable && (!thin.usable || candidate.cost < thin.cost)) thin = std::move(candidate);
    }
    if (!thin.usable) continue;
    Fit best = run_fit(data, thin.blocks, with_spot, -1, 1, true, 60, false);
    // A spot has three parameters more. Errors of paper and face are not independent, so ask for far more than a test
    // of white noise would.
    constexpr double kWorthIt = 0.9;
    moved_mm[light].setZero();
    if (!best.usable || !(best.cost < fit.cost)) continue;
    if (!(best.cost < kWorthIt * fit.cost)) {
      moved_mm[light] = Eigen::Vector3d::Map(best.blocks.lamps[light].position) -
                        Eigen::Vector3d::Map(fit.blocks.lamps[light].position);
      continue;
    }
    fit = std::move(best);
    spot = with_spot;
  }
}

// Takes the face for a brushed one, where that explains much more: from several directions, since a lamp that was found
// without them may be far off. Whether it did.
bool try_grain(const Data& data, const std::vector<bool>& spot, Fit& fit) {
  constexpr std::size_t kThin = 6;
  constexpr double kStart = 0.3, kLeastGrain = 0.02;
  Fit thin;
  for (int i = 0; i < 4; ++i) {
    Blocks from = fit.blocks;
    const double twice = 2 * std::numbers::pi * i / 4;
    from.grain[0] = kStart * std::cos(twice);
    from.grain[1] = kStart * std::sin(twice);
    Fit candidate = run_fit(data, from, spot, -1, kThin, true, 60, false);
    if (candidate.usable && (!thin.usable || candidate.cost < thin.cost)) thin = std::move(candidate);
  }
  if (!thin.usable) return false;
  // All samples are asked only where a sixth of them comes near to what they must say.
  constexpr double kWorthIt = 0.85, kNear = 0.93;
  const Fit plain = run_fit(data, fit.blocks, spot, -1, kThin, true, 60, false);
  if (plain.usable && !(thin.cost < kNear * plain.cost)) return false;
  Fit best = run_fit(data, thin.blocks, spot, -1, 1, true, 60, false);
  // As for spots: far more than a test of white noise would ask.
  if (!best.usable || !(best.cost < kWorthIt * fit.cost)) return false;
  if (std::hypot(best.blocks.grain[0], best.blocks.grain[1]) < kLeastGrain) return false;
  fit = std::move(best);
  return true;
}

// Residuals in the robust loss's core: their RMS, and the factor by which they exceed what was expected of them.
std::pair<double, double> core_residuals(const Data& data, const std::vector<bool>& usable, const Fit& fit) {
  double sum = 0, sum_weighted = 0;
  std::size_t core = 0;
  for (const LightSample& sample : data.samples) {
    if (!usable[sample.light] || !(sample.value > 0)) continue;
    const LampBlocks& b = fit.blocks.lamps[sample.light];
    const double relative = sample.sigma / sample.value;
    const LogResidual residual{&sample, paper_albedo(*data.board, sample.kind), data.f0, 1};
    double r = 0;
    if (!residual(b.position, b.log_intensity, b.spot, fit.blocks.shared, fit.blocks.grain, &r)) continue;
    const double expected2 = relative * relative + data.model_error * data.model_error;
    if (r * r > 9 * expected2) continue;
    sum += r * r;
    sum_weighted += r * r / expected2;
    ++core;
  }
  if (core == 0) return {0, 1};
  return {std::sqrt(sum / static_cast<double>(core)),
          std::max(1.0, std::sqrt(sum_weighted / static_cast<double>(core)))};
}

void fill_seed(const Data& data, const std::vector<bool>& usable, const std::vector<bool>& spot, const Fit& fit,
               LampSeed& seed) {
  const auto [rms, inflation] = core_residuals(data, usable, fit);
  seed.found = true;
  seed.residual_rms = rms;
  seed.base_alpha = std::exp(fit.blocks.shared[0]);
  seed.base_alpha_sigma = inflation * fit.log_base_alpha_sigma * seed.base_alpha;
  seed.grain = {fit.blocks.grain[0], fit.blocks.grain[1]};
  seed.ambient = fit.blocks.shared[1];
  seed.vignette = Eigen::Vector3d::Map(fit.blocks.shared + 2);
  seed.aim_mm.assign(usable.size(), data.center_mm);
  for (std::size_t light = 0; light < usable.size(); ++light) {
    if (!usable[light]) continue;
    const LampBlocks& b = fit.blocks.lamps[light];
    Light& l = seed.lights[light];
    l.position_mm = Eigen::Vector3d::Map(b.position);
    l.intensity.setConstant(std::exp(b.log_intensity[0]));
    l.falloff_exponent = spot[light] ? b.spot[2] : 0;
    if (spot[light]) seed.aim_mm[light] = Eigen::Vector2d(b.spot[0], b.spot[1]);
    l.axis = (Eigen::Vector3d(seed.aim_mm[light].x(), seed.aim_mm[light].y(), 0) - l.position_mm).normalized();
    if (!fit.position_covariance.empty() && fit.position_covariance[light](0, 0) >= 0)
      l.position_sigma_mm = inflation * fit.position_covariance[light].diagonal().cwiseSqrt();
  }
}

// Scatter, as standard deviations, of what a fit says when groups of samples are left out in turn (the jackknife).
struct GroupScatter {
  std::vector<Eigen::Vector3d> position_mm;  // of each lamp, per axis
  double log_base_alpha = 0;
};

// The jackknife's standard deviation of each row, a column a fit without a group; 0 where there are too few groups.
Eigen::VectorXd jackknife_sigma(const Eigen::MatrixXd& answers) {
  const auto n = static_cast<double>(answers.cols());
  if (n < 3) return Eigen::VectorXd::Zero(answers.rows());
  const Eigen::VectorXd mean = answers.rowwise().mean();
  return ((n - 1) / n * (answers.colwise() - mean).rowwise().squaredNorm()).cwiseSqrt();
}

// What is left out decides nothing, so a group of which a lamp is not seen adds nothing to its scatter. `group_of`:
// from 0 to `groups` - 1, or -1 for what is never left out. One sample of the face in `thin` counts: it has enough.
template <typename GroupOf>
GroupScatter scatter_by_groups(const Data& data, const Fit& fit, const std::vector<bool>& spot, int groups,
                               std::size_t thin, GroupOf group_of) {
  const std::size_t lamps = fit.blocks.lamps.size();
  std::vector<std::optional<Fit>> without(static_cast<std::size_t>(groups));
  tbb::parallel_for(0, groups, [&](int g) {
    std::vector<LightSample> kept;
    for (const LightSample& sample : data.samples)
      if (group_of(sample) != g) kept.push_back(sample);
    if (kept.size() == data.samples.size() || kept.empty()) return;
    Data part = data;
    part.samples = std::move(kept);
    without[static_cast<std::size_t>(g)] = run_fit(part, fit.blocks, spot, -1, thin, true, 30, false);
  });
  const auto rows = static_cast<Eigen::Index>(3 * lamps + 1);
  Eigen::MatrixXd answers(rows, groups);
  Eigen::Index count = 0;
  for (const std::optional<Fit>& f : without) {
    if (!f || !f->usable) continue;
    for (std::size_t i = 0; i < lamps; ++i)
      answers.block<3, 1>(static_cast<Eigen::Index>(3 * i), count) = Eigen::Vector3d::Map(f->blocks.lamps[i].position);
    answers(rows - 1, count++) = f->blocks.shared[0];
  }
  const Eigen::VectorXd sigma = jackknife_sigma(answers.leftCols(count));
  GroupScatter out;
  for (std::size_t i = 0; i < lamps; ++i) out.position_mm.push_back(sigma.segment<3>(static_cast<Eigen::Index>(3 * i)));
  out.log_base_alpha = sigma[rows - 1];
  return out;
}

// How far a sample of the face is from the lamp's mirror image: the tangent of the half vector's lean.
double lean_of(const LightSample& sample, const Fit& fit) {
  const Eigen::Vector3d lamp = Eigen::Vector3d::Map(fit.blocks.lamps[sample.light].position);
  const Eigen::Vector3d h = (lamp - sample.p_board).normalized() + sample.to_camera;
  return h.cross(sample.normal).norm() / std::max(1e-9, h.dot(sample.normal));
}

// Three edges between four groups of the face's samples, alike in number, by their lean.
std::array<double, 3> lean_edges(const Data& data, const Fit& fit) {
  std::vector<double> leans;
  for (const LightSample& sample : data.samples)
    if (sample.kind == SampleKind::face) leans.push_back(lean_of(sample, fit));
  std::sort(leans.begin(), leans.end());
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < out.size() && !leans.empty(); ++i) out[i] = leans[(i + 1) * leans.size() / 4];
  return out;
}

// Makes sigmas larger where photos, places on the board, or the highlight's middle and its wings contradict each other
// more than independent errors would: streaks of a brushed face, or a lobe that is not the model's, are no noise.
void widen_by_groups(const Data& data, const Fit& fit, const std::vector<bool>& spot, LampSeed& seed) {
  constexpr int kGroups = 8, kAcross = 3;
  constexpr std::size_t kThin = 4;
  std::map<std::size_t, int> rank;  // of the photos
  for (const LightSample& sample : data.samples) rank.emplace(sample.light_view, 0);
  int next = 0;
  for (auto& [view, number] : rank) number = next++;
  const int photos = std::min(kGroups, next);
  const auto photo_of = [&](const LightSample& s) { return rank[s.light_view] % photos; };
  const Eigen::Vector2d size = data.board->size_mm;
  const auto place_of = [&](const LightSample& s) {
    const auto cell = [&](int axis) {
      return std::clamp(static_cast<int>(kAcross * s.p_board[axis] / size[axis]), 0, kAcross - 1);
    };
    return cell(0) + kAcross * cell(1);
  };
  const std::array<double, 3> edges = lean_edges(data, fit);
  const auto lean_group_of = [&](const LightSample& s) {
    if (s.kind != SampleKind::face) return -1;
    return static_cast<int>(std::upper_bound(edges.begin(), edges.end(), lean_of(s, fit)) - edges.begin());
  };
  for (const GroupScatter& by : {scatter_by_groups(data, fit, spot, 4, 2 * kThin, lean_group_of),
                                 scatter_by_groups(data, fit, spot, photos, kThin, photo_of),
                                 scatter_by_groups(data, fit, spot, kAcross * kAcross, kThin, place_of)}) {
    for (std::size_t i = 0; i < seed.lights.size(); ++i)
      if (auto& sigma = seed.lights[i].position_sigma_mm) *sigma = sigma->cwiseMax(by.position_mm[i]);
    seed.base_alpha_sigma = std::max(seed.base_alpha_sigma, seed.base_alpha * by.log_base_alpha);
  }
}

}  // namespace

LampSeed fit_lamps(std::span<const LightSample> samples, const Board& board, const Bench& bench,
                   const LampOptions& options) {
  Data data;
  data.samples = samples;
  data.board = &board;
  data.f0 = board.material.f0.mean();
  data.reach_mm = board.size_mm.norm();
  data.center_mm = 0.5 * board.size_mm;
  data.model_error = options.model_error;

  LampSeed seed;
  seed.lights = bench.lights;
  Blocks blocks;
  blocks.lamps.resize(bench.lights.size());
  blocks.shared[0] = std::log(board.material.base_alpha);
  std::vector<bool> spot(bench.lights.size(), false), usable(bench.lights.size(), false);
  for (std::size_t light = 0; light < bench.lights.size(); ++light) {
    if (!bench.lights[light].is_near()) continue;  // given, and known by their scale
    const Fit best = fit_from_starts(data, blocks, light, bench.lights[light].id, seed.findings);
    usable[light] = best.usable;
    if (best.usable) blocks = best.blocks;
  }
  if (std::none_of(usable.begin(), usable.end(), [](bool u) { return u; })) return seed;
  Fit fit = run_fit(data, blocks, spot, -1, 1, true, 60, false);
  if (!fit.usable) return seed;
  std::vector<Eigen::Vector3d> moved_mm(usable.size(), Eigen::Vector3d::Zero());
  if (options.fit_spot) try_spots(data, usable, spot, fit, moved_mm);
  // A face that is brushed, or whose highlight a large lamp draws out, hides a spot's fall-off as long as it is not.
  if (try_grain(data, spot, fit) && options.fit_spot) try_spots(data, usable, spot, fit, moved_mm);
  fit = run_fit(data, fit.blocks, spot, -1, 1, true, 60, true);
  if (fit.usable) fill_seed(data, usable, spot, fit, seed);
  if (fit.usable && options.jackknife) widen_by_groups(data, fit, spot, seed);
  for (std::size_t light = 0; light < usable.size(); ++light)
    if (auto& sigma = seed.lights[light].position_sigma_mm)
      *sigma = (sigma->cwiseAbs2() + moved_mm[light].cwiseAbs2()).cwiseSqrt();
  return seed;
}

Bench with_lamps(std::span<const MergedView> photos, const Board& board, const Sent& sent, const Bench& measured,
                 std::vector<Finding>& findings) {
  Bench bench = measured;
  const std::vector<LightView> views = make_light_views(photos, board, bench, findings);
  return with_lamps(gather_light_samples(views, board, bench, sent), board, bench, findings);
}

Bench with_lamps(std::span<const LightSample> samples, const Board& board, const Bench& measured,
                 std::vector<Finding>& findings) {
  Bench bench = measured;
  LampOptions options;
  options.jackknife = true;
  const LampSeed seed = fit_lamps(samples, board, bench, options);
  append(findings, seed.findings);
  for (const Light& light : bench.lights)
    bench.verdict[parameter::light_position(light.id)] = {
        Source::assumed, Degree::not_determined, {}, Unit::none, {{Cause::Kind::no_paper}}};
  if (!seed.found) return bench;
  bench.lights = seed.lights;
  bench.material.base_alpha = seed.base_alpha;
  bench.material.grain = seed.grain;
  bench.material_sigma.base_alpha = seed.base_alpha_sigma;
  bench.ambient.setConstant(seed.ambient);
  bench.sensor.vignette = seed.vignette;
  for (const Light& light : bench.lights) {
    if (!light.position_sigma_mm) continue;
    const double sigma = light.position_sigma_mm->norm();
    bench.verdict[parameter::light_position(light.id)] = {
        Source::measured,
        sigma < 0.2 * light.position_mm.norm() ? Degree::determined : Degree::not_determined,
        sigma,
        Unit::mm,
        {{Cause::Kind::paper_and_face}}};
  }
  return bench;
}

}  // namespace burin
