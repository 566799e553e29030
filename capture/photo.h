// capture/photo.h - one photo as linear values, and a bracket of them merged.
// Pixels are those of the sensor: EXIF orientation is never applied.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "capture/session.h"
#include "render/image.h"

namespace burin {

/// A photo, linear, 1 being the white level; 1 or 3 channels.
struct LinearPhoto {
  Image value;
  std::vector<std::uint8_t> clipped;  ///< width * height: 1 where any channel is at (or near) the white level or unusable
};

/// Reads PNG, TIFF, JPEG, EXR and raw files. `photo.encoding` says how stored values become linear.
/// Raw: linear, no tone curve, no white balance, black level removed. 12-bit data in the high end of 16 clips at its own
/// top. Throws Error for a file that is missing, broken, or of an unknown kind.
LinearPhoto read_photo(const Photo& photo);

/// One view under one lamp: all its exposures in one picture.
struct MergedView {
  std::string view, light;
  Image value;  ///< linear value / exposure_factor: gain * vignette * radiance. Same scale for all views: never rescaled.
  Image sigma;  ///< standard deviation of the noise of each value, from photon and read noise and quantisation
  std::vector<std::uint8_t> valid;  ///< 0 where no exposure holds the pixel (clipped in all of them)
};

/// Merges the exposures of one view and lamp, weighting by noise; clipped pixels come from the shorter exposures.
MergedView merge_bracket(std::span<const Photo> photos);

/// All (view, light) pairs of a session in order of first appearance. Throws Error when photo sizes differ.
std::vector<MergedView> merge_session(const Session& session);

}  // namespace burin
