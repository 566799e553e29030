// What is proved: for a linear model the halves' optima are those of solving again on the half (so a step of Gauss and
// Newton is the re-solve); halves balance (each pair counts alike, both halves hold one of each); over many worlds with
// the noise that sigma says, halves contradict as rarely as the limit promises, and with errors that photos have as a
// whole, which sigma does not know of, they do. Not proved: that photos' models are linear enough (refine_test.cpp
// compares with a second solve on real halves).
#include "burin/calib/verdict/half_samples.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numeric>
#include <random>

namespace burin {
namespace {

// Straight lines through points: 12 photos of 20 points each; `photo_error`: an offset that a photo has as a whole.
struct Line {
  EquationsInParts equations;
  std::vector<Eigen::MatrixXd> J;
  std::vector<Eigen::VectorXd> y;
  Eigen::VectorXd solution;
};

Line make_line(std::mt19937_64& random, double photo_error) {
  std::normal_distribution<double> gauss;
  Line out;
  std::vector<double> keys;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, 2);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(2);
  for (int k = 0; k < 12; ++k) {
    Eigen::MatrixXd J(20, 2);
    Eigen::VectorXd y(20);
    const double offset = photo_error * gauss(random);
    for (int i = 0; i < 20; ++i) {
      J.row(i) << 1, 0.1 * k + 0.02 * i;
      y[i] = 3 + 2 * J(i, 1) + gauss(random) + offset;
    }
    H += J.transpose() * J;
    g += J.transpose() * y;
    out.J.push_back(J);
    out.y.push_back(y);
    keys.push_back(0.1 * k);
  }
  out.solution = H.ldlt().solve(g);
  for (int k = 0; k < 12; ++k) {
    out.equations.information.emplace_back(out.J[k].transpose() * out.J[k]);
    out.equations.gradient.emplace_back(out.J[k].transpose() * (out.J[k] * out.solution - out.y[k]));
  }
  out.equations.prior = Eigen::MatrixXd::Zero(2, 2);
  out.equations.prior_gradient = Eigen::VectorXd::Zero(2);
  out.equations.pairs = pair_neighbors(keys, std::vector<std::size_t>(12, 0));
  return out;
}

TEST(HalfSamples, AreTheOptimaOfTheHalves) {
  std::mt19937_64 random(5);
  const Line line = make_line(random, 0);
  const HalfSamples halves = half_samples(line.equations);
  ASSERT_EQ(halves.pair_information.size(), 6U);
  ASSERT_EQ(halves.splits.size(), 8U);
  // The first split puts the first of every pair into A: photos 0, 2, 4, ...
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, 2);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(2);
  for (int k = 0; k < 12; k += 2) {
    H += line.J[k].transpose() * line.J[k];
    g += line.J[k].transpose() * line.y[k];
  }
  EXPECT_LT((line.solution + halves.splits[0].step_a - H.ldlt().solve(g)).norm(), 1e-7);
  // Halves hold complementary photos, so for a linear model their information-weighted steps cancel.
  for (const auto& split : halves.splits) {
    const Eigen::VectorXd sum = split.inverse_a.ldlt().solve(split.step_a) + split.inverse_b.ldlt().solve(split.step_b);
    EXPECT_LT(sum.norm(), 1e-5);
  }
}

TEST(HalfSamples, ContradictAsOftenAsTheyShould) {
  std::mt19937_64 random(9);
  const auto share = [&](double photo_error) {
    int contradicting = 0;
    double ratio2 = 0;
    constexpr int kWorlds = 2000;
    for (int world = 0; world < kWorlds; ++world) {
      const HalfSamples halves = half_samples(make_line(random, photo_error).equations);
      const Eigen::VectorXd slope = Eigen::VectorXd::Unit(2, 1);
      const HalvesVerdict v = compare_halves(halves, slope, std::sqrt(halves.inverse(1, 1)));
      contradicting += v.contradict();
      ratio2 += v.ratio * v.ratio / kWorlds;
    }
    return std::pair(contradicting / double{kWorlds}, ratio2);
  };
  const auto [honest, honest_ratio2] = share(0);
  EXPECT_LT(honest, 0.005);
  EXPECT_NEAR(honest_ratio2, 1, 0.1);
  // A photo's own error of 0.7: the variance of its 20 points' mean, 0.49 + 0.05, is 10.8 times 0.05.
  const auto [too_small, too_small_ratio2] = share(0.7);
  EXPECT_GT(too_small, 0.5);
  EXPECT_NEAR(too_small_ratio2, 10.8, 2);
}

TEST(HalfSamples, WhatOnePhotoAloneKnowsIsNotCompared) {
  // The second parameter is seen in one photo: in each split one half does not know it, which is no contradiction.
  EquationsInParts e;
  for (int k = 0; k < 4; ++k) {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, 2);
    H(0, 0) = 1;
    H(1, 1) = k == 2 ? 100 : 0;
    e.information.push_back(H);
    e.gradient.emplace_back(Eigen::Vector2d(k % 2 ? 1 : -1, 0));
  }
  e.prior = Eigen::MatrixXd::Zero(2, 2);
  e.prior_gradient = Eigen::VectorXd::Zero(2);
  e.pairs = {{0, 1}, {2, 3}};
  const HalvesVerdict v = compare_halves(half_samples(e), Eigen::VectorXd::Unit(2, 1), 0.1);
  EXPECT_FALSE(v.contradict());
  EXPECT_GT(v.half_to_whole, 100);
}

TEST(HalfSamples, PairsStayWithinTheirGroup) {
  const auto pairs = pair_neighbors({5, 1, 2, 4, 3}, {0, 0, 1, 0, 1});
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0], std::pair(std::size_t{1}, std::size_t{3}));
  EXPECT_EQ(pairs[1], std::pair(std::size_t{2}, std::size_t{4}));
}

}  // namespace
}  // namespace burin
