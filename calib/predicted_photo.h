// burin/calib/predicted_photo.h - predicts a bench's photo of a carved board. docs/model.md 5.1 to 5.8. Pixels: the
// center of the top-left pixel is (0, 0).
#pragma once

#include "burin/base/image.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/footprint_grid.h"
#include "burin/scene/sensor.h"

namespace burin {

/// Region and encoding of a predicted photo.
struct PredictedPhotoOptions {
  int channels = 1;  ///< 1: the mean of R, G, B; 3: R, G, B
  /// The requested part of the photo; width 0: all of it.
  PixelWindow window{0, 0, 0, 0};
  /// exposure_factor() of the photo. A sensor clips values above 1.
  double exposure_factor = 1;
  bool clipped = false;                  ///< to 0..1, as a sensor does
  Encoding encoding = Encoding::linear;  ///< of the values returned; anything but linear is clipped
};

/// The metal of a carved board in a photo: grooves rendered, blurred by the lens, scattered by veiling glare, exposed,
/// vignetted and encoded, without noise. `light` is the only lamp. Tags and everything outside the board stay 0. Throws
/// Error for scenes that cannot be rendered.
Image predicted_photo(const Bench& bench, const Board& board, const View& view, const Light& light,
                      const Carved& carved, const PredictedPhotoOptions& options = {});

/// The window of the carve area in this view, with a margin. Width or height is 0 if it is outside the photo.
PixelWindow carve_window(const Bench& bench, const Board& board, const View& view);

}  // namespace burin
