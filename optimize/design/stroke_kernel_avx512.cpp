#include "burin/optimize/design/stroke_kernel_impl.h"

namespace burin {

extern const TryStrokes try_strokes_avx512;
const TryStrokes try_strokes_avx512 = StrokeKernel<xsimd::batch<float, xsimd::avx512bw>>::try_strokes;

}  // namespace burin
