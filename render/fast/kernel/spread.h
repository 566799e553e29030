// burin/render/fast/kernel/spread.h - sums per pixel of the derivatives of a tile's pairs, for photos
// (burin/render/fast/pixel_slopes.h). docs/model.md 8.7.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "burin/render/fast/kernel/work.h"

namespace burin::kernel {

/// The tile's lattice in float: the middle of a pixel in mm from the tile's origin.
struct MiddleOfPixel {
  float first_x, first_y, column_x, column_y, row_x, row_y;

  explicit MiddleOfPixel(const TileLattice& l)
      : first_x(static_cast<float>(l.first_x)),
        first_y(static_cast<float>(l.first_y)),
        column_x(static_cast<float>(l.column_x)),
        column_y(static_cast<float>(l.column_y)),
        row_x(static_cast<float>(l.row_x)),
        row_y(static_cast<float>(l.row_y)) {}

  template <class T>
  [[gnu::always_inline]] T x(const T& column, const T& row) const {
    return T(first_x) + column * T(column_x) + row * T(row_x);
  }
  template <class T>
  [[gnu::always_inline]] T y(const T& column, const T& row) const {
    return T(first_y) + column * T(column_y) + row * T(row_y);
  }
};

/// Adds four columns to the numbers of n pixels.
template <class P>
[[gnu::always_inline]] inline void add_four(const P (&columns)[4], const std::uint16_t* place, int n, float* to) {
  using Four = float __attribute__((vector_size(16)));
  alignas(64) float rows[kLanesOf<P>][4];
  packet::four_rows(columns, rows);
  for (int k = 0; k < n; ++k) {
    Four sum, more;
    float* const at = to + static_cast<std::ptrdiff_t>(kPixelSlopes) * place[k];
    std::memcpy(&sum, at, sizeof(Four));
    std::memcpy(&more, rows[k], sizeof(Four));
    sum += more;
    std::memcpy(at, &sum, sizeof(Four));
  }
}

/// Implements TileKernels::spread.
template <class P>
BURIN_FLATTEN inline void spread(const TileTask& task, const TilePlaces& places, const TileJacobian& jacobian,
                                 const RunUnits* units, const float* half_x, const float* half_y, float* to) {
  const MiddleOfPixel middle(*task.lattice);
  for (std::uint32_t r = 0; r < task.run_count; ++r) {
    const std::size_t last = places.begin[r + 1];
    if (places.begin[r] == last) continue;
    const TileRun& run = task.runs[r];
    const RunUnits& unit = units[r];
    const P ax(run.across_x), ay(run.across_y), per_mm(task.shapes[r].per_mm), origin(run.t_origin);
    const P xx = ax * ax, xy = ax * ay, yy = ay * ay;
    for (std::size_t i = places.begin[r]; i < last; i += kLanesOf<P>) {
      const std::uint16_t* place = &places.place[i];
      const int n = static_cast<int>(std::min<std::size_t>(kLanesOf<P>, last - i));
      P column, row;
      packet::columns_and_rows(place, column, row);
      const P x = middle.x(column, row), y = middle.y(column, row);
      const P t = origin + per_mm * (ax * x + ay * y), Y = per_mm * (ax * y - ay * x);
      const P shift = load<P>(jacobian.shift + i), shift_mm = per_mm * shift, rim = load<P>(jacobian.rim + i),
              width = load<P>(jacobian.width + i);
      const P across = load<P>(jacobian.h_across + i), along = load<P>(jacobian.h_along + i);
      add_four<P>({ax * shift_mm, ay * shift_mm, ax * across - ay * along, ay * across + ax * along}, place, n, to);
      // Turn about the pixel's middle instead of the foot of the tile's origin; the same without the turn of the half
      // vector in the scratch's frame; motion away from the middle, and with a change of width.
      const P turn = load<P>(jacobian.turn + i) + Y * shift;
      const P hx = packet::look_up<P>(half_x, place), hy = packet::look_up<P>(half_y, place);
      const P bare = turn - ((ax * hy - ay * hx) * across - (ax * hx + ay * hy) * along);
      const P away = -(t * shift), wider = away + width;
      add_four<P>({turn * xy + away * xx, away * xy - turn * xx, turn * yy + away * xy, away * yy - turn * xy}, place,
                  n, to + kByGrooves);
      add_four<P>(
          {-(bare * xy + wider * xx), bare * xx - wider * xy, -(bare * yy + wider * xy), bare * xy - wider * yy}, place,
          n, to + kByFootprint);
      add_four<P>({P(unit.rim_by_depth) * rim + P(unit.aside_by_depth) * shift_mm,
                   P(unit.scale_by_width) * width + P(unit.rim_by_width) * rim + P(unit.aside_by_width) * shift_mm,
                   P(unit.by_alpha) * load<P>(jacobian.alpha + i), P(0.0F)},
                  place, n, to + kByDepth);
    }
  }
  for (const EndPair *e = jacobian.ends, *stop = e + jacobian.end_count; e != stop; ++e) {
    const std::uint16_t place = places.place[e->pair];
    const TileRun& run = task.runs[e->run];
    const float per_mm = task.shapes[e->run].per_mm, ax = run.across_x, ay = run.across_y;
    const int whole_rows = place / kTile;
    const auto column = static_cast<float>(place % kTile), row = static_cast<float>(whole_rows);
    const float x = middle.x(column, row), y = middle.y(column, row);
    const float t = run.t_origin + per_mm * (ax * x + ay * y), Y = per_mm * (ax * y - ay * x);
    const float both = e->first + e->second, aside = -t * both,
                away = e->first * (run.first_end - Y) + e->second * (run.second_end - Y);
    float* const at = to + static_cast<std::ptrdiff_t>(kPixelSlopes) * place;
    at[kByShift] -= per_mm * ay * both;
    at[kByShift + 1] += per_mm * ax * both;
    const float moved[4] = {ay * (ay * away - ax * aside), -ay * (ax * away + ay * aside),
                            ax * (ax * aside - ay * away), ax * (ax * away + ay * aside)};
    for (int k = 0; k < 4; ++k) {
      at[kByGrooves + k] += moved[k];
      at[kByFootprint + k] -= moved[k];
    }
  }
}

}  // namespace burin::kernel
