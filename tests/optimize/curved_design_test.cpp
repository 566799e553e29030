// Designs on curved boards: a quarter of a tube shows three pictures nearly as well as the flat board does with as many
// scratches; a mesh of that tube gives the tube's design; what a hollow board hides is not asked for; which views
// collide is said of the whole board; meshes that fold, and boards that turn away, are refused by name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <numeric>

#include "burin/base/error.h"
#include "burin/optimize/design.h"
#include "burin/optimize/design/collisions.h"
#include "burin/optimize/design/curved_views.h"
#include "burin/optimize/design/glint.h"
#include "burin/scene/board_mesh.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kRadian = std::numbers::pi / 180;

// Three places across a board's axis (y), all of them and the lamp aside along it, as docs/curved.md says: half vectors
// turn with the place, and no two of them alike.
struct TubeBench {
  Board board;
  Bench bench;
  DesignSpec spec;
  DesignOptions options;

  TubeBench() {
    board.size_mm = {120, 120};
    board.carve_min_mm = {20, 20};
    board.carve_max_mm = {100, 100};
    board.material.alpha = 0.03;
    board.material.depth_um = 180;
    bench.material = board.material;
    bench.material.base_alpha = 0.05;
    Light lamp;
    lamp.position_mm = Vector3d(60, 60, 0) + aside(45, 0, 800);
    bench.lights = {lamp};
    const std::filesystem::path pictures = std::filesystem::path(places::source()) / "samples/small-bench/targets";
    const std::array<const char*, 3> files{"moon.png", "boat.png", "still-life.png"};
    int k = 0;
    for (const char* name : {"low", "middle", "high"}) {
      View view;
      view.name = name;
      view.T_camera_board.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
      view.T_camera_board.translation() =
          -(view.T_camera_board.linear() * (Vector3d(60, 60, 0) + aside(45, 50 * (k - 1), 600)));
      bench.views.push_back(view);
      spec.views.push_back({name, "lamp", {}, 1});
      spec.views.back().target.picture = pictures / files[static_cast<std::size_t>(k++)];
    }
    spec.scratches = 8000;
    options.pixels = 80;
    options.iterations = 20;
  }

  // From the board's middle, degrees: so far across the axis, and from there along it.
  static Vector3d aside(double along, double across, double distance) {
    return distance * Vector3d(std::sin(across * kRadian), std::cos(across * kRadian) * std::sin(along * kRadian),
                               std::cos(across * kRadian) * std::cos(along * kRadian));
  }
};

double mean_psnr(const DesignResult& result) {
  double sum = 0;
  for (const DesignedView& view : result.views) sum += view.psnr_db / static_cast<double>(result.views.size());
  return sum;
}
double mean_psnr(const TubeBench& b) { return mean_psnr(design(b.spec, b.board, b.bench, b.options, {})); }

// A quarter of a tube: the sheet turns by 90 degrees.
const Bend kQuarter{120 / (std::numbers::pi / 2), 90};

TEST(CurvedDesign, AQuarterOfATubeShowsThreePicturesNearlyAsWellAsTheFlatBoard) {
  TubeBench bench;
  const double flat = mean_psnr(bench);
  bench.board.bend = kQuarter;
  const double bent = mean_psnr(bench);
  // Both are hard to tell from their targets. The last iterates had 34.1 and 33.1 dB; the best ones have 37.6 and 34.6.
  EXPECT_GT(flat, 36);
  EXPECT_GT(bent, 34);
}

// The tube as 60 x 60 faces, as an OBJ.
std::filesystem::path write_tube(const TemporaryFolder& folder, const Vector2d& size, double fold = 1) {
  const Cylinder c = cylinder_of(kQuarter, size);
  std::string text;
  char line[200];
  constexpr int kSide = 60;
  for (int j = 0; j <= kSide; ++j)
    for (int i = 0; i <= kSide; ++i) {
      const BentPlace p = bent_place(c, size.cwiseProduct(Vector2d(i, j)) / kSide);
      std::snprintf(line, sizeof line, "v %.9f %.9f %.9f\nvt %.9f %.9f\nvn %.9f %.9f %.9f\n", p.position_mm.x(),
                    p.position_mm.y(), p.position_mm.z(), fold * i / kSide, 1.0 * j / kSide, p.normal.x(), p.normal.y(),
                    p.normal.z());
      text += line;
    }
  const auto at = [](int i, int j) {
    const std::string n = std::to_string(j * (kSide + 1) + i + 1);
    return " " + n + "/" + n + "/" + n;
  };
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) text += "f" + at(i, j) + at(i + 1, j) + at(i + 1, j + 1) + at(i, j + 1) + "\n";
  return folder.write("tube.obj", text);
}

TEST(CurvedDesign, AMeshOfTheTubeIsTheTube) {
  TubeBench tube;
  tube.options.iterations = 10;
  tube.spec.scratches = 3000;
  TubeBench mesh = tube;
  tube.board.bend = kQuarter;
  const TemporaryFolder folder;
  mesh.board.mesh = write_tube(folder, mesh.board.size_mm);
  const DesignResult of_tube = design(tube.spec, tube.board, tube.bench, tube.options, {});
  EXPECT_NEAR(mean_psnr(of_tube), mean_psnr(mesh), 1.0);  // searches part ways by rounding, and end alike
  // The tube's scratches on the mesh show the tube's pictures.
  mesh.options.from = of_tube.scratches;
  mesh.options.iterations = 0;
  mesh.options.drop_error = 0;
  EXPECT_NEAR(mean_psnr(of_tube), mean_psnr(mesh), 0.1);
}

TEST(CurvedDesign, AHollowBoardIsNotAskedForWhatItHides) {
  TubeBench bench;
  bench.board.size_mm = {60, 60};
  bench.board.bend = Bend{-24, 0};  // nearly half a tube: its far rim hides the near wall from low places
  const BoardFace face = face_of(bench.board, bench.bench);
  const FootprintGrid grid = board_grid({5, 5}, {55, 55}, 40, 40, face);
  const Vector3d low(30, 600, 150);
  const Image seen = seen_from(grid, face, low);
  ASSERT_EQ(seen.data.size(), 1600U);
  const double share = std::accumulate(seen.data.begin(), seen.data.end(), 0.0) / 1600;
  EXPECT_GT(share, 0.1);
  EXPECT_LT(share, 0.7);
  const auto findings = check_seen("low", grid, face, low, {30, 30, 500});
  ASSERT_FALSE(findings.empty());
  EXPECT_THAT(sentence(findings[0]), AllOf(HasSubstr("view low"), HasSubstr("are not seen from there")));
  EXPECT_TRUE(seen_from(board_grid({5, 5}, {55, 55}, 40, 40, Surface{{60, 60}, {0, 0, 0}, {}}),
                        {Surface{{60, 60}, {0, 0, 0}, {}}, nullptr}, low)
                  .data.empty());
}

TEST(CurvedDesign, ABoardThatTurnsAwayIsRefused) {
  TubeBench bench;
  bench.board.size_mm = {60, 60};
  bench.board.bend = Bend{25, 0};
  const BoardFace face = face_of(bench.board, bench.bench);
  const FootprintGrid grid = board_grid({5, 25}, {55, 30}, 40, 8, face);  // its middle only
  try {
    check_seen("beside", grid, face, {30, 600, -200}, {30, 30, 500});
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("view beside"), HasSubstr("turns away from its eye")));
  }
}

TEST(CurvedDesign, CollisionsAreThoseOfTheWholeBoard) {
  // Two eyes whose scratches run 90 degrees apart in the middle, and alike where the board turns.
  Board board;
  board.size_mm = {60, 60};
  board.bend = Bend{60 / (std::numbers::pi / 2), 0};
  const auto view = [&](const char* name, double x, double y) {
    return GlintView{name, {30 + x, 30 + y, 600}, {30, 30, 900}, curved_face(board, Bench())};
  };
  std::vector<GlintView> views{view("right", 350, 0), view("up", 0, 350)};
  const auto groove_at = [](const Vector2d&) { return GrooveShape{60, 0.06}; };
  EXPECT_TRUE(collisions_of({{"right", {380, 30, 600}, {30, 30, 900}}, {"up", {30, 380, 600}, {30, 30, 900}}}, {5, 5},
                            {55, 55}, groove_at)
                  .empty());
  const auto curved = collisions_of(views, {5, 5}, {55, 55}, groove_at);
  ASSERT_EQ(curved.size(), 1U);
  EXPECT_NEAR(curved[0].apart, std::numbers::pi / 2, 0.05);
  EXPECT_GT(curved[0].worst, 0.9);
  EXPECT_THAT(sentence(told(curved, views)[0]), AllOf(HasSubstr("right and up"), HasSubstr("the board being curved")));
}

TEST(CurvedDesign, ManyViewsThatCollideAreOneSentence) {
  std::vector<GlintView> views;
  for (int k = 0; k < 24; ++k) {
    const double angle = (k - 11.5) * 3 * kRadian;
    views.push_back({"v" + std::to_string(k), {500 * std::sin(angle), -300, 500 * std::cos(angle)}, {0, 400, 600}});
  }
  const auto collisions = collisions_of(views, {-30, -30}, {30, 30}, [](const Vector2d&) {
    return GrooveShape{40, 0.04};
  });
  ASSERT_GT(collisions.size(), 6U);
  for (std::size_t i = 1; i < collisions.size(); ++i) EXPECT_GE(collisions[i - 1].ghost, collisions[i].ghost);
  const auto findings = told(collisions, views);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(sentence(findings[0]), AllOf(HasSubstr("of 276 pairs of views collide"), HasSubstr("neighbors")));
}

TEST(CurvedDesign, AMeshThatFoldsIsRefused) {
  const TemporaryFolder folder;
  // uv that run to the middle and back again: the order of corners is kept, so both halves face the viewer.
  std::string text =
      "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 20 0 5\nv 20 10 5\n"
      "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.2 0\nvt 0.8 0\nvt 0.8 1\nvt 0.2 1\n"
      "f 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 3/8\n";
  try {
    BoardMesh(read_obj(folder.write("fold.obj", text)), {10, 10}, "fold.obj");
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("fold.obj:"), HasSubstr("the mesh folds"), HasSubstr("line")));
  }
}

TEST(CurvedDesign, AMeshThatStretchesIsTold) {
  const TemporaryFolder folder;
  const Vector2d size(60, 60);
  const auto stretch = [&](double fold) {
    const auto mesh = std::make_shared<const BoardMesh>(read_obj(write_tube(folder, size, fold)), size, "tube.obj");
    return check_stretch({Surface{size, {0, 0, 0}, {}}, mesh}, "tube.obj");
  };
  EXPECT_TRUE(stretch(1).empty());
  ASSERT_EQ(stretch(0.8).size(), 1U);
  EXPECT_THAT(sentence(stretch(0.8)[0]), HasSubstr("by up to 25.0 %"));
}

}  // namespace
}  // namespace burin
