// burin/optimize/loss/lane_sum.h - a float sum in SIMD vectors: sixteen partial sums, added in one order on every
// machine.
#pragma once

#include "burin/base/machine_clones.h"

namespace burin {

struct LaneSum {
  float lane[16] = {};

  /// Adds term(i) for i = 0 .. n - 1.
  template <typename Term>
  BURIN_INLINED void add(int n, const Term& term) {
    int i = 0;
    for (; i + 16 <= n; i += 16)
      for (int k = 0; k < 16; ++k) lane[k] += term(i + k);
    for (int k = 0; i + k < n; ++k) lane[k] += term(i + k);
  }

  BURIN_INLINED float total() const {
    float a[8], b[4];
    for (int k = 0; k < 8; ++k) a[k] = lane[k] + lane[k + 8];
    for (int k = 0; k < 4; ++k) b[k] = a[k] + a[k + 4];
    return (b[0] + b[2]) + (b[1] + b[3]);
  }
};

}  // namespace burin
