// burin/render/lanes_view.h - one view under one lamp of grooves that cut one another, lane by lane. Frame: board, mm.
// docs/model.md 8.8.
//
// A visible lane is a line of light. Its light per millimeter follows from the half vector and the lean of the wall.
// Along the groove it changes smoothly, for any cross-section and any area of the lamp. A pixel gets from each lane the
// length of its chord, less the part that other grooves remove. So light is computed per groove and not per pixel, and
// the cost of a view is proportional to the number of chords.
//
// A small outward shift of a pixel's edge adds the shift times the light across the edge. So all derivatives by
// position follow from one sum per edge and its first moment along the edge.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "burin/base/image.h"
#include "burin/render/groove_sums.h"
#include "burin/render/pixel_shading.h"
#include "burin/render/view_scene.h"
#include "burin/scene/crossings.h"
#include "burin/scene/scratch_gradients.h"
#include "burin/scene/scratches.h"

namespace burin {

/// True if lanes can render a scene: it needs one near lamp and a face without a mesh.
bool takes_lanes(const ViewScene& scene);

/// Grooves and their visible lanes.
struct LanedGrooves {
  const Scratches& grooves;
  const VisibleLanes& lanes;
};

class LanesView {
 public:
  /// `scene` must have passed check_view() and takes_lanes(). The object keeps no reference to it.
  LanesView(const ViewScene& scene, int channels);
  ~LanesView();
  LanesView(const LanesView&) = delete;
  LanesView& operator=(const LanesView&) = delete;

  /// Radiance of every pixel; `keep_slopes` for backward().
  void forward(const LanedGrooves& of, bool keep_slopes, Image& radiance);
  /// Gradient for the grooves of the last forward(), by their ends, depth and alpha, but not by width. `of` must be
  /// those grooves, and that forward() must have kept its slopes. The parts that other grooves cut off stay fixed.
  void backward(const LanedGrooves& of, const Image& dE_dradiance, ScratchGradients& gradients) const;
  /// As ViewRenderer::add_contributions().
  void add_contributions(const LanedGrooves& of, std::vector<double>& contribution) const;
  /// Sums over the grooves of each pixel with all derivatives except the one by width. Requires a point lamp.
  void find_slopes(const LanedGrooves& of);
  /// Sums of one pixel, after find_slopes(). `p` is the shading of this pixel, which is lit and visible. The corners
  /// and area are those of its footprint.
  GrooveSums sums_of(std::size_t pixel, const PixelShading& p, const std::array<Eigen::Vector2d, 4>& corners_mm,
                     double area_mm2) const;
  /// Chords of the last forward().
  std::size_t chord_count() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace burin
