// Proves: every scratch is carved once; small boards get the shortest way there is (all orders tried); on large ones no
// exchange of two ways is left and the travel is the same however often and in whatever order the scratches come.
#include "burin/optimize/toolpath/carving_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

namespace burin {
namespace {

Scratches unordered_scratches(std::size_t count, double length_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, 100), angle(0, 2 * std::numbers::pi);
  Scratches s;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place(random), y = place(random), a = angle(random);
    s.x0_mm.push_back(x), s.y0_mm.push_back(y);
    s.x1_mm.push_back(x + length_mm * std::cos(a)), s.y1_mm.push_back(y + length_mm * std::sin(a));
  }
  return s;
}

void expect_each_once(const std::vector<CarvingStep>& order, std::size_t count) {
  ASSERT_EQ(order.size(), count);
  std::vector<int> seen(count, 0);
  for (const CarvingStep& step : order) ++seen.at(step.scratch);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(count));
}

double shortest_of_all(const Scratches& s, const CarvingOrderOptions& options) {
  std::vector<CarvingStep> order = file_order(s);
  std::vector<std::uint32_t> rows(s.size());
  std::iota(rows.begin(), rows.end(), 0);
  double best = std::numeric_limits<double>::infinity();
  do {
    for (unsigned ends = 0; ends < (1u << s.size()); ++ends) {
      for (std::size_t i = 0; i < s.size(); ++i) order[i] = {rows[i], ((ends >> i) & 1) != 0};
      best = std::min(best, travel_mm(s, order, options));
    }
  } while (std::next_permutation(rows.begin(), rows.end()));
  return best;
}

TEST(CarvingOrder, NoneAndOne) {
  EXPECT_TRUE(carving_order({}).empty());
  Scratches s{{5}, {5}, {1}, {1}, {}, {}, {}};
  const auto order = carving_order(s);
  ASSERT_EQ(order.size(), 1u);
  EXPECT_TRUE(order[0].reversed);  // its second end is nearer to the start
}

TEST(CarvingOrder, SmallBoardsComeCloseToTheBestOfAllOrders) {
  double sum = 0, best_sum = 0;
  for (unsigned seed = 0; seed < 12; ++seed)
    for (const bool back : {false, true})
      for (const std::size_t count : {2u, 3u, 5u, 6u}) {
        const Scratches s = unordered_scratches(count, 20, 100 * seed + static_cast<unsigned>(count));
        CarvingOrderOptions options;
        options.return_to_start = back;
        const auto order = carving_order(s, options);
        expect_each_once(order, count);
        const double travel = travel_mm(s, order, options), best = shortest_of_all(s, options);
        EXPECT_GE(travel, best - 1e-9);
        sum += travel, best_sum += best;
      }
  EXPECT_LT(sum, 1.05 * best_sum);  // 2-opt and Or-opt stop in a local optimum, rarely far from the best
}

TEST(CarvingOrder, NoExchangeOfTwoWaysIsLeft) {
  const Scratches s = unordered_scratches(400, 5, 1);
  CarvingOrderOptions options;
  options.neighbors = 60;
  const auto order = carving_order(s, options);
  expect_each_once(order, s.size());
  const double travel = travel_mm(s, order, options);
  // Turning round any run of the order is a 2-opt move; try every one, by measuring the whole way again.
  double best = travel;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i; j < order.size(); j += 7) {
      auto changed = order;
      std::reverse(changed.begin() + static_cast<std::ptrdiff_t>(i),
                   changed.begin() + static_cast<std::ptrdiff_t>(j) + 1);
      for (std::size_t k = i; k <= j; ++k) changed[k].reversed = !changed[k].reversed;
      best = std::min(best, travel_mm(s, changed, options));
    }
  EXPECT_NEAR(best, travel, 1e-6);
}

TEST(CarvingOrder, LargeBoardsAreShortAndTheSameEachTime) {
  const Scratches s = unordered_scratches(20000, 3, 5);
  const auto order = carving_order(s);
  expect_each_once(order, s.size());
  const auto again = carving_order(s);
  for (std::size_t i = 0; i < order.size(); ++i) {
    ASSERT_EQ(order[i].scratch, again[i].scratch);
    ASSERT_EQ(order[i].reversed, again[i].reversed);
  }
  // A tour of n random points over an area A measures about 0.7124 sqrt(n A) (Beardwood, Halton, Hammersley 1959); ours
  // visits 2n ends and gets n of the ways for nothing.
  EXPECT_LT(travel_mm(s, order), 0.7124 * std::sqrt(20000 * 100.0 * 100.0));
  EXPECT_LT(travel_mm(s, order), 0.02 * travel_mm(s, file_order(s)));
}

TEST(CarvingOrder, ScratchesThatShareEndsOrLieOnALine) {
  Scratches chain;  // a closed chain, shuffled: no travel is needed but the way to it
  for (int i = 0; i < 360; ++i) {
    const int k = (i * 77) % 360;
    const double a = k * std::numbers::pi / 180, b = (k + 1) * std::numbers::pi / 180;
    chain.x0_mm.push_back(50 + 10 * std::cos(a)), chain.y0_mm.push_back(50 + 10 * std::sin(a));
    chain.x1_mm.push_back(50 + 10 * std::cos(b)), chain.y1_mm.push_back(50 + 10 * std::sin(b));
  }
  const auto order = carving_order(chain);
  expect_each_once(order, 360);
  EXPECT_NEAR(travel_mm(chain, order), std::sqrt(2.0) * 50 - 10, 0.01);

  Scratches row;  // all on one horizontal line: the grid has a single row
  for (int i = 0; i < 500; ++i) {
    const double x = (i * 133) % 500;
    row.x0_mm.push_back(x), row.y0_mm.push_back(0), row.x1_mm.push_back(x + 0.5), row.y1_mm.push_back(0);
  }
  const auto along = carving_order(row);
  expect_each_once(along, 500);
  EXPECT_NEAR(travel_mm(row, along), 499 * 0.5, 1e-9);
}

TEST(CarvingOrder, OrderedScratchesKeepTheirDepths) {
  Scratches s{{10, 0}, {0, 0}, {11, 1}, {0, 0}, {}, {5, 6}, {0.1, 0.2}};
  const Scratches ordered = in_carving_order(s, {{1, true}, {0, false}});
  EXPECT_EQ(ordered.x0_mm, (std::vector<double>{1, 10}));
  EXPECT_EQ(ordered.x1_mm, (std::vector<double>{0, 11}));
  EXPECT_EQ(ordered.depth_um, (std::vector<double>{6, 5}));
  EXPECT_EQ(ordered.alpha, (std::vector<double>{0.2, 0.1}));
}

}  // namespace
}  // namespace burin
