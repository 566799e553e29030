// burin/optimize/design/stroke_kernel.h - the search's inner loop: sixteen strokes at a time, each through a point in a
// direction, each given the ends with which it lowers its view's squared error most.
//
// A lane is a stroke; its operations do not depend on the other lanes, nor on how many of them a packet holds, and
// there are no fused multiply-adds: every width comes to the same bits. One width is chosen at run time
// (burin/base/simd_width.h). What is summed, and why the ends are the best ones: stroke_search.h, docs/model.md 6.5.
// Frames: board in mm; pixels of the picture, y down, counted from the window's corner.
#pragma once

#include <cstdint>

#include "burin/base/simd_width.h"

namespace burin {

inline constexpr int kStrokeLanes = 16;  ///< strokes tried at once
inline constexpr int kMostPlaces = 9;    ///< from which a view's errors count: three channels, each from three places
/// The most pixels that a window reaches over in memory, from its first to its last: they are counted in floats.
inline constexpr int kMostWindowPixels = 1 << 24;

/// What the search knows of a pixel as seen from one place.
struct alignas(16) StrokePixel {
  float light = 0;   ///< of white
  float unit = 0;    ///< added by a scratch of the best direction along one pixel's length
  float target = 0;  ///< gamma-encoded
  float shown = 0;   ///< shown_light(light)
};

/// Along the half vector at a pixel's middle, in the frame of the face.
struct alignas(16) StrokeHalfVector {
  float x = 0, y = 0, z = 1, unused = 0;
};

/// Where eye and lamp may stand, and what is seen from there.
struct StrokePlace {
  const StrokePixel* pixels = nullptr;  ///< of the window's corner
  float weight = 1;                     ///< of its errors
  const float* matters = nullptr;       ///< as StrokeWindow::matters, which is null then; where places differ
  float camera_mm[3] = {}, lamp_mm[3] = {};
  /// Where the face is curved, or it is not one lamp that shines: of the picture's first pixel. Null: eye and lamp say.
  const StrokeHalfVector* half_vectors = nullptr;
};

/// A window of a view. The first place is the one that eye and lamp are meant to be in.
struct StrokeWindow {
  StrokePlace place[kMostPlaces];
  int places = 1;
  const float* matters = nullptr;  ///< of the window's corner: the mask squared; null: all pixels count alike
  /// Of the window's corner: what a pixel of length costs of the gain, whatever light it brings. Null: nothing.
  const float* cost = nullptr;
  int stride = 0;                 ///< pixels from one row to the next
  int width = 0, height = 0;      ///< stride * height <= kMostWindowPixels
  int column = 0, row = 0;        ///< of the window's corner in the picture
  int picture_height = 0;         ///< `stride` is its width
  float left_mm = 0, top_mm = 0;  ///< the window's corner on the board
  float pitch_x_mm = 1, pitch_y_mm = 1;
  float shortest = 0, longest = 0;  ///< of a stroke, in pixels
  float dimmest = 0;                ///< least part of the lobe that a stroke is turned to
};

/// Points, and how a stroke through each is to be turned. Either as the stroke (old_x, old_y) was, brighter or dimmer,
/// or
/// - where `anywhere` is not 0 - so that it brings `brighter` times the light that its pixel lacks.
struct StrokeTries {
  float x[kStrokeLanes], y[kStrokeLanes];  ///< within the window
  float old_x = 1, old_y = 0;              ///< direction on the board, mm, of length 1
  /// On (1 + q^2), q = h . u / alpha, that of the old stroke: its lobe is that to the power -3/2. Or on the light.
  float brighter[kStrokeLanes];
  float anywhere[kStrokeLanes];
  float side[kStrokeLanes];  ///< to which it is turned, 1 or -1; of the old stroke's side, or of any
  float alpha[kStrokeLanes];
  int count = kStrokeLanes;
};

/// The best stroke of each try, from x + behind * (ux, uy) to x + ahead * (ux, uy). gain 0: there is none that is long
/// enough.
struct StrokesFound {
  float ux[kStrokeLanes], uy[kStrokeLanes];  ///< in pixels, y down, of length 1
  float behind[kStrokeLanes], ahead[kStrokeLanes];
  float gain[kStrokeLanes];
};

using TryStrokes = void (*)(const StrokeWindow& window, const StrokeTries& tries, StrokesFound& found);

/// The kernel of one width. Throws Error for a width that does not run here.
TryStrokes try_strokes(SimdWidth width = SimdWidth::best);

}  // namespace burin
