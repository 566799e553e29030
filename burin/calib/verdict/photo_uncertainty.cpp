#include "burin/calib/verdict/photo_uncertainty.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "burin/calib/light/paper_equation.h"

namespace burin {
namespace {

constexpr double kTileMm = 20;

// A^-1 b for a positive definite A whose unknowns have very different units.
Eigen::MatrixXd inverse_times(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd scale = A.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inner = scale.asDiagonal() * A * scale.asDiagonal();
  return scale.asDiagonal() * inner.ldlt().solve(scale.asDiagonal() * b);
}

// The normal equations of everything at one state, cameras, bow and lens ("geometry") eliminated.
struct NormalSystem {
  std::vector<bool> free;
  Eigen::MatrixXd H, noise_H;  // of all; with the camera's noise alone as weights, poses known
  Eigen::VectorXd g;
  Eigen::VectorXd prior;             // diagonal of the priors' information
  Eigen::MatrixXd geometry_scatter;  // of the scores, from the tags' noise in the geometry's prior
  // Scores by square of the board and by photo; below them the geometry's own.
  Eigen::MatrixXd tiles, photos;
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

// What normal_system() differentiates by: all that the stage frees, and poses, bow and lens where they may move.
FreeUnknowns wanted_of(const Problem& data, const Stage& stage) {
  FreeUnknowns wanted{};
  if (data.geometry)
    for (Eigen::Index i = 0; i < data.geometry->lens_parameters; ++i) wanted[unknown::lens + i] = true;
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
  const Carved carved = carved_at(data.model, state.of(0));
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
  const Eigen::Index m = free_geometry ? data.geometry->information.rows() : 0;
  const Eigen::Index lens = free_geometry ? data.geometry->lens_parameters : 0, at_lens = m - lens,
                     at_bow = at_lens - 3;
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
    if (index < unknown::lens) return n + at_bow + (index - unknown::bow);
    return n + at_lens + (index - unknown::lens);
  };
  const int count = free_geometry ? unknown::lens + static_cast<int>(lens) : kInner;
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
    Eigen::VectorXd off = prior.moved;  // of poses exactly, where a photo says
    for (const PhotoData& photo : data.photos) {
      const std::size_t view = photo.photo.view;
      off.segment<6>(6 * static_cast<Eigen::Index>(view)) =
          pose_difference(prior.T_camera_board[view], photo.camera.T_camera_board);
    }
    out.A = F.bottomRightCorner(m, m) + prior.information;
    out.B = F.topRightCorner(n, m);
    out.geometry_g = f.tail(m) + prior.information * off;
    out.gain = inverse_times(out.A, out.B.transpose()).transpose();
    eliminate.rightCols(m) = -out.gain;
    out.geometry_scatter = out.gain * prior.information * out.gain.transpose();
    f.tail(m) = out.geometry_g;
  }
  for (const auto& [view, Fv] : F_view) {
    out.H_view[view] = eliminate * Fv * eliminate.transpose();
    out.g_view[view] = Eigen::VectorXd::Zero(n);
  }
  Eigen::MatrixXd with_geometry(n + m, n + m);
  with_geometry << eliminate, Eigen::MatrixXd::Zero(m, n), Eigen::MatrixXd::Identity(m, m);
  out.photos.resize(n + m, static_cast<Eigen::Index>(data.photos.size()));
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    out.photos.col(column) = with_geometry * f_photo[k];
    out.g_view[data.photos[k].photo.view] += out.photos.col(column).head(n);
  }
  out.tiles = with_geometry * tiles;
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
    out.photos.col(static_cast<Eigen::Index>(sample.light_view)).head(n) += weight * r * row;
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
  out.tiles = system.tiles.topRows(system.H.rows());
  out.prior_scatter = system.geometry_scatter;
  out.prior_scatter.diagonal() += system.prior;
  return out;
}

Eigen::VectorXd joint_step(Problem& data, const Stage& stage, State& state, Bench& bench) {
  const NormalSystem system = weighted_system(data, stage, state);
  const Eigen::VectorXd step = -safe_inverse(system.H, system.free) * system.g;
  state = moved_state(state, step);
  const auto [least_blur, most_blur] = log_blur_range(data);
  state.shared[unknown::log_blur] = std::clamp(state.shared[unknown::log_blur], least_blur, most_blur);
  if (!data.geometry) return {};
  const Eigen::VectorXd by = -inverse_times(system.A, system.geometry_g + system.B.transpose() * step);
  // Views without photos go along: their tags were seen through the same lens, on the same board.
  for (std::size_t view = 0; view < bench.views.size(); ++view) {
    Eigen::Isometry3d& T = bench.views[view].T_camera_board;
    T = moved_pose(T, by.segment<6>(6 * static_cast<Eigen::Index>(view)));
  }
  const Eigen::Index lens = data.geometry->lens_parameters;
  bench.bow_mm += by.segment<3>(by.size() - lens - 3);
  data.geometry->moved += by;
  bench.lens = moved_lens(bench.lens, by.tail(lens));
  return by.tail(lens);
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
  std::vector<Eigen::VectorXd> geometry_shifts;
  const auto add_shift = [&](const NormalSystem& by, const Eigen::MatrixXd& by_inverse, const Eigen::VectorXd& g,
                             const Eigen::VectorXd& geometry_g) {
    out.shifts.emplace_back(-by_inverse * g);
    if (data.geometry)
      geometry_shifts.emplace_back(-inverse_times(by.A, geometry_g + by.B.transpose() * out.shifts.back()));
  };
  add_shift(tolerant, safe_inverse(tolerant.H, tolerant.free), tolerant.g, tolerant.geometry_g);
  for (std::size_t model = 2; model < models.size(); ++model) {
    const NormalSystem uneven = system_of(model);
    add_shift(system, inverse, uneven.g - system.g, uneven.geometry_g - system.geometry_g);
  }
  out.noise_bound = safe_inverse(system.noise_H, system.free);
  const double scatter = system.pixels ? std::max(1.0, 2 * system.cost / static_cast<double>(system.pixels)) : 1;
  out.covariances.push_back(scatter * inverse);

  Eigen::MatrixXd priors = system.geometry_scatter;  // the priors' own scatter
  priors.diagonal() += system.prior;
  // Scores that are taken for independent, and by what factor a sum over few of them falls short.
  struct Clusters {
    Eigen::MatrixXd scores;
    double factor = 1;
  };
  std::vector<Clusters> clusters(1);
  clusters[0].scores = system.tiles;
  clusters[0].scores.conservativeResize(Eigen::NoChange,
                                        system.tiles.cols() + static_cast<Eigen::Index>(system.tags.size()));
  clusters[0].scores.rightCols(static_cast<Eigen::Index>(system.tags.size())).setZero();
  for (Eigen::Index column = system.tiles.cols(); const auto& [tag, score] : system.tags)
    clusters[0].scores.col(column++).head(n) = score;
  // Errors of the model itself are alike in neighboring places and in photos with like half vectors, so clusters that
  // small would take them for many independent ones. Few large clusters do not: the board's quadrants, and the photos
  // in groups along the lean of their half vectors.
  const auto add_clusters = [&](const Eigen::MatrixXd& scores) {
    const auto count = static_cast<double>(scores.cols());
    if (scores.cols() >= 2) clusters.push_back({scores, count / (count - 1)});
  };
  Eigen::MatrixXd quadrants = Eigen::MatrixXd::Zero(system.tiles.rows(), 4);
  const auto tile_columns = static_cast<Eigen::Index>(std::ceil(data.model.board->size_mm.x() / kTileMm));
  const Eigen::Index tile_rows = system.tiles.cols() / tile_columns;
  for (Eigen::Index tile = 0; tile < system.tiles.cols(); ++tile) {
    const bool right = 2 * (tile % tile_columns) >= tile_columns, upper = 2 * (tile / tile_columns) >= tile_rows;
    quadrants.col((right ? 1 : 0) + (upper ? 2 : 0)) += system.tiles.col(tile);
  }
  add_clusters(quadrants);

  const std::size_t count = data.photos.size();
  std::vector<std::pair<double, Eigen::Index>> by_lean;
  for (std::size_t k = 0; k < count; ++k) {
    const Unknowns x = state.of(data.photos[k].photo.light);
    const Eigen::Vector3d center(data.model.center_mm.x(), data.model.center_mm.y(), 0);
    const Eigen::Vector3d lamp = x.segment<3>(unknown::lamp_position);
    const Eigen::Vector3d h =
        ((lamp - center).normalized() + (data.photos[k].scene.camera_center_mm - center).normalized()).normalized();
    by_lean.emplace_back(h.z(), static_cast<Eigen::Index>(k));
  }
  std::sort(by_lean.begin(), by_lean.end());
  const std::size_t groups = std::min<std::size_t>(4, count / 2);
  Eigen::MatrixXd grouped = Eigen::MatrixXd::Zero(system.photos.rows(), static_cast<Eigen::Index>(groups));
  for (std::size_t k = 0; k < count && groups > 0; ++k)
    grouped.col(static_cast<Eigen::Index>(k * groups / count)) += system.photos.col(by_lean[k].second);
  add_clusters(grouped);
  const Eigen::MatrixXd by_priors = inverse * priors * inverse;
  for (const Clusters& c : clusters) {
    const Eigen::MatrixXd by_cluster = inverse * c.scores.topRows(n);
    out.covariances.emplace_back(c.factor * by_cluster * by_cluster.transpose() + by_priors);
  }

  if (data.geometry) {
    // The centers -R^T t move by -R^T times what t moves by; turns about the camera leave them where they are. A column
    // an axis of each view; those of views without photos stay 0.
    const Eigen::Index m = system.A.rows(), views = static_cast<Eigen::Index>(data.geometry->T_camera_board.size());
    Eigen::MatrixXd by_geometry = Eigen::MatrixXd::Zero(m, 3 * views);
    for (const PhotoData& photo : data.photos) {
      const auto view = static_cast<Eigen::Index>(photo.photo.view);
      by_geometry.block<3, 3>(6 * view + 3, 3 * view) = -photo.camera.T_camera_board.linear();
    }
    const Eigen::MatrixXd by_own = inverse_times(system.A, by_geometry), by_unknowns = system.gain * by_geometry,
                          by_scores = inverse * by_unknowns;
    const Eigen::MatrixXd by_tags = by_own + system.gain.transpose() * by_scores;
    Eigen::MatrixXd by_score(n + m, 3 * views);  // the centers' moves for each score of the unknowns and the geometry
    by_score << by_scores, -by_own;
    out.center_sigma_mm.assign(data.geometry->T_camera_board.size(), Eigen::Vector3d::Zero());
    for (Eigen::Index k = 0; k < 3 * views; ++k) {
      const double of_priors = by_tags.col(k).dot(data.geometry->information * by_tags.col(k)) +
                               by_scores.col(k).dot(system.prior.cwiseProduct(by_scores.col(k)));
      double variance = scatter * (by_geometry.col(k).dot(by_own.col(k)) + by_unknowns.col(k).dot(by_scores.col(k)));
      for (const Clusters& c : clusters)
        variance = std::max(variance, c.factor * (by_score.col(k).transpose() * c.scores).squaredNorm() + of_priors);
      for (const Eigen::VectorXd& shift : geometry_shifts) variance += std::pow(by_geometry.col(k).dot(shift), 2);
      out.center_sigma_mm[k / 3][k % 3] = std::sqrt(variance);
    }
  }

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
