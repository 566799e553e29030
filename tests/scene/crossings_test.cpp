// What is proved: the area that other scratches leave of each scratch, against counting random points (the last scratch
// over a point owns it, or the lowest wall does), and the exact cases. Not proved: that real grooves cut each other so.
#include "burin/scene/crossings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "burin/base/error.h"
#include "burin/scene/groove.h"

namespace burin {
namespace {

constexpr double kWidthUm = 1000, kDepthUm = 60;

double half_width_mm() { return 1e-3 * half_width_um(kWidthUm, kDepthUm); }

void add(Scratches& s, double x0, double y0, double x1, double y1) {
  s.x0_mm.push_back(x0);
  s.y0_mm.push_back(y0);
  s.x1_mm.push_back(x1);
  s.y1_mm.push_back(y1);
}

double piece_length(const VisiblePieces& v, std::size_t k) {
  return std::hypot(v.pieces.x1_mm[k] - v.pieces.x0_mm[k], v.pieces.y1_mm[k] - v.pieces.y0_mm[k]);
}

double length_of(const VisiblePieces& v, std::size_t source) {
  double sum = 0;
  for (std::size_t i = 0; i < v.source.size(); ++i)
    if (v.source[i] == source) sum += piece_length(v, i);
  return sum;
}

Scratches strewn(std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(0, 40), turn(0, std::numbers::pi), length(5, 9);
  Scratches s;
  for (int i = 0; i < 250; ++i) {
    const double x = place(random), y = place(random), a = turn(random), l = length(random);
    add(s, x, y, x + l * std::cos(a), y + l * std::sin(a));
  }
  return s;
}

// Where a scratch begins, along which unit vector it goes, and how far. In plain numbers: points are asked by the
// million, and under sanitizers too.
struct Lie {
  double x, y, along_x, along_y, length;
};
std::vector<Lie> lies_of(const Scratches& s) {
  std::vector<Lie> out;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double x = s.x1_mm[i] - s.x0_mm[i], y = s.y1_mm[i] - s.y0_mm[i], l = std::hypot(x, y);
    out.push_back({s.x0_mm[i], s.y0_mm[i], x / l, y / l, l});
  }
  return out;
}

struct Point {
  double x, y;
};
// A share of the way along a scratch, and so far beside it.
Point point_on(const Lie& lie, double share, double across_mm) {
  const double along_mm = share * lie.length;
  return {lie.x + along_mm * lie.along_x + across_mm * lie.along_y,
          lie.y + along_mm * lie.along_y - across_mm * lie.along_x};
}
// How far across a scratch a point lies, where it lies on it.
std::optional<double> across_at(const Lie& lie, double half_width_mm, const Point& p) {
  const double x = p.x - lie.x, y = p.y - lie.y, across = x * lie.along_y - y * lie.along_x;
  if (std::abs(across) > half_width_mm) return std::nullopt;
  const double along = x * lie.along_x + y * lie.along_y;
  if (along < 0 || along > lie.length) return std::nullopt;
  return across;
}

TEST(VisiblePieces, AFullCrossingTakesItsParallelogram) {
  Scratches s;
  add(s, 0, 5, 10, 5);
  const double angle = 0.7;  // between the two
  add(s, 5 - 4 * std::cos(angle), 5 - 4 * std::sin(angle), 5 + 4 * std::cos(angle), 5 + 4 * std::sin(angle));
  const VisiblePieces v = visible_pieces(s, kWidthUm, kDepthUm);
  EXPECT_NEAR(length_of(v, 0), 10 - 2 * half_width_mm() / std::sin(angle), 1e-9);
  EXPECT_NEAR(length_of(v, 1), 8, 1e-9);  // the later one is whole
  EXPECT_EQ(v.source.size(), 3U);
}

TEST(VisiblePieces, NothingCrossesNothingIsCut) {
  Scratches s;
  add(s, 0, 0, 10, 0);
  add(s, 0, 3, 10, 3);
  add(s, 12, 0, 12, 3);
  s.alpha = {0.1, 0.2, 0.3};
  const VisiblePieces v = visible_pieces(s, kWidthUm, kDepthUm);
  ASSERT_EQ(v.source.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(length_of(v, i), length_of(visible_pieces(s, 1e-3, 1e-6), i), 1e-3);
  EXPECT_EQ(v.pieces.alpha[2], 0.3);
  EXPECT_EQ(visible_pieces({}, kWidthUm, kDepthUm).source.size(), 0U);
}

TEST(VisiblePieces, AreaLeftAgreesWithCountingPoints) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  const Scratches s = strewn(random);
  const double w = half_width_mm();
  const VisiblePieces v = visible_pieces(s, kWidthUm, kDepthUm);
  const std::vector<Lie> lies = lies_of(s);
  double cut = 0, counted = 0, whole = 0;
  constexpr int kPoints = 2000;
  for (std::size_t i = 0; i < s.size(); ++i) {
    int left = 0;
    for (int k = 0; k < kPoints; ++k) {
      const double share = unit(random);
      const Point p = point_on(lies[i], share, w * (2 * unit(random) - 1));
      bool covered = false;
      for (std::size_t j = i + 1; j < s.size() && !covered; ++j) {
        covered = across_at(lies[j], w, p).has_value();
      }
      left += !covered;
    }
    whole += lies[i].length;
    counted += lies[i].length * left / kPoints;
    cut += length_of(v, i);
  }
  EXPECT_LT(counted, 0.9 * whole);  // the case is worth the test: crossings take a good part
  // Sideways overlaps are cut by the center line only: right on average, not each. 250 x 2000 points count to 0.2 %.
  EXPECT_NEAR(cut / counted, 1, 0.01);
}

// By how much pieces leave more or less than the lower surface of all shows, of strips of each groove's width, inner to
// outer.
struct StripsLeft {
  std::vector<double> off, counted;  // a strip: the relative error; the share that points see
};
StripsLeft strips_left(const Scratches& s, int strips, int steps, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const VisiblePieces v = visible_pieces(s, kWidthUm, kDepthUm, {}, Crossings::deepest, steps);
  const auto half_mm = [&](std::size_t i) { return 1e-3 * half_width_um(kWidthUm, s.depth_um[i]); };
  const std::vector<Lie> lies = lies_of(s);
  StripsLeft out{std::vector<double>(strips), std::vector<double>(strips)};
  double whole = 0;
  constexpr int kPoints = 1500;
  for (std::size_t i = 0; i < s.size(); ++i) {
    whole += lies[i].length;
    for (int k = 0; k < kPoints; ++k) {
      const double off = 2 * unit(random) - 1;
      const Point p = point_on(lies[i], unit(random), half_mm(i) * off);
      const double height = groove_height_um(1e3 * half_mm(i) * off, kWidthUm, s.depth_um[i]);
      bool covered = false;
      for (std::size_t j = 0; j < s.size() && !covered; ++j) {
        if (j == i) continue;
        const std::optional<double> x = across_at(lies[j], half_mm(j), p);
        covered = x && groove_height_um(1e3 * *x, kWidthUm, s.depth_um[j]) < height;
      }
      if (!covered)
        out.counted[std::min(strips - 1, static_cast<int>(strips * std::abs(off)))] +=
            strips * lies[i].length / kPoints;
    }
  }
  std::vector<double>& left = out.off;
  for (std::size_t k = 0; k < v.source.size(); ++k) {
    const std::size_t i = v.source[k];
    const double share = half_width_um(kWidthUm, v.pieces.depth_um[k]) / (1e3 * half_mm(i)), l = piece_length(v, k);
    EXPECT_NEAR(v.pieces.left[k], share, 1e-9);
    EXPECT_EQ(v.pieces.is_narrowed(k), share < 1 - 1e-9);
    for (int strip = 0; strip < strips; ++strip) left[strip] += l * std::clamp(strips * share - strip, 0.0, 1.0);
  }
  for (int strip = 0; strip < strips; ++strip) {
    left[strip] = left[strip] / out.counted[strip] - 1;
    out.counted[strip] /= whole;
  }
  return out;
}

Scratches strewn_of_any_depth(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  Scratches s = strewn(random);
  for (std::size_t i = 0; i < s.size(); ++i) s.depth_um.push_back(kDepthUm * (0.85 + 0.3 * unit(random)));
  return s;
}

// Of as many strips as there are steps.
TEST(VisiblePieces, OfTheDeepestEachStripIsLeftAsPointsCountIt) {
  std::mt19937_64 random(8);
  const StripsLeft left = strips_left(strewn_of_any_depth(random), kCrossingSteps, kCrossingSteps, random);
  EXPECT_LT(left.counted[2], 0.8);  // rims are taken away,
  EXPECT_GT(left.counted[0], 0.9);  // middles hardly are
  for (int strip = 0; strip < kCrossingSteps; ++strip) EXPECT_NEAR(left.off[strip], 0, 0.015) << strip;
}

// At a step's beginning more is hidden than should be, at its end less: what tells a depth lies at the last one's end.
TEST(VisiblePieces, FinerStepsLeaveEachLeanAsPointsCountIt) {
  std::mt19937_64 random(8);
  const Scratches s = strewn_of_any_depth(random);
  constexpr int kStrips = 16;
  const auto worst = [&](int steps) {
    double out = 0;
    for (const double off : strips_left(s, kStrips, steps, random).off) out = std::max(out, std::abs(off));
    return out;
  };
  const double coarse = worst(kCrossingSteps);
  EXPECT_GT(coarse, 0.03);
  EXPECT_LT(worst(8), 0.5 * coarse);
}

TEST(VisiblePieces, TakeMoreStepsWhereGroovesCrowd) {
  EXPECT_EQ(crossing_steps_for(0), kCrossingSteps);
  EXPECT_EQ(crossing_steps_for(0.2), kCrossingSteps);
  EXPECT_EQ(crossing_steps_for(0.53), 6);
  EXPECT_EQ(crossing_steps_for(5), kMostCrossingSteps);
}

// What decides how much of a board is cut at a time.
// Burrs stand where no other groove is, whichever came first.
TEST(VisiblePieces, BurrsAreLeftWherePointsFindNoGroove) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(0, 1);
  const Scratches s = strewn(random);
  const double w = half_width_mm();
  GrooveProfile profile;
  profile.burr_left_um = profile.burr_right_um = 3;
  profile.burr_width_um = 20;
  const std::vector<Lie> lies = lies_of(s);
  double whole = 0, counted = 0;
  constexpr int kPoints = 1500;
  for (std::size_t i = 0; i < s.size(); ++i) {
    whole += lies[i].length;
    for (int k = 0; k < kPoints; ++k) {
      const double side = k % 2 == 0 ? -1 : 1, off_mm = side * (w + 1e-3 * profile.burr_width_um * unit(random));
      const Point p = point_on(lies[i], unit(random), off_mm);
      bool covered = false;
      for (std::size_t j = 0; j < s.size() && !covered; ++j) covered = j != i && across_at(lies[j], w, p).has_value();
      if (!covered) counted += lies[i].length / kPoints;
    }
  }
  EXPECT_LT(counted, 0.8 * whole);
  for (const Crossings rule : {Crossings::last, Crossings::deepest}) {
    const VisiblePieces v = visible_pieces(s, kWidthUm, kDepthUm, profile, rule);
    double left = 0;
    for (std::size_t k = 0; k < v.source.size(); ++k)
      if (!v.pieces.is_narrowed(k)) left += piece_length(v, k);
    EXPECT_NEAR(left / counted, 1, 0.015) << in_words(rule);
    // Of the grooves themselves as much is left as without burrs.
    const VisiblePieces bare = visible_pieces(s, kWidthUm, kDepthUm, {}, rule);
    double with_burrs = 0, without = 0;
    for (std::size_t k = 0; k < v.source.size(); ++k)
      if (v.pieces.left[k] >= kAllButBurrs) with_burrs += piece_length(v, k);
    for (std::size_t k = 0; k < bare.source.size(); ++k)
      if (!bare.pieces.is_narrowed(k)) without += piece_length(bare, k);
    EXPECT_NEAR(with_burrs / without, 1, 1e-3) << in_words(rule);
  }
}

TEST(VisiblePieces, AreForetoldForGroovesInAnyDirection) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 60), turn(0, 2 * std::numbers::pi), length(2, 12);
  for (const int count : {600, 1500}) {
    Scratches s;
    for (int i = 0; i < count; ++i) {
      const double x = place(random), y = place(random), a = turn(random), l = length(random);
      s.x0_mm.push_back(x);
      s.y0_mm.push_back(y);
      s.x1_mm.push_back(x + l * std::cos(a));
      s.y1_mm.push_back(y + l * std::sin(a));
    }
    const auto pieces =
        static_cast<double>(visible_pieces(s, kWidthUm, kDepthUm, {}, Crossings::deepest).pieces.size());
    EXPECT_GT(expected_pieces(s, 66 * 66), 0.4 * pieces) << count;
    EXPECT_LT(expected_pieces(s, 66 * 66), 2 * pieces) << count;
  }
}

TEST(VisiblePieces, AreCountedAsTheyAreMade) {
  std::mt19937_64 random(5);
  const Scratches s = strewn(random);
  GrooveProfile with_burrs;
  with_burrs.burr_left_um = 1;
  with_burrs.burr_width_um = 10;
  for (const GrooveProfile& profile : {GrooveProfile{}, with_burrs})
    for (const Crossings rule : {Crossings::last, Crossings::deepest}) {
      const std::size_t made = visible_pieces(s, kWidthUm, kDepthUm, profile, rule).source.size();
      ASSERT_GT(made, s.size());
      EXPECT_FALSE(are_more_pieces(s, kWidthUm, kDepthUm, profile, rule, made));
      EXPECT_TRUE(are_more_pieces(s, kWidthUm, kDepthUm, profile, rule, made - 1));
    }
  EXPECT_FALSE(are_more_pieces(s, kWidthUm, kDepthUm, {}, Crossings::add, 0));  // nothing is cut
}

TEST(VisiblePieces, MoreThanAMachineHoldsAreRefused) {
  Scratches s;  // a grid: each crosses half of all
  constexpr int kEachWay = 1200;
  for (int i = 0; i < 2 * kEachWay; ++i) {
    const double at = 0.25 * (i / 2), end = 0.25 * kEachWay;
    s.x0_mm.push_back(i % 2 == 0 ? at : 0);
    s.x1_mm.push_back(i % 2 == 0 ? at : end);
    s.y0_mm.push_back(i % 2 == 0 ? 0 : at);
    s.y1_mm.push_back(i % 2 == 0 ? end : at);
  }
  EXPECT_THAT([&] { visible_pieces(s, kWidthUm, kDepthUm, {}, Crossings::deepest); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("more than 5002400 pieces; let their light add there")));
}

// All cross all, at one place or over their whole length: as many pairs as would take minutes, of which hardly a piece
// is left. As few as a person may carve are cut.
TEST(VisiblePieces, ACrowdIsRefusedBeforeItIsLookedAt) {
  const auto crowd = [](int count, bool star) {
    Scratches s;
    for (int i = 0; i < count; ++i) {
      const double turn = star ? std::numbers::pi * i / count : 0.5, x = 20 * std::cos(turn), y = 20 * std::sin(turn);
      add(s, 40 - x, 40 - y, 40 + x, 40 + y);
    }
    return s;
  };
  for (const Crossings rule : {Crossings::last, Crossings::deepest})
    for (const bool star : {false, true}) {
      EXPECT_THAT([&] { visible_pieces(crowd(20'000, star), 60, kDepthUm, {}, rule); },
                  testing::ThrowsMessage<Error>(testing::HasSubstr("lie more than 100000000 times near one another")));
      EXPECT_TRUE(are_more_pieces(crowd(20'000, star), 60, kDepthUm, {}, rule, 1'000'000'000));
      EXPECT_NO_THROW(visible_pieces(crowd(500, star), 60, kDepthUm, {}, rule));
    }
}

}  // namespace
}  // namespace burin
