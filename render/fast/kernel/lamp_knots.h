// burin/render/fast/kernel/lamp_knots.h - the curves of a tile's strips under a lamp, made at a few positions along
// each (burin/render/fast/lamp_curves.h). docs/model.md 8.6.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "burin/render/fast/kernel/run_curves.h"
#include "burin/render/fast/kernel/work.h"
#include "burin/render/fast/lamp_curves.h"

namespace burin::kernel {

/// One point of the lamp for one position on a strip: the half vector in the strip's frame (x across, y along), the
/// factor of D, and its derivative by alpha (d log / d alpha).
struct SeenPoint {
  float h_x, h_y, h_z, strength, by_alpha;
};
inline SeenPoint seen_point(const LampFit& fit, float column, float row, float across_x, float across_y, float alpha) {
  const float c = (column - 0.5F * (kTile - 1)) * (2.0F / kTile), r = (row - 0.5F * (kTile - 1)) * (2.0F / kTile);
  const float powers[6] = {1, c, r, c * c, c * r, r * r};
  const auto value = [&](const float(&of)[6]) {
    float sum = 0;
    for (int i = 0; i < 6; ++i) sum += powers[i] * of[i];
    return sum;
  };
  const float x = value(fit.h_x), y = value(fit.h_y);
  const float tan2[2] = {std::max(0.0F, value(fit.tan2_i)), std::max(0.0F, value(fit.tan2_o))};
  SeenPoint out{across_x * x + across_y * y, across_x * y - across_y * x,
                std::sqrt(std::max(1 - x * x - y * y, 1e-12F)), value(fit.strength), 0};
  for (const float t : tan2) {
    const float root = std::sqrt(1 + alpha * alpha * t);
    out.strength *= 2 / (1 + root);
    out.by_alpha -= alpha * t / (root * (1 + root));
  }
  return out;
}

/// Adds the light of one point on a section's walls to `to`. Each set has rows of R and its derivatives: by the strip's
/// turn, by alpha, and by h across and along the strip. The third component of h follows.
template <class P, int kSets>
BURIN_FLATTEN inline void add_light(const SectionLeans& leans, const SectionLeans::Part& part, const SeenPoint& h,
                                    float alpha, float across, float* to) {
  const int size = SectionLeans::kRows * leans.stride;
  const P zero(0.0F), along2(1 / (alpha * alpha)), across2(1 / (across * across * alpha * alpha));
  const P x(h.h_x), y(h.h_y), z(h.h_z), y2 = y * y * along2, x_per_z(h.h_x / h.h_z), y_per_z(h.h_y / h.h_z);
  const P strength = P(h.strength * 0.318309886F / across) * along2, by_alpha(h.by_alpha), per_alpha(1 / alpha);
  for (int i = 0; i < size; i += kLanesOf<P>) {
    const P sine = load<P>(&part.sine[i]), cosine = load<P>(&part.cosine[i]);
    // docs/model.md 3.7, on a wall of this lean.
    const P m = xsimd::fma(x, cosine, z * sine), nh = xsimd::fms(z, cosine, x * sine);
    const P m2 = across2 * m * m, Q = xsimd::fma(nh, nh, m2 + y2), per_Q = inverse(Q);
    const P D = xsimd::select(nh > zero, strength * per_Q * per_Q, zero);
    save(to + i, load<P>(to + i) + D);
    if constexpr (kSets > 1) {
      const P by_turn = P(-4.0F) * D * per_Q * y * (across2 * m * cosine - along2 * x - nh * sine);
      save(to + size + i, load<P>(to + size + i) + by_turn);
    }
    if constexpr (kSets > 2) {
      const P slope = D * (per_alpha * (P(4.0F) * (m2 + y2) * per_Q - P(2.0F)) + by_alpha);
      save(to + 2 * size + i, load<P>(to + 2 * size + i) + slope);
    }
    if constexpr (kSets > 3) {
      const P by_D = P(-4.0F) * D * per_Q, by_z = across2 * m * sine + nh * cosine;
      save(to + 3 * size + i, load<P>(to + 3 * size + i) + by_D * (across2 * m * cosine - nh * sine - x_per_z * by_z));
      save(to + 4 * size + i, load<P>(to + 4 * size + i) + by_D * (along2 * y - y_per_z * by_z));
    }
  }
}

/// Converts rows of light to a curve's nodes.
template <class P>
BURIN_FLATTEN inline void make_nodes(const SectionLeans& leans, const float* light, float* to) {
  constexpr int kGauss = SectionLeans::kGauss;
  // Weights of the integral over a step, and of the mean of (1 - position) over it.
  constexpr float kShare[kGauss] = {0.17392742F, 0.32607258F, 0.32607258F, 0.17392742F};
  constexpr float kRest[kGauss] = {0.16185132F, 0.21846554F, 0.10760703F, 0.01207610F};
  const int stride = leans.stride, middle = leans.half_count, nodes = 2 * middle + 1;
  const P step2(leans.step * leans.step), half_step2 = P(0.5F) * step2;
  const float* const ends = light + static_cast<std::ptrdiff_t>(kGauss) * stride;
  alignas(64) float sums[kLanesOf<P>], rests[kLanesOf<P>], lights[kLanesOf<P>];
  // Increments of the integrals from node to node ...
  for (int i = 0; i < nodes; i += kLanesOf<P>) {
    P whole(0.0F), rest(0.0F);
    for (int j = 0; j < kGauss; ++j) {
      const P of = load<P>(light + static_cast<std::ptrdiff_t>(j) * stride + i);
      whole = xsimd::fma(P(kShare[j]), of, whole);
      rest = xsimd::fma(P(kRest[j]), of, rest);
    }
    (step2 * whole).store_aligned(sums);
    (step2 * rest).store_aligned(rests);
    (half_step2 * load<P>(ends + i)).store_aligned(lights);
    const int here = std::min(kLanesOf<P>, nodes - i);
    float* node = to + static_cast<std::ptrdiff_t>(kCurveNode) * i;
    for (int k = 0; k < here; ++k, node += kCurveNode) {
      node[0] = rests[k];
      node[1] = sums[k];
      node[2] = lights[k];
    }
  }
  // ... and their sums, from the middle to either side, because integrals lose digits far from their start.
  float sum = 0, sum_of_sums = 0;  // step times the integral, and the integral of that
  for (int k = middle; k < nodes; ++k) {
    float* const node = to + static_cast<std::ptrdiff_t>(kCurveNode) * k;
    const float rest = node[0], grows = node[1];
    node[0] = sum_of_sums;
    node[1] = sum;
    sum_of_sums += sum + rest;
    sum += grows;
  }
  sum = sum_of_sums = 0;
  for (int k = middle - 1; k >= 0; --k) {
    float* const node = to + static_cast<std::ptrdiff_t>(kCurveNode) * k;
    sum -= node[1];
    sum_of_sums -= sum + node[0];
    node[0] = sum_of_sums;
    node[1] = sum;
  }
}

/// True if two runs are on one line and have one curve.
inline bool same_line(const TileTask& task, std::uint32_t a, std::uint32_t b) {
  constexpr float kTurn = 1e-5F, kShift = 1e-3F;
  const TileRun &x = task.runs[a], &y = task.runs[b];
  const RunShape &s = task.shapes[a], &t = task.shapes[b];
  return s.part == t.part && s.alpha == t.alpha && s.per_mm == t.per_mm && std::abs(x.across_x - y.across_x) < kTurn &&
         std::abs(x.across_y - y.across_y) < kTurn && std::abs(x.t_origin - y.t_origin) < kShift;
}

template <class P, int kSets>
inline void make_lamp_curves_of(const LampCurves& lamp, const TileTask& task, const TilePlaces& places,
                                std::size_t tile, TileCurves& to) {
  constexpr float kKnot = 0.06F;  // of the roughness: largest turn of h between knots
  constexpr int kMostSteps = 64;
  const SectionLeans& leans = lamp.leans;
  const int size = SectionLeans::kRows * leans.stride, nodes = 2 * leans.half_count + 1;
  to.half_count = leans.half_count;
  to.step = leans.step;
  to.curve_floats = (static_cast<std::size_t>(kCurveNode) * nodes + 16) / 16 * 16;
  to.knot_floats = kSets * to.curve_floats;
  to.grow_runs(task.run_count + 16);
  make_run_paths<P>(task, places, 0.0F, to);
  to.grow_rows(static_cast<std::size_t>(kSets) * size);
  const LampFit* const points = lamp.fits.of(tile);
  const auto has_pairs = [&](std::uint32_t r) { return places.begin[r + 1] != places.begin[r]; };
  std::size_t knots = 0;
  std::fill_n(to.runs.begin(), task.run_count, RunCurve{});
  for (std::uint32_t r = 0; r < task.run_count;) {
    if (!has_pairs(r)) {
      ++r;
      continue;
    }
    // Successive runs may be pieces of one groove. They share their knots.
    const auto number = [&](std::uint32_t run, int what) { return to.lines[what * to.line_stride + run]; };
    float from = number(r, kFromY), until = from + number(r, kLength);
    std::uint32_t last = r + 1;
    for (; last < task.run_count && (!has_pairs(last) || same_line(task, r, last)); ++last) {
      if (!has_pairs(last)) continue;
      from = std::min(from, number(last, kFromY));
      until = std::max(until, number(last, kFromY) + number(last, kLength));
    }
    const TileRun& run = task.runs[r];
    const RunShape& shape = task.shapes[r];
    const SectionLeans::Part& part = leans.part[static_cast<int>(shape.part)];
    const auto seen_at = [&](const LampFit& fit, float Y) {
      return seen_point(fit, number(r, kFirstColumn) + Y * number(r, kColumnStep),
                        number(r, kFirstRow) + Y * number(r, kRowStep), run.across_x, run.across_y, shape.alpha);
    };
    const SeenPoint a = seen_at(points[0], from), b = seen_at(points[0], until);
    const float turned = std::sqrt((a.h_x - b.h_x) * (a.h_x - b.h_x) + (a.h_y - b.h_y) * (a.h_y - b.h_y));
    const float wanted = turned / (kKnot * shape.alpha * std::min(1.0F, lamp.across));
    const int steps = std::min(kMostSteps, static_cast<int>(wanted) + 1);
    const float length = until - from, step = length / static_cast<float>(steps);
    for (std::uint32_t k = r; k < last; ++k)
      if (has_pairs(k))
        to.runs[k] = {static_cast<float>(knots + 1), from, length > 0 ? static_cast<float>(steps) / length : 0.0F,
                      static_cast<float>(steps - 1)};
    // One more knot, which is read if the next one's share is 0.
    to.grow_knots((knots + steps + 2) * to.knot_floats);
    for (int k = 0; k <= steps; ++k, ++knots) {
      const float Y = from + static_cast<float>(k) * step;
      std::fill_n(to.rows.begin(), static_cast<std::ptrdiff_t>(kSets) * size, 0.0F);
      for (int p = 0; p < lamp.fits.points; ++p)
        add_light<P, kSets>(leans, part, seen_at(points[p], Y), shape.alpha, lamp.across, to.rows.data());
      for (int set = 0; set < kSets; ++set)
        make_nodes<P>(leans, to.rows.data() + static_cast<std::ptrdiff_t>(set) * size,
                      &to.knots[knots * to.knot_floats + set * to.curve_floats]);
    }
    r = last;
  }
  close_curves(task.run_count, knots, to);
}

/// Implements CurveKernels::make_lamp_curves.
template <class P>
inline void make_lamp_curves(const LampCurves& lamp, const TileTask& task, const TilePlaces& places, std::size_t tile,
                             TileCurves& to) {
  switch (task.mode) {
    case KernelMode::value:
      return make_lamp_curves_of<P, 1>(lamp, task, places, tile, to);
    case KernelMode::ends:
      return make_lamp_curves_of<P, 2>(lamp, task, places, tile, to);
    case KernelMode::material:
      return task.by_half_vector ? make_lamp_curves_of<P, 5>(lamp, task, places, tile, to)
                                 : make_lamp_curves_of<P, 3>(lamp, task, places, tile, to);
  }
}

}  // namespace burin::kernel
