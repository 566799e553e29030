// burin/base/simd_width.h - which instructions the float kernels use. One build holds several and chooses on the
// machine.
#pragma once

#include <cstdint>

namespace burin {

/// `generic` is what the compiler's base line allows (SSE2, NEON); `best` the widest that this machine runs.
enum class SimdWidth : std::uint8_t { best, generic, avx2, avx512 };

/// Whether this build and this machine, its system included, run a width.
bool has_kernel(SimdWidth width);

/// `best` made concrete. Throws Error for a width that does not run here.
SimdWidth resolved_simd(SimdWidth width);

/// From now on `best` is this width everywhere in the process (`best`: the widest again). Gives what it was before.
/// SimdChoice (simd_choice.h) calls it, and takes it back.
SimdWidth replace_best(SimdWidth width);

/// Floats in one packet of a width.
int kernel_lanes(SimdWidth width);

const char* name(SimdWidth width);  ///< "sse2", "avx2", "avx512" ("generic" elsewhere)

}  // namespace burin
