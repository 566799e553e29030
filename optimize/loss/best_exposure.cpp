// best_exposure() of picture_metrics.h. An exposure is a factor on light, so its power 1/2.2 is a factor on the shown
// picture. The gamma curve is therefore applied once, not for every exposure.
#include <algorithm>
#include <cmath>

#include "burin/base/error.h"
#include "burin/base/machine_clones.h"
#include "burin/optimize/loss/bands.h"
#include "burin/optimize/loss/lane_sum.h"
#include "burin/optimize/loss/picture_metrics.h"

namespace burin {
namespace {

constexpr float kToShown = 1.0F / 2.2F;

// Squared errors, times the mask, of a row shown `scale` times as bright and clipped at white.
BURIN_MACHINE_CLONES float error_of_row(const float* encoded, const float* target, const float* mask, int n,
                                        float scale) {
  LaneSum sum;
  const auto squared = [&](int i) {
    const float d = std::min(1.0F, scale * encoded[i]) - target[i];
    return d * d;
  };
  if (mask == nullptr)
    sum.add(n, squared);
  else
    sum.add(n, [&](int i) { return mask[i] * squared(i); });
  return sum.total();
}

}  // namespace

double best_exposure(const Image& radiance, const Image& target, double guess, const Image& mask) {
  if (radiance.width != target.width || radiance.height != target.height || radiance.channels != 1 ||
      target.channels != 1)
    fail("picture metrics", "the pictures differ in size or have several channels", "compare equal sizes, one channel");
  const int n = radiance.width;
  const auto row_of = [&](int y) { return static_cast<std::size_t>(y) * n; };
  Image encoded(radiance.width, radiance.height, 1);
  for_bands(radiance.height, [&](int first, int end) {
    for (std::size_t i = row_of(first); i < row_of(end); ++i)
      encoded.data[i] = std::pow(std::max(0.0F, radiance.data[i]), kToShown);
  });
  // The sum for an exposed picture. Its normalization does not affect the minimum.
  const auto error = [&](double log_exposure) {
    const auto scale = static_cast<float>(std::exp(log_exposure / 2.2));
    return sum_over_bands(radiance.height, [&](int first, int end) {
      double sum = 0;
      for (int y = first; y < end; ++y) {
        const std::size_t row = row_of(y);
        sum += static_cast<double>(error_of_row(&encoded.data[row], &target.data[row],
                                                mask.data.empty() ? nullptr : &mask.data[row], n, scale));
      }
      return sum;
    });
  };
  // A coarse scan (clipping can give the error shoulders), then golden section around its minimum.
  double best = std::log(guess), least = error(best);
  for (int i = -8; i <= 8; ++i) {
    const double at = std::log(guess) + 0.3 * i, e = error(at);
    if (e < least) {
      least = e;
      best = at;
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
