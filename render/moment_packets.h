// render/moment_packets.h - the moments of footprint_core.h for many intervals at once, in float, as wide as the
// machine allows.
//
// One formula (footprint_core.h), several widths: plain float, SSE2 (or what else the compiler's base machine has),
// AVX2 and AVX-512. Each width is a source file of its own, compiled for its instructions only; which one runs is
// chosen by what the processor and the system support, so one build runs everywhere. Intervals are arrays of the same
// length: entry i of each is interval i. Precondition of every interval as in footprint_core.h: unit h, 0 < alpha <= 1,
// t1 <= t2, n.h >= 0 between them, |t| <= 1. DESIGN 7.
#pragma once

#include <cstddef>
#include <span>

namespace burin::footprint {

/// Floats in a packet.
enum class PacketWidth { scalar = 1, base = 4, avx2 = 8, avx512 = 16 };

const char* name(PacketWidth width);  ///< "scalar", "sse2", "avx2", "avx512"
bool supported(PacketWidth width);    ///< by this build and this machine
PacketWidth widest_supported();

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

/// Throws Error for arrays of different lengths or a width that is not supported here.
void moments(const Intervals& intervals, const MomentArrays& results, PacketWidth width = widest_supported());
void moments_with_derivatives(const Intervals& intervals, const MomentArrays& results,
                              PacketWidth width = widest_supported());

}  // namespace burin::footprint
