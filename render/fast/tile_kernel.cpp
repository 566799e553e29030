#include "burin/render/fast/tile_kernel.h"

namespace burin {

// One per file with its own instruction set; the build defines BURIN_X86_KERNELS if it has the x86 kernels.
extern const TileKernels tile_kernels_generic;
#ifdef BURIN_X86_KERNELS
extern const TileKernels tile_kernels_avx2;
extern const TileKernels tile_kernels_avx512;
#endif

const TileKernels& tile_kernels(SimdWidth width) {
  switch (resolved_simd(width)) {
#ifdef BURIN_X86_KERNELS
    case SimdWidth::avx2:
      return tile_kernels_avx2;
    case SimdWidth::avx512:
      return tile_kernels_avx512;
#endif
    default:
      return tile_kernels_generic;
  }
}

}  // namespace burin
