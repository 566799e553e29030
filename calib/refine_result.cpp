#include "calib/refine_result.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "render/groove.h"
#include "render/surface.h"

namespace burin {
namespace {

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

// Covariance of the affine map (one row of it: x, y, 1) that best takes the tags' true centers to the believed ones.
Eigen::Matrix3d tag_frame_covariance(const Board& board) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const Tag& tag : board.tags.list) {
    const Eigen::Vector3d x(tag.center_mm.x(), tag.center_mm.y(), 1);
    information += x * x.transpose();
  }
  const double sigma = board.tags.sigma_mm;
  if (board.tags.list.size() < 3) return Eigen::Matrix3d::Identity() * sigma * sigma;
  return sigma * sigma * information.inverse();
}

}  // namespace

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
  // Photos see the scratches against the tags, so the frame itself is only as good as the tags' believed places taken
  // together; that is no fault of the photos and must not be read as one of the machine.
  const Eigen::Matrix3d frame = tag_frame_covariance(board);
  const auto sigma_of = [&](int row, const Eigen::Vector3d& a_center) {  // of a00 a1 + a01 a2 + t a3, about the center
    Eigen::VectorXd a = Eigen::VectorXd::Zero(uncertainty.covariances.front().rows());
    for (int column = 0; column < 2; ++column) a[unknown::machine + 2 * row + column] = a_center[column];
    a[unknown::machine + 4 + row] = a_center[2];
    // The frame's covariance is about the board's origin: x = c + (x - c).
    const Eigen::Vector3d a_origin(a_center[0] + a_center[2] * c.x(), a_center[1] + a_center[2] * c.y(), a_center[2]);
    return std::hypot(uncertainty.sigma(a), std::sqrt(a_origin.dot(frame * a_origin)));
  };
  Affine2 sigma;
  for (int row = 0; row < 2; ++row) {
    sigma(row, 0) = sigma_of(row, {1, 0, 0});
    sigma(row, 1) = sigma_of(row, {0, 1, 0});
    sigma(row, 2) = sigma_of(row, {-c.x(), -c.y(), 1});
  }
  bench.machine_affine_sigma = sigma;
  double worst = 0;  // over the carve area's corners
  for (const double x : {board.carve_min_mm.x(), board.carve_max_mm.x()})
    for (const double y : {board.carve_min_mm.y(), board.carve_max_mm.y()})
      for (int row = 0; row < 2; ++row) worst = std::max(worst, sigma_of(row, {x - c.x(), y - c.y(), 1}));
  judge("machine.affine", worst, 0.1,
        "one sigma is at most " + number(worst, 2) + " mm over the carve area, the tags' places included");

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

}  // namespace burin
