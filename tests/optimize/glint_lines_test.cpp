// Proves that grooves which cut each other's rims away are seen as the lines along which they glint: what is left of a
// line is where, of all grooves' surfaces (Eqn. 2 of the paper), its own is the lowest, point by point; its ends move
// as finite differences say; and the place across a groove is where the wall mirrors lamp and eye.
#include "burin/optimize/design/glint_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "burin/optimize/toolpath/ends.h"
#include "burin/scene/groove.h"

namespace burin {
namespace {

class GlintLinesTest : public testing::Test {
 protected:
  GlintLinesTest() {
    board_.size_mm = {30, 30};
    board_.tool_width_um = 400;
    bench_.crossings = Crossings::deepest;
    bench_.material.depth_um = 14;
    bench_.material.alpha = 0.01;
  }
  static Scratches any_scratches(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(5, 25), angle(0, 3.14159), half(1, 4);
    Scratches s;
    for (std::size_t i = 0; i < count; ++i) {
      const double x = place(random), y = place(random), a = angle(random), h = half(random);
      s.x0_mm.push_back(x - h * std::cos(a)), s.y0_mm.push_back(y - h * std::sin(a));
      s.x1_mm.push_back(x + h * std::cos(a)), s.y1_mm.push_back(y + h * std::sin(a));
    }
    return s;
  }
  Carved left_of_all(const Scratches& s) const {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < s.size(); ++i) rows.push_back(i);
    return GlintCuts(s, bench_, board_).left_of(rows, std::vector<const GlintView*>(s.size(), &glint_));
  }
  double depth_um(const Scratches& s, std::size_t i) const {
    return s.depth_um.empty() ? bench_.material.depth_um : s.depth_um[i];
  }
  // How high groove i's surface is over a place; above the face where it does not reach there.
  double height_um(const Scratches& s, std::size_t i, const Eigen::Vector2d& p) const {
    const Ends e = ends_of(s, i);
    const Eigen::Vector2d u = (e.b - e.a).normalized(), o = p - e.a;
    const double along = o.dot(u), x_um = 1e3 * (o.x() * u.y() - o.y() * u.x());
    if (along < 0 || along > e.length() || std::abs(x_um) >= 0.49 * board_.tool_width_um) return 1;
    return groove_height_um(x_um, board_.tool_width_um, depth_um(s, i));
  }
  // Shares of all lines' lengths: left, and where the pieces say something else.
  std::pair<double, double> left_and_off(const Scratches& s) const {
    const Carved pieces = left_of_all(s);
    const BrightPlaces places = bright_places(s, bench_, board_);
    double all = 0, left = 0, off = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Ends e = ends_of(s, i);
      const GlintLine line = glint_line(e.a, e.b, depth_um(s, i), glint_, places);
      constexpr double kStep = 0.01;
      for (double t = kStep / 2; t < line.length; t += kStep) {
        const Eigen::Vector2d p = line.at(t);
        const double own = height_um(s, i, p);
        bool lowest = true, listed = false;
        for (std::size_t j = 0; j < s.size() && lowest; ++j) lowest = j == i || height_um(s, j, p) >= own;
        for (std::size_t k = 0; k < pieces.size() && !listed; ++k)
          listed = pieces.source[k] == i && t > pieces.begin[k].at * line.length && t < pieces.end[k].at * line.length;
        all += kStep, left += lowest ? kStep : 0, off += lowest != listed ? kStep : 0;
      }
    }
    return {left / all, off / all};
  }

  Board board_;
  Bench bench_;
  GlintView glint_{"v", {-100, 10, 400}, {20, 300, 350}};
};

TEST_F(GlintLinesTest, WhatIsLeftIsWhereTheOwnSurfaceIsTheLowest) {
  Scratches s = any_scratches(250, 3);
  const auto [left, off] = left_and_off(s);
  EXPECT_GT(left, 0.3);
  EXPECT_LT(left, 0.9) << "crossings take much here";
  EXPECT_LT(off, 0.01);
  // Of depths that differ the deeper ones take more; how far they reach is known to first order.
  for (std::size_t i = 0; i < s.size(); ++i) s.depth_um.push_back(12 + 4 * (i % 5) / 4.0);
  EXPECT_LT(left_and_off(s).second, 0.02);
}

TEST_F(GlintLinesTest, GlintsWhereTheWallMirrorsLampToEye) {
  const Eigen::Vector2d a(10, 12), b(16, 15), middle = (a + b) / 2;
  const GlintLine line = glint_line(a, b, 14, glint_, bright_places(any_scratches(1, 1), bench_, board_));
  const Eigen::Vector3d p(middle.x(), middle.y(), 0);
  const Eigen::Vector3d h = (glint_.light_mm - p).normalized() + (glint_.camera_mm - p).normalized();
  // The wall's slope there, by differences, against h's in the plane across the groove.
  const double x = 1e3 * line.bright.aside_mm,
               slope = (groove_height_um(x + 0.01, 400.0, 14.0) - groove_height_um(x - 0.01, 400.0, 14.0)) / 0.02;
  EXPECT_NEAR(-slope, h.head<2>().dot(line.across()) / h.z(), 0.01);
}

TEST_F(GlintLinesTest, EndsOfWhatIsLeftMoveAsDifferencesSay) {
  const Scratches s = any_scratches(120, 9);
  // A sum over all pieces that is smooth as they come and go.
  const auto sum_of = [](const Carved& c) {
    double sum = 0;
    for (std::size_t k = 0; k < c.size(); ++k) {
      const Ends e = ends_of(c.scratches, k);
      sum += (1 + 0.1 * (c.source[k] % 7)) * (e.b - e.a).squaredNorm();
    }
    return sum;
  };
  const Carved left = left_of_all(s);
  ScratchGradients by;
  by.resize(left.size());
  for (std::size_t k = 0; k < left.size(); ++k) {
    const Ends e = ends_of(left.scratches, k);
    const Eigen::Vector2d d = 2 * (1 + 0.1 * (left.source[k] % 7)) * (e.b - e.a);
    by.x0_mm[k] = -d.x(), by.y0_mm[k] = -d.y(), by.x1_mm[k] = d.x(), by.y1_mm[k] = d.y();
  }
  const ScratchGradients g = pull_back(left, Designed(s), bench_, board_, by);
  double off = 0, all = 0;
  for (std::size_t i = 0; i < s.size(); i += 3) {
    constexpr double kStep = 1e-5;
    Scratches more = s, less = s;
    more.x0_mm[i] += kStep;
    less.x0_mm[i] -= kStep;
    const double measured = (sum_of(left_of_all(more)) - sum_of(left_of_all(less))) / (2 * kStep);
    off += std::pow(g.x0_mm[i] - measured, 2);
    all += std::pow(measured, 2);
  }
  // Turning a groove moves its line a little, which ends do not follow.
  EXPECT_LT(std::sqrt(off / all), 0.03);
}

}  // namespace
}  // namespace burin
