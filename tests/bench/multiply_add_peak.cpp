#include "tests/bench/multiply_add_peak.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <map>

namespace burin {
namespace {

// Twelve chains side by side, so that none waits for another, each a variable of its own: arrays would go to memory. A
// macro, because GCC splits the vectors of a template for the machine it stands on before it is inlined into a function
// for another. The empty assembly keeps a packet in its register, and unpacked with its neighbors.
#if defined(__x86_64__)
#define BURIN_STEP(v)       \
  (v) = (v)*0.999F + 1e-3F; \
  asm("" : "+v"(v))
#else
#define BURIN_STEP(v)       \
  (v) = (v)*0.999F + 1e-3F; \
  benchmark::DoNotOptimize(v)
#endif
// clang-format off
#define BURIN_CHAINS(Name, Packet)                                                                             \
  double Name() {                                                                                              \
    constexpr long kRounds = 1 << 16;                                                                          \
    Packet a{}, b = a + 1.0F, c = a + 2.0F, d = a + 3.0F, e = a + 4.0F, f = a + 5.0F;                          \
    Packet g = a + 6.0F, h = a + 7.0F, i = a + 8.0F, j = a + 9.0F, k = a + 10.0F, l = a + 11.0F;               \
    for (long round = 0; round < kRounds; ++round) {                                                           \
      BURIN_STEP(a); BURIN_STEP(b); BURIN_STEP(c); BURIN_STEP(d); BURIN_STEP(e); BURIN_STEP(f);                \
      BURIN_STEP(g); BURIN_STEP(h); BURIN_STEP(i); BURIN_STEP(j); BURIN_STEP(k); BURIN_STEP(l);                \
    }                                                                                                          \
    Packet sum = a + b + c + d + e + f + g + h + i + j + k + l;                                                \
    benchmark::DoNotOptimize(sum);                                                                             \
    return 2.0 * sizeof(Packet) / sizeof(float) * 12 * kRounds;                                                \
  }
// clang-format on

using Four = float __attribute__((vector_size(16)));
BURIN_CHAINS(four_lanes, Four)
BURIN_CHAINS(one_lane, float)
#if defined(__x86_64__)
using Eight = float __attribute__((vector_size(32)));
using Sixteen = float __attribute__((vector_size(64)));
__attribute__((target("avx2,fma"))) BURIN_CHAINS(eight_lanes, Eight) __attribute__((target("avx512f")))
BURIN_CHAINS(sixteen_lanes, Sixteen)
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
