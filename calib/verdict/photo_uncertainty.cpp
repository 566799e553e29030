#include "burin/calib/verdict/photo_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "burin/base/median.h"
#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/board_tiles.h"
#include "burin/calib/photo/normal_system.h"
#include "burin/calib/verdict/model_tests.h"

namespace burin {
namespace {

// Shifts of the estimates under another assumption: the unknowns, and cameras, bow and lens with them.
struct Shifts {
  std::vector<Eigen::VectorXd> unknowns, geometry;
};

// The problem's own model, a model with a more tolerant loss, and models whose groove-to-groove variation is larger by
// one sigma.
std::vector<ModelData> models_as_good(const Problem& data) {
  // Influence of the loss: residuals from dust and model errors are skewed, and a tolerant loss shifts the estimates.
  // One step towards the optimum of another scale measures the shift.
  std::vector<ModelData> models{data.model, data.model};
  models.back().cauchy *= 2;
  // Influence of the assumed groove-to-groove variation, which determines the mean light of uneven grooves.
  for (const auto& [jitter, sigma2] : {std::pair(&ModelData::alpha_jitter, data.model.alpha_jitter2_sigma),
                                       std::pair(&ModelData::depth_jitter, data.model.depth_jitter2_sigma)}) {
    if (!(sigma2 > 0)) continue;
    models.push_back(data.model);
    models.back().*jitter = std::sqrt(std::pow(data.model.*jitter, 2) + sigma2);
  }
  return models;
}

Shifts shifts_of(const Problem& data, const Stage& stage, const State& state, const NormalSystem& system,
                 const Eigen::MatrixXd& inverse, const std::vector<std::vector<PhotoEquations>>& equations) {
  Shifts out;
  const auto add = [&](const NormalSystem& by, const Eigen::MatrixXd& by_inverse, const Eigen::VectorXd& g,
                       const Eigen::VectorXd& geometry_g) {
    out.unknowns.emplace_back(-by_inverse * g);
    if (data.geometry)
      out.geometry.emplace_back(-inverse_times(by.A, geometry_g + by.B.transpose() * out.unknowns.back()));
  };
  const auto system_of = [&](std::size_t model) {
    return normal_system(data, stage, state, Information::curvature, equations[model]);
  };
  const NormalSystem tolerant = system_of(1);
  add(tolerant, safe_inverse(tolerant.H, tolerant.free), tolerant.g, tolerant.geometry_g);
  for (std::size_t model = 2; model < equations.size(); ++model) {
    const NormalSystem uneven = system_of(model);
    add(system, inverse, uneven.g - system.g, uneven.geometry_g - system.geometry_g);
  }
  return out;
}

// Scores that count as independent, and the correction of a sum over few of them.
struct Clusters {
  Eigen::MatrixXd scores;
  double factor = 1;
};

Clusters squares_and_tags(const NormalSystem& system) {
  Clusters out;
  const auto tags = static_cast<Eigen::Index>(system.tags.size());
  out.scores = system.tiles;
  out.scores.conservativeResize(Eigen::NoChange, system.tiles.cols() + tags);
  out.scores.rightCols(tags).setZero();
  for (Eigen::Index column = system.tiles.cols(); const auto& [tag, score] : system.tags)
    out.scores.col(column++).head(system.H.rows()) = score;
  return out;
}

Eigen::MatrixXd quadrants_of(const Problem& data, const NormalSystem& system) {
  Eigen::MatrixXd quadrants = Eigen::MatrixXd::Zero(system.tiles.rows(), 4);
  const CellGrid grid = board_tiles(*data.model.board);
  for (Eigen::Index tile = 0; tile < system.tiles.cols(); ++tile) {
    const bool right = 2 * (tile % grid.columns) >= grid.columns, upper = 2 * (tile / grid.columns) >= grid.rows;
    quadrants.col((right ? 1 : 0) + (upper ? 2 : 0)) += system.tiles.col(tile);
  }
  return quadrants;
}

// Photos in groups by the tilt of their half vectors.
Eigen::MatrixXd groups_by_lean(const Problem& data, const State& state, const NormalSystem& system) {
  const std::size_t count = data.photos.size();
  const Eigen::Vector3d center(data.model.center_mm.x(), data.model.center_mm.y(), 0);
  std::vector<std::pair<double, Eigen::Index>> by_lean;
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d lamp = state.of(data.photos[k].photo.light).segment<3>(unknown::lamp_position);
    const Eigen::Vector3d h =
        ((lamp - center).normalized() + (data.photos[k].scene.camera_center_mm - center).normalized()).normalized();
    by_lean.emplace_back(h.z(), static_cast<Eigen::Index>(k));
  }
  std::sort(by_lean.begin(), by_lean.end());
  const std::size_t groups = std::min<std::size_t>(4, count / 2);
  Eigen::MatrixXd grouped = Eigen::MatrixXd::Zero(system.photos.rows(), static_cast<Eigen::Index>(groups));
  for (std::size_t k = 0; k < count && groups > 0; ++k)
    grouped.col(static_cast<Eigen::Index>(k * groups / count)) += system.photos.col(by_lean[k].second);
  return grouped;
}

// Errors of the model are correlated between neighboring places and between photos with similar half vectors. Clusters
// as small as squares of the board would treat them as many independent errors. A few large clusters do not: the
// board's quadrants, and the photos in groups.
std::vector<Clusters> clusters_of(const Problem& data, const State& state, const NormalSystem& system) {
  std::vector<Clusters> out{squares_and_tags(system)};
  for (Eigen::MatrixXd& scores :
       std::vector<Eigen::MatrixXd>{quadrants_of(data, system), groups_by_lean(data, state, system)}) {
    const auto count = static_cast<double>(scores.cols());
    if (scores.cols() >= 2) out.push_back({std::move(scores), count / (count - 1)});
  }
  return out;
}

// Sigmas of the cameras' centers, board axes. Zero for views without photos.
std::vector<Eigen::Vector3d> center_sigmas(const Problem& data, const NormalSystem& system,
                                           const Eigen::MatrixXd& inverse, double scatter,
                                           const std::vector<Clusters>& clusters,
                                           const std::vector<Eigen::VectorXd>& geometry_shifts) {
  // The shift of a center -R^T t is -R^T times the shift of t; rotations about the camera leave it unchanged. One
  // column per axis of each view; columns of views without photos stay 0.
  const Eigen::Index n = system.H.rows(), m = system.A.rows(),
                     views = static_cast<Eigen::Index>(data.geometry->T_camera_board.size());
  Eigen::MatrixXd by_geometry = Eigen::MatrixXd::Zero(m, 3 * views);
  for (const PhotoData& photo : data.photos) {
    const auto view = static_cast<Eigen::Index>(photo.photo.view);
    by_geometry.block<3, 3>(data.geometry->of_view * view + 3, 3 * view) = -photo.camera.T_camera_board.linear();
  }
  const Eigen::MatrixXd by_own = inverse_times(system.A, by_geometry), by_unknowns = system.gain * by_geometry,
                        by_scores = inverse * by_unknowns;
  const Eigen::MatrixXd by_tags = by_own + system.gain.transpose() * by_scores;
  Eigen::MatrixXd by_score(n + m, 3 * views);  // shifts of the centers per score of the unknowns and the geometry
  by_score << by_scores, -by_own;
  std::vector<Eigen::Vector3d> out(data.geometry->T_camera_board.size(), Eigen::Vector3d::Zero());
  for (Eigen::Index k = 0; k < 3 * views; ++k) {
    const double weight = data.geometry->weight;  // scores with a larger weight scatter more
    const double of_priors = weight * weight * by_tags.col(k).dot(data.geometry->information * by_tags.col(k)) +
                             by_scores.col(k).dot(system.prior.cwiseProduct(by_scores.col(k)));
    double variance = scatter * (by_geometry.col(k).dot(by_own.col(k)) + by_unknowns.col(k).dot(by_scores.col(k)));
    for (const Clusters& c : clusters)
      variance = std::max(variance, c.factor * (by_score.col(k).transpose() * c.scores).squaredNorm() + of_priors);
    for (const Eigen::VectorXd& shift : geometry_shifts) variance += std::pow(by_geometry.col(k).dot(shift), 2);
    out[k / 3][k % 3] = std::sqrt(variance);
  }
  return out;
}

// Shifts of the estimates without each view, in the order of H_view.
std::vector<Eigen::VectorXd> shifts_without_views(const NormalSystem& system) {
  std::vector<Eigen::VectorXd> out;
  for (const auto& [view, H] : system.H_view)
    out.emplace_back(safe_inverse(system.H - H, system.free) * system.g_view.at(view));
  return out;
}

// Jackknife: deletes one view at a time.
Eigen::MatrixXd jackknife_of(const std::vector<Eigen::VectorXd>& shifts) {
  const Eigen::Index n = shifts.front().size();
  const auto views = static_cast<double>(shifts.size());
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
  for (const Eigen::VectorXd& s : shifts) mean += s / views;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::VectorXd& s : shifts) out += (s - mean) * (s - mean).transpose();
  return out * (views - 1) / views;
}

// Several tests detect one contradiction in several ways: together they count once.
void add_misfits(std::vector<ModelTest> tests, Uncertainty& out) {
  const double share = 1 / std::sqrt(static_cast<double>(std::max<std::size_t>(1, tests.size())));
  for (ModelTest& test : tests) {
    out.shifts.emplace_back(share * test.shift);
    out.misfits.push_back(std::move(test.misfit));
  }
}

// With grooves that cut each other's rims away, setups with known ground truth give slightly too shallow depths and
// slightly wrong roughnesses (docs/results/calibration.md). The constants are the RMS errors: of five setups in lanes,
// and of pieces, which leave more of the steps by which they narrow grooves.
void add_unexplained_by_rims(const ModelData& model, Uncertainty& out) {
  struct Errors {
    double depth, alpha, base_alpha;
  };
  const Errors rms = model.cut.lanes > 0 ? Errors{0.0016, 0.0007, 0.0001} : Errors{0.003, 0.001, 0.001};
  for (const auto& [unknown, by] : {std::pair(unknown::log_depth, rms.depth), std::pair(unknown::log_alpha, rms.alpha),
                                    std::pair(unknown::log_base_alpha, rms.base_alpha)})
    out.shifts.emplace_back(by * Eigen::VectorXd::Unit(out.covariances.front().rows(), unknown));
}

// The streaks of a brushed face differ from each other, and each has a slightly different direction. Their scatter is
// part of its roughness. On two setups with known ground truth, the roughness was too high by this RMS error.
void add_unexplained_by_streaks(Uncertainty& out) {
  constexpr double kRoughness = 0.001;
  out.shifts.emplace_back(kRoughness * Eigen::VectorXd::Unit(out.covariances.front().rows(), unknown::log_base_alpha));
}

// Unmodeled light has the effect of rotated half vectors: a fraction m of it, on a lobe of width alpha, rotates them by
// m alpha. Pixels with a common error would have to be far more numerous to determine a lamp's direction better. In 26
// setups with departures, the two whose lamps were wrong by more than four sigmas had one sigma at a third of this
// value.
void add_unexplained_light(const Problem& data, const State& state, Uncertainty& out) {
  if (data.photo_model_error.empty()) return;
  constexpr double kTimes = 1.5;
  const double turn = kTimes * median_of(data.photo_model_error) * std::exp(state.shared[unknown::log_alpha]);
  const Eigen::Vector3d middle_mm(data.model.center_mm.x(), data.model.center_mm.y(), 0);
  for (std::size_t light = 0; light < state.lamps.size(); ++light) {
    const Eigen::Vector3d to_lamp_mm = Eigen::Vector3d::Map(state.block(unknown::lamp_position, light)) - middle_mm;
    const Eigen::Vector3d aside = to_lamp_mm.unitOrthogonal();
    for (const Eigen::Vector3d& way : {aside, Eigen::Vector3d(to_lamp_mm.normalized().cross(aside))}) {
      Eigen::VectorXd& shift = out.shifts.emplace_back(Eigen::VectorXd::Zero(out.covariances.front().rows()));
      for (int k = 0; k < 3; ++k)
        if (const int at = global_index(unknown::lamp_position + k, light); out.free[static_cast<std::size_t>(at)])
          shift[at] = turn * to_lamp_mm.norm() * way[k];
    }
  }
}

}  // namespace

Uncertainty uncertainty_of(const Problem& data, const Stage& stage, const State& state) {
  std::vector<ClassSums> classes(data.photos.size());
  const BinEdges edges = bin_edges(data, state);
  const std::vector<std::vector<PhotoEquations>> equations = equations_of_photos(
      data, stage, state, models_as_good(data),
      [&](std::size_t k, const PhotoSlopes& slopes) { classes[k] = class_sums(data, k, state, slopes, edges); });
  const NormalSystem system = normal_system(data, stage, state, Information::curvature, equations.front());
  const Eigen::MatrixXd inverse = safe_inverse(system.H, system.free);
  Uncertainty out;
  out.free = system.free;
  Shifts shifts = shifts_of(data, stage, state, system, inverse, equations);
  out.shifts = std::move(shifts.unknowns);
  out.noise_bound = safe_inverse(system.noise_H, system.free);

  const double scatter = system.pixels ? std::max(1.0, 2 * system.cost / static_cast<double>(system.pixels)) : 1;
  out.covariances.push_back(scatter * inverse);
  Eigen::MatrixXd priors = system.geometry_scatter;  // the priors' own scatter
  priors.diagonal() += system.prior;
  const Eigen::MatrixXd by_priors = inverse * priors * inverse;
  const std::vector<Clusters> clusters = clusters_of(data, state, system);
  for (const Clusters& c : clusters) {
    const Eigen::MatrixXd by_cluster = inverse * c.scores.topRows(system.H.rows());
    out.covariances.emplace_back(c.factor * by_cluster * by_cluster.transpose() + by_priors);
  }
  if (data.geometry) out.center_sigma_mm = center_sigmas(data, system, inverse, scatter, clusters, shifts.geometry);
  constexpr std::size_t kFewestViews = 3;
  out.part_shift = shifts_without_views(system);
  if (out.part_shift.size() >= kFewestViews) out.covariances.push_back(jackknife_of(out.part_shift));

  add_misfits(test_model(data, state, system.free, classes), out);
  if (data.model.crossings == Crossings::deepest) add_unexplained_by_rims(data.model, out);
  if (stage.frees(Group::grain)) add_unexplained_by_streaks(out);
  add_unexplained_light(data, state, out);

  for (const auto& [view, H] : system.H_view) {
    std::size_t first = 0;
    while (data.photos[first].photo.view != view) ++first;
    out.part_photo.push_back(first);
    out.part_information.push_back(H);
    out.part_gradient.push_back(system.g_view.at(view));
  }
  out.prior_information = system.prior;
  out.prior_gradient = system.prior_g;
  return out;
}

}  // namespace burin
