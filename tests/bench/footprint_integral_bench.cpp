// How fast the moments of the footprint integral are, for each packet width, against what the machine can do: intervals
// a second, and the fraction of the multiply-add peak that a second holds, measured in the same run. One core.
// Correctness stands beside time: `error` is that of IntervalWork, against double.
#include <benchmark/benchmark.h>

#include "burin/base/simd_width.h"
#include "tests/bench/interval_work.h"
#include "tests/bench/multiply_add_peak.h"
#include "tests/moment_packets/moment_packets.h"

namespace burin {
namespace {

using namespace footprint;

SimdWidth width_of(std::int64_t lanes) {
  return lanes == 16 ? SimdWidth::avx512 : lanes == 8 ? SimdWidth::avx2 : SimdWidth::generic;
}

bool can_run(benchmark::State& state) {
  if (has_kernel(width_of(state.range(0)))) return true;
  state.SkipWithError("this machine does not have it");
  return false;
}

void MultiplyAddPeak(benchmark::State& state) {
  if (!can_run(state)) return;
  double operations = 0;
  for (auto _ : state) operations += multiply_add(static_cast<int>(state.range(0)));
  state.counters["operations"] = benchmark::Counter(operations, benchmark::Counter::kIsRate);
}

void run(benchmark::State& state, bool derivatives) {
  if (!can_run(state)) return;
  const auto lanes = static_cast<int>(state.range(0));
  const SimdWidth width = width_of(lanes);
  IntervalWork work(8192);
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
  state.counters["of_peak"] = benchmark::Counter(
      double(state.iterations()) * 8192 * per_interval / multiply_add_peak(lanes), benchmark::Counter::kIsRate);
  state.counters["error"] = work.error();
}

void Moments(benchmark::State& state) { run(state, false); }
void MomentsWithDerivatives(benchmark::State& state) { run(state, true); }

BENCHMARK(MultiplyAddPeak)->ArgName("lanes")->Arg(1)->Arg(4)->Arg(8)->Arg(16);
BENCHMARK(Moments)->ArgName("lanes")->Arg(4)->Arg(8)->Arg(16);
BENCHMARK(MomentsWithDerivatives)->ArgName("lanes")->Arg(4)->Arg(8)->Arg(16);

}  // namespace
}  // namespace burin
