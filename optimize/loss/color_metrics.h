// burin/optimize/loss/color_metrics.h - the figures of picture_metrics.h for pictures in gray and in color.
//
// Pictures have one channel or three (R, G, B), are gamma-encoded with white at 1, and have equal sizes (Error
// otherwise). An empty mask means every pixel.
#pragma once

#include <array>

#include "burin/base/image.h"

namespace burin {

/// The names of the channels in messages.
inline constexpr std::array<const char*, 3> kChannelNames{"red", "green", "blue"};

/// One channel of a picture.
Image channel_of(const Image& picture, int channel);

/// Three pictures of one channel and one size as a picture in color.
Image in_color(const Image& red, const Image& green, const Image& blue);

/// Three channels stacked vertically in one: a sum over its pixels is a sum over pixels and channels. A picture of one
/// channel is returned as it is.
Image channels_below(const Image& picture);

/// The luminance (Rec. 709) of a picture's light, encoded alike (gamma 2.2). A picture of one channel is returned as it
/// is.
Image shown_luminance(const Image& picture);

/// psnr_db() with the mean square over all channels.
double color_psnr_db(const Image& picture, const Image& target, const Image& mask = {});

/// ssim(), mean of the channels.
double color_ssim(const Image& picture, const Image& target, const Image& mask = {});

/// best_exposure(), one for all channels.
double color_best_exposure(const Image& radiance, const Image& target, double guess, const Image& mask = {});

/// Quality of a picture in color, per channel and in luminance.
struct ColorQuality {
  std::array<double, 3> channel_psnr_db{};  ///< red, green, blue
  double luminance_psnr_db = 0;
};
/// The quality of a picture with three channels.
ColorQuality color_quality(const Image& picture, const Image& target, const Image& mask = {});

}  // namespace burin
