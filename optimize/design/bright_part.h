// burin/optimize/design/bright_part.h - split of a view's grooves into bright and faint ones.
//
// Most scratches of a design are made for other views and send a view about a thousandth of their light. Their sum
// changes little between iterations, so it is rendered now and then, and held in between. Bright grooves are rendered
// and differentiated every time. With N views this is an N-th of the work. docs/model.md 6.5, docs/design.md. Frame:
// board, mm.
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

inline constexpr int kOthersEvery = 16;  ///< iterations between renderings of the faint grooves

/// One view's bright grooves, and the light of all others.
struct BrightPart {
  bool apart = false;             ///< whether bright and faint grooves are separate; if not, all are bright
  std::vector<std::size_t> rows;  ///< of the carved grooves, ascending
  Carved grooves;                 ///< these rows, or their remaining pieces
  Image others;                   ///< additional radiance of all other grooves, as last rendered; no pixels: not yet
  ScratchGradients gradients;     ///< by `grooves`
};

/// Whether each groove sends its light from one line along it: all lights of the view are point lamps, and the board is
/// flat.
bool glints_along_lines(const WorkView& view, const Bench& bench);

/// Whether the view's half vectors can separate its bright grooves. All its lights must be point lamps and the board
/// flat. The covered face light of a groove must be less than a twentieth of the groove's own light in its best
/// direction.
bool bright_part_shows(const WorkView& view, const Bench& bench, const Board& board);

/// Rows of grooves with at least a two-hundredth of their best direction's light in a view (lobe() at their middles,
/// for the lamp with the most). None if no light of the view is a lamp.
std::vector<std::size_t> bright_rows(const WorkView& view, const Bench& bench, const Scratches& grooves);

/// Renders a view into its radiance: the bright grooves, plus the held light of the others. The others are rendered too
/// if they were not yet. With derivatives, view_backward() may follow.
void render_view(WorkView& view, BrightPart& part, const Bench& bench, const LyingGrooves& grooves, bool with_jacobian);

/// A view's radiance with the whole grooves, none of them cut: the bright ones, plus the held light of the others.
Image uncut_radiance(WorkView& view, const BrightPart& part, const Bench& bench, const Carved& whole);

/// Backward pass: adds the gradient of a loss by the view's radiance to the gradient of the whole grooves. Faint
/// grooves get none. `metal`: their bench without fields, and their board.
void view_backward(const WorkView& view, BrightPart& part, const Metal& metal, const LyingGrooves& grooves,
                   const Image& dE_dradiance, ScratchGradients& by_whole);

}  // namespace burin
