#include "burin/render/fast/tile_kernel_impl.h"

namespace burin {

extern const TileKernels tile_kernels_generic;
const TileKernels tile_kernels_generic = tile_kernels_of<xsimd::batch<float>>();

}  // namespace burin
