#include "burin/scene/blur.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

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

Image blurred(const Image& image, const std::vector<float>& taps) {
  if (taps.empty()) return image;
  // OpenCV's headers want pointers to data that they do not change.
  const cv::Mat in(image.height, image.width, CV_32FC(image.channels), const_cast<float*>(image.data.data()));
  const cv::Mat kernel(static_cast<int>(taps.size()), 1, CV_32F, const_cast<float*>(taps.data()));
  Image out(image.width, image.height, image.channels);
  cv::Mat result(out.height, out.width, CV_32FC(out.channels), out.data.data());
  cv::sepFilter2D(in, result, CV_32F, kernel, kernel, cv::Point(-1, -1), 0, cv::BORDER_REPLICATE);
  return out;
}

Image blurred(const Image& image, double psf_sigma_px) { return blurred(image, blur_taps(psf_sigma_px)); }

}  // namespace burin
