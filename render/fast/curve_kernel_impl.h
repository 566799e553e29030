// burin/render/fast/curve_kernel_impl.h - kernels of burin/render/fast/curve_kernel.h over a SIMD vector type. Only the
// files compiled for one instruction set each include it (see burin/render/fast/packet_math.h).
#pragma once

#include "burin/render/fast/curve_kernel.h"
#include "burin/render/fast/kernel/evaluate.h"
#include "burin/render/fast/kernel/lamp_knots.h"
#include "burin/render/fast/kernel/run_curves.h"

namespace burin {

template <class P>
constexpr CurveKernels curve_kernels_of() {
  return {kernel::make_curves<P>, kernel::make_lamp_curves<P>, kernel::evaluate<P, true>};
}

}  // namespace burin
