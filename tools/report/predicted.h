// tools/report/predicted.h - the photo that a bench should give of a view, in the unit that photos have.
// Pixels: the center of the top-left pixel is (0, 0).
#pragma once

#include "burin/render/bench.h"
#include "burin/render/board.h"
#include "burin/render/footprint_grid.h"
#include "burin/render/image.h"
#include "burin/render/scratches.h"

namespace burin {

/// Linear value over the exposure factor (gain * vignette * radiance, blurred by the lens) of the window's pixels.
/// `carved`: the scratches as they lie on the board, the machine's map applied.
Image predicted_photo(const Bench& bench, const Board& board, const Scratches& carved, const View& view,
                      const Light& light, int channels, const PixelWindow& window);

/// The window that holds the carve area in that view. Width or height 0 if it lies outside the photo.
PixelWindow carve_window(const Bench& bench, const Board& board, const View& view);

}  // namespace burin
