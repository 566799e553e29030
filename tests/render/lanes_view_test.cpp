// What is proved: that lanes show what sampled points of the lowest walls show, where grooves cross at any angle and in
// any number; and where nothing is cut, that light and all slopes are those of the footprint integral.
#include "burin/render/lanes_view.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "burin/render/brdf.h"
#include "burin/scene/blur.h"
#include "burin/scene/groove.h"
#include "tests/render/small_world.h"

namespace burin {
namespace {

// The small world, seen by 240 x 176 pixels of 0.1 mm.
World seen_closely(int count) {
  World w = small_world(count);
  w.bench.lens.width = 240;
  w.bench.lens.height = 176;
  w.bench.lens.intrinsics = {592, 584, 122, 81.8, -0.1, 0.05, 0.001, -0.001, 0, 0, 0, 0};
  View view;
  view.T_camera_board = w.camera.T_camera_board;
  w.camera = make_camera_view(w.bench, w.board, view, {0, 0, 240, 176});
  w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
  return w;
}

Carved in_lanes(const World& w, Crossings rule, int count) {
  Carved out = in_metal(w.scratches);
  std::vector<std::uint32_t> order(out.size(), 0);  // all at once: of the last rule, nothing is cut
  out.lanes = std::make_shared<const VisibleLanes>(visible_lanes(out.scratches, order, w.scene.tool_width_um,
                                                                 w.scene.material.depth_um, w.scene.material.profile,
                                                                 rule, count, 0.02));
  return out;
}

double difference_of(const Image& a_sharp, const Image& b_sharp) {
  const Image a = blurred(a_sharp, 0.8), b = blurred(b_sharp, 0.8);
  return relative_rms({a.data.begin(), a.data.end()}, {b.data.begin(), b.data.end()});
}

std::vector<SceneParameter> all_but_width() {
  std::vector<SceneParameter> out = all_parameters();
  std::erase(out, SceneParameter::width_um);
  return out;
}

TEST(LanesView, WhereNothingIsCutLightAndSlopesAreTheIntegrals) {
  for (const bool own : {true, false}) {
    World w = seen_closely(150);
    if (!own) {
      w.scratches.width_um.clear();
      w.scratches.depth_um.clear();
      w.scratches.alpha.clear();
    }
    const std::vector<SceneParameter> parameters = all_but_width();
    const RadianceDerivatives exact =
        render_with_derivatives(w.scene, w.camera, in_metal(w.scratches), parameters, {1, true});
    const Carved lanes = in_lanes(w, Crossings::last, 24);
    const RadianceDerivatives found = render_with_derivatives(w.scene, w.camera, lanes, parameters);
    EXPECT_LT(difference_of(found.radiance, exact.radiance), 1e-3);
    Image radiance;
    ViewRenderer(w.scene).forward(lanes, radiance);
    EXPECT_LT(difference_of(radiance, exact.radiance), 1e-3);
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      const bool places = parameters[k] >= SceneParameter::machine_00 && parameters[k] <= SceneParameter::bow_2_mm;
      // Rims lie in one lane, and edges of pixels are crossed lane by lane.
      const double most = parameters[k] == SceneParameter::depth_um ? 0.05 : places ? 0.2 : 0.01;
      EXPECT_LT(difference_of(found.d_radiance[k], exact.d_radiance[k]), most)
          << "parameter " << static_cast<int>(parameters[k]) << (own ? ", own numbers" : "");
    }
  }
}

TEST(LanesView, BackwardIsTheIntegrals) {
  const World w = seen_closely(150);
  const Image weights = blurred(random_weights(w, 1, 9), 1.5);
  ViewRenderer exact(w.scene, {1, true}), found(w.scene);
  Image image;
  exact.forward_with_jacobian(in_metal(w.scratches), image);
  const ScratchGradients expected = exact.backward(weights);
  found.forward_with_jacobian(in_lanes(w, Crossings::last, 24), image);
  const ScratchGradients g = found.backward(weights);
  for (const auto column : {&ScratchGradients::x0_mm, &ScratchGradients::y0_mm, &ScratchGradients::x1_mm,
                            &ScratchGradients::y1_mm, &ScratchGradients::depth_um})
    EXPECT_LT(relative_rms(g.*column, expected.*column), 0.25);  // one end lies where grooves cover the face just whole
  EXPECT_LT(relative_rms(g.alpha, expected.alpha), 0.02);
  EXPECT_NEAR(g.shared_base_alpha, expected.shared_base_alpha, 1e-3 * std::abs(expected.shared_base_alpha));
  std::vector<double> sent(w.scratches.size(), 0), expected_sent(sent);
  found.add_contributions(sent);
  exact.add_contributions(expected_sent);
  EXPECT_LT(relative_rms(sent, expected_sent), 5e-3);
}

// What a place of the board sends: the NDF on the lowest wall there, or the plain face's.
struct PointLight {
  const World& w;
  std::vector<Eigen::Vector2d> first, along;
  std::vector<double> length, half_mm;

  explicit PointLight(const World& world) : w(world) {
    const Scratches& s = w.scratches;
    for (std::size_t i = 0; i < s.size(); ++i) {
      first.emplace_back(s.x0_mm[i], s.y0_mm[i]);
      const Eigen::Vector2d way = Eigen::Vector2d(s.x1_mm[i], s.y1_mm[i]) - first[i];
      length.push_back(way.norm());
      along.push_back(way / length[i]);
      half_mm.push_back(1e-3 * half_width_um(s.width_um[i], s.depth_um[i]));
    }
  }
  // Where the plain face is seen, `base`; else D G of the wall.
  double at(const Eigen::Vector2d& p, const PixelShading& shading, double base) const {
    double lowest_um = 0, light = base;
    for (std::size_t i = 0; i < first.size(); ++i) {
      const Eigen::Vector2d from = p - first[i];
      const double t = from.dot(along[i]), x = from.x() * along[i].y() - from.y() * along[i].x();
      if (t < 0 || t > length[i] || std::abs(x) >= half_mm[i]) continue;
      const double width = w.scratches.width_um[i], height = groove_height_um(1e3 * x, width, w.scratches.depth_um[i]);
      if (!(height < lowest_um)) continue;
      lowest_um = height;
      const double t2 = 2e3 * x / width, slope = 2 * t2 / (1 - t2 * t2);
      const Eigen::Vector3d normal = Eigen::Vector3d(-slope * along[i].y(), slope * along[i].x(), 1).normalized();
      light = ggx_D(normal.dot(shading.h_face), w.scratches.alpha[i]) *
              smith_G(shading.cos_i, shading.cos_o, w.scratches.alpha[i]);
    }
    return light;
  }
};

// 140 grooves on 80 mm^2, whose widths, depths and roughnesses vary between `least` and its inverse, seen by 40 x 40
// pixels.
World crossing_grooves(unsigned seed, double least, double alpha, double focal_px, const Eigen::Vector3d& camera_mm) {
  World w = small_world(0);
  w.bench.bow_mm.setZero();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> where(6, 14), turn(0, 2 * std::numbers::pi), factor(least, 1 / least);
  for (int i = 0; i < 140; ++i) {
    const double a = turn(random), l = 4 * factor(random), x = where(random), y = where(random);
    w.scratches.x0_mm.push_back(x - l / 2 * std::cos(a));
    w.scratches.y0_mm.push_back(y - l / 2 * std::sin(a));
    w.scratches.x1_mm.push_back(x + l / 2 * std::cos(a));
    w.scratches.y1_mm.push_back(y + l / 2 * std::sin(a));
    w.scratches.width_um.push_back(400 * factor(random));
    w.scratches.depth_um.push_back(14 * factor(random));
    w.scratches.alpha.push_back(alpha * factor(random));
  }
  w.bench.lens.width = 40;
  w.bench.lens.height = 40;
  w.bench.lens.intrinsics = {focal_px, 0.98 * focal_px, 19.5, 20.5, -0.1, 0.05, 0.001, -0.001, 0, 0, 0, 0};
  View view;
  view.T_camera_board = looking_at(camera_mm, {10, 10, 0});
  w.camera = make_camera_view(w.bench, w.board, view, {0, 0, 40, 40});
  w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
  w.scene.ambient.setZero();
  return w;
}

TEST(LanesView, GroovesThatCrossShowTheLowestWalls) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const World w = crossing_grooves(seed, 0.8, 0.08, 700, {12, 26, 44});
    std::mt19937 random(seed);
    Image found;
    ViewRenderer(w.scene).forward(in_lanes(w, Crossings::deepest, 24), found);
    const PointLight light(w);
    const ViewPixels pixels = view_pixels(w.scene, 1);
    std::uniform_real_distribution<double> unit(0, 1);
    constexpr int kAcross = 24;
    double error2 = 0, sum2 = 0, sum = 0, found_sum = 0, noise2 = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const PixelShading& p = pixels.shading[i];
      const auto c = footprint_corners_mm(*w.scene.grid, static_cast<int>(i % 40), static_cast<int>(i / 40));
      std::array<double, 2> halves{};
      for (int v = 0; v < kAcross; ++v)
        for (int u = 0; u < kAcross; ++u) {
          const double a = (u + unit(random)) / kAcross, b = (v + unit(random)) / kAcross;
          const Eigen::Vector2d q = (1 - b) * ((1 - a) * c[0] + a * c[1]) + b * ((1 - a) * c[3] + a * c[2]);
          halves[(u + v) % 2] += light.at(q, p, p.base);
        }
      const double factor = channel_factors(w.scene, p.cos_ho, 1)[0] * p.direct,
                   expected = factor * (halves[0] + halves[1]) / (kAcross * kAcross),
                   noise = factor * (halves[0] - halves[1]) / (kAcross * kAcross);
      error2 += std::pow(found.data[i] - expected, 2);
      noise2 += noise * noise;
      sum2 += expected * expected;
      sum += expected;
      found_sum += found.data[i];
    }
    // Points of two halves differ by as much as their mean is off.
    EXPECT_LT(std::sqrt(error2 / sum2), 0.007 + std::sqrt(noise2 / sum2)) << "seed " << seed;
    EXPECT_NEAR(found_sum / sum, 1, 3e-3) << "seed " << seed;
  }
}

// A lobe as narrow as a lane meets walls near the rims, of which crossings leave less the nearer they are to the rim.
TEST(LanesView, FewLanesShowTheLightOfMany) {
  for (const unsigned seed : {1U, 2U, 3U})
    for (const double alpha : {0.03, 0.06}) {
      World w = crossing_grooves(seed, 1, alpha, 1700, {10, 100, 420});
      w.scene.light.position_mm = {10, 300, 400};
      const double slope = 0.4 + 0.2 * seed;
      for (std::size_t i = 0; i < w.scratches.size(); ++i) {
        const bool glints = i % 2 == 0;  // the others cross those that glint, and none lies along another
        const double y_mm = glints ? 6 + 0.058 * static_cast<double>(i) : 0.12 * static_cast<double>(i);
        w.scratches.x0_mm[i] = 6;
        w.scratches.x1_mm[i] = 14;
        w.scratches.y0_mm[i] = y_mm;
        w.scratches.y1_mm[i] = y_mm + (glints ? 0 : 8 * slope);
      }
      const auto light_of = [&](int lanes) {
        Image radiance;
        ViewRenderer(w.scene).forward(in_lanes(w, Crossings::deepest, lanes), radiance);
        return std::accumulate(radiance.data.begin(), radiance.data.end(), 0.0);
      };
      EXPECT_NEAR(light_of(16) / light_of(192), 1, 5e-5) << "seed " << seed << ", alpha " << alpha;
    }
}

}  // namespace
}  // namespace burin
