#include "burin/optimize/design/stroke_kernel.h"

namespace burin {

// One kernel per file and instruction set; BURIN_X86_KERNELS is defined if the build has the x86 ones.
extern const TryStrokes try_strokes_generic;
#ifdef BURIN_X86_KERNELS
extern const TryStrokes try_strokes_avx2;
extern const TryStrokes try_strokes_avx512;
#endif

TryStrokes try_strokes(SimdWidth width) {
  switch (resolved_simd(width)) {
#ifdef BURIN_X86_KERNELS
    case SimdWidth::avx2:
      return try_strokes_avx2;
    case SimdWidth::avx512:
      return try_strokes_avx512;
#endif
    default:
      return try_strokes_generic;
  }
}

}  // namespace burin
