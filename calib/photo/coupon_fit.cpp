#include "burin/calib/photo/coupon_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/carved_states.h"
#include "burin/calib/photo/cauchy_loss.h"
#include "burin/calib/photo/machine_map.h"
#include "burin/calib/photo/normal_system.h"
#include "burin/calib/photo/paper_equation.h"

namespace burin {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kAcrossPrior = 0.05;
constexpr double kTravelPrior = 0.3;  // of a tool with little dependence on the direction of travel
constexpr int kSectors = 12;          // of a fan, over each of which scores are summed

Vector2d travel_of(const Scratches& s, std::size_t i) {
  return Vector2d(s.x1_mm[i] - s.x0_mm[i], s.y1_mm[i] - s.y0_mm[i]).normalized();
}

constexpr int kTrends = 4;  // travel, across

// Factors of a scratch's log depth by travel (2) and across (2).
Eigen::Vector4d trends_of(const Scratches& s, std::size_t i, const CouponFan& fan) {
  const Vector2d middle(0.5 * (s.x0_mm[i] + s.x1_mm[i]), 0.5 * (s.y0_mm[i] + s.y1_mm[i]));
  Eigen::Vector4d out;
  out << travel_of(s, i), (middle - fan.center_mm) / fan.radius_mm;
  return out;
}

// Index of each scratch's fan; -1: none.
std::vector<int> fan_of_rows(const Coupon& coupon, std::size_t rows) {
  std::vector<int> fan(rows, -1);
  for (std::size_t f = 0; f < coupon.fans.size(); ++f)
    for (std::size_t i = 0; i < coupon.fans[f].rows; ++i) fan[coupon.fans[f].first_row + i] = static_cast<int>(f);
  return fan;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

// Each photo's prediction with the carved scratches.
Image value_of(const FanProblem& problem, std::size_t k, const State& state, const Carved& carved) {
  const PhotoData& photo = problem.data.photos[k];
  return predict(problem.data.model, photo, state.of(photo.photo.light), carved);
}

Carved carved_of(FanProblem& problem, Sent& sent, const State& state, const FanValues& values) {
  sent = scratches_of(problem.told, *problem.coupon, values);
  problem.data.model.sent = &sent;
  return carved_pieces(problem.data.model, state.of(0));
}

// Half the robust sum over a photo's pixels, by fan; the last entry: pixels of no fan.
void add_costs(const FanProblem& problem, std::size_t k, const Image& value, std::vector<double>& costs) {
  const PhotoData& photo = problem.data.photos[k];
  for (std::size_t i = 0; i < value.data.size(); ++i) {
    if (!(photo.weight[i] > 0)) continue;
    const double r = photo.weight[i] * (value.data[i] - photo.photo.value.data[i]);
    const int fan = problem.fan_of_pixel[k][i];
    costs[fan < 0 ? costs.size() - 1 : static_cast<std::size_t>(fan)] +=
        0.5 * cauchy_loss(r * r, problem.data.model.cauchy).rho;
  }
}

double prior_cost(const FanProblem& problem, const FanValues& values) {
  double cost = 0.5 * values.travel.squaredNorm() / (kTravelPrior * kTravelPrior) +
                0.5 * values.across.squaredNorm() / (kAcrossPrior * kAcrossPrior);
  for (std::size_t f = 0; f < values.log_depth.size(); ++f)
    cost += 0.5 * std::pow((values.log_depth[f] - problem.prior.log_depth[f]) / kFanDepthPrior, 2) +
            0.5 * std::pow((values.log_alpha[f] - problem.prior.log_alpha[f]) / kFanAlphaPrior, 2);
  return cost;
}

// Cost of paper and of the table's priors.
double other_cost(const Problem& data, const State& state, const std::vector<bool>& free) {
  double cost = 0;
  for (const LightSample& sample : data.paper) {
    const double r = paper_equation(data, state, sample, free).residual;
    cost += 0.5 * kPaperLoss * kPaperLoss * std::log1p(r * r / (kPaperLoss * kPaperLoss));
  }
  for_each_unknown([&](const UnknownRow& row, int first) {
    if (!(row.prior_sigma[0] > 0)) return;
    for (int i = 0; i < row.size; ++i) cost += 0.5 * std::pow(state.block(first)[i] / row.prior_sigma[i], 2);
  });
  return cost;
}

double total_cost(FanProblem& problem, const State& state, const FanValues& values, const std::vector<bool>& free) {
  Sent sent;
  const Carved carved = carved_of(problem, sent, state, values);
  std::vector<std::vector<double>> costs(problem.data.photos.size(),
                                         std::vector<double>(problem.coupon->fans.size() + 1, 0));
  each_photo(costs.size(), photos_at_once(problem.data.model),
             [&](std::size_t k) { add_costs(problem, k, value_of(problem, k, state, carved), costs[k]); });
  double cost = prior_cost(problem, values) + other_cost(problem.data, state, free);
  for (const std::vector<double>& of_photo : costs)
    for (const double c : of_photo) cost += c;
  return cost;
}

// All unknowns of the fit in one vector: the fans', the shared and the lamps', and then cameras, bow and lens.
struct FanLayout {
  Index fans = 0, own = 0, global = 0, geometry = 0, lens = 0;

  FanLayout(const FanProblem& problem, const State& state, bool with_geometry)
      : fans(static_cast<Index>(problem.coupon->fans.size())),
        own(2 * fans + kTrends),
        global(global_count(state.lamps.size())) {
    if (!with_geometry || !problem.data.geometry) return;
    geometry = problem.data.geometry->information.rows();
    lens = problem.data.geometry->lens_parameters;
  }
  Index size() const { return own + global + geometry; }
  Index place(const PhotoData& photo, int index) const {
    if (index < unknown::pose) return own + global_index(index, photo.photo.light);
    const Index first = own + global;
    if (index < unknown::bow) return first + 6 * static_cast<Index>(photo.photo.view) + (index - unknown::pose);
    if (index < unknown::lens) return first + geometry - lens - 3 + (index - unknown::bow);
    return first + geometry - lens + (index - unknown::lens);
  }
};

// The normal equations of everything, and scores summed over sectors of fans.
struct FanEquations {
  MatrixXd H, curvature, clusters;
  VectorXd g;

  FanEquations(Index n, Index cluster_count)
      : H(MatrixXd::Zero(n, n)),
        curvature(MatrixXd::Zero(n, n)),
        clusters(MatrixXd::Zero(n, cluster_count)),
        g(VectorXd::Zero(n)) {}
};

// A photo's derivatives by the shared trends of the fans.
std::array<Image, kTrends> trend_slopes(const FanProblem& problem, std::size_t k, const State& state,
                                        const Carved& carved, const Image& value) {
  constexpr double kStep = 0.02;
  const std::vector<int> fan_of = fan_of_rows(*problem.coupon, carved.size());
  std::array<Image, kTrends> out;
  for (int trend = 0; trend < kTrends; ++trend) {
    Carved moved = carved;
    for (std::size_t i = 0; i < moved.size(); ++i)
      if (fan_of[i] >= 0)
        moved.scratches.depth_um[i] *= std::exp(
            kStep * trends_of(problem.told, i, problem.coupon->fans[static_cast<std::size_t>(fan_of[i])])[trend]);
    Image& slope = out[static_cast<std::size_t>(trend)];
    slope = value_of(problem, k, state, moved);
    for (std::size_t i = 0; i < slope.data.size(); ++i)
      slope.data[i] = (slope.data[i] - value.data[i]) / static_cast<float>(kStep);
  }
  return out;
}

int sector_of(const Vector2d& from_center) {
  const double share = (std::atan2(from_center.y(), from_center.x()) + std::numbers::pi) / (2 * std::numbers::pi);
  return std::clamp(static_cast<int>(share * kSectors), 0, kSectors - 1);
}

FreeUnknowns wanted_of(const Stage& stage, const FanLayout& layout) {
  FreeUnknowns wanted{};
  for_each_unknown([&](const UnknownRow& row, int first) {
    if (row.scope == Scope::paper || row.group == Group::groove || row.group == Group::depth) return;
    const bool free = row.scope == Scope::geometry ? layout.geometry > 0 : stage.frees(row.group);
    const int count = first == unknown::lens ? static_cast<int>(layout.lens) : row.size;
    std::fill_n(wanted.begin() + first, free ? count : 0, true);
  });
  return wanted;
}

// Adds one photo. Its row of derivatives is short: by the pixel's own fan, by travel, and by the photo's other
// unknowns.
void add_photo(const FanProblem& problem, std::size_t k, const State& state, const Carved& carved,
               const CarvedStates& grooves, const Stage& stage, const FanLayout& layout, FanEquations& out) {
  const ModelData& model = problem.data.model;
  const PhotoData& photo = problem.data.photos[k];
  const Unknowns x = state.of(photo.photo.light);
  const GrooveSlopes own = predict_with_slopes(model, photo, x, carved);
  const std::array<Image, kTrends> trends = trend_slopes(problem, k, state, carved, own.value);
  const FreeUnknowns wanted = wanted_of(stage, layout);
  const PhotoSlopes slopes = photo_slopes(model, photo, x, carved, grooves, wanted);
  std::vector<Index> at{0, 0};  // own depth and alpha first: set for each fan
  for (Index trend = 0; trend < kTrends; ++trend) at.push_back(2 * layout.fans + trend);
  for (const int index : slopes.index) at.push_back(layout.place(photo, index));
  if (wanted[unknown::ambient]) at.push_back(layout.place(photo, unknown::ambient));
  for (int v = 0; v < 3; ++v)
    if (wanted[unknown::vignette + v]) at.push_back(layout.place(photo, unknown::vignette + v));
  const auto n = static_cast<Index>(at.size());
  const MachineMap map = machine_map(x);
  // Sums of one fan (the last: of no fan): their rows and columns 0 and 1 are the fan's own.
  const std::size_t groups = problem.coupon->fans.size() + 1;
  std::vector<MatrixXd> H(groups, MatrixXd::Zero(n, n)), C = H;
  std::vector<VectorXd> g(groups, VectorXd::Zero(n));
  std::vector<std::array<VectorXd, kSectors>> scores(groups);
  for (auto& of_fan : scores) of_fan.fill(VectorXd::Zero(n));
  VectorXd row(n);
  for (std::size_t i = 0; i < own.value.data.size(); ++i) {
    if (!(photo.weight[i] > 0)) continue;
    const int fan = problem.fan_of_pixel[k][i];
    const std::size_t group = fan < 0 ? groups - 1 : static_cast<std::size_t>(fan);
    const double vignette = vignette_at(x.data() + unknown::vignette, static_cast<double>(photo.radius2[i]));
    row[0] = fan < 0 ? 0 : own.by_log_depth.data[i];
    row[1] = fan < 0 ? 0 : own.by_log_alpha.data[i];
    Index next = 2;
    for (const Image& slope : trends) row[next++] = slope.data[i];
    for (const Image& column : slopes.columns) row[next++] = vignette * column.data[i];
    if (wanted[unknown::ambient]) row[next++] = vignette * model.f0;
    double power = photo.radius2[i];
    for (int v = 0; v < 3; ++v, power *= photo.radius2[i])
      if (wanted[unknown::vignette + v]) row[next++] = power * slopes.light.data[i];
    row *= photo.weight[i];
    const double r = photo.weight[i] * (own.value.data[i] - photo.photo.value.data[i]);
    const Loss loss = cauchy_loss(r * r, model.cauchy);
    H[group].selfadjointView<Eigen::Lower>().rankUpdate(row, loss.weight);
    C[group].selfadjointView<Eigen::Lower>().rankUpdate(row, loss.curvature);
    g[group] += loss.weight * r * row;
    int sector = 0;
    if (fan >= 0) {
      const Vector2d center =
          map.A * (problem.coupon->fans[group].center_mm - model.center_mm) + model.center_mm + map.shift_mm;
      sector = sector_of(footprint_middle_mm(*photo.scene.grid, i) - center);
    }
    scores[group][static_cast<std::size_t>(sector)] += loss.weight * r * row;
  }
  for (std::size_t group = 0; group < groups; ++group) {
    const bool of_fan = group + 1 < groups;
    at[0] = of_fan ? static_cast<Index>(group) : 0;
    at[1] = of_fan ? layout.fans + static_cast<Index>(group) : 0;
    H[group].triangularView<Eigen::StrictlyUpper>() = H[group].transpose();
    C[group].triangularView<Eigen::StrictlyUpper>() = C[group].transpose();
    for (Index a = of_fan ? 0 : 2; a < n; ++a) {
      out.g[at[a]] += g[group][a];
      for (int s = 0; s < kSectors; ++s)
        out.clusters(at[a], static_cast<Index>((k * groups + group) * kSectors) + s) += scores[group][s][a];
      for (Index b = of_fan ? 0 : 2; b < n; ++b) {
        out.H(at[a], at[b]) += H[group](a, b);
        out.curvature(at[a], at[b]) += C[group](a, b);
      }
    }
  }
}

// Adds priors of fans and of the table, paper, and the tags' prior of cameras.
void add_others(const FanProblem& problem, const State& state, const FanValues& values, const std::vector<bool>& free,
                const FanLayout& layout, FanEquations& out) {
  const auto add = [&](Index at, double information, double off) {
    out.H(at, at) += information;
    out.curvature(at, at) += information;
    out.g[at] += information * off;
  };
  for (Index f = 0; f < layout.fans; ++f) {
    const auto i = static_cast<std::size_t>(f);
    add(f, std::pow(kFanDepthPrior, -2), values.log_depth[i] - problem.prior.log_depth[i]);
    add(layout.fans + f, std::pow(kFanAlphaPrior, -2), values.log_alpha[i] - problem.prior.log_alpha[i]);
  }
  for (int axis = 0; axis < 2; ++axis) {
    add(2 * layout.fans + axis, std::pow(kTravelPrior, -2), values.travel[axis]);
    add(2 * layout.fans + 2 + axis, std::pow(kAcrossPrior, -2), values.across[axis]);
  }
  for (const LightSample& sample : problem.data.paper) {
    const auto [r, row] = paper_equation(problem.data, state, sample, free);
    const double weight = 1 / (1 + r * r / (kPaperLoss * kPaperLoss));
    out.H.block(layout.own, layout.own, layout.global, layout.global) += weight * row * row.transpose();
    out.curvature.block(layout.own, layout.own, layout.global, layout.global) += weight * row * row.transpose();
    out.g.segment(layout.own, layout.global) += weight * r * row;
  }
  for_each_unknown([&](const UnknownRow& row, int first) {
    if (!(row.prior_sigma[0] > 0)) return;
    const int begin = row.scope == Scope::paper ? kPaperIndex : first;
    for (int i = 0; i < row.size; ++i) {
      const int at = begin + i;
      if (free[static_cast<std::size_t>(at)])
        add(layout.own + at, std::pow(row.prior_sigma[i], -2), state.block(first)[i]);
    }
  });
  if (layout.geometry > 0) {
    out.H.bottomRightCorner(layout.geometry, layout.geometry) += problem.data.geometry->information;
    out.curvature.bottomRightCorner(layout.geometry, layout.geometry) += problem.data.geometry->information;
  }
}

FanEquations equations_of(FanProblem& problem, const Stage& stage, const State& state, const FanValues& values,
                          const FanLayout& layout) {
  Sent sent;
  const Carved carved = carved_of(problem, sent, state, values);
  const CarvedStates grooves(problem.data.model);
  const std::size_t photos = problem.data.photos.size();
  const auto clusters = static_cast<Index>(photos * (problem.coupon->fans.size() + 1) * kSectors);
  std::vector<FanEquations> parts(photos, FanEquations(layout.size(), clusters));
  each_photo(photos, photos_at_once(problem.data.model),
             [&](std::size_t k) { add_photo(problem, k, state, carved, grooves, stage, layout, parts[k]); });
  FanEquations out(layout.size(), clusters);
  for (const FanEquations& part : parts) {
    out.H += part.H;
    out.curvature += part.curvature;
    out.clusters += part.clusters;
    out.g += part.g;
  }
  add_others(problem, state, values, free_unknowns(problem.data, stage, state.lamps.size()), layout, out);
  return out;
}

std::vector<bool> all_free(const FanProblem& problem, const Stage& stage, const State& state, const FanLayout& layout) {
  std::vector<bool> free(static_cast<std::size_t>(layout.size()), true);
  const std::vector<bool> global = free_unknowns(problem.data, stage, state.lamps.size());
  std::copy(global.begin(), global.end(), free.begin() + layout.own);
  return free;
}

// The stage without the shared depth and roughness of all fans.
Stage without_grooves(Stage stage) { return stage.hold({Group::groove, Group::depth}); }

}  // namespace

FanValues believed_fans(const Coupon& coupon, double alpha) {
  FanValues out;
  for (const CouponFan& fan : coupon.fans) {
    out.log_depth.push_back(std::log(coupon.cells[fan.cell].depth_um));
    out.log_alpha.push_back(std::log(alpha));
  }
  return out;
}

Sent scratches_of(const Scratches& told, const Coupon& coupon, const FanValues& values) {
  Scratches out = told;
  const std::vector<int> fan_of = fan_of_rows(coupon, told.size());
  const double log_depth = mean_of(values.log_depth), log_alpha = mean_of(values.log_alpha);
  out.depth_um.resize(told.size());
  out.alpha.resize(told.size());
  for (std::size_t i = 0; i < told.size(); ++i) {
    const auto fan = static_cast<std::size_t>(std::max(fan_of[i], 0));
    const bool of_fan = fan_of[i] >= 0;
    Eigen::Vector4d trends;
    trends << values.travel, values.across;
    out.depth_um[i] =
        std::exp(of_fan ? values.log_depth[fan] + trends.dot(trends_of(told, i, coupon.fans[fan])) : log_depth);
    out.alpha[i] = std::min(1.0, std::exp(of_fan ? values.log_alpha[fan] : log_alpha));
  }
  return Sent(std::move(out));
}

void find_fans(const State& state, FanProblem& problem) {
  const Coupon& coupon = *problem.coupon;
  const MachineMap map = machine_map(state.of(0));
  const Vector2d& middle = problem.data.model.center_mm;
  const auto carved = [&](const Vector2d& p) -> Vector2d { return map.A * (p - middle) + middle + map.shift_mm; };
  // The date's and number's box.
  constexpr double kMargin_mm = 0.3;
  Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  const std::vector<int> fan_of = fan_of_rows(coupon, problem.told.size());
  for (std::size_t i = 0; i < fan_of.size(); ++i) {
    if (fan_of[i] >= 0) continue;
    for (const Vector2d& p : {carved({problem.told.x0_mm[i], problem.told.y0_mm[i]}),
                              carved({problem.told.x1_mm[i], problem.told.y1_mm[i]})}) {
      low = low.cwiseMin(p.array().matrix());
      high = high.cwiseMax(p);
    }
  }
  problem.fan_of_pixel.clear();
  for (PhotoData& photo : problem.data.photos) {
    std::vector<int>& fans = problem.fan_of_pixel.emplace_back(photo.weight.size(), -1);
    for (std::size_t i = 0; i < fans.size(); ++i) {
      const Vector2d p = footprint_middle_mm(*photo.scene.grid, i);
      if (!std::isfinite(p.x())) continue;
      if ((p.array() > low.array() - kMargin_mm).all() && (p.array() < high.array() + kMargin_mm).all())
        photo.weight[i] = 0;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t f = 0; f < coupon.fans.size(); ++f) {
        const double distance = (p - carved(coupon.fans[f].center_mm)).norm();
        // Light blurred out of a fan still belongs to it.
        if (distance > coupon.fans[f].radius_mm + 4 * kMargin_mm || distance >= nearest) continue;
        nearest = distance;
        fans[i] = static_cast<int>(f);
      }
    }
  }
}

void try_fans(FanProblem& problem, const State& state, FanValues& values, const Progress& progress) {
  constexpr std::array kDepths{0.25, 0.33, 0.43, 0.56, 0.7, 0.85, 1.0, 1.2, 1.45, 1.8, 2.3, 3.0, 4.0};
  constexpr std::array kAlphas{0.5, 0.7, 1.0, 1.4, 2.0};
  const Coupon& coupon = *problem.coupon;
  std::vector<double> best(coupon.cells.size(), std::numeric_limits<double>::infinity());
  std::vector<std::pair<double, double>> chosen(coupon.cells.size(), {0, 0});
  int done = 0;
  for (const double depth : kDepths)
    for (const double alpha : kAlphas) {
      FanValues moved = values;
      for (double& v : moved.log_depth) v += std::log(depth);
      for (double& v : moved.log_alpha) v += std::log(alpha);
      Sent sent;
      const Carved carved = carved_of(problem, sent, state, moved);
      std::vector<std::vector<double>> costs(problem.data.photos.size(),
                                             std::vector<double>(coupon.fans.size() + 1, 0));
      each_photo(costs.size(), photos_at_once(problem.data.model),
                 [&](std::size_t k) { add_costs(problem, k, value_of(problem, k, state, carved), costs[k]); });
      std::vector<double> of_cell(coupon.cells.size(), 0);
      for (const std::vector<double>& of_photo : costs)
        for (std::size_t f = 0; f < coupon.fans.size(); ++f) of_cell[coupon.fans[f].cell] += of_photo[f];
      for (std::size_t c = 0; c < of_cell.size(); ++c)
        if (of_cell[c] < best[c]) best[c] = of_cell[c], chosen[c] = {std::log(depth), std::log(alpha)};
      if (progress) progress("trying depths and roughnesses", ++done / double(kDepths.size() * kAlphas.size()));
    }
  for (std::size_t f = 0; f < coupon.fans.size(); ++f) {
    values.log_depth[f] += chosen[coupon.fans[f].cell].first;
    values.log_alpha[f] += chosen[coupon.fans[f].cell].second;
  }
}

double fit_fans(FanProblem& problem, const Stage& stage, int max_iterations, State& state, FanValues& values,
                const Progress& progress) {
  const Stage held = without_grooves(stage);
  const FanLayout layout(problem, state, false);
  const std::vector<bool> free = free_unknowns(problem.data, held, state.lamps.size());
  double cost = total_cost(problem, state, values, free);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    if (progress) progress("fitting each fan", static_cast<double>(iteration) / max_iterations);
    const FanEquations e = equations_of(problem, held, state, values, layout);
    VectorXd step = -safe_inverse(e.H, all_free(problem, held, state, layout)) * e.g;
    // Poorly constrained unknowns must not diverge in one step.
    constexpr double kMostStep = 0.5;
    const double largest = step.head(layout.own).cwiseAbs().maxCoeff();
    if (largest > kMostStep) step *= kMostStep / largest;
    bool better = false;
    const double before = cost;
    for (double share = 1; share > 0.02 && !better; share *= 0.4) {
      State moved = moved_state(state, share * step.segment(layout.own, layout.global));
      FanValues at = values;
      for (Index f = 0; f < layout.fans; ++f) {
        at.log_depth[static_cast<std::size_t>(f)] += share * step[f];
        at.log_alpha[static_cast<std::size_t>(f)] = std::clamp(
            at.log_alpha[static_cast<std::size_t>(f)] + share * step[layout.fans + f], std::log(0.004), std::log(0.8));
      }
      at.travel += share * step.segment<2>(2 * layout.fans);
      at.across += share * step.segment<2>(2 * layout.fans + 2);
      keep_within_bounds(problem.data, moved);
      const double there = total_cost(problem, moved, at, free);
      if (!(there < cost)) continue;
      better = true;
      cost = there;
      state = moved;
      values = at;
    }
    if (!better || before - cost < 1e-5 * before) break;
  }
  return cost;
}

MatrixXd fan_covariance(FanProblem& problem, const Stage& stage, const State& state, const FanValues& values) {
  const Stage held = without_grooves(stage);
  const FanLayout layout(problem, state, true);
  const FanEquations e = equations_of(problem, held, state, values, layout);
  const MatrixXd inverse = safe_inverse(e.curvature, all_free(problem, held, state, layout));
  // Scores of sectors, and of all terms other than pixels.
  FanEquations others(layout.size(), 0);
  add_others(problem, state, values, free_unknowns(problem.data, held, state.lamps.size()), layout, others);
  // Scores of whole fans for the shared parameters: a fan's own errors.
  const auto groups = static_cast<Index>(problem.coupon->fans.size() + 1);
  MatrixXd of_fans = MatrixXd::Zero(layout.size(), groups);
  for (Index c = 0; c < e.clusters.cols(); ++c) of_fans.col(c / kSectors % groups) += e.clusters.col(c);
  const auto sandwich = [&](const MatrixXd& scores) {
    return MatrixXd((inverse * (scores + others.H) * inverse).topLeftCorner(layout.own, layout.own));
  };
  const MatrixXd by_sectors = sandwich(e.clusters * e.clusters.transpose()),
                 by_fans = sandwich(of_fans * of_fans.transpose());
  MatrixXd out = inverse.topLeftCorner(layout.own, layout.own);
  VectorXd grow(layout.own);
  for (Index i = 0; i < layout.own; ++i)
    grow[i] = std::sqrt(std::max({1.0, by_sectors(i, i) / out(i, i), by_fans(i, i) / out(i, i)}));
  return grow.asDiagonal() * out * grow.asDiagonal();
}

}  // namespace burin
