#include "burin/optimize/design/stroke_kernel_impl.h"

namespace burin {

extern const TryStrokes try_strokes_avx2;
const TryStrokes try_strokes_avx2 = StrokeKernel<xsimd::batch<float, xsimd::avx2>>::try_strokes;

}  // namespace burin
