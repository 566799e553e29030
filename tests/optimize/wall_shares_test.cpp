// Proves: a wall's exposure is the one at which the sum of its boards' errors, computed pixel by pixel, is least; and
// its scratches are shared so that no move of some from one board to another lowers the sum of the errors.
#include "burin/optimize/wall/wall_shares.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

namespace burin {
namespace {

// A board's view: light of its pixels and their targets (gamma-encoded).
struct Pixels {
  std::vector<double> light, target;
  double error(double exposure) const {
    double sum = 0;
    for (std::size_t i = 0; i < light.size(); ++i)
      sum += std::pow(std::pow(exposure * light[i], 1 / 2.2) - target[i], 2);
    return sum;
  }
};

// The least of a function of one minimum, by golden sections.
template <typename F>
double least_of(const F& f, double low, double high) {
  const double golden = (std::sqrt(5.0) - 1) / 2;
  for (int i = 0; i < 200; ++i) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    (f(a) < f(b) ? high : low) = f(a) < f(b) ? b : a;
  }
  return (low + high) / 2;
}

TEST(WallShares, TheCommonExposureHasTheLeastError) {
  const std::vector<Pixels> boards{{{0.1, 0.2, 0.05, 0.3}, {0.4, 0.5, 0.35, 0.6}},
                                   {{0.02, 0.21, 0.15, 0.1}, {0.2, 0.55, 0.4, 0.42}},
                                   {{1e-7, 1e-7, 1e-7, 1e-7}, {0, 0, 0, 0}}};  // black
  std::vector<BoardPreview> previews;
  for (const Pixels& p : boards) {
    const double best = least_of([&](double e) { return p.error(e); }, 1e-6, 10);
    double stiffness = 0;
    for (const double l : p.light) stiffness += std::pow(std::pow(best * l, 1 / 2.2) / 2.2, 2);
    previews.push_back({{{best, stiffness}}, {}});
  }
  const double common = common_exposures(previews).front();
  const double wanted = least_of(
      [&](double e) {
        double sum = 0;
        for (const Pixels& p : boards) sum += p.error(e);
        return sum;
      },
      1e-6, 10);
  // The error is quadratic in the logarithm up to its third power; the boards' own exposures are a tenth apart.
  EXPECT_NEAR(common / wanted, 1, 0.005);
  EXPECT_EQ(common_exposures({{{{0.0, 0.0}}, {}}}).front(), 0);
}

TEST(WallShares, TheCurvePassesThroughErrorsWithAFloor) {
  const ErrorCurve curve = error_curve({{500, 3 + 7.0 / 500, 0}, {1000, 3 + 7.0 / 1000, 0}});
  EXPECT_NEAR(curve.floor, 3, 1e-9);
  EXPECT_NEAR(curve.at(2000), 3 + 7.0 / 2000, 1e-9);
  EXPECT_EQ(error_curve({{500, 1, 0}, {1000, 2, 0}}).a, 0);  // more scratches do not help
}

std::vector<PreviewTrial> trials(double floor, double a, double seconds_each) {
  std::vector<PreviewTrial> out;
  for (const double n : {500.0, 1000.0, 2000.0}) out.push_back({n, floor + a / n, seconds_each * n});
  return out;
}

TEST(WallShares, NoMoveOfScratchesLowersTheError) {
  const std::vector<BoardPreview> boards{{{}, trials(5, 5000, 3)}, {{}, trials(20, 4000, 3)}, {{}, trials(9, 9000, 3)}};
  const std::vector<int> counts = shared_scratches(boards, 3000);
  const int sum = std::accumulate(counts.begin(), counts.end(), 0);
  EXPECT_LE(sum, 3000);
  EXPECT_GT(sum, 2990);
  const auto error = [&](const std::vector<int>& n) {
    double e = 0;
    for (std::size_t b = 0; b < boards.size(); ++b) e += error_curve(boards[b].trials).at(n[b]);
    return e;
  };
  for (std::size_t from = 0; from < counts.size(); ++from)
    for (std::size_t to = 0; to < counts.size(); ++to) {
      if (from == to) continue;
      std::vector<int> moved = counts;
      moved[from] -= 20;
      moved[to] += 20;
      EXPECT_GT(error(moved), error(counts)) << from << " to " << to;
    }
}

TEST(WallShares, ABoardOnASlowMachineGetsFewerForTheSameHours) {
  const std::vector<BoardPreview> boards{{{}, trials(5, 5000, 2)}, {{}, trials(5, 5000, 6)}};
  const std::vector<int> counts = shared_hours(boards, 8000);
  EXPECT_GT(counts[0], 1.5 * counts[1]);
  EXPECT_NEAR(2 * counts[0] + 6 * counts[1], 8000, 10);
}

TEST(WallShares, SharesStayNearWhatWasTried) {
  const std::vector<BoardPreview> boards{{{}, trials(5, 1e6, 3)}, {{}, trials(9, 0, 3)}};
  const std::vector<int> counts = shared_scratches(boards, 2000);
  EXPECT_EQ(counts[1], 500);
  EXPECT_NEAR(counts[0], 1500, 2);
}

}  // namespace
}  // namespace burin
