// burin/optimize/design/shown_light.h - shown value of a pixel's light, light^(1/2.2) clipped at white, fast enough for
// a hundred million calls a second.
//
// With light = 2^e (1 + z): log2(1 + z) = z + z (1 - z) kLog2(z), 2^f = 1 + f + f (1 - f) kExp2(f), with polynomials
// through Chebyshev's nodes. The relative error of the result is at most 4e-5. The kernels (stroke_kernel_impl.h) take
// the same steps in SIMD vectors without fused multiply-adds, and give the same bits.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace burin {

inline constexpr std::array<float, 4> kLog2{0.442418579F, -0.269578015F, 0.150533197F, -0.0448739553F};
inline constexpr std::array<float, 3> kExp2{-0.306908787F, -0.0656250952F, -0.0136976637F};

/// Smallest light: less counts as this, which shows as 8e-5 of white.
inline constexpr float kLeastLight = 0x1p-30F;
/// Exponent from light to shown value.
inline constexpr float kShownPower = 1 / 2.2F;

/// log2 of a positive, normal number; the error is at most 5e-5.
inline float fast_log2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const auto e = static_cast<float>(static_cast<std::int32_t>(bits >> 23) - 127);
  const float z = std::bit_cast<float>((bits & 0x7fffffU) | 0x3f800000U) - 1;
  const float p = ((kLog2[3] * z + kLog2[2]) * z + kLog2[1]) * z + kLog2[0];
  return e + (z + z * (1 - z) * p);
}

/// 2^x for -126 <= x <= 126; the relative error is at most 1.3e-5.
inline float fast_exp2(float x) {
  const auto whole = static_cast<std::int32_t>(x) - (x < static_cast<float>(static_cast<std::int32_t>(x)) ? 1 : 0);
  const float f = x - static_cast<float>(whole);
  const float p = (kExp2[2] * f + kExp2[1]) * f + kExp2[0];
  const float y = 1 + f + f * (1 - f) * p;
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(y) + (static_cast<std::uint32_t>(whole) << 23));
}

/// light^(1/2.2), at most 1.
inline float shown_light(float light) {
  return std::min(1.0F, fast_exp2(kShownPower * fast_log2(std::max(light, kLeastLight))));
}

}  // namespace burin
