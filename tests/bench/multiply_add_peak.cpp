#include "tests/bench/multiply_add_peak.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <map>

namespace burin {
namespace {

/// As many chains side by side as fit into the registers, so that none waits for another.
template <typename Packet, int kChains>
__attribute__((always_inline)) inline double chains() {
  constexpr long kRounds = 1 << 16;
  constexpr int kLanes = sizeof(Packet) / sizeof(float);
  Packet x[kChains];
  for (int k = 0; k < kChains; ++k) x[k] = Packet{} + static_cast<float>(k);
  for (long i = 0; i < kRounds; ++i) {
    for (Packet& v : x) {
      v = v * 0.999F + 1e-3F;
#if defined(__x86_64__)
      asm volatile("" : "+x"(v));  // in a register, and not packed with its neighbours
#else
      benchmark::DoNotOptimize(v);
#endif
    }
  }
  for (Packet& v : x) benchmark::DoNotOptimize(v);
  return 2.0 * kLanes * kChains * kRounds;
}

using Four = float __attribute__((vector_size(16)));
double four_lanes() { return chains<Four, 12>(); }
double one_lane() { return chains<float, 12>(); }
#if defined(__x86_64__)
using Eight = float __attribute__((vector_size(32)));
using Sixteen = float __attribute__((vector_size(64)));
__attribute__((target("avx2,fma"))) double eight_lanes() { return chains<Eight, 12>(); }
__attribute__((target("avx512f"))) double sixteen_lanes() { return chains<Sixteen, 16>(); }
#endif

}  // namespace

double multiply_add(int lanes) {
#if defined(__x86_64__)
  if (lanes == 16) return sixteen_lanes();
  if (lanes == 8) return eight_lanes();
#endif
  return lanes == 4 ? four_lanes() : one_lane();
}

double multiply_add_peak(int lanes) {
  static std::map<int, double> known;
  double& best = known[lanes];
  if (best > 0) return best;
  for (int i = 0; i < 30; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const double operations = multiply_add(lanes);
    best = std::max(best, operations / std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

}  // namespace burin
