// A sheet bent to a cylinder: that bending keeps lengths, that rays find the place they came from, that what a hollow
// sheet hides is what Embree says of a fine mesh of it, that the picture of a bent board is that mesh's, that every
// derivative agrees with central differences, and that what no sheet allows is refused by name.
#include "burin/scene/bend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "burin/base/error.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/board_face.h"
#include "burin/scene/board_mesh.h"
#include "tests/render/expect_fast_is_exact.h"
#include "tests/render/small_world.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;

const Vector2d kSheet{120, 80};

// A cylinder as many flat strips across its axis; the vertices' normals are the cylinder's own.
TriangleMesh mesh_of(const Cylinder& c, int columns, int rows) {
  TriangleMesh mesh;
  const auto flat = [&](int i, int j) { return Vector2d(c.size_mm.x() * i / columns, c.size_mm.y() * j / rows); };
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) mesh.position_mm.push_back(bent_place(c, flat(i, j)).position_mm);
  const auto vertex = [&](int i, int j) { return static_cast<std::uint32_t>(j * (columns + 1) + i); };
  const auto add = [&](std::array<std::array<int, 2>, 3> corners) {
    std::array<std::uint32_t, 3> t;
    std::array<Vector2d, 3> uv;
    std::array<Vector3d, 3> normal;
    for (int k = 0; k < 3; ++k) {
      t[k] = vertex(corners[k][0], corners[k][1]);
      uv[k] = flat(corners[k][0], corners[k][1]).cwiseQuotient(c.size_mm);
      normal[k] = bent_place(c, flat(corners[k][0], corners[k][1])).normal;
    }
    mesh.triangle.push_back(t);
    mesh.uv.push_back(uv);
    mesh.normal.push_back(normal);
  };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}});
      add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}});
    }
  return mesh;
}

TEST(Bend, KeepsLengthsAndTheMiddle) {
  for (const Bend bend : {Bend{76, 90}, Bend{-150, 30}, Bend{1e7, 10}, Bend{40, 135}}) {
    const Cylinder c = cylinder_of(bend, kSheet);
    const BentPlace middle = bent_place(c, kSheet / 2);
    EXPECT_LT((middle.position_mm - Vector3d(60, 40, 0)).norm(), 1e-9);
    EXPECT_LT((middle.normal - Vector3d::UnitZ()).norm(), 1e-9);
    for (const Vector2d& p : {Vector2d(3, 5), Vector2d(110, 70), Vector2d(60, 79)}) {
      const BentPlace at = bent_place(c, p);
      constexpr double kStep = 1e-4;
      Eigen::Matrix<double, 3, 2> J;
      for (int k = 0; k < 2; ++k)
        J.col(k) = (bent_place(c, p + kStep * Vector2d::Unit(k)).position_mm -
                    bent_place(c, p - kStep * Vector2d::Unit(k)).position_mm) /
                   (2 * kStep);
      EXPECT_LT((J.transpose() * J - Eigen::Matrix2d::Identity()).norm(), 1e-8);
      EXPECT_LT((J.col(0).cross(J.col(1)) - at.normal).norm(), 1e-8);
      EXPECT_LT((at.across.cross(at.normal) - at.along).norm(), 1e-12);
      // Grooves' frame: the shortest turn of the normal to z lays tangents back where they were on the flat sheet.
      const FacePlace face = *face_place({Surface{kSheet, Vector3d::Zero(), bend}, nullptr}, p);
      EXPECT_LT((face.x - J.col(0)).norm(), 1e-7);
    }
  }
  // Convex towards the viewer: the rim lies below; hollow: above.
  EXPECT_LT(bent_place(cylinder_of({76, 90}, kSheet), {0, 40}).position_mm.z(), -10);
  EXPECT_GT(bent_place(cylinder_of({-76, 90}, kSheet), {0, 40}).position_mm.z(), 10);
}

TEST(Bend, RaysFindThePlaceTheyCameFrom) {
  const Vector3d eye(100, -200, 500);
  for (const Bend bend : {Bend{76, 90}, Bend{-150, 30}, Bend{1e9, 10}, Bend{-60, 45}}) {
    const Cylinder c = cylinder_of(bend, kSheet);
    int seen = 0;
    for (double x = 1; x < 120; x += 7)
      for (double y = 1; y < 80; y += 7) {
        const BentPlace place = bent_place(c, {x, y});
        const auto found = flat_place(c, eye, place.position_mm - eye);
        if (hidden_from(c, place, eye)) {
          EXPECT_TRUE(!found || (*found - Vector2d(x, y)).norm() > 1);
          continue;
        }
        ++seen;
        ASSERT_TRUE(found) << x << " " << y;
        EXPECT_LT((*found - Vector2d(x, y)).norm(), 1e-8);
      }
    EXPECT_GT(seen, 100);
    EXPECT_FALSE(flat_place(c, eye, Vector3d(0, 0, 1)));
    EXPECT_FALSE(flat_place(c, {60, 40, -500}, Vector3d(0, 0, 1)));  // from behind
  }
}

TEST(Bend, HidesWhatEmbreeSaysAFineMeshHides) {
  int hidden = 0, open = 0;
  for (const Bend bend : {Bend{-40, 90}, Bend{-60, 45}, Bend{50, 20}}) {
    const Cylinder c = cylinder_of(bend, kSheet);
    const BoardMesh mesh(mesh_of(c, 240, 160), kSheet, "mesh");
    for (const Vector3d& from : {Vector3d(400, 60, 100), Vector3d(60, 300, 30), Vector3d(60, 40, 400)})
      for (double x = 2.3; x < 120; x += 6.1)
        for (double y = 2.7; y < 80; y += 6.1) {
          const BentPlace place = bent_place(c, {x, y});
          // Where the way grazes the face, a mesh of flat pieces decides otherwise.
          const Vector3d way = (from - place.position_mm).normalized();
          if (std::abs(way.dot(place.normal)) < 0.03) continue;
          const bool by_mesh = mesh.hidden_from(from, place.position_mm + 0.02 * place.normal, place.normal);
          const bool by_sheet = hidden_from(c, place, from);
          // And where it passes an edge of the sheet within a piece's length.
          if (by_mesh != by_sheet) {
            const auto near_edge = [&](double lift) {
              BentPlace lifted = place;
              lifted.position_mm += Vector3d(lift, lift, 0);
              return hidden_from(c, lifted, from) != by_sheet;
            };
            EXPECT_TRUE(near_edge(0.6) || near_edge(-0.6)) << x << " " << y << " from " << from.transpose();
            continue;
          }
          ++(by_sheet ? hidden : open);
        }
  }
  EXPECT_GT(hidden, 200);
  EXPECT_GT(open, 200);
}

TEST(Bend, MotionAgainstCentralDifferences) {
  for (const Bend bend : {Bend{76, 90}, Bend{-150, 30}, Bend{5000, 70}})
    for (const Vector2d& p : {Vector2d(3, 5), Vector2d(110, 70), Vector2d(60, 79)}) {
      const BentMotion motion = bent_motion(cylinder_of(bend, kSheet), p);
      for (int k = 0; k < 2; ++k) {
        constexpr double kStep = 1e-4;
        const BentPlace plus = bent_place(cylinder_of(bend, kSheet, kStep * Vector2d::Unit(k)), p),
                        minus = bent_place(cylinder_of(bend, kSheet, -kStep * Vector2d::Unit(k)), p);
        EXPECT_LT(((plus.position_mm - minus.position_mm) / (2 * kStep) - motion.position_by[k]).norm(), 1e-7);
        EXPECT_LT(((plus.normal - minus.normal) / (2 * kStep) - motion.normal_by[k]).norm(), 1e-7);
      }
    }
}

World bent_world(const Bend& bend, int count = 120) {
  World w = small_world(count);
  w.bench.bow_mm.setZero();
  w.board.bend = bend;
  View view;
  view.T_camera_board = w.camera.T_camera_board;
  w.camera = make_camera_view(w.bench, w.board, view, w.camera.window);
  w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
  return w;
}

// A quarter of a tube and a hollow one, about axes askew.
const std::array kBends{Bend{14, 75}, Bend{-16, 20}};

TEST(BentBoard, FastPathIsTheExactOne) {
  for (const Bend& bend : kBends)
    for (const int channels : {1, 3}) expect_fast_is_exact(bent_world(bend, 400), channels, SimdWidth::best, "bent");
}

TEST(BentBoard, ShowsWhatAFineMeshOfItShows) {
  for (const Bend& bend : kBends) {
    World w = bent_world(bend, 400);
    const BoardMesh mesh(mesh_of(cylinder_of(w.camera.surface), 400, 400), w.board.size_mm, "mesh");
    const FootprintGrid by_mesh = camera_grid(w.camera.lens, w.camera.T_camera_board, mesh, w.camera.window);
    // The mesh has an x axis of its own, of its triangles' uv: that the shortest turn is right, too, rests on it.
    ASSERT_FALSE(by_mesh.x_axis.empty());
    Image bent, meshed;
    ViewRenderer(w.scene, {1, true}).forward(in_metal(w.scratches), bent);
    ViewScene scene = w.scene;
    scene.grid = share(by_mesh);
    scene.hidden_from_light = hidden_pixels(by_mesh, mesh, scene.light.position_mm);
    ViewRenderer(scene, {1, true}).forward(in_metal(w.scratches), meshed);
    double error2 = 0, size2 = 0;
    int compared = 0;
    for (std::size_t i = 0; i < bent.data.size(); ++i) {
      if (bent.data[i] == 0 || meshed.data[i] == 0) continue;  // at the sheet's rim
      ++compared;
      error2 += std::pow(bent.data[i] - meshed.data[i], 2);
      size2 += std::pow(bent.data[i], 2);
    }
    EXPECT_GT(compared, 150);
    // Pieces of 0.05 mm on a radius of 15 lie up to 2e-5 mm off, and a groove's light follows the normal.
    EXPECT_LT(std::sqrt(error2 / size2), 2e-3);
  }
}

std::vector<double> radiance_of(const World& w) {
  const ViewPixels pixels = view_pixels(w.scene, 1);
  ExactView view(w.scene, pixels);
  Image image;
  const auto strips = strips_of(w.scratches, w.scene.tool_width_um, w.scene.material);
  view.forward(w.scratches,
               find_pairs(PixelIndex(*w.scene.grid), w.scene.grid->width(), w.scene.grid->height(), strips), false,
               image);
  return view.radiance();
}

World bent_moved(World w, SceneParameter parameter, double step) {
  const int bow = static_cast<int>(parameter) - static_cast<int>(SceneParameter::bow_0_mm);
  const int turn = static_cast<int>(parameter) - static_cast<int>(SceneParameter::pose_rx);
  if (parameter == SceneParameter::light_x_mm)
    w.bench.lights[0].position_mm.x() += step;
  else if (bow >= 0)
    w.camera.surface.bow_mm[bow] += step;
  else if (turn >= 3)
    w.camera.T_camera_board.translation()[turn - 3] += step;
  else
    w.camera.T_camera_board = Eigen::AngleAxisd(step, Vector3d::Unit(turn)) * w.camera.T_camera_board;
  w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
  return w;
}

TEST(BentBoard, DerivativesAgainstCentralDifferences) {
  using P = SceneParameter;
  const std::vector parameters{P::light_x_mm, P::pose_rx,    P::pose_ry,  P::pose_rz, P::pose_tx_mm,
                               P::pose_ty_mm, P::pose_tz_mm, P::bow_0_mm, P::bow_1_mm};
  for (const Bend& bend : kBends) {
    World w = bent_world(bend);
    for (const Vector3d& bow : {Vector3d(0, 0, 0), Vector3d(0.3, -0.2, 0)}) {
      w.camera.surface.bow_mm = bow;
      w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
      const RadianceDerivatives d =
          render_with_derivatives(w.scene, w.camera, in_metal(w.scratches), parameters, {1, true});
      for (std::size_t k = 0; k < parameters.size(); ++k) {
        const bool turn = parameters[k] >= P::pose_rx && parameters[k] <= P::pose_rz;
        const double step = parameters[k] == P::light_x_mm ? 1e-4 : turn ? 1e-7 : 1e-6;
        const auto plus = radiance_of(bent_moved(w, parameters[k], step)),
                   minus = radiance_of(bent_moved(w, parameters[k], -step));
        double error2 = 0, size2 = 0;
        for (std::size_t i = 0; i < plus.size(); ++i) {
          const double difference = (plus[i] - minus[i]) / (2 * step);
          error2 += std::pow(difference - d.d_radiance[k].data[i], 2);
          size2 += difference * difference;
        }
        EXPECT_GT(size2, 0) << k;
        EXPECT_LT(std::sqrt(error2 / size2), 2e-5) << "parameter " << k << ", radius " << bend.radius_mm;
      }
    }
  }
}

TEST(BentBoard, ALargeRadiusIsAFlatBoard) {
  World flat = small_world(200);
  flat.bench.bow_mm.setZero();
  View view;
  view.T_camera_board = flat.camera.T_camera_board;
  flat.camera = make_camera_view(flat.bench, flat.board, view, flat.camera.window);
  flat.scene = make_scene(flat.bench, flat.board, flat.camera, flat.bench.lights[0]);
  const auto a = radiance_of(flat), b = radiance_of(bent_world({1e9, 30}, 200));
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-5 * a[i] + 1e-9);
}

TEST(BentBoard, WhatWasFoundInPhotosIsSettled) {
  Board board;
  board.size_mm = kSheet;
  board.bend = Bend{150, 85};
  Bench bench;
  bench.bow_mm = {-0.7, 0.4, 0};
  const Cylinder found = cylinder_of(surface_of(board, bench));
  settle_bend(board, bench);
  EXPECT_TRUE(bench.bow_mm.isZero());
  ASSERT_TRUE(bench.bend);
  EXPECT_LT(bench.bend->radius_mm, 150);  // the rim fell: bent more tightly
  const Cylinder settled = cylinder_of(surface_of(board, bench));
  EXPECT_NEAR(settled.curvature, found.curvature, 1e-15);
  EXPECT_LT((settled.along - found.along).norm(), 1e-12);
  const Bend sigma = bend_sigma_of(surface_of(board, bench), {0.01, 0.01});
  EXPECT_NEAR(sigma.radius_mm, std::pow(bench.bend->radius_mm, 2) * 2 * 0.01 / 5200, 1e-6);
}

std::string error_of(const std::string& bend, const std::string& more = "") {
  const TemporaryFolder folder;
  const auto file = folder.write("board.json", R"({"format": "burin/board", "version": 1, "size_mm": [120, 80])" +
                                                   more + R"(, "bend": )" + bend + "}");
  try {
    read_board(file);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(BentBoard, IsReadAndWrittenAndRefusedByName) {
  EXPECT_EQ(error_of(R"({"radius_mm": 76.4, "axis_deg": 90})"), "");
  EXPECT_EQ(error_of(R"({"radius_mm": -300})"), "");
  EXPECT_THAT(error_of(R"({"radius_mm": 0, "axis_deg": 90})"), HasSubstr("leave bend out for a flat board"));
  EXPECT_THAT(error_of(R"({"radius_mm": 15, "axis_deg": 90})"),
              AllOf(HasSubstr("bend"), HasSubstr("radius_mm"), HasSubstr("is 15"), HasSubstr("20.2 mm")));
  EXPECT_EQ(error_of(R"({"radius_mm": 20.2, "axis_deg": 90})"), "");
  EXPECT_THAT(error_of(R"({"radius_mm": 90, "axis": 90})"), HasSubstr("axis_deg"));
  EXPECT_THAT(error_of(R"({"radius_mm": 90})", R"(, "mesh": "board.obj")"), HasSubstr("one shape"));
  Board board;
  board.size_mm = kSheet;
  board.carve_max_mm = kSheet;
  board.bend = Bend{-211.5, 12};
  const TemporaryFolder folder;
  const auto file = folder / "board.json";
  write_board(board, file);
  const Board back = read_board(file);
  ASSERT_TRUE(back.bend);
  EXPECT_EQ(back.bend->radius_mm, -211.5);
  EXPECT_EQ(back.bend->axis_deg, 12);
}

}  // namespace
}  // namespace burin
