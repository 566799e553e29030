#include "burin/render/fast/curve_kernel.h"

namespace burin {

void TileCurves::grow_runs(std::size_t count) {
  if (runs.size() < count) runs.resize(2 * count);
  line_stride = runs.size();
  lines.resize(kMostLines * line_stride);
}

void TileCurves::start_rows(std::size_t count, std::size_t floats) {
  row_made.assign(count, 0);
  row_wanted.assign(count, 0);
  row_light.resize(4 * count);
  if (rows.size() < count * floats) rows.resize(count * floats);
}

void TileCurves::grow_rows(std::size_t floats) {
  if (rows.size() < floats) rows.resize(floats);
}

void TileCurves::grow_knots(std::size_t floats) {
  if (knots.size() < floats) knots.resize(2 * floats);
}

// One per file with its own instruction set; the build defines BURIN_X86_KERNELS if it has the x86 kernels.
extern const CurveKernels curve_kernels_generic;
#ifdef BURIN_X86_KERNELS
extern const CurveKernels curve_kernels_avx2;
extern const CurveKernels curve_kernels_avx512;
#endif

const CurveKernels& curve_kernels(SimdWidth width) {
  switch (resolved_simd(width)) {
#ifdef BURIN_X86_KERNELS
    case SimdWidth::avx2:
      return curve_kernels_avx2;
    case SimdWidth::avx512:
      return curve_kernels_avx512;
#endif
    default:
      return curve_kernels_generic;
  }
}

}  // namespace burin
