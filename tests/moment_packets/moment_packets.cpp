#include "tests/moment_packets/moment_packets.h"

#include <algorithm>
#include <string>

#include "burin/base/error.h"
#include "tests/moment_packets/moment_packets_kernel.h"

namespace burin::footprint {
namespace {

PacketKernels kernels(SimdWidth width) {
  switch (resolved_simd(width)) {
    case SimdWidth::avx512:
      return avx512_kernels();
    case SimdWidth::avx2:
      return avx2_kernels();
    default:
      return detail::kernels_of<xsimd::default_arch>();
  }
}

PacketKernels checked_kernels(const Intervals& in, std::initializer_list<std::span<float>> results, SimdWidth width) {
  for (const auto& s : {in.hx, in.hy, in.hz, in.alpha, in.t2}) {
    if (s.size() != in.size())
      fail("Intervals", "its arrays have different lengths", "give each one entry an interval");
  }
  for (const auto& s : results) {
    if (s.size() != in.size()) {
      fail("MomentArrays", "its arrays differ in length from the " + std::to_string(in.size()) + " intervals",
           "give each one entry an interval");
    }
  }
  return kernels(width);
}

}  // namespace

void moments(const Intervals& intervals, const MomentArrays& results, SimdWidth width) {
  checked_kernels(intervals, {results.m0, results.m1}, width).moments(intervals, results);
}

void moments_with_derivatives(const Intervals& intervals, const MomentArrays& results, SimdWidth width) {
  checked_kernels(intervals,
                  {results.m0, results.m1, results.turn_m0, results.turn_m1, results.radial_m0, results.radial_m1},
                  width)
      .moments_with_derivatives(intervals, results);
}

}  // namespace burin::footprint
