// burin/base/simd_width.h - SIMD widths of the float kernels. One build contains several and chooses on the machine.
#pragma once

#include <cstdint>

namespace burin {

/// `generic` is the compiler's base line (SSE2, NEON); `best` is the widest on this machine.
enum class SimdWidth : std::uint8_t { best, generic, avx2, avx512 };

/// True if this build, the processor and the operating system run a width.
bool has_kernel(SimdWidth width);

/// `best` as a concrete width. Throws Error for a width that does not run here.
SimdWidth resolved_simd(SimdWidth width);

/// Sets the width of `best` everywhere in the process (`best`: the widest again) and returns the previous one.
/// SimdChoice (simd_choice.h) calls it, and restores the previous width.
SimdWidth replace_best(SimdWidth width);

/// SIMD lanes: floats in one vector of a width.
int kernel_lanes(SimdWidth width);

const char* name(SimdWidth width);  ///< "sse2", "avx2", "avx512" ("generic" elsewhere)

}  // namespace burin
