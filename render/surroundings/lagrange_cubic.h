// burin/render/surroundings/lagrange_cubic.h - weights of four neighbors on an axis, for tables in double and for SIMD
// kernels.
#pragma once

namespace burin {

/// Lagrange's cubic through four neighbors at -1, 0, 1, 2: their weights at u, and the derivatives by u. `Kernel` is
/// the SIMD vector type of a file with its own instruction set, so that files share no such code.
template <class Number, class Kernel = void>
[[gnu::always_inline]] inline void lagrange_cubic(Number u, Number (&share)[4], Number (&slope)[4]) {
  const Number one(1), two(2), three(3), four(4), six(6), half(0.5), sixth(Number(1) / six);
  const Number before = u + one, after = u - one, far = u - two;
  share[0] = -sixth * u * after * far;
  share[1] = half * before * after * far;
  share[2] = -half * before * u * far;
  share[3] = sixth * before * u * after;
  slope[0] = -sixth * (three * u * u - six * u + two);
  slope[1] = half * (three * u * u - four * u - one);
  slope[2] = -half * (three * u * u - two * u - two);
  slope[3] = sixth * (three * u * u - one);
}

}  // namespace burin
