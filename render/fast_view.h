// render/fast_view.h - one view rendered in float packets: the fast twin of render/exact_view.h. DESIGN 7.
//
// The picture is cut into tiles of kTile x kTile pixels. Each iteration: scratches are put along a Morton curve; their
// pixels are found as spans and sorted into tiles; each tile then works through its scratches by itself, so that what
// it adds up stays in the cache, and every sum has one order, whatever the number of threads. A scratch within a tile
// is a `run`: its pairs lie one after the other, with their Jacobian, so backward() is a gather over pixel weights.
// Frame: board, mm. Buffers grow to the largest iteration and are kept.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "render/pair_batch.h"
#include "render/pairs.h"
#include "render/view_renderer.h"

namespace burin {

class FastView {
 public:
  /// `scene` and `index` must outlive this. Throws Error for scene values out of range (as view_pixels()).
  FastView(const ViewScene& scene, const PixelIndex& index, int channels, SimdWidth width);
  ~FastView();
  FastView(const FastView&) = delete;
  FastView& operator=(const FastView&) = delete;

  void forward(const Scratches& scratches, BatchMode mode, Image& radiance);
  /// Needs a forward() with BatchMode::ends or material. Derivatives by material are left as they are after `ends`.
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;
  void add_contributions(std::vector<double>& contribution) const;
  std::size_t pair_count() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace burin
