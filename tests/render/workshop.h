// Benches drawn at random, as they could stand in a workshop.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "burin/scene/groove.h"
#include "tests/render/small_world.h"

namespace burin {

struct Draw {
  std::mt19937 random;
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); }
  double decades(double a, double b) { return std::pow(10, uniform(a, b)); }
  bool chance(double p) { return uniform(0, 1) < p; }
  /// A place above the board's middle, `elevation` from the face, some board sizes away.
  Eigen::Vector3d above(double size_mm, double low_deg) {
    const double e = uniform(low_deg, 88) * std::numbers::pi / 180, a = uniform(0, 2 * std::numbers::pi),
                 r = size_mm * uniform(1.5, 6);
    return {0.5 * size_mm + r * std::cos(e) * std::cos(a), 0.5 * size_mm + r * std::cos(e) * std::sin(a),
            r * std::sin(e)};
  }
};

/// A bench that could stand in a workshop: boards of 20 to 400 mm, pictures laid on the board or seen through a
/// distorting lens, tools of 25 to 800 um, grooves shallow and deep, pixels from a third of the groove to 40 of it,
/// alpha 0.02 to 0.3, lamps bare and spots.
inline World workshop(unsigned seed, int count) {
  Draw draw{std::mt19937(seed)};
  World w;
  const double size = draw.decades(1.3, 2.6);
  w.board.size_mm = {size, size};
  w.board.tool_width_um = 25 * std::pow(32.0, draw.uniform(0, 1));
  const double wt = w.board.tool_width_um;
  w.bench.material = {
      0.02 * std::pow(15, draw.uniform(0, 1)), wt * draw.decades(-1.5, 0), draw.uniform(0.08, 0.4), {0.91, 0.92, 0.6}};
  const double groove_mm = 2e-3 * half_width_um(wt, w.bench.material.depth_um);
  if (draw.chance(0.5)) w.bench.ambient = {0.001, 0.002, 0.003};
  Light lamp;
  lamp.position_mm = draw.above(size, 15);
  lamp.intensity = Eigen::Vector3d(900, 800, 700) * lamp.position_mm.squaredNorm() / 2000;
  const Eigen::Vector3d middle(size / 2, size / 2, 0);
  lamp.axis = (middle - lamp.position_mm).normalized();
  lamp.falloff_exponent = draw.chance(0.5) ? draw.uniform(0.5, 6) : 0;
  w.bench.lights = {lamp};
  View view;
  const Eigen::Vector3d eye = draw.above(size, 20);
  view.T_camera_board = looking_at(eye, middle);
  constexpr int kWidth = 56, kHeight = 41;
  const double seen = std::min(size, kWidth * groove_mm * draw.decades(-0.5, 1.6));
  const bool on_board = draw.chance(0.4);
  w.bench.lens.width = kWidth;
  w.bench.lens.height = kHeight;
  const double f = kWidth * (eye - middle).norm() / seen;
  w.bench.lens.intrinsics = {
      f, f, 0.5 * kWidth, 0.5 * kHeight, -0.1 * draw.uniform(0, 1) * f / kWidth * f / kWidth, 0, 0.001, -0.001, 0, 0,
      0, 0};
  if (draw.chance(0.5)) w.bench.bow_mm = 1e-3 * size * Eigen::Vector3d(1, -0.6, 0.5);
  w.camera = make_camera_view(w.bench, w.board, view, {0, 0, kWidth, kHeight});
  w.scene = make_scene(w.bench, w.board, w.camera, lamp);
  if (on_board) {
    const Eigen::Vector2d low = middle.head<2>().array() - 0.5 * seen, high = middle.head<2>().array() + 0.5 * seen;
    w.scene.grid = share(board_grid(low, high, kWidth, kHeight, {w.board.size_mm, w.bench.bow_mm}));
    w.scene.camera_center_mm = eye;
  }
  const bool own = draw.chance(0.5);
  for (int i = 0; i < count; ++i) {
    const double a = i % 8 == 0 ? std::numbers::pi / 2 * (i / 8 % 4) : draw.uniform(0, 2 * std::numbers::pi);
    const double l = seen * draw.decades(-2.5, 0);
    const Eigen::Vector2d p =
        middle.head<2>() + seen * Eigen::Vector2d(draw.uniform(-0.6, 0.6), draw.uniform(-0.5, 0.5));
    w.scratches.x0_mm.push_back(p.x() - 0.5 * l * std::cos(a));
    w.scratches.y0_mm.push_back(p.y() - 0.5 * l * std::sin(a));
    w.scratches.x1_mm.push_back(p.x() + 0.5 * l * std::cos(a));
    w.scratches.y1_mm.push_back(p.y() + 0.5 * l * std::sin(a));
    if (!own) continue;
    w.scratches.width_um.push_back(wt * draw.uniform(0.8, 1.2));
    w.scratches.depth_um.push_back(w.bench.material.depth_um * draw.uniform(0.7, 1.4));
    w.scratches.alpha.push_back(std::max(0.02, w.bench.material.alpha * draw.uniform(0.8, 1.25)));
  }
  return w;
}

}  // namespace burin
