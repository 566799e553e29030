// optimize/start.h - scratches placed where and how the pictures want them.
//
// A simple model of light: a scratch adds, to each pixel it crosses in a view, `unit` times the length inside the pixel
// (in pixels) times the lobe of glint.h for the scratch's direction. The unit comes from the renderer itself
// (measure_units), so lamp, fall-off, cut-off and material are in it. On this model strokes are placed one by one, each
// the best of several random candidates: a place, a view it is meant for, a length, and a turn away from the best
// direction that gives it the brightness which the picture still misses there. What it shows in the other views counts
// against it. (Matching pursuit - Mallat & Zhang, IEEE TSP 41(12), 1993 - with a random choice of atoms.)
//
// Errors are squared differences of light with a weight a pixel, which makes them those of the gamma-encoded pictures.
// Frame: board, mm; images as board_grid lays them, row 0 at the top.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "optimize/glint.h"
#include "render/image.h"
#include "render/scratches.h"
#include "render/view_renderer.h"

namespace burin {

/// What the model knows of one view. All images have the grid's size; light is relative to white.
struct StrokeView {
  GlintView glint;
  Image missing;  ///< target light minus shown light; strokes placed are subtracted
  Image weight;   ///< of a squared error in light
  Image unit;     ///< light of a pixel crossed along one pixel's length by a scratch of the best direction
};

struct StrokeRules {
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};  ///< the carve area, on which the images lie
  double shortest_mm = 0,
         longest_mm = 0;  ///< of a stroke; candidates' lengths are drawn between, evenly in their logarithm
  double alpha = 0.04;
  double dimmest = 0.02;  ///< least part of the lobe a stroke is turned to
  int candidates = 12;    ///< a stroke is the best of
};

/// A stroke and by how much it lowers the weighted squared error.
struct Stroke {
  Eigen::Vector2d a_mm{0, 0}, b_mm{0, 0};
  double gain = 0;
};

/// Light per mm of length, summed over pixels, that a scratch of the best direction sends to the view of `renderer`,
/// measured on a lattice of test scratches and interpolated to every pixel; in radiance times pixels per mm.
Image measure_units(ViewRenderer& renderer, const GlintView& glint, const Eigen::Vector2d& min_mm,
                    const Eigen::Vector2d& max_mm);

/// StrokeView::weight: the squared secant of the gamma curve between the light that is shown and the light of a
/// gamma-encoded target, times the mask squared, so that weight * missing^2 is the squared error of the encoded
/// picture.
Image light_weight(const Image& shown_light, const Image& encoded_target, const Image& mask);

/// Places `count` strokes one after the other, subtracting each from views[].missing. Deterministic for a seed.
/// Stops early once no candidate in many tries lowers the error by more than `least_gain`.
std::vector<Stroke> place_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, std::size_t count,
                                  std::uint64_t seed, double least_gain = 0);

/// By how much the weighted squared error would grow without each scratch, on the model; negative: it does harm.
std::vector<double> worth_of(const std::vector<StrokeView>& views, const StrokeRules& rules,
                             const Scratches& scratches);

/// Takes the light of scratch `index` out of the pictures: adds it to views[].missing.
void lift_stroke(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                 std::size_t index);

}  // namespace burin
