#include "burin/render/fast/curve_kernel_impl.h"

namespace burin {

extern const CurveKernels curve_kernels_avx2;
const CurveKernels curve_kernels_avx2 = curve_kernels_of<xsimd::batch<float, xsimd::fma3<xsimd::avx2>>>();

}  // namespace burin
