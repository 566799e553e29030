// burin/optimize/design/stroke_kernel.h - the search's inner loop. It takes sixteen points and directions, and finds
// each stroke's ends with the largest decrease of its view's squared error.
//
// A lane is a stroke. Its operations are independent of the other lanes and of the SIMD width, and use no fused
// multiply-adds, so every width gives the same bits. The width is chosen at run time (burin/base/simd_width.h).
// stroke_search.h and docs/model.md 6.5 define the sums and show why these ends are best. Frames: board in mm; pixels
// of the picture, y down, counted from the window's corner.
#pragma once

#include <cstdint>

#include "burin/base/simd_width.h"

namespace burin {

inline constexpr int kStrokeLanes = 16;  ///< strokes per call
inline constexpr int kMostPlaces = 9;  ///< positions with errors that count: three channels, each from three viewpoints
/// The largest number of pixels from a window's first to its last in memory. Floats hold pixel indices.
inline constexpr int kMostWindowPixels = 1 << 24;

/// State of a pixel as seen from one place.
struct alignas(16) StrokePixel {
  float light = 0;   ///< relative to white
  float unit = 0;    ///< added by a scratch of the best direction along one pixel's length
  float target = 0;  ///< gamma-encoded
  float shown = 0;   ///< shown_light(light)
};

/// A direction along the half vector at a pixel's middle, in the frame of the face.
struct alignas(16) StrokeHalfVector {
  float x = 0, y = 0, z = 1, unused = 0;
};

/// A position of eye and lamp, and the picture seen from there.
struct StrokePlace {
  const StrokePixel* pixels = nullptr;  ///< at the window's corner
  float weight = 1;                     ///< of its errors
  const float* matters = nullptr;       ///< replaces StrokeWindow::matters, which is null then, if places differ
  float camera_mm[3] = {}, lamp_mm[3] = {};
  /// Half vectors from the picture's first pixel on, for a curved face or other lights than one lamp. Null: eye and
  /// lamp define them.
  const StrokeHalfVector* half_vectors = nullptr;
};

/// A window of a view. Its first place is the intended position of eye and lamp.
struct StrokeWindow {
  StrokePlace place[kMostPlaces];
  int places = 1;
  const float* matters = nullptr;  ///< the mask squared, at the window's corner; null: all pixels count equally
  /// Reduction of the gain per pixel of length, for any light, at the window's corner. Null: none.
  const float* cost = nullptr;
  int stride = 0;                 ///< pixels from one row to the next
  int width = 0, height = 0;      ///< stride * height <= kMostWindowPixels
  int column = 0, row = 0;        ///< of the window's corner in the picture
  int picture_height = 0;         ///< `stride` is its width
  float left_mm = 0, top_mm = 0;  ///< position of the window's corner on the board
  float pitch_x_mm = 1, pitch_y_mm = 1;
  float shortest = 0, longest = 0;  ///< length of a stroke, in pixels
  float dimmest = 0;                ///< smallest part of the lobe for a turned stroke
};

/// Points, and the direction of the stroke through each. The direction follows the stroke (old_x, old_y), brighter or
/// dimmer. If `anywhere` is not 0, it gives `brighter` times its pixel's missing light.
struct StrokeTries {
  float x[kStrokeLanes], y[kStrokeLanes];  ///< within the window
  float old_x = 1, old_y = 0;              ///< direction on the board, mm, of length 1
  /// Factor on (1 + q^2), q = h . u / alpha, of the old stroke; the power -3/2 of this is its lobe. With `anywhere`:
  /// factor on the light.
  float brighter[kStrokeLanes];
  float anywhere[kStrokeLanes];
  float side[kStrokeLanes];  ///< side of the turn, 1 or -1: relative to the old stroke, or any
  float alpha[kStrokeLanes];
  int count = kStrokeLanes;
};

/// The best stroke of each try, from x + behind * (ux, uy) to x + ahead * (ux, uy). gain 0: no stroke is long enough.
struct StrokesFound {
  float ux[kStrokeLanes], uy[kStrokeLanes];  ///< in pixels, y down, of length 1
  float behind[kStrokeLanes], ahead[kStrokeLanes];
  float gain[kStrokeLanes];
};

using TryStrokes = void (*)(const StrokeWindow& window, const StrokeTries& tries, StrokesFound& found);

/// The kernel of one width. Throws Error for a width that this machine does not support.
TryStrokes try_strokes(SimdWidth width = SimdWidth::best);

}  // namespace burin
