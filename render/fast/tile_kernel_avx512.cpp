#include "burin/render/fast/tile_kernel_impl.h"

namespace burin {

extern const TileKernels tile_kernels_avx512;
const TileKernels tile_kernels_avx512 = tile_kernels_of<xsimd::batch<float, xsimd::avx512bw>>();

}  // namespace burin
