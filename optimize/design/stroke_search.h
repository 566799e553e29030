// burin/optimize/design/stroke_search.h - greedy initialization and re-insertion search: scratches at the places at
// which they lower the pictures' error most.
//
// The loss has many local minima: a scratch one pixel from its best place has no gradient towards it. The search uses a
// light model instead. A scratch adds light to each pixel that it crosses, in the one view for which it is made. This
// light is `unit` times its length inside the pixel (in pixels) times the lobe of glint.h, which follows the view's
// half vector along the scratch. The renderer measures `unit` (measure_units), so it includes lamp, falloff, cutoff
// angle and material. The model is exact for grooves much narrower than a pixel. On five views of photographs it
// predicts their PSNR to 0.1 dB.
//
// For a point and a direction, the best ends are found exactly. The error that a stroke removes is a sum over the
// crossed pixels, so its ends are at the maxima of the running sums to both sides. Points and directions, and with them
// brightnesses, are drawn at random. Most points are at places with missing light, or near the stroke to replace.
//
//   place_strokes    one stroke after the other (matching pursuit: Mallat & Zhang, IEEE TSP 41(12), 1993, with a random
//                    choice of atoms); the light: docs/model.md 6.5
//   improve_strokes  removes each stroke together with the nearest stroke at one of its ends. It inserts the
//                    best of several candidates, the old stroke among them, for each of the two (block coordinate
//                    descent; of two strokes in a line, neither could move alone)
//
// Errors are squared differences of the shown pictures, gamma-encoded and clipped at white, times the mask squared. A
// stroke's light in other views is part of `light` as rendered, and is not counted again.
//
// Tiles divide the pictures (stroke_tiles.h). Only strokes inside the same tile replace a stroke inside it, so tiles
// run in parallel. Their positions change every time, and longer strokes wait for larger ones. The kernel tries sixteen
// candidates at once (stroke_kernel.h). Each tile has one fixed order and its own random numbers: the same seed gives
// the same bits for any number of threads. Frame: board, mm; images as in board_grid, row 0 at the top.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "burin/base/image.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/design/stroke_types.h"
#include "burin/optimize/design/to_metal.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/carve.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Unit light of the view of `renderer`: light per mm of length, summed over pixels, from a scratch of the best
/// direction, in radiance times pixels per mm. It is measured on a lattice of test scratches and interpolated to every
/// pixel. `carve` carves the test scratches, so the unit includes the spatial variation of depth and roughness, and
/// with them the covered lobe fraction.
Image measure_units(ViewRenderer& renderer, const GlintView& glint, const Eigen::Vector2d& min_mm,
                    const Eigen::Vector2d& max_mm, const std::function<Carved(const Scratches&)>& carve = in_metal);

/// Places up to `count` strokes. The last ones gain about equally in all views. Fewer result if no candidate of many
/// tries gains anything, or once `stop` (called now and then) returns true. Adds their light to `views`.
std::vector<Stroke> place_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, std::size_t count,
                                  std::uint64_t seed, const std::function<bool()>& stop = {});

/// Improves the first `movable` scratches in one sweep, or in part of one once `stop` returns true. `views` must show
/// all scratches; the function updates them. Returns the changed scratches, ascending.
std::vector<std::size_t> improve_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, Scratches& scratches,
                                         std::size_t movable, std::uint64_t seed,
                                         const std::function<bool()>& stop = {});

/// Squared error of the shown pictures of one view (with its asides), or of all views (a shared picture counts once).
/// Gains and marginal contributions are parts of it.
double squared_error(const StrokeView& view);
double squared_error(const std::vector<StrokeView>& views);

/// Marginal contribution: increase of the squared error without each scratch, in the view for which it is made. A
/// negative one means harm.
std::vector<double> worth_of(std::vector<StrokeView> views, const StrokeRules& rules, const Scratches& scratches);

/// Pruning order of the first `movable` scratches. Each step takes the scratch with the least marginal contribution per
/// cost, given all earlier removals. `cost` has one positive value per scratch, or is empty for equal costs.
/// `spare(scratch, worth)` is called before each removal; false ends the order before it.
std::vector<std::size_t> spare_order(std::vector<StrokeView> views, const StrokeRules& rules,
                                     const Scratches& scratches, std::size_t movable, const std::vector<double>& cost,
                                     const std::function<bool(std::size_t, double)>& spare);

/// Removes the light of these scratches from the views for which they are made, or adds it there.
void lift_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                  const std::vector<std::size_t>& which);
void add_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                 const std::vector<std::size_t>& which);

}  // namespace burin
