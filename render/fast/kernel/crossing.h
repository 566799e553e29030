// burin/render/fast/kernel/crossing.h - pixels in the units of the scratches that touch them, and the part of each
// pixel on its groove.
#pragma once

#include <algorithm>
#include <cstdint>

#include "burin/render/fast/kernel/edges.h"
#include "burin/render/fast/kernel/work.h"

namespace burin::kernel {

/// Middles of the pixels of a SIMD vector of pairs on the lattice, in the scratches' units.
template <class P>
struct Middle {
  P coarse, fine, Y;
};
template <class P, class Constant>
[[gnu::always_inline]] inline Middle<P> middle_of(const std::uint16_t* place, const Constant& of) {
  P column, row;
  packet::columns_and_rows(place, column, row);
  return {of(kMidCoarse) + column * of(kColumnCoarse) + row * of(kRowCoarse),
          of(kMidFine) + column * of(kColumnFine) + row * of(kRowFine),
          of(kMidY) + column * of(kColumnY) + row * of(kRowY)};
}

/// The pixels' corners in their scratches' units. of(Line) returns a constant of the scratches.
template <class P, class Constant>
[[gnu::always_inline]] inline Edges<P> edges_of(const TileTask& task, const std::uint16_t* place,
                                                const Middle<P>& middle, const Constant& of) {
  Edges<P> e;
  const P half(0.5F);
  constexpr float kColumn[4] = {-1, 1, 1, -1}, kRow[4] = {-1, -1, 1, 1};
  P fine[4];
  for (int k = 0; k < 4; ++k) {
    const P column = half * P(kColumn[k]), row = half * P(kRow[k]);
    e.t[k] = middle.coarse + (column * of(kColumnCoarse) + row * of(kRowCoarse));
    fine[k] = middle.fine + (column * of(kColumnFine) + row * of(kRowFine));
    e.Y[k] = middle.Y + (column * of(kColumnY) + row * of(kRowY));
  }
  if (task.corners != nullptr) {
    // Offset in floats: rows of corners are one longer than rows of pixels.
    static_assert(TileCorners::kSide == kTile + 1);
    alignas(64) std::uint32_t at[kLanesOf<P>];
    for (int k = 0; k < kLanesOf<P>; ++k) at[k] = 2U * (place[k] + place[k] / kTile);
    asm("" : "+m"(at));  // through memory, as in Shading (shading.h)
    const float *corners = task.corners->at[0], *below = corners + 2 * TileCorners::kSide;
    P up[4], down[4];
    packet::four_columns(up, [&](int k) { return corners + at[k]; });
    packet::four_columns(down, [&](int k) { return below + at[k]; });
    const P tx = of(kAcrossX) * of(kPerMm), ty = of(kAcrossY) * of(kPerMm);
    const auto move = [&](int k, const P& x, const P& y) {
      fine[k] += tx * x + ty * y;
      e.Y[k] += tx * y - ty * x;
    };
    move(0, up[0], up[1]);
    move(1, up[2], up[3]);
    move(2, down[2], down[3]);
    move(3, down[0], down[1]);
  }
  for (int k = 0; k < 4; ++k) e.t[k] += fine[k];
  e.make();
  return e;
}

/// The part of each pixel across its groove, as if the scratch had no ends.
template <class P>
struct Crossing {
  P t_min, t_max, Y_min, Y_max;
  P a, b;  // range of t of the groove in the pixel
  P top1, top2, bottom1, bottom2;
  P inside;         // positive if a corner is between a and b
  MaskOf<P> along;  // a side runs along the groove
};

template <class P, class Constant>
[[gnu::always_inline]] inline Crossing<P> crossing_of_corners(const TileTask& task, const std::uint16_t* place,
                                                              const Constant& of) {
  const Edges<P> e = edges_of<P>(task, place, middle_of<P>(place, of), of);
  const P rim = of(kRim), a = xsimd::max(-rim, e.t_min), b = xsimd::min(rim, e.t_max);
  P top1(1e30F), top2(1e30F), bottom1(-1e30F), bottom2(-1e30F);
  e.cut_levels(a, top1, bottom1);
  e.cut_levels(b, top2, bottom2);
  P inside = (e.t[0] - a) * (b - e.t[0]);
  MaskOf<P> slanting = e.is_top[0] | e.is_bottom[0];
  for (int k = 1; k < 4; ++k) {
    inside = xsimd::max(inside, (e.t[k] - a) * (b - e.t[k]));
    slanting = slanting & (e.is_top[k] | e.is_bottom[k]);
  }
  return {e.t_min, e.t_max, e.Y_min, e.Y_max, a, b, top1, top2, bottom1, bottom2, inside, !slanting};
}

/// crossing_of_corners() for corners on the lattice: pixels are parallelograms, and the constants hold their sides.
/// From the corner with the least t the upper boundary has the steeper side first, then the flatter one. The lower
/// boundary has the reverse order.
template <class P, class Constant>
[[gnu::always_inline]] inline Crossing<P> crossing_on_lattice(const std::uint16_t* place, const Constant& of) {
  const Middle<P> middle = middle_of<P>(place, of);
  Crossing<P> c;
  c.t_min = (middle.coarse - of(kReachCoarse)) + (middle.fine - of(kReachFine));
  c.t_max = (middle.coarse + of(kReachCoarse)) + (middle.fine + of(kReachFine));
  c.Y_min = middle.Y - of(kReachY);
  c.Y_max = middle.Y + of(kReachY);
  const P rim = of(kRim);
  c.a = xsimd::max(-rim, c.t_min);
  c.b = xsimd::min(rim, c.t_max);
  const P near_Y = middle.Y - of(kFarY), far_Y = middle.Y + of(kFarY), steep = of(kSteep), flat = of(kFlat);
  const auto levels = [&](const P& at, P& top, P& bottom) {
    const P from_near = at - c.t_min, from_far = at - c.t_max;
    top = xsimd::min(near_Y + steep * from_near, far_Y + flat * from_far);
    bottom = xsimd::max(near_Y + flat * from_near, far_Y + steep * from_far);
  };
  levels(c.a, c.top1, c.bottom1);
  levels(c.b, c.top2, c.bottom2);
  const P column = xsimd::abs(of(kColumnCoarse) + of(kColumnFine)), row = xsimd::abs(of(kRowCoarse) + of(kRowFine));
  const P t1 = c.t_min + column, t2 = c.t_min + row;
  c.inside = xsimd::max((t1 - c.a) * (c.b - t1), (t2 - c.a) * (c.b - t2));
  // Almost along the groove: its corners may round to the same t.
  c.along = xsimd::min(column, row) < P(1e-6F);
  return c;
}

}  // namespace burin::kernel
