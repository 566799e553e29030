#include "burin/render/fast/tile_kernel_impl.h"

namespace burin {

extern const TileKernels tile_kernels_avx2;
const TileKernels tile_kernels_avx2 = tile_kernels_of<xsimd::batch<float, xsimd::fma3<xsimd::avx2>>>();

}  // namespace burin
