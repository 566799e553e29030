// burin/scene/scratch_gradients.h - derivatives of one number by everything that a set of scratches is made of.
#pragma once

#include <cstddef>
#include <vector>

namespace burin {

/// dE/d(...) summed over views: one entry a scratch. ViewRenderer::backward() adds to it, and sizes what is
/// empty; resize() zeroes it.
/// The shared_ numbers are for parameters that scratches do not carry themselves, and always the sum over scratches.
struct ScratchGradients {
  std::vector<double> x0_mm, y0_mm, x1_mm, y1_mm;
  std::vector<double> width_um, depth_um, alpha;
  double shared_width_um = 0, shared_depth_um = 0, shared_alpha = 0, shared_base_alpha = 0;

  /// Zeros for so many scratches.
  void resize(std::size_t scratch_count);
};

}  // namespace burin
