#include "burin/scene/response.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burin/scene/blur.h"

namespace burin {
namespace {

double logit(double v) { return std::log(v / (1 - v)); }

double unbent_logit(const Response& r, double s) {
  double out = r.offset + (1 + r.slope) * logit(s);
  for (std::size_t k = 0; k < Response::kBumps; ++k)
    if (r.bumps[k] != 0) out += r.bumps[k] * std::sin(static_cast<double>(k + 1) * std::numbers::pi * s);
  return out;
}

}  // namespace

double unbent(const Response& response, double stored) {
  if (response.is_none()) return stored;
  if (stored <= 0) return 0;
  if (stored >= 1) return 1;
  return 1 / (1 + std::exp(-unbent_logit(response, stored)));
}

double bent(const Response& response, double plain) {
  if (response.is_none()) return plain;
  if (plain <= 0) return 0;
  if (plain >= 1) return 1;
  double low = 0, high = 1;
  for (int i = 0; i < 52; ++i) {
    const double middle = (low + high) / 2;
    (unbent(response, middle) < plain ? low : high) = middle;
  }
  return (low + high) / 2;
}

bool is_monotonic(const Response& response) {
  constexpr int kLevels = 255;
  for (int i = 2; i < kLevels; ++i)
    if (!(unbent_logit(response, static_cast<double>(i) / kLevels) >
          unbent_logit(response, static_cast<double>(i - 1) / kLevels)))
      return false;
  return true;
}

Response s_curve(double contrast, double pivot) {
  Response out;
  out.slope = 1 / contrast - 1;
  out.offset = -out.slope * logit(pivot);
  return out;
}

void unsharpened(const Sharpening& sharpening, Image& stored) {
  if (!(sharpening.amount > 0) || !(sharpening.sigma_px > 0)) return;
  const std::vector<float> taps = blur_taps(sharpening.sigma_px);
  const int n = stored.channels;
  Image given(stored.width, stored.height, 1);
  for (std::size_t i = 0; i < given.data.size(); ++i) {
    float sum = 0;
    for (int c = 0; c < n; ++c) sum += stored.data[i * n + c];
    given.data[i] = sum / static_cast<float>(n);
  }
  // s = (given + a G s) / (1 + a): each round reduces the error by the factor a / (1 + a).
  const auto a = static_cast<float>(sharpening.amount);
  const int rounds =
      static_cast<int>(std::ceil(std::log(1e-4) / std::log(sharpening.amount / (1 + sharpening.amount))));
  Image plain = given;
  for (int round = 0; round < std::clamp(rounds, 2, 60); ++round) {
    const Image smooth = blurred(plain, taps);
    for (std::size_t i = 0; i < plain.data.size(); ++i) plain.data[i] = (given.data[i] + a * smooth.data[i]) / (1 + a);
  }
  for (std::size_t i = 0; i < given.data.size(); ++i)
    for (int c = 0; c < n; ++c) {
      float& v = stored.data[i * n + c];
      v = std::clamp(v + plain.data[i] - given.data[i], 0.0F, 1.0F);
    }
}

void keep_green_sites(GreenSites sites, Image& linear) {
  if (sites == GreenSites::unknown) return;
  const int w = linear.width, h = linear.height, n = linear.channels;
  // The loop reads only these sites and changes only others, so rows are independent.
  tbb::parallel_for(0, h, [&](int y) {
    for (int x = measured_green(sites, 0, y) ? 1 : 0; x < w; x += 2)
      for (int c = 0; c < n; ++c) {
        float sum = 0, count = 0;
        const auto add = [&](int xx, int yy) {
          if (xx < 0 || yy < 0 || xx >= w || yy >= h) return;
          sum += linear.at(xx, yy, c);
          ++count;
        };
        add(x - 1, y), add(x + 1, y), add(x, y - 1), add(x, y + 1);
        if (count > 0) linear.at(x, y, c) = sum / count;
      }
  });
}

}  // namespace burin
