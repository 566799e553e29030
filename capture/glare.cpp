#include "burin/capture/glare.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace burin {
namespace {

constexpr int kShrink = 4;  // pixels of a picture per coarse cell, in both directions

// Share of K within radius `r`, by the integral of 2 pi r / (r^2 + c^2).
double part_within(const Glare& glare, double r) {
  const double c2 = glare.core_px * glare.core_px;
  return std::log1p(r * r / c2) / std::log1p(glare.reach_px * glare.reach_px / c2);
}

// K on a grid of square cells, each the mean over 5 x 5 points: near the middle K changes within a cell.
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

Image coarse_for_glare(const Image& seen) {
  Image out((seen.width + kShrink - 1) / kShrink, (seen.height + kShrink - 1) / kShrink, 1);
  const cv::Mat in(seen.height, seen.width, CV_32F, const_cast<float*>(seen.data.data()));
  // Only whole cells: pixels beyond the edge continue its value.
  cv::Mat padded, coarse(out.height, out.width, CV_32F, out.data.data());
  cv::copyMakeBorder(in, padded, 0, out.height * kShrink - seen.height, 0, out.width * kShrink - seen.width,
                     cv::BORDER_REPLICATE);
  cv::resize(padded, coarse, coarse.size(), 0, 0, cv::INTER_AREA);
  return out;
}

Image glare_of(const Image& part, int x0, int y0, const Image& coarse, const Glare& glare, double pixel_px) {
  Image out(part.width, part.height, 1);
  const cv::Mat in(part.height, part.width, CV_32F, const_cast<float*>(part.data.data()));
  cv::Mat result(out.height, out.width, CV_32F, out.data.data());
  // Near light is computed pixel by pixel. Distant light comes from cells an eighth of the nearest distance wide.
  constexpr double kNearCells = 12;
  const double near_px = kNearCells * pixel_px;
  if (near_px >= glare.reach_px) {
    filtered(in, kernel_of(glare, pixel_px, -1)).copyTo(result);
    return out;
  }
  Glare inner = glare;
  inner.reach_px = near_px;
  const double inner_part = part_within(glare, near_px);
  const cv::Mat small(coarse.height, coarse.width, CV_32F, const_cast<float*>(coarse.data.data()));
  cv::Mat far;
  cv::resize(filtered(small, kernel_of(glare, pixel_px * kShrink, near_px)), far,
             cv::Size(coarse.width * kShrink, coarse.height * kShrink), 0, 0, cv::INTER_LINEAR);
  const cv::Mat near = filtered(in, kernel_of(inner, pixel_px, -1));
  result = inner_part * near + (1 - inner_part) * far(cv::Rect(x0, y0, part.width, part.height));
  return out;
}

Image glare_of(const Image& seen, const Glare& glare, double pixel_px) {
  return glare_of(seen, 0, 0, coarse_for_glare(seen), glare, pixel_px);
}

}  // namespace burin
