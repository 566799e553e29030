#include "burin/render/fast/curve_kernel_impl.h"

namespace burin {

extern const CurveKernels curve_kernels_generic;
const CurveKernels curve_kernels_generic = curve_kernels_of<xsimd::batch<float>>();

}  // namespace burin
