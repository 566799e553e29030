#include "burin/optimize/loss/color_metrics.h"

#include <algorithm>
#include <cmath>

#include "burin/base/error.h"
#include "burin/optimize/loss/picture_metrics.h"

namespace burin {
namespace {

// The mask, repeated for each channel.
Image mask_below(const Image& mask, int channels) {
  if (mask.data.empty()) return {};
  if (channels == 1) return mask;
  return channels_below(in_color(mask, mask, mask));
}

}  // namespace

Image channel_of(const Image& picture, int channel) {
  Image out(picture.width, picture.height, 1);
  for (std::size_t i = 0; i < out.data.size(); ++i)
    out.data[i] = picture.data[i * static_cast<std::size_t>(picture.channels) + static_cast<std::size_t>(channel)];
  return out;
}

Image in_color(const Image& red, const Image& green, const Image& blue) {
  const std::array<const Image*, 3> from{&red, &green, &blue};
  for (const Image* one : from)
    if (one->width != red.width || one->height != red.height || one->channels != 1)
      fail("color", "the channels differ in size", "give three of one size");
  Image out(red.width, red.height, 3);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < red.data.size(); ++i) out.data[3 * i + c] = from[c]->data[i];
  return out;
}

Image channels_below(const Image& picture) {
  if (picture.channels == 1) return picture;
  Image out(picture.width, picture.height * picture.channels, 1);
  auto next = out.data.begin();
  for (int c = 0; c < picture.channels; ++c) {
    const Image one = channel_of(picture, c);
    next = std::copy(one.data.begin(), one.data.end(), next);
  }
  return out;
}

Image shown_luminance(const Image& picture) {
  if (picture.channels == 1) return picture;
  Image light = picture;
  for (float& v : light.data) v = std::pow(std::max(0.0F, v), 2.2F);
  Image out = luminance(light);
  for (float& v : out.data) v = std::pow(v, 1 / 2.2F);
  return out;
}

double color_psnr_db(const Image& picture, const Image& target, const Image& mask) {
  if (picture.channels == 1) return psnr_db(picture, target, mask);  // avoids copies
  return psnr_db(channels_below(picture), channels_below(target), mask_below(mask, picture.channels));
}

double color_ssim(const Image& picture, const Image& target, const Image& mask) {
  if (picture.channels == 1) return ssim(picture, target, mask);
  double sum = 0;
  for (int c = 0; c < picture.channels; ++c) sum += ssim(channel_of(picture, c), channel_of(target, c), mask);
  return sum / picture.channels;
}

double color_best_exposure(const Image& radiance, const Image& target, double guess, const Image& mask) {
  if (radiance.channels == 1) return best_exposure(radiance, target, guess, mask);
  return best_exposure(channels_below(radiance), channels_below(target), guess, mask_below(mask, radiance.channels));
}

ColorQuality color_quality(const Image& picture, const Image& target, const Image& mask) {
  ColorQuality out;
  for (int c = 0; c < 3; ++c)
    out.channel_psnr_db[static_cast<std::size_t>(c)] = psnr_db(channel_of(picture, c), channel_of(target, c), mask);
  out.luminance_psnr_db = psnr_db(shown_luminance(picture), shown_luminance(target), mask);
  return out;
}

}  // namespace burin
