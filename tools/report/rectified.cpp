#include "tools/report/rectified.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "burin/base/median.h"

namespace burin {
namespace {

constexpr int kSamplesPerSide = 2;

float bilinear(const Image& image, double x, double y, int channel) {
  const int c0 = static_cast<int>(std::floor(x)), r0 = static_cast<int>(std::floor(y));
  if (!(c0 >= 0 && r0 >= 0 && c0 + 1 < image.width && r0 + 1 < image.height))
    return std::numeric_limits<float>::quiet_NaN();
  const auto fx = static_cast<float>(x - c0), fy = static_cast<float>(y - r0);
  const float a = image.at(c0, r0, channel), b = image.at(c0 + 1, r0, channel);
  const float c = image.at(c0, r0 + 1, channel), d = image.at(c0 + 1, r0 + 1, channel);
  if (std::isinf(a) || std::isinf(b) || std::isinf(c) || std::isinf(d)) return std::numeric_limits<float>::infinity();
  return (1 - fy) * ((1 - fx) * a + fx * b) + fy * ((1 - fx) * c + fx * d);
}

}  // namespace

BoardFrame board_frame(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int long_side_px) {
  const Eigen::Vector2d size = max_mm - min_mm;
  const double px_per_mm = long_side_px / size.maxCoeff();
  return {min_mm, max_mm, std::max(1, static_cast<int>(std::lround(size.x() * px_per_mm))),
          std::max(1, static_cast<int>(std::lround(size.y() * px_per_mm)))};
}

Image rectified(const Image& photo, int x0, int y0, const Lens& lens, const Eigen::Isometry3d& T_camera_board,
                const Surface& surface, const BoardFrame& frame) {
  constexpr int kSamples = kSamplesPerSide * kSamplesPerSide;
  const Eigen::Vector2d size = frame.max_mm - frame.min_mm;
  std::vector<Eigen::Vector3d> p_camera;
  p_camera.reserve(static_cast<std::size_t>(frame.width) * frame.height * kSamples);
  for (int r = 0; r < frame.height; ++r)
    for (int c = 0; c < frame.width; ++c)
      for (int s = 0; s < kSamples; ++s) {
        const int column = s % kSamplesPerSide, row = s / kSamplesPerSide;
        const double u = (c + (column + 0.5) / kSamplesPerSide) / frame.width;
        const double v = (r + (row + 0.5) / kSamplesPerSide) / frame.height;
        const double x = frame.min_mm.x() + u * size.x(), y = frame.max_mm.y() - v * size.y();
        p_camera.push_back(T_camera_board * face_point(surface, x, y));
      }
  std::vector<Eigen::Vector2d> q_px(p_camera.size());
  project(lens, p_camera, q_px);

  Image out(frame.width, frame.height, photo.channels);
  std::size_t sample = 0;
  for (int r = 0; r < frame.height; ++r)
    for (int c = 0; c < frame.width; ++c, sample += kSamples)
      for (int channel = 0; channel < photo.channels; ++channel) {
        float sum = 0;
        for (int s = 0; s < kSamples; ++s) {
          const bool in_front = p_camera[sample + s].z() > 0;
          sum += in_front ? bilinear(photo, q_px[sample + s].x() - x0, q_px[sample + s].y() - y0, channel)
                          : std::numeric_limits<float>::quiet_NaN();
        }
        out.at(c, r, channel) = sum / kSamples;
      }
  return out;
}

float percentile(const Image& image, double fraction) {
  std::vector<float> values;
  values.reserve(image.data.size());
  std::copy_if(image.data.begin(), image.data.end(), std::back_inserter(values),
               [](float v) { return std::isfinite(v); });
  if (values.empty()) return 0;
  return quantile_in_place(values, fraction);
}

Image shown(const Image& linear, float white) {
  Image out = linear;
  for (float& v : out.data) v = v > 0 && white > 0 ? std::pow(std::min(1.0F, v / white), 1 / 2.2F) : 0.0F;
  return out;
}

Image difference_shown(const Image& photo, const Image& predicted, float white, float full_scale) {
  constexpr float kMissing = 0.6F;
  Image out(photo.width, photo.height, 3, kMissing);
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      float d = 0;
      for (int c = 0; c < photo.channels; ++c)
        d += (photo.at(x, y, c) - predicted.at(x, y, std::min(c, predicted.channels - 1))) / photo.channels;
      if (!std::isfinite(d) || !(white > 0)) continue;
      const float t = std::clamp(d / (white * full_scale), -1.0F, 1.0F);
      const float fade = 1 - std::abs(t);
      out.at(x, y, 0) = t > 0 ? 1 - 0.25F * t : fade;
      out.at(x, y, 1) = fade;
      out.at(x, y, 2) = t < 0 ? 1 + 0.25F * t : fade;
    }
  return out;
}

}  // namespace burin
