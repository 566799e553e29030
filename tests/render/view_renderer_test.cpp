// What the renderer shows: pairs found against all pairs, each gradient of a view against central differences in
// double, lights and cameras out of place, bad input by name. The oracle of single values is footprint_integral_test;
// that the whole agrees with photographs that we did not make is rig_prediction_test.
#include "burin/render/view_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "burin/base/error.h"
#include "burin/base/simd_width.h"
#include "burin/render/exact/exact_view.h"
#include "burin/render/exact/scratch_pair.h"
#include "burin/scene/groove.h"
#include "tests/render/expect_fast_is_exact.h"
#include "tests/render/small_world.h"

namespace burin {
namespace {

TEST(ViewRenderer, PairsFoundGiveWhatAllPairsGive) {
  const World w = small_world();
  for (const int channels : {1, 3}) {
    ViewRenderer renderer(w.scene, {channels, true});
    Image found;
    renderer.forward(in_metal(w.scratches), found);
    const Image all = render_brute_force(w.scene, in_metal(w.scratches), channels);
    ASSERT_EQ(found.data.size(), all.data.size());
    EXPECT_GT(*std::max_element(all.data.begin(), all.data.end()), 0);
    EXPECT_EQ(found.data, all.data) << channels << " channels";
  }
}

// A pixel's edge on a groove's rim, to the last bit or beside it, is no corner of a triangle.
TEST(ViewRenderer, PixelsWhoseEdgesLieOnRimsAreSeenWhole) {
  const double width_um = 400, depth_um = 2, half_mm = 1e-3 * half_width_um(width_um, depth_um);
  for (const SimdWidth simd : {SimdWidth::generic, SimdWidth::avx2, SimdWidth::avx512})
    for (const double beside_mm : {0.0, 1e-12, -1e-12, 1e-9, -1e-9, 3e-8})
      for (const int columns : {1, 2, 3}) {
        if (!has_kernel(simd)) continue;
        const double pitch_mm = (columns == 2 ? 1 : 2) * (half_mm + beside_mm), left_mm = 30 - pitch_mm * columns / 2;
        ViewScene scene;
        scene.grid = share(board_grid({left_mm, 23.5}, {left_mm + columns * pitch_mm, 24.5}, columns, 2,
                                      Surface{{60, 48}, {0, 0, 0}}));
        scene.camera_center_mm = {30, 0, 300};
        scene.light.position_mm = {20, -300, 400};
        scene.tool_width_um = width_um;
        scene.material.depth_um = depth_um;
        Scratches s;
        s.x0_mm = s.x1_mm = {30};
        s.y0_mm = {19}, s.y1_mm = {29};
        Image fast, exact;
        RenderOptions options;
        options.simd = simd;
        ViewRenderer(scene, options).forward(in_metal(s), fast);
        options.use_double = true;
        ViewRenderer(scene, options).forward(in_metal(s), exact);
        for (std::size_t i = 0; i < exact.data.size(); ++i)
          EXPECT_NEAR(fast.data[i], exact.data[i], 1e-4 * exact.data[i] + 1e-12)
              << columns << " columns, " << beside_mm << " mm beside";
      }
}

/// backward() of the double path against central differences in double: every number of every scratch, and the shared
/// ones with and without numbers of the scratches' own.
void expect_backward(World w, const std::string& what) {
  const Image weights = random_weights(w, 3, 5);
  ViewRenderer renderer(w.scene, {3, true});
  Image image;
  renderer.forward_with_jacobian(in_metal(w.scratches), image);
  ScratchGradients g;
  g.resize(w.scratches.size());
  renderer.backward(weights, g);

  const ViewPixels pixels = view_pixels(w.scene, 3);
  const PixelIndex index(*w.scene.grid);
  const auto check = [&](std::vector<double> Scratches::*member, const std::vector<double>& gradient, double step,
                         const char* name) {
    double largest = 0;
    for (const double v : gradient) largest = std::max(largest, std::abs(v));
    EXPECT_GT(largest, 0) << what << ", " << name;
    for (std::size_t s = 0; s < w.scratches.size(); ++s) {
      double& value = (w.scratches.*member)[s];
      const double kept = value;
      value = kept + step;
      const double plus = weighted_sum(w, pixels, index, weights);
      value = kept - step;
      const double minus = weighted_sum(w, pixels, index, weights);
      value = kept;
      EXPECT_NEAR((plus - minus) / (2 * step), gradient[s], 1e-5 * largest + 1e-4 * std::abs(gradient[s]))
          << what << ", " << name << " of scratch " << s;
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
    EXPECT_NEAR((plus - minus) / (2 * step), gradient, 1e-6 * std::abs(gradient)) << what << ", shared " << name;
  };
  shared(w.scene.material.base_alpha, 1e-6, g.shared_base_alpha, "base_alpha");
  w.scratches.width_um.clear();
  w.scratches.depth_um.clear();
  w.scratches.alpha.clear();
  ViewRenderer uniform(w.scene, {3, true});
  uniform.forward_with_jacobian(in_metal(w.scratches), image);
  g.resize(w.scratches.size());
  uniform.backward(weights, g);
  shared(w.scene.material.alpha, 1e-6, g.shared_alpha, "alpha");
  shared(w.scene.material.depth_um, 1e-4, g.shared_depth_um, "depth_um");
  shared(w.scene.tool_width_um, 1e-3, g.shared_width_um, "width_um");
}

TEST(ViewRenderer, BackwardAgainstCentralDifferences) { expect_backward(small_world(60), "ordinary"); }

/// Worlds at the edges of what formulas distinguish, by name.
std::vector<std::pair<std::string, World>> edge_worlds(int count) {
  std::vector<std::pair<std::string, World>> worlds;
  const auto add = [&](const char* name, const auto& change) {
    World w = small_world(count);
    change(w);
    worlds.emplace_back(name, std::move(w));
  };
  const auto light_from = [](World& w, const Eigen::Vector3d& lamp_mm) {
    w.bench.lights[0].position_mm = lamp_mm;
    w.bench.lights[0].axis = (Eigen::Vector3d(10, 10, 0) - lamp_mm).normalized();
    w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
  };
  add("whole scratches inside a pixel", [](World& w) {
    for (std::size_t s = 0; s < w.scratches.size(); ++s) {
      const Eigen::Vector2d d(w.scratches.x1_mm[s] - w.scratches.x0_mm[s], w.scratches.y1_mm[s] - w.scratches.y0_mm[s]);
      const double length = 0.02 + 0.005 * static_cast<double>(s);
      w.scratches.x1_mm[s] = w.scratches.x0_mm[s] + length * d.x() / d.norm();
      w.scratches.y1_mm[s] = w.scratches.y0_mm[s] + length * d.y() / d.norm();
    }
  });
  add("pixels smaller than the groove, limits cut by their edges", [](World& w) {
    w.scene.grid = share(board_grid({8.013, 8.021}, {9.517, 9.413}, 40, 37, {w.board.size_mm, {0, 0, 0}}));
    for (std::size_t s = 0; s < w.scratches.size(); ++s) {
      const double x = 8.1 + 0.021 * static_cast<double>(s), y = 8.15 + 0.017 * static_cast<double>(s * 7 % 50);
      const Eigen::Vector2d d(w.scratches.x1_mm[s] - w.scratches.x0_mm[s], w.scratches.y1_mm[s] - w.scratches.y0_mm[s]);
      w.scratches.x0_mm[s] = x;
      w.scratches.y0_mm[s] = y;
      w.scratches.x1_mm[s] = x + 0.4 * d.x() / d.norm();
      w.scratches.y1_mm[s] = y + 0.4 * d.y() / d.norm();
    }
  });
  add("scratches along and across the rows of a picture", [](World& w) {
    w.scene.grid = share(board_grid({0, 0}, {20, 20}, 23, 19, {w.board.size_mm, {0, 0, 0}}));
    for (std::size_t s = 0; s < w.scratches.size(); ++s) {
      const double length = 0.05 + 0.07 * static_cast<double>(s % 60);
      w.scratches.x1_mm[s] = w.scratches.x0_mm[s] + (s % 2 == 0 ? length : 0);
      w.scratches.y1_mm[s] = w.scratches.y0_mm[s] + (s % 2 == 0 ? 0 : length);
    }
  });
  // One mirror direction for all pixels is a lamp and a camera far off.
  add("normal incidence, half vectors along the normal", [](World& w) {
    w.scene.camera_center_mm = {10, 10, 5000};
    w.scene.light.position_mm = {10, 10, 4000};
    w.scene.light.axis = {0, 0, -1};
    w.scene.light.intensity *= 4000;
  });
  add("mirror direction", [&](World& w) { light_from(w, {8, -6, 44}); });
  add("cut-off, half vectors at the steepest normal", [&](World& w) { light_from(w, {10, -85, 20}); });
  add("grazing lamp", [&](World& w) { light_from(w, {60, 8, 3}); });
  add("steep grooves, n.h below 0 on one side", [&](World& w) {
    light_from(w, {60, 8, 6});
    for (std::size_t s = 0; s < w.scratches.size(); ++s) w.scratches.depth_um[s] = 2 * w.scratches.width_um[s];
  });
  add("mirror-like grooves", [](World& w) {
    for (double& v : w.scratches.alpha) v *= 0.1;
  });
  add("rough grooves", [](World& w) {
    for (double& v : w.scratches.alpha) v = std::min(0.999, 10 * v);
  });
  return worlds;
}

TEST(ViewRenderer, BackwardAgainstCentralDifferencesAtTheEdges) {
  for (const auto& [name, world] : edge_worlds(40)) expect_backward(world, name);
}

TEST(ViewRenderer, BackwardWhereGroovesCoverTheFaceWhole) {
  // `covered` is clamped in the middle and not at the rim of a heap of wide grooves.
  World w = small_world(60);
  for (double& v : w.scratches.width_um) v *= 12;
  for (double& v : w.scratches.depth_um) v *= 12;
  expect_backward(w, "covered");
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
    Bench moved;
    moved.machine_affine = A;
    moved.material = Board().material;  // as told: own depths stay as they are
    w.scratches = carve(Sent(w.scratches), moved, Board()).scratches;
  } else if (const int i = among(SceneParameter::pose_rx, 3); i >= 0) {
    w.camera.T_camera_board = Eigen::AngleAxisd(step, Eigen::Vector3d::Unit(i)) * w.camera.T_camera_board;
  } else if (const int i = among(SceneParameter::pose_tx_mm, 3); i >= 0) {
    w.camera.T_camera_board.translation()[i] += step;
  } else if (const int i = among(SceneParameter::bow_0_mm, 3); i >= 0) {
    w.bench.bow_mm[i] += step;
    w.camera.surface.bow_mm[i] += step;
  } else if (parameter == SceneParameter::grain_c) {
    material.grain.c += step;
  } else if (parameter == SceneParameter::grain_s) {
    material.grain.s += step;
  }
  w.scene = make_scene(w.bench, w.board, w.camera, light);
  return w;
}

std::vector<double> radiance_in_double(const World& w, int channels) {
  const ViewPixels pixels = view_pixels(w.scene, channels);
  ExactView view(w.scene, pixels);
  Image image;
  const auto strips = strips_of(w.scratches, w.scene.tool_width_um, w.scene.material);
  view.forward(w.scratches,
               find_pairs(PixelIndex(*w.scene.grid), w.scene.grid->width(), w.scene.grid->height(), strips), false,
               image);
  return view.radiance();
}

// `most`: the worst rounding is that of a difference of 1e-6 in double; a wrong term would be off by parts of one.
void expect_derivatives(const World& w, const char* what, double most = 2e-5) {
  const auto parameters = all_parameters();
  for (const int channels : {1, 3}) {
    const RadianceDerivatives d =
        render_with_derivatives(w.scene, w.camera, in_metal(w.scratches), parameters, {channels, true});
    const std::vector<double> here = radiance_in_double(w, channels);
    for (std::size_t i = 0; i < here.size(); ++i)
      ASSERT_NEAR(d.radiance.data[i], here[i], 1e-6 * std::abs(here[i])) << what;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      const bool position = parameters[k] >= SceneParameter::light_x_mm && parameters[k] <= SceneParameter::light_z_mm;
      const bool turn = (parameters[k] >= SceneParameter::pose_rx && parameters[k] <= SceneParameter::pose_rz) ||
                        parameters[k] == SceneParameter::machine_00 || parameters[k] == SceneParameter::machine_01 ||
                        parameters[k] == SceneParameter::machine_10 || parameters[k] == SceneParameter::machine_11;
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
      EXPECT_LT(std::sqrt(error2 / size2), most) << what << ", parameter " << k << ", " << channels << " channels";
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

TEST(SceneDerivatives, OfABrushedFace) {
  World w = small_world(120);
  w.bench.material.grain = FaceGrain::of(25, 0.12, 0.25);
  w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
  expect_derivatives(w, "brushed");
}

TEST(SceneDerivatives, OfARoundedV) {
  World w = small_world(120);
  w.bench.material.profile.kind = GrooveProfile::Kind::rounded_v;
  w.bench.material.profile.flank_deg = 20;
  w.bench.material.profile.across = 1.3;
  w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
  // Derivatives of a band's mean are taken by the nodes of the mean itself: good to some 1e-4 of it.
  expect_derivatives(w, "rounded V", 1e-3);
}

TEST(ViewRenderer, ABrushedFaceIsTheSameInBothPaths) {
  World w = small_world(60);
  w.bench.material.grain = FaceGrain::of(-40, 0.1, 0.3);
  w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
  Image fast;
  ViewRenderer(w.scene, {3}).forward(in_metal(w.scratches), fast);
  const std::vector<double> exact = radiance_in_double(w, 3);
  double peak = 0, most = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    peak = std::max(peak, exact[i]);
    most = std::max(most, std::abs(fast.data[i] - exact[i]));
  }
  EXPECT_LT(most, 3e-6 * peak);  // float's
}

TEST(SceneDerivatives, AtTheEdges) {
  for (const auto& [name, world] : edge_worlds(120)) {
    // Those laid on the board have no camera whose pose could change.
    if (name.find("picture") == std::string::npos && name.find("pixels smaller") == std::string::npos &&
        name.find("incidence") == std::string::npos)
      expect_derivatives(world, name.c_str());
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

TEST(FastView, AgreesWithDoubleAtTheEdges) {
  for (const auto& [name, world] : edge_worlds(200)) {
    if (name == "mirror-like grooves") continue;  // alpha below 0.02 is promised no more than to be finite
    for (const SimdWidth simd : {SimdWidth::generic, SimdWidth::avx2, SimdWidth::avx512})
      if (has_kernel(simd)) expect_fast_is_exact(world, 1, simd, name + ", " + std::to_string(kernel_lanes(simd)));
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
      w.scene.grid =
          share(board_grid(pixel_mm > 0.1 ? Eigen::Vector2d(0, 0) : low,
                           pixel_mm > 0.1 ? Eigen::Vector2d(20, 20) : high, 40, 37, {w.board.size_mm, {0, 0, 0}}));
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
    renderer.forward_with_jacobian(in_metal(w.scratches), image);
    ScratchGradients& g = material ? all : ends;
    g.resize(w.scratches.size());
    renderer.backward(weights, g);
  }
  EXPECT_LT(relative_rms(ends.x0_mm, all.x0_mm), 1e-6);
  EXPECT_LT(relative_rms(ends.y1_mm, all.y1_mm), 1e-6);
  EXPECT_EQ(*std::max_element(ends.alpha.begin(), ends.alpha.end()), 0);
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
    w.scene.grid = share(board_grid({5, 5}, {15, 15}, n, n, {{20, 20}, {0, 0, 0}}));
    for (const bool use_double : {true, false}) {
      ViewRenderer renderer(w.scene, {1, use_double});
      Image with, without;
      renderer.forward(in_metal(w.scratches), with);
      renderer.forward({}, without);
      double sum = 0;
      for (std::size_t i = 0; i < with.data.size(); ++i)
        sum += (static_cast<double>(with.data[i]) - without.data[i]) / (static_cast<double>(n) * n);
      sums.push_back(sum);
    }
  }
  for (const double sum : sums) EXPECT_NEAR(sum, sums[0], 1e-4 * std::abs(sums[0]));
  const ViewPixels pixels = view_pixels(w.scene, 1);
  const PixelPairs pairs =
      find_pairs(PixelIndex(*w.scene.grid), 301, 301, strips_of(w.scratches, w.scene.tool_width_um, m));
  double area = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    for (std::size_t k = pairs.begin[i]; k < pairs.begin[i + 1]; ++k) {
      const ScratchFrame f = scratch_frame(w.scratches, 0, w.scene.tool_width_um, m);
      const auto corners = footprint_corners_mm(*w.scene.grid, static_cast<int>(i % 301), static_cast<int>(i / 301));
      area += footprint_integral(f.groove, in_scratch(f, corners), in_scratch(f, pixels.shading[i].h_face)).area_mm2;
    }
  }
  EXPECT_NEAR(area, 2e-3 * half_width_um(w.scene.tool_width_um, m.depth_um) * std::hypot(4.2, 4.2), 1e-9);
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
  EXPECT_THAT(message([&] { renderer.forward(in_metal(broken), image); }),
              testing::HasSubstr("y1_mm of scratch 7 is nan"));
  ScratchGradients g;
  g.resize(w.scratches.size());
  renderer.forward(in_metal(w.scratches), image);
  EXPECT_THAT(message([&] { renderer.backward(image, g); }), testing::HasSubstr("forward_with_jacobian"));
  renderer.forward_with_jacobian(in_metal(w.scratches), image);
  EXPECT_THAT(message([&] { renderer.backward(Image(3, 3, 1), g); }), testing::HasSubstr("another size"));
  g.resize(3);
  EXPECT_THAT(message([&] { renderer.backward(image, g); }), testing::HasSubstr("are for 3 scratches"));
  // Empty gradients are sized, and hold what those of a view of its own hold.
  ScratchGradients empty;
  renderer.backward(image, empty);
  EXPECT_EQ(empty.x0_mm, renderer.backward(image).x0_mm);
  ViewScene scene = w.scene;
  scene.material.alpha = 0;
  EXPECT_THAT(message([&] { ViewRenderer r(scene); }), testing::HasSubstr("material.alpha"));
  scene = w.scene;
  scene.light.position_mm.x() = NAN;
  EXPECT_THAT(message([&] { ViewRenderer r(scene); }), testing::HasSubstr("light.position_mm"));
  scene = w.scene;
  FootprintGrid short_of_centers = *w.scene.grid;
  short_of_centers.center_mm.clear();
  scene.grid = share(short_of_centers);
  EXPECT_THAT(message([&] { ViewRenderer r(scene); }), testing::HasSubstr("scene.grid"));
  scene.grid = nullptr;
  EXPECT_THAT(message([&] { ViewRenderer r(scene); }), testing::HasSubstr("scene.grid"));
}

}  // namespace
}  // namespace burin
