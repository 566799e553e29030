// tests/calib/small_grooves.h - a board of 60 mm with 500 grooves, seen from six places on both sides of the grooves'
// cut-off, one pixel to about 0.6 mm. For tests only.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>

#include "burin/calib/photo/machine_map.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

struct SmallGrooves {
  Board board;
  Bench bench;
  Sent sent;
  Problem data;  ///< without photos
  State truth;
};

/// Fills all but the views. Returns the random numbers that come next.
inline std::mt19937_64 fill_small_grooves(SmallGrooves& s, std::uint64_t seed) {
  s.board.size_mm << 60, 60;
  s.board.carve_min_mm << 5, 5;
  s.board.carve_max_mm << 55, 55;
  s.board.tool_width_um = 600;
  s.board.material.alpha = 0.08;
  s.board.material.depth_um = 18;
  s.bench.lens.model = "LENSMODEL_PINHOLE";
  s.bench.lens.intrinsics = {300, 300, 59.5, 59.5};
  s.bench.lens.width = s.bench.lens.height = 120;
  s.bench.lights.resize(1);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(8, 52), turn(0, std::numbers::pi);
  for (int i = 0; i < 500; ++i) {
    const double x = place(random), y = place(random), a = turn(random);
    s.sent.scratches.x0_mm.push_back(x - 2 * std::cos(a));
    s.sent.scratches.y0_mm.push_back(y - 2 * std::sin(a));
    s.sent.scratches.x1_mm.push_back(x + 2 * std::cos(a));
    s.sent.scratches.y1_mm.push_back(y + 2 * std::sin(a));
  }
  Problem& data = s.data;
  data.model.board = &s.board;
  data.model.sent = &s.sent;
  data.model.center_mm << 30, 30;
  data.model.f0 = s.board.material.f0.mean();
  data.is_spot = {false};
  s.truth.lamps.resize(1);
  s.truth.shared[unknown::log_alpha] = std::log(0.08);
  s.truth.shared[unknown::log_depth] = std::log(18);
  s.truth.shared[unknown::log_base_alpha] = std::log(0.2);
  put_machine_map({}, s.truth.shared);
  s.truth.shared[unknown::log_blur] = std::log(0.7);
  s.truth.lamps[0] = {30, -90, 220, std::log(4e4), 30, 30, 0};
  return random;
}

/// Adds the next of the six views to the bench; its photo is black, with a sigma of 1.
inline LightView add_view(SmallGrooves& s, int k) {
  View view;
  view.name = "v" + std::to_string(k);
  const double azimuth = 1.1 * k, lean = 0.12 + 0.13 * k;
  const Eigen::Vector3d eye =
      Eigen::Vector3d(30, 30, 0) +
      190 * Eigen::Vector3d(std::sin(lean) * std::cos(azimuth), std::sin(lean) * std::sin(azimuth), std::cos(lean));
  const Eigen::Vector3d forward = (Eigen::Vector3d(30, 30, 0) - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitY()).normalized();
  view.T_camera_board.linear() << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  view.T_camera_board.translation() = -(view.T_camera_board.linear() * eye);
  s.bench.views.push_back(view);
  LightView v;
  v.merged = v.view = static_cast<std::size_t>(k);
  v.lens = s.bench.lens;
  v.window = {0, 0, 120, 120};
  v.value = Image(120, 120, 1);
  v.sigma = Image(120, 120, 1, 1);
  v.valid.assign(120 * 120, 1);
  return v;
}

}  // namespace burin
