#include "burin/optimize/loss/picture_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "burin/base/error.h"
#include "burin/optimize/loss/loss.h"

namespace burin {
namespace {

void check_sizes(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height || a.channels != 1 || b.channels != 1)
    fail("picture metrics", "the pictures differ in size or have several channels", "compare equal sizes, one channel");
}

double mean_square(const Image& a, const Image& b, const Image& mask) {
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) {
    const double m = mask.data.empty() ? 1 : mask.data[i];
    const double d = static_cast<double>(a.data[i]) - b.data[i];
    sum += m * d * d;
    weight += m;
  }
  return weight > 0 ? sum / weight : 0;
}

constexpr int kRadius = 5;                              // of SSIM's window
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;  // its constants for white 1

std::array<double, 2 * kRadius + 1> window() {
  std::array<double, 2 * kRadius + 1> g{};
  double total = 0;
  for (int k = -kRadius; k <= kRadius; ++k) total += g[k + kRadius] = std::exp(-k * k / (2 * 1.5 * 1.5));
  for (double& v : g) v /= total;
  return g;
}

// Valid part of a separable 11 x 11 Gaussian filter of sigma 1.5.
std::vector<double> window_means(const std::vector<double>& values, int width, int height) {
  const std::array<double, 2 * kRadius + 1> g = window();
  const int w = width - 2 * kRadius, h = height - 2 * kRadius;
  std::vector<double> rows(static_cast<std::size_t>(w) * height), out(static_cast<std::size_t>(w) * h);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < w; ++x) {
      double sum = 0;
      for (int k = 0; k < 11; ++k) sum += g[k] * values[static_cast<std::size_t>(y) * width + x + k];
      rows[static_cast<std::size_t>(y) * w + x] = sum;
    }
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      double sum = 0;
      for (int k = 0; k < 11; ++k) sum += g[k] * rows[static_cast<std::size_t>(y + k) * w + x];
      out[static_cast<std::size_t>(y) * w + x] = sum;
    }
  return out;
}

}  // namespace

double psnr_db(const Image& picture, const Image& target, const Image& mask) {
  check_sizes(picture, target);
  const double error = mean_square(picture, target, mask);
  return error > 0 ? std::min(99.0, -10 * std::log10(error)) : 99;
}

double ssim(const Image& picture, const Image& target, const Image& mask) {
  check_sizes(picture, target);
  if (picture.width < 11 || picture.height < 11)
    fail("ssim", "the pictures are smaller than its window of 11 x 11", "use larger pictures");
  const std::size_t n = picture.data.size();
  const int w = picture.width, h = picture.height;
  std::vector<double> a(n), b(n), aa(n), bb(n), ab(n), weight(n, 1.0);
  if (!mask.data.empty()) weight.assign(mask.data.begin(), mask.data.end());
  for (std::size_t i = 0; i < n; ++i) {
    const double m = weight[i], p = picture.data[i], t = target.data[i];
    a[i] = m * p;
    b[i] = m * t;
    aa[i] = m * p * p;
    bb[i] = m * t * t;
    ab[i] = m * p * t;
  }
  for (auto* means : {&a, &b, &aa, &bb, &ab}) *means = window_means(*means, w, h);
  const std::vector<double> share = window_means(weight, w, h);
  double sum = 0, total = 0;
  for (int y = 0; y < h - 2 * kRadius; ++y)
    for (int x = 0; x < w - 2 * kRadius; ++x) {
      const double counts = weight[static_cast<std::size_t>(y + kRadius) * w + x + kRadius];
      if (!(counts > 0)) continue;
      const std::size_t i = static_cast<std::size_t>(y) * (w - 2 * kRadius) + x;
      const double p = a[i] / share[i], t = b[i] / share[i];
      const double vp = aa[i] / share[i] - p * p, vt = bb[i] / share[i] - t * t, cov = ab[i] / share[i] - p * t;
      sum += counts * (2 * p * t + kC1) * (2 * cov + kC2) / ((p * p + t * t + kC1) * (vp + vt + kC2));
      total += counts;
    }
  return total > 0 ? sum / total : 1;
}

double correlation(const Image& a, const Image& b, const Image& mask) {
  check_sizes(a, b);
  const auto weight = [&](std::size_t i) { return mask.data.empty() ? 1.0 : mask.data[i]; };
  double n = 0, ma = 0, mb = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) {
    n += weight(i);
    ma += weight(i) * a.data[i];
    mb += weight(i) * b.data[i];
  }
  if (!(n > 0)) return 0;
  ma /= n;
  mb /= n;
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) {
    const double da = a.data[i] - ma, db = b.data[i] - mb;
    aa += weight(i) * da * da;
    bb += weight(i) * db * db;
    ab += weight(i) * da * db;
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

}  // namespace burin
