// A small bench for the renderer's tests, and the comparisons that several of them make.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "burin/render/exact/exact_view.h"
#include "burin/render/fast/pairs.h"
#include "burin/render/view_renderer.h"

namespace burin {

struct World {
  Board board;
  Bench bench;
  CameraView camera;
  ViewScene scene;
  Scratches scratches;
};

/// A camera that looks at `target` from `center`, image up roughly board y.
inline Eigen::Isometry3d looking_at(const Eigen::Vector3d& center, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - center).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d(0.1, 1, 0.05)).normalized();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << x.transpose(), z.cross(x).transpose(), z.transpose();
  T.translation() = -T.linear() * center;
  return T;
}

/// A board of 20 mm, 24 x 18 pixels of about 1 mm through a distorting lens, a bowed face, a spot lamp, room light, and
/// scratches 0.1 mm wide with widths, depths and roughnesses of their own.
inline World small_world(int count = 60) {
  World w;
  w.board.size_mm = {20, 20};
  w.board.tool_width_um = 400;
  w.bench.lens.width = 24;
  w.bench.lens.height = 18;
  w.bench.lens.intrinsics = {60, 59, 12.3, 8.1, -0.1, 0.05, 0.001, -0.001, 0, 0, 0, 0};
  w.bench.bow_mm = {0.05, -0.03, 0.08};
  w.bench.material = {0.08, 14, 0.18, {0.91, 0.92, 0.6}};
  w.bench.ambient = {0.001, 0.002, 0.003};
  Light lamp;
  lamp.position_mm = {8, -20, 45};
  lamp.intensity = {900, 800, 700};
  lamp.axis = Eigen::Vector3d(0.05, 0.4, -0.9).normalized();
  lamp.falloff_exponent = 2.5;
  w.bench.lights = {lamp};
  View view;
  view.T_camera_board = looking_at({12, 26, 44}, {10, 10, 0});
  w.camera = make_camera_view(w.bench, w.board, view, {0, 0, 24, 18});
  w.scene = make_scene(w.bench, w.board, w.camera, lamp);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> where(3, 17), turn(0, 2 * std::numbers::pi), length(0.1, 5), factor(0.7, 1.4);
  for (int i = 0; i < count; ++i) {
    const double a = i % 6 == 0 ? std::numbers::pi / 2 * (i / 6 % 4) : turn(random), l = length(random);
    w.scratches.x0_mm.push_back(where(random));
    w.scratches.y0_mm.push_back(where(random));
    w.scratches.x1_mm.push_back(w.scratches.x0_mm.back() + l * std::cos(a));
    w.scratches.y1_mm.push_back(w.scratches.y0_mm.back() + l * std::sin(a));
    w.scratches.width_um.push_back(400 * factor(random));
    w.scratches.depth_um.push_back(14 * factor(random));
    w.scratches.alpha.push_back(0.08 * factor(random));
  }
  return w;
}

/// E = sum of weights times radiance, in double throughout: images are floats, too coarse for small steps.
inline double weighted_sum(const World& w, const ViewPixels& pixels, const PixelIndex& index, const Image& weights) {
  ExactView view(w.scene, pixels);
  Image image;
  const auto strips = strips_of(w.scratches, w.scene.tool_width_um, w.scene.material);
  view.forward(w.scratches, find_pairs(index, w.scene.grid->width(), w.scene.grid->height(), strips), false, image);
  double sum = 0;
  for (std::size_t i = 0; i < view.radiance().size(); ++i) sum += weights.data[i] * view.radiance()[i];
  return sum;
}

inline Image random_weights(const World& w, int channels, unsigned seed) {
  Image weights(w.scene.grid->width(), w.scene.grid->height(), channels);
  std::mt19937 random(seed);
  for (float& v : weights.data) v = std::uniform_real_distribution<float>(-1, 1)(random);
  return weights;
}

inline std::vector<SceneParameter> all_parameters() {
  std::vector<SceneParameter> all;
  for (int i = 0; i <= static_cast<int>(SceneParameter::grain_s); ++i) all.push_back(static_cast<SceneParameter>(i));
  return all;
}

inline double relative_rms(const std::vector<double>& a, const std::vector<double>& exact) {
  double error2 = 0, size2 = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    error2 += (a[i] - exact[i]) * (a[i] - exact[i]);
    size2 += exact[i] * exact[i];
  }
  return std::sqrt(error2 / size2);
}

/// How far one width of the fast path's packets is from the double path.
struct FastErrors {
  double image = 0, value_only = 0;  ///< RMS over the image's peak: of forward_with_jacobian() and of forward()
  double contributions = 0;          ///< relative RMS
  bool same_pairs = false;
  double base_alpha = 0;  ///< relative
  /// Relative RMS over the scratches, by x0 y0 x1 y1, width, depth, alpha; NaN where no scratch has any.
  std::vector<std::pair<std::string, double>> gradients;
};

inline FastErrors fast_errors(const World& w, int channels, SimdWidth simd) {
  const Image weights = random_weights(w, channels, 9);
  RenderOptions options{channels, true};
  ViewRenderer exact(w.scene, options);
  options.use_double = false;
  options.simd = simd;
  ViewRenderer fast(w.scene, options);
  Image expected, image, value_only;
  exact.forward_with_jacobian(in_metal(w.scratches), expected);
  fast.forward(in_metal(w.scratches), value_only);
  fast.forward_with_jacobian(in_metal(w.scratches), image);
  FastErrors errors;
  errors.same_pairs = fast.pair_count() == exact.pair_count();
  double peak = 0, error2 = 0, value_error2 = 0;
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    peak = std::max<double>(peak, expected.data[i]);
    error2 += std::pow(static_cast<double>(image.data[i]) - expected.data[i], 2);
    value_error2 += std::pow(static_cast<double>(value_only.data[i]) - expected.data[i], 2);
  }
  errors.image = std::sqrt(error2 / image.data.size()) / peak;
  errors.value_only = std::sqrt(value_error2 / image.data.size()) / peak;

  ScratchGradients g, ge;
  g.resize(w.scratches.size());
  ge.resize(w.scratches.size());
  fast.backward(weights, g);
  exact.backward(weights, ge);
  errors.gradients = {
      {"x0", relative_rms(g.x0_mm, ge.x0_mm)},          {"y0", relative_rms(g.y0_mm, ge.y0_mm)},
      {"x1", relative_rms(g.x1_mm, ge.x1_mm)},          {"y1", relative_rms(g.y1_mm, ge.y1_mm)},
      {"width", relative_rms(g.width_um, ge.width_um)}, {"depth", relative_rms(g.depth_um, ge.depth_um)},
      {"alpha", relative_rms(g.alpha, ge.alpha)}};
  errors.base_alpha = std::abs(g.shared_base_alpha - ge.shared_base_alpha) / std::abs(ge.shared_base_alpha);

  std::vector<double> sent(w.scratches.size(), 0), sent_exact(w.scratches.size(), 0);
  fast.add_contributions(sent);
  exact.add_contributions(sent_exact);
  errors.contributions = relative_rms(sent, sent_exact);
  return errors;
}

}  // namespace burin
