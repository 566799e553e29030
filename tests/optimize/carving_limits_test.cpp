// Proves: the rules of a board and a machine are judged exactly, and what is mended obeys them. The oracle for
// keep-outs and overlaps is brute force: points along a scratch, and points strewn over a groove.
#include "burin/optimize/toolpath/carving_limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <numbers>
#include <random>

#include "burin/base/error.h"
#include "burin/optimize/toolpath/groove_pairs.h"
#include "burin/scene/groove.h"
#include "burin/scene/keep_out.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Board board_100() {
  Board board;
  board.size_mm = board.carve_max_mm = {100, 100};
  board.tool_width_um = 400;
  board.material.depth_um = 12;
  return board;
}

CarvingLimits limits_for(const Board& board, const MachineLimits& machine = {}) {
  return carving_limits(board, machine, board.material.depth_um, CarvingLimits().affine);
}

Scratches scratches_up_to(std::size_t count, double longest_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-2, 102), turn(0, std::numbers::pi), length(0.01, longest_mm);
  Scratches s;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place(random), y = place(random), angle = turn(random), l = length(random);
    s.x0_mm.push_back(x), s.y0_mm.push_back(y);
    s.x1_mm.push_back(x + l * std::cos(angle)), s.y1_mm.push_back(y + l * std::sin(angle));
  }
  return s;
}

std::size_t broken(const LimitsCheck& check, Rule rule) { return check.broken[static_cast<std::size_t>(rule)]; }

const std::vector<KeepOut> kPlaces{
    {"hole", {}, {30, 30}, 5},
    {"clamp", {{0, 60}, {20, 60}, {20, 80}, {0, 80}}, {}, 0},
    {"hook", {{60, 20}, {90, 20}, {90, 50}, {80, 50}, {80, 30}, {60, 30}}, {}, 0},  // hollow: an L
};

// Pairs are counted before they are looked at: a star of 20,000 would take hours, one of 300 does not.
TEST(CarvingLimits, ACrowdIsRefusedBeforeItIsJudged) {
  const auto star = [](int count) {
    Scratches s;
    for (int i = 0; i < count; ++i) {
      const double turn = std::numbers::pi * i / count, x = 20 * std::cos(turn), y = 20 * std::sin(turn);
      s.x0_mm.push_back(50 - x), s.y0_mm.push_back(50 - y);
      s.x1_mm.push_back(50 + x), s.y1_mm.push_back(50 + y);
    }
    return s;
  };
  MachineLimits distance, overlap, grooves;
  distance.distance_mm = 0.1;
  overlap.max_overlap = 0.5;
  grooves.max_grooves = 3;
  for (const MachineLimits& machine : {distance, overlap, grooves}) {
    const CarvingLimits limits = limits_for(board_100(), machine);
    EXPECT_THAT([&] { fail_if_crowded(star(20'000), limits); },
                ThrowsMessage<Error>(AllOf(HasSubstr("20000 scratches: lie more than 100000000 times near one another"),
                                           HasSubstr("max_overlap"))));
    EXPECT_NO_THROW(fail_if_crowded(star(300), limits));
  }
  EXPECT_NO_THROW(fail_if_crowded(star(20'000), limits_for(board_100()))) << "nothing concerns pairs";
  EXPECT_EQ(broken(check_limits(star(300), limits_for(board_100(), grooves)), Rule::grooves), 300U);
}

TEST(KeepOut, FreePartsAreThoseThatBruteForceFindsFree) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 100);
  int cut = 0;
  for (int k = 0; k < 400; ++k) {
    const Eigen::Vector2d a(place(random), place(random)), b(place(random), place(random));
    const double clearance = k % 3;
    const std::vector<LinePart> free = free_parts(a, b, kPlaces, clearance);
    cut += free.size() != 1 || free[0].second - free[0].first < 1;
    constexpr int kPoints = 500;
    for (int i = 0; i <= kPoints; ++i) {
      const double t = static_cast<double>(i) / kPoints;
      double nearest = INFINITY;
      for (const KeepOut& p : kPlaces) nearest = std::min(nearest, distance_mm(a + t * (b - a), p));
      const bool is_free =
          std::any_of(free.begin(), free.end(), [t](const LinePart& p) { return t >= p.first && t <= p.second; });
      if (std::abs(nearest - clearance) > 1e-6) {
        EXPECT_EQ(is_free, nearest > clearance) << "at " << t;
      }
    }
  }
  EXPECT_GT(cut, 100);
}

TEST(GroovePairs, CommonAreaIsWhatStrewnPointsFind) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 4), one(0, 1);
  for (int k = 0; k < 20; ++k) {
    const Groove a{{place(random), place(random)}, {place(random), place(random)}, 0.4};
    const Groove b{{place(random), place(random)}, {place(random), place(random)}, 0.3};
    const Eigen::Vector2d u = (a.b_mm - a.a_mm).normalized(), n(-u.y(), u.x());
    const Eigen::Vector2d v = (b.b_mm - b.a_mm).normalized();
    int inside = 0;
    constexpr int kPoints = 40000;
    for (int i = 0; i < kPoints; ++i) {
      const Eigen::Vector2d p =
          a.a_mm + one(random) * (a.b_mm - a.a_mm) + (2 * one(random) - 1) * a.half_width_mm * n - b.a_mm;
      inside += p.dot(v) >= 0 && p.dot(v) <= (b.b_mm - b.a_mm).norm() &&
                std::abs(v.x() * p.y() - v.y() * p.x()) <= b.half_width_mm;
    }
    const double expected = static_cast<double>(inside) / kPoints * a.area_mm2();
    EXPECT_NEAR(area_mm2(common_part(a, b)), expected, 0.015 * a.area_mm2());
    EXPECT_NEAR(area_mm2(common_part(a, b)), area_mm2(common_part(b, a)), 1e-12);
  }
}

TEST(GroovePairs, DistanceIsZeroOnlyWhereTheLinesMeet) {
  const Groove flat{{0, 0}, {10, 0}, 0.1};
  EXPECT_EQ(line_distance_mm(flat, {{5, -1}, {5, 1}, 0.1}), 0);
  EXPECT_EQ(line_distance_mm(flat, {{5, 0}, {5, 1}, 0.1}), 0);
  EXPECT_DOUBLE_EQ(line_distance_mm(flat, {{5, 0.25}, {5, 1}, 0.1}), 0.25);
  EXPECT_DOUBLE_EQ(line_distance_mm(flat, {{0, 2}, {10, 2}, 0.1}), 2);
  EXPECT_DOUBLE_EQ(line_distance_mm(flat, {{13, 4}, {20, 4}, 0.1}), 5);
}

TEST(GroovePairs, MostAtAPlaceIsWhatStrewnPointsFind) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(0, 3);
  for (int k = 0; k < 10; ++k) {
    std::vector<std::vector<Eigen::Vector2d>> parts;
    const Groove whole{{-1, 1.5}, {4, 1.5}, 3};
    std::vector<Groove> grooves;
    for (int i = 0; i < 8; ++i) {
      grooves.push_back({{place(random), place(random)}, {place(random), place(random)}, 0.3});
      parts.push_back(common_part(whole, grooves.back()));
    }
    int most = 0;
    for (double x = -1; x < 4; x += 0.01)
      for (double y = -1; y < 4; y += 0.01) {
        int here = 0;
        for (const Groove& g : grooves) {
          const Eigen::Vector2d u = (g.b_mm - g.a_mm).normalized(), p = Eigen::Vector2d(x, y) - g.a_mm;
          here += p.dot(u) >= 0 && p.dot(u) <= (g.b_mm - g.a_mm).norm() &&
                  std::abs(u.x() * p.y() - u.y() * p.x()) <= g.half_width_mm;
        }
        most = std::max(most, here);
      }
    EXPECT_EQ(most_at_a_place(parts, 100), most);
    EXPECT_GT(most_at_a_place(parts, 1), 1);
  }
}

TEST(CarvingLimits, EachRuleIsJudgedAndNamed) {
  Board board = board_100();
  board.keep_out = kPlaces;
  board.tags.list = {{4, {50, 90}, 10, 0}};
  MachineLimits machine;
  machine.step_mm = 0.01;
  machine.shortest_mm = 1;
  machine.longest_mm = 10;
  machine.distance_mm = 0.2;
  machine.max_overlap = 0.1;
  machine.max_grooves = 2;
  const CarvingLimits limits = limits_for(board, machine);
  const auto judge = [&](const Scratches& s, Rule rule, const std::string& words) {
    const LimitsCheck check = check_limits(s, limits);
    EXPECT_GT(broken(check, rule), 0U) << words;
    EXPECT_THAT(check.first, HasSubstr(words));
    EXPECT_THAT([&] { fail_unless_good(check, "here"); },
                ThrowsMessage<Error>(AllOf(HasSubstr("here: scratch in row"), HasSubstr("; "))));
  };
  EXPECT_TRUE(check_limits({{50, 50}, {50, 51}, {52, 52}, {50, 51}, {}, {}, {}}, limits).good());
  judge({{50}, {50}, {50.5}, {50}, {}, {}, {}}, Rule::shortest, "is 0.5 mm long; the machine carves no less than 1 mm");
  judge({{50}, {50}, {61}, {50}, {}, {}, {}}, Rule::longest, "no more than 10 mm");
  judge({{99}, {50}, {101}, {50}, {}, {}, {}}, Rule::area, "leaves the board's carve area at (101.000, 50.000) mm");
  judge({{50.005}, {50}, {52}, {50}, {}, {}, {}}, Rule::step, "machine's steps of 0.01 mm");
  judge({{28}, {33}, {32}, {33}, {}, {}, {}}, Rule::keep_out, "\"hole\"");
  judge({{50}, {85}, {52}, {85}, {}, {}, {}}, Rule::keep_out, "\"tag 4\"");
  // The tag's paper is 18 mm wide and ends at y = 81; the groove is 0.048 mm to each side.
  EXPECT_TRUE(check_limits({{50}, {80.9}, {52}, {80.9}, {}, {}, {}}, limits).good());
  judge({{50}, {80.96}, {52}, {80.96}, {}, {}, {}}, Rule::keep_out, "\"tag 4\"");
  judge({{50, 50}, {50, 50.15}, {52, 52}, {50, 50.15}, {}, {}, {}}, Rule::distance,
        "runs 0.15 mm next to the one in row 2");
  judge({{50, 50}, {50, 49.97}, {52, 52}, {50, 50.03}, {}, {}, {}}, Rule::overlap, "of its groove to others");
  judge({{46, 51, 54}, {50, 46, 47}, {55, 51, 48}, {50, 54, 53}, {}, {}, {}}, Rule::grooves, "more than 2 grooves lie");
  judge({{50}, {50}, {52}, {50}, {500}, {}, {}}, Rule::width, "the board's tool");
}

TEST(CarvingLimits, TheMachinesMapIsInTheSteps) {
  MachineLimits machine;
  machine.step_mm = 0.0125;
  Board board = board_100();
  CarvingLimits limits = limits_for(board, machine);
  limits.affine << 1.001, 0.002, 0.31, -0.0015, 0.9985, -0.17;
  const Mended mended = mend(scratches_up_to(500, 6, 5), limits);
  EXPECT_GT(mended.rows.size(), 450U);
  for (std::size_t i = 0; i < mended.scratches.size(); ++i) {
    const Eigen::Vector2d p(mended.scratches.x0_mm[i], mended.scratches.y0_mm[i]);
    const Eigen::Vector2d told = limits.affine.leftCols<2>().inverse() * (p - limits.affine.col(2)) / 0.0125;
    EXPECT_LT((told.array() - told.array().round()).abs().maxCoeff() * 0.0125, 2e-5);
  }
  EXPECT_TRUE(check_limits(mended.scratches, limits).good());
}

class Mending : public ::testing::TestWithParam<int> {};

TEST_P(Mending, WhatIsMendedObeysEveryRuleAlsoFromItsFile) {
  std::mt19937 random(GetParam());
  std::uniform_real_distribution<double> one(0, 1);
  Board board = board_100();
  board.carve_min_mm = {5.123456, 4};
  board.carve_max_mm = {95, 96.7654321};
  board.keep_out = kPlaces;
  board.tags.list = {{4, {50, 90}, 10, 30}};
  MachineLimits machine;
  machine.step_mm = GetParam() % 2 ? 0.0125 : 0;
  machine.shortest_mm = 0.5 + one(random);
  machine.longest_mm = machine.shortest_mm + 0.1 + 5 * one(random);
  machine.distance_mm = GetParam() % 3 ? 0.1 * one(random) + 1e-3 : 0;
  machine.max_overlap = GetParam() % 4 ? 0.02 + 0.2 * one(random) : 0;
  machine.max_grooves = GetParam() % 5;
  CarvingLimits limits = limits_for(board, machine);
  if (GetParam() % 2) limits.affine << 1.001, 0.002, 0.31, -0.0015, 0.9985, -0.17;
  const Scratches given = scratches_up_to(1500, 8, GetParam() + 100);
  std::vector<double> worth;
  for (std::size_t i = 0; i < given.size(); ++i) worth.push_back(one(random));
  const Mended mended = mend(given, limits, worth);
  std::size_t dropped = 0;
  for (const std::size_t n : mended.dropped) dropped += n;
  EXPECT_EQ(mended.rows.size() + dropped, given.size());
  EXPECT_GT(mended.rows.size(), given.size() / 8);
  const TemporaryFolder folder;
  write_scratches(mended.scratches, folder / "scratches.csv");
  const LimitsCheck check = check_limits(read_scratches(folder / "scratches.csv"), limits);
  EXPECT_TRUE(check.good()) << check.first;
  EXPECT_FALSE(check_limits(given, limits).good());
  // Mending what is mended changes nothing.
  const Mended again = mend(mended.scratches, limits);
  EXPECT_EQ(again.rows.size(), mended.rows.size());
  EXPECT_LT(again.moved_mm, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Random, Mending, ::testing::Range(0, 12));

TEST(CarvingLimits, WorthDecidesWhichOfTwoStays) {
  MachineLimits machine;
  machine.max_grooves = 1;
  const CarvingLimits limits = limits_for(board_100(), machine);
  const Scratches cross{{50, 51}, {50, 49}, {52, 51}, {50, 51}, {}, {}, {}};
  EXPECT_EQ(mend(cross, limits, std::vector<double>{1, 2}).rows, std::vector<std::size_t>{1});
  EXPECT_EQ(mend(cross, limits, std::vector<double>{2, 1}).rows, std::vector<std::size_t>{0});
}

TEST(CarvingLimits, AHairAsideOrAShorterEndKeepsAScratch) {
  MachineLimits machine;
  machine.distance_mm = 0.1;
  const CarvingLimits limits = limits_for(board_100(), machine);
  // One ends just short of another, one runs close beside it, one is far from both.
  const Scratches near{{40, 50, 45, 20}, {50, 50.03, 50.05, 20}, {60, 50, 55, 25}, {50, 55, 50.05, 20}, {}, {}, {}};
  EXPECT_EQ(broken(check_limits(near, limits), Rule::distance), 3U);
  const Mended mended = mend(near, limits, std::vector<double>{3, 2, 1, 1});
  EXPECT_EQ(mended.rows.size(), 4U);
  EXPECT_TRUE(check_limits(mended.scratches, limits).good());
  EXPECT_EQ(mended.scratches.x0_mm[0], 40);  // the worthiest stays
  EXPECT_LT(mended.moved_mm, 2.5 * machine.distance_mm);
  EXPECT_GT(mended.moved_mm, 0);
  // Two that share all of their grooves' overlap at their ends: the less worthy gives way by its length.
  machine.distance_mm = 0;
  machine.max_grooves = 1;
  const Scratches cross{{40, 48}, {50, 49}, {52, 48}, {50, 59}, {}, {}, {}};
  const Mended cut = mend(cross, limits_for(board_100(), machine), std::vector<double>{2, 1});
  EXPECT_EQ(cut.rows.size(), 2U);
  EXPECT_NEAR(cut.scratches.y0_mm[1], 51, 1e-4);  // a fifth of ten
  EXPECT_EQ(cut.scratches.y1_mm[1], 59);
}

TEST(CarvingLimits, WhatIsCarvedStaysAndCounts) {
  MachineLimits machine;
  machine.max_grooves = 1;
  machine.shortest_mm = 1;
  const CarvingLimits limits = limits_for(board_100(), machine);
  // The carved one is too short and stays; the new one crosses it and goes, however much it is worth.
  Scratches s{{50, 50.2, 20}, {50, 49, 20}, {50.4, 50.2, 22}, {50, 51, 20}, {}, {}, {}};
  s.carved = {1, 0, 0};
  EXPECT_EQ(broken(check_limits(s, limits), Rule::grooves), 1U);
  EXPECT_EQ(broken(check_limits(s, limits), Rule::shortest), 0U);
  const Mended mended = mend(s, limits, std::vector<double>{0, 10, 1});
  EXPECT_EQ(mended.rows, (std::vector<std::size_t>{0, 2}));
  EXPECT_TRUE(check_limits(mended.scratches, limits).good());
}

TEST(CarvingLimits, AScratchIsCutOffAtAKeepOutOrGoesBack) {
  Board board = board_100();
  board.keep_out = kPlaces;
  MachineLimits machine;
  machine.shortest_mm = 1;
  const CarvingLimits limits = limits_for(board, machine);
  const double half_width = 1e-3 * half_width_um(board.tool_width_um, board.material.depth_um);
  Scratches s{{20, 29}, {30, 30}, {31, 31}, {30, 30}, {}, {}, {}};
  ASSERT_TRUE(confine(s, 0, limits, {20, 30}, {24, 30}));
  EXPECT_EQ(s.x0_mm[0], 20);
  EXPECT_NEAR(s.x1_mm[0], 25 - half_width, 1e-4);
  ASSERT_TRUE(confine(s, 1, limits, {20, 40}, {22, 40}));  // all within the hole: back to where it was
  EXPECT_EQ(s.y0_mm[1], 40);
  s.x0_mm[1] = 29, s.y0_mm[1] = 30, s.x1_mm[1] = 31, s.y1_mm[1] = 30;
  EXPECT_FALSE(confine(s, 1, limits, {29, 30}, {31, 30}));
  EXPECT_EQ(s.x0_mm[1], 29);
}

}  // namespace
}  // namespace burin
