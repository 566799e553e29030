#include "burin/capture/photo_look.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <span>
#include <string>
#include <utility>

#include "burin/base/median.h"
#include "burin/capture/noise.h"
#include "burin/capture/photo.h"
#include "burin/capture/tags/tag_detector.h"
#include "burin/capture/tags/tag_look.h"

namespace burin {
namespace {

cv::Mat view_of(Image& image) { return {image.height, image.width, CV_32FC(image.channels), image.data.data()}; }

// At its steepest, a step blurred by a Gaussian of sigma rises by 1 / (sigma sqrt(2 pi)) of its height per pixel. The
// sharpest percent of the strong edges represents the photo: weaker ones may be soft in the scene.
std::optional<double> edge_sigma_px(const cv::Mat& gray, double low, double high) {
  const cv::Mat window = cv::Mat::ones(15, 15, CV_8U);
  cv::Mat top, bottom, dx, dy;
  cv::dilate(gray, top, window);
  cv::erode(gray, bottom, window);
  const cv::Matx13f half(-0.5F, 0, 0.5F);
  cv::filter2D(gray, dx, CV_32F, half);
  cv::filter2D(gray, dy, CV_32F, half.t());
  std::vector<float> steepness;
  for (int y = 8; y < gray.rows - 8; ++y)
    for (int x = 8; x < gray.cols - 8; ++x) {
      const float range = top.at<float>(y, x) - bottom.at<float>(y, x);
      if (range > 0.3 * (high - low)) steepness.push_back(std::hypot(dx.at<float>(y, x), dy.at<float>(y, x)) / range);
    }
  if (steepness.size() < 2000) return std::nullopt;
  return 1 / (quantile_of(std::move(steepness), 0.99) * std::sqrt(2 * std::numbers::pi));
}

std::vector<TagLook> look_for_tags(const Image& gray, std::span<const std::uint8_t> clipped, const TagSet& tags,
                                   std::vector<int>& stray) {
  // A highlight may be far brighter than paper: raise the brightness until every tag is found.
  std::vector<TagDetection> found;
  for (const double brighter : {1., 8., 64.}) {
    std::vector<TagDetection> seen = detector_of_this_thread(tags.family).detect_coarse(gray, brighter);
    std::erase_if(seen, [&](const TagDetection& t) {
      const bool listed = std::any_of(tags.list.begin(), tags.list.end(), [&](const Tag& b) { return b.id == t.id; });
      const bool known = std::any_of(found.begin(), found.end(), [&](const TagDetection& f) {
        return f.id == t.id && (f.coarse_px[0] - t.coarse_px[0]).norm() < (t.coarse_px[1] - t.coarse_px[0]).norm();
      });
      if (!listed && t.hamming == 0) stray.push_back(t.id);
      return t.hamming > 1 || !listed || known;
    });
    found.insert(found.end(), seen.begin(), seen.end());
    if (found.size() >= tags.list.size()) break;
  }
  std::sort(stray.begin(), stray.end());
  stray.erase(std::unique(stray.begin(), stray.end()), stray.end());
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return look_at_tags(found, gray, clipped, tags.family);
}

}  // namespace

std::uint16_t SmallPhoto::code_of(double value) {
  return static_cast<std::uint16_t>(std::lround(kWhite * std::sqrt(std::clamp(value, 0.0, 1.0))));
}

double SmallPhoto::value_of(std::uint16_t code) {
  const double root = static_cast<double>(code) / kWhite;
  return root * root;
}

PhotoLook look_at(const Photo& photo, const TagSet* tags) {
  const LinearPhoto linear = read_photo(photo);
  const Image& value = linear.value;
  Image gray(value.width, value.height, 1);
  std::size_t clipped = 0;
  for (std::size_t i = 0; i < gray.data.size(); ++i) {
    float sum = 0;
    for (int c = 0; c < value.channels; ++c) sum += value.data[i * value.channels + c];
    gray.data[i] = sum / static_cast<float>(value.channels);
    clipped += linear.clipped[i];
  }
  PhotoLook look;
  look.clipped_fraction = static_cast<double>(clipped) / static_cast<double>(gray.data.size());
  look.bright = quantile_of(gray.data, 0.995);
  look.noise_floor = std::max(4 * linear_step(linear.stored, 0), 0.0015);
  const cv::Mat full = view_of(gray);
  // Clipped values would make nearby edges look steep or flat, so sharpness is judged below them.
  look.edge_sigma_px = edge_sigma_px(cv::min(full, 0.9F), quantile_of(gray.data, 0.005), std::min(look.bright, 0.9));

  look.width = value.width;
  look.height = value.height;
  if (tags) look.tags = look_for_tags(gray, linear.clipped, *tags, look.stray_tags);
  look.scale = std::max(1.0, std::max(value.width, value.height) / 800.0);
  const cv::Size size(std::max(1, static_cast<int>(value.width / look.scale)),
                      std::max(1, static_cast<int>(value.height / look.scale)));
  cv::Mat small, mask(value.height, value.width, CV_8U);
  std::transform(linear.clipped.begin(), linear.clipped.end(), mask.begin<std::uint8_t>(),
                 [](std::uint8_t c) { return static_cast<std::uint8_t>(c ? 255 : 0); });
  cv::resize(full, small, size, 0, 0, cv::INTER_AREA);
  cv::Mat small_mask;
  cv::resize(mask, small_mask, size, 0, 0, cv::INTER_AREA);
  look.small = {size.width, size.height, {}};
  look.small.codes.resize(static_cast<std::size_t>(size.width) * size.height);
  std::transform(small.begin<float>(), small.end<float>(), small_mask.begin<std::uint8_t>(), look.small.codes.begin(),
                 [](float v, std::uint8_t clips) { return clips ? SmallPhoto::kClipped : SmallPhoto::code_of(v); });
  return look;
}

std::optional<Comparison> compare(const PhotoLook& a, double factor_a, const PhotoLook& b, double factor_b) {
  if (a.small.width != b.small.width || a.small.height != b.small.height) return std::nullopt;
  constexpr double kLostInTheDark = 0.02;  // of the white level, for a photo's brightest parts: details are noise
  if (std::min(a.bright, b.bright) < kLostInTheDark) return std::nullopt;
  // Both are cut at one common range of radiance, so clipped parts of one are equally flat in the other.
  const double low = std::max(a.noise_floor / factor_a, b.noise_floor / factor_b);
  const double high = 0.9 * std::min(1 / factor_a, 1 / factor_b);
  if (low >= high) return std::nullopt;
  const auto logarithm = [&](const PhotoLook& look, double factor) {
    cv::Mat log(look.small.height, look.small.width, CV_32F);
    std::transform(look.small.codes.begin(), look.small.codes.end(), log.begin<float>(), [&](std::uint16_t code) {
      return static_cast<float>(
          std::log(code == SmallPhoto::kClipped ? high : std::clamp(SmallPhoto::value_of(code) / factor, low, high)));
    });
    return log;
  };
  const cv::Mat log_a = logarithm(a, factor_a), log_b = logarithm(b, factor_b);
  std::vector<float> ratios;
  for (std::size_t i = 0; i < a.small.codes.size(); ++i) {
    const std::uint16_t code_a = a.small.codes[i], code_b = b.small.codes[i];
    if (code_a == SmallPhoto::kClipped || code_b == SmallPhoto::kClipped) continue;
    const double va = SmallPhoto::value_of(code_a) / factor_a, vb = SmallPhoto::value_of(code_b) / factor_b;
    if (va > low && vb > low && va < high && vb < high) ratios.push_back(static_cast<float>(vb / va));
  }
  if (ratios.size() * 20 < a.small.codes.size()) return std::nullopt;

  // Details only: every photo of a board is bright in the middle and dark around.
  const auto details = [](const cv::Mat& log) {
    cv::Mat smooth, detail;
    cv::GaussianBlur(log, smooth, {}, 6);
    detail = log - smooth;
    return detail;
  };
  cv::Mat detail_a = details(log_a), detail_b = details(log_b);
  Comparison result;
  result.correlation =
      detail_a.dot(detail_b) / std::max(std::sqrt(detail_a.dot(detail_a) * detail_b.dot(detail_b)), 1e-12);
  result.ratio = quantile_of(std::move(ratios), 0.5);
  cv::Mat window;
  cv::createHanningWindow(window, detail_a.size(), CV_32F);
  cv::Point2d shift = cv::phaseCorrelate(detail_a, detail_b, window);
  // OpenCV pads to an efficient size of the Fourier transform, and is half a pixel off if that size is odd.
  if (cv::getOptimalDFTSize(detail_a.cols) % 2 == 1) shift.x -= 0.5;
  if (cv::getOptimalDFTSize(detail_a.rows) % 2 == 1) shift.y -= 0.5;
  result.shift_px = std::hypot(shift.x, shift.y) * a.scale;
  return result;
}

}  // namespace burin
