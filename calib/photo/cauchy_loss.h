// burin/calib/photo/cauchy_loss.h - the robust loss of pixel residuals. docs/model.md 9.7.
#pragma once

#include <algorithm>
#include <cmath>

namespace burin {

/// Functions of s = r^2: rho(s), rho'(s), and half the second derivative of rho by r, at least 0.
struct Loss {
  double rho, weight, curvature;
};

/// c^2 log(1 + s / c^2), c being `scale`.
inline Loss cauchy_loss(double s, double scale) {
  const double c2 = scale * scale, weight = 1 / (1 + s / c2);
  return {c2 * std::log1p(s / c2), weight, std::max(0.0, 1 - s / c2) * weight * weight};
}

}  // namespace burin
