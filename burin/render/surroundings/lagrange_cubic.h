// burin/render/surroundings/lagrange_cubic.h - shares of four neighbors on an axis, for tables in double and for the
// packets' kernels.
#pragma once

namespace burin {

/// Lagrange's cubic through four neighbors at the places -1, 0, 1, 2: their shares at u, and the shares' slopes by u.
/// `Kernel`: the packet of a file with instructions of its own, so that no such code is shared with other files.
template <class Number, class Kernel = void>
[[gnu::always_inline]] inline void lagrange_cubic(Number u, Number (&share)[4], Number (&slope)[4]) {
  share[0] = -u * (u - 1) * (u - 2) / 6;
  share[1] = (u + 1) * (u - 1) * (u - 2) / 2;
  share[2] = -(u + 1) * u * (u - 2) / 2;
  share[3] = (u + 1) * u * (u - 1) / 6;
  slope[0] = -(3 * u * u - 6 * u + 2) / 6;
  slope[1] = (3 * u * u - 4 * u - 1) / 2;
  slope[2] = -(3 * u * u - 2 * u - 2) / 2;
  slope[3] = (3 * u * u - 1) / 6;
}

}  // namespace burin
