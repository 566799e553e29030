#include "burin/render/glare.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace burin {
namespace {

// The part of K within `near_px` of its middle and the rest, by the integral of 2 pi r / (r^2 + c^2).
double part_within(const Glare& glare, double r) {
  const double c2 = glare.core_px * glare.core_px;
  return std::log1p(r * r / c2) / std::log1p(glare.reach_px * glare.reach_px / c2);
}

// K on a grid of square cells, each the mean over 5 x 5 points of it: near the middle K changes within a cell.
cv::Mat kernel_of(const Glare& glare, double cell_px, double from_px) {
  const int radius = std::max(1, static_cast<int>(std::ceil(glare.reach_px / cell_px)));
  cv::Mat kernel(2 * radius + 1, 2 * radius + 1, CV_32F);
  double sum = 0;
  constexpr int kPoints = 5;
  for (int j = -radius; j <= radius; ++j)
    for (int i = -radius; i <= radius; ++i) {
      double v = 0;
      for (int b = 0; b < kPoints; ++b)
        for (int a = 0; a < kPoints; ++a) {
          const double x = cell_px * (i + (a + 0.5) / kPoints - 0.5), y = cell_px * (j + (b + 0.5) / kPoints - 0.5);
          const double r2 = x * x + y * y;
          if (r2 <= glare.reach_px * glare.reach_px && r2 > from_px * from_px)
            v += 1 / (r2 + glare.core_px * glare.core_px);
        }
      kernel.at<float>(j + radius, i + radius) = static_cast<float>(v);
      sum += v;
    }
  if (sum > 0) kernel *= 1 / sum;
  return kernel;
}

cv::Mat filtered(const cv::Mat& in, const cv::Mat& kernel) {
  cv::Mat out;
  cv::filter2D(in, out, CV_32F, kernel, cv::Point(-1, -1), 0, cv::BORDER_REPLICATE);
  return out;
}

}  // namespace

Image glare_of(const Image& seen, const Glare& glare, double pixel_px) {
  Image out(seen.width, seen.height, 1);
  const cv::Mat in(seen.height, seen.width, CV_32F, const_cast<float*>(seen.data.data()));
  cv::Mat result(out.height, out.width, CV_32F, out.data.data());
  // What lies near is taken as it is; what lies far, from cells that are an eighth of the nearest distance wide.
  constexpr double kNearCells = 12;
  const double near_px = kNearCells * pixel_px;
  if (near_px >= glare.reach_px) {
    filtered(in, kernel_of(glare, pixel_px, -1)).copyTo(result);
    return out;
  }
  Glare inner = glare;
  inner.reach_px = near_px;
  const double inner_part = part_within(glare, near_px);
  constexpr int kShrink = 4;
  const int w = (seen.width + kShrink - 1) / kShrink, h = (seen.height + kShrink - 1) / kShrink;
  // Whole cells: the rim is filled as it ends.
  cv::Mat padded, small, far;
  cv::copyMakeBorder(in, padded, 0, h * kShrink - seen.height, 0, w * kShrink - seen.width, cv::BORDER_REPLICATE);
  cv::resize(padded, small, cv::Size(w, h), 0, 0, cv::INTER_AREA);
  far = filtered(small, kernel_of(glare, pixel_px * kShrink, near_px));
  cv::resize(far, padded, padded.size(), 0, 0, cv::INTER_LINEAR);
  const cv::Mat near = filtered(in, kernel_of(inner, pixel_px, -1));
  result = inner_part * near + (1 - inner_part) * padded(cv::Rect(0, 0, seen.width, seen.height));
  return out;
}

}  // namespace burin
