#include "calib/photo_problem.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <set>

namespace burin {
namespace {

// The scratches of the last few states: all photos of an iteration share them.
class CarvedCache {
 public:
  std::shared_ptr<const Scratches> get(const ModelData& model, const Unknowns& x) {
    const Eigen::VectorXd key = x.head<unknown::ambient>();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!carved_ || key != key_) {
      carved_ = std::make_shared<const Scratches>(carved_scratches(model, x));
      key_ = key;
    }
    return carved_;
  }

 private:
  std::mutex mutex_;
  Eigen::VectorXd key_;
  std::shared_ptr<const Scratches> carved_;
};

// One photo as Ceres sees it: its weighted residuals and their Jacobian, turned by an orthogonal transform into count +
// 1 numbers that have the same cost, gradient and Gauss-Newton matrix. So Ceres' memory does not grow with the pixels.
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
    const std::shared_ptr<const Scratches> carved = cache_.get(model_, x);
    Eigen::Map<Eigen::VectorXd> out(residuals, unknown::count + 1);
    out.setZero();
    if (jacobians == nullptr) {
      out[unknown::count] = std::sqrt(2 * photo_cost(model_, photo_, x, *carved));
      return out.allFinite();
    }
    const PhotoEquations equations = photo_equations(model_, photo_, x, *carved, free);
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

bool frees(const Stage& stage, int first) {
  switch (first) {
    case unknown::log_alpha:
    case unknown::log_depth:
      return stage.groove;
    case unknown::log_base_alpha:
      return stage.base;
    case unknown::depth_gradient:
      return stage.gradient;
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

double solve(const Problem& data, const Stage& stage, int max_iterations, double tolerance, State& state,
             const Progress& progress, const std::string& stage_name) {
  CarvedCache cache;
  ceres::Problem problem;
  std::vector<std::array<double, 6>> poses(data.photos.size(), std::array<double, 6>{});
  std::set<std::size_t> lights;
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    const std::size_t light = data.photos[k].photo.light;
    lights.insert(light);
    std::vector<double*> blocks;
    for (const Block& block : kBlocks)
      blocks.push_back(block.first == unknown::pose ? poses[k].data() : state.block(block.first, light));
    problem.AddResidualBlock(new PhotoCost(data.model, data.photos[k], cache), nullptr, blocks);
    problem.SetParameterBlockConstant(poses[k].data());
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
    if (block.first == unknown::pose) continue;
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
  bounds(unknown::log_blur, 0, std::log(0.05), std::log(6.0), 0);
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

void weigh_photos(Problem& data, const State& state) {
  const Scratches carved = carved_scratches(data.model, state.of(0));
  data.photo_model_error.assign(data.photos.size(), 0);
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    PhotoData& photo = data.photos[k];
    const Image predicted = predict(data.model, photo, state.of(photo.photo.light), carved);
    struct Term {
      double r2, noise2, value2;
    };
    std::vector<Term> terms;
    const std::size_t stride = 1 + predicted.data.size() / 200'000;
    for (std::size_t i = 0; i < predicted.data.size(); i += stride) {
      if (!(photo.weight[i] > 0)) continue;
      const double r = static_cast<double>(predicted.data[i]) - photo.photo.value.data[i];
      const double noise = photo.photo.sigma.data[i], value = predicted.data[i];
      terms.push_back({r * r, noise * noise, value * value});
    }
    constexpr double kNormalMedian = 0.6745;
    std::vector<double> ratios(terms.size());
    const auto median_ratio = [&](double m) {
      for (std::size_t i = 0; i < terms.size(); ++i)
        ratios[i] = terms[i].r2 / (terms[i].noise2 + m * m * terms[i].value2);
      return std::sqrt(median_of(ratios));
    };
    double low = 0, high = 3;
    if (terms.empty() || median_ratio(0) <= kNormalMedian) high = 0;
    for (int i = 0; i < 30 && high > 0; ++i) {
      const double middle = 0.5 * (low + high);
      (median_ratio(middle) > kNormalMedian ? low : high) = middle;
    }
    const double m = high;
    data.photo_model_error[k] = m;
    for (std::size_t i = 0; i < predicted.data.size(); ++i)
      if (photo.weight[i] > 0)
        photo.weight[i] = static_cast<float>(
            1 / std::hypot(static_cast<double>(photo.photo.sigma.data[i]), m * static_cast<double>(predicted.data[i])));
  }
}

double pixel_mm(const LightView& view, const Bench& bench) {
  const Eigen::Isometry3d& T = bench.views[view.view].T_camera_board;
  return T.translation().norm() / view.lens.intrinsics[0];
}

std::vector<PhotoData> photos_at(const std::vector<LightView>& views, int bin, const Board& board, const Bench& bench,
                                 double blur_px) {
  std::vector<PhotoData> photos;
  for (const LightView& view : views)
    photos.push_back(make_photo_data(binned(view, bin), bin, board, bench, 0.8 + 3 * blur_px / bin));
  return photos;
}

double cost_of(const Problem& data, const State& state, std::size_t stride) {
  double cost = 0;
  const Scratches carved = carved_scratches(data.model, state.of(0));  // the same for all lamps
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
