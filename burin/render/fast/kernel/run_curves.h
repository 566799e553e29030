// burin/render/fast/kernel/run_curves.h - the curves of a tile's runs, at a few places along each
// (burin/render/fast/curve_tables.h). docs/model.md 10.12.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "burin/render/fast/curve_tables.h"
#include "burin/render/fast/kernel/work.h"

namespace burin::kernel {

/// Lagrange's cubic through four neighbors, the place being u beyond the second; with slopes by the place.
template <class P>
[[gnu::always_inline]] inline void lagrange(float u, float (&share)[4], float (&slope)[4]) {
  share[0] = -u * (u - 1) * (u - 2) / 6;
  share[1] = (u + 1) * (u - 1) * (u - 2) / 2;
  share[2] = -(u + 1) * u * (u - 2) / 2;
  share[3] = (u + 1) * u * (u - 1) / 6;
  slope[0] = -(3 * u * u - 6 * u + 2) / 6;
  slope[1] = (3 * u * u - 4 * u - 1) / 2;
  slope[2] = -(3 * u * u - 2 * u - 2) / 2;
  slope[3] = (3 * u * u - 1) / 6;
}

/// atan2(y, x) of a unit vector with y >= 0, within 1e-5 (Abramowitz and Stegun, 4.4.49).
template <class P>
[[gnu::always_inline]] inline float azimuth_of(float x, float y) {
  constexpr float kHalf = 1.57079633F;
  const float ax = std::abs(x), low = std::min(ax, y), a = low / std::max(ax, y), b = a * a;
  const float part = a * (0.999866F + b * (-0.3302995F + b * (0.180141F + b * (-0.085133F + b * 0.0208351F))));
  const float first = ax >= y ? part : kHalf - part;
  return x >= 0 ? first : 2 * kHalf - first;
}

/// The curves that a knot is made of: four directions of some places.
struct KnotPlaces {
  const float* at[16];
  float share[16];
  int count = 0;
};
template <class P>
[[gnu::always_inline]] inline void find_places(const CurveTables& tables, float column, float row, int direction,
                                               KnotPlaces& to) {
  const auto axis = [&](double place, int count, int& first, float(&share)[4]) {
    const auto at = static_cast<float>(std::min(std::max(place, 0.0), count - 1.0));
    if (!tables.cubic) {
      first = std::max(0, std::min(static_cast<int>(at), count - 2));
      share[1] = count > 1 ? at - static_cast<float>(first) : 0;
      share[0] = 1 - share[1];
      return count > 1 ? 2 : 1;
    }
    float slope[4];
    first = std::max(0, std::min(static_cast<int>(at) - 1, count - 4));
    lagrange<P>(at - static_cast<float>(first) - 1, share, slope);
    return 4;
  };
  int x = 0, y = 0;
  float x_share[4] = {}, y_share[4] = {};
  const int nx = axis(column * tables.columns_per_pixel, tables.columns, x, x_share);
  const int ny = axis(row * tables.rows_per_pixel, tables.rows, y, y_share);
  to.count = 0;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const std::size_t place = static_cast<std::size_t>(y + j) * tables.columns + x + i;
      to.at[to.count] = tables.data.data() + place * tables.place_floats() +
                        static_cast<std::size_t>(direction + 1) * tables.row_floats;
      to.share[to.count++] = x_share[i] * y_share[j];
    }
}

/// Roughnesses of the tables near one, with Lagrange's shares in log(alpha), and the shares' slopes by alpha.
struct RoughnessShares {
  int first = 0, count = 1;
  float share[3] = {1, 0, 0}, slope[3] = {};
};
template <class P>
inline RoughnessShares roughness_shares(const CurveTables& tables, float alpha) {
  RoughnessShares out;
  const auto& logs = tables.log_alpha;
  if (logs.size() < 3) return out;
  const float x = std::log(alpha);
  std::size_t near = 1;
  for (std::size_t k = 1; k + 1 < logs.size(); ++k)
    if (std::abs(logs[k] - x) < std::abs(logs[near] - x)) near = k;
  out.first = static_cast<int>(near) - 1;
  out.count = 3;
  for (int k = 0; k < 3; ++k) {
    const float a = logs[out.first + (k + 1) % 3], b = logs[out.first + (k + 2) % 3], at = logs[out.first + k];
    const float below = (at - a) * (at - b);
    out.share[k] = (x - a) * (x - b) / below;
    out.slope[k] = (2 * x - a - b) / (below * alpha);
  }
  return out;
}

/// One knot's curves: with kSets 1 R, with 2 and dR by the turn, with 3 and dR by alpha.
template <class P, int kSets>
BURIN_FLATTEN inline void sum_knot(const CurveTables& tables, const KnotPlaces& places, const float (&share)[4],
                                   const float (&slope)[4], const RoughnessShares& rough, float* to) {
  const std::size_t table_floats = tables.place_floats() * tables.columns * tables.rows;
  const auto floats = static_cast<std::size_t>(tables.row_floats);
  for (int r = 0; r < rough.count; ++r) {
    if (kSets < 3 && rough.share[r] == 0) continue;
    const P whole(rough.share[r]), by_alpha(rough.slope[r]);
    const std::size_t table = (rough.first + r) * table_floats;
    for (std::size_t i = 0; i < floats; i += kLanesOf<P>) {
      P v[4] = {P(0.0F), P(0.0F), P(0.0F), P(0.0F)};
      for (int k = 0; k < places.count; ++k) {
        const float* from = places.at[k] + table + i;
        const P by(places.share[k]);
        for (int d = 0; d < 4; ++d) v[d] = xsimd::fma(by, load<P>(from + d * floats), v[d]);
      }
      P value = P(share[0]) * v[0], turn = P(slope[0]) * v[0];
      for (int d = 1; d < 4; ++d) {
        value = xsimd::fma(P(share[d]), v[d], value);
        turn = xsimd::fma(P(slope[d]), v[d], turn);
      }
      const auto add = [&](int set, const P& by, const P& what) {
        float* at = to + set * floats + i;
        save(at, xsimd::fma(by, what, load<P>(at)));
      };
      add(0, whole, value);
      if constexpr (kSets > 1) add(1, whole, turn);
      if constexpr (kSets > 2) add(2, by_alpha, value);
    }
  }
}

/// How a run's middle line lies in its tile's lattice: pixel (column, row) = first + Y * step.
struct RunLine {
  float column, row, column_step, row_step;
  float from_Y, to_Y;  ///< as far as it lies within the tile
};

template <class P>
inline RunLine run_line(const TileTask& task, const TilePlaces& places, std::uint32_t r, float per_mm) {
  const TileLattice& l = *task.lattice;
  const TileRun& run = task.runs[r];
  const double det = l.column_x * l.row_y - l.column_y * l.row_x, per = det != 0 ? 1 / det : 0;
  const auto column_of = [&](double x, double y) { return static_cast<float>((x * l.row_y - y * l.row_x) * per); };
  const auto row_of = [&](double x, double y) { return static_cast<float>((y * l.column_x - x * l.column_y) * per); };
  const double back = -run.t_origin / per_mm, x = back * run.across_x - l.first_x, y = back * run.across_y - l.first_y;
  RunLine out{column_of(x, y),
              row_of(x, y),
              column_of(-run.across_y / per_mm, run.across_x / per_mm),
              row_of(-run.across_y / per_mm, run.across_x / per_mm),
              run.first_end,
              run.second_end};
  const auto clip = [&](float at, float step) {
    if (std::abs(step) < 1e-12F) return;
    const float a = (-0.5F - at) / step, b = (kTile - 0.5F - at) / step;
    out.from_Y = std::max(out.from_Y, std::min(a, b));
    out.to_Y = std::min(out.to_Y, std::max(a, b));
  };
  clip(out.column, out.column_step);
  clip(out.row, out.row_step);
  if (!(out.from_Y <= out.to_Y)) {  // its middle line is not in the tile: a pixel of it is
    const std::uint16_t place = places.place[places.begin[r]];
    const float c = static_cast<float>(place % kTile) - out.column, d = static_cast<float>(place / kTile) - out.row;
    const float size = out.column_step * out.column_step + out.row_step * out.row_step;
    const float Y = size > 0 ? (c * out.column_step + d * out.row_step) / size : 0;
    out.from_Y = out.to_Y = std::min(std::max(Y, run.first_end), run.second_end);
  }
  return out;
}

template <class P, int kSets>
inline void make_curves_of(const CurveTables& tables, const TileTask& task, const TilePlaces& places, int left, int top,
                           TileCurves& to) {
  constexpr float kKnot = 0.15F;  // of the roughness: by how much h may turn from a knot to the next
  constexpr int kMostSteps = 64;
  to.curve_floats = tables.row_floats;
  to.knot_floats = kSets * to.curve_floats;
  to.half_count = tables.half_count;
  to.step = tables.step;
  to.grow_runs(task.run_count + 16);
  std::size_t knots = 0;
  RoughnessShares rough;
  if (task.shapes.shared) rough = roughness_shares<P>(tables, task.shapes[0].alpha);
  KnotPlaces stencil;
  for (std::uint32_t r = 0; r < task.run_count; ++r) {
    RunCurve& run = to.runs[r];
    run = {};
    if (places.begin[r + 1] == places.begin[r]) continue;
    const RunShape& shape = task.shapes[r];
    if (!task.shapes.shared) rough = roughness_shares<P>(tables, shape.alpha);
    // Directions over half a turn; beyond it the curve is the same the other way round.
    const float x = task.runs[r].across_x, y = task.runs[r].across_y;
    const float sign = y < 0 ? -1.0F : 1.0F, per_direction = static_cast<float>(tables.directions) * 0.318309886F;
    const float place = azimuth_of<P>(sign * x, sign * y) * per_direction;
    const int direction = std::min(static_cast<int>(place), tables.directions - 1);
    float share[4], slope[4];
    lagrange<P>(place - static_cast<float>(direction), share, slope);
    for (float& s : slope) s *= per_direction;
    const RunLine line = run_line<P>(task, places, r, shape.per_mm);
    const float length = line.to_Y - line.from_Y;
    const float turned = length * std::hypot(line.column_step, line.row_step) *
                         static_cast<float>(tables.lean_per_pixel) / (kKnot * shape.alpha);
    const int steps = turned < 0.2F ? 0 : std::min(kMostSteps, static_cast<int>(std::ceil(turned)));
    run.number = sign * static_cast<float>(knots + 1);
    run.first_Y = line.from_Y;
    run.knots_per_Y = steps > 0 ? static_cast<float>(steps) / length : 0;
    run.last = static_cast<float>(std::max(0, steps - 1));
    // A knot more, which is read where the share of the next is 0.
    to.grow_knots((knots + steps + 2) * to.knot_floats);
    for (int k = 0; k <= steps; ++k, ++knots) {
      const float Y = line.from_Y + length * (steps > 0 ? static_cast<float>(k) / static_cast<float>(steps) : 0.5F);
      find_places<P>(tables, static_cast<float>(left) + line.column + Y * line.column_step,
                     static_cast<float>(top) + line.row + Y * line.row_step, direction - 1, stencil);
      float* at = &to.knots[knots * to.knot_floats];
      std::fill_n(at, to.knot_floats, 0.0F);
      sum_knot<P, kSets>(tables, stencil, share, slope, rough, at);
    }
  }
  to.grow_knots((knots + 1) * to.knot_floats);
  std::fill_n(to.knots.begin() + static_cast<std::ptrdiff_t>(knots * to.knot_floats), to.knot_floats, 0.0F);
  std::fill_n(to.runs.begin() + task.run_count, 16, RunCurve{});
}

/// Implements CurveKernels::make_curves.
template <class P>
inline void make_curves(const CurveTables& tables, const TileTask& task, const TilePlaces& places, int left, int top,
                        TileCurves& to) {
  switch (task.mode) {
    case KernelMode::value:
      return make_curves_of<P, 1>(tables, task, places, left, top, to);
    case KernelMode::ends:
      return make_curves_of<P, 2>(tables, task, places, left, top, to);
    case KernelMode::material:
      return make_curves_of<P, 3>(tables, task, places, left, top, to);
  }
}

}  // namespace burin::kernel
