// burin/render/fast/kernel/run_curves.h - the curves of a tile's runs, at a few positions along each
// (burin/render/fast/curve_tables.h). docs/model.md 10.12.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

#include "burin/render/fast/curve_tables.h"
#include "burin/render/fast/kernel/work.h"
#include "burin/render/surroundings/lagrange_cubic.h"

namespace burin::kernel {

/// atan2(y, x) of unit vectors with y >= 0, error 1e-5 (Abramowitz and Stegun, 4.4.49).
template <class P>
[[gnu::always_inline]] inline P azimuth_of(const P& x, const P& y) {
  const P half_turn(3.14159265F), ax = xsimd::abs(x);
  const P a = xsimd::min(ax, y) * inverse(xsimd::max(ax, y)), b = a * a;
  P series = xsimd::fma(b, P(0.0208351F), P(-0.085133F));
  series = xsimd::fma(b, series, P(0.180141F));
  series = xsimd::fma(b, series, P(-0.3302995F));
  const P part = a * xsimd::fma(b, series, P(0.999866F));
  const P first = xsimd::select(ax < y, P(1.57079633F) - part, part);
  return xsimd::select(x < P(0.0F), half_turn - first, first);
}

/// Tabulated curves that a knot interpolates: four directions of some places.
struct KnotPlaces {
  const std::int16_t* at[16];
  float share[16];
  int count = 0;

  /// Uses a single place, from direction -1.
  void hold(const CurveTables& tables, int column, int row) {
    at[0] = tables.data.data() + (static_cast<std::size_t>(row) * tables.columns + column) * tables.place_floats();
    share[0] = 1;
    count = 1;
  }
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

/// Roughnesses of a part's tables near a given one, with Lagrange weights in log(alpha) and their derivatives by alpha.
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

/// One knot's curves. kSets = 1: R; 2: also dR by the turn; 3: also dR by alpha.
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
        const std::int16_t* from = places.at[k] + table + i;
        const P by(places.share[k]);
        for (int d = 0; d < 4; ++d) v[d] = xsimd::fma(by, packet::load_shorts<P>(from + d * floats), v[d]);
      }
      const P unit = load<P>(&tables.unit[i]);
      P value = P(share[0]) * v[0], turn = P(slope[0]) * v[0];
      for (int d = 1; d < 4; ++d) {
        value = xsimd::fma(P(share[d]), v[d], value);
        turn = xsimd::fma(P(slope[d]), v[d], turn);
      }
      const auto add = [&](int set, const P& by, const P& what) {
        float* at = to + set * floats + i;
        save(at, !begun ? P(by * what) : xsimd::fma(by, what, load<P>(at)));
      };
      value *= unit;
      add(0, whole, value);
      if constexpr (kSets > 1) add(1, whole, unit * turn);
      if constexpr (kSets > 2) add(2, by_alpha, value);
    }
    begun = true;
  }
}

/// A tile's own curves, if the half vector turns so little in it that light is linear over it. Each requested direction
/// has three rows: at the tile's middle, by a column and by a row.
template <class P>
class TileRows {
 public:
  TileRows(const CurveTables& tables, int left, int top, TileCurves& to)
      : tables_(tables), to_(to), row_floats_(tables.row_floats), directions_(tables.directions + 3) {
    to.start_rows(directions_ * tables.tables(), 3 * row_floats_);
    const auto axis = [](const std::vector<float>& corners, int tile, float& middle, float& half) {
      middle = 0.5F * (corners[tile] + corners[tile + 1]);
      half = 0.5F * std::max(1.0F, corners[tile + 1] - corners[tile]);
    };
    float half[2] = {};
    axis(tables.column_corners, left / kTile, middle_column, half[0]);
    axis(tables.row_corners, top / kTile, middle_row, half[1]);
    for (int corner = 0; corner < 4; ++corner) {
      const float x = corner % 2 == 0 ? -1.0F : 1.0F, y = corner / 2 == 0 ? -1.0F : 1.0F;
      KnotPlaces at;
      if (tables.of_tiles)
        at.hold(tables, left / kTile + corner % 2, top / kTile + corner / 2);
      else
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

  /// Makes the requested rows in memory order, before the runs use them.
  void make_wanted(int roughness) {
    constexpr std::size_t kAhead = 3;
    const std::size_t first = static_cast<std::size_t>(roughness) * directions_;
    for (std::size_t d = 0; d < directions_; ++d) {
      if (d + kAhead < directions_ && to_.row_wanted[d + kAhead] != 0)
        for (int k = 0; k < count_; ++k)
          for (std::size_t i = 0; i < row_floats_; i += 32)
            __builtin_prefetch(place_[k] + table_of(roughness) + (d + kAhead) * row_floats_ + i);
      if (to_.row_wanted[d] != 0 && to_.row_made[first + d] == 0) make(first + d);
    }
  }

  /// Rows of four directions from `direction` on (-1 is the first), at a roughness.
  const float* of(int direction, int roughness) {
    const std::size_t first = place(direction, roughness);
    for (std::size_t d = first; d < first + 4; ++d)
      if (to_.row_made[d] == 0) make(d);
    return to_.rows.data() + first * 3 * row_floats_;
  }
  /// Light of these rows over the whole groove, from rim to rim: at the middle, by a column, by a row; the fourth is
  /// unused.
  const float* light_of(int direction, int roughness) const {
    return to_.row_light.data() + 4 * place(direction, roughness);
  }

 private:
  std::size_t place(int direction, int roughness) const {
    return static_cast<std::size_t>(roughness) * directions_ + direction + 1;
  }

  std::size_t table_of(std::size_t roughness) const {
    return roughness * tables_.columns * tables_.rows * tables_.place_floats();
  }

  BURIN_FLATTEN void make(std::size_t d) {
    to_.row_made[d] = 1;
    const std::size_t from = table_of(d / directions_) + d % directions_ * row_floats_;
    float* at = to_.rows.data() + d * 3 * row_floats_;
    for (std::size_t i = 0; i < row_floats_; i += kLanesOf<P>) {
      P v[3] = {P(0.0F), P(0.0F), P(0.0F)};
      for (int k = 0; k < count_; ++k) {
        const P row = packet::load_shorts<P>(place_[k] + from + i);
        for (int j = 0; j < 3; ++j) v[j] = xsimd::fma(P(share_[j][k]), row, v[j]);
      }
      const P unit = load<P>(&tables_.unit[i]);
      for (int j = 0; j < 3; ++j) save(at + j * row_floats_ + i, P(unit * v[j]));
    }
    // The second number of a node is the integral up to the node.
    const std::size_t last = static_cast<std::size_t>(2 * kCurveNode) * tables_.half_count;
    for (int j = 0; j < 3; ++j, at += row_floats_) to_.row_light[4 * d + j] = at[last + 1] - at[1];
  }

  const CurveTables& tables_;
  TileCurves& to_;
  const std::size_t row_floats_, directions_;
  const std::int16_t* place_[64];
  float share_[3][64];
  int count_ = 0;
};

/// sum_knot() for kKnots knots at once, from a tile's own rows. `column`, `row`: of the knots, from the tile's middle.
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

/// Map from mm to the lattice.
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

/// Constants of a run for its curves, in TileCurves::lines. Directions of grooves cover half a turn; beyond it the
/// curve is reversed. On the tile's lattice the middle line is pixel (column, row) = first + Y step.
enum RunNumber : std::uint8_t {
  kSign,
  kDirection,                 ///< first of the four neighbors, at least -1
  kShare,                     ///< weights of the four
  kSlope = kShare + 4,        ///< their derivatives, per radian
  kFirstColumn = kSlope + 4,  ///< at Y = 0
  kFirstRow,                  ///< at Y = 0
  kColumnStep,                ///< per unit of Y
  kRowStep,                   ///< per unit of Y
  kFromY,                     ///< entry into the tile
  kLength,                    ///< in Y, within the tile
  kTurned,                    ///< turn of h over this length, in units of the roughness
  kRunNumbers
};
static_assert(kRunNumbers <= TileCurves::kMostLines);

/// Paths of the tile's runs: kFirstColumn to kTurned.
template <class P>
BURIN_FLATTEN inline void make_run_paths(const TileTask& task, const TilePlaces& places, float lean_per_pixel,
                                         TileCurves& to) {
  const FromMm m(*task.lattice);
  const P zero(0.0F), lean(lean_per_pixel);
  for (std::uint32_t first = 0; first < task.run_count; first += kLanesOf<P>) {
    const auto number = [&](int k) { return std::min<std::uint32_t>(first + k, task.run_count - 1); };
    const auto put = [&](int what, const P& v) { save(&to.lines[what * to.line_stride + first], v); };
    P run[8], shape[4] = {P(task.shapes[0].per_mm), zero, P(task.shapes[0].alpha)};
    for (const int i : {0, 4}) packet::four_columns(run + i, [&](int k) { return &task.runs[number(k)].across_x + i; });
    if (!task.shapes.shared) packet::four_columns(shape, [&](int k) { return &task.shapes[number(k)].per_mm; });
    const P mm = inverse(shape[0]), x = -run[2] * mm * run[0] - P(m.first_x), y = -run[2] * mm * run[1] - P(m.first_y);
    const P dx = -run[1] * mm, dy = run[0] * mm;
    const P column = P(m.column_x) * x + P(m.column_y) * y, row = P(m.row_x) * x + P(m.row_y) * y;
    const P column_step = P(m.column_x) * dx + P(m.column_y) * dy, row_step = P(m.row_x) * dx + P(m.row_y) * dy;
    const P size = column_step * column_step + row_step * row_step;
    P from = run[3], until = run[4];
    const auto clip = [&](const P& at, const P& step) {
      const P per = xsimd::select(xsimd::abs(step) > P(1e-12F), inverse(step), P(1e12F));
      const P a = (P(-0.5F) - at) * per, b = (P(kTile - 0.5F) - at) * per;
      from = xsimd::max(from, xsimd::min(a, b));
      until = xsimd::min(until, xsimd::max(a, b));
    };
    clip(column, column_step);
    clip(row, row_step);
    // If the middle line misses the tile, use a pixel of the run.
    alignas(64) std::uint16_t pixel[kLanesOf<P>];
    for (int k = 0; k < kLanesOf<P>; ++k) pixel[k] = places.place[places.begin[number(k)]];
    P pixel_column, pixel_row;
    packet::columns_and_rows(pixel, pixel_column, pixel_row);
    const P foot = xsimd::select(
        size > zero, ((pixel_column - column) * column_step + (pixel_row - row) * row_step) * inverse(size), zero);
    const P beside = xsimd::min(xsimd::max(foot, run[3]), run[4]);
    const MaskOf<P> within = from <= until;
    from = xsimd::select(within, from, beside);
    const P length = xsimd::select(within, until - from, zero);
    put(kFirstColumn, column);
    put(kFirstRow, row);
    put(kColumnStep, column_step);
    put(kRowStep, row_step);
    put(kFromY, from);
    put(kLength, length);
    put(kTurned, length * xsimd::sqrt(size) * lean * inverse(shape[2]));
  }
}

/// Constants of the tile's runs for tables of directions: kSign to kSlope.
template <class P>
BURIN_FLATTEN inline void make_run_directions(const CurveTables& tables, const TileTask& task, TileCurves& to) {
  const P zero(0.0F), one(1.0F);
  const P directions(static_cast<float>(tables.directions)), per_direction = directions * P(0.318309886F);
  for (std::uint32_t first = 0; first < task.run_count; first += kLanesOf<P>) {
    const auto number = [&](int k) { return std::min<std::uint32_t>(first + k, task.run_count - 1); };
    const auto put = [&](int what, const P& v) { save(&to.lines[what * to.line_stride + first], v); };
    P run[4];
    packet::four_columns(run, [&](int k) { return &task.runs[number(k)].across_x; });

    const P sign = xsimd::select(run[1] < zero, -one, one);
    const P place = azimuth_of<P>(sign * run[0], sign * run[1]) * per_direction;
    const P below = xsimd::min(xsimd::floor(place), directions - one);
    P share[4], slope[4];
    lagrange_cubic<P, P>(place - below, share, slope);
    put(kSign, sign);
    put(kDirection, below - one);
    for (int d = 0; d < 4; ++d) {
      put(kShare + d, share[d]);
      put(kSlope + d, slope[d] * per_direction);
    }
  }
}

/// Appends a dark knot, which is read if the next one's share is 0, and runs to fill a SIMD vector.
inline void close_curves(std::uint32_t run_count, std::size_t knots, TileCurves& to) {
  to.grow_knots((knots + 1) * to.knot_floats);
  std::fill_n(to.knots.begin() + static_cast<std::ptrdiff_t>(knots * to.knot_floats), to.knot_floats, 0.0F);
  std::fill_n(to.runs.begin() + run_count, 16, RunCurve{});
}

/// Relative growth per unit of Y of a whole groove's light, from rim to rim. `light`: light at the tile's middle, and
/// its change by a column and a row (of four directions). `column`, `row`: position from the tile's middle.
inline float growth(const float (&light)[3], float column, float row, float column_step, float row_step) {
  const float all = light[0] + column * light[1] + row * light[2];
  return all > 0 ? (light[1] * column_step + light[2] * row_step) / all : 0;
}

template <class P, int kSets>
inline void make_curves_of(const CurveTables& tables, const TileTask& task, const TilePlaces& places, int left, int top,
                           TileCurves& to) {
  constexpr float kKnot = 0.15F;                // of the roughness: largest turn of h between knots
  constexpr float kLone = 0.7F, kStill = 0.2F;  // of kKnot: limits for a single knot, scaled or constant
  constexpr int kMostSteps = 64;
  const std::size_t floats = tables.row_floats;
  to.curve_floats = floats;
  to.knot_floats = kSets * floats;
  to.half_count = tables.half_count;
  to.step = tables.step;
  to.grow_runs(task.run_count + 16);
  make_run_directions<P>(tables, task, to);
  make_run_paths<P>(task, places, static_cast<float>(tables.lean_per_pixel), to);
  const bool linear = tables.linear_over_tiles;
  RoughnessShares rough;
  if (task.shapes.shared) rough = roughness_shares<P>(tables, task.shapes[0].alpha);
  std::optional<TileRows<P>> rows;
  if (linear) {
    rows.emplace(tables, left, top, to);
    if (task.shapes.shared) {
      const float* direction = &to.lines[kDirection * to.line_stride];
      for (std::uint32_t r = 0; r < task.run_count; ++r)
        if (places.begin[r + 1] != places.begin[r])
          std::memset(&to.row_wanted[static_cast<std::size_t>(direction[r] + 1)], 1, 4);
      for (int k = 0; k < rough.count; ++k)
        if (kSets == 3 || rough.share[k] != 0) rows->make_wanted(rough.first + k);
    }
  }
  std::size_t knots = 0;
  KnotPlaces stencil;
  for (std::uint32_t r = 0; r < task.run_count; ++r) {
    RunCurve& run = to.runs[r];
    run = {};
    if (places.begin[r + 1] == places.begin[r]) continue;
    if (!task.shapes.shared) {
      rough = roughness_shares<P>(tables, task.shapes[r].alpha);
      rough.first += static_cast<int>(task.shapes[r].part) * static_cast<int>(tables.log_alpha.size());
    }
    const float* const line = &to.lines[r];
    const auto number = [&](int what) { return line[what * to.line_stride]; };
    const int direction = static_cast<int>(number(kDirection));
    float share[4], slope[4];
    for (int d = 0; d < 4; ++d) {
      share[d] = number(kShare + d);
      slope[d] = number(kSlope + d);
    }
    const float from_Y = number(kFromY), length = number(kLength), turned = number(kTurned) / kKnot;
    const float column_step = number(kColumnStep), row_step = number(kRowStep);
    const int steps = turned < (linear ? kLone : kStill) ? 0 : std::min(kMostSteps, static_cast<int>(turned) + 1);
    run.number = number(kSign) * static_cast<float>(knots + 1);
    run.first_Y = from_Y;
    run.per_Y = steps > 0 ? static_cast<float>(steps) / length : 0;
    run.last = static_cast<float>(steps - 1);
    // One more knot, which is read if the next one's share is 0.
    to.grow_knots((knots + steps + 2) * to.knot_floats);
    const float step = steps > 0 ? length / static_cast<float>(steps) : 0,
                first = steps > 0 ? from_Y : from_Y + 0.5F * length;
    for (int k = 0; k <= steps;) {
      float* at = &to.knots[knots * to.knot_floats];
      const float Y[2] = {first + static_cast<float>(k) * step, first + static_cast<float>(k + 1) * step};
      float column[2], row[2];
      for (int j = 0; j < 2; ++j) {
        column[j] = number(kFirstColumn) + Y[j] * column_step;
        row[j] = number(kFirstRow) + Y[j] * row_step;
      }
      if (!linear) {
        find_places<P>(tables, static_cast<float>(left) + column[0], static_cast<float>(top) + row[0], direction,
                       stencil);
        sum_knot<P, kSets>(tables, stencil, share, slope, rough, at);
        ++k;
        ++knots;
        continue;
      }
      for (int j = 0; j < 2; ++j) {
        column[j] += static_cast<float>(left) - rows->middle_column;
        row[j] += static_cast<float>(top) - rows->middle_row;
      }
      const auto sum = [&]<int kKnots>(std::integral_constant<int, kKnots>) {
        sum_tile_knots<P, kSets, kKnots>(*rows, direction, floats, column, row, share, slope, rough, at);
        k += kKnots;
        knots += kKnots;
      };
      if (k < steps)
        sum(std::integral_constant<int, 2>{});
      else
        sum(std::integral_constant<int, 1>{});
      if (steps > 0) continue;
      float light[3] = {};
      for (int q = 0; q < rough.count; ++q) {
        if (rough.share[q] == 0) continue;
        const float* of = rows->light_of(direction, rough.first + q);
        for (int d = 0; d < 4; ++d)
          for (int j = 0; j < 3; ++j) light[j] += rough.share[q] * share[d] * of[4 * d + j];
      }
      run.first_Y = first;
      run.per_Y = growth(light, column[0], row[0], column_step, row_step);
    }
  }
  close_curves(task.run_count, knots, to);
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
