#include "burin/base/simd_width.h"

#include <atomic>
#include <string>

#include "burin/base/error.h"

namespace burin {
namespace {

std::atomic<SimdWidth> chosen = SimdWidth::best;

std::string widths_here() {
  std::string names;
  for (const SimdWidth width : {SimdWidth::generic, SimdWidth::avx2, SimdWidth::avx512})
    if (has_kernel(width)) names += (names.empty() ? "" : " or ") + std::string(name(width));
  return names;
}

}  // namespace

bool has_kernel(SimdWidth width) {
  switch (width) {
    case SimdWidth::best:
    case SimdWidth::generic:
      return true;
#ifdef BURIN_X86_KERNELS
    // The built-ins check the processor and the system's support for its registers.
    case SimdWidth::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case SimdWidth::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("fma");
#endif
    default:
      return false;
  }
}

SimdWidth resolved_simd(SimdWidth width) {
  if (!has_kernel(width))
    fail("simd", std::string(name(width)) + " does not run on this machine: its processor or system lacks it",
         "choose " + widths_here());
  if (width != SimdWidth::best) return width;
  if (const SimdWidth wanted = chosen; wanted != SimdWidth::best) return wanted;
  if (has_kernel(SimdWidth::avx512)) return SimdWidth::avx512;
  return has_kernel(SimdWidth::avx2) ? SimdWidth::avx2 : SimdWidth::generic;
}

SimdWidth replace_best(SimdWidth width) { return chosen.exchange(width); }

int kernel_lanes(SimdWidth width) {
  switch (resolved_simd(width)) {
    case SimdWidth::avx512:
      return 16;
    case SimdWidth::avx2:
      return 8;
    default:
      return 4;
  }
}

const char* name(SimdWidth width) {
  switch (width) {
    case SimdWidth::best:
      return name(resolved_simd(width));
    case SimdWidth::avx2:
      return "avx2";
    case SimdWidth::avx512:
      return "avx512";
    default:
#ifdef BURIN_X86_KERNELS
      return "sse2";
#else
      return "generic";
#endif
  }
}

}  // namespace burin
