// tests/moment_packets/moment_packets_kernel.h - the loop of moment_packets.h over packets of one instruction set.
// Included only by the source files that are compiled for it: each instantiates it for its own Arch, so no two files
// share its code.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "burin/render/fast/packet_math.h"
#include "tests/moment_packets/moment_packets.h"

namespace burin::footprint {

/// How one width does both jobs; null where the build has it not.
struct PacketKernels {
  void (*moments)(const Intervals&, const MomentArrays&) = nullptr;
  void (*moments_with_derivatives)(const Intervals&, const MomentArrays&) = nullptr;
};

PacketKernels avx2_kernels();
PacketKernels avx512_kernels();

namespace detail {

template <class Arch, bool kDerivatives>
void packet_loop(const Intervals& in, const MomentArrays& out) {
  using Packet = xsimd::batch<float, Arch>;
  constexpr std::size_t width = Packet::size;
  const std::size_t count = in.t1.size();
  const auto work = [](const std::array<const float*, 6>& from, const std::array<float*, 6>& to) {
    const Lobes<Packet> lobes = make_lobes(Packet::load_unaligned(from[0]), Packet::load_unaligned(from[1]),
                                           Packet::load_unaligned(from[2]), Packet::load_unaligned(from[3]));
    const Packet t1 = Packet::load_unaligned(from[4]), t2 = Packet::load_unaligned(from[5]);
    if constexpr (kDerivatives) {
      const auto m = footprint::moments_with_derivatives(lobes, t1, t2);
      m.value.m0.store_unaligned(to[0]);
      m.value.m1.store_unaligned(to[1]);
      m.turn.m0.store_unaligned(to[2]);
      m.turn.m1.store_unaligned(to[3]);
      m.radial_over_r2.m0.store_unaligned(to[4]);
      m.radial_over_r2.m1.store_unaligned(to[5]);
    } else {
      const auto m = footprint::moments(lobes, t1, t2);
      m.m0.store_unaligned(to[0]);
      m.m1.store_unaligned(to[1]);
    }
  };
  const std::array<const float*, 6> from{in.hx.data(),    in.hy.data(), in.hz.data(),
                                         in.alpha.data(), in.t1.data(), in.t2.data()};
  const std::array<float*, 6> to{out.m0.data(),      out.m1.data(),        out.turn_m0.data(),
                                 out.turn_m1.data(), out.radial_m0.data(), out.radial_m1.data()};
  constexpr int results = kDerivatives ? 6 : 2;
  std::size_t i = 0;
  for (; i + width <= count; i += width) {
    std::array<const float*, 6> f;
    std::array<float*, 6> t{};
    for (int k = 0; k < 6; ++k) f[k] = from[k] + i;
    for (int k = 0; k < results; ++k) t[k] = to[k] + i;
    work(f, t);
  }
  if (i == count) return;
  // The rest, in a packet filled up with copies of its first interval: the same code, so the same bits.
  std::array<std::array<float, width>, 6> padded, result;
  std::array<const float*, 6> f;
  std::array<float*, 6> t;
  for (int k = 0; k < 6; ++k) {
    for (std::size_t lane = 0; lane < width; ++lane) padded[k][lane] = from[k][i + lane < count ? i + lane : i];
    f[k] = padded[k].data();
    t[k] = result[k].data();
  }
  work(f, t);
  for (int k = 0; k < results; ++k) {
    for (std::size_t lane = 0; i + lane < count; ++lane) to[k][i + lane] = result[k][lane];
  }
}

template <class Arch>
PacketKernels kernels_of() {
  return {packet_loop<Arch, false>, packet_loop<Arch, true>};
}

}  // namespace detail
}  // namespace burin::footprint
