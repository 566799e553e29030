#include "optimize/picture_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "optimize/loss.h"
#include "render/error.h"

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

// Valid part of a separable 11 x 11 Gaussian of sigma 1.5.
std::vector<double> window_means(const std::vector<double>& values, int width, int height) {
  constexpr int kRadius = 5;
  std::array<double, 11> g{};
  double total = 0;
  for (int k = -kRadius; k <= kRadius; ++k) total += g[k + kRadius] = std::exp(-k * k / (2 * 1.5 * 1.5));
  for (double& v : g) v /= total;
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

double ssim(const Image& picture, const Image& target) {
  check_sizes(picture, target);
  if (picture.width < 11 || picture.height < 11)
    fail("ssim", "the pictures are smaller than its window of 11 x 11", "use larger pictures");
  const std::size_t n = picture.data.size();
  std::vector<double> a(picture.data.begin(), picture.data.end()), b(target.data.begin(), target.data.end());
  std::vector<double> aa(n), bb(n), ab(n);
  for (std::size_t i = 0; i < n; ++i) {
    aa[i] = a[i] * a[i];
    bb[i] = b[i] * b[i];
    ab[i] = a[i] * b[i];
  }
  const int w = picture.width, h = picture.height;
  a = window_means(a, w, h);
  b = window_means(b, w, h);
  aa = window_means(aa, w, h);
  bb = window_means(bb, w, h);
  ab = window_means(ab, w, h);
  constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double va = aa[i] - a[i] * a[i], vb = bb[i] - b[i] * b[i], cov = ab[i] - a[i] * b[i];
    sum += (2 * a[i] * b[i] + c1) * (2 * cov + c2) / ((a[i] * a[i] + b[i] * b[i] + c1) * (va + vb + c2));
  }
  return sum / static_cast<double>(a.size());
}

double correlation(const Image& a, const Image& b) {
  check_sizes(a, b);
  const auto n = static_cast<double>(a.data.size());
  double ma = 0, mb = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) {
    ma += a.data[i];
    mb += b.data[i];
  }
  ma /= n;
  mb /= n;
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) {
    const double da = a.data[i] - ma, db = b.data[i] - mb;
    aa += da * da;
    bb += db * db;
    ab += da * db;
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

double best_exposure(const Image& radiance, const Image& target, double guess, const Image& mask) {
  check_sizes(radiance, target);
  const auto error = [&](double log_exposure) {
    return mean_square(shown_picture(radiance, std::exp(log_exposure)), target, mask);
  };
  // A coarse scan (the error may have shoulders where much is clipped), then golden section around its best.
  double best = std::log(guess), least = error(best);
  for (double step = -2.4; step <= 2.41; step += 0.3) {
    const double e = error(std::log(guess) + step);
    if (e < least) {
      least = e;
      best = std::log(guess) + step;
    }
  }
  constexpr double kGolden = 0.6180339887498949;
  double a = best - 0.3, b = best + 0.3;
  double c = b - kGolden * (b - a), d = a + kGolden * (b - a);
  double ec = error(c), ed = error(d);
  for (int i = 0; i < 14; ++i) {
    if (ec < ed) {
      b = d;
      d = c;
      ed = ec;
      c = b - kGolden * (b - a);
      ec = error(c);
    } else {
      a = c;
      c = d;
      ec = ed;
      d = a + kGolden * (b - a);
      ed = error(d);
    }
  }
  return std::exp((a + b) / 2);
}

}  // namespace burin
