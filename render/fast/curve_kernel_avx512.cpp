#include "burin/render/fast/curve_kernel_impl.h"

namespace burin {

extern const CurveKernels curve_kernels_avx512;
const CurveKernels curve_kernels_avx512 = curve_kernels_of<xsimd::batch<float, xsimd::avx512bw>>();

}  // namespace burin
