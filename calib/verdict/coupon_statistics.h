// burin/calib/verdict/coupon_statistics.h - statistics of a coupon, from fans to cells. The input is one number per
// fan, with covariance. The result is one number per cell, the variation of fans with the same command, and trends over
// carving order and place.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace burin {

/// A fan's logarithm of depth or roughness, with its place and order.
struct FanSample {
  std::size_t cell = 0;
  double value = 0;
  double age = 0;               ///< 0: carved first, 1: last
  Eigen::Vector2d place{0, 0};  ///< from -1/2 to 1/2 over the coupon
};

/// An estimate, possibly unknown.
struct Estimate {
  double value = 0, sigma = 0;
  bool known = false;
};

/// Result of cell_statistics().
struct CellStatistics {
  std::vector<Estimate> cells;  ///< halfway through the carving, at the coupon's middle; unknown without a sample
  Eigen::MatrixXd covariance;   ///< of all cells; 0 for those without a sample
  Estimate repeat;  ///< standard deviation of fans with the same command, in addition to the photos' uncertainty
  Estimate wear;    ///< from the first fan to the last
  Estimate tilt_x, tilt_y;  ///< from edge to edge
  double chi2 = 0;          ///< of the samples around the fit, without `repeat`
  int degrees = 0;          ///< degrees of freedom of chi2
};

/// Prior of a tilt over the coupon, edge to edge.
struct TiltPrior {
  Eigen::Vector2d value{0, 0}, sigma{0.05, 0.05};
};

/// Generalized least squares with the samples' `covariance` and an unknown scatter of fans. The result averages over
/// all scatters, weighted by their restricted likelihood and a prior (lognormal, about 2 %), so few repeats give large
/// sigmas. Wear is fitted if two or more repeats remain in addition to it. A tilt is fitted only with a prior, because
/// few repeats confuse it with chance.
CellStatistics cell_statistics(const std::vector<FanSample>& samples, const Eigen::MatrixXd& covariance,
                               std::size_t cells, const std::optional<TiltPrior>& tilt_prior);

}  // namespace burin
