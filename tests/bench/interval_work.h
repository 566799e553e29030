// Intervals of the footprint integral as a board shows them: 62 % whole grooves [-T, T], the rest cut by a pixel's
// edges; half vectors up to 34 degrees off the normal; alpha 0.02 to 0.2. And what each costs in operations.
#pragma once

#include <vector>

#include "tests/moment_packets/moment_packets.h"

namespace burin {

struct IntervalWork {
  std::vector<float> hx, hy, hz, alpha, t1, t2;
  std::vector<float> r[6];
  std::vector<double> m0, most;  ///< in double; and length of the interval times the peak of W

  explicit IntervalWork(int count);

  footprint::Intervals intervals() const { return {hx, hy, hz, alpha, t1, t2}; }
  footprint::MomentArrays results() { return {r[0], r[1], r[2], r[3], r[4], r[5]}; }
  /// The largest error of the m0 in `r[0]`, over the largest m0 that its peak and length allow.
  double error() const;
};

/// Float operations of the moments of an interval, counted one by one on a scalar: additions, multiplications,
/// divisions, square roots and logarithms as one each; minima, signs and choices as none.
double operations_per_interval(const IntervalWork& work, bool derivatives);

}  // namespace burin
