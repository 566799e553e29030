// burin/render/lanes_view.h - one view under one lamp of grooves that cut one another, lane by lane. Frame: board, mm.
// docs/model.md 8.8.
//
// A lane that is seen is a line of light: so much a millimeter, which follows from the half vector and the lean of the
// wall, and changes smoothly along the groove whatever its cross-section and the lamp's area. A pixel gets of each lane
// the length of its chord, less what other grooves take of it. So light is found once a groove and not once a pixel,
// and a view costs as much as its lanes have chords.
//
// Moving a pixel's edge outwards by a little adds that times the light that crosses it: all derivatives by place follow
// from one sum for each edge, and its first moment along the edge.
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

/// Whether lanes serve a scene: one near lamp, and a face that is no mesh.
bool takes_lanes(const ViewScene& scene);

/// Grooves, and what is left of them.
struct LanedGrooves {
  const Scratches& grooves;
  const VisibleLanes& lanes;
};

class LanesView {
 public:
  /// `scene` must have passed check_view() and takes_lanes(); it may go.
  LanesView(const ViewScene& scene, int channels);
  ~LanesView();
  LanesView(const LanesView&) = delete;
  LanesView& operator=(const LanesView&) = delete;

  /// Radiance of every pixel; `keep_slopes` for backward().
  void forward(const LanedGrooves& of, bool keep_slopes, Image& radiance);
  /// The gradient for the grooves of the last forward(), which kept its slopes, and which must be given again: by their
  /// ends, depth and alpha, not by their width. What others cut of them is held.
  void backward(const LanedGrooves& of, const Image& dE_dradiance, ScratchGradients& gradients) const;
  /// As ViewRenderer::add_contributions().
  void add_contributions(const LanedGrooves& of, std::vector<double>& contribution) const;
  /// What the grooves of each pixel add up to, with all slopes but that by width. Of a point lamp.
  void find_slopes(const LanedGrooves& of);
  /// Of one pixel, after find_slopes(): `p` is that pixel's, lit and seen, and so are its footprint's corners and area.
  GrooveSums sums_of(std::size_t pixel, const PixelShading& p, const std::array<Eigen::Vector2d, 4>& corners_mm,
                     double area_mm2) const;
  /// Chords of the last forward().
  std::size_t chord_count() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace burin
