#include "burin/render/fast/tile_kernel_impl.h"

namespace burin {

extern const TileKernels tile_kernels_generic;
const TileKernels tile_kernels_generic = TileKernel<xsimd::batch<float>>::kernels();

}  // namespace burin
