// How fast the moments of the footprint integral are, for each packet width, against what the machine can do: intervals
// a second, and the fraction of the multiply-add peak that a second holds, measured in the same run.
//
// Correctness stands beside time: `error` is the largest error of m0 over the intervals, over the largest m0 that its
// peak and length allow, against double. One core. Half vectors and intervals as a board shows them: 62 % whole grooves
// [-T, T], the rest cut by a pixel's edges; alpha 0.02 to 0.2.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "render/footprint_core.h"
#include "render/moment_packets.h"

namespace {

using namespace burin::footprint;

struct Work {
  std::vector<float> hx, hy, hz, alpha, t1, t2;
  std::vector<float> r[6];
  std::vector<double> m0, most;  // in double; and length of the interval times the peak of W

  explicit Work(int count) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> u(0, 1);
    const auto push = [](std::vector<float>& v, double x) { v.push_back(float(x)); };
    for (int i = 0; i < count; ++i) {
      const double tilt = 0.6 * u(random), azimuth = 6.2831853 * u(random), T = 0.2 + 0.15 * u(random);
      push(hx, std::sin(tilt) * std::cos(azimuth));
      push(hy, std::sin(tilt) * std::sin(azimuth));
      push(hz, std::cos(tilt));
      push(alpha, 0.02 * std::pow(10, u(random)));
      double a = -T, b = T;
      if (u(random) > 0.62) {
        a = -T + 2 * T * u(random);
        b = -T + 2 * T * u(random);
      }
      push(t1, std::min(a, b));
      push(t2, std::max(a, b));
      const auto lobes = make_lobes<double>(hx[i], hy[i], hz[i], alpha[i]);
      m0.push_back(burin::footprint::moments<double>(lobes, t1[i], t2[i]).m0);
      most.push_back((double(t2[i]) - t1[i]) * std::pow(lobes.s2, -2));
    }
    for (auto& v : r) v.resize(count);
  }

  Intervals intervals() const { return {hx, hy, hz, alpha, t1, t2}; }
  MomentArrays results() { return {r[0], r[1], r[2], r[3], r[4], r[5]}; }
  double error() const {
    double e = 0;
    for (std::size_t i = 0; i < m0.size(); ++i) {
      if (most[i] > 0) e = std::max(e, std::abs(r[0][i] - m0[i]) / most[i]);
    }
    return e;
  }
};

// A float that counts what is done to it.
struct Counted {
  using value_type = float;  // constants and tables are float's
  float v = 0;
  static inline long operations = 0;
  Counted() = default;
  Counted(double x) : v(float(x)) {}
  Counted operator-() const { return Counted(-v); }
};
Counted counted(float v) {
  ++Counted::operations;
  return Counted(v);
}
Counted operator+(Counted a, Counted b) { return counted(a.v + b.v); }
Counted operator-(Counted a, Counted b) { return counted(a.v - b.v); }
Counted operator*(Counted a, Counted b) { return counted(a.v * b.v); }
Counted operator/(Counted a, Counted b) { return counted(a.v / b.v); }
Counted sqrt(Counted a) { return counted(std::sqrt(a.v)); }
Counted log1p(Counted a) { return counted(std::log1p(a.v)); }
Counted abs(Counted a) { return Counted(std::abs(a.v)); }
Counted max(Counted a, Counted b) { return Counted(std::max(a.v, b.v)); }
Counted select(bool mask, Counted a, Counted b) { return mask ? a : b; }
bool operator<(Counted a, Counted b) { return a.v < b.v; }
bool operator>(Counted a, Counted b) { return a.v > b.v; }
bool operator>=(Counted a, Counted b) { return a.v >= b.v; }

double operations_per_interval(const Work& w, bool derivatives) {
  Counted::operations = 0;
  for (std::size_t i = 0; i < w.t1.size(); ++i) {
    const auto lobes = make_lobes<Counted>(w.hx[i], w.hy[i], w.hz[i], w.alpha[i]);
    if (derivatives) {
      benchmark::DoNotOptimize(burin::footprint::moments_with_derivatives<Counted>(lobes, w.t1[i], w.t2[i]));
    } else {
      benchmark::DoNotOptimize(burin::footprint::moments<Counted>(lobes, w.t1[i], w.t2[i]));
    }
  }
  return double(Counted::operations) / double(w.t1.size());
}

// Multiply-adds on registers alone, sixteen chains so that none waits for another; returns their number.
constexpr long kRounds = 1 << 16;
#if defined(__x86_64__)
__attribute__((target("avx512f"))) double multiply_add_avx512() {
  __m512 x[16], m = _mm512_set1_ps(0.999F), a = _mm512_set1_ps(1e-3F);
  for (int k = 0; k < 16; ++k) x[k] = _mm512_set1_ps(float(k));
  for (long i = 0; i < kRounds; ++i) {
    for (auto& v : x) v = _mm512_fmadd_ps(v, m, a);
  }
  for (auto& v : x) benchmark::DoNotOptimize(v);
  return 2.0 * 16 * 16 * kRounds;
}
__attribute__((target("avx2,fma"))) double multiply_add_avx2() {
  __m256 x[12], m = _mm256_set1_ps(0.999F), a = _mm256_set1_ps(1e-3F);
  for (int k = 0; k < 12; ++k) x[k] = _mm256_set1_ps(float(k));
  for (long i = 0; i < kRounds; ++i) {
    for (auto& v : x) v = _mm256_fmadd_ps(v, m, a);
  }
  for (auto& v : x) benchmark::DoNotOptimize(v);
  return 2.0 * 8 * 12 * kRounds;
}
double multiply_add_base() {
  __m128 x[12], m = _mm_set1_ps(0.999F), a = _mm_set1_ps(1e-3F);
  for (int k = 0; k < 12; ++k) x[k] = _mm_set1_ps(float(k));
  for (long i = 0; i < kRounds; ++i) {
    for (auto& v : x) v = _mm_add_ps(_mm_mul_ps(v, m), a);
  }
  for (auto& v : x) benchmark::DoNotOptimize(v);
  return 2.0 * 4 * 12 * kRounds;
}
#endif
double multiply_add_scalar() {
  float x[12];
  for (int k = 0; k < 12; ++k) x[k] = float(k);
  for (long i = 0; i < kRounds; ++i) {
    for (auto& v : x) {
      v = v * 0.999F + 1e-3F;
#if defined(__x86_64__)
      asm volatile("" : "+x"(v));  // keeps the compiler from making packets of it
#else
      benchmark::DoNotOptimize(v);
#endif
    }
  }
  return 2.0 * 12 * kRounds;
}

double multiply_add(PacketWidth width) {
#if defined(__x86_64__)
  if (width == PacketWidth::avx512) return multiply_add_avx512();
  if (width == PacketWidth::avx2) return multiply_add_avx2();
  if (width == PacketWidth::base) return multiply_add_base();
#endif
  return multiply_add_scalar();
}

// Operations a second, the best of a few runs; once a width.
double peak(PacketWidth width) {
  static std::map<PacketWidth, double> known;
  double& best = known[width];
  if (best > 0) return best;
  for (int i = 0; i < 30; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const double operations = multiply_add(width);
    best = std::max(best, operations / std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

void MultiplyAddPeak(benchmark::State& state) {
  const auto width = PacketWidth(state.range(0));
  if (!supported(width)) {
    state.SkipWithError("this machine does not have it");
    return;
  }
  double operations = 0;
  for (auto _ : state) operations += multiply_add(width);
  state.counters["operations"] = benchmark::Counter(operations, benchmark::Counter::kIsRate);
}

void run(benchmark::State& state, PacketWidth width, bool derivatives) {
  if (!supported(width)) {
    state.SkipWithError("this machine does not have it");
    return;
  }
  Work work(8192);
  for (auto _ : state) {
    if (derivatives) {
      moments_with_derivatives(work.intervals(), work.results(), width);
    } else {
      moments(work.intervals(), work.results(), width);
    }
    benchmark::DoNotOptimize(work.r[0].data());
    benchmark::ClobberMemory();
  }
  state.counters["intervals"] = benchmark::Counter(double(state.iterations()) * 8192, benchmark::Counter::kIsRate);
  const double per_interval = operations_per_interval(work, derivatives);
  state.counters["operations_each"] = per_interval;
  state.counters["of_peak"] =
      benchmark::Counter(double(state.iterations()) * 8192 * per_interval / peak(width), benchmark::Counter::kIsRate);
  state.counters["error"] = work.error();
}

void Moments(benchmark::State& state) { run(state, PacketWidth(state.range(0)), false); }
void MomentsWithDerivatives(benchmark::State& state) { run(state, PacketWidth(state.range(0)), true); }

BENCHMARK(MultiplyAddPeak)->ArgName("width")->Arg(1)->Arg(4)->Arg(8)->Arg(16);
BENCHMARK(Moments)->ArgName("width")->Arg(1)->Arg(4)->Arg(8)->Arg(16);
BENCHMARK(MomentsWithDerivatives)->ArgName("width")->Arg(1)->Arg(4)->Arg(8)->Arg(16);

}  // namespace
