// How fast the moments of the footprint integral are, for each packet width, against what the machine can do: intervals
// a second, and the fraction of the multiply-add peak that a second holds, measured in the same run. One core.
// Correctness stands beside time: `error` is that of IntervalWork, against double.
#include <benchmark/benchmark.h>

#include "render/moment_packets.h"
#include "tests/bench/interval_work.h"
#include "tests/bench/multiply_add_peak.h"

namespace burin {
namespace {

using namespace footprint;

void MultiplyAddPeak(benchmark::State& state) {
  const auto width = PacketWidth(state.range(0));
  if (!supported(width)) {
    state.SkipWithError("this machine does not have it");
    return;
  }
  double operations = 0;
  for (auto _ : state) operations += multiply_add(static_cast<int>(width));
  state.counters["operations"] = benchmark::Counter(operations, benchmark::Counter::kIsRate);
}

void run(benchmark::State& state, PacketWidth width, bool derivatives) {
  if (!supported(width)) {
    state.SkipWithError("this machine does not have it");
    return;
  }
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
  state.counters["of_peak"] =
      benchmark::Counter(double(state.iterations()) * 8192 * per_interval / multiply_add_peak(static_cast<int>(width)),
                         benchmark::Counter::kIsRate);
  state.counters["error"] = work.error();
}

void Moments(benchmark::State& state) { run(state, PacketWidth(state.range(0)), false); }
void MomentsWithDerivatives(benchmark::State& state) { run(state, PacketWidth(state.range(0)), true); }

BENCHMARK(MultiplyAddPeak)->ArgName("width")->Arg(1)->Arg(4)->Arg(8)->Arg(16);
BENCHMARK(Moments)->ArgName("width")->Arg(1)->Arg(4)->Arg(8)->Arg(16);
BENCHMARK(MomentsWithDerivatives)->ArgName("width")->Arg(1)->Arg(4)->Arg(8)->Arg(16);

}  // namespace
}  // namespace burin
