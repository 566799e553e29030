// What the renderer shows: pairs found against all pairs, each gradient of a view against central differences in
// double, lights and cameras out of place, bad input by name. The oracle of single values is footprint_integral_test;
// that the whole agrees with photographs that we did not make is rig_prediction_test.
#include "render/view_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>
#include <string>

#include "render/error.h"
#include "render/exact_view.h"
#include "render/groove.h"
#include "render/scratch_pair.h"

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

double relative_rms(const std::vector<double>& a, const std::vector<double>& exact) {
  double error2 = 0, size2 = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    error2 += (a[i] - exact[i]) * (a[i] - exact[i]);
    size2 += exact[i] * exact[i];
  }
  return std::sqrt(error2 / size2);
}

/// Image within 1e-6 of its peak and gradients within 1e-4, both RMS, for the packets of one width.
void expect_fast_is_exact(const World& w, int channels, SimdWidth simd, const std::string& what) {
  const Image weights = random_weights(w, channels, 9);
  RenderOptions options{channels, true};
  ViewRenderer exact(w.scene, options);
  options.use_double = false;
  options.simd = simd;
  ViewRenderer fast(w.scene, options);
  Image expected, image, value_only;
  exact.forward_with_jacobian(w.scratches, expected);
  fast.forward(w.scratches, value_only);
  fast.forward_with_jacobian(w.scratches, image);
  EXPECT_EQ(fast.pair_count(), exact.pair_count()) << what;
  double peak = 0, error2 = 0, value_error2 = 0;
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    peak = std::max<double>(peak, expected.data[i]);
    error2 += std::pow(static_cast<double>(image.data[i]) - expected.data[i], 2);
    value_error2 += std::pow(static_cast<double>(value_only.data[i]) - expected.data[i], 2);
  }
  EXPECT_LT(std::sqrt(error2 / image.data.size()), 1e-6 * peak) << what;
  EXPECT_LT(std::sqrt(value_error2 / image.data.size()), 1e-6 * peak) << what;

  ScratchGradients g, ge;
  g.resize(w.scratches.size());
  ge.resize(w.scratches.size());
  fast.backward(weights, g);
  exact.backward(weights, ge);
  EXPECT_LT(relative_rms(g.x0_mm, ge.x0_mm), 1e-4) << what << " x0";
  EXPECT_LT(relative_rms(g.y0_mm, ge.y0_mm), 1e-4) << what << " y0";
  EXPECT_LT(relative_rms(g.x1_mm, ge.x1_mm), 1e-4) << what << " x1";
  EXPECT_LT(relative_rms(g.y1_mm, ge.y1_mm), 1e-4) << what << " y1";
  EXPECT_LT(relative_rms(g.width_um, ge.width_um), 1e-4) << what << " width";
  EXPECT_LT(relative_rms(g.depth_um, ge.depth_um), 1e-4) << what << " depth";
  EXPECT_LT(relative_rms(g.alpha, ge.alpha), 1e-4) << what << " alpha";
  EXPECT_NEAR(g.shared_base_alpha, ge.shared_base_alpha, 1e-4 * std::abs(ge.shared_base_alpha)) << what;

  std::vector<double> sent(w.scratches.size(), 0), sent_exact(w.scratches.size(), 0);
  fast.add_contributions(sent);
  exact.add_contributions(sent_exact);
  EXPECT_LT(relative_rms(sent, sent_exact), 1e-5) << what << " contributions";
}

TEST(SceneDerivatives, MirrorDirectionAndCutOff) {
  // Half vectors along the face's normal, where the plain face shines and the closed forms are most delicate, and at
  // the grooves' steepest normal (29 degrees here), where the glint ends.
  for (const auto& [lamp_mm, what] : {std::pair{Eigen::Vector3d(8, -6, 44), "mirror direction"},
                                      std::pair{Eigen::Vector3d(10, -85, 20), "cut-off"}}) {
    World w = small_world(120);
    w.bench.lights[0].position_mm = lamp_mm;
    w.bench.lights[0].axis = (Eigen::Vector3d(10, 10, 0) - lamp_mm).normalized();
    w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
    const Eigen::Vector3d p(10, 10, 0);
    const Eigen::Vector3d h = ((lamp_mm - p).normalized() + (w.scene.camera_center_mm - p).normalized()).normalized();
    RecordProperty(what, std::to_string(std::acos(h.z()) * 180 / M_PI));
    expect_derivatives(w, what);
  }
}

TEST(FastView, AgreesWithDoubleForEveryWidthOfPackets) {
  const World w = small_world(400);
  for (const SimdWidth simd : {SimdWidth::generic, SimdWidth::avx2, SimdWidth::avx512}) {
    if (!has_kernel(simd)) continue;
    for (const int channels : {1, 3})
      expect_fast_is_exact(w, channels, simd, std::to_string(kernel_lanes(simd)) + " lanes");
  }
}

TEST(FastView, AgreesWithDoubleForDesigns) {
  // The paper's fine deep grooves and a real one's, in a picture laid on the board, where axis-parallel scratches have
  // edges along and across them; pixels larger and smaller than the groove.
  for (const auto& [width_um, depth_um, alpha] : {std::array{30.0, 30.0, 0.04}, std::array{75.0, 38.4, 0.02},
                                                  std::array{400.0, 14.0, 0.08}, std::array{400.0, 14.0, 0.02}}) {
    for (const double pixel_mm : {0.6, 0.05}) {
      World w = small_world(300);
      const double size = 64 * pixel_mm;
      w.board.size_mm = {20, 20};
      const Eigen::Vector2d low(10 - size / 8, 10 - size / 8), high(10 + size / 8, 10 + size / 8);
      w.scene.grid = board_grid(pixel_mm > 0.1 ? Eigen::Vector2d(0, 0) : low,
                                pixel_mm > 0.1 ? Eigen::Vector2d(20, 20) : high, 40, 37, {w.board.size_mm, {0, 0, 0}});
      w.scratches.width_um.clear();
      w.scratches.depth_um.clear();
      w.scratches.alpha.clear();
      w.scene.tool_width_um = width_um;
      w.scene.material.depth_um = depth_um;
      w.scene.material.alpha = alpha;
      expect_fast_is_exact(w, 1, SimdWidth::best,
                           "wt " + std::to_string(width_um) + ", alpha " + std::to_string(alpha) + ", pixels of " +
                               std::to_string(pixel_mm) + " mm");
    }
  }
}

TEST(FastView, WithoutMaterialGradientsTheEndsAreTheSame) {
  const World w = small_world(200);
  const Image weights = random_weights(w, 1, 3);
  ScratchGradients all, ends;
  for (const bool material : {true, false}) {
    RenderOptions options;
    options.material_gradients = material;
    ViewRenderer renderer(w.scene, options);
    Image image;
    renderer.forward_with_jacobian(w.scratches, image);
    ScratchGradients& g = material ? all : ends;
    g.resize(w.scratches.size());
    renderer.backward(weights, g);
  }
  EXPECT_LT(relative_rms(ends.x0_mm, all.x0_mm), 1e-6);
  EXPECT_LT(relative_rms(ends.y1_mm, all.y1_mm), 1e-6);
  EXPECT_EQ(*std::max_element(ends.alpha.begin(), ends.alpha.end()), 0);
}

TEST(ViewRenderer, SameBitsForAnyNumberOfThreads) {
  const World w = small_world(700);
  const Image weights = random_weights(w, 1, 4);
  for (const bool use_double : {false, true}) {
    Image first;
    ScratchGradients first_g;
    std::vector<Image> first_d;
    for (const int threads : {1, 2, 3, 8}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      ViewRenderer renderer(w.scene, {1, use_double});
      Image image;
      renderer.forward_with_jacobian(w.scratches, image);
      ScratchGradients g;
      g.resize(w.scratches.size());
      renderer.backward(weights, g);
      const auto d = render_with_derivatives(w.scene, w.camera, w.scratches, all_parameters());
      if (threads == 1) {
        first = image;
        first_g = g;
        first_d = d.d_radiance;
      }
      EXPECT_EQ(image.data, first.data) << threads << " threads";
      EXPECT_EQ(g.x0_mm, first_g.x0_mm) << threads << " threads";
      EXPECT_EQ(g.y1_mm, first_g.y1_mm) << threads << " threads";
      EXPECT_EQ(g.alpha, first_g.alpha) << threads << " threads";
      EXPECT_EQ(g.shared_base_alpha, first_g.shared_base_alpha) << threads << " threads";
      for (std::size_t k = 0; k < d.d_radiance.size(); ++k) EXPECT_EQ(d.d_radiance[k].data, first_d[k].data);
    }
  }
}

TEST(ViewRenderer, AFineGridHoldsTheWholeScratch) {
  // What pixels of any size see of a scratch adds up to the whole scratch in one footprint; its area is 2 w L.
  World w = small_world(0);
  w.scratches.x0_mm = {7.1};
  w.scratches.y0_mm = {8.2};
  w.scratches.x1_mm = {11.3};
  w.scratches.y1_mm = {12.4};
  Material& m = w.scene.material;
  w.scene.ambient.setZero();
  m.base_alpha = 1;
  m.alpha = 0.3;
  // Far lamp and camera: one half vector for all pixels.
  w.scene.light = Light{};
  w.scene.light.position_mm = {2e6, -3e6, 9e6};
  w.scene.light.intensity = {1e20, 1e20, 1e20};
  w.scene.camera_center_mm = {-1e6, 4e6, 9e6};
  std::vector<double> sums;
  for (const int n : {1, 7, 64, 301}) {
    w.scene.grid = board_grid({5, 5}, {15, 15}, n, n, {{20, 20}, {0, 0, 0}});
    for (const bool use_double : {true, false}) {
      ViewRenderer renderer(w.scene, {1, use_double});
      Image with, without;
      renderer.forward(w.scratches, with);
      renderer.forward(Scratches{}, without);
      double sum = 0;
      for (std::size_t i = 0; i < with.data.size(); ++i)
        sum += (static_cast<double>(with.data[i]) - without.data[i]) / (static_cast<double>(n) * n);
      sums.push_back(sum);
    }
  }
  for (const double sum : sums) EXPECT_NEAR(sum, sums[0], 1e-4 * std::abs(sums[0]));
  const ViewPixels pixels = view_pixels(w.scene, 1);
  const PixelPairs pairs =
      find_pairs(PixelIndex(w.scene.grid), 301, 301, strips_of(w.scratches, w.scene.tool_width_um, m.depth_um));
  double area = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    for (std::size_t k = pairs.begin[i]; k < pairs.begin[i + 1]; ++k) {
      const ScratchFrame f = scratch_frame(w.scratches, 0, w.scene.tool_width_um, m.depth_um, m.alpha);
      const auto corners = footprint_corners_mm(w.scene.grid, static_cast<int>(i % 301), static_cast<int>(i / 301));
      area += footprint_integral(f.groove, in_scratch(f, corners), in_scratch(f, pixels.shading[i].h_face)).area_mm2;
    }
  }
  EXPECT_NEAR(area, 2e-3 * half_width_um(w.scene.tool_width_um, m.depth_um) * std::hypot(4.2, 4.2), 1e-9);
}

TEST(ViewRenderer, LampBehindTheBoardAndCameraBelowTheHorizonAreDark) {
  World w = small_world();
  for (const bool use_double : {false, true}) {
    ViewScene scene = w.scene;
    scene.light.position_mm.z() = -30;
    Image image;
    ViewRenderer behind(scene, {1, use_double});
    behind.forward(w.scratches, image);
    const double room = scene.ambient.cwiseProduct(scene.material.f0).mean();
    for (const float v : image.data) EXPECT_TRUE(v == 0 || std::abs(v - room) < 1e-9) << v;
    EXPECT_GT(*std::max_element(image.data.begin(), image.data.end()), 0);

    scene = w.scene;
    scene.camera_center_mm = {10, 10, -5};
    ViewRenderer below(scene, {1, use_double});
    below.forward(w.scratches, image);
    for (const float v : image.data) EXPECT_EQ(v, 0);
  }
}

TEST(ViewRenderer, BadInputIsNamed) {
  World w = small_world();
  const auto message = [](const auto& act) {
    try {
      act();
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("nothing was thrown");
  };
  ViewRenderer renderer(w.scene);
  Image image;
  Scratches broken = w.scratches;
  broken.y1_mm[7] = NAN;
  EXPECT_THAT(message([&] { renderer.forward(broken, image); }), testing::HasSubstr("y1_mm of scratch 7 is nan"));
  ScratchGradients g;
  g.resize(w.scratches.size());
  renderer.forward(w.scratches, image);
  EXPECT_THAT(message([&] { renderer.backward(image, g); }), testing::HasSubstr("forward_with_jacobian"));
  renderer.forward_with_jacobian(w.scratches, image);
  EXPECT_THAT(message([&] { renderer.backward(Image(3, 3, 1), g); }), testing::HasSubstr("another size"));
  g.resize(3);
  EXPECT_THAT(message([&] { renderer.backward(image, g); }), testing::HasSubstr("resize()"));
  ViewScene scene = w.scene;
  scene.material.alpha = 0;
  EXPECT_THAT(message([&] { ViewRenderer r(scene); }), testing::HasSubstr("material.alpha"));
  scene = w.scene;
  scene.light.position_mm.x() = NAN;
  EXPECT_THAT(message([&] { ViewRenderer r(scene); }), testing::HasSubstr("light.position_mm"));
  scene = w.scene;
  scene.grid.center_mm.clear();
  EXPECT_THAT(message([&] { ViewRenderer r(scene); }), testing::HasSubstr("scene.grid"));
}

TEST(ViewRenderer, FuzzNeverGivesNaN) {
  // Random benches, most of them absurd: grazing and inverted cameras, lamps on the face, mirror-like and rough
  // grooves, grooves wider than the board, scratches without length or as thin as rounding.
  std::mt19937 random(2);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const auto decades = [&](double a, double b) { return std::pow(10, uniform(a, b)); };
  for (int round = 0; round < 150; ++round) {
    World w = small_world(30);
    Light& lamp = w.bench.lights[0];
    lamp.position_mm = {uniform(-30, 50), uniform(-30, 50), round % 7 == 0 ? 0 : uniform(-5, 60)};
    lamp.falloff_exponent = round % 3 == 0 ? 0 : decades(-1, 2);
    w.bench.material.alpha = decades(-3.4, 0);
    w.bench.material.base_alpha = decades(-3, 0);
    w.bench.bow_mm = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    w.camera.surface.bow_mm = w.bench.bow_mm;
    w.camera.T_camera_board =
        looking_at({uniform(-20, 40), uniform(-20, 40), uniform(-3, 60)}, {uniform(0, 20), uniform(0, 20), 0});
    for (std::size_t s = 0; s < w.scratches.size(); ++s) {
      w.scratches.alpha[s] = decades(-3.4, 0);
      w.scratches.width_um[s] = decades(-1, 5);
      w.scratches.depth_um[s] = w.scratches.width_um[s] * decades(-5, 0.4);
      const double length = s % 5 == 0 ? decades(-12, -3) : decades(-2, 1.5);
      w.scratches.x1_mm[s] = w.scratches.x0_mm[s] + (s % 10 == 0 ? 0 : length);
      if (s % 3 == 0) w.scratches.y1_mm[s] = w.scratches.y0_mm[s];
    }
    w.scene = make_scene(w.bench, w.board, w.camera, lamp);
    for (const bool use_double : {false, true}) {
      ViewRenderer renderer(w.scene, {3, use_double});
      Image image;
      renderer.forward_with_jacobian(w.scratches, image);
      ScratchGradients g;
      g.resize(w.scratches.size());
      renderer.backward(random_weights(w, 3, round), g);
      for (const float v : image.data) ASSERT_TRUE(std::isfinite(v) && v >= 0) << "round " << round << " " << v;
      for (const auto* values : {&g.x0_mm, &g.y0_mm, &g.x1_mm, &g.y1_mm, &g.width_um, &g.depth_um, &g.alpha})
        for (const double v : *values) ASSERT_TRUE(std::isfinite(v)) << "round " << round;
    }
    const auto d = render_with_derivatives(w.scene, w.camera, w.scratches, all_parameters());
    for (const Image& image : d.d_radiance)
      for (const float v : image.data) ASSERT_TRUE(std::isfinite(v)) << "round " << round;
  }
}

}  // namespace
}  // namespace burin
