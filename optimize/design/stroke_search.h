// burin/optimize/design/stroke_search.h - scratches placed, and placed again, where they lower the pictures' error
// most.
//
// Pictures of scratches are full of local minima: a scratch a pixel aside from where it belongs feels no slope towards
// it. So scratches are searched for, on a model of light: a scratch adds to each pixel that it crosses, in the one view
// that it is meant for, `unit` times its length inside the pixel (in pixels) times the lobe of glint.h, which follows
// the view's half vector along the scratch. `unit` comes from the renderer itself (measure_units), so lamp, fall-off,
// cut-off and material are in it. Exact for grooves much narrower than a pixel; on five views of photographs it tells
// their PSNR to 0.1 dB.
//
// Through a point, in a direction, the best ends are found exactly: the error that a stroke removes is a sum over the
// pixels crossed, so its ends lie where the running sums to both sides are largest. Points and directions - and with
// them brightnesses - are drawn at random, most of them where the picture misses light or near the stroke that is to be
// replaced.
//
//   place_strokes    one stroke after the other (matching pursuit: Mallat & Zhang, IEEE TSP 41(12), 1993, with a random
//                    choice of atoms); the light: docs/model.md 6.5
//   improve_strokes  takes each stroke out, with the one that ends nearest to one of its ends, and puts the best of
//                    several candidates, the old one among them, in the place of each (block coordinate descent; where
//                    one ends as the other begins, neither could give way alone)
//
// Errors are squared differences of the shown pictures, gamma-encoded and clipped at white, times the mask squared.
// What a stroke adds to other views than its own stands in `light` as rendered and is not counted anew.
//
// Pictures are cut into tiles (stroke_tiles.h). A stroke that lies in a tile is replaced by strokes in that tile, so
// tiles are worked on in parallel; they are laid elsewhere every time, and strokes that fit into none wait for larger
// ones. Sixteen candidates are tried at once (stroke_kernel.h). Each tile has one fixed order and random numbers of its
// own: same seed, same bits, for any number of threads.
// Frame: board, mm; images as board_grid lays them, row 0 at the top.
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

/// Light per mm of length, summed over pixels, that a scratch of the best direction sends to the view of `renderer`,
/// measured on a lattice of test scratches and interpolated to every pixel; in radiance times pixels per mm. `carve`
/// says what becomes of the test scratches, so that depths and roughnesses that vary over the board, and with them how
/// far the walls reach, are in it.
Image measure_units(ViewRenderer& renderer, const GlintView& glint, const Eigen::Vector2d& min_mm,
                    const Eigen::Vector2d& max_mm, const std::function<Carved(const Scratches&)>& carve = in_metal);

/// Places up to `count` strokes, shared among the views so that the last ones gain about as much everywhere; fewer when
/// no candidate in many tries gains anything, or once `stop` (asked now and then) says so. Adds their light to `views`.
std::vector<Stroke> place_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, std::size_t count,
                                  std::uint64_t seed, const std::function<bool()>& stop = {});

/// One sweep over the first `movable` scratches, or a part of it once `stop` says so (as above). `views` must show them
/// all; it follows the changes. Returns the scratches that were changed, ascending.
std::vector<std::size_t> improve_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, Scratches& scratches,
                                         std::size_t movable, std::uint64_t seed,
                                         const std::function<bool()>& stop = {});

/// Squared error of the shown pictures, of one view (with its asides) or of all (a picture that several share counts
/// once): what gains and worths are parts of.
double squared_error(const StrokeView& view);
double squared_error(const std::vector<StrokeView>& views);

/// By how much the squared error would grow without each scratch in the view it is meant for; negative: it does harm.
std::vector<double> worth_of(std::vector<StrokeView> views, const StrokeRules& rules, const Scratches& scratches);

/// The order in which the first `movable` scratches are best spared: each time the one whose worth, without those that
/// went before, is least for what it costs (`cost`: one each, above 0, or empty: all alike). `spare(scratch, worth)` is
/// asked before each; false ends the order before it.
std::vector<std::size_t> spare_order(std::vector<StrokeView> views, const StrokeRules& rules,
                                     const Scratches& scratches, std::size_t movable, const std::vector<double>& cost,
                                     const std::function<bool(std::size_t, double)>& spare);

/// Takes the light of these scratches out of the views they are meant for, or adds it there.
void lift_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                  const std::vector<std::size_t>& which);
void add_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                 const std::vector<std::size_t>& which);

}  // namespace burin
