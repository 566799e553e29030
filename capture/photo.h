// burin/capture/photo.h - one photo as linear values, and a merged bracket. Pixels are those of the sensor: EXIF
// orientation is never applied. Pixel centers are at whole numbers (docs/model.md 1). Values: 1 is the white level
// (docs/model.md 5). A merged view is divided by the exposure, so all views of a session share one scale.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "burin/base/image.h"
#include "burin/capture/linear_photo.h"
#include "burin/capture/noise.h"
#include "burin/capture/session.h"
#include "burin/scene/footprint_grid.h"

namespace burin {

/// Reads PNG, TIFF, JPEG, EXR and raw files. `photo.encoding` defines the conversion to linear values. Raw files become
/// linear without tone curve, white balance or color matrix. Their black level is removed and the color filter array is
/// filled in linearly. 12-bit data in the high end of 16 clips at its own top. An alpha channel is ignored. Throws
/// Error for a missing, broken or truncated file, and for an unknown kind.
LinearPhoto read_photo(const Photo& photo);

/// One view under one lamp: all its exposures in one picture.
struct MergedView {
  std::string view, light;
  /// Linear value / exposure_factor: gain * vignette * radiance. Same scale for all views: never rescaled.
  Image value;
  Image sigma;                      ///< standard deviation of the noise of each value; infinite where not valid
  std::vector<std::uint8_t> valid;  ///< 0 where no exposure holds the pixel (clipped in all of them)
  int bin = 1;  ///< bin x bin pixels of the photo were averaged into one (rests at its edges dropped)
  /// Top-left pixel of the images in the whole (binned) photo; not 0, 0 for a cropped() view.
  int x0 = 0, y0 = 0;
  /// coarse_for_glare() of the whole photo's channel mean, for a cropped() view. Empty: the images are whole.
  Image whole{};
};

/// Mean of the channels, 0 where it is not finite.
Image mean_of_channels(const Image& image);

/// The part of a merged view inside a window of the whole (binned) photo, with a coarse copy of the whole for glare. A
/// photo shows far more than the board, and the whole in color takes 25 bytes per pixel.
MergedView cropped(MergedView whole, const PixelWindow& window);

/// The image for tag detection: the mean of a view's channels at the photo's full size.
struct GrayView {
  Image value;  ///< one channel, linear value / exposure_factor
  std::vector<std::uint8_t> valid;
};

/// Options of merge_bracket().
struct MergeOptions {
  int bin = 1;               ///< a binned pixel is valid if all its parts are; those that measured green alone count
  GrayView* gray = nullptr;  ///< filled if given: tag detection needs every pixel, but no color and no sigma
};

/// Merges the exposures of one view and lamp. Each exposure is weighted by its inverse variance under `noise`. The
/// variance uses the pixel's longest valid exposure, then the merged value. So a pixel's own noise hardly changes its
/// weights. Pixels within two of a clipped one also come from shorter exposures: sensors bloom and JPEG rings there. If
/// no exposure is left, `value` is the shortest exposure's, a lower bound. With known green sites (Photo::green_sites),
/// `value` rests on these (keep_green_sites()). `gray` does not: demosaicing loses light of glints but not of paper's
/// edges, and corners need every pixel. Throws Error when sizes or channels differ, or when no photo is given.
MergedView merge_bracket(std::span<const Photo> photos, const NoiseModel& noise, const MergeOptions& options = {});

/// Merges with the noise of these photos alone (estimate_noise).
MergedView merge_bracket(std::span<const Photo> photos);

/// Estimates the noise of photos like these. It uses differences between the exposures of a bracket. With one exposure
/// per view, it uses differences between neighboring pixels (see noise.h). At most four brackets are read.
NoiseModel estimate_noise(std::span<const Photo> photos);

/// Photos of one view under one light, in order of first appearance; indices into session.photos.
struct Bracket {
  std::string view, light;
  std::vector<int> photos;
};
std::vector<Bracket> brackets_of(const Session& session);

/// The size of a session's photos, from their headers. Throws Error, naming two photos, when sizes differ.
struct PhotoSize {
  int width = 0, height = 0;
};
PhotoSize photo_size(const Session& session);

/// The noise model of each bracket: one for all photos of one encoding and ISO. A mixed bracket uses its first photo's.
std::vector<NoiseModel> session_noise(const Session& session, std::span<const Bracket> brackets);

/// Merges brackets one by one and passes each to `work`, from several threads at once if the photos are small. Memory
/// holds the results of `work` and a few photos. `work` must not depend on the order.
using MergedWork = std::function<void(std::size_t bracket, MergedView&& view, GrayView&& gray)>;
void for_each_merged(const Session& session, std::span<const Bracket> brackets, std::span<const NoiseModel> noise,
                     int bin, const MergedWork& work);

/// Merges all (view, light) pairs of a session in order of first appearance, each with the noise of its encoding and
/// ISO. Runs in parallel; the same files give the same bits for any number of threads. `kept` chooses the part in
/// memory, such as a cropped() one. Throws Error when photo sizes differ.
using KeptPart = std::function<MergedView(MergedView&&)>;
std::vector<MergedView> merge_session(const Session& session, int bin = 1, const KeptPart& kept = {});

}  // namespace burin
