#include "burin/simulate/camera_truth.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "burin/base/files/json_file.h"

namespace burin {
namespace {

cv::Mat view_of(const Image& image) {
  return {image.height, image.width, CV_32FC(image.channels), const_cast<float*>(image.data.data())};
}

// Keeps one color per pixel and interpolates the other two.
Image demosaiced(const Image& linear) {
  cv::Mat mosaic(linear.height, linear.width, CV_16U);
  for (int y = 0; y < linear.height; ++y)
    for (int x = 0; x < linear.width; ++x) {
      const int channel = (y % 2) + (x % 2);  // R G / G B
      mosaic.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(std::lround(65535 * linear.at(x, y, channel)));
    }
  cv::Mat bgr;
  cv::cvtColor(mosaic, bgr, cv::COLOR_BayerBG2BGR_EA);  // OpenCV names patterns by their second row
  Image out(linear.width, linear.height, 3);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int c = 0; c < 3; ++c)
        out.at(x, y, c) = static_cast<float>(bgr.at<cv::Vec<std::uint16_t, 3>>(y, x)[2 - c]) / 65535.0F;
  return out;
}

double s_shaped(double v, double contrast, double pivot) {
  if (v <= 0 || v >= 1) return std::clamp(v, 0.0, 1.0);
  const double odds = pivot / (1 - pivot) * std::pow(v * (1 - pivot) / ((1 - v) * pivot), contrast);
  return odds / (1 + odds);
}

}  // namespace

void read_camera_truth(JsonObject& json, CameraTruth& camera) {
  camera.mosaic = json.boolean("mosaic", false);
  camera.white_balance = json.vec3("white_balance", camera.white_balance);
  if (!(camera.white_balance.array() > 0).all())
    json.fail_field("white_balance", "is not positive", "write factors on R, G and B");
  camera.white_balance_jitter = json.number("white_balance_jitter", 0);
  if (camera.white_balance_jitter < 0) json.fail_field("white_balance_jitter", "is negative", "write 0 or more");
  camera.contrast = json.positive("contrast", 1);
  camera.pivot = json.number("pivot", camera.pivot);
  if (!(camera.pivot > 0 && camera.pivot < 1)) json.fail_field("pivot", "is out of range", "write 0 to 1");
  camera.sharpen_amount = json.number("sharpen_amount", 0);
  if (camera.sharpen_amount < 0) json.fail_field("sharpen_amount", "is negative", "write 0 or more");
  camera.sharpen_px = json.positive("sharpen_px", camera.sharpen_px);
}

GlareTruth read_glare_truth(JsonObject json) {
  GlareTruth glare;
  glare.share = json.number("share", 0);
  if (!(glare.share >= 0 && glare.share < 1)) json.fail_field("share", "is out of range", "write 0 to 1");
  glare.core_px = json.positive("core_px", glare.core_px);
  glare.reach_px = json.positive("reach_px", glare.reach_px);
  json.finish();
  return glare;
}

Image with_glare(const Image& radiance, const GlareTruth& glare) {
  if (!(glare.share > 0)) return radiance;
  const int reach = std::max(1, static_cast<int>(std::ceil(glare.reach_px)));
  cv::Mat kernel = cv::Mat::zeros(2 * reach + 1, 2 * reach + 1, CV_32F);
  for (int j = -reach; j <= reach; ++j)
    for (int i = -reach; i <= reach; ++i)
      if (const double r2 = 1.0 * i * i + 1.0 * j * j; r2 <= glare.reach_px * glare.reach_px)
        kernel.at<float>(j + reach, i + reach) = static_cast<float>(1 / (r2 + glare.core_px * glare.core_px));
  kernel *= glare.share / cv::sum(kernel)[0];
  kernel.at<float>(reach, reach) += static_cast<float>(1 - glare.share);
  Image out(radiance.width, radiance.height, radiance.channels);
  cv::Mat result = view_of(out);
  cv::filter2D(view_of(radiance), result, CV_32F, kernel, cv::Point(-1, -1), 0, cv::BORDER_REPLICATE);
  return out;
}

Image developed(const Image& linear, Encoding encoding, const CameraTruth& camera, std::uint64_t seed) {
  std::mt19937_64 random(seed ^ 0x5bd1e995a3c59ac3ULL);
  std::normal_distribution<> normal;
  Image out = camera.mosaic && linear.channels == 3 ? demosaiced(linear) : linear;
  Eigen::Vector3d balance = camera.white_balance;
  for (const int c : {0, 2}) balance[c] *= std::exp(camera.white_balance_jitter * normal(random));
  for (std::size_t i = 0; i < out.data.size(); ++i) {
    const double v = out.channels == 3 ? out.data[i] * balance[static_cast<Eigen::Index>(i % 3)] : out.data[i];
    out.data[i] = encoded(static_cast<float>(std::clamp(v, 0.0, 1.0)), encoding);
    if (camera.contrast != 1) out.data[i] = static_cast<float>(s_shaped(out.data[i], camera.contrast, camera.pivot));
  }
  if (!(camera.sharpen_amount > 0)) return out;
  const int n = out.channels;
  cv::Mat brightness(out.height, out.width, CV_32F), smooth;
  for (std::size_t i = 0; i < linear.data.size() / n; ++i) {
    float sum = 0;
    for (int c = 0; c < n; ++c) sum += out.data[i * n + c];
    brightness.at<float>(static_cast<int>(i / out.width), static_cast<int>(i % out.width)) =
        sum / static_cast<float>(n);
  }
  cv::GaussianBlur(brightness, smooth, cv::Size(), camera.sharpen_px, camera.sharpen_px, cv::BORDER_REPLICATE);
  for (std::size_t i = 0; i < out.data.size(); ++i) {
    const int y = static_cast<int>(i / n / out.width), x = static_cast<int>(i / n % out.width);
    const float more =
        static_cast<float>(camera.sharpen_amount) * (brightness.at<float>(y, x) - smooth.at<float>(y, x));
    out.data[i] = std::clamp(out.data[i] + more, 0.0F, 1.0F);
  }
  return out;
}

}  // namespace burin
