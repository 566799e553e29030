// What is proved: the one way from a design to the metal. Compensation and the machine's map cancel; each groove gets
// the depth of its place and of its age; what is carved already stays as it is and lies under what comes after; grooves
// that are cut keep the area that later ones leave; and the gradient that comes back is that of finite differences,
// through all of it at once. Not proved: that real machines and grooves do so (the rigs' tests).
#include "burin/scene/carve.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <random>

#include "burin/base/error.h"
#include "burin/scene/groove.h"

namespace burin {
namespace {

Board small_board() {
  Board board;
  board.size_mm = {100, 50};
  board.tool_width_um = 400;
  board.material.depth_um = 10;
  board.material.alpha = 0.05;
  return board;
}

// A machine that shrinks, turns and shifts by a few tenths of a per cent, grooves deeper and rougher than believed.
Bench worn_bench() {
  Bench bench;
  bench.machine_affine << 1.004, 0.002, 0.15, -0.001, 0.997, -0.2;
  bench.material.depth_um = 14;
  bench.material.alpha = 0.06;
  bench.depth_field.terms = {0.08, -0.05, 0.03, 0.02, -0.04, 0.04};
  bench.alpha_field.terms = {-0.06, 0.03, 0, 0.05, 0, 0};
  return bench;
}

Scratches strewn(std::size_t count, std::uint64_t seed, double longest_mm = 12) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> x(10, 90), y(10, 40), turn(0, 2 * std::numbers::pi),
      length(0.3 * longest_mm, longest_mm);
  Scratches s;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = turn(random), half = length(random) / 2, cx = x(random), cy = y(random);
    s.x0_mm.push_back(cx - half * std::cos(a));
    s.y0_mm.push_back(cy - half * std::sin(a));
    s.x1_mm.push_back(cx + half * std::cos(a));
    s.y1_mm.push_back(cy + half * std::sin(a));
  }
  return s;
}

double farthest(const Scratches& a, const Scratches& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0;
  for (const auto column : {&Scratches::x0_mm, &Scratches::y0_mm, &Scratches::x1_mm, &Scratches::y1_mm})
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs((a.*column)[i] - (b.*column)[i]));
  return most;
}

TEST(Carve, ACompensatedDesignLiesWhereItIsWanted) {
  const Board board = small_board();
  for (const Crossings crossings : {Crossings::add, Crossings::last, Crossings::deepest}) {
    Bench bench = worn_bench();
    bench.crossings = crossings;
    Designed design(strewn(60, 1));
    design.scratches.depth_um.assign(60, 12);
    design.scratches.alpha.assign(60, 0.07);
    const Carved direct = carve(design, bench, board);
    const Carved by_machine = carve(compensated(design, bench, board), bench, board);
    EXPECT_LT(farthest(direct.scratches, by_machine.scratches), 1e-10);
    for (std::size_t i = 0; i < direct.size(); ++i) {
      EXPECT_NEAR(direct.scratches.depth_um[i], by_machine.scratches.depth_um[i], 1e-10);
      EXPECT_NEAR(direct.scratches.alpha[i], by_machine.scratches.alpha[i], 1e-12);
    }
    EXPECT_EQ(direct.source, by_machine.source);
  }
}

TEST(Carve, WithoutFieldsAndCutsADesignIsWhatItIs) {
  Bench bench;
  bench.machine_affine << 1.01, 0, 3, 0, 0.99, -2;
  const Designed design(strewn(20, 2));
  const Carved carved = carve(design, bench, small_board());
  EXPECT_EQ(carved.scratches.x0_mm, design.scratches.x0_mm);
  EXPECT_EQ(carved.scratches.y1_mm, design.scratches.y1_mm);
  EXPECT_TRUE(carved.scratches.depth_um.empty());
  EXPECT_TRUE(carved.source.empty());
}

TEST(Carve, WhatTheMachineIsToldGoesThroughItsMapAndToItsDepth) {
  const Board board = small_board();
  Bench bench = worn_bench();
  bench.depth_field = bench.alpha_field = {};
  Sent sent;
  sent.scratches.x0_mm = {10};
  sent.scratches.y0_mm = {20};
  sent.scratches.x1_mm = {30};
  sent.scratches.y1_mm = {40};
  sent.scratches.depth_um = {5};  // half of what the board's material is believed to be
  const Carved carved = carve(sent, bench, board);
  EXPECT_NEAR(carved.scratches.x0_mm[0], 1.004 * 10 + 0.002 * 20 + 0.15, 1e-12);
  EXPECT_NEAR(carved.scratches.y1_mm[0], -0.001 * 30 + 0.997 * 40 - 0.2, 1e-12);
  EXPECT_NEAR(carved.scratches.depth_um[0], 7, 1e-12);
}

TEST(Carve, EachGrooveHasTheDepthOfItsPlaceAndItsAge) {
  Scratches s;
  s.x0_mm = {0, 40, 90};
  s.x1_mm = {20, 60, 110};
  s.y0_mm = s.y1_mm = {10, 25, 45};
  Bench bench;
  bench.material.depth_um = 10;
  bench.depth_field.terms = {0.2, 0, 0, 0, 0, 0.1};
  const Scratches carved = carve(Designed(s), bench, small_board()).scratches;
  ASSERT_EQ(carved.depth_um.size(), 3U);
  EXPECT_NEAR(carved.depth_um[0], 10 * (1 + 0.2 * -0.4) * (1 + 0.1 * 0.5), 1e-12);
  EXPECT_NEAR(carved.depth_um[1], 10, 1e-12);
  EXPECT_NEAR(carved.depth_um[2], 10 * (1 + 0.2 * 0.5) * (1 - 0.1 * 0.5), 1e-12);
  EXPECT_TRUE(carved.alpha.empty());  // constant: nothing is written
}

TEST(Carve, FieldsStayWithinWhatGroovesCanBe) {
  Bench bench;
  bench.material.alpha = 0.5;
  bench.depth_field.terms[0] = bench.alpha_field.terms[0] = 10;
  const Scratches carved = carve(Designed(strewn(30, 3)), bench, small_board()).scratches;
  for (std::size_t i = 0; i < carved.size(); ++i) {
    EXPECT_GT(carved.depth_um[i], 0);
    EXPECT_GT(carved.alpha[i], 0);
    EXPECT_LE(carved.alpha[i], 1);
  }
}

TEST(Carve, WhatIsInTheMetalStaysAndLiesUnderWhatComesAfter) {
  const Board board = small_board();
  Bench bench = worn_bench();
  bench.crossings = Crossings::last;
  Scratches s;  // a new groove, and one across it that was carved on another day, though it stands after it in the file
  s.x0_mm = {40, 50};
  s.y0_mm = {25, 15};
  s.x1_mm = {60, 50};
  s.y1_mm = {25, 35};
  s.depth_um = {12, 9};
  s.carved = {0, 1};
  for (const bool sent : {false, true}) {
    const Carved carved = sent ? carve(Sent(s), bench, board) : carve(Designed(s), bench, board);
    ASSERT_EQ(carved.size(), 3U) << sent;
    // The old one in two pieces, untouched by map and field.
    EXPECT_EQ(carved.source, (std::vector<std::uint32_t>{1, 1, 0}));
    EXPECT_EQ(carved.scratches.x0_mm[0], 50);
    EXPECT_EQ(carved.scratches.y0_mm[0], 15);
    EXPECT_EQ(carved.scratches.depth_um[0], 9);
    const double half_mm = 1e-3 * half_width_um(board.tool_width_um, carved.scratches.depth_um[2]);
    const double gap = carved.scratches.y0_mm[1] - carved.scratches.y1_mm[0];
    EXPECT_NEAR(gap, 2 * half_mm, 1e-3 * half_mm);
  }
}

// What photos of a part of the board need: inside the boxes the metal is the whole's, whoever ends or is cut outside.
TEST(Carve, InPlacesThatAreLookedAtGroovesAreThoseOfTheWhole) {
  const Board board = small_board();
  Bench bench = worn_bench();
  bench.material.profile.burr_left_um = 2;
  bench.machine_errors.backlash_mm = {0.05, 0.02};
  bench.machine_errors.screw_sin_mm = {0.02, 0.01};
  bench.machine_errors.screw_period_mm = {3, 4};
  const Sent sent(strewn(400, 11));
  const Eigen::AlignedBox2d left(Eigen::Vector2d(15, 12), Eigen::Vector2d(30, 30)),
      overlapping(Eigen::Vector2d(25, 20), Eigen::Vector2d(38, 33));
  const std::array places{left, overlapping};
  const auto inside = [&](const Eigen::Vector2d& p) {  // further from a side than a groove is wide
    const Eigen::Vector2d rim(0.5, 0.5);
    return std::any_of(places.begin(), places.end(), [&](const Eigen::AlignedBox2d& box) {
      return ((p - rim).array() > box.min().array()).all() && ((p + rim).array() < box.max().array()).all();
    });
  };
  for (const Crossings rule : {Crossings::add, Crossings::last, Crossings::deepest}) {
    bench.crossings = rule;
    // Of each row, summed over what lies inside, however it is cut.
    const auto rows = [&](const Carved& carved) {
      std::map<std::uint32_t, Eigen::Vector3d> out;  // length, and the same times depth and what is left
      const Scratches& s = carved.scratches;
      for (std::size_t i = 0; i < carved.size(); ++i) {
        const Eigen::Vector2d p0(s.x0_mm[i], s.y0_mm[i]), p1(s.x1_mm[i], s.y1_mm[i]);
        constexpr int kSteps = 400;
        int count = 0;
        for (int k = 0; k < kSteps; ++k) count += inside(p0 + (k + 0.5) / kSteps * (p1 - p0)) ? 1 : 0;
        if (count == 0) continue;
        const double length = (p1 - p0).norm() * count / kSteps;
        const double left_of = s.left.empty() ? 1 : s.left[i], depth = s.depth_um[i];
        out.try_emplace(carved.source[i], Eigen::Vector3d::Zero()).first->second +=
            length * Eigen::Vector3d(1, depth, left_of);
      }
      return out;
    };
    const auto whole = rows(carve(sent, bench, board)), part = rows(carve(sent, bench, board, places));
    ASSERT_EQ(whole.size(), part.size());
    EXPECT_GT(whole.size(), 60U);
    EXPECT_LT(whole.size(), sent.size());
    for (const auto& [row, sums] : whole) {
      ASSERT_TRUE(part.count(row)) << row;
      const Eigen::Vector3d other = part.at(row);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(sums[i], other[i], 0.01 * sums[i] + 0.02) << row << ' ' << i;
    }
  }
}

TEST(Carve, PiecesInPlacesKnowWhereAlongTheirRowsTheyLie) {
  const Board board = small_board();
  Bench bench;
  bench.crossings = Crossings::last;
  const Sent sent(strewn(200, 12));
  const std::array places{Eigen::AlignedBox2d(Eigen::Vector2d(20, 15), Eigen::Vector2d(60, 30))};
  const Carved carved = carve(sent, bench, board, places);
  ASSERT_GT(carved.size(), 100U);
  const Scratches &s = sent.scratches, &pieces = carved.scratches;
  for (std::size_t k = 0; k < carved.size(); ++k) {
    const std::uint32_t row = carved.source[k];
    const Eigen::Vector2d p0(s.x0_mm[row], s.y0_mm[row]), along(s.x1_mm[row] - p0.x(), s.y1_mm[row] - p0.y());
    const Eigen::Vector2d from = p0 + carved.begin[k].at * along, to = p0 + carved.end[k].at * along;
    EXPECT_NEAR((from - Eigen::Vector2d(pieces.x0_mm[k], pieces.y0_mm[k])).norm(), 0, 1e-9);
    EXPECT_NEAR((to - Eigen::Vector2d(pieces.x1_mm[k], pieces.y1_mm[k])).norm(), 0, 1e-9);
  }
}

TEST(Carve, RefusesAMapThatCannotBeUndone) {
  Bench bench;
  bench.machine_affine << 1, 2, 0, 2, 4, 0;
  EXPECT_THROW(compensated(Designed(strewn(2, 4)), bench, small_board()), Error);
}

// E is a fixed random linear function of all that is carved, so that its gradient by the carved rows is known.
struct LinearE {
  std::vector<double> weight;
  explicit LinearE(std::size_t count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<> normal;
    for (std::size_t i = 0; i < 6 * count; ++i) weight.push_back(normal(random));
  }
  double operator()(const Carved& c) const {
    double e = 0;
    for (std::size_t i = 0; i < c.size(); ++i)
      e += weight[6 * i] * c.scratches.x0_mm[i] + weight[6 * i + 1] * c.scratches.y0_mm[i] +
           weight[6 * i + 2] * c.scratches.x1_mm[i] + weight[6 * i + 3] * c.scratches.y1_mm[i] +
           (c.scratches.depth_um.empty() ? 0 : weight[6 * i + 4] * c.scratches.depth_um[i]) +
           (c.scratches.alpha.empty() ? 0 : 100 * weight[6 * i + 5] * c.scratches.alpha[i]);
    return e;
  }
  ScratchGradients gradient(const Carved& c) const {
    ScratchGradients g;
    g.resize(c.size());
    for (std::size_t i = 0; i < c.size(); ++i) {
      g.x0_mm[i] = weight[6 * i];
      g.y0_mm[i] = weight[6 * i + 1];
      g.x1_mm[i] = weight[6 * i + 2];
      g.y1_mm[i] = weight[6 * i + 3];
      if (!c.scratches.depth_um.empty()) g.depth_um[i] = weight[6 * i + 4];
      if (!c.scratches.alpha.empty()) g.alpha[i] = 100 * weight[6 * i + 5];
    }
    return g;
  }
};

TEST(PullBack, IsTheGradientThroughFieldsWearAndCrossings) {
  const Board board = small_board();
  for (const bool own_depth : {false, true})
    for (const Crossings crossings : {Crossings::add, Crossings::last, Crossings::deepest}) {
      Bench bench = worn_bench();
      bench.crossings = crossings;
      Designed design(strewn(40, 5, 30));
      if (own_depth) {
        design.scratches.depth_um.assign(40, 13);
        design.scratches.depth_um[7] = 30;
      }
      const Carved carved = carve(design, bench, board);
      // They do cut each other.
      ASSERT_GE(carved.size(), design.size() + (crossings == Crossings::add ? 0 : 20));
      const LinearE E(carved.size(), 6);
      const ScratchGradients g = pull_back(carved, design, bench, board, E.gradient(carved));
      std::size_t compared = 0;
      const auto compare = [&](std::vector<double> Scratches::*column, const std::vector<double>& by, double step) {
        for (std::size_t i = 0; i < design.size(); ++i) {
          const auto at = [&](double by_mm) {
            Designed moved = design;
            (moved.scratches.*column)[i] += by_mm;
            const Carved c = carve(moved, bench, board);
            return c.size() == carved.size() ? E(c) : NAN;  // a crossing came or went: no derivative there
          };
          const double difference = (at(step) - at(-step)) / (2 * step);
          if (!std::isfinite(difference)) continue;
          ++compared;
          EXPECT_NEAR(by[i], difference, 1e-5 * std::max(1.0, std::abs(difference))) << i;
        }
      };
      compare(&Scratches::x0_mm, g.x0_mm, 1e-6);
      compare(&Scratches::y0_mm, g.y0_mm, 1e-6);
      compare(&Scratches::x1_mm, g.x1_mm, 1e-6);
      compare(&Scratches::y1_mm, g.y1_mm, 1e-6);
      if (own_depth) compare(&Scratches::depth_um, g.depth_um, 1e-6);
      EXPECT_GE(compared, 4 * design.size() - 4);
      double sum = 0;
      for (const double by : g.depth_um) sum += by;
      EXPECT_NEAR(g.shared_depth_um, sum, 1e-9 * std::abs(sum));
    }
}

TEST(PullBack, AnyNumberOfThreadsCutsAndPullsBackTheSame) {
  const Board board = small_board();
  Bench bench = worn_bench();
  bench.crossings = Crossings::deepest;
  const Designed design(strewn(600, 9, 30));
  std::optional<Carved> first;
  ScratchGradients first_gradients;
  for (const int threads : {1, 2, 5}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Carved carved = carve(design, bench, board);
    ASSERT_GT(carved.size(), 8 * design.size());  // pieces are pulled back in more than one part
    const ScratchGradients g = pull_back(carved, design, bench, board, LinearE(carved.size(), 6).gradient(carved));
    if (!first) {
      first = carved;
      first_gradients = g;
    }
    EXPECT_EQ(carved.scratches.x0_mm, first->scratches.x0_mm) << threads << " threads";
    EXPECT_EQ(carved.scratches.left, first->scratches.left) << threads << " threads";
    EXPECT_EQ(carved.source, first->source) << threads << " threads";
    EXPECT_EQ(g.x0_mm, first_gradients.x0_mm) << threads << " threads";
    EXPECT_EQ(g.depth_um, first_gradients.depth_um) << threads << " threads";
  }
}

TEST(PullBack, SharedDepthMovesAllGrooves) {
  const Board board = small_board();
  for (const Crossings crossings : {Crossings::last, Crossings::deepest}) {
    Bench bench = worn_bench();
    bench.crossings = crossings;
    const Designed design(strewn(40, 8));
    const Carved carved = carve(design, bench, board);
    const LinearE E(carved.size(), 9);
    const ScratchGradients g = pull_back(carved, design, bench, board, E.gradient(carved));
    const auto at = [&](double by_um) {
      Bench other = bench;
      other.material.depth_um += by_um;
      return E(carve(design, other, board));
    };
    EXPECT_NEAR(g.shared_depth_um, (at(1e-5) - at(-1e-5)) / 2e-5, 1e-5 * std::abs(g.shared_depth_um));
  }
}

TEST(PullBack, RefusesTheGradientOfOtherGrooves) {
  const Designed design(strewn(3, 4));
  ScratchGradients g;
  g.resize(2);
  EXPECT_THROW(pull_back(carve(design, Bench(), small_board()), design, Bench(), small_board(), g), Error);
}

}  // namespace
}  // namespace burin
