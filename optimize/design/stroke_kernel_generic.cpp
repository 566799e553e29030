#include "burin/optimize/design/stroke_kernel_impl.h"

namespace burin {

extern const TryStrokes try_strokes_generic;
const TryStrokes try_strokes_generic = StrokeKernel<xsimd::batch<float>>::try_strokes;

}  // namespace burin
