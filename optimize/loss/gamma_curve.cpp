// The gamma curve of burin/optimize/loss/loss.h and its derivative, one row at a time in SIMD vectors of floats.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "burin/base/machine_clones.h"
#include "burin/optimize/loss/bands.h"
#include "burin/optimize/loss/lane_sum.h"
#include "burin/optimize/loss/loss.h"

namespace burin {
namespace {

constexpr float kInverseGamma = 1.0F / 2.2F;
constexpr auto kOffset = static_cast<float>(kGammaOffset);

/// c0 + c1 x + c2 x^2 + ...
BURIN_INLINED float horner(float, float c0) { return c0; }
template <typename... Rest>
BURIN_INLINED float horner(float x, float c0, Rest... rest) {
  return c0 + x * horner(x, rest...);
}

/// v^(1/2.2) for a normal number above 0, to a relative error of 2e-7: 2^(log2(v) / 2.2). The integer part of the
/// logarithm is separate, because rounding its float sum with the fraction would cost as much. Both polynomials are
/// minimax (Remez). log2(1 + m) / m between sqrt(1/2) and sqrt(2) has an error of at most 3.8e-8; 2^f for |f| <= 1/2
/// has 1.9e-9.
BURIN_INLINED float encoded(float v) {
  constexpr std::int32_t kSqrtHalf = 0x3f3504f3;
  const auto bits = std::bit_cast<std::int32_t>(v);
  const std::int32_t exponent = (bits - kSqrtHalf) >> 23;
  const float m = std::bit_cast<float>(bits - (exponent << 23)) - 1.0F;
  const float log2_m = m * horner(m, 1.442695F, -0.721347199F, 0.48091028F, -0.360716264F, 0.287939094F, -0.238675685F,
                                  0.21521226F, -0.208933794F, 0.12926425F);

  constexpr float kHigh = 59578.0F / 131072;  // the first 16 bits of 1/2.2: exact times the exponent
  constexpr auto kLow = static_cast<float>(1 / 2.2 - 59578.0 / 131072);
  const float high = static_cast<float>(exponent) * kHigh;
  const float low = static_cast<float>(exponent) * kLow + log2_m * kInverseGamma;
  constexpr float kToInteger = 12582912.0F;  // 1.5 * 2^23: adding it rounds to an integer
  const float rounded = high + low + kToInteger;
  const float f = (high - (rounded - kToInteger)) + low;
  const std::int32_t power = std::bit_cast<std::int32_t>(rounded) - std::bit_cast<std::int32_t>(kToInteger);
  return std::bit_cast<float>((power + 127) << 23) *
         horner(f, 1.0F, 0.693147207F, 0.240226515F, 0.0555032722F, 0.00961799451F, 0.00134004317F, 0.000154780224F);
}

BURIN_MACHINE_CLONES void encode_row(const float* radiance, int n, float exposure, float* picture) {
  for (int i = 0; i < n; ++i) {
    const float light = exposure * radiance[i];
    // max(0, light) without a branch, which would prevent vectorization.
    picture[i] = encoded(0.5F * (light + std::abs(light)) + kOffset);
  }
}

/// Returns the sum of dE_dradiance times radiance.
BURIN_MACHINE_CLONES float decode_gradient_row(const float* radiance, const float* picture, const float* dE_dpicture,
                                               int n, float exposure, float* dE_dradiance) {
  for (int i = 0; i < n; ++i) {
    const float light = exposure * radiance[i];
    const float on = light > 0 ? kInverseGamma * exposure : 0.0F;
    dE_dradiance[i] = on * dE_dpicture[i] * picture[i] / (std::abs(light) + kOffset);
  }
  LaneSum sum;
  sum.add(n, [&](int i) { return dE_dradiance[i] * radiance[i]; });
  return sum.total();
}

}  // namespace

void picture_from_radiance(const Image& radiance, double exposure, Image& picture) {
  if (picture.data.size() != radiance.data.size() || picture.width != radiance.width)
    picture = Image(radiance.width, radiance.height, radiance.channels);
  const int n = radiance.width * radiance.channels;
  for_bands(radiance.height, [&](int first, int end) {
    for (int y = first; y < end; ++y) {
      const std::size_t row = static_cast<std::size_t>(y) * n;
      encode_row(&radiance.data[row], n, static_cast<float>(exposure), &picture.data[row]);
    }
  });
}

double radiance_gradient(const Image& radiance, double exposure, const Image& picture, const Image& dE_dpicture,
                         Image& dE_dradiance) {
  if (dE_dradiance.data.size() != radiance.data.size() || dE_dradiance.width != radiance.width)
    dE_dradiance = Image(radiance.width, radiance.height, radiance.channels);
  const int n = radiance.width * radiance.channels;
  return sum_over_bands(radiance.height, [&](int first, int end) {
    double sum = 0;
    for (int y = first; y < end; ++y) {
      const std::size_t row = static_cast<std::size_t>(y) * n;
      sum += decode_gradient_row(&radiance.data[row], &picture.data[row], &dE_dpicture.data[row], n,
                                 static_cast<float>(exposure), &dE_dradiance.data[row]);
    }
    return sum;
  });
}

Image with_gamma_offset(const Image& encoded) {
  Image out = encoded;
  for (float& v : out.data) v = std::pow(std::pow(std::max(0.0F, v), 2.2F) + kOffset, kInverseGamma);
  return out;
}

Image shown_picture(const Image& radiance, double exposure) {
  Image out = radiance;
  const auto e = static_cast<float>(exposure);
  const std::size_t n = static_cast<std::size_t>(out.width) * out.channels;
  for_bands(out.height, [&](int first, int end) {
    for (std::size_t i = first * n; i < end * n; ++i)
      out.data[i] = std::min(1.0F, std::pow(std::max(0.0F, e * out.data[i]), kInverseGamma));
  });
  return out;
}

}  // namespace burin
