#include "calib/refine.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <sstream>

#include "calib/lamp.h"
#include "calib/light_samples.h"
#include "calib/photo_equations.h"
#include "render/error.h"
#include "render/groove.h"
#include "render/surface.h"

namespace burin {
namespace {

// The parameter blocks of one photo's cost, in the order of `unknown`.
struct Block {
  int first, size;
};
constexpr std::array<Block, 12> kBlocks = {{{unknown::log_alpha, 1},
                                            {unknown::log_depth, 1},
                                            {unknown::log_base_alpha, 1},
                                            {unknown::depth_gradient, 2},
                                            {unknown::machine, 6},
                                            {unknown::ambient, 1},
                                            {unknown::vignette, 3},
                                            {unknown::log_blur, 1},
                                            {unknown::lamp_position, 3},
                                            {unknown::log_intensity, 1},
                                            {unknown::spot, 3},
                                            {unknown::pose, 6}}};
constexpr int kFirstLampUnknown = unknown::lamp_position;
constexpr int kSharedUnknowns = kFirstLampUnknown;  // those before the lamp's
constexpr int kLampUnknowns = unknown::pose - unknown::lamp_position;

// Everything that moves: shared unknowns, the paper's brightness, and a set for each lamp.
struct State {
  std::array<double, kSharedUnknowns> shared{};
  double log_paper[1] = {0};
  std::vector<std::array<double, kLampUnknowns>> lamps;

  double* block(int first, std::size_t light) {
    return first < kFirstLampUnknown ? shared.data() + first : lamps[light].data() + (first - kFirstLampUnknown);
  }
  Unknowns of(std::size_t light) const {
    Unknowns x = Unknowns::Zero();
    for (int i = 0; i < kSharedUnknowns; ++i) x[i] = shared[i];
    for (int i = 0; i < kLampUnknowns; ++i) x[kFirstLampUnknown + i] = lamps[light][i];
    return x;
  }
};

// Groups of unknowns that a stage frees.
struct Stage {
  bool groove = true, base = true, gradient = false, machine = true, ambient = true, vignette = true, blur = false,
       lamp = true, intensity = true;
};

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

// Paper: its mean brightness a tag and photo, with the albedo that board.json gives up to one common factor.
struct PaperResidual {
  const LightSample* sample;
  double albedo, weight;

  template <typename T>
  bool operator()(const T* ambient, const T* vignette, const T* position, const T* log_intensity, const T* spot,
                  const T* log_paper, T* residual) const {
    using std::exp;
    LampModel<T> lamp;
    lamp.position_mm = Eigen::Matrix<T, 3, 1>(position[0], position[1], position[2]);
    lamp.log_intensity = log_intensity[0];
    lamp.aim_mm = Eigen::Matrix<T, 2, 1>(spot[0], spot[1]);
    lamp.exponent = spot[2];
    const T radiance = exp(log_paper[0]) * paper_radiance(lamp, ambient[0], albedo, *sample);
    residual[0] = weight * (vignette_at(vignette, sample->radius2) * radiance - sample->value);
    return true;
  }
};
using PaperCost = ceres::AutoDiffCostFunction<PaperResidual, 1, 1, 3, 3, 1, 3, 1>;

constexpr double kPaperError = 0.005;        // relative: unevenness of paper beyond noise
constexpr double kPaperFactorSigma = 0.02;   // how well albedos in board.json are known, as a common factor
constexpr double kVignettePriorSigma = 0.5;  // wide: matters only where nothing tells
constexpr double kPaperLoss = 3;             // Cauchy scale, in expected errors

struct Problem {
  ModelData model;
  std::vector<PhotoData> photos;
  std::vector<LightSample> paper;
  std::vector<double> photo_model_error;
  std::vector<bool> is_spot;
};

double paper_albedo(const Board& board, SampleKind kind) {
  return kind == SampleKind::white_paper ? board.tags.white_albedo : board.tags.black_albedo;
}

PaperResidual paper_residual(const Problem& problem, const LightSample& sample) {
  const double error = std::hypot(sample.sigma, kPaperError * sample.value);
  return {&sample, paper_albedo(*problem.model.board, sample.kind), 1 / error};
}

struct GaussPrior {
  double weight;
  int count;
  template <typename T>
  bool operator()(T const* const* x, T* residual) const {
    for (int i = 0; i < count; ++i) residual[i] = weight * x[0][i];
    return true;
  }
};

void add_prior(ceres::Problem& problem, double* block, int size, double sigma) {
  auto* cost = new ceres::DynamicAutoDiffCostFunction<GaussPrior, 4>(new GaussPrior{1 / sigma, size});
  cost->AddParameterBlock(size);
  cost->SetNumResiduals(size);
  problem.AddResidualBlock(cost, nullptr, block);
}

// Minimises over what `stage` frees. Returns the cost; `state` moves.
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
  add_prior(problem, state.block(unknown::vignette, 0), 3, kVignettePriorSigma);
  add_prior(problem, state.log_paper, 1, kPaperFactorSigma);

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

double median_of(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Weighs each photo by its noise and by what its residuals say the model misses: the relative error m for which the
// median of |residual| / sqrt(noise^2 + (m prediction)^2) is that of a normal distribution. A photo that the model
// cannot explain (moved, out of focus) so weighs little by itself.
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

// Size of a photo's pixel on the board, mm: the root of the area that its middle pixel covers.
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

// Cost of every `stride`-th photo.
double cost_of(const Problem& data, const State& state, std::size_t stride) {
  double cost = 0;
  const Scratches carved = carved_scratches(data.model, state.of(0));  // the same for all lamps
  for (std::size_t k = 0; k < data.photos.size(); k += stride)
    cost += photo_cost(data.model, data.photos[k], state.of(data.photos[k].photo.light), carved);
  return cost;
}

// ---- uncertainty
// ------------------------------------------------------------------------------------------------------

// Indices of all unknowns of a problem in one vector: shared, paper, lamps.
int global_index(int index, std::size_t light) {
  return index < kFirstLampUnknown
             ? index
             : kSharedUnknowns + 1 + static_cast<int>(light) * kLampUnknowns + (index - kFirstLampUnknown);
}

struct Uncertainty {
  std::vector<Eigen::MatrixXd> covariances;          // three estimates, over all unknowns; held ones are 0
  std::vector<std::vector<Eigen::VectorXd>> halves;  // unused by sigma(): shifts when only half of the photos count

  // The largest of the estimates for the linear combination a.
  double sigma(const Eigen::VectorXd& a) const {
    double variance = 0;
    for (const Eigen::MatrixXd& c : covariances) variance = std::max(variance, a.dot(c * a));
    return std::sqrt(variance);
  }
  double sigma(int index) const { return sigma(Eigen::VectorXd::Unit(covariances.front().rows(), index)); }
};

// Inverse on the space that is determined: directions without information get a variance that says so.
Eigen::MatrixXd safe_inverse(const Eigen::MatrixXd& H, const std::vector<bool>& free) {
  const Eigen::Index n = H.rows();
  Eigen::VectorXd scale = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i)
    if (free[i]) scale[i] = H(i, i) > 0 ? 1 / std::sqrt(H(i, i)) : 1;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * H * scale.asDiagonal());
  Eigen::VectorXd inverse = eigen.eigenvalues();
  for (double& v : inverse) v = 1 / std::max(v, 1e-12);
  const Eigen::MatrixXd S = scale.asDiagonal() * eigen.eigenvectors();
  return S * inverse.asDiagonal() * S.transpose();
}

Uncertainty uncertainty_of(const Problem& data, const Stage& stage, State& state, std::size_t light_count) {
  const Eigen::Index n = kSharedUnknowns + 1 + static_cast<Eigen::Index>(light_count) * kLampUnknowns;
  std::vector<bool> free(n, false);
  free[kSharedUnknowns] = true;
  FreeUnknowns wanted{};
  for (const Block& block : kBlocks)
    for (int i = 0; i < block.size && block.first != unknown::pose; ++i) {
      wanted[block.first + i] = block.first == unknown::spot ? stage.lamp : frees(stage, block.first);
      for (std::size_t light = 0; light < light_count; ++light)
        if (wanted[block.first + i] && (block.first != unknown::spot || data.is_spot[light]))
          free[global_index(block.first + i, light)] = true;
    }

  constexpr double kTileMm = 20;
  const Scratches carved = carved_scratches(data.model, state.of(0));
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n), tiles;
  std::vector<Eigen::MatrixXd> H_photo;
  std::vector<Eigen::VectorXd> g_photo;
  double cost = 0;
  std::size_t pixels = 0;
  for (const PhotoData& photo : data.photos) {
    const std::size_t light = photo.photo.light;
    const Unknowns x = state.of(light);
    const PhotoEquations e = photo_equations(data.model, photo, x, carved_scratches(data.model, x), wanted, kTileMm);
    Eigen::MatrixXd Hk = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd gk = Eigen::VectorXd::Zero(n);
    if (tiles.size() == 0) tiles = Eigen::MatrixXd::Zero(n, e.tile_scores.cols());
    for (int a = 0; a < unknown::pose; ++a) {
      const int ga = global_index(a, light);
      gk[ga] = e.Jtr[a];
      tiles.row(ga) += e.tile_scores.row(a);
      for (int b = 0; b < unknown::pose; ++b) Hk(ga, global_index(b, light)) = e.JtJ(a, b);
    }
    cost += e.cost;
    for (const float w : photo.weight) pixels += w > 0;
    H += Hk;
    H_photo.push_back(std::move(Hk));
    g_photo.push_back(std::move(gk));
  }
  // Paper belongs to the photo it was seen in; a tag's albedo is its own in all photos.
  std::map<int, Eigen::VectorXd> tag_scores;
  for (const LightSample& sample : data.paper) {
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
    double r = 0;
    cost_function.Evaluate(blocks.data(), &r, jacobians.data());
    Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
    for (int b = 0; b < 6; ++b)
      for (int i = 0; i < cost_function.parameter_block_sizes()[b]; ++i) {
        const int at = kFirst[b] < 0 ? kSharedUnknowns : global_index(kFirst[b] + i, sample.light);
        if (free[at]) row[at] = jacobian[b][i];
      }
    const double weight = 1 / (1 + r * r / (kPaperLoss * kPaperLoss));
    const Eigen::MatrixXd outer = weight * row * row.transpose();
    H += outer;
    H_photo[sample.light_view] += outer;
    g_photo[sample.light_view] += weight * r * row;
    auto [at, fresh] = tag_scores.try_emplace(sample.tag, Eigen::VectorXd::Zero(n));
    at->second += weight * r * row;
  }
  Eigen::VectorXd prior = Eigen::VectorXd::Zero(n);
  prior[kSharedUnknowns] = 1 / (kPaperFactorSigma * kPaperFactorSigma);
  for (int i = 0; i < 3; ++i)
    if (free[unknown::vignette + i]) prior[unknown::vignette + i] = 1 / (kVignettePriorSigma * kVignettePriorSigma);
  H.diagonal() += prior;

  const Eigen::MatrixXd inverse = safe_inverse(H, free);
  Uncertainty out;
  const double scatter = pixels ? std::max(1.0, 2 * cost / static_cast<double>(pixels)) : 1;
  out.covariances.push_back(scatter * inverse);

  Eigen::MatrixXd meat = tiles * tiles.transpose();
  for (const auto& [tag, score] : tag_scores) meat += score * score.transpose();
  meat.diagonal() += prior;  // the priors' own scatter
  out.covariances.push_back(inverse * meat * inverse);

  const std::size_t count = H_photo.size();
  if (count >= 3) {
    std::vector<Eigen::VectorXd> shifts;
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
    for (std::size_t k = 0; k < count; ++k) {
      shifts.push_back(safe_inverse(H - H_photo[k], free) * g_photo[k]);
      mean += shifts.back() / static_cast<double>(count);
    }
    Eigen::MatrixXd jackknife = Eigen::MatrixXd::Zero(n, n);
    for (const Eigen::VectorXd& s : shifts) jackknife += (s - mean) * (s - mean).transpose();
    out.covariances.push_back(jackknife * (static_cast<double>(count) - 1) / static_cast<double>(count));
  }
  return out;
}

// ---- what the result says
// ---------------------------------------------------------------------------------------------

std::string number(double value, int digits = 3) {
  std::ostringstream out;
  out.precision(digits);
  out << value;
  return out.str();
}

// Pairs of scratch and photo near the groove's cut-off: how many half vectors lean less, and how many more, across the
// scratch than its steepest normal, 2 atan(T). Only scratches that could glint count: h within 2 alpha of the plane
// across.
struct Straddle {
  std::size_t inside = 0, outside = 0;
  bool both() const {
    constexpr std::size_t kFewest = 25;
    return inside >= kFewest && outside >= kFewest;
  }
};

Straddle straddle_of(const Problem& data, const State& state) {
  Straddle out;
  ModelData whole = data.model;
  whole.last_carved_rules = false;
  const Scratches carved = carved_scratches(whole, state.of(0));
  for (const PhotoData& photo : data.photos) {
    const Unknowns x = state.of(photo.photo.light);
    const double alpha = std::exp(x[unknown::log_alpha]), depth = std::exp(x[unknown::log_depth]);
    const Eigen::Vector3d lamp = x.segment<3>(unknown::lamp_position), camera = photo.scene.camera_center_mm;
    for (std::size_t i = 0; i < carved.size(); ++i) {
      const Eigen::Vector3d a(carved.x0_mm[i], carved.y0_mm[i], 0), b(carved.x1_mm[i], carved.y1_mm[i], 0);
      const Eigen::Vector3d p = 0.5 * (a + b);
      const Eigen::Vector3d n = face_normal(photo.camera.surface, p.x(), p.y());
      const Eigen::Vector3d along = (b - a).normalized(), across = along.cross(n);
      const Eigen::Vector3d h = ((lamp - p).normalized() + (camera - p).normalized()).normalized();
      if (std::abs(std::asin(std::clamp(h.dot(along), -1.0, 1.0))) > 2 * alpha) continue;
      const double width = carved.width_um.empty() ? data.model.board->tool_width_um : carved.width_um[i];
      const double cutoff = 2 * std::atan(groove_rim(width, carved.depth_um.empty() ? depth : carved.depth_um[i]));
      const double beyond = std::atan2(std::abs(h.dot(across)), h.dot(n)) - cutoff;
      const double band = 0.05 + 4 * alpha, softness = 0.5 * alpha;
      if (std::abs(beyond) > band || std::abs(beyond) < softness) continue;
      ++(beyond > 0 ? out.outside : out.inside);
    }
  }
  return out;
}

PhotoFit photo_fit(const Problem& data, std::size_t k, const State& state, const Scratches& carved,
                   const Bench& bench) {
  const PhotoData& photo = data.photos[k];
  const Unknowns x = state.of(photo.photo.light);
  const Image predicted = predict(data.model, photo, x, carved);
  PhotoFit fit;
  fit.view = bench.views[photo.photo.view].name;
  fit.light = bench.lights[photo.photo.light].id;
  std::vector<double> to_noise;
  double residual2 = 0, value2 = 0;
  std::size_t inliers = 0;
  constexpr double kOutlier = 4;
  for (std::size_t i = 0; i < predicted.data.size(); ++i) {
    if (!(photo.weight[i] > 0)) continue;
    ++fit.pixels;
    const double r = static_cast<double>(predicted.data[i]) - photo.photo.value.data[i];
    to_noise.push_back(std::abs(r) / photo.photo.sigma.data[i]);
    if (std::abs(r) * photo.weight[i] > kOutlier) continue;
    ++inliers;
    residual2 += r * r;
    value2 += static_cast<double>(photo.photo.value.data[i]) * photo.photo.value.data[i];
  }
  if (fit.pixels == 0) return fit;
  fit.residual_rms = value2 > 0 ? std::sqrt(residual2 / value2) : 0;
  fit.residual_to_noise = median_of(to_noise) / 0.6745;
  fit.outliers = 1 - static_cast<double>(inliers) / static_cast<double>(fit.pixels);
  return fit;
}

// Colours: with everything else known, each channel of a photo is linear in its lamp's intensity and the ambient light.
void fit_colors(const Problem& data, std::span<const MergedView> merged, const State& state, Bench& bench) {
  const std::size_t lights = bench.lights.size();
  const Eigen::Vector3d f0 = bench.material.f0;
  const auto n = static_cast<Eigen::Index>(lights + 1);
  std::array<Eigen::MatrixXd, 3> H;
  std::array<Eigen::VectorXd, 3> g;
  for (int c = 0; c < 3; ++c) {
    H[c] = Eigen::MatrixXd::Zero(n, n);
    g[c] = Eigen::VectorXd::Zero(n);
  }
  bool colored = false;
  const Scratches carved = carved_scratches(data.model, state.of(0));
  for (const PhotoData& photo : data.photos) {
    const MergedView& source = merged[photo.photo.merged];
    if (source.value.channels != 3) continue;
    colored = true;
    const Unknowns x = state.of(photo.photo.light);
    const Image both = predict(data.model, photo, x, carved);
    for (int y = 0; y < both.height; ++y)
      for (int px = 0; px < both.width; ++px) {
        const std::size_t i = static_cast<std::size_t>(y) * both.width + px;
        if (!(photo.weight[i] > 0)) continue;
        const double r = photo.weight[i] * (static_cast<double>(both.data[i]) - photo.photo.value.data[i]);
        const double ambient =
            vignette_at(x.data() + unknown::vignette, static_cast<double>(photo.radius2[i])) * data.model.f0;
        const double lamp = both.data[i] - x[unknown::ambient] * ambient;
        const double weight = photo.weight[i] * photo.weight[i] / (1 + r * r / (data.model.cauchy * data.model.cauchy));
        for (int c = 0; c < 3; ++c) {
          double value = 0;
          for (int v = 0; v < photo.bin; ++v)
            for (int u = 0; u < photo.bin; ++u)
              value += source.value.at((px + photo.photo.window.x0) * photo.bin + u,
                                       (y + photo.photo.window.y0) * photo.bin + v, c);
          value /= photo.bin * photo.bin;
          Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
          row[static_cast<Eigen::Index>(photo.photo.light)] = lamp * f0[c] / data.model.f0;
          row[n - 1] = ambient * f0[c] / data.model.f0;
          H[c].noalias() += weight * row * row.transpose();
          g[c] += weight * value * row;
        }
      }
  }
  if (!colored) return;
  for (int c = 0; c < 3; ++c) {
    const Eigen::VectorXd factor = H[c].ldlt().solve(g[c]);
    if (!factor.allFinite()) continue;
    for (std::size_t light = 0; light < lights; ++light)
      if (H[c](static_cast<Eigen::Index>(light), static_cast<Eigen::Index>(light)) > 0)
        bench.lights[light].intensity[c] *= factor[static_cast<Eigen::Index>(light)];
    bench.ambient[c] = std::max(0.0, factor[n - 1]);
  }
}

// Writes state and uncertainty into a bench, and judges each parameter.
void fill_bench(const Problem& data, const State& state, const Uncertainty& uncertainty, const Stage& stage,
                Refinement& out) {
  Bench& bench = out.bench;
  const Board& board = *data.model.board;
  const auto& s = state.shared;
  bench.material.alpha = std::exp(s[unknown::log_alpha]);
  bench.material.depth_um = std::exp(s[unknown::log_depth]);
  bench.material.base_alpha = std::exp(s[unknown::log_base_alpha]);
  bench.material.f0 = board.material.f0;
  bench.sensor.gain = 1;
  bench.sensor.vignette = Eigen::Vector3d(s[unknown::vignette], s[unknown::vignette + 1], s[unknown::vignette + 2]);
  bench.sensor.psf_sigma_px = std::exp(s[unknown::log_blur]);
  bench.ambient.setConstant(s[unknown::ambient]);
  for (int i = 0; i < 2; ++i) {
    out.depth_gradient[i] = s[unknown::depth_gradient + i];
    out.depth_gradient_sigma[i] = stage.gradient ? uncertainty.sigma(unknown::depth_gradient + i) : 0;
  }

  const auto judge = [&](const std::string& name, double relative_sigma, double limit, const std::string& text) {
    const bool good = relative_sigma < limit;
    bench.verdict[name] = {good, text + (good ? "" : "; the photos do not tell it better than that")};
  };
  const auto percent = [](double v) { return number(100 * v, 2) + " %"; };

  const double alpha_sigma = uncertainty.sigma(unknown::log_alpha);
  const double depth_sigma = uncertainty.sigma(unknown::log_depth);
  const double base_sigma = uncertainty.sigma(unknown::log_base_alpha);
  constexpr double kLimit = 0.2;
  judge("alpha", alpha_sigma, kLimit, "one sigma is " + percent(alpha_sigma));
  if (alpha_sigma < kLimit) bench.material_sigma.alpha = bench.material.alpha * alpha_sigma;
  judge("base_alpha", base_sigma, kLimit, "one sigma is " + percent(base_sigma));
  if (base_sigma < kLimit) bench.material_sigma.base_alpha = bench.material.base_alpha * base_sigma;

  const Straddle straddle = straddle_of(data, state);
  const std::string counts = std::to_string(straddle.inside) + " half vectors lean a little less and " +
                             std::to_string(straddle.outside) + " a little more than the grooves' steepest wall";
  if (!straddle.both()) {
    bench.verdict["depth_um"] = {
        false, counts + ", so no photo shows where the glints end; photograph the board from further to the side"};
    bench.material_sigma.depth_um.reset();
  } else {
    judge("depth_um", depth_sigma, kLimit, "one sigma is " + percent(depth_sigma) + "; " + counts);
    if (depth_sigma < kLimit) bench.material_sigma.depth_um = bench.material.depth_um * depth_sigma;
  }

  Eigen::Matrix2d A;
  A << s[unknown::machine], s[unknown::machine + 1], s[unknown::machine + 2], s[unknown::machine + 3];
  const Eigen::Vector2d c = data.model.center_mm, t(s[unknown::machine + 4], s[unknown::machine + 5]);
  bench.machine_affine << A, c - A * c + t;
  Affine2 sigma;
  for (int row = 0; row < 2; ++row) {
    Eigen::VectorXd a = Eigen::VectorXd::Zero(uncertainty.covariances.front().rows());
    for (int column = 0; column < 2; ++column) {
      sigma(row, column) = uncertainty.sigma(unknown::machine + 2 * row + column);
      a[unknown::machine + 2 * row + column] = -c[column];
    }
    a[unknown::machine + 4 + row] = 1;
    sigma(row, 2) = uncertainty.sigma(a);
  }
  bench.machine_affine_sigma = sigma;
  double worst = 0;  // over the carve area's corners
  for (const double x : {board.carve_min_mm.x(), board.carve_max_mm.x()})
    for (const double y : {board.carve_min_mm.y(), board.carve_max_mm.y()})
      for (int row = 0; row < 2; ++row) {
        Eigen::VectorXd a = Eigen::VectorXd::Zero(uncertainty.covariances.front().rows());
        a[unknown::machine + 2 * row] = x - c.x();
        a[unknown::machine + 2 * row + 1] = y - c.y();
        a[unknown::machine + 4 + row] = 1;
        worst = std::max(worst, uncertainty.sigma(a));
      }
  judge("machine.affine", worst, 0.1, "one sigma is at most " + number(worst, 2) + " mm over the carve area");

  for (std::size_t light = 0; light < bench.lights.size(); ++light) {
    Light& l = bench.lights[light];
    const auto& v = state.lamps[light];
    const auto at = [&](int index) { return global_index(index, light); };
    l.position_mm = Eigen::Vector3d(v[0], v[1], v[2]);
    l.intensity.setConstant(std::exp(v[unknown::log_intensity - kFirstLampUnknown]));
    const double* spot = v.data() + (unknown::spot - kFirstLampUnknown);
    l.falloff_exponent = data.is_spot[light] ? spot[2] : 0;
    l.axis = (Eigen::Vector3d(spot[0], spot[1], 0) - l.position_mm).normalized();
    const bool seen =
        std::any_of(data.photos.begin(), data.photos.end(), [&](const PhotoData& p) { return p.photo.light == light; });
    const std::string name = "light." + l.id;
    if (!seen) {
      bench.verdict[name + ".position_mm"] = {false, "no photo shows the board under this lamp"};
      continue;
    }
    if (stage.lamp) {
      Eigen::Vector3d position_sigma;
      for (int i = 0; i < 3; ++i) position_sigma[i] = uncertainty.sigma(at(unknown::lamp_position + i));
      judge(name + ".position_mm", position_sigma.norm() / l.position_mm.norm(), 0.05,
            "one sigma is " + number(position_sigma.norm(), 2) + " mm");
      l.position_sigma_mm = position_sigma;
      if (data.is_spot[light]) {
        l.falloff_exponent_sigma = uncertainty.sigma(at(unknown::spot + 2));
        judge(name + ".falloff_exponent", *l.falloff_exponent_sigma / std::max(1e-9, l.falloff_exponent), 0.5,
              "one sigma is " + number(*l.falloff_exponent_sigma, 2));
      }
    }
    const double intensity_sigma = uncertainty.sigma(at(unknown::log_intensity));
    l.intensity_sigma = l.intensity * intensity_sigma;
    judge(name + ".intensity", intensity_sigma, kLimit, "one sigma is " + percent(intensity_sigma));
  }
}

}  // namespace

Refinement refine(std::span<const MergedView> merged, const Board& board, const Scratches& designed,
                  const Bench& measured, const RefineOptions& options, const Progress& progress) {
  if (designed.size() == 0)
    fail("scratches", "there is no scratch to refine against", "name the designed scratches in board.json");
  Refinement out;
  out.bench = measured;
  const std::vector<LightView> views = make_light_views(merged, board, out.bench, out.findings);
  if (views.empty())
    fail("session", "no photo has both a camera pose and the board in it", "run burin calibrate on this session first");

  if (progress) progress("finding the lamp", 0);
  const std::vector<LightSample> samples = gather_light_samples(views, board, out.bench, designed);
  const LampSeed seed = fit_lamps(samples, board, out.bench);
  out.findings.insert(out.findings.end(), seed.findings.begin(), seed.findings.end());

  Problem data;
  data.model.board = &board;
  data.model.designed = &designed;
  data.model.center_mm = 0.5 * (board.carve_min_mm + board.carve_max_mm);
  data.model.f0 = board.material.f0.mean();
  data.is_spot.assign(out.bench.lights.size(), false);
  for (const LightSample& sample : samples)
    if (sample.kind != SampleKind::face && sample.value > 0) data.paper.push_back(sample);

  State state;
  state.lamps.resize(out.bench.lights.size());
  state.shared[unknown::log_alpha] = std::log(board.material.alpha);
  state.shared[unknown::log_depth] = std::log(board.material.depth_um);
  state.shared[unknown::log_base_alpha] = std::log(seed.found ? seed.base_alpha : board.material.base_alpha);
  const Affine2& affine = out.bench.machine_affine;
  const Eigen::Vector2d shift = affine.leftCols<2>() * data.model.center_mm + affine.col(2) - data.model.center_mm;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) state.shared[unknown::machine + 2 * row + column] = affine(row, column);
    state.shared[unknown::machine + 4 + row] = shift[row];
  }
  state.shared[unknown::ambient] = seed.found ? seed.ambient : out.bench.ambient.mean();
  for (int i = 0; i < 3; ++i) state.shared[unknown::vignette + i] = seed.found ? seed.vignette[i] : 0;
  constexpr double kBlurAtFirstPx = 0.6;
  state.shared[unknown::log_blur] =
      std::log(out.bench.sensor.psf_sigma_px > 0 ? out.bench.sensor.psf_sigma_px : kBlurAtFirstPx);
  for (std::size_t i = 0; i < state.lamps.size(); ++i) {
    const Light& light = seed.found && options.fit_lamp ? seed.lights[i] : out.bench.lights[i];
    const Eigen::Vector2d aim = seed.found ? seed.aim_mm[i] : Eigen::Vector2d(0.5 * board.size_mm);
    data.is_spot[i] = light.falloff_exponent > 0;
    const double intensity = (seed.found ? seed.lights[i] : light).intensity.mean();
    state.lamps[i] = {light.position_mm.x(),
                      light.position_mm.y(),
                      light.position_mm.z(),
                      std::log(std::max(1e-12, intensity)),
                      aim.x(),
                      aim.y(),
                      light.falloff_exponent};
  }

  std::vector<double> sizes;
  double total_pixels = 0;
  for (const LightView& view : views) {
    sizes.push_back(pixel_mm(view, out.bench));
    total_pixels += static_cast<double>(view.value.data.size());
  }
  const double size = median_of(sizes);
  const int finest = std::max({1, static_cast<int>(std::ceil(options.finest_pixel_mm / size - 1e-9)),
                               static_cast<int>(std::ceil(std::sqrt(total_pixels / options.max_pixels) - 1e-9))});
  constexpr double kCoarsePixelMm = 1.6, kMiddlePixelMm = 0.8;
  const int coarse = std::max(finest, static_cast<int>(std::lround(kCoarsePixelMm / size)));
  const int middle = std::max(finest, static_cast<int>(std::lround(kMiddlePixelMm / size)));

  const auto blur = [&] { return std::exp(state.shared[unknown::log_blur]); };
  data.photos = photos_at(views, coarse, board, out.bench, blur());
  std::size_t used = 0;
  for (const PhotoData& photo : data.photos)
    used += std::count_if(photo.weight.begin(), photo.weight.end(), [](float w) { return w > 0; });
  if (used < 1000)
    fail("session", "hardly a pixel of bare metal is seen unclipped",
         "add shorter exposures, or photos nearer to the board");

  // A grid of starts over alpha and depth: what is believed of them may be off by factors.
  for (PhotoData& photo : data.photos)
    for (std::size_t i = 0; i < photo.weight.size(); ++i)
      if (photo.weight[i] > 0)
        photo.weight[i] = 1 / std::hypot(photo.photo.sigma.data[i], 0.2F * photo.photo.value.data[i]);
  const std::size_t stride = 1 + (data.photos.size() - 1) / 5;
  State best = state;
  double best_cost = -1;
  const std::array<double, 5> alphas{0.02, 0.04, 0.08, 0.15, 0.3};
  const std::array<double, 4> depth_factors{0.4, 0.8, 1.5, 3};
  int tried = 0;
  for (const double alpha : alphas)
    for (const double factor : depth_factors) {
      State candidate = state;
      candidate.shared[unknown::log_alpha] = std::log(alpha);
      candidate.shared[unknown::log_depth] = std::log(factor * board.material.depth_um);
      const double cost = cost_of(data, candidate, stride);
      if (best_cost < 0 || cost < best_cost) {
        best_cost = cost;
        best = candidate;
      }
      if (progress)
        progress("trying roughness and depth", static_cast<double>(++tried) / (alphas.size() * depth_factors.size()));
    }
  state = best;

  Stage stage;
  stage.lamp = options.fit_lamp;
  stage.machine = false;
  weigh_photos(data, state);
  solve(data, stage, 6, 1e-3, state, progress, "fitting coarse photos");
  stage.machine = true;
  weigh_photos(data, state);
  solve(data, stage, options.max_iterations, 1e-4, state, progress, "fitting coarse photos and the machine");
  data.model.last_carved_rules = options.overlap == Overlap::last;
  if (options.overlap == Overlap::automatic) {
    weigh_photos(data, state);
    State adding = state, last = state;
    const double cost_adding = solve(data, stage, 4, 1e-4, adding, progress, "crossing scratches as a sum");
    data.model.last_carved_rules = true;
    const double cost_last = solve(data, stage, 4, 1e-4, last, progress, "crossing scratches, the last one rules");
    data.model.last_carved_rules = cost_last < cost_adding;
    state = data.model.last_carved_rules ? last : adding;
  }
  out.overlap = data.model.last_carved_rules ? Overlap::last : Overlap::add;

  stage.gradient = options.fit_depth_gradient;
  if (middle < coarse) data.photos = photos_at(views, middle, board, out.bench, blur());
  stage.blur = true;
  weigh_photos(data, state);
  solve(data, stage, options.max_iterations, 1e-5, state, progress, "fitting binned photos");
  if (stage.gradient) {
    const Uncertainty sigmas = uncertainty_of(data, stage, state, state.lamps.size());
    double significance = 0;
    for (int i = 0; i < 2; ++i)
      significance = std::max(significance, std::abs(state.shared[unknown::depth_gradient + i]) /
                                                sigmas.sigma(unknown::depth_gradient + i));
    constexpr double kSignificant = 3;
    if (significance < kSignificant) {
      stage.gradient = false;
      for (int i = 0; i < 2; ++i) state.shared[unknown::depth_gradient + i] = 0;
    }
  }

  if (finest < middle) data.photos = photos_at(views, finest, board, out.bench, blur());
  stage.blur = true;
  weigh_photos(data, state);
  solve(data, stage, options.max_iterations, 1e-5, state, progress, "fitting photos");
  weigh_photos(data, state);
  solve(data, stage, options.max_iterations, 1e-6, state, progress, "fitting photos with their own errors");
  if (progress) progress("judging the result", 0);
  const Uncertainty uncertainty = uncertainty_of(data, stage, state, state.lamps.size());

  fill_bench(data, state, uncertainty, stage, out);
  fit_colors(data, merged, state, out.bench);
  out.model_error = median_of(data.photo_model_error);
  const Scratches carved = carved_scratches(data.model, state.of(0));
  for (std::size_t k = 0; k < data.photos.size(); ++k)
    out.photos.push_back(photo_fit(data, k, state, carved, out.bench));
  return out;
}

Refinement refine(const Session& session, const Board& board, const Scratches& designed, const Bench& measured,
                  const RefineOptions& options, const Progress& progress) {
  if (progress) progress("reading photos", 0);
  const std::vector<MergedView> merged = merge_session(session);
  return refine(merged, board, designed, measured, options, progress);
}

}  // namespace burin
