#include "burin/scene/scratch_gradients.h"

namespace burin {

void ScratchGradients::resize(std::size_t scratch_count) {
  for (std::vector<double>* v : {&x0_mm, &y0_mm, &x1_mm, &y1_mm, &width_um, &depth_um, &alpha})
    v->assign(scratch_count, 0);
  shared_width_um = shared_depth_um = shared_alpha = shared_base_alpha = 0;
}

}  // namespace burin
