#include "burin/optimize/design/design_memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"

namespace burin {
namespace {

constexpr double kOfPixel = 85, kOfScratch = 1300, kProgram = 60e6;

// The number after a name, or the first number of the file.
std::optional<double> figure_in(const char* file, const std::string& name) {
  std::ifstream in(file);
  double number = 0;
  if (name.empty()) return in >> number ? std::optional(number) : std::nullopt;
  std::string word;
  while (in >> word)
    if (word == name) return in >> number ? std::optional(number) : std::nullopt;
  return std::nullopt;
}

std::string gigabytes(double bytes) { return fixed(bytes / 1e9, bytes < 1e9 ? 2 : 1) + " GB"; }

}  // namespace

double design_bytes(double pixels, double scratches) { return kProgram + kOfPixel * pixels + kOfScratch * scratches; }

std::optional<double> free_bytes() {
  constexpr double kKiB = 1024;
  std::optional<double> free;
  const auto no_more_than = [&free](std::optional<double> bytes) {
    if (bytes) free = std::min(free.value_or(std::numeric_limits<double>::infinity()), std::max(0.0, *bytes));
  };
  if (const auto system = figure_in("/proc/meminfo", "MemAvailable:")) no_more_than(kKiB * *system);
  if (const auto most = figure_in("/sys/fs/cgroup/memory.max", ""))
    if (const auto used = figure_in("/sys/fs/cgroup/memory.current", "")) no_more_than(*most - *used);
  rlimit own{};
  if (getrlimit(RLIMIT_AS, &own) == 0 && own.rlim_cur != RLIM_INFINITY)
    if (const auto used = figure_in("/proc/self/status", "VmSize:"))
      no_more_than(static_cast<double>(own.rlim_cur) - kKiB * *used);
  return free;
}

void require_memory(double pixels, int longer_px, double scratches, std::optional<double> free) {
  const double needed = design_bytes(pixels, scratches);
  if (!free || needed <= *free) return;
  const double for_pixels = *free - design_bytes(0, scratches);
  const int fits_px =
      for_pixels > 0 ? static_cast<int>(0.95 * longer_px * std::sqrt(for_pixels / (kOfPixel * pixels))) : 0;
  constexpr int kFewest = 64;
  const double fit = std::floor(0.9 * (*free - design_bytes(pixels, 0)) / kOfScratch);
  fail("design",
       "needs about " + gigabytes(needed) + " of memory for " + fixed(scratches, 0) + " scratches and " +
           fixed(pixels / 1e6, 1) + " million pixels of all views, and " + gigabytes(*free) + " are free",
       fits_px >= kFewest ? "--pixels " + std::to_string(fits_px) + " fits"
       : fit >= 1         ? "--scratches " + fixed(fit, 0) + " fit"
                          : "ask for fewer scratches and fewer pixels, or end other programs");
}

}  // namespace burin
