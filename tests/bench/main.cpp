// Google Benchmark's main, and what a reader of its JSON needs to know of the machine.
#include <benchmark/benchmark.h>

#include <fstream>
#include <string>
#include <thread>

#include "burin/base/simd_width.h"
#include "tests/bench/memory_bench.h"

namespace {

/// The value of the first line of a /proc file that begins with `key`, or "unknown".
std::string proc_value(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const auto colon = line.find(':');
    if (line.rfind(key, 0) != 0 || colon == std::string::npos) continue;
    const auto begin = line.find_first_not_of(" \t", colon + 1);
    return begin == std::string::npos ? "unknown" : line.substr(begin);
  }
  return "unknown";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--peak-memory") return burin::print_peak_memory();
  const std::string cpu = proc_value("/proc/cpuinfo", "model name") + ", family " +
                          proc_value("/proc/cpuinfo", "cpu family") + ", model " +
                          proc_value("/proc/cpuinfo", "model\t");
  benchmark::AddCustomContext("processor", cpu);
  benchmark::AddCustomContext("cores", std::to_string(std::thread::hardware_concurrency()));
  benchmark::AddCustomContext("memory", proc_value("/proc/meminfo", "MemTotal"));
  benchmark::AddCustomContext("packets", std::to_string(burin::kernel_lanes(burin::SimdWidth::best)) + " floats");
  benchmark::AddCustomContext("compiler", __VERSION__);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
