#include "calib/photo_uncertainty.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "calib/paper_equation.h"

namespace burin {
namespace {

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

}  // namespace

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
    const auto [r, row] = paper_equation(data, state, sample, free);
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
    if (free[unknown::vignette + i]) prior[unknown::vignette + i] = 1 / std::pow(kVignettePriorSigma[i], 2);
  H.diagonal() += prior;

  const Eigen::MatrixXd inverse = safe_inverse(H, free);
  Uncertainty out;
  const double scatter = pixels ? std::max(1.0, 2 * cost / static_cast<double>(pixels)) : 1;
  out.covariances.push_back(scatter * inverse);

  Eigen::MatrixXd meat = tiles * tiles.transpose();
  for (const auto& [tag, score] : tag_scores) meat += score * score.transpose();
  meat.diagonal() += prior;  // the priors' own scatter
  out.covariances.push_back(inverse * meat * inverse);

  // Errors of the model itself are alike in neighbouring places and in photos with like half vectors, so clusters that
  // small would take them for many independent ones. Few large clusters do not: the board's quadrants, and the photos
  // in groups along the lean of their half vectors.
  const auto add_clusters = [&](const std::vector<Eigen::VectorXd>& scores) {
    const auto clusters = static_cast<double>(scores.size());
    if (scores.size() < 2) return;
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
    for (const Eigen::VectorXd& score : scores) sum += score * score.transpose();
    out.covariances.push_back(inverse * (clusters / (clusters - 1) * sum) * inverse);
  };
  std::vector<Eigen::VectorXd> quadrants(4, Eigen::VectorXd::Zero(n));
  const auto tile_columns = static_cast<Eigen::Index>(std::ceil(data.model.board->size_mm.x() / kTileMm));
  const Eigen::Index tile_rows = tiles.cols() / tile_columns;
  for (Eigen::Index tile = 0; tile < tiles.cols(); ++tile) {
    const bool right = 2 * (tile % tile_columns) >= tile_columns, upper = 2 * (tile / tile_columns) >= tile_rows;
    quadrants[(right ? 1 : 0) + (upper ? 2 : 0)] += tiles.col(tile);
  }
  add_clusters(quadrants);

  const std::size_t count = H_photo.size();
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
  for (std::size_t k = 0; k < count && groups > 0; ++k) grouped[k * groups / count] += g_photo[by_lean[k].second];
  add_clusters(grouped);

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

  out.free = free;
  for (std::size_t k = 0; k < count; ++k) out.part_photo.push_back(k);
  out.part_information = std::move(H_photo);
  out.part_gradient = std::move(g_photo);
  out.prior_information = prior;
  out.prior_gradient = Eigen::VectorXd::Zero(n);
  out.prior_gradient[kSharedUnknowns] = prior[kSharedUnknowns] * state.log_paper[0];
  for (int i = unknown::vignette; i < unknown::vignette + 3; ++i) out.prior_gradient[i] = prior[i] * state.shared[i];
  return out;
}

}  // namespace burin
