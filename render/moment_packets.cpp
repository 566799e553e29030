#include "render/moment_packets.h"

#include <algorithm>
#include <string>

#include "render/error.h"
#include "render/moment_packets_kernel.h"

namespace burin::footprint {
namespace {

bool machine_has(PacketWidth width) {
#if defined(__x86_64__) || defined(__i386__)
  // These look at the processor and at whether the system saves its registers.
  switch (width) {
    case PacketWidth::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case PacketWidth::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("fma");
    default:
      return true;
  }
#else
  return width == PacketWidth::scalar || width == PacketWidth::base;
#endif
}

template <bool kDerivatives>
void scalar_loop(const Intervals& in, const MomentArrays& out) {
  for (std::size_t i = 0; i < in.size(); ++i) {
    const auto lobes = make_lobes(in.hx[i], in.hy[i], in.hz[i], in.alpha[i]);
    if constexpr (kDerivatives) {
      const auto m = moments_with_derivatives(lobes, in.t1[i], in.t2[i]);
      out.m0[i] = m.value.m0;
      out.m1[i] = m.value.m1;
      out.turn_m0[i] = m.turn.m0;
      out.turn_m1[i] = m.turn.m1;
      out.radial_m0[i] = m.radial_over_r2.m0;
      out.radial_m1[i] = m.radial_over_r2.m1;
    } else {
      const auto m = moments(lobes, in.t1[i], in.t2[i]);
      out.m0[i] = m.m0;
      out.m1[i] = m.m1;
    }
  }
}

PacketKernels kernels(PacketWidth width) {
  switch (width) {
    case PacketWidth::scalar:
      return {scalar_loop<false>, scalar_loop<true>};
    case PacketWidth::base:
      return detail::kernels_of<xsimd::default_arch>();
    case PacketWidth::avx2:
      return avx2_kernels();
    case PacketWidth::avx512:
      return avx512_kernels();
  }
  return {};
}

PacketKernels checked_kernels(const Intervals& in, std::initializer_list<std::span<float>> results, PacketWidth width) {
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
  if (!supported(width)) {
    fail("PacketWidth", std::string(name(width)) + " does not run on this machine", "use widest_supported()");
  }
  return kernels(width);
}

}  // namespace

const char* name(PacketWidth width) {
  switch (width) {
    case PacketWidth::scalar:
      return "scalar";
    case PacketWidth::base:
      return xsimd::default_arch::name();
    case PacketWidth::avx2:
      return "avx2";
    case PacketWidth::avx512:
      return "avx512";
  }
  return "unknown";
}

bool supported(PacketWidth width) { return machine_has(width) && kernels(width).moments != nullptr; }

PacketWidth widest_supported() {
  static const PacketWidth widest = [] {
    for (const auto width : {PacketWidth::avx512, PacketWidth::avx2, PacketWidth::base}) {
      if (supported(width)) return width;
    }
    return PacketWidth::scalar;
  }();
  return widest;
}

void moments(const Intervals& intervals, const MomentArrays& results, PacketWidth width) {
  checked_kernels(intervals, {results.m0, results.m1}, width).moments(intervals, results);
}

void moments_with_derivatives(const Intervals& intervals, const MomentArrays& results, PacketWidth width) {
  checked_kernels(intervals,
                  {results.m0, results.m1, results.turn_m0, results.turn_m1, results.radial_m0, results.radial_m1},
                  width)
      .moments_with_derivatives(intervals, results);
}

}  // namespace burin::footprint
