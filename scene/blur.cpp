#include "burin/scene/blur.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace burin {

std::vector<float> blur_taps(double psf_sigma_px, int bin) {
  const double sigma = psf_sigma_px / bin;
  if (!(sigma > 0)) return {};
  if (bin > 1 && sigma < 0.5) {
    const float side = static_cast<float>(0.5 * sigma * sigma);
    return {side, 1 - 2 * side, side};
  }
  const int radius = std::max(1, static_cast<int>(std::ceil(4 * sigma)));
  std::vector<float> taps(2 * radius + 1);
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) sum += std::exp(-0.5 * i * i / (sigma * sigma));
  for (int i = -radius; i <= radius; ++i)
    taps[i + radius] = static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)) / sum);
  return taps;
}

namespace {

void add_weighed(const float* from, float weight, float* to, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) to[i] += weight * from[i];
}

}  // namespace

Image blurred(const Image& image, const std::vector<float>& taps) {
  if (taps.empty()) return image;
  const std::size_t channels = static_cast<std::size_t>(image.channels), radius = taps.size() / 2;
  const std::size_t row = channels * static_cast<std::size_t>(image.width);
  Image wide(image.width, image.height, image.channels), out = wide;
  tbb::parallel_for(0, image.height, [&](int y) {
    std::vector<float> padded(row + 2 * radius * channels);
    const float* const from = image.data.data() + static_cast<std::size_t>(y) * row;
    for (std::size_t i = 0; i < radius * channels; ++i) {
      padded[i] = from[i % channels];
      padded[radius * channels + row + i] = from[row - channels + i % channels];
    }
    std::copy_n(from, row, padded.begin() + static_cast<std::ptrdiff_t>(radius * channels));
    float* const to = wide.data.data() + static_cast<std::size_t>(y) * row;
    for (std::size_t t = 0; t < taps.size(); ++t) add_weighed(padded.data() + t * channels, taps[t], to, row);
  });
  tbb::parallel_for(0, image.height, [&](int y) {
    float* const to = out.data.data() + static_cast<std::size_t>(y) * row;
    for (std::size_t t = 0; t < taps.size(); ++t) {
      const int at = std::clamp(y + static_cast<int>(t) - static_cast<int>(radius), 0, image.height - 1);
      add_weighed(wide.data.data() + static_cast<std::size_t>(at) * row, taps[t], to, row);
    }
  });
  return out;
}

Image blurred(const Image& image, double psf_sigma_px) { return blurred(image, blur_taps(psf_sigma_px)); }

}  // namespace burin
