// What a groove sends under surroundings against a renderer that is not ours: Mitsuba 3, by
// tests/data/mitsuba/make_groove.py.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "burin/base/files/table.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/far_light.h"
#include "burin/scene/groove.h"
#include "tests/places.h"

namespace burin {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// The two windows of make_groove.py; their edges fall between pixels.
std::shared_ptr<const Panorama> two_windows() {
  Image picture(720, 360, 3, 0.0F);
  const auto paint = [&](int from, int to, int above, int below, const std::array<float, 3>& color) {
    for (int y = 2 * above; y < 2 * below; ++y)
      for (int x = 2 * from; x < 2 * to; ++x)
        for (int c = 0; c < 3; ++c) picture.at(x, y, c) = color[c];
  };
  paint(250, 272, 20, 50, {9, 8, 7});
  paint(60, 100, 10, 40, {1.5F, 2, 3});
  return make_panorama(std::move(picture), {}, "two windows");
}

struct MitsubaRow {
  double width_um, depth_um, alpha, eye_azimuth_deg, eye_polar_deg;
  std::array<double, 3> light;
  double sigma;
};

std::vector<MitsubaRow> mitsuba_rows() {
  const std::vector<std::string> columns{"width_um", "depth_um", "alpha", "eye_azimuth_deg", "eye_polar_deg", "r",
                                         "g",        "b",        "sigma"};
  TableReader table(std::filesystem::path(places::data()) / "mitsuba" / "groove.csv", TableStyle::csv, columns, "");
  std::vector<MitsubaRow> rows;
  while (table.next()) {
    const auto v = [&](std::size_t k) { return table.number(*table.find(columns[k])); };
    rows.push_back({v(0), v(1), v(2), v(3), v(4), {v(5), v(6), v(7)}, v(8)});
  }
  return rows;
}

// One pixel as wide as the groove that runs along y, seen from far away.
Image seen_groove(const MitsubaRow& row, const std::shared_ptr<const Panorama>& windows) {
  const double half_mm = 1e-3 * half_width_um(row.width_um, row.depth_um), a = row.eye_azimuth_deg * kDegree,
               p = row.eye_polar_deg * kDegree;
  const Eigen::Vector3d middle(30, 24, 0), to_eye(std::sin(p) * std::cos(a), std::sin(p) * std::sin(a), std::cos(p));
  ViewScene scene;
  scene.grid = share(board_grid({middle.x() - half_mm, middle.y() - 0.5}, {middle.x() + half_mm, middle.y() + 0.5}, 1,
                                1, Surface{{60, 48}, {0, 0, 0}}));
  scene.camera_center_mm = middle + 1e5 * to_eye;
  scene.light = surroundings_light(windows);
  scene.tool_width_um = row.width_um;
  scene.material.alpha = row.alpha;
  scene.material.depth_um = row.depth_um;
  scene.material.f0 = {1, 1, 1};
  Carved carved;
  carved.scratches = {{middle.x()}, {middle.y() - 5}, {middle.x()}, {middle.y() + 5}, {}, {}, {}};
  Image light;
  ViewRenderer(std::move(scene), {3}).forward(carved, light);
  return light;
}

// The paper takes the plain face's area and shadowing for a wall's (docs/model.md 5): a wall of lean l sends 1 / cos l
// times as much, so that what is missing lies between nothing and that of the steepest wall. Beside that 1.5 %, what
// Smith's term changes by a wall's lean at these angles, and four sigmas of Mitsuba's own noise.
TEST(MitsubaGroove, SendsWhatAnotherRendererSaysUnderSurroundings) {
  const auto windows = two_windows();
  const std::vector<MitsubaRow> rows = mitsuba_rows();
  ASSERT_EQ(rows.size(), 30U);
  for (const MitsubaRow& row : rows) {
    const Image ours = seen_groove(row, windows);
    const double steepest = 2 * std::atan(2 * half_width_um(row.width_um, row.depth_um) / row.width_um);
    for (int c = 0; c < 3; ++c) {
      const double noise = 0.015 + 4 * row.sigma / row.light[c], ratio = row.light[c] / ours.at(0, 0, c);
      SCOPED_TRACE("depth " + std::to_string(row.depth_um) + ", alpha " + std::to_string(row.alpha) + ", eye " +
                   std::to_string(row.eye_azimuth_deg) + " " + std::to_string(row.eye_polar_deg) + ", channel " +
                   std::to_string(c) + ", ratio " + std::to_string(ratio));
      EXPECT_GT(ratio, 1 - noise);
      EXPECT_LT(ratio, (1 + noise) / std::cos(steepest));
    }
  }
}

}  // namespace
}  // namespace burin
