#include "calib/photo_uncertainty.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "calib/paper_equation.h"

namespace burin {
namespace {

constexpr double kTileMm = 20;

// The normal equations of everything at one state, cameras and bow ("geometry") eliminated.
struct NormalSystem {
  std::vector<bool> free;
  Eigen::MatrixXd H, noise_H;  // of all; with the camera's noise alone as weights, poses known
  Eigen::VectorXd g;
  Eigen::VectorXd prior;                // diagonal of the priors' information
  Eigen::MatrixXd geometry_scatter;     // of the scores, from the tags' noise in the geometry's prior
  Eigen::MatrixXd tiles;                // scores by square of the board
  std::vector<Eigen::VectorXd> photos;  // scores by photo
  std::map<int, Eigen::VectorXd> tags;  // scores by tag (paper)
  std::map<std::size_t, Eigen::MatrixXd> H_view;
  std::map<std::size_t, Eigen::VectorXd> g_view;
  Eigen::MatrixXd A, B, gain;  // (geometry, geometry), (unknowns, geometry), B A^-1
  Eigen::VectorXd geometry_g;
  double cost = 0;
  std::size_t pixels = 0;
};

// What stands in H for the robust loss: Gauss and Newton's weights, which lead to the optimum, or the loss' own
// curvature there, which says how far scores move the optimum. That is less by a fifth for normal errors, by a half
// where errors have long tails, as those of grooves near their cut-off have.
enum class Information { weights, curvature };

// What normal_system() differentiates by: all that the stage frees, and poses and bow where they may move.
FreeUnknowns wanted_of(const Problem& data, const Stage& stage) {
  FreeUnknowns wanted{};
  for (const Block& block : kBlocks)
    for (int i = 0; i < block.size; ++i)
      wanted[block.first + i] = block.first >= unknown::pose   ? data.geometry.has_value()
                                : block.first == unknown::spot ? stage.lamp
                                                               : frees(stage, block.first);
  return wanted;
}

// Every photo's equations under each of some models, which differ in their loss and in how much grooves differ, the
// problem's own first: [model][photo]. Slopes, which take the time, are rendered once.
std::vector<std::vector<PhotoEquations>> equations_of_photos(const Problem& data, const Stage& stage,
                                                             const State& state, const std::vector<ModelData>& models) {
  const FreeUnknowns wanted = wanted_of(data, stage);
  const Scratches carved = carved_scratches(data.model, state.of(0));
  std::vector<std::vector<PhotoEquations>> out(models.size(), std::vector<PhotoEquations>(data.photos.size()));
  each_photo(data.photos.size(), [&](std::size_t k) {
    const PhotoData& photo = data.photos[k];
    const Unknowns x = state.of(photo.photo.light);
    const PhotoSlopes slopes = photo_slopes(data.model, photo, x, carved, wanted);
    for (std::size_t m = 0; m < models.size(); ++m) {
      const ModelData& model = models[m];
      if (model.alpha_jitter == data.model.alpha_jitter && model.depth_jitter == data.model.depth_jitter) {
        out[m][k] = photo_equations(model, photo, x, slopes.light, slopes, kTileMm);
      } else {
        PhotoData shifted = photo;
        shift_by_grooves(model, x, carved, shifted);
        out[m][k] = photo_equations(model, shifted, x, slopes.light, slopes, kTileMm);
      }
    }
  });
  return out;
}

NormalSystem normal_system(const Problem& data, const Stage& stage, State& state, Information information,
                           const std::vector<PhotoEquations>& equations) {
  const std::size_t lights = state.lamps.size();
  const Eigen::Index n = kSharedUnknowns + 1 + static_cast<Eigen::Index>(lights) * kLampUnknowns;
  const bool free_geometry = data.geometry.has_value();
  const Eigen::Index m = free_geometry ? data.geometry->information.rows() : 0, at_bow = m - 3;
  NormalSystem out;
  out.free.assign(n, false);
  out.free[kSharedUnknowns] = true;
  const FreeUnknowns wanted = wanted_of(data, stage);
  for (int i = 0; i < unknown::pose; ++i)
    for (std::size_t light = 0; light < lights; ++light)
      if (wanted[i] && (i < unknown::spot || data.is_spot[light])) out.free[global_index(i, light)] = true;

  // Each photo's equations over (unknowns, geometry), in their places of the whole.
  constexpr int kInner = unknown::pose;
  const auto place = [&](const PhotoData& photo, int index) -> Eigen::Index {
    if (index < kInner) return global_index(index, photo.photo.light);
    if (index < unknown::bow) return n + 6 * static_cast<Eigen::Index>(photo.photo.view) + (index - unknown::pose);
    return n + at_bow + (index - unknown::bow);
  };
  const int count = free_geometry ? static_cast<int>(unknown::count) : kInner;
  out.noise_H = Eigen::MatrixXd::Zero(n, n);
  std::map<std::size_t, Eigen::MatrixXd> F_view;  // over (unknowns, geometry)
  std::vector<Eigen::VectorXd> f_photo;
  Eigen::MatrixXd tiles;
  Eigen::MatrixXd F = Eigen::MatrixXd::Zero(n + m, n + m);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(n + m);
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    const PhotoData& photo = data.photos[k];
    const PhotoEquations& e = equations[k];
    Eigen::MatrixXd& Fv = F_view.try_emplace(photo.photo.view, Eigen::MatrixXd::Zero(n + m, n + m)).first->second;
    Eigen::VectorXd fk = Eigen::VectorXd::Zero(n + m);
    if (tiles.size() == 0) tiles = Eigen::MatrixXd::Zero(n + m, e.tile_scores.cols());
    for (int a = 0; a < count; ++a) {
      const Eigen::Index pa = place(photo, a);
      fk[pa] += e.Jtr[a];
      tiles.row(pa) += e.tile_scores.row(a);
      for (int b = 0; b < count; ++b) {
        const Eigen::Index pb = place(photo, b);
        Fv(pa, pb) += information == Information::curvature ? e.curvature_JtJ(a, b) : e.JtJ(a, b);
        if (pa < n && pb < n) out.noise_H(pa, pb) += e.noise_JtJ(a, b);
      }
    }
    f += fk;
    f_photo.push_back(std::move(fk));
    out.cost += e.cost;
    for (const float w : photo.weight) out.pixels += w > 0;
  }
  for (const auto& [view, Fv] : F_view) F += Fv;
  Eigen::MatrixXd eliminate = Eigen::MatrixXd::Zero(n, n + m);  // (I, -B A^-1)
  eliminate.leftCols(n).setIdentity();
  out.geometry_scatter = Eigen::MatrixXd::Zero(n, n);
  if (free_geometry) {
    const GeometryPrior& prior = *data.geometry;
    Eigen::VectorXd off = Eigen::VectorXd::Zero(m);
    for (const PhotoData& photo : data.photos) {
      const std::size_t view = photo.photo.view;
      off.segment<6>(6 * static_cast<Eigen::Index>(view)) =
          pose_difference(prior.T_camera_board[view], photo.camera.T_camera_board);
      off.tail<3>() = photo.camera.surface.bow_mm - prior.bow_mm;
    }
    out.A = F.bottomRightCorner(m, m) + prior.information;
    out.B = F.topRightCorner(n, m);
    out.geometry_g = f.tail(m) + prior.information * off;
    const Eigen::VectorXd scale = out.A.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd inner = scale.asDiagonal() * out.A * scale.asDiagonal();
    out.gain = (scale.asDiagonal() * inner.ldlt().solve(scale.asDiagonal() * out.B.transpose())).transpose();
    eliminate.rightCols(m) = -out.gain;
    out.geometry_scatter = out.gain * prior.information * out.gain.transpose();
    f.tail(m) = out.geometry_g;
  }
  for (const auto& [view, Fv] : F_view) {
    out.H_view[view] = eliminate * Fv * eliminate.transpose();
    out.g_view[view] = Eigen::VectorXd::Zero(n);
  }
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    out.photos.emplace_back(eliminate * f_photo[k]);
    out.g_view[data.photos[k].photo.view] += out.photos.back();
  }
  out.tiles = eliminate * tiles;
  out.g = eliminate * f;
  out.H = out.geometry_scatter;

  // Paper belongs to the photo it was seen in; a tag's albedo is its own in all photos.
  for (const LightSample& sample : data.paper) {
    const auto [r, row] = paper_equation(data, state, sample, out.free);
    const double s = r * r / (kPaperLoss * kPaperLoss), weight = 1 / (1 + s);
    const double counted = information == Information::curvature ? std::max(0.0, 1 - s) * weight * weight : weight;
    const Eigen::MatrixXd outer = counted * row * row.transpose();
    const std::size_t view = data.photos[sample.light_view].photo.view;
    out.noise_H += weight * row * row.transpose();
    out.H_view[view] += outer;
    out.g_view[view] += weight * r * row;
    out.photos[sample.light_view] += weight * r * row;
    out.g += weight * r * row;
    auto [at, fresh] = out.tags.try_emplace(sample.tag, Eigen::VectorXd::Zero(n));
    at->second += weight * r * row;
  }
  out.prior = Eigen::VectorXd::Zero(n);
  out.prior[kSharedUnknowns] = 1 / (kPaperFactorSigma * kPaperFactorSigma);
  for (int i = 0; i < 3; ++i)
    if (out.free[unknown::vignette + i]) out.prior[unknown::vignette + i] = 1 / std::pow(kVignettePriorSigma[i], 2);
  for (const auto& [view, Hv] : out.H_view) out.H += Hv;
  out.H.diagonal() += out.prior;
  out.noise_H.diagonal() += out.prior;
  for (int i = 0; i < 3; ++i)
    out.g[unknown::vignette + i] += out.prior[unknown::vignette + i] * state.shared[unknown::vignette + i];
  out.g[kSharedUnknowns] += out.prior[kSharedUnknowns] * state.log_paper[0];
  return out;
}

NormalSystem weighted_system(const Problem& data, const Stage& stage, State& state) {
  return normal_system(data, stage, state, Information::weights,
                       equations_of_photos(data, stage, state, {data.model}).front());
}

}  // namespace

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

ViewEquations view_equations(const Problem& data, const Stage& stage, State& state) {
  const NormalSystem system = weighted_system(data, stage, state);
  ViewEquations out;
  out.free = system.free;
  out.prior = system.prior;
  out.prior_g = system.g;
  out.cost = system.cost;
  for (const auto& [view, H] : system.H_view) {
    out.view.push_back(view);
    out.H.push_back(H);
    out.g.push_back(system.g_view.at(view));
    out.prior_g -= out.g.back();
  }
  out.tiles = system.tiles;
  out.prior_scatter = system.geometry_scatter;
  out.prior_scatter.diagonal() += system.prior;
  return out;
}

void joint_step(const Problem& data, const Stage& stage, State& state, Bench& bench) {
  const NormalSystem system = weighted_system(data, stage, state);
  const Eigen::VectorXd step = -safe_inverse(system.H, system.free) * system.g;
  state = moved_state(state, step);
  const auto [least_blur, most_blur] = log_blur_range(data);
  state.shared[unknown::log_blur] = std::clamp(state.shared[unknown::log_blur], least_blur, most_blur);
  if (!data.geometry) return;
  const Eigen::VectorXd scale = system.A.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inner = scale.asDiagonal() * system.A * scale.asDiagonal();
  const Eigen::VectorXd by =
      -scale.cwiseProduct(inner.ldlt().solve(scale.cwiseProduct(system.geometry_g + system.B.transpose() * step)));
  for (const PhotoData& photo : data.photos) {
    const std::size_t view = photo.photo.view;
    bench.views[view].T_camera_board =
        moved_pose(photo.camera.T_camera_board, by.segment<6>(6 * static_cast<Eigen::Index>(view)));
  }
  bench.bow_mm += by.tail<3>();
}

Uncertainty uncertainty_of(const Problem& data, const Stage& stage, State& state) {
  // What the answer owes to the loss: residuals of dust and of the model's own errors are skewed, and a loss that
  // forgives them moves the answer. One step towards the optimum of another scale shows by how much.
  std::vector<ModelData> models{data.model, data.model};
  models.back().cauchy *= 2;
  // And what it owes to how much grooves are believed to differ: that sets the mean light of uneven ones.
  for (const auto& [jitter, sigma2] : {std::pair(&ModelData::alpha_jitter, data.model.alpha_jitter2_sigma),
                                       std::pair(&ModelData::depth_jitter, data.model.depth_jitter2_sigma)}) {
    if (!(sigma2 > 0)) continue;
    models.push_back(data.model);
    models.back().*jitter = std::sqrt(std::pow(data.model.*jitter, 2) + sigma2);
  }
  const std::vector<std::vector<PhotoEquations>> equations = equations_of_photos(data, stage, state, models);
  const auto system_of = [&](std::size_t model) {
    return normal_system(data, stage, state, Information::curvature, equations[model]);
  };
  const NormalSystem system = system_of(0), tolerant = system_of(1);
  const Eigen::Index n = system.H.rows();
  const Eigen::MatrixXd inverse = safe_inverse(system.H, system.free);
  Uncertainty out;
  out.shifts.emplace_back(safe_inverse(tolerant.H, tolerant.free) * tolerant.g);
  for (std::size_t model = 2; model < models.size(); ++model)
    out.shifts.emplace_back(inverse * (system_of(model).g - system.g));
  out.noise_bound = safe_inverse(system.noise_H, system.free);
  const double scatter = system.pixels ? std::max(1.0, 2 * system.cost / static_cast<double>(system.pixels)) : 1;
  out.covariances.push_back(scatter * inverse);

  Eigen::MatrixXd priors = system.geometry_scatter;  // the priors' own scatter
  priors.diagonal() += system.prior;
  Eigen::MatrixXd meat = system.tiles * system.tiles.transpose() + priors;
  for (const auto& [tag, score] : system.tags) meat += score * score.transpose();
  out.covariances.push_back(inverse * meat * inverse);

  // Errors of the model itself are alike in neighbouring places and in photos with like half vectors, so clusters that
  // small would take them for many independent ones. Few large clusters do not: the board's quadrants, and the photos
  // in groups along the lean of their half vectors.
  const auto add_clusters = [&](const std::vector<Eigen::VectorXd>& scores) {
    const auto clusters = static_cast<double>(scores.size());
    if (scores.size() < 2) return;
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
    for (const Eigen::VectorXd& score : scores) sum += score * score.transpose();
    out.covariances.push_back(inverse * (clusters / (clusters - 1) * sum + priors) * inverse);
  };
  std::vector<Eigen::VectorXd> quadrants(4, Eigen::VectorXd::Zero(n));
  const auto tile_columns = static_cast<Eigen::Index>(std::ceil(data.model.board->size_mm.x() / kTileMm));
  const Eigen::Index tile_rows = system.tiles.cols() / tile_columns;
  for (Eigen::Index tile = 0; tile < system.tiles.cols(); ++tile) {
    const bool right = 2 * (tile % tile_columns) >= tile_columns, upper = 2 * (tile / tile_columns) >= tile_rows;
    quadrants[(right ? 1 : 0) + (upper ? 2 : 0)] += system.tiles.col(tile);
  }
  add_clusters(quadrants);

  const std::size_t count = system.photos.size();
  std::vector<std::pair<double, std::size_t>> by_lean;
  for (std::size_t k = 0; k < count; ++k) {
    const Unknowns x = state.of(data.photos[k].photo.light);
    const Eigen::Vector3d center(data.model.center_mm.x(), data.model.center_mm.y(), 0);
    const Eigen::Vector3d lamp = x.segment<3>(unknown::lamp_position);
    const Eigen::Vector3d h =
        ((lamp - center).normalized() + (data.photos[k].scene.camera_center_mm - center).normalized()).normalized();
    by_lean.emplace_back(h.z(), k);
  }
  std::sort(by_lean.begin(), by_lean.end());
  const std::size_t groups = std::min<std::size_t>(4, count / 2);
  std::vector<Eigen::VectorXd> grouped(groups, Eigen::VectorXd::Zero(n));
  for (std::size_t k = 0; k < count && groups > 0; ++k) grouped[k * groups / count] += system.photos[by_lean[k].second];
  add_clusters(grouped);

  const auto views = static_cast<double>(system.H_view.size());
  if (views >= 3) {
    std::vector<Eigen::VectorXd> shifts;
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
    for (const auto& [view, H] : system.H_view) {
      shifts.push_back(safe_inverse(system.H - H, system.free) * system.g_view.at(view));
      mean += shifts.back() / views;
    }
    Eigen::MatrixXd jackknife = Eigen::MatrixXd::Zero(n, n);
    for (const Eigen::VectorXd& s : shifts) jackknife += (s - mean) * (s - mean).transpose();
    out.covariances.push_back(jackknife * (views - 1) / views);
  }

  out.free = system.free;
  for (const auto& [view, H] : system.H_view) {
    std::size_t first = 0;
    while (data.photos[first].photo.view != view) ++first;
    out.part_photo.push_back(first);
    out.part_information.push_back(H);
    out.part_gradient.push_back(system.g_view.at(view));
  }
  out.prior_information = system.prior;
  out.prior_gradient = Eigen::VectorXd::Zero(n);
  out.prior_gradient[kSharedUnknowns] = system.prior[kSharedUnknowns] * state.log_paper[0];
  for (int i = unknown::vignette; i < unknown::vignette + 3; ++i)
    out.prior_gradient[i] = system.prior[i] * state.shared[i];
  return out;
}

}  // namespace burin
