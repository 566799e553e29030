// burin/render/fast/kernel/edges.h - edges of a SIMD vector of convex quadrilaterals, as lines Y over t.
#pragma once

#include <xsimd/xsimd.hpp>

#include "burin/render/fast/kernel/work.h"

namespace burin::kernel {

/// In the lanes of the mask, sets both levels to their middle, so the interval is empty.
template <class P>
[[gnu::always_inline]] inline void close_where(const MaskOf<P>& mask, P& top, P& bottom) {
  const P middle = P(0.5F) * (top + bottom);
  top = xsimd::select(mask, middle, top);
  bottom = xsimd::select(mask, middle, bottom);
}

template <class P>
[[gnu::always_inline]] inline void order(P& a, P& b) {
  const P low = xsimd::min(a, b);
  b = xsimd::max(a, b);
  a = low;
}

/// Edges of the top run towards smaller t, edges of the bottom towards larger t.
template <class P>
struct Edges {
  P t[4], Y[4], slope[4];
  MaskOf<P> is_top[4], is_bottom[4];
  P t_min, t_max, Y_min, Y_max;

  void make() {
    // Counter-clockwise.
    const MaskOf<P> clockwise = (t[2] - t[0]) * (Y[3] - Y[1]) < (t[3] - t[1]) * (Y[2] - Y[0]);
    for (P* v : {t, Y}) {
      const P one = v[1];
      v[1] = xsimd::select(clockwise, v[3], one);
      v[3] = xsimd::select(clockwise, one, v[3]);
    }
    for (int i = 0; i < 4; ++i) {
      const int j = (i + 1) % 4;
      const P dt = t[j] - t[i];
      is_top[i] = dt < P(0.0F);
      is_bottom[i] = dt > P(0.0F);
      slope[i] = (Y[j] - Y[i]) * inverse(xsimd::select(is_top[i] | is_bottom[i], dt, P(1.0F)));
    }
    t_min = xsimd::min(xsimd::min(t[0], t[1]), xsimd::min(t[2], t[3]));
    t_max = xsimd::max(xsimd::max(t[0], t[1]), xsimd::max(t[2], t[3]));
    Y_min = xsimd::min(xsimd::min(Y[0], Y[1]), xsimd::min(Y[2], Y[3]));
    Y_max = xsimd::max(xsimd::max(Y[0], Y[1]), xsimd::max(Y[2], Y[3]));
  }

  /// Cuts [bottom, top] to the polygon's extent at t.
  void cut_levels(const P& at, P& top, P& bottom) const {
    for (int i = 0; i < 4; ++i) {
      const P line = Y[i] + slope[i] * (at - t[i]);
      top = xsimd::select(is_top[i], xsimd::min(top, line), top);
      bottom = xsimd::select(is_bottom[i], xsimd::max(bottom, line), bottom);
    }
  }

  /// The polygon's extent at t, cut to [first, second]; equal levels if it is empty.
  void levels(const P& at, const P& first, const P& second, P& top, P& bottom) const {
    top = second;
    bottom = first;
    cut_levels(at, top, bottom);
    close_where(top < bottom, top, bottom);
  }
};

}  // namespace burin::kernel
