// What the renderer shows: pairs found against all pairs, each gradient of a view against central differences in
// double, lights and cameras out of place, bad input by name. The oracle of single values is footprint_integral_test;
// that the whole agrees with photographs that we did not make is rig_prediction_test.
#include "render/view_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "render/error.h"
#include "render/exact_view.h"

namespace burin {
namespace {

struct World {
  Board board;
  Bench bench;
  CameraView camera;
  ViewScene scene;
  Scratches scratches;
};

Eigen::Isometry3d looking_at(const Eigen::Vector3d& center, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - center).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d(0.1, 1, 0.05)).normalized();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << x.transpose(), z.cross(x).transpose(), z.transpose();
  T.translation() = -T.linear() * center;
  return T;
}

/// A board of 20 mm, 24 x 18 pixels of about 1 mm through a distorting lens, a bowed face, a spot lamp, room light, and
/// scratches 0.1 mm wide with widths, depths and roughnesses of their own.
World small_world(int count = 60) {
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
  std::uniform_real_distribution<double> where(3, 17), turn(0, 2 * M_PI), length(0.1, 5), factor(0.7, 1.4);
  for (int i = 0; i < count; ++i) {
    const double a = i % 6 == 0 ? M_PI / 2 * (i / 6 % 4) : turn(random), l = length(random);
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

TEST(ViewRenderer, PairsFoundGiveWhatAllPairsGive) {
  const World w = small_world();
  for (const int channels : {1, 3}) {
    ViewRenderer renderer(w.scene, {channels, true});
    Image found;
    renderer.forward(w.scratches, found);
    const Image all = render_brute_force(w.scene, w.scratches, channels);
    ASSERT_EQ(found.data.size(), all.data.size());
    EXPECT_GT(*std::max_element(all.data.begin(), all.data.end()), 0);
    EXPECT_EQ(found.data, all.data) << channels << " channels";
  }
}

/// E = sum of weights times radiance, in double throughout: images are floats, too coarse for small steps.
double weighted_sum(const World& w, const ViewPixels& pixels, const PixelIndex& index, const Image& weights) {
  ExactView view(w.scene, pixels);
  Image image;
  const auto strips = strips_of(w.scratches, w.scene.tool_width_um, w.scene.material.depth_um);
  view.forward(w.scratches, find_pairs(index, w.scene.grid.width(), w.scene.grid.height(), strips), false, image);
  double sum = 0;
  for (std::size_t i = 0; i < view.radiance().size(); ++i) sum += weights.data[i] * view.radiance()[i];
  return sum;
}

Image random_weights(const World& w, int channels, unsigned seed) {
  Image weights(w.scene.grid.width(), w.scene.grid.height(), channels);
  std::mt19937 random(seed);
  for (float& v : weights.data) v = std::uniform_real_distribution<float>(-1, 1)(random);
  return weights;
}

TEST(ViewRenderer, BackwardAgainstCentralDifferences) {
  World w = small_world(60);
  const Image weights = random_weights(w, 3, 5);
  ViewRenderer renderer(w.scene, {3, true});
  Image image;
  renderer.forward_with_jacobian(w.scratches, image);
  ScratchGradients g;
  g.resize(w.scratches.size());
  renderer.backward(weights, g);

  const ViewPixels pixels = view_pixels(w.scene, 3);
  const PixelIndex index(w.scene.grid);
  const auto check = [&](std::vector<double> Scratches::*member, const std::vector<double>& gradient, double step,
                         const char* name) {
    double largest = 0;
    for (const double v : gradient) largest = std::max(largest, std::abs(v));
    EXPECT_GT(largest, 0) << name;
    for (std::size_t s = 0; s < w.scratches.size(); ++s) {
      double& value = (w.scratches.*member)[s];
      const double kept = value;
      value = kept + step;
      const double plus = weighted_sum(w, pixels, index, weights);
      value = kept - step;
      const double minus = weighted_sum(w, pixels, index, weights);
      value = kept;
      EXPECT_NEAR((plus - minus) / (2 * step), gradient[s], 1e-5 * largest + 1e-4 * std::abs(gradient[s]))
          << name << " of scratch " << s;
    }
  };
  check(&Scratches::x0_mm, g.x0_mm, 1e-6, "x0");
  check(&Scratches::y0_mm, g.y0_mm, 1e-6, "y0");
  check(&Scratches::x1_mm, g.x1_mm, 1e-6, "x1");
  check(&Scratches::y1_mm, g.y1_mm, 1e-6, "y1");
  check(&Scratches::width_um, g.width_um, 1e-3, "width");
  check(&Scratches::depth_um, g.depth_um, 1e-4, "depth");
  check(&Scratches::alpha, g.alpha, 1e-6, "alpha");

  const auto shared = [&](double& value, double step, double gradient, const char* name) {
    const double kept = value;
    value = kept + step;
    const double plus = weighted_sum(w, view_pixels(w.scene, 3), index, weights);
    value = kept - step;
    const double minus = weighted_sum(w, view_pixels(w.scene, 3), index, weights);
    value = kept;
    EXPECT_NEAR((plus - minus) / (2 * step), gradient, 1e-6 * std::abs(gradient)) << name;
  };
  shared(w.scene.material.base_alpha, 1e-6, g.shared_base_alpha, "base_alpha");
  w.scratches.width_um.clear();
  w.scratches.depth_um.clear();
  w.scratches.alpha.clear();
  ViewRenderer uniform(w.scene, {3, true});
  uniform.forward_with_jacobian(w.scratches, image);
  g.resize(w.scratches.size());
  uniform.backward(weights, g);
  shared(w.scene.material.alpha, 1e-6, g.shared_alpha, "alpha");
  shared(w.scene.material.depth_um, 1e-4, g.shared_depth_um, "depth_um");
  shared(w.scene.tool_width_um, 1e-3, g.shared_width_um, "width_um");
}

/// The world with one parameter of a bench changed by `step`, everything else made anew from it.
World moved(World w, SceneParameter parameter, double step) {
  const int p = static_cast<int>(parameter);
  const auto among = [&](SceneParameter first, int count) {
    const int i = p - static_cast<int>(first);
    return i >= 0 && i < count ? i : -1;
  };
  Material& material = w.bench.material;
  Light& light = w.bench.lights[0];
  const auto scale = [](std::vector<double>& values, double factor) {
    for (double& v : values) v *= factor;
  };
  if (parameter == SceneParameter::alpha) {
    scale(w.scratches.alpha, 1 + step / material.alpha);
    material.alpha += step;
  } else if (parameter == SceneParameter::depth_um) {
    scale(w.scratches.depth_um, 1 + step / material.depth_um);
    material.depth_um += step;
  } else if (parameter == SceneParameter::width_um) {
    scale(w.scratches.width_um, 1 + step / w.board.tool_width_um);
    w.board.tool_width_um += step;
  } else if (parameter == SceneParameter::base_alpha) {
    material.base_alpha += step;
  } else if (parameter == SceneParameter::log_intensity) {
    light.intensity *= std::exp(step);
  } else if (parameter == SceneParameter::falloff_exponent) {
    light.falloff_exponent += step;
  } else if (const int i = among(SceneParameter::light_x_mm, 3); i >= 0) {
    light.position_mm[i] += step;
  } else if (const int i = among(SceneParameter::light_axis_x, 3); i >= 0) {
    light.axis[i] += step;
  } else if (const int i = among(SceneParameter::machine_00, 6); i >= 0) {
    Affine2 A = (Affine2() << 1, 0, 0, 0, 1, 0).finished();
    A(i / 3, i % 3) += step;
    w.scratches = transformed(w.scratches, A);
  } else if (const int i = among(SceneParameter::pose_rx, 3); i >= 0) {
    w.camera.T_camera_board = Eigen::AngleAxisd(step, Eigen::Vector3d::Unit(i)) * w.camera.T_camera_board;
  } else if (const int i = among(SceneParameter::pose_tx_mm, 3); i >= 0) {
    w.camera.T_camera_board.translation()[i] += step;
  } else if (const int i = among(SceneParameter::bow_0_mm, 3); i >= 0) {
    w.bench.bow_mm[i] += step;
    w.camera.surface.bow_mm[i] += step;
  }
  w.scene = make_scene(w.bench, w.board, w.camera, light);
  return w;
}

std::vector<double> radiance_in_double(const World& w, int channels) {
  const ViewPixels pixels = view_pixels(w.scene, channels);
  ExactView view(w.scene, pixels);
  Image image;
  const auto strips = strips_of(w.scratches, w.scene.tool_width_um, w.scene.material.depth_um);
  view.forward(w.scratches, find_pairs(PixelIndex(w.scene.grid), w.scene.grid.width(), w.scene.grid.height(), strips),
               false, image);
  return view.radiance();
}

std::vector<SceneParameter> all_parameters() {
  std::vector<SceneParameter> all;
  for (int i = 0; i <= static_cast<int>(SceneParameter::bow_2_mm); ++i) all.push_back(static_cast<SceneParameter>(i));
  return all;
}

void expect_derivatives(const World& w, const char* what) {
  const auto parameters = all_parameters();
  for (const int channels : {1, 3}) {
    const RadianceDerivatives d = render_with_derivatives(w.scene, w.camera, w.scratches, parameters, {channels});
    const std::vector<double> here = radiance_in_double(w, channels);
    for (std::size_t i = 0; i < here.size(); ++i)
      ASSERT_NEAR(d.radiance.data[i], here[i], 1e-6 * std::abs(here[i])) << what;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      const bool position = parameters[k] >= SceneParameter::light_x_mm && parameters[k] <= SceneParameter::light_z_mm;
      const bool turn = parameters[k] >= SceneParameter::pose_rx && parameters[k] <= SceneParameter::pose_rz;
      // Radiance is only piecewise smooth (corners cross rims): steps as small as double allows, in mm on the board.
      const double step = position ? 1e-4 : turn ? 1e-7 : 1e-6;
      const auto plus = radiance_in_double(moved(w, parameters[k], step), channels);
      const auto minus = radiance_in_double(moved(w, parameters[k], -step), channels);
      double largest = 0, error2 = 0, size2 = 0;
      for (std::size_t i = 0; i < plus.size(); ++i) {
        const double difference = (plus[i] - minus[i]) / (2 * step);
        largest = std::max(largest, std::abs(difference));
        error2 += std::pow(difference - d.d_radiance[k].data[i], 2);
        size2 += difference * difference;
      }
      EXPECT_GT(largest, 0) << what << ", parameter " << k;
      // The worst rounding is that of a difference of 1e-6 in double; a wrong term would be off by parts of one.
      EXPECT_LT(std::sqrt(error2 / size2), 2e-5) << what << ", parameter " << k << ", " << channels << " channels";
    }
  }
}

TEST(SceneDerivatives, AgainstCentralDifferences) {
  World w = small_world(120);
  expect_derivatives(w, "own widths, depths and roughnesses");
  w.scratches.width_um.clear();
  w.scratches.depth_um.clear();
  w.scratches.alpha.clear();
  expect_derivatives(w, "shared ones");
}

TEST(SceneDerivatives, WhereGroovesCoverTheFaceWhole) {
  World w = small_world(900);
  for (double& v : w.scratches.width_um) v *= 3;
  expect_derivatives(w, "clamped covered area");
}

TEST(SceneDerivatives, FlatFaceAndBareLamp) {
  World w = small_world(120);
  w.bench.bow_mm.setZero();
  w.camera.surface.bow_mm.setZero();
  w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
  expect_derivatives(w, "flat face");
}

}  // namespace
}  // namespace burin
