// No pair of pixel and scratch is missed, and few are found in vain: PixelIndex against all pairs of two convex
// polygons by separating axes, for perspective, a distorting lens, a bowed face, a view near the horizon, boards cut by
// the window and pixels larger and smaller than the groove. Not proved here: what the pairs contribute
// (view_renderer_test).
#include "burin/render/fast/pairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "burin/base/error.h"
#include "tests/render/quadrilaterals.h"
#include "tests/render/small_world.h"

namespace burin {
namespace {

Lens strong_lens(int width, int height) {
  Lens lens;
  lens.model = "LENSMODEL_OPENCV8";
  lens.width = width;
  lens.height = height;
  lens.intrinsics = {1.1 * width, 1.1 * width, 0.51 * width, 0.48 * height, -0.25, 0.08, 0.002, -0.001, 0, 0, 0, 0};
  return lens;
}

Lens pinhole(int width, int height) {
  Lens lens = strong_lens(width, height);
  lens.model = "LENSMODEL_PINHOLE";
  lens.intrinsics.resize(4);
  return lens;
}

std::vector<Strip> random_strips(int count, double size_mm, double half_width_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> where(-0.1 * size_mm, 1.1 * size_mm), length(0.001, 0.3),
      turn(0, 2 * std::numbers::pi);
  std::vector<Strip> strips;
  for (int i = 0; i < count; ++i) {
    // A quarter of them lies along an axis, where edges coincide with those of a grid on the board.
    const double angle = i % 4 == 0 ? std::numbers::pi / 2 * (i / 4 % 4) : turn(random);
    const Eigen::Vector2d p(where(random), where(random)), d(std::cos(angle), std::sin(angle));
    strips.push_back({p, p + size_mm * length(random) * d, half_width_mm});
  }
  return strips;
}

struct Count {
  std::size_t touching = 0, missed = 0, in_vain = 0;
};

Count compare(const FootprintGrid& grid, const std::vector<Strip>& strips) {
  const PixelIndex index(grid);
  Count count;
  for (const Strip& strip : strips) {
    std::vector<PixelSpan> spans;
    find_spans(index, strip, spans);
    std::set<std::pair<int, int>> found;
    for (const PixelSpan& s : spans)
      for (int c = s.begin; c < s.end; ++c)
        EXPECT_TRUE(found.insert({c, s.row}).second) << "pixel reported twice: " << c << ", " << s.row;
    const Corners q = strip_corners(strip);
    for (int r = 0; r < grid.height(); ++r) {
      for (int c = 0; c < grid.width(); ++c) {
        const Corners p = footprint_corners_mm(grid, c, r);
        const bool valid = std::isfinite(signed_area_mm2(p)) && signed_area_mm2(p) != 0;
        const double overlap = valid ? overlap_mm(p, q) : -1;
        const bool reported = found.count({c, r}) > 0;
        EXPECT_TRUE(valid || !reported) << "a pixel without a footprint was reported";
        if (overlap > 1e-9) {
          ++count.touching;
          count.missed += !reported;
        } else if (overlap < -1e-9) {
          count.in_vain += reported;
        }
      }
    }
  }
  return count;
}

void expect_complete(const FootprintGrid& grid, double size_mm, const char* what, double in_vain_limit = 0.1) {
  for (const double half_width_mm : {0.002, 0.05, 2.0}) {
    const Count n = compare(grid, random_strips(200, size_mm, half_width_mm, 7));
    EXPECT_GT(n.touching, 200u) << what;
    EXPECT_EQ(n.missed, 0u) << what << ", half width " << half_width_mm << ", of " << n.touching;
    EXPECT_LE(n.in_vain, in_vain_limit * n.touching) << what << ", half width " << half_width_mm;
  }
}

const Surface kFlat{{100, 100}, {0, 0, 0}};

TEST(PixelIndex, GridOnTheBoard) {
  expect_complete(board_grid({0, 0}, {100, 100}, 64, 50, kFlat), 100, "board grid", 0.01);
  expect_complete(board_grid({20, 30}, {70, 80}, 33, 70, kFlat), 100, "part of the board", 0.01);
}

TEST(PixelIndex, PixelsSmallerThanTheGroove) {
  const FootprintGrid grid = board_grid({49, 49}, {51, 51}, 70, 60, kFlat);
  const Count n = compare(grid, random_strips(2000, 100, 0.2, 3));
  EXPECT_GT(n.touching, 500u);
  EXPECT_EQ(n.missed, 0u);
}

TEST(PixelIndex, PerspectiveThroughAPinhole) {
  const auto T = looking_at({60, -80, 120}, {50, 50, 0});
  const FootprintGrid grid = camera_grid(pinhole(80, 60), T, kFlat, {0, 0, 80, 60});
  ASSERT_TRUE(grid.board_from_pixel.has_value());
  expect_complete(grid, 100, "pinhole", 0.01);
}

TEST(PixelIndex, DistortingLensAndBowedFace) {
  const auto T = looking_at({60, -80, 120}, {50, 50, 0});
  expect_complete(camera_grid(strong_lens(80, 60), T, kFlat, {0, 0, 80, 60}), 100, "distorted");
  const Surface bowed{{100, 100}, {1.5, -0.7, 2}};
  expect_complete(camera_grid(strong_lens(80, 60), T, bowed, {0, 0, 80, 60}), 100, "distorted, bowed");
  expect_complete(camera_grid(strong_lens(80, 60), T, bowed, {13, 9, 41, 37}), 100, "a window of it");
}

TEST(PixelIndex, NearTheHorizon) {
  // The camera stands 3 mm above the face, at its edge: rows go from 5 mm to the horizon, some of them beyond it.
  const auto T = looking_at({50, -10, 3}, {50, 60, 0});
  for (const Lens& lens : {pinhole(60, 60), strong_lens(60, 60)}) {
    const FootprintGrid grid = camera_grid(lens, T, kFlat, {0, 0, 60, 60});
    expect_complete(grid, 100, lens.model.c_str(), 0.6);
  }
}

TEST(PixelIndex, RandomCamerasMissNothing) {
  // Cameras drawn at random, down to 2 degrees above the face and into its middle, with lenses straight and bent, flat
  // and bowed faces, windows that the board's edge cuts; strips from a thousandth of a pixel to ten pixels wide, some
  // of them along the footprints' own edges.
  std::size_t touching = 0;
  for (unsigned seed = 0; seed < 120; ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
    const double elevation = std::numbers::pi / 180 * (seed % 3 == 0 ? uniform(2, 12) : uniform(12, 90)),
                 turn = uniform(0, 2 * std::numbers::pi);
    const Eigen::Vector3d target(uniform(0, 100), uniform(0, 100), 0);
    const Eigen::Vector3d from(std::cos(elevation) * std::cos(turn), std::cos(elevation) * std::sin(turn),
                               std::sin(elevation));
    const Lens lens = seed % 2 == 0 ? strong_lens(44, 37) : pinhole(44, 37);
    const Surface face{{100, 100}, seed % 5 < 2 ? Eigen::Vector3d(1.5, -0.7, 2) : Eigen::Vector3d(0, 0, 0)};
    const PixelWindow window = seed % 4 == 0 ? PixelWindow{9, 5, 30, 27} : PixelWindow{0, 0, 44, 37};
    const FootprintGrid grid = camera_grid(lens, looking_at(target + uniform(15, 250) * from, target), face, window);
    const auto corners = footprint_corners_mm(grid, window.width / 2, window.height / 2);
    const double pixel_mm = std::sqrt(std::abs(signed_area_mm2(corners)));
    if (!std::isfinite(pixel_mm)) continue;
    std::vector<Strip> strips = random_strips(60, 100, pixel_mm * std::pow(10, uniform(-3, 1)), seed);
    for (int k = 0; k < 20; ++k) {
      const auto q = footprint_corners_mm(grid, static_cast<int>(uniform(0, window.width)),
                                          static_cast<int>(uniform(0, window.height)));
      if (q[0].allFinite() && q[1].allFinite() && q[2].allFinite())
        strips.push_back({q[k % 2], q[k % 2 + 1], 1e-3 * pixel_mm});
    }
    const Count n = compare(grid, strips);
    touching += n.touching;
    EXPECT_EQ(n.missed, 0u) << "seed " << seed << ", of " << n.touching;
  }
  EXPECT_GT(touching, 20000u);
}

TEST(PixelIndex, NoFootprintNoPair) {
  FootprintGrid grid = board_grid({0, 0}, {100, 100}, 16, 16, kFlat);
  for (double& x : grid.corner_x_mm) x = NAN;
  const PixelIndex index(grid);
  std::vector<PixelSpan> spans;
  find_spans(index, {{0, 0}, {100, 100}, 1}, spans);
  EXPECT_TRUE(spans.empty());
}

TEST(FindPairs, ByPixelInScratchOrder) {
  const FootprintGrid grid = board_grid({0, 0}, {100, 100}, 40, 40, kFlat);
  const auto strips = random_strips(1500, 100, 0.05, 5);
  const PixelPairs pairs = find_pairs(PixelIndex(grid), 40, 40, strips);
  ASSERT_EQ(pairs.begin.size(), 1601u);
  std::size_t expected = 0;
  const PixelIndex index(grid);
  for (const Strip& strip : strips) {
    std::vector<PixelSpan> spans;
    find_spans(index, strip, spans);
    for (const PixelSpan& s : spans) expected += s.end - s.begin;
  }
  EXPECT_EQ(pairs.scratch.size(), expected);
  for (int i = 0; i < 1600; ++i)
    for (std::size_t k = pairs.begin[i] + 1; k < pairs.begin[i + 1]; ++k)
      EXPECT_LT(pairs.scratch[k - 1], pairs.scratch[k]);
}

TEST(CheckScratches, NamesWhatIsWrong) {
  Scratches s;
  s.x0_mm = {1, 2};
  s.y0_mm = {1, 2};
  s.x1_mm = {3, NAN};
  s.y1_mm = {1, 2};
  try {
    check_scratches(s);
    FAIL() << "a NaN passed";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("x1_mm of scratch 1 is nan"), std::string::npos) << e.what();
  }
  s.x1_mm[1] = 4;
  s.depth_um = {1, 0};
  EXPECT_THROW(check_scratches(s), Error);
  s.depth_um = {1};
  EXPECT_THROW(check_scratches(s), Error);
}

}  // namespace
}  // namespace burin
