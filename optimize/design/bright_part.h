// burin/optimize/design/bright_part.h - in each view most of a design's scratches hardly show: they are made for the
// others, and send it a thousandth of their light. What they add together changes little from one iteration to the
// next, so it is rendered now and then, and in between held; what is bright is rendered, and differentiated, every
// time. With N views that is a N-th of the work. docs/model.md 6.5, docs/design.md. Frame: board, mm.
#pragma once

#include <cstddef>
#include <vector>

#include "burin/base/image.h"
#include "burin/optimize/design/design_views.h"
#include "burin/optimize/design/to_metal.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/scratch_gradients.h"

namespace burin {

inline constexpr int kOthersEvery = 16;  ///< iterations from one look at what hardly shows to the next

/// One view's bright grooves, and the light of all others.
struct BrightPart {
  bool apart = false;             ///< whether the two are told apart; if not, all grooves are bright
  std::vector<std::size_t> rows;  ///< of the grooves in the metal, ascending
  Carved grooves;                 ///< those, or what others leave of them
  Image others;                   ///< radiance that all other grooves add to these, as last seen; no pixels: not yet
  ScratchGradients gradients;     ///< by `grooves`
};

/// Whether each groove sends its light from one line along it: all lights of the view are point lamps, and the board is
/// flat.
bool glints_along_lines(const WorkView& view, const Bench& bench);

/// Whether a view's bright grooves can be told by its half vectors and held apart: all its lights are point lamps, the
/// board is flat, and what a groove takes of the face's light is less than a twentieth of what it sends when it is
/// turned to the view.
bool bright_part_shows(const WorkView& view, const Bench& bench, const Board& board);

/// Rows of grooves that send a view at least a two-hundredth of the light that they would if they were turned to it
/// (lobe() at their middles, for the lamp for which it is most). Where no light of the view is a lamp: none.
std::vector<std::size_t> bright_rows(const WorkView& view, const Bench& bench, const Scratches& grooves);

/// Renders a view into its radiance: the bright grooves alone, and what the others added when last seen, or now if they
/// were not. With derivatives, view_backward() may follow.
void render_view(WorkView& view, BrightPart& part, const Bench& bench, const LyingGrooves& grooves, bool with_jacobian);

/// Adds the gradient of a loss by the view's radiance to that of the whole grooves, those that are not bright feeling
/// nothing of it. `metal`: where they lie, without fields.
void view_backward(const WorkView& view, BrightPart& part, const Metal& metal, const LyingGrooves& grooves,
                   const Image& dE_dradiance, ScratchGradients& by_whole);

}  // namespace burin
