#include "burin/calib/photo/photo_problem.h"

#include <ceres/ceres.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <set>

#include "burin/calib/photo/groove_scatter.h"

namespace burin {
namespace {

// The scratches of the last few states: all photos of an iteration share them.
class CarvedCache {
 public:
  std::shared_ptr<const Carved> get(const ModelData& model, const Unknowns& x) {
    const Eigen::VectorXd key = x.head<unknown::ambient>();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!carved_ || key != key_) {
      carved_ = std::make_shared<const Carved>(carved_at(model, x));
      key_ = key;
    }
    return carved_;
  }

 private:
  std::mutex mutex_;
  Eigen::VectorXd key_;
  std::shared_ptr<const Carved> carved_;
};

// One photo as Ceres sees it: its weighted residuals and their Jacobian, turned by an orthogonal transform into count +
// 1 numbers that have the same cost, gradient and Gauss-Newton matrix. So Ceres' memory does not grow with the pixels.
// Derivatives take ten times as long as values, so they are kept while they hold (slopes_hold): a fit that starts
// near its end takes them once.
class PhotoCost : public ceres::CostFunction {
 public:
  PhotoCost(const ModelData& model, const PhotoData& photo, CarvedCache& cache)
      : model_(model), photo_(photo), cache_(cache) {
    for (const Block& block : kBlocks) mutable_parameter_block_sizes()->push_back(block.size);
    set_num_residuals(unknown::count + 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Unknowns x;
    FreeUnknowns free{};
    for (std::size_t b = 0; b < kBlocks.size(); ++b)
      for (int i = 0; i < kBlocks[b].size; ++i) {
        x[kBlocks[b].first + i] = parameters[b][i];
        free[kBlocks[b].first + i] = jacobians != nullptr && jacobians[b] != nullptr;
      }
    const std::shared_ptr<const Carved> carved = cache_.get(model_, x);
    Eigen::Map<Eigen::VectorXd> out(residuals, unknown::count + 1);
    out.setZero();
    // A step that is taken is asked for twice: for its cost, and with the Jacobian.
    if (light_.data.empty() || x != seen_at_) {
      light_ = seen_light(model_, photo_, x, *carved);
      seen_at_ = x;
    }
    if (jacobians == nullptr) {
      out[unknown::count] = std::sqrt(2 * photo_cost(model_, photo_, x, light_));
      return out.allFinite();
    }
    if (slopes_.free != free || !slopes_hold(model_, photo_, slopes_, x, light_))
      slopes_ = photo_slopes(model_, photo_, x, *carved, free);
    const PhotoEquations equations = photo_equations(model_, photo_, x, light_, slopes_);
    // JtJ = D U S U^T D with D its diagonal's root: rows sqrt(S) U^T D, residuals S^-1/2 U^T D^-1 Jtr.
    Eigen::VectorXd D = equations.JtJ.diagonal().cwiseSqrt(), D_inverse = D;
    for (double& d : D_inverse) d = d > 0 ? 1 / d : 0;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(D_inverse.asDiagonal() * equations.JtJ *
                                                               D_inverse.asDiagonal());
    const Eigen::VectorXd S = eigen.eigenvalues().cwiseMax(0);
    const Eigen::MatrixXd J = S.cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose() * D.asDiagonal();
    Eigen::VectorXd r = eigen.eigenvectors().transpose() * (D_inverse.asDiagonal() * equations.Jtr);
    for (Eigen::Index i = 0; i < r.size(); ++i) r[i] = S[i] > 1e-13 ? r[i] / std::sqrt(S[i]) : 0;
    out.head(unknown::count) = r;
    out[unknown::count] = std::sqrt(std::max(0.0, 2 * equations.cost - r.squaredNorm()));
    for (std::size_t b = 0; b < kBlocks.size(); ++b) {
      if (jacobians[b] == nullptr) continue;
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> block(
          jacobians[b], unknown::count + 1, kBlocks[b].size);
      block.setZero();
      block.topRows(unknown::count) = J.middleCols(kBlocks[b].first, kBlocks[b].size);
    }
    return out.allFinite() && J.allFinite();
  }

 private:
  const ModelData& model_;
  const PhotoData& photo_;
  CarvedCache& cache_;
  // Ceres asks for one evaluation of a block at a time.
  mutable Unknowns seen_at_ = Unknowns::Zero();
  mutable Image light_;  // at seen_at_
  mutable PhotoSlopes slopes_;
};

using PaperCost = ceres::AutoDiffCostFunction<PaperResidual, 1, 1, 3, 3, 1, 3, 1>;

struct GaussPrior {
  std::vector<double> sigma;
  template <typename T>
  bool operator()(T const* const* x, T* residual) const {
    for (std::size_t i = 0; i < sigma.size(); ++i) residual[i] = x[0][i] / sigma[i];
    return true;
  }
};

void add_prior(ceres::Problem& problem, double* block, const std::vector<double>& sigma) {
  const int size = static_cast<int>(sigma.size());
  auto* cost = new ceres::DynamicAutoDiffCostFunction<GaussPrior, 4>(new GaussPrior{sigma});
  cost->AddParameterBlock(size);
  cost->SetNumResiduals(size);
  problem.AddResidualBlock(cost, nullptr, block);
}

}  // namespace

State state_of(const Bench& bench, const ModelData& model) {
  State state;
  state.shared[unknown::log_alpha] = std::log(bench.material.alpha);
  state.shared[unknown::log_depth] = std::log(bench.material.depth_um);
  state.shared[unknown::log_base_alpha] = std::log(bench.material.base_alpha);
  for (int i = 0; i < GrooveField::kTerms; ++i) state.shared[unknown::depth_field + i] = bench.depth_field.terms[i];
  const Affine2& affine = bench.machine_affine;
  const Eigen::Vector2d shift = affine.leftCols<2>() * model.center_mm + affine.col(2) - model.center_mm;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) state.shared[unknown::machine + 2 * row + column] = affine(row, column);
    state.shared[unknown::machine + 4 + row] = shift[row];
  }
  state.shared[unknown::ambient] = bench.ambient.mean();
  for (int i = 0; i < 3; ++i) state.shared[unknown::vignette + i] = bench.sensor.vignette[i];
  constexpr double kBlurAtFirstPx = 0.6;
  state.shared[unknown::log_blur] =
      std::log(bench.sensor.psf_sigma_px > 0 ? bench.sensor.psf_sigma_px : kBlurAtFirstPx);
  for (const Light& light : bench.lights) {
    const Eigen::Vector3d& p = light.position_mm;
    const Eigen::Vector3d aim = light.axis.z() < 0 ? Eigen::Vector3d(p - light.axis * (p.z() / light.axis.z()))
                                                   : Eigen::Vector3d(model.center_mm.x(), model.center_mm.y(), 0);
    state.lamps.push_back({p.x(), p.y(), p.z(), std::log(std::max(1e-12, light.intensity.mean())), aim.x(), aim.y(),
                           light.falloff_exponent});
  }
  return state;
}

State moved_state(const State& state, const Eigen::VectorXd& step) {
  State out = state;
  for (int i = 0; i < kSharedUnknowns; ++i) out.shared[i] += step[i];
  out.log_paper[0] += step[kSharedUnknowns];
  for (std::size_t light = 0; light < out.lamps.size(); ++light)
    for (int i = 0; i < kLampUnknowns; ++i) out.lamps[light][i] += step[global_index(kFirstLampUnknown + i, light)];
  return out;
}

bool frees(const Stage& stage, int first) {
  switch (first) {
    case unknown::log_alpha:
    case unknown::log_depth:
      return stage.groove;
    case unknown::log_base_alpha:
      return stage.base;
    case unknown::depth_field:
      return stage.depth_field.linear;
    case unknown::depth_field + 2:
      return stage.depth_field.quadratic;
    case unknown::depth_field + 5:
      return stage.depth_field.wear;
    case unknown::machine:
      return stage.machine;
    case unknown::ambient:
      return stage.ambient;
    case unknown::vignette:
      return stage.vignette;
    case unknown::log_blur:
      return stage.blur;
    case unknown::lamp_position:
      return stage.lamp;
    case unknown::log_intensity:
      return stage.intensity;
    default:
      return false;
  }
}

double paper_albedo(const Board& board, SampleKind kind) {
  return kind == SampleKind::white_paper ? board.tags.white_albedo : board.tags.black_albedo;
}

PaperResidual paper_residual(const Problem& problem, const LightSample& sample) {
  const double error = std::hypot(sample.sigma, kPaperError * sample.value);
  return {&sample, paper_albedo(*problem.model.board, sample.kind), 1 / error};
}

std::pair<double, double> log_blur_range(const Problem& data) {
  for (const PhotoData& photo : data.photos) {
    constexpr double kHolds = 0.3;
    if (!photo.correction.empty()) return {photo.log_blur_at - kHolds, photo.log_blur_at + kHolds};
  }
  return {std::log(0.05), std::log(6.0)};
}

double solve(const Problem& data, const Stage& stage, int max_iterations, double tolerance, State& state,
             const Progress& progress, const std::string& stage_name) {
  CarvedCache cache;
  ceres::Problem problem;
  std::vector<std::array<double, 9>> geometry(data.photos.size(), std::array<double, 9>{});  // pose and bow, held
  std::set<std::size_t> lights;
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    const std::size_t light = data.photos[k].photo.light;
    lights.insert(light);
    std::vector<double*> blocks;
    blocks.reserve(kBlocks.size());
    for (const Block& block : kBlocks)
      blocks.push_back(block.first >= unknown::pose ? geometry[k].data() + (block.first - unknown::pose)
                                                    : state.block(block.first, light));
    problem.AddResidualBlock(new PhotoCost(data.model, data.photos[k], cache), nullptr, blocks);
    for (const int offset : {0, unknown::bow - unknown::pose})
      problem.SetParameterBlockConstant(geometry[k].data() + offset);
  }
  for (const LightSample& sample : data.paper) {
    if (!lights.count(sample.light)) continue;
    problem.AddResidualBlock(new PaperCost(new PaperResidual(paper_residual(data, sample))),
                             new ceres::CauchyLoss(kPaperLoss), state.block(unknown::ambient, 0),
                             state.block(unknown::vignette, 0), state.block(unknown::lamp_position, sample.light),
                             state.block(unknown::log_intensity, sample.light),
                             state.block(unknown::spot, sample.light), state.log_paper);
  }
  add_prior(problem, state.block(unknown::vignette, 0), {kVignettePriorSigma.begin(), kVignettePriorSigma.end()});
  add_prior(problem, state.log_paper, {kPaperFactorSigma});

  for (const Block& block : kBlocks) {
    if (block.first >= unknown::pose) continue;
    for (const std::size_t light : lights) {
      double* values = state.block(block.first, light);
      const bool free = block.first == unknown::spot ? stage.lamp && data.is_spot[light] : frees(stage, block.first);
      if (!free) problem.SetParameterBlockConstant(values);
    }
  }
  const auto bounds = [&](int first, int offset, double low, double high, std::size_t light) {
    double* values = state.block(first, light);
    values[offset] = std::clamp(values[offset], low, high);
    problem.SetParameterLowerBound(values, offset, low);
    problem.SetParameterUpperBound(values, offset, high);
  };
  const double width_um = data.model.board->tool_width_um;
  bounds(unknown::log_alpha, 0, std::log(0.004), std::log(0.8), 0);
  bounds(unknown::log_depth, 0, std::log(1e-3 * width_um), std::log(0.7 * width_um), 0);
  bounds(unknown::log_base_alpha, 0, std::log(0.01), std::log(1.0), 0);
  const auto [least_blur, most_blur] = log_blur_range(data);
  bounds(unknown::log_blur, 0, least_blur, most_blur, 0);
  bounds(unknown::ambient, 0, 0, 1e9, 0);
  for (const std::size_t light : lights) {
    bounds(unknown::lamp_position, 2, 0.02 * data.model.board->size_mm.norm(), 1e6, light);
    if (data.is_spot[light]) bounds(unknown::spot, 2, 1e-3, 200, light);
  }

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = tolerance;
  options.parameter_tolerance = 1e-7;
  options.initial_trust_region_radius = 1e5;
  options.logging_type = ceres::SILENT;
  options.num_threads = 2;
  struct Report : ceres::IterationCallback {
    const Progress& progress;
    std::string stage;
    int iterations;
    Report(const Progress& p, std::string s, int n) : progress(p), stage(std::move(s)), iterations(n) {}
    ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
      if (progress) progress(stage, std::min(1.0, static_cast<double>(summary.iteration) / iterations));
      return ceres::SOLVER_CONTINUE;
    }
  } report(progress, stage_name, max_iterations);
  options.callbacks.push_back(&report);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.final_cost;
}

namespace {

// One pixel's squares: residual, noise, prediction, its slopes by log alpha and log depth.
struct PixelSquares {
  double residual, noise, value, by_alpha, by_depth;
};

// The relative error m of the model for which the median of residual^2 / expected^2 is a normal distribution's.
double relative_error(const std::vector<PixelSquares>& pixels, double alpha_jitter, double depth_jitter) {
  constexpr double kNormalMedian = 0.6745;
  // Half of the pixels are beyond the median: a pixel is while beyond - m^2 value > 0.
  std::vector<double> beyond(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const PixelSquares& p = pixels[i];
    beyond[i] = p.residual / (kNormalMedian * kNormalMedian) - p.noise - alpha_jitter * alpha_jitter * p.by_alpha -
                depth_jitter * depth_jitter * p.by_depth;
  }
  const auto too_small = [&](double m) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) count += beyond[i] > m * m * pixels[i].value ? 1 : 0;
    return 2 * count > pixels.size();
  };
  if (pixels.empty() || !too_small(0)) return 0;
  double low = 0, high = 3;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (too_small(middle) ? low : high) = middle;
  }
  return high;
}

// Variances of log alpha and log depth (not negative) that explain what noise and m leave, by weighted least squares. A
// residual counts up to 1.5 sigmas: dust, fingerprints and tool marks are no scatter of grooves.
Eigen::Vector2d groove_variances(const std::vector<std::vector<PixelSquares>>& photos, const std::vector<double>& m,
                                 const Eigen::Vector2d& variances) {
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < photos.size(); ++k)
    for (const PixelSquares& p : photos[k]) {
      const Eigen::Vector2d slopes(p.by_alpha, p.by_depth);
      const double known = p.noise + m[k] * m[k] * p.value, expected = known + variances.dot(slopes);
      constexpr double kMost = 2.25, kMeanOfNormal = 0.77848;  // the mean of min(z^2, kMost) over a normal distribution
      const double weight = 1 / (expected * expected);
      H += weight * slopes * slopes.transpose();
      g += weight * (std::min(p.residual, kMost * expected) / kMeanOfNormal - known) * slopes;
    }
  if (!(H(0, 0) > 0) || !(H(1, 1) > 0)) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d alone = g.cwiseQuotient(H.diagonal()).cwiseMax(0);
  Eigen::Vector2d both = H.ldlt().solve(g);
  if (both.minCoeff() >= 0) return both;
  return both[0] < both[1] ? Eigen::Vector2d(0, alone[1]) : Eigen::Vector2d(alone[0], 0);
}

void weigh(Problem& data, const State& state, bool grooves_differ) {
  const Carved carved = carved_at(data.model, state.of(0));
  data.photo_model_error.assign(data.photos.size(), 0);
  std::vector<GrooveSlopes> predicted(data.photos.size());
  std::vector<std::vector<PixelSquares>> squares(data.photos.size());
  each_photo(data.photos.size(), [&](std::size_t k) {
    const PhotoData& photo = data.photos[k];
    const Unknowns x = state.of(photo.photo.light);
    GrooveSlopes& p = predicted[k];
    p = grooves_differ ? predict_with_slopes(data.model, photo, x, carved)
                       : GrooveSlopes{predict(data.model, photo, x, carved), {}, {}};
    const auto square = [](double v) { return v * v; };
    const std::size_t stride = 1 + p.value.data.size() / 200'000;
    for (std::size_t i = 0; i < p.value.data.size(); i += stride)
      if (photo.weight[i] > 0)
        squares[k].push_back({square(static_cast<double>(p.value.data[i]) - photo.photo.value.data[i]),
                              square(photo.photo.sigma.data[i]), square(p.value.data[i]),
                              grooves_differ ? square(p.by_log_alpha.data[i]) : 0,
                              grooves_differ ? square(p.by_log_depth.data[i]) : 0});
  });
  Eigen::Vector2d variances = Eigen::Vector2d::Zero();
  constexpr int kRounds = 8;
  for (int round = 0; round < (grooves_differ ? kRounds : 1); ++round) {
    if (round > 0) variances = groove_variances(squares, data.photo_model_error, variances);
    each_photo(data.photos.size(), [&](std::size_t k) {
      data.photo_model_error[k] = relative_error(squares[k], std::sqrt(variances[0]), std::sqrt(variances[1]));
    });
  }
  if (grooves_differ) data.slope_error = variances.cwiseSqrt();
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    PhotoData& photo = data.photos[k];
    const GrooveSlopes& p = predicted[k];
    for (std::size_t i = 0; i < p.value.data.size(); ++i) {
      if (!(photo.weight[i] > 0)) continue;
      const double noise = photo.photo.sigma.data[i], miss = data.photo_model_error[k] * p.value.data[i];
      const double grooves = grooves_differ ? std::hypot(data.slope_error[0] * p.by_log_alpha.data[i],
                                                         data.slope_error[1] * p.by_log_depth.data[i])
                                            : 0;
      photo.weight[i] = static_cast<float>(1 / std::sqrt(noise * noise + miss * miss + grooves * grooves));
    }
  }
}

}  // namespace

void weigh_photos(Problem& data, const State& state) { weigh(data, state, false); }

void weigh_photos_and_grooves(Problem& data, const State& state) {
  weigh(data, state, true);
  const GrooveScatter scatter = groove_scatter(data, state);
  data.model.alpha_jitter = std::sqrt(scatter.variance[0]);
  data.model.depth_jitter = std::sqrt(scatter.variance[1]);
  data.model.alpha_jitter2_sigma = scatter.sigma[0];
  data.model.depth_jitter2_sigma = scatter.sigma[1];
  const Carved carved = carved_at(data.model, state.of(0));
  each_photo(data.photos.size(), [&](std::size_t k) {
    shift_by_grooves(data.model, state.of(data.photos[k].photo.light), carved, data.photos[k]);
  });
}

void each_photo(std::size_t count, const std::function<void(std::size_t)>& body) {
  // Isolated: a thread that waits for the rest of its own photo's rendering must not begin another photo.
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t k = range.begin(); k < range.end(); ++k) tbb::this_task_arena::isolate([&] { body(k); });
      },
      tbb::simple_partitioner());
}

double pixel_mm(const LightView& view, const Bench& bench) {
  const Eigen::Isometry3d& T = bench.views[view.view].T_camera_board;
  return T.translation().norm() / view.lens.intrinsics[0];
}

std::vector<PhotoData> photos_at(const std::vector<LightView>& views, int bin, const Board& board, const Bench& bench,
                                 double blur_px) {
  std::vector<PhotoData> photos;
  photos.reserve(views.size());
  for (const LightView& view : views)
    photos.push_back(make_photo_data(binned(view, bin), bin, board, bench, 0.8 + 3 * blur_px / bin));
  return photos;
}

void correct_binning(Problem& data, const std::vector<LightView>& views, const Board& board, const Bench& bench,
                     const State& state) {
  constexpr std::size_t kMaxPixels = 4'000'000;  // of a photo: some 100 bytes each while it is worked on
  const Carved carved = carved_at(data.model, state.of(0));
  each_photo(data.photos.size(), [&](std::size_t k) {
    const Unknowns x = state.of(views[k].light);
    correct_binning(data.model, views[k], board, bench, x, carved, kMaxPixels, data.photos[k]);
    shift_by_grooves(data.model, x, carved, data.photos[k]);
  });
}

double cost_of(const Problem& data, const State& state, std::size_t stride) {
  double cost = 0;
  const Carved carved = carved_at(data.model, state.of(0));  // the same for all lamps
  for (std::size_t k = 0; k < data.photos.size(); k += stride)
    cost += photo_cost(data.model, data.photos[k], state.of(data.photos[k].photo.light), carved);
  return cost;
}

double median_of(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace burin
