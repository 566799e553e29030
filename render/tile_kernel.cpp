#include "render/tile_kernel.h"

namespace burin {

// One a file of its own instruction set; BURIN_X86_KERNELS where the build has the x86 ones.
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

std::size_t TilePairs::bytes() const {
  std::size_t floats = 0;
  for (const std::vector<float>* v : {&light, &shift, &turn, &width, &rim, &alpha}) floats += v->capacity();
  return floats * sizeof(float) + begin.capacity() * sizeof(std::uint32_t) + place.capacity() * sizeof(std::uint16_t) +
         ends.capacity() * sizeof(EndPair);
}

}  // namespace burin
