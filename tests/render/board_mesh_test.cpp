// What boards given as a mesh promise: the same footprints as the closed surfaces they approximate, uv that carry
// scratches along, what hides what, and broken files refused by name. Oracles: camera_grid of flat and bowed surfaces
// (another code path, no rays), a cylinder worked out by hand, shadows found from similar triangles.
#include "burin/scene/board_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>

#include "burin/base/error.h"
#include "burin/render/view_renderer.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kWidth_mm = 300, kHeight_mm = 200;

struct Placed {
  Eigen::Vector3d position, normal;
};

/// n x n quads over the board, each two triangles, at `place(x, y)`; with that normal, or none.
TriangleMesh sheet(int n, const std::function<Placed(double, double)>& place, bool normals) {
  TriangleMesh m;
  const auto uv = [&](int i, int j) { return Eigen::Vector2d(double(i) / n, double(j) / n); };
  const auto at = [&](int i, int j) { return place(uv(i, j).x() * kWidth_mm, uv(i, j).y() * kHeight_mm); };
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) m.position_mm.push_back(at(i, j).position);
  }
  const auto add = [&](std::array<std::array<int, 2>, 3> ij) {
    auto& t = m.triangle.emplace_back();
    auto& u = m.uv.emplace_back();
    for (int k = 0; k < 3; ++k) {
      t[k] = std::uint32_t(ij[k][1] * (n + 1) + ij[k][0]);
      u[k] = uv(ij[k][0], ij[k][1]);
    }
    if (!normals) return;
    auto& v = m.normal.emplace_back();
    for (int k = 0; k < 3; ++k) v[k] = at(ij[k][0], ij[k][1]).normal;
  };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}});
      add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}});
    }
  }
  return m;
}

TriangleMesh surface_sheet(int n, const Surface& s, bool normals) {
  return sheet(
      n,
      [&](double x, double y) {
        return Placed{{x, y, height_mm(s, x, y)}, face_normal(s, x, y)};
      },
      normals);
}

/// A camera that looks at the board's middle from `center_mm`, x of the photo level.
Eigen::Isometry3d look_at(const Eigen::Vector3d& center_mm, const Eigen::Vector3d& at_mm) {
  const Eigen::Vector3d z = (at_mm - center_mm).normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear().row(0) = x;
  T.linear().row(1) = z.cross(x);
  T.linear().row(2) = z;
  T.translation() = -T.linear() * center_mm;
  return T;
}

Lens lens() {
  Lens l;
  l.model = "LENSMODEL_OPENCV4";
  l.intrinsics = {1000, 1000, 199.5, 149.5, -0.1, 0.05, 1e-3, -5e-4};
  l.width = 400;
  l.height = 300;
  return l;
}

const Eigen::Vector2d kSize(kWidth_mm, kHeight_mm);
const Eigen::Vector3d kMiddle(150, 100, 0);
const PixelWindow kWindow{50, 40, 300, 220};

struct Difference {
  double corner_mm = 0, center_mm = 0, normal = 0;
  int both = 0, one = 0;  // corners on the face in both grids; in one only
};

Difference difference(const FootprintGrid& a, const FootprintGrid& b) {
  Difference d;
  for (std::size_t i = 0; i < a.corner_x_mm.size(); ++i) {
    const bool in_a = std::isfinite(a.corner_x_mm[i]), in_b = std::isfinite(b.corner_x_mm[i]);
    d.both += in_a && in_b;
    d.one += in_a != in_b;
    if (in_a && in_b) {
      d.corner_mm =
          std::max(d.corner_mm, std::hypot(a.corner_x_mm[i] - b.corner_x_mm[i], a.corner_y_mm[i] - b.corner_y_mm[i]));
    }
  }
  for (std::size_t i = 0; i < a.center_mm.size(); ++i) {
    if (!a.center_mm[i].allFinite() || !b.center_mm[i].allFinite()) continue;
    d.center_mm = std::max(d.center_mm, (a.center_mm[i] - b.center_mm[i]).norm());
    d.normal = std::max(d.normal, (a.normal[i] - b.normal[i]).norm());
  }
  return d;
}

// Proves that a flat mesh is a flat board, through a distorting lens, to double precision: Embree's float rays choose
// the triangle, nothing more.
TEST(BoardMesh, FlatMeshIsAFlatBoard) {
  const Surface flat{kSize, {0, 0, 0}};
  const BoardMesh mesh(surface_sheet(7, flat, false), kSize, "flat");
  for (const Eigen::Vector3d& from : {Eigen::Vector3d(150, 99, 700), {-300, -400, 500}, {600, 100, 250}}) {
    const auto T = look_at(from, kMiddle);
    const auto d = difference(camera_grid(lens(), T, mesh, kWindow), camera_grid(lens(), T, flat, kWindow));
    EXPECT_GT(d.both, 20000);
    EXPECT_LE(d.one, 4);  // corners within rounding of the rim
    EXPECT_LT(d.corner_mm, 1e-9);
    EXPECT_LT(d.center_mm, 1e-9);
    EXPECT_LT(d.normal, 1e-12);
  }
  const auto a = board_grid({30, 20}, {270, 180}, 12, 8, mesh), b = board_grid({30, 20}, {270, 180}, 12, 8, flat);
  const auto d = difference(a, b);
  EXPECT_EQ(d.both, 13 * 9);
  EXPECT_EQ(d.one, 0);
  EXPECT_LT(d.corner_mm + d.center_mm + d.normal, 1e-11);
}

// Proves that a bowed mesh is the bow polynomial, and gets there as facets shrink: four times closer for each halving.
TEST(BoardMesh, BowedMeshIsTheBowPolynomial) {
  const Surface bowed{kSize, {1.5, -0.4, 0.8}};
  const auto T = look_at({-100, -350, 500}, kMiddle);
  const auto exact = camera_grid(lens(), T, bowed, kWindow);
  double before = 0;
  for (const int n : {20, 40, 80}) {
    for (const bool normals : {true, false}) {
      const BoardMesh mesh(surface_sheet(n, bowed, normals), kSize, "bowed");
      const auto d = difference(camera_grid(lens(), T, mesh, kWindow), exact);
      EXPECT_GT(d.both, 15000);
      // A facet of edge a lies at most a^2 k / 8 off a surface of curvature k: 300 / n mm, 1.5 * 2 / 150^2 per mm, both
      // ways and along the diagonal; the view is oblique.
      const double sagitta_mm = std::pow(300.0 / n, 2) * (2 * 1.5 / (150 * 150) + 2 * 0.8 / (100 * 100)) / 8 * 2;
      EXPECT_LT(d.center_mm, 2 * sagitta_mm);
      EXPECT_LT(d.corner_mm, 3 * sagitta_mm);
      EXPECT_LT(d.normal, normals ? 2e-3 / n : 2.0 / n * 0.05);  // without vn, one-sided at the rim
      if (!normals) continue;
      if (before > 0) {
        EXPECT_NEAR(before / d.corner_mm, 4, 0.8);
      }
      before = d.corner_mm;
    }
  }
}

// Proves uv on a face that no polynomial describes: a sheet rolled into a half cylinder, its uv the arc length. A ray
// from the axis's side at a known angle meets it at radius * angle.
TEST(BoardMesh, RolledSheetKeepsArcLength) {
  const double radius = kWidth_mm / std::numbers::pi;  // half a turn
  const auto roll = [&](double x, double y) {
    const double angle = x / radius - 1.57079632679489661923;  // -90 .. 90 degrees from the top
    const Eigen::Vector3d n(std::sin(angle), 0, std::cos(angle));
    return Placed{Eigen::Vector3d(150, y, 0) + radius * n, n};
  };
  const BoardMesh mesh(sheet(400, roll, true), kSize, "rolled");
  for (const double degrees : {-80.0, -33.0, 0.0, 12.5, 77.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    const Eigen::Vector3d n(std::sin(angle), 0, std::cos(angle));
    const auto hit = mesh.first_hit(Eigen::Vector3d(150, 60, 0) + 400 * n, -n);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->board_mm.x(), radius * (angle + 1.57079632679489661923), 2e-3);
    EXPECT_NEAR(hit->board_mm.y(), 60, 1e-9);
    EXPECT_LT((hit->normal - n).norm(), 1e-5);
    const auto place = mesh.place(hit->board_mm);
    ASSERT_TRUE(place);
    EXPECT_LT((place->position_mm - hit->position_mm).norm(), 1e-9);
  }
  // From outside the back is never seen; from the axis nothing but backs.
  EXPECT_FALSE(mesh.first_hit({150, 60, 0}, {0.3, 0, 1}));
  // A camera on the right sees no further than where its rays are tangents: cos(angle) = radius / distance, and what
  // lies beyond is hidden by the sheet itself.
  const double distance =
      1200;  // a pixel is 1.2 mm across the sight line there: the last one starts up to sqrt(2 * 1.2 * radius) short
  const auto grid = camera_grid(lens(), look_at({150 + distance, 99, 0}, {150, 100, 0}), mesh, {0, 0, 400, 300});
  double least_x = 1e9;
  for (const double x : grid.corner_x_mm) {
    if (std::isfinite(x)) least_x = std::min(least_x, x);
  }
  const double horizon = radius * (std::numbers::pi - std::acos(radius / distance));
  EXPECT_GT(least_x, horizon - 0.5);
  EXPECT_LT(least_x, horizon + 20);
  EXPECT_TRUE(
      mesh.hidden_from({150 + distance, 100, 0}, roll(horizon - 5, 100).position, roll(horizon - 5, 100).normal));
  EXPECT_FALSE(
      mesh.hidden_from({150 + distance, 100, 0}, roll(horizon + 5, 100).position, roll(horizon + 5, 100).normal));
}

/// A square plate at height z, x0 .. x1, y0 .. y1, facing anywhere.
TriangleMesh plate(double x0, double y0, double x1, double y1, double z) {
  TriangleMesh m;
  m.position_mm = {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
  m.triangle = {{0, 1, 2}, {0, 3, 2}};
  return m;
}

// Proves what an occluder hides, from the camera and from the lamp, against its shadow by similar triangles; and that a
// mesh hides itself: the far wall of a valley from a low lamp.
TEST(BoardMesh, OccludersAndSelfShadow) {
  const Surface flat{kSize, {0, 0, 0}};
  const std::vector<TriangleMesh> occluders{plate(100, 80, 140, 130, 50)};
  const BoardMesh open(surface_sheet(3, flat, false), kSize, "flat");
  const BoardMesh mesh(surface_sheet(3, flat, false), kSize, "flat", occluders);
  const Eigen::Vector3d lamp(400, 100, 300);
  int dark = 0, wrong = 0;
  for (double x = 5; x < 300; x += 2.3) {
    for (double y = 5; y < 200; y += 2.1) {
      // Where the segment from (x, y, 0) to the lamp passes z = 50:
      const Eigen::Vector2d at = Eigen::Vector2d(x, y) + (lamp.head<2>() - Eigen::Vector2d(x, y)) * (50 / lamp.z());
      const bool hidden = at.x() > 100 && at.x() < 140 && at.y() > 80 && at.y() < 130;
      const double to_rim =
          std::min({std::abs(at.x() - 100), std::abs(at.x() - 140), std::abs(at.y() - 80), std::abs(at.y() - 130)});
      if (to_rim < 0.1) continue;
      dark += hidden;
      wrong += mesh.hidden_from(lamp, {x, y, 0}, {0, 0, 1}) != hidden;
      wrong += open.hidden_from(lamp, {x, y, 0}, {0, 0, 1});
    }
  }
  EXPECT_GT(dark, 100);
  EXPECT_EQ(wrong, 0);
  EXPECT_TRUE(open.hidden_from({150, 100, -10}, {150, 100, 0}, {0, 0, 1})) << "a lamp behind the face";

  // The camera: no footprint touches the plate's shadow seen from it.
  const Eigen::Vector3d camera(150, 99, 700);
  const auto T = look_at(camera, kMiddle);
  const auto seen = camera_grid(lens(), T, mesh, kWindow), all = camera_grid(lens(), T, open, kWindow);
  int lost = 0;
  for (int r = 0; r < seen.height(); ++r) {
    for (int c = 0; c < seen.width(); ++c) {
      const auto q = footprint_corners_mm(all, c, r);
      const Eigen::Vector2d middle = 0.25 * (q[0] + q[1] + q[2] + q[3]);
      if (!middle.allFinite()) continue;
      const Eigen::Vector2d at = middle + (camera.head<2>() - middle) * (50 / camera.z());
      const bool behind = at.x() > 100 && at.x() < 140 && at.y() > 80 && at.y() < 130;
      const bool near_rim = at.x() > 97 && at.x() < 143 && at.y() > 77 && at.y() < 133;  // 3 mm: over two pixels
      const auto got = footprint_corners_mm(seen, c, r);
      const bool finite = (got[0] + got[1] + got[2] + got[3]).allFinite();
      if (behind) {
        EXPECT_FALSE(finite);
        ++lost;
      } else if (!near_rim) {
        EXPECT_TRUE(finite);
        for (int k = 0; k < 4; ++k) EXPECT_EQ(got[k], q[k]);
      }
    }
  }
  EXPECT_GT(lost, 500);
  const auto hidden = hidden_pixels(all, mesh, lamp);
  const auto lit = hidden_pixels(all, open, lamp);
  EXPECT_GT(std::count(hidden.begin(), hidden.end(), 1), std::count(lit.begin(), lit.end(), 1) + 500);

  const auto valley = [](double x, double y) {
    const double z = std::abs(x - 150);  // 45 degrees down and up again
    return Placed{{x, y, z}, Eigen::Vector3d(x < 150 ? 1 : -1, 0, 1).normalized()};
  };
  const BoardMesh v(sheet(2, valley, false), kSize, "valley");
  const Eigen::Vector3d low_lamp(500, 100,
                                 200);  // seen from the left wall's foot above the right wall's edge (300, 150)
  // From (150 - a, z = a): the sight line over the edge (300, 150) has slope (150 - a) / (150 + a) = 50 / 200 -> a
  // = 90.
  EXPECT_TRUE(v.hidden_from(low_lamp, {150 - 80, 100, 80}, Eigen::Vector3d(1, 0, 1).normalized()));
  EXPECT_FALSE(v.hidden_from(low_lamp, {150 - 100, 100, 100}, Eigen::Vector3d(1, 0, 1).normalized()));
}

// Proves that no pair of pixel and scratch is missed where pixels do not map to the board by anything smooth: a sheet
// in waves steep enough to hide parts of itself, with an occluder before it, against all pairs.
TEST(BoardMesh, PairsOnFoldedFacesAreFound) {
  const auto waves = [](double x, double y) {
    const double phase = x / 12, slope = 1.5 * std::cos(phase);
    return Placed{{x, y, 18 * std::sin(phase)}, Eigen::Vector3d(-slope, 0, 1).normalized()};
  };
  const std::vector<TriangleMesh> occluders{plate(100, 80, 140, 130, 50)};
  const BoardMesh mesh(sheet(150, waves, true), kSize, "waves", occluders);
  const auto T = look_at({-500, -200, 450}, kMiddle);
  Lens pinhole = lens();
  pinhole.intrinsics[0] = pinhole.intrinsics[1] = 150;
  pinhole.intrinsics[2] = 39.5;
  pinhole.intrinsics[3] = 29.5;
  pinhole.width = 80;
  pinhole.height = 60;
  ViewScene scene;
  scene.grid = share(camera_grid(pinhole, T, mesh, {0, 0, 80, 60}));
  scene.camera_center_mm = T.inverse().translation();
  scene.light.position_mm = {300, 500, 800};
  scene.material.alpha = 0.3;
  scene.hidden_from_light = hidden_pixels(*scene.grid, mesh, scene.light.position_mm);
  Scratches scratches;
  for (int i = 0; i < 150; ++i) {
    const double x = std::fmod(i * 61.803398875, 280) + 10, y = std::fmod(i * 37.37, 180) + 10, a = i * 0.7;
    scratches.x0_mm.push_back(x);
    scratches.y0_mm.push_back(y);
    scratches.x1_mm.push_back(x + 25 * std::cos(a));
    scratches.y1_mm.push_back(y + 25 * std::sin(a));
  }
  const Image all = render_brute_force(scene, in_metal(scratches));
  Image found, fast;
  ViewRenderer(scene, {1, true}).forward(in_metal(scratches), found);
  ViewRenderer(scene, {1, false}).forward(in_metal(scratches), fast);
  const float most = *std::max_element(all.data.begin(), all.data.end());
  EXPECT_GT(most, 0);
  int dark = 0;
  for (std::size_t i = 0; i < all.data.size(); ++i) {
    EXPECT_NEAR(found.data[i], all.data[i], 1e-6 * most);
    EXPECT_NEAR(fast.data[i], all.data[i], 1e-5 * most);
    dark += all.data[i] == 0;
  }
  EXPECT_LT(dark, 80 * 60 * 9 / 10);
}

class BoardMeshFiles : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) { return folder_.write("mesh.obj", text); }

  std::string message(const std::string& text) {
    try {
      const auto file = write(text);
      BoardMesh(read_obj(file), kSize, file.string());
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  }

  TemporaryFolder folder_;
};

const std::string kQuad =
    "# a flat board\nmtllib none.mtl\no board\nv 0 0 0\nv 300 0 0\nv 300 200 0\nv 0 200 0\nvt 0 0\nvt 1 0\nvt 1 1 "
    "0\nvt 0 1\n";

// Proves that a bench whose board names a mesh is rendered through it: a bowed face given as a mesh looks as the bow
// polynomial does, and pixels that the lamp does not reach keep only what the room sends.
TEST_F(BoardMeshFiles, BenchesRenderThroughTheMesh) {
  const Surface bowed{kSize, {0.3, 0.1, -0.2}};
  const TriangleMesh m = surface_sheet(60, bowed, true);
  std::string text;
  char line[200];
  for (const auto& p : m.position_mm) {
    std::snprintf(line, sizeof line, "v %.12g %.12g %.12g\n", p.x(), p.y(), p.z());
    text += line;
  }
  for (std::size_t i = 0; i < m.triangle.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      std::snprintf(line, sizeof line, "vt %.12g %.12g\nvn %.12g %.12g %.12g\n", m.uv[i][k].x(), m.uv[i][k].y(),
                    m.normal[i][k].x(), m.normal[i][k].y(), m.normal[i][k].z());
      text += line;
    }
    text += "f";
    for (int k = 0; k < 3; ++k) {
      const std::string corner = std::to_string(3 * i + k + 1);
      text += " " + std::to_string(m.triangle[i][k] + 1) + "/" + corner + "/" + corner;
    }
    text += "\n";
  }
  Board board;
  board.size_mm = kSize;
  Bench bench;
  bench.lens = lens();
  bench.bow_mm = bowed.bow_mm;
  bench.material.alpha = 0.1;
  bench.ambient = {1e-7, 1e-7, 1e-7};
  Light lamp;
  lamp.position_mm = {150, 500, 600};
  View view;
  view.T_camera_board = look_at({150, -300, 700}, kMiddle);
  const auto camera = make_camera_view(bench, board, view, {100, 80, 160, 120});
  Scratches scratches;
  for (int i = 0; i < 2000; ++i) {
    const double x = 100 + std::fmod(i * 61.803398875, 100), y = 50 + std::fmod(i * 17.37, 100), a = 0.3 * (i % 7 - 3);
    scratches.x0_mm.push_back(x);
    scratches.y0_mm.push_back(y);
    scratches.x1_mm.push_back(x + 6 * std::cos(a));
    scratches.y1_mm.push_back(y + 6 * std::sin(a));
  }
  Image by_bow, by_mesh, in_shadow;
  ViewRenderer(make_scene(bench, board, camera, lamp), {1, true}).forward(in_metal(scratches), by_bow);
  board.mesh = write(text);
  ViewScene scene = make_scene(bench, board, camera, lamp);
  EXPECT_EQ(scene.hidden_from_light.size(), 160u * 120u);
  ViewRenderer(scene, {1, true}).forward(in_metal(scratches), by_mesh);
  double sum = 0, difference = 0;
  for (std::size_t i = 0; i < by_bow.data.size(); ++i) {
    sum += std::pow(by_bow.data[i], 2);
    difference += std::pow(by_bow.data[i] - by_mesh.data[i], 2);
  }
  EXPECT_GT(sum, 0);
  // Facets of 5 mm move footprints by up to 1e-3 mm, a thousandth of a pixel.
  EXPECT_LT(std::sqrt(difference / sum), 3e-3);

  scene.hidden_from_light.assign(160 * 120, 1);
  for (const bool use_double : {true, false}) {
    ViewRenderer(scene, {1, use_double}).forward(in_metal(scratches), in_shadow);
    for (const float v : in_shadow.data) EXPECT_LE(v, 1.0001e-7);
    EXPECT_GT(*std::max_element(in_shadow.data.begin(), in_shadow.data.end()), 0.9e-7);
  }
  scene.hidden_from_light.resize(5);
  EXPECT_THROW(ViewRenderer(scene, {1, true}), Error);
}

// Proves that what modeling programs write is read: polygons, negative indices, normals or none.
TEST_F(BoardMeshFiles, ReadsObj) {
  for (const std::string face :
       {"f 1/1 2/2 3/3 4/4", "f -4/-4 -3/-3 -2/-2 -1/-1", "vn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1",
        "f 1/1 2/2 3/3\ns off\nf 1/1 3/3 4/4 # the rest", "f 1/1 2/2 3/3 4/4\nf 1/1 1/1 2/2"}) {
    const auto m = read_obj(write(kQuad + face + "\n"));
    ASSERT_EQ(m.triangle.size(), 2u) << face;
    EXPECT_EQ(m.normal.empty(), face.find("vn") == std::string::npos);
    const BoardMesh mesh(m, kSize, "quad");
    const auto hit = mesh.first_hit({60, 150, 100}, {0, 0, -1});
    ASSERT_TRUE(hit);
    EXPECT_LT((hit->board_mm - Eigen::Vector2d(60, 150)).norm(), 1e-10);
    EXPECT_LT((hit->normal - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12);
  }
}

// Proves that a mesh that cannot serve is refused, with file, line and remedy.
TEST_F(BoardMeshFiles, RefusesBrokenMeshes) {
  EXPECT_THAT(message(kQuad + "f 1 2 3 4\n"),
              AllOf(HasSubstr(".obj"), HasSubstr("no uv"), HasSubstr("texture coordinates")));
  EXPECT_THAT(message(kQuad + "f 1/1 2/2 3/3\nf 1 3 4\n"), HasSubstr("no uv on all"));
  EXPECT_THAT(message(kQuad + "f 1/1 2/1 3/1\n"), AllOf(HasSubstr(".obj:12"), HasSubstr("no area")));
  EXPECT_THAT(message(kQuad + "f 4/4 3/3 2/2\n"), AllOf(HasSubstr(".obj:12"), HasSubstr("clockwise")));
  EXPECT_THAT(message(kQuad + "f 1/2 2/1 3/4\n"), AllOf(HasSubstr(".obj:12"), HasSubstr("mirrored")));
  EXPECT_THAT(message(kQuad + "f 1/1 2/2 9/3\n"), AllOf(HasSubstr(".obj:12"), HasSubstr("vertex 9")));
  EXPECT_THAT(message(kQuad + "f 1/1 2/2 3/9\n"), AllOf(HasSubstr(".obj:12"), HasSubstr("uv 9")));
  EXPECT_THAT(message(kQuad + "f 1/1 2/2 0/3\n"), HasSubstr("vertex 0"));
  EXPECT_THAT(message(kQuad + "f 1/1 2/2 x/3\n"), HasSubstr("vertex x"));
  EXPECT_THAT(message(kQuad + "f 1/1 2/2\n"), HasSubstr("2 corners"));
  EXPECT_THAT(message(kQuad + "v 1 nan 3\n"), AllOf(HasSubstr(".obj:12"), HasSubstr("'nan'")));
  EXPECT_THAT(message(kQuad + "v 1 2\n"), AllOf(HasSubstr(".obj:12"), HasSubstr("2 numbers")));
  EXPECT_THAT(message(kQuad + "vt 1 1e999\n"), HasSubstr("finite"));
  EXPECT_THAT(message(kQuad), HasSubstr("no face"));
  EXPECT_THAT(message(kQuad + "f 1/1 1/1 2/2\n"), HasSubstr("no face with an area"));
  EXPECT_THAT(message(""), HasSubstr("no face"));
  EXPECT_THAT(message(std::string("\0\x7f\xff solid\n\x01", 11)), HasSubstr("no face"));
  EXPECT_THROW(read_obj("/nowhere/board.obj"), Error);
  EXPECT_THROW(read_obj(folder_.path()), Error);
  EXPECT_THROW(BoardMesh(read_obj(write(kQuad + "f 1/1 2/2 3/3\n")), {0, 200}, "quad"), Error);
}

}  // namespace
}  // namespace burin
