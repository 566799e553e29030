// Designs on curved boards: what a hollow board hides is not asked for, views that collide are told, meshes that fold
// and boards that turn away are refused by name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>

#include "burin/optimize/design.h"
#include "burin/optimize/design/collisions.h"
#include "burin/optimize/design/curved_views.h"
#include "burin/optimize/design/glint.h"
#include "burin/render/board_mesh.h"
#include "burin/render/error.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kRadian = std::numbers::pi / 180;

// Three places across a board's axis (x), under a lamp that stands aside along it: half vectors turn with the place.
struct TubeBench {
  Board board;
  Bench bench;
  DesignSpec spec;
  DesignOptions options;

  TubeBench() {
    board.size_mm = {60, 60};
    board.carve_min_mm = {5, 5};
    board.carve_max_mm = {55, 55};
    board.material.alpha = 0.04;
    board.material.depth_um = 80;
    bench.material = board.material;
    bench.material.base_alpha = 0.05;
    Light lamp;
    lamp.position_mm = {30 + 800 * std::sin(40 * kRadian), 30, 800 * std::cos(40 * kRadian)};
    bench.lights = {lamp};
    std::vector<Image> pictures(3, Image(56, 56, 1, 0.2F));
    for (int y = 0; y < 56; ++y)
      for (int x = 0; x < 56; ++x) {
        if (std::hypot(x - 27.5, y - 27.5) < 18) pictures[0].at(x, y) = 0.8F;
        pictures[1].at(x, y) = x > 34 && x < 44 ? 0.8F : 0.2F + 0.4F * static_cast<float>(y) / 55;
        if ((x / 14 + y / 14) % 2 == 0) pictures[2].at(x, y) = 0.7F;
      }
    int k = 0;
    for (const char* name : {"low", "middle", "high"}) {
      const double angle = 40 * (k - 1) * kRadian;
      View view;
      view.name = name;
      view.T_camera_board.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
      view.T_camera_board.translation() =
          -(view.T_camera_board.linear() * Vector3d(30, 30 + 600 * std::sin(angle), 600 * std::cos(angle)));
      bench.views.push_back(view);
      spec.views.push_back({name, "lamp", {}, 1});
      spec.views.back().target.image = pictures[static_cast<std::size_t>(k++)];
    }
    spec.scratches = 3000;
    options.pixels = 56;
    options.iterations = 30;
  }

  double mean_psnr() const {
    const DesignResult result = design(spec, board, bench, options, {});
    double sum = 0;
    for (const DesignedView& view : result.views) sum += view.psnr_db / 3;
    return sum;
  }
};

// A quarter of a tube: the sheet turns by 90 degrees.
const Bend kQuarter{60 / (std::numbers::pi / 2), 0};

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

TEST(CurvedDesign, AHollowBoardIsNotAskedForWhatItHides) {
  TubeBench bench;
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
