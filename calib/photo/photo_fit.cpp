#include "burin/calib/photo/photo_fit.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/carved_states.h"
#include "burin/calib/photo/paper_equation.h"

namespace burin {
namespace {

// The unknowns of a photo, as Ceres' parameter blocks.
struct Block {
  const UnknownRow* row;
  int first;
};
constexpr std::size_t count_blocks() {
  std::size_t count = 0;
  for (const UnknownRow& row : kUnknownRows) count += row.scope == Scope::shared || row.scope == Scope::lamp ? 1 : 0;
  return count;
}
constexpr std::array<Block, count_blocks()> blocks_of_rows() {
  std::array<Block, count_blocks()> out{};
  std::size_t b = 0;
  int first = 0;
  for (const UnknownRow& row : kUnknownRows) {
    if (row.scope == Scope::shared || row.scope == Scope::lamp) out[b++] = {&row, first};
    first += row.size;
  }
  return out;
}
constexpr auto kBlocks = blocks_of_rows();

// One photo as a Ceres cost function. An orthogonal transform compresses its weighted residuals and their Jacobian to
// count + 1 numbers with the same cost, gradient and Gauss-Newton matrix. Ceres' memory thus does not grow with the
// pixels. Derivatives take ten times as long as values, so they are kept while they hold (slopes_hold). A fit that
// starts near the optimum computes them once. PhotosAtOnce evaluates the photos in parallel before Ceres reads them.
// Ceres then sums them in one order, by one thread.
class PhotoCost : public ceres::CostFunction {
 public:
  PhotoCost(const ModelData& model, const PhotoData& photo, const CarvedStates& grooves, std::vector<double*> blocks)
      : model_(model), photo_(photo), grooves_(grooves), blocks_(std::move(blocks)) {
    for (const Block& block : kBlocks) mutable_parameter_block_sizes()->push_back(block.row->size);
    set_num_residuals(unknown::count + 1);
  }

  const std::vector<double*>& blocks() const { return blocks_; }

  /// Residuals at the blocks' present values and, unless `free_unknowns` is null, their Jacobian by these unknowns.
  void look(const FreeUnknowns* free_unknowns) {
    Unknowns x = Unknowns::Zero();  // cameras, bow and lens are held
    for (std::size_t b = 0; b < kBlocks.size(); ++b)
      for (int i = 0; i < kBlocks[b].row->size; ++i) x[kBlocks[b].first + i] = blocks_[b][i];
    const std::shared_ptr<const Carved> carved = grooves_.at(x);
    residuals_ = Eigen::VectorXd::Zero(unknown::count + 1);
    // Ceres evaluates an accepted step twice: for its cost, and with the Jacobian.
    if (light_.data.empty() || x != seen_at_) {
      light_ = seen_light(model_, photo_, x, *carved);
      seen_at_ = x;
    }
    if (free_unknowns == nullptr) {
      residuals_[unknown::count] = std::sqrt(2 * photo_cost(model_, photo_, x, light_));
      return;
    }
    const FreeUnknowns& free = *free_unknowns;
    if (slopes_.free != free || !slopes_hold(model_, photo_, slopes_, x, light_))
      slopes_ = photo_slopes(model_, photo_, x, *carved, grooves_, free);
    const PhotoEquations equations = photo_equations(model_, photo_, x, light_, slopes_);
    // JtJ = D U S U^T D with D its diagonal's root: rows sqrt(S) U^T D, residuals S^-1/2 U^T D^-1 Jtr.
    const ScaledEigen eigen = scaled_eigen(equations.JtJ);
    const Eigen::VectorXd D = equations.JtJ.diagonal().cwiseSqrt(), S = eigen.values.cwiseMax(0);
    J_ = S.cwiseSqrt().asDiagonal() * eigen.vectors.transpose() * D.asDiagonal();
    Eigen::VectorXd r = eigen.vectors.transpose() * (eigen.scale.asDiagonal() * equations.Jtr);
    for (Eigen::Index i = 0; i < r.size(); ++i) r[i] = S[i] > 1e-13 ? r[i] / std::sqrt(S[i]) : 0;
    residuals_.head(unknown::count) = r;
    residuals_[unknown::count] = std::sqrt(std::max(0.0, 2 * equations.cost - r.squaredNorm()));
  }

  bool Evaluate(double const* const* /*parameters*/, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd>(residuals, unknown::count + 1) = residuals_;
    if (jacobians == nullptr) return residuals_.allFinite();
    for (std::size_t b = 0; b < kBlocks.size(); ++b) {
      if (jacobians[b] == nullptr) continue;
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> block(
          jacobians[b], unknown::count + 1, kBlocks[b].row->size);
      block.setZero();
      block.topRows(unknown::count) = J_.middleCols(kBlocks[b].first, kBlocks[b].row->size);
    }
    return residuals_.allFinite() && J_.allFinite();
  }

 private:
  const ModelData& model_;
  const PhotoData& photo_;
  const CarvedStates& grooves_;
  std::vector<double*> blocks_;  // one parameter block for each of kBlocks
  Unknowns seen_at_ = Unknowns::Zero();
  Image light_;  // at seen_at_
  PhotoSlopes slopes_;
  Eigen::VectorXd residuals_;
  Eigen::MatrixXd J_;
};

// Evaluates all photos before Ceres reads a state, two at a time: while one sums its equations on one core, the other
// is rendered on all cores. More at a time would take memory (a photo's derivatives are 40 pictures) and save little
// time.
class PhotosAtOnce : public ceres::EvaluationCallback {
 public:
  std::vector<PhotoCost*> photos;
  std::vector<FreeUnknowns> free;  // per photo
  int at_once = 2;

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    if (!evaluate_jacobians && !new_evaluation_point) return;
    each_photo(photos.size(), std::min(2, at_once),
               [&](std::size_t k) { photos[k]->look(evaluate_jacobians ? &free[k] : nullptr); });
  }
};

using PaperCost = ceres::AutoDiffCostFunction<PaperResidual, 1, 1, 3, 3, 1, 2, 1, 1>;

struct GaussPrior {
  std::vector<double> sigma;
  template <typename T>
  bool operator()(T const* const* x, T* residual) const {
    for (std::size_t i = 0; i < sigma.size(); ++i) residual[i] = x[0][i] / sigma[i];
    return true;
  }
};

// `row`'s prior on its block; none if it has no prior.
void add_prior(ceres::Problem& problem, const UnknownRow& row, double* block) {
  if (!(row.prior_sigma[0] > 0)) return;
  auto* cost = new ceres::DynamicAutoDiffCostFunction<GaussPrior, 4>(
      new GaussPrior{{row.prior_sigma.begin(), row.prior_sigma.begin() + row.size}});
  cost->AddParameterBlock(row.size);
  cost->SetNumResiduals(row.size);
  problem.AddResidualBlock(cost, nullptr, block);
}

// Adds photos and paper as Ceres' residual blocks. Returns the photos' lamps.
std::set<std::size_t> add_residuals(const Problem& data, const CarvedStates& grooves, State& state,
                                    PhotosAtOnce& photos, ceres::Problem& problem) {
  std::set<std::size_t> lights;
  for (const PhotoData& photo : data.photos) {
    const std::size_t light = photo.photo.light;
    lights.insert(light);
    std::vector<double*> blocks;
    blocks.reserve(kBlocks.size());
    for (const Block& block : kBlocks) blocks.push_back(state.block(block.first, light));
    auto* cost = new PhotoCost(data.model, photo, grooves, blocks);
    photos.photos.push_back(cost);
    problem.AddResidualBlock(cost, nullptr, blocks);
  }
  for (const LightSample& sample : data.paper) {
    if (!lights.count(sample.light)) continue;
    problem.AddResidualBlock(new PaperCost(new PaperResidual(paper_residual(data, state, sample))),
                             new ceres::CauchyLoss(kPaperLoss), state.block(unknown::ambient),
                             state.block(unknown::vignette), state.block(unknown::lamp_position, sample.light),
                             state.block(unknown::log_intensity, sample.light),
                             state.block(unknown::spot, sample.light), state.block(unknown::spot + 2, sample.light),
                             state.block(unknown::log_paper));
  }
  for_each_unknown([&](const UnknownRow& row, int first) {
    if (row.scope == Scope::shared || row.scope == Scope::paper) add_prior(problem, row, state.block(first));
  });
  return lights;
}

// A block of one number with reachable bounds.
struct Bounded {
  double* value;
  double low, high;
};

// Holds the stage's fixed unknowns, and bounds the rest. Returns the ones with reachable bounds: all except aims and
// lamps' positions, which reach them only in a failed fit.
std::vector<Bounded> hold_and_bound(const Problem& data, const Stage& stage, const std::set<std::size_t>& lights,
                                    State& state, ceres::Problem& problem) {
  std::vector<Bounded> out;
  for (const Block& block : kBlocks)
    for (const std::size_t light : lights) {
      const UnknownRow& row = *block.row;
      if (row.scope == Scope::shared && light != *lights.begin()) continue;
      double* values = state.block(block.first, light);
      const bool exists = has_unknown(data, row, light);
      if (!exists || !stage.frees(row.group)) problem.SetParameterBlockConstant(values);
      double low = 0, high = 0;
      if (!exists || !bounds_of(data, row, low, high)) continue;
      if (row.group == Group::blur) std::tie(low, high) = log_blur_range(data);
      for (int i = row.bounds.at; i < row.bounds.at + row.bounds.count; ++i) {
        values[i] = std::clamp(values[i], low, high);
        problem.SetParameterLowerBound(values, i, low);
        problem.SetParameterUpperBound(values, i, high);
      }
      if (row.size == 1 && !problem.IsParameterBlockConstant(values)) out.push_back({values, low, high});
    }
  return out;
}

// The ones on a bound against which the cost pushes them.
std::set<double*> pushed_out(const std::vector<Bounded>& bounded, ceres::Problem& problem) {
  std::vector<Bounded> on_bound;
  ceres::Problem::EvaluateOptions options;
  for (const Bounded& b : bounded) {
    if (*b.value > b.low && *b.value < b.high) continue;
    on_bound.push_back(b);
    options.parameter_blocks.push_back(b.value);
  }
  std::set<double*> out;
  if (on_bound.empty()) return out;
  std::vector<double> gradient;
  problem.Evaluate(options, nullptr, nullptr, &gradient, nullptr);
  for (std::size_t i = 0; i < on_bound.size(); ++i)
    if (*on_bound[i].value <= on_bound[i].low ? gradient[i] > 0 : gradient[i] < 0) out.insert(on_bound[i].value);
  return out;
}

}  // namespace

double solve(const Problem& data, const Stage& stage, int max_iterations, double tolerance, State& state,
             const Progress& progress, const std::string& stage_name) {
  const CarvedStates grooves(data.model);
  PhotosAtOnce photos;
  photos.at_once = photos_at_once(data.model);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &photos;
  ceres::Problem problem(problem_options);
  const std::set<std::size_t> lights = add_residuals(data, grooves, state, photos, problem);
  const std::vector<Bounded> bounded = hold_and_bound(data, stage, lights, state, problem);
  for (const PhotoCost* photo : photos.photos) {
    FreeUnknowns& free = photos.free.emplace_back();
    for (std::size_t b = 0; b < kBlocks.size(); ++b)
      for (int i = 0; i < kBlocks[b].row->size; ++i)
        free[kBlocks[b].first + i] = !problem.IsParameterBlockConstant(photo->blocks()[b]);
  }

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.function_tolerance = tolerance;
  options.parameter_tolerance = 1e-7;
  options.initial_trust_region_radius = 1e5;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;  // sums in one order: the same bits in every run
  // Bounds require a line search for each step: by costs alone, since a cubic would need all derivatives again.
  options.line_search_interpolation_type = ceres::QUADRATIC;
  struct Report : ceres::IterationCallback {
    const Progress& progress;
    std::string stage;
    int iterations, done = 0;
    Report(const Progress& p, std::string s, int n) : progress(p), stage(std::move(s)), iterations(n) {}
    ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
      if (progress) progress(stage, std::min(1.0, static_cast<double>(done + summary.iteration) / iterations));
      return ceres::SOLVER_CONTINUE;
    }
  } report(progress, stage_name, max_iterations);
  options.callbacks.push_back(&report);
  // Ceres projects a step onto the bounds and searches along it for a lower cost. The search ends where the other
  // unknowns compensate for the projected one: 1.5 % above the minimum with ambient light pushed below 0. Unknowns
  // pushed beyond a bound are therefore held there, until they no longer are.
  ceres::Solver::Summary summary;
  constexpr int kMostRounds = 4;
  std::set<double*> held = pushed_out(bounded, problem);
  for (int round = 1;; ++round) {
    for (double* const value : held) problem.SetParameterBlockConstant(value);
    options.max_num_iterations = max_iterations - report.done;
    ceres::Solve(options, &problem, &summary);
    report.done += std::max(0, static_cast<int>(summary.iterations.size()) - 1);
    for (double* const value : held) problem.SetParameterBlockVariable(value);
    if (round == kMostRounds || report.done >= max_iterations) break;
    std::set<double*> pushed = pushed_out(bounded, problem);
    if (pushed == held) break;
    held = std::move(pushed);
  }
  return summary.final_cost;
}

}  // namespace burin
