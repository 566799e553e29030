// burin/render/fast/kernel/shading.h - light and view of pixels: the half vector, and the factors around the footprint
// integral. docs/model.md 5.
#pragma once

#include <algorithm>
#include <cstdint>

#include "burin/render/fast/kernel/work.h"

namespace burin::kernel {

/// G with its part of the derivative by alpha: (alpha^2 / pi) G, and d log(alpha^2 G) / d alpha.
template <class P>
struct Factor {
  P value, by_alpha;
};
template <class P, KernelMode kMode>
[[gnu::always_inline]] inline Factor<P> factor_of(const P& alpha, const P& tan2_i, const P& tan2_o) {
  const P one(1.0F), alpha2 = alpha * alpha;
  const P u = one + alpha2 * tan2_i, v = one + alpha2 * tan2_o;
  const P per_root_i = footprint::Arithmetic<P>::inverse_sqrt(u),
          per_root_o = footprint::Arithmetic<P>::inverse_sqrt(v);
  const P root_i = u * per_root_i, root_o = v * per_root_o;
  const P G = P(4.0F) * inverse((one + root_i) * (one + root_o));
  Factor<P> f{P(0.318309886F) * alpha2 * G, P(0.0F)};
  if constexpr (kMode == KernelMode::material)
    f.by_alpha =
        P(2.0F) / alpha - alpha * (tan2_i * per_root_i / (one + root_i) + tan2_o * per_root_o / (one + root_o));
  return f;
}

/// Light and view of the pixels of a SIMD vector of pairs: the half vector and the other two numbers of `of`.
template <class P>
struct Shading {
  P h_x, h_y, h_z, beside[2];

  [[gnu::always_inline]] Shading(const float (*of)[4], const std::uint16_t* place) {
    // Forces a store, because extraction of single lanes from a register is slow.
    alignas(64) std::uint32_t at[kLanesOf<P>];
    for (int k = 0; k < kLanesOf<P>; ++k) at[k] = 4U * place[k];
    asm("" : "+m"(at));
    P shading[4];
    const auto* const all = reinterpret_cast<const float*>(of);  // not one row: `at` indexes all rows
    packet::four_columns(shading, [&](int k) { return all + at[k]; });
    h_x = shading[0];
    h_y = shading[1];
    const P hz2 = xsimd::max(P(1.0F) - (h_x * h_x + h_y * h_y), P(1e-12F));
    h_z = hz2 * footprint::Arithmetic<P>::inverse_sqrt(hz2);
    beside[0] = shading[2];
    beside[1] = shading[3];
  }
};

/// Light of the pixels of a SIMD vector of pairs. Stores from `at` on: a pair's light for V = 1 and a unit of 1 mm^2,
/// the plain face's light per mm^2, and d log(alpha^2 G) / d alpha.
template <class P, KernelMode kMode>
[[gnu::always_inline]] inline Shading<P> shade(const TileTask& task, TileBuffers& buffers, const std::uint16_t* place,
                                               const P& alpha, int at) {
  const bool one_alpha = task.shapes.shared;
  const Shading<P> px(one_alpha ? buffers.lit : task.shading->at, place);
  Factor<P> f{px.beside[0], P(0.0F)};
  P base = px.beside[1];
  if (one_alpha) {
    if constexpr (kMode == KernelMode::material) f.by_alpha = packet::look_up<P>(buffers.lit_by_alpha, place);
  } else {
    f = factor_of<P, kMode>(alpha, px.beside[0], px.beside[1]);
    if constexpr (kMode != KernelMode::value) base = packet::look_up<P>(task.base, place);
  }
  save(buffers.gain + at, f.value);
  if constexpr (kMode != KernelMode::value) save(buffers.base + at, base);
  if constexpr (kMode == KernelMode::material) save(buffers.by_alpha + at, f.by_alpha);
  return px;
}

/// Fills buffers.lit and buffers.lit_by_alpha.
template <class P, KernelMode kMode>
BURIN_FLATTEN inline void shade_tile(const TileTask& task, TileBuffers& buffers) {
  const P alpha(task.shapes[0].alpha);
  for (int i = 0; i < kTilePixels; i += kLanesOf<P>) {
    P of[4];
    packet::four_columns(of, [&](int k) { return task.shading->at[i + k]; });
    const Factor<P> f = factor_of<P, kMode>(alpha, of[2], of[3]);
    const P base = kMode == KernelMode::value ? P(0.0F) : load<P>(task.base + i);
    packet::four_rows({of[0], of[1], f.value, base}, buffers.lit + i);
    if constexpr (kMode == KernelMode::material) save(buffers.lit_by_alpha + i, f.by_alpha);
  }
}

}  // namespace burin::kernel
