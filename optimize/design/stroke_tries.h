// burin/optimize/design/stroke_tries.h - search of strokes in one tile: random points and turns, and the kernel's best
// stroke. Frames: board, mm; pixels of the picture, y down.
#pragma once

#include <cstdint>
#include <vector>

#include "burin/optimize/design/random.h"
#include "burin/optimize/design/stroke_field.h"
#include "burin/optimize/design/stroke_kernel.h"
#include "burin/optimize/design/stroke_tiles.h"
#include "burin/optimize/design/stroke_types.h"

namespace burin {

/// The searcher of one tile. It owns all its data, except the field's pixels in its box.
class StrokeTrier {
 public:
  /// `field` and `rules` must outlive this object.
  StrokeTrier(const StrokeField& field, const StrokeRules& rules, const PixelBox& box, std::uint64_t seed);

  /// Updates the missing light of the box.
  void survey();
  bool misses_anything() const { return missing_.all() > 0; }

  /// The best of `candidates` strokes in the box, mostly at places with missing light. gain 0: none gains anything.
  Stroke best_anywhere(int candidates);
  /// The best of `old`, which is removed from the picture, and of candidates near it and elsewhere. Equal to `old` if
  /// none is better.
  Stroke best_instead(const Stroke& old, int candidates);

  SplitMix64& random() { return random_; }
  StrokePixelsBefore& before() { return before_; }  ///< for changes with undo
  const PixelBox& box() const { return box_; }

 private:
  void draw_anywhere(int lane);
  void draw_near(int lane, const Eigen::Vector2d& a, const Eigen::Vector2d& b);
  double alpha_at_pixel(const Eigen::Vector2d& in_window) const;
  bool take_best(Stroke& best);

  const StrokeField& field_;
  const StrokeRules& rules_;
  PixelBox box_;
  StrokeWindow window_;
  TryStrokes kernel_;
  SplitMix64 random_;
  MissingLight missing_;
  StrokePixelsBefore before_;
  StrokeTries tries_;
  StrokesFound found_;
};

}  // namespace burin
