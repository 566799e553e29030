// Proves: from fans to cells. Over many coupons drawn by chance, sigmas of depths, wear and tilt hold whatever part of
// the errors is the photos' own and whatever is the machine's; how much fans differ is found; few repeats make sigmas
// large instead of small; what no fan tells is said to be unknown. (The photos themselves: tests/tools, coupon.)
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "burin/calib/verdict/coupon_statistics.h"

namespace burin {
namespace {

struct Drawn {
  std::vector<FanSample> samples;
  Eigen::MatrixXd covariance;
  std::vector<double> truth;
};

constexpr double kWear = -0.05, kTilt = 0.03;

// 16 cells in 25 fans, shuffled, as a coupon has them; photos leave errors that fans share by half.
Drawn draw(std::mt19937_64& random, double photo_sigma, double scatter, int cells = 16, int fans = 25) {
  std::normal_distribution<> normal;
  std::uniform_real_distribution<> uniform(-0.5, 0.5);
  Drawn out;
  for (int c = 0; c < cells; ++c) out.truth.push_back(std::log(5.0 + 1.5 * c));
  std::vector<int> cell(static_cast<std::size_t>(fans));
  for (int f = 0; f < fans; ++f) cell[static_cast<std::size_t>(f)] = f < cells ? f : (f - cells) % std::min(5, cells);
  std::shuffle(cell.begin(), cell.end(), random);
  out.covariance = Eigen::MatrixXd::Constant(fans, fans, 0.5 * photo_sigma * photo_sigma);
  out.covariance.diagonal().array() += 0.5 * photo_sigma * photo_sigma;
  Eigen::VectorXd noise(fans);
  for (double& v : noise) v = normal(random);
  noise = Eigen::LLT<Eigen::MatrixXd>(out.covariance).matrixL() * noise;
  for (int f = 0; f < fans; ++f) {
    FanSample s;
    s.cell = static_cast<std::size_t>(cell[static_cast<std::size_t>(f)]);
    s.age = f / (fans - 1.0);
    s.place = {uniform(random), uniform(random)};
    s.value = out.truth[s.cell] + kWear * (s.age - 0.5) + kTilt * s.place.x() + noise[f] + scatter * normal(random);
    out.samples.push_back(s);
  }
  return out;
}

// Of z-scores: the share within two sigmas, and their mean square's root.
struct Scores {
  double within = 0, rms = 0;
};
Scores scores(const std::vector<double>& z) {
  Scores out;
  for (const double v : z) {
    out.within += (std::abs(v) < 2) / static_cast<double>(z.size());
    out.rms += v * v / static_cast<double>(z.size());
  }
  out.rms = std::sqrt(out.rms);
  return out;
}

TEST(CouponStatistics, SigmasHold) {
  for (const auto& [photo_sigma, scatter] : {std::pair(0.01, 0.02), std::pair(0.02, 0.0), std::pair(0.005, 0.06)}) {
    std::mt19937_64 random(11);
    std::vector<double> cells, wear, tilt;
    double repeat = 0;
    constexpr int kCoupons = 60;
    for (int i = 0; i < kCoupons; ++i) {
      const Drawn drawn = draw(random, photo_sigma, scatter);
      const CellStatistics s = cell_statistics(drawn.samples, drawn.covariance, drawn.truth.size(), TiltPrior{});
      for (std::size_t c = 0; c < drawn.truth.size(); ++c) {
        ASSERT_TRUE(s.cells[c].known);
        cells.push_back((s.cells[c].value - drawn.truth[c]) / s.cells[c].sigma);
      }
      wear.push_back((s.wear.value - kWear) / s.wear.sigma);
      tilt.push_back((s.tilt_x.value - kTilt) / s.tilt_x.sigma);
      repeat += s.repeat.value / kCoupons;
      EXPECT_EQ(s.degrees, 25 - 16 - 1);
    }
    // 95.4 % of a normal distribution; 60 coupons say it to 3 %, and the cells of one are not independent.
    EXPECT_GT(scores(cells).within, 0.90) << photo_sigma << " " << scatter;
    EXPECT_GT(scores(wear).within, 0.87);
    EXPECT_GT(scores(tilt).within, 0.87);
    // Nor are they promised so large that they say nothing.
    EXPECT_GT(scores(cells).rms, 0.5) << photo_sigma << " " << scatter;
    EXPECT_GT(scores(wear).rms, 0.5);
    // Six degrees of freedom know a scatter to a third; its square, averaged, is biased upwards where it is small.
    EXPECT_NEAR(repeat, scatter, 0.35 * scatter + 0.7 * photo_sigma);
  }
}

TEST(CouponStatistics, FewRepeatsKnowLittle) {
  std::mt19937_64 random(5);
  const Drawn many = draw(random, 0.01, 0.03, 4, 25), few = draw(random, 0.01, 0.03, 16, 19);
  const CellStatistics sure = cell_statistics(many.samples, many.covariance, 4, TiltPrior{}),
                       unsure = cell_statistics(few.samples, few.covariance, 16, TiltPrior{});
  EXPECT_TRUE(unsure.wear.known);
  EXPECT_GT(unsure.tilt_x.sigma, sure.tilt_x.sigma);
  EXPECT_GT(unsure.repeat.sigma, 2 * sure.repeat.sigma);
  EXPECT_GT(unsure.cells[0].sigma, 1.3 * sure.cells[0].sigma);
}

TEST(CouponStatistics, SaysWhatNoFanTells) {
  std::mt19937_64 random(6);
  Drawn drawn = draw(random, 0.01, 0.02);
  std::erase_if(drawn.samples, [](const FanSample& s) { return s.cell == 7; });
  const auto n = static_cast<Eigen::Index>(drawn.samples.size());
  const CellStatistics s = cell_statistics(drawn.samples, drawn.covariance.topLeftCorner(n, n), 16, TiltPrior{});
  EXPECT_FALSE(s.cells[7].known);
  EXPECT_TRUE(s.cells[6].known);
  EXPECT_EQ(s.covariance(7, 7), 0);
  EXPECT_FALSE(cell_statistics({}, {}, 16, std::nullopt).cells[0].known);
}

}  // namespace
}  // namespace burin
