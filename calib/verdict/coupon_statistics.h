// burin/calib/verdict/coupon_statistics.h - from fans to cells: one number a fan, with its covariance, becomes one
// number a cell, how much fans that are carved alike differ, and what goes with the carving order and the place.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace burin {

/// A fan's logarithm of depth or roughness, and where it stands.
struct FanSample {
  std::size_t cell = 0;
  double value = 0;
  double age = 0;               ///< 0: carved first, 1: last
  Eigen::Vector2d place{0, 0};  ///< from -1/2 to 1/2 over the coupon
};

/// A number that may not be known.
struct Estimate {
  double value = 0, sigma = 0;
  bool known = false;
};

/// What the samples say.
struct CellStatistics {
  std::vector<Estimate> cells;  ///< halfway through the carving, at the coupon's middle; not known: no sample
  Eigen::MatrixXd covariance;   ///< of all cells; 0 for those without a sample
  Estimate repeat;              ///< standard deviation of fans that are carved alike, beside what the photos leave open
  Estimate wear;                ///< from the first fan to the last
  Estimate tilt_x, tilt_y;      ///< from edge to edge
  double chi2 = 0;              ///< of the samples about what is fitted, without `repeat`
  int degrees = 0;              ///< of freedom that chi2 has
};

/// What is known of a tilt over the coupon before fans are compared, edge to edge.
struct TiltPrior {
  Eigen::Vector2d value{0, 0}, sigma{0.05, 0.05};
};

/// Generalized least squares with the samples' `covariance` and a scatter of fans that is not known: all scatters count
/// by their likelihood (restricted) and a prior (lognormal, about 2 %), so that few repeats make large sigmas. Wear is
/// sought where two repeats or more remain besides it; a tilt only with a prior, since few repeats take chance for one.
CellStatistics cell_statistics(const std::vector<FanSample>& samples, const Eigen::MatrixXd& covariance,
                               std::size_t cells, const std::optional<TiltPrior>& tilt_prior);

}  // namespace burin
