// burin/scene/scratch_gradients.h - derivatives of one number by all coordinates and parameters of a set of scratches.
#pragma once

#include <cstddef>
#include <vector>

namespace burin {

/// dE/d(...) summed over views: one entry per scratch. ViewRenderer::backward() sizes empty arrays and adds to them;
/// resize() zeroes them. The shared_ numbers belong to parameters without a value per scratch, and are always sums over
/// scratches.
struct ScratchGradients {
  std::vector<double> x0_mm, y0_mm, x1_mm, y1_mm;
  std::vector<double> width_um, depth_um, alpha;
  double shared_width_um = 0, shared_depth_um = 0, shared_alpha = 0, shared_base_alpha = 0;

  /// Zeros for `scratch_count` scratches.
  void resize(std::size_t scratch_count);
};

}  // namespace burin
