// tests/optimize/color_rig.h - a small design in color that tests begin with.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/optimize/design.h"
#include "burin/optimize/design/design_start.h"
#include "burin/optimize/design/design_views.h"
#include "tests/temporary_folder.h"

namespace burin {

/// Three discs in red, green and blue that overlap, on dark gray.
inline Image discs(int size) {
  Image image(size, size, 3, 0.25F);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      for (int c = 0; c < 3; ++c) {
        const double turn = 2 * std::numbers::pi * c / 3;
        const double u = (x + 0.5) / size - 0.5 - 0.18 * std::cos(turn),
                     v = (y + 0.5) / size - 0.5 - 0.18 * std::sin(turn);
        if (std::hypot(u, v) < 0.25) image.at(x, y, c) = 0.8F;
      }
  return image;
}

/// A board of 60 x 60 mm, an eye above it and three lamps: a view in color of the discs.
class ColorRig : public testing::Test {
 protected:
  void SetUp() override {
    board_.size_mm = {60, 60};
    board_.carve_min_mm = {5, 5};
    board_.carve_max_mm = {55, 55};
    board_.tool_width_um = 200;
    board_.material.alpha = 0.05;
    board_.material.depth_um = 14;
    board_.material.base_alpha = 0.06;
    board_.material.f0 = {0.95, 0.85, 0.6};  // the metal has a color of its own
    bench_.material = board_.material;
    View view;
    view.name = "front";
    Eigen::Matrix3d R;
    R << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    view.T_camera_board.linear() = R;
    view.T_camera_board.translation() = -R * Eigen::Vector3d(30, -100, 600);
    bench_.views = {view};
    // Half vectors 24 degrees from the normal, towards 90, 150 and 30 degrees.
    lamp("red", {30, 594, 273}, {1, 0, 0});
    lamp("green", {-321, 417, 330}, {0, 1, 0});
    lamp("blue", {381, 417, 330}, {0, 0, 1});
    DesignView v{"front", "red + green + blue", {}, 1};
    v.color = true;
    v.target.image = discs(64);
    spec_.views = {v};
    spec_.scratches = 2000;
    options_.pixels = 64;
    options_.iterations = 20;
  }
  void lamp(const std::string& id, const Eigen::Vector3d& at_mm, const Eigen::Vector3d& color) {
    Light light;
    light.id = id;
    light.position_mm = at_mm;
    light.intensity = color;
    bench_.lights.push_back(light);
  }
  /// All lamps' half vectors 24 degrees from the normal, so far apart.
  void set_apart(double degrees) {
    const Eigen::Vector3d middle(30, 30, 0), eye = (Eigen::Vector3d(30, -100, 600) - middle).normalized();
    for (const int k : {0, 1, 2}) {
      const double lean = 24 * std::numbers::pi / 180, towards = (90 + (k - 1) * degrees) * std::numbers::pi / 180;
      const Eigen::Vector3d h(std::sin(lean) * std::cos(towards), std::sin(lean) * std::sin(towards), std::cos(lean));
      bench_.lights[static_cast<std::size_t>(k)].position_mm = middle + 640 * (2 * h.dot(eye) * h - eye);
    }
  }
  void mix_lamps() {
    bench_.lights[0].intensity = {1, 0.3, 0.2};
    bench_.lights[1].intensity = {0.2, 1, 0.3};
    bench_.lights[2].intensity = {0.1, 0.3, 1};
  }
  /// Each has so much of its light in its own channel, the rest in the other two.
  void set_purity(double own) {
    for (const int k : {0, 1, 2}) {
      bench_.lights[static_cast<std::size_t>(k)].intensity.setConstant((1 - own) / 2);
      bench_.lights[static_cast<std::size_t>(k)].intensity[k] = own;
    }
  }
  std::string error_of() {
    try {
      design(spec_, board_, bench_, options_, {});
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }
  std::vector<WorkView> views() {
    std::vector<Finding> findings;
    return prepare_views(spec_, board_, bench_, options_, options_.pixels, design_limits(board_, bench_, options_),
                         findings);
  }

  TemporaryFolder folder_;
  Board board_;
  Bench bench_;
  DesignSpec spec_;
  DesignOptions options_;
};

}  // namespace burin
