// burin/calib/predicted_photo.h - the photo that a bench should give of a carved board. docs/model.md 5.1 to 5.8.
// Pixels: the center of the top-left pixel is (0, 0).
#pragma once

#include "burin/base/image.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/footprint_grid.h"
#include "burin/scene/sensor.h"

namespace burin {

/// Which photo is predicted, and how its values are kept.
struct PredictedPhotoOptions {
  int channels = 1;  ///< 1: the mean of R, G, B; 3: R, G, B
  /// The part of the photo that is wanted; width 0: all of it.
  PixelWindow window{0, 0, 0, 0};
  /// exposure_factor() of the photo. Values above 1 are those that a sensor clips.
  double exposure_factor = 1;
  bool clipped = false;                  ///< to 0..1, as a sensor does
  Encoding encoding = Encoding::linear;  ///< of the values returned; anything but linear is clipped
};

/// What the metal of a carved board shows in a photo: carved grooves rendered, blurred by the lens, its own light
/// scattered by glare, exposed, darkened towards the corners, encoded; no noise. `light` is the one lamp that is lit.
/// Tags and what lies beside the board stay 0. Throws Error for scenes that cannot be rendered.
Image predicted_photo(const Bench& bench, const Board& board, const View& view, const Light& light,
                      const Carved& carved, const PredictedPhotoOptions& options = {});

/// The window that holds the carve area in that view, with a margin. Width or height 0 if it lies outside the photo.
PixelWindow carve_window(const Bench& bench, const Board& board, const View& view);

}  // namespace burin
