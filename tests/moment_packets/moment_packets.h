// tests/moment_packets/moment_packets.h - the moments of footprint_core.h for many intervals at once, in float, as wide
// as the machine allows.
//
// For tests and benchmarks: one formula (footprint_core.h) over the packets of the fast path
// (burin/render/fast/packet_math.h), by which its integral can be tested and timed alone. Intervals are arrays of the
// same length: entry i of each is interval i. Precondition of every interval as in footprint_core.h: unit h, 0 < alpha
// <= 1, t1 <= t2, n.h >= 0 between them, |t|
// <= 1. docs/model.md 8.
#pragma once

#include <cstddef>
#include <span>

#include "burin/base/simd_width.h"

namespace burin::footprint {

/// Half vectors in scratch frames, roughnesses, and the intervals of t.
struct Intervals {
  std::span<const float> hx, hy, hz, alpha, t1, t2;

  std::size_t size() const { return t1.size(); }
};

/// Where results go: m0 and m1 of W; with derivatives also those by `turn` and by `radial` over r^2 (footprint_core.h).
struct MomentArrays {
  std::span<float> m0, m1;
  std::span<float> turn_m0, turn_m1, radial_m0, radial_m1;
};

/// Throws Error for arrays of different lengths or a width that does not run here.
void moments(const Intervals& intervals, const MomentArrays& results, SimdWidth width = SimdWidth::best);
void moments_with_derivatives(const Intervals& intervals, const MomentArrays& results,
                              SimdWidth width = SimdWidth::best);

}  // namespace burin::footprint
