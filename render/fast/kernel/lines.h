// burin/render/fast/kernel/lines.h - constants of a scratch for its pairs, made once per run (Line in
// burin/render/fast/tile_kernel.h).
#pragma once

#include <cstdint>
#include <limits>

#include "burin/render/fast/kernel/work.h"

namespace burin::kernel {

/// The lines of the runs number(0) .. number(kLanesOf<P> - 1), from column `at` on. With `place`, one pixel per run,
/// the lines refer to this pixel instead of pixel (0, 0). Y then counts from kOriginY, a point in the pixel. So Y keeps
/// its digits if a scratch's end and a pixel's side nearly meet.
template <class P, class Number>
BURIN_FLATTEN inline void make_lines(const TileTask& task, const Number& number, float (*to)[TileBuffers::kLines],
                                     int at, const std::uint16_t* place = nullptr) {
  P run[8], shape[4] = {P(task.shapes[0].per_mm), P(task.shapes[0].rim), P(task.shapes[0].alpha)};
  for (const int i : {0, 4}) packet::four_columns(run + i, [&](int k) { return &task.runs[number(k)].across_x + i; });
  if (!task.shapes.shared) packet::four_columns(shape, [&](int k) { return &task.shapes[number(k)].per_mm; });
  const TileLattice& lattice = *task.lattice;
  alignas(64) float in[9][kLanesOf<P>], split[6][kLanesOf<P>], Y[3][kLanesOf<P>], origin[kLanesOf<P>],
      pixel[2][kLanesOf<P>];
  for (int i = 0; i < 8; ++i) run[i].store_aligned(in[i]);
  shape[0].store_aligned(in[8]);
  if (place != nullptr) {
    P column, row;
    packet::columns_and_rows(place, column, row);
    column.store_aligned(pixel[0]);
    row.store_aligned(pixel[1]);
  }
  using D = packet::DoublesOf<P>;
  for (int k = 0; k < kLanesOf<P>; k += static_cast<int>(D::size)) {
    const auto get = [&](int i) { return packet::doubles<P>(in[i] + k); };
    const D per_mm = get(8), tx = per_mm * (get(0) + get(5)), ty = per_mm * (get(1) + get(6));
    D x(lattice.first_x), y(lattice.first_y);
    if (place != nullptr) {
      const D column = packet::doubles<P>(pixel[0] + k), row = packet::doubles<P>(pixel[1] + k);
      x += column * D(lattice.column_x) + row * D(lattice.row_x);
      y += column * D(lattice.column_y) + row * D(lattice.row_y);
    }
    const D t[3] = {tx * x + ty * y + (get(2) + get(7)), tx * D(lattice.column_x) + ty * D(lattice.column_y),
                    tx * D(lattice.row_x) + ty * D(lattice.row_y)};
    D mid_Y = tx * y - ty * x;
    if (place != nullptr) {
      packet::store_floats<P>(origin + k, mid_Y);
      mid_Y -= packet::doubles<P>(origin + k);
    }
    packet::store_floats<P>(Y[0] + k, mid_Y);
    packet::store_floats<P>(Y[1] + k, tx * D(lattice.column_y) - ty * D(lattice.column_x));
    packet::store_floats<P>(Y[2] + k, tx * D(lattice.row_y) - ty * D(lattice.row_x));
    // Adding and subtracting a large number leaves multiples of 2^-21 of the power of two in `size`.
    const D size = xsimd::abs(t[0]) + D(kTile) * (xsimd::abs(t[1]) + xsimd::abs(t[2]));
    const D exponent_bits(std::numeric_limits<double>::infinity());
    const D large = D(3.0 * (1 << 30)) * (size & exponent_bits);
    for (int i = 0; i < 3; ++i) {
      const D coarse = (t[i] + large) - large;
      packet::store_floats<P>(split[2 * i] + k, coarse);
      packet::store_floats<P>(split[2 * i + 1] + k, t[i] - coarse);
    }
  }
  const auto put = [&](Line line, const P& v) { save(to[line] + at, v); };
  const P column_coarse = P::load_aligned(split[2]), column_fine = P::load_aligned(split[3]);
  const P row_coarse = P::load_aligned(split[4]), row_fine = P::load_aligned(split[5]);
  put(kMidCoarse, P::load_aligned(split[0]));
  put(kMidFine, P::load_aligned(split[1]));
  put(kColumnCoarse, column_coarse);
  put(kColumnFine, column_fine);
  put(kRowCoarse, row_coarse);
  put(kRowFine, row_fine);
  const P column_Y = P::load_aligned(Y[1]), row_Y = P::load_aligned(Y[2]);
  put(kMidY, P::load_aligned(Y[0]));
  if (place != nullptr) put(kOriginY, P::load_aligned(origin));
  put(kColumnY, column_Y);
  put(kRowY, row_Y);
  // A pixel's sides, directed towards larger t.
  const P half(0.5F), column = column_coarse + column_fine, row_t = row_coarse + row_fine;
  const MaskOf<P> column_back = column < P(0.0F), row_back = row_t < P(0.0F);
  const P u = xsimd::abs(column), v = xsimd::abs(row_t);
  const P u_Y = xsimd::select(column_back, -column_Y, column_Y), v_Y = xsimd::select(row_back, -row_Y, row_Y);
  put(kReachCoarse, half * (xsimd::abs(column_coarse) + xsimd::abs(row_coarse)));
  put(kReachFine,
      half * (xsimd::select(column_back, -column_fine, column_fine) + xsimd::select(row_back, -row_fine, row_fine)));
  put(kReachY, half * (xsimd::abs(column_Y) + xsimd::abs(row_Y)));
  put(kFarY, half * (u_Y + v_Y));
  const P u_slope = u_Y * inverse(xsimd::max(u, P(1e-25F))), v_slope = v_Y * inverse(xsimd::max(v, P(1e-25F)));
  const MaskOf<P> u_steeper = u_Y * v > v_Y * u;
  put(kSteep, xsimd::select(u_steeper, u_slope, v_slope));
  put(kFlat, xsimd::select(u_steeper, v_slope, u_slope));
  const P per_t = inverse(shape[0]);
  put(kUnit, per_t * per_t);
  put(kAcrossX, run[0]);
  put(kAcrossY, run[1]);
  put(kPerMm, shape[0]);
  put(kFirstEnd, run[3]);
  put(kSecondEnd, run[4]);
  put(kAlpha, shape[2]);
  put(kRim, shape[1]);
}

}  // namespace burin::kernel
