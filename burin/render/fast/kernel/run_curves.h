// burin/render/fast/kernel/run_curves.h - the curves of a tile's runs, at a few places along each
// (burin/render/fast/curve_tables.h). docs/model.md 10.12.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "burin/render/fast/curve_tables.h"
#include "burin/render/fast/kernel/work.h"
#include "burin/render/surroundings/lagrange_cubic.h"

namespace burin::kernel {

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
    lagrange_cubic<float, P>(at - static_cast<float>(first) - 1, share, slope);
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
  bool begun = false;
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
        save(at, !begun ? P(by * what) : xsimd::fma(by, what, load<P>(at)));
      };
      add(0, whole, value);
      if constexpr (kSets > 1) add(1, whole, turn);
      if constexpr (kSets > 2) add(2, by_alpha, value);
    }
    begun = true;
  }
}

/// A tile's own curves, where the half vector turns so little in it that light is linear over it: of each direction
/// that a run has asked for, three rows, at the tile's middle and by a column and a row.
template <class P>
class TileRows {
 public:
  TileRows(const CurveTables& tables, int left, int top, TileCurves& to)
      : tables_(tables), to_(to), row_floats_(tables.row_floats), directions_(tables.directions + 3) {
    to.start_rows(directions_ * tables.log_alpha.size(), 3 * row_floats_);
    // The picture may end within the tile, and the tables with it.
    const auto axis = [](int from, int count, double per_pixel, float& middle, float& half) {
      const float last = per_pixel > 0 ? static_cast<float>((count - 1) / per_pixel) : 0;
      half = 0.5F * std::max(1.0F, std::min(kTile - 1.0F, last - static_cast<float>(from)));
      middle = static_cast<float>(from) + half;
    };
    float half[2] = {};
    axis(left, tables.columns, tables.columns_per_pixel, middle_column, half[0]);
    axis(top, tables.rows, tables.rows_per_pixel, middle_row, half[1]);
    for (int corner = 0; corner < 4; ++corner) {
      const float x = corner % 2 == 0 ? -1.0F : 1.0F, y = corner / 2 == 0 ? -1.0F : 1.0F;
      KnotPlaces at;
      find_places<P>(tables, middle_column + half[0] * x, middle_row + half[1] * y, -1, at);
      for (int k = 0; k < at.count; ++k) {
        int same = 0;
        while (same < count_ && place_[same] != at.at[k]) ++same;
        if (same == count_) {
          place_[count_] = at.at[k];
          share_[0][count_] = share_[1][count_] = share_[2][count_] = 0;
          ++count_;
        }
        share_[0][same] += 0.25F * at.share[k];
        share_[1][same] += 0.25F * x / half[0] * at.share[k];
        share_[2][same] += 0.25F * y / half[1] * at.share[k];
      }
    }
  }

  float middle_column = 0, middle_row = 0;  ///< of the tile, in the picture

  /// Of four directions from `direction` on (-1 is the first), at a roughness.
  const float* of(int direction, int roughness) {
    const std::size_t first = static_cast<std::size_t>(roughness) * directions_ + direction + 1;
    for (std::size_t d = first; d < first + 4; ++d)
      if (to_.row_made[d] == 0) make(d);
    return to_.rows.data() + first * 3 * row_floats_;
  }

 private:
  BURIN_FLATTEN void make(std::size_t d) {
    to_.row_made[d] = 1;
    const std::size_t places = static_cast<std::size_t>(tables_.columns) * tables_.rows;
    const std::size_t from =
        d / directions_ * places * tables_.place_floats() + d % directions_ * static_cast<std::size_t>(row_floats_);
    float* at = to_.rows.data() + d * 3 * row_floats_;
    for (std::size_t i = 0; i < row_floats_; i += kLanesOf<P>) {
      P v[3] = {P(0.0F), P(0.0F), P(0.0F)};
      for (int k = 0; k < count_; ++k) {
        const P row = load<P>(place_[k] + from + i);
        for (int j = 0; j < 3; ++j) v[j] = xsimd::fma(P(share_[j][k]), row, v[j]);
      }
      for (int j = 0; j < 3; ++j) save(at + j * row_floats_ + i, v[j]);
    }
  }

  const CurveTables& tables_;
  TileCurves& to_;
  const std::size_t row_floats_, directions_;
  const float* place_[64];
  float share_[3][64];
  int count_ = 0;
};

/// As sum_knot(), of kKnots knots at once, from a tile's own rows. `column`, `row`: of the knots, from the tile's
/// middle.
template <class P, int kSets, int kKnots>
BURIN_FLATTEN inline void sum_tile_knots(TileRows<P>& rows, int direction, std::size_t floats, const float* column,
                                         const float* row, const float (&share)[4], const float (&slope)[4],
                                         const RoughnessShares& rough, float* to) {
  bool begun = false;
  for (int r = 0; r < rough.count; ++r) {
    if (kSets < 3 && rough.share[r] == 0) continue;
    const P whole(rough.share[r]), by_alpha(rough.slope[r]);
    const float* const first = rows.of(direction, rough.first + r);
    for (std::size_t i = 0; i < floats; i += kLanesOf<P>) {
      P value[kKnots], turn[kKnots];
      for (int k = 0; k < kKnots; ++k) value[k] = turn[k] = P(0.0F);
      for (int d = 0; d < 4; ++d) {
        const float* from = first + 3 * d * floats + i;
        const P middle = load<P>(from), by_column = load<P>(from + floats), by_row = load<P>(from + 2 * floats);
        for (int k = 0; k < kKnots; ++k) {
          const P v = xsimd::fma(P(column[k]), by_column, xsimd::fma(P(row[k]), by_row, middle));
          value[k] = xsimd::fma(P(share[d]), v, value[k]);
          if constexpr (kSets > 1) turn[k] = xsimd::fma(P(slope[d]), v, turn[k]);
        }
      }
      for (int k = 0; k < kKnots; ++k) {
        float* at = to + k * kSets * floats + i;
        const auto add = [&](int set, const P& by, const P& what) {
          save(at + set * floats, !begun ? P(by * what) : xsimd::fma(by, what, load<P>(at + set * floats)));
        };
        add(0, whole, value[k]);
        if constexpr (kSets > 1) add(1, whole, turn[k]);
        if constexpr (kSets > 2) add(2, by_alpha, value[k]);
      }
    }
    begun = true;
  }
}

/// How a run's middle line lies in its tile's lattice: pixel (column, row) = first + Y * step.
struct RunLine {
  float column, row, column_step, row_step;
  float pixels_per_Y;
  float from_Y, to_Y;  ///< as far as it lies within the tile
};

/// From mm to the lattice.
struct FromMm {
  float column_x, column_y, row_x, row_y, first_x, first_y;

  explicit FromMm(const TileLattice& l) {
    const double det = l.column_x * l.row_y - l.column_y * l.row_x, per = det != 0 ? 1 / det : 0;
    column_x = static_cast<float>(l.row_y * per);
    column_y = static_cast<float>(-l.row_x * per);
    row_x = static_cast<float>(-l.column_y * per);
    row_y = static_cast<float>(l.column_x * per);
    first_x = static_cast<float>(l.first_x);
    first_y = static_cast<float>(l.first_y);
  }
};

template <class P>
[[gnu::always_inline]] inline RunLine run_line(const TileRun& run, const FromMm& m, float mm,
                                               const std::uint16_t first_place) {
  const float x = -run.t_origin * mm * run.across_x - m.first_x, y = -run.t_origin * mm * run.across_y - m.first_y,
              dx = -run.across_y * mm, dy = run.across_x * mm;
  RunLine out{m.column_x * x + m.column_y * y,
              m.row_x * x + m.row_y * y,
              m.column_x * dx + m.column_y * dy,
              m.row_x * dx + m.row_y * dy,
              0,
              run.first_end,
              run.second_end};
  const float size = out.column_step * out.column_step + out.row_step * out.row_step;
  out.pixels_per_Y = std::sqrt(size);
  const auto clip = [&](float at, float step) {
    const float per = std::abs(step) > 1e-12F ? 1 / step : 1e12F;
    const float a = (-0.5F - at) * per, b = (kTile - 0.5F - at) * per;
    out.from_Y = std::max(out.from_Y, std::min(a, b));
    out.to_Y = std::min(out.to_Y, std::max(a, b));
  };
  clip(out.column, out.column_step);
  clip(out.row, out.row_step);
  if (!(out.from_Y <= out.to_Y)) {  // its middle line is not in the tile: a pixel of it is
    const auto column = first_place % kTile, row = first_place / kTile;
    const float c = static_cast<float>(column) - out.column, d = static_cast<float>(row) - out.row;
    const float Y = size > 0 ? (c * out.column_step + d * out.row_step) / size : 0;
    out.from_Y = out.to_Y = std::min(std::max(Y, run.first_end), run.second_end);
  }
  return out;
}

/// Over half a turn; beyond it the curve is the same the other way round.
struct RunDirection {
  float sign;
  int first;                 ///< of the four neighbors, -1 or more
  float share[4], slope[4];  ///< by radians
};
template <class P>
[[gnu::always_inline]] inline RunDirection run_direction(const TileRun& run, int directions) {
  RunDirection out;
  out.sign = run.across_y < 0 ? -1.0F : 1.0F;
  const float per_direction = static_cast<float>(directions) * 0.318309886F;
  const float place = azimuth_of<P>(out.sign * run.across_x, out.sign * run.across_y) * per_direction;
  const int below = std::min(static_cast<int>(place), directions - 1);
  out.first = below - 1;
  lagrange_cubic<float, P>(place - static_cast<float>(below), out.share, out.slope);
  for (float& s : out.slope) s *= per_direction;
  return out;
}

/// By what share the light of a whole groove, from rim to rim, grows by a unit of Y. `last`: its last node's place in a
/// row.
template <class P>
inline float growth(TileRows<P>& rows, const RunDirection& direction, const RoughnessShares& rough, std::size_t floats,
                    std::size_t last, float column, float row, const RunLine& line) {
  float sum[3] = {};
  for (int r = 0; r < rough.count; ++r) {
    if (rough.share[r] == 0) continue;
    const float* from = rows.of(direction.first, rough.first + r) + 1;
    for (int d = 0; d < 4; ++d)
      for (int j = 0; j < 3; ++j, from += floats)
        sum[j] += rough.share[r] * direction.share[d] * (from[last] - from[0]);
  }
  const float all = sum[0] + column * sum[1] + row * sum[2];
  return all > 0 ? (sum[1] * line.column_step + sum[2] * line.row_step) / all : 0;
}

template <class P, int kSets>
inline void make_curves_of(const CurveTables& tables, const TileTask& task, const TilePlaces& places, int left, int top,
                           TileCurves& to) {
  constexpr float kKnot = 0.15F;                // of the roughness: by how much h may turn from a knot to the next
  constexpr float kLinear = 0.2F;               // the same over a tile with rows of its own
  constexpr float kLone = 0.7F, kStill = 0.2F;  // of that: one knot will do, scaled or as it is
  constexpr int kMostSteps = 64;
  const std::size_t floats = tables.row_floats;
  to.curve_floats = floats;
  to.knot_floats = kSets * floats;
  to.half_count = tables.half_count;
  to.step = tables.step;
  to.grow_runs(task.run_count + 16);
  const auto lean = static_cast<float>(tables.lean_per_pixel);
  const bool linear = kTile * lean < kLinear * std::exp(tables.log_alpha.front());
  std::optional<TileRows<P>> rows;
  if (linear) rows.emplace(tables, left, top, to);
  const FromMm from_mm(*task.lattice);
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
    const RunDirection direction = run_direction<P>(task.runs[r], tables.directions);
    const RunLine line = run_line<P>(task.runs[r], from_mm, 1 / shape.per_mm, places.place[places.begin[r]]);
    const float length = line.to_Y - line.from_Y;
    const float turned = length * line.pixels_per_Y * lean / (kKnot * shape.alpha);
    const int steps = turned < (linear ? kLone : kStill) ? 0 : std::min(kMostSteps, static_cast<int>(turned) + 1);
    run.number = direction.sign * static_cast<float>(knots + 1);
    run.first_Y = line.from_Y;
    run.per_Y = steps > 0 ? static_cast<float>(steps) / length : 0;
    run.last = static_cast<float>(steps - 1);
    // A knot more, which is read where the share of the next is 0.
    to.grow_knots((knots + steps + 2) * to.knot_floats);
    const float step = steps > 0 ? length / static_cast<float>(steps) : 0,
                first = steps > 0 ? line.from_Y : line.from_Y + 0.5F * length;
    for (int k = 0; k <= steps;) {
      float* at = &to.knots[knots * to.knot_floats];
      const float Y[2] = {first + static_cast<float>(k) * step, first + static_cast<float>(k + 1) * step};
      float column[2], row[2];
      for (int j = 0; j < 2; ++j) {
        column[j] = line.column + Y[j] * line.column_step;
        row[j] = line.row + Y[j] * line.row_step;
      }
      if (!linear) {
        find_places<P>(tables, static_cast<float>(left) + column[0], static_cast<float>(top) + row[0], direction.first,
                       stencil);
        sum_knot<P, kSets>(tables, stencil, direction.share, direction.slope, rough, at);
        ++k;
        ++knots;
        continue;
      }
      for (int j = 0; j < 2; ++j) {
        column[j] += static_cast<float>(left) - rows->middle_column;
        row[j] += static_cast<float>(top) - rows->middle_row;
      }
      const auto sum = [&]<int kKnots>(std::integral_constant<int, kKnots>) {
        sum_tile_knots<P, kSets, kKnots>(*rows, direction.first, floats, column, row, direction.share, direction.slope,
                                         rough, at);
        k += kKnots;
        knots += kKnots;
      };
      if (steps == 0) {
        run.first_Y = first;
        run.per_Y =
            growth(*rows, direction, rough, floats, std::size_t{6} * tables.half_count, column[0], row[0], line);
      }
      if (k < steps)
        sum(std::integral_constant<int, 2>{});
      else
        sum(std::integral_constant<int, 1>{});
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
