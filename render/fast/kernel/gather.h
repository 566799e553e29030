// burin/render/fast/kernel/gather.h - the backward pass of one tile, and the correction of covered pixels.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "burin/render/fast/kernel/work.h"

namespace burin::kernel {

/// Implements TileKernels::cover.
template <class P>
BURIN_FLATTEN inline void cover(const TileTask& task, const TilePlaces& places, const float* covered,
                                const TileBuffers& buffers, const TileJacobian& to) {
  const std::size_t count = places.begin[task.run_count];
  for (std::size_t i = 0; i < count; i += kLanesOf<P>) {
    const P base = packet::look_up<P>(covered, &places.place[i]);
    const auto give_back = [&](const std::vector<float>& area, float* of) {
      save(of + i, load<P>(of + i) + base * load<P>(&area[i]));
    };
    give_back(buffers.area_shift, to.shift);
    give_back(buffers.area_turn, to.turn);
    if (task.mode != KernelMode::material) continue;
    give_back(buffers.area_width, to.width);
    give_back(buffers.area_rim, to.rim);
  }
  for (EndPair* e = to.ends; e != to.ends + to.end_count; ++e) {
    const float base = covered[places.place[e->pair]];
    e->first += base * e->area_first;
    e->second += base * e->area_second;
  }
}

template <class P, bool kMaterial>
BURIN_FLATTEN inline void gather_mode(const TileTask& task, const TilePlaces& places, const float* weight,
                                      const TileJacobian& jacobian, float* to) {
  constexpr int kNumbers = run_gradients(kMaterial ? KernelMode::material : KernelMode::ends);
  constexpr int kSums = kMaterial ? 5 : 2;
  const float* const arrays[5] = {jacobian.shift, jacobian.turn, jacobian.width, jacobian.rim, jacobian.alpha};
  const P lane = packet::lane_numbers<P>();
  for (std::uint32_t first = 0; first < task.run_count; first += kLanesOf<P>) {
    const std::uint32_t stop = std::min<std::uint32_t>(first + kLanesOf<P>, task.run_count);
    P sums[kSums][kLanesOf<P>];  // one SIMD vector per run: shift, turn, width, rim, alpha
    for (std::uint32_t r = first; r < stop; ++r) {
      const std::size_t last = places.begin[r + 1];
      P sum[kSums];
      for (P& s : sum) s = P(0.0F);
      for (std::size_t i = places.begin[r]; i < last; i += kLanesOf<P>) {
        const MaskOf<P> in = lane < P(static_cast<float>(last - i));
        const P w = xsimd::select(in, packet::look_up<P>(weight, &places.place[i]), P(0.0F));
        for (int k = 0; k < kSums; ++k) sum[k] = sum[k] + w * load<P>(arrays[k] + i);
      }
      for (int k = 0; k < kSums; ++k) sums[k][r - first] = sum[k];
    }
    for (std::uint32_t r = stop; r < first + kLanesOf<P>; ++r)
      for (int k = 0; k < kSums; ++k) sums[k][r - first] = P(0.0F);
    const auto number = [&](int k) { return std::min<std::size_t>(first + k, stop - 1); };
    P run[4], shape[4] = {P(task.shapes[0].per_mm)};
    packet::four_columns(run, [&](int k) { return &task.runs[number(k)].across_x; });
    if (!task.shapes.shared) packet::four_columns(shape, [&](int k) { return &task.shapes[number(k)].per_mm; });
    // The shift acts at the foot of the tile's origin, Y = 0.
    const P shift = packet::sums_of_rows(sums[0]), turn = packet::sums_of_rows(sums[1]);
    const P out[4] = {shape[0] * shift, -(shift * run[3] + turn), P(0.0F), P(0.0F)};
    const std::size_t here = stop - first;
    alignas(64) float rows[kLanesOf<P>][4];
    packet::four_rows(out, rows);
    for (std::size_t k = 0; k < here; ++k) std::memcpy(to + (first + k) * kNumbers, rows[k], sizeof(rows[k]));
    if constexpr (kMaterial) {
      packet::four_rows(
          {packet::sums_of_rows(sums[2]), packet::sums_of_rows(sums[3]), packet::sums_of_rows(sums[4]), P(0.0F)}, rows);
      for (std::size_t k = 0; k < here; ++k) std::memcpy(to + (first + k) * kNumbers + 4, rows[k], sizeof(rows[k]));
    }
  }
  for (const EndPair *e = jacobian.ends, *stop = e + jacobian.end_count; e != stop; ++e) {
    const float w = task.shapes[e->run].per_mm * weight[places.place[e->pair]];
    float* by = to + static_cast<std::size_t>(e->run) * kNumbers;
    by[2] += w * e->first;
    by[3] += w * e->second;
  }
}

/// Implements TileKernels::gather.
template <class P>
inline void gather(const TileTask& task, const TilePlaces& places, const float* weight, const TileJacobian& jacobian,
                   float* to) {
  if (task.mode == KernelMode::material)
    gather_mode<P, true>(task, places, weight, jacobian, to);
  else
    gather_mode<P, false>(task, places, weight, jacobian, to);
}

}  // namespace burin::kernel
