#include "optimize/start.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "render/error.h"

namespace burin {
namespace {

double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

// Board to pixels of the grid.
struct Grid {
  Eigen::Vector2d min_mm, max_mm;
  int width, height;

  double pitch_x() const { return (max_mm.x() - min_mm.x()) / width; }
  double pitch_y() const { return (max_mm.y() - min_mm.y()) / height; }
  Eigen::Vector2d pixel(const Eigen::Vector2d& p) const {
    return {(p.x() - min_mm.x()) / pitch_x() - 0.5, (max_mm.y() - p.y()) / pitch_y() - 0.5};
  }
  Eigen::Vector2d board(double x, double y) const {
    return {min_mm.x() + (x + 0.5) * pitch_x(), max_mm.y() - (y + 0.5) * pitch_y()};
  }
};

Grid grid_of(const std::vector<StrokeView>& views, const StrokeRules& rules) {
  return {rules.min_mm, rules.max_mm, views.front().missing.width, views.front().missing.height};
}

// The pixels a stroke crosses and its length in each, in pixels: along the line's major axis, one column (or row) after
// the other, its light shared between the two nearest pixels across.
struct Path {
  std::vector<std::pair<std::uint32_t, float>> cells;

  void trace(const Grid& grid, const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm) {
    cells.clear();
    Eigen::Vector2d a = grid.pixel(a_mm), b = grid.pixel(b_mm);
    const bool steep = std::abs(b.y() - a.y()) > std::abs(b.x() - a.x());
    if (steep) {
      std::swap(a.x(), a.y());
      std::swap(b.x(), b.y());
    }
    if (a.x() > b.x()) std::swap(a, b);
    const double run = b.x() - a.x();
    if (!(run > 0)) return;
    const double slope = (b.y() - a.y()) / run, stretch = std::sqrt(1 + slope * slope);
    const int along = steep ? grid.height : grid.width, across = steep ? grid.width : grid.height;
    const auto add = [&](int u, int v, double length) {
      if (u < 0 || v < 0 || u >= along || v >= across || length <= 0) return;
      const int x = steep ? v : u, y = steep ? u : v;
      cells.emplace_back(static_cast<std::uint32_t>(y) * grid.width + x, static_cast<float>(length));
    };
    const int first = static_cast<int>(std::lround(a.x())), last = static_cast<int>(std::lround(b.x()));
    for (int u = first; u <= last; ++u) {
      const double from = std::max(a.x(), u - 0.5), to = std::min(b.x(), u + 0.5);
      if (to <= from) continue;
      const double v = a.y() + slope * ((from + to) / 2 - a.x());
      const int v0 = static_cast<int>(std::floor(v));
      const double part = v - v0, length = (to - from) * stretch;
      add(u, v0, length * (1 - part));
      add(u, v0 + 1, length * part);
    }
  }
};

// Sums along a path in one view: error removed by a stroke of lobe b is 2 b linear - b^2 square.
struct PathSums {
  double linear = 0, square = 0;
  double gain(double b) const { return b * (2 * linear - b * square); }
};

PathSums sums_along(const StrokeView& view, const Path& path) {
  PathSums s;
  for (const auto& [i, length] : path.cells) {
    const float light = length * view.unit.data[i], w = view.weight.data[i];
    s.linear += static_cast<double>(w * light * view.missing.data[i]);
    s.square += static_cast<double>(w * light * light);
  }
  return s;
}

void subtract(StrokeView& view, const Path& path, double b) {
  for (const auto& [i, length] : path.cells) view.missing.data[i] -= static_cast<float>(b) * length * view.unit.data[i];
}

struct Candidate {
  Stroke stroke;
  std::vector<double> lobes;  // a view
};

double angle_of(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return std::atan2(b.y() - a.y(), b.x() - a.x()); }

std::vector<double> lobes_at(const std::vector<StrokeView>& views, const StrokeRules& rules, const Eigen::Vector2d& a,
                             const Eigen::Vector2d& b) {
  const Eigen::Vector2d m = (a + b) / 2;
  const double angle = angle_of(a, b);
  std::vector<double> lobes;
  for (const StrokeView& view : views) {
    const Lean lean = lean_at(view.glint, {m.x(), m.y(), 0});
    lobes.push_back(lobe(lean.angle, angle - lean.scratch_direction(), rules.alpha));
  }
  return lobes;
}

// Moves a segment (by its middle) into the area; false if it is too long for it.
bool fit_inside(const StrokeRules& rules, Eigen::Vector2d& a, Eigen::Vector2d& b) {
  const Eigen::Vector2d half = (b - a).cwiseAbs() / 2, low = rules.min_mm + half, high = rules.max_mm - half;
  if ((low.array() > high.array()).any()) return false;
  const Eigen::Vector2d middle = (a + b) / 2, shift = middle.cwiseMax(low).cwiseMin(high) - middle;
  a += shift;
  b += shift;
  return true;
}

}  // namespace

Image measure_units(ViewRenderer& renderer, const GlintView& glint, const Eigen::Vector2d& min_mm,
                    const Eigen::Vector2d& max_mm) {
  constexpr int kLattice = 33;
  const FootprintGrid& footprints = renderer.scene().grid;
  const Grid grid{min_mm, max_mm, footprints.width(), footprints.height()};
  const double length = 3 * std::max(grid.pitch_x(), grid.pitch_y());
  const double margin = 0.5 * length / (max_mm - min_mm).minCoeff();
  Scratches tests;
  for (int j = 0; j < kLattice; ++j)
    for (int i = 0; i < kLattice; ++i) {
      const auto at = [&](int k) { return margin + (1 - 2 * margin) * k / (kLattice - 1.0); };
      const Eigen::Vector2d p(min_mm.x() + at(i) * (max_mm.x() - min_mm.x()),
                              max_mm.y() - at(j) * (max_mm.y() - min_mm.y()));
      const double direction = lean_at(glint, {p.x(), p.y(), 0}).scratch_direction();
      const Eigen::Vector2d half = length / 2 * Eigen::Vector2d(std::cos(direction), std::sin(direction));
      tests.x0_mm.push_back(p.x() - half.x());
      tests.y0_mm.push_back(p.y() - half.y());
      tests.x1_mm.push_back(p.x() + half.x());
      tests.y1_mm.push_back(p.y() + half.y());
    }
  Image radiance;
  renderer.forward_with_jacobian(tests, radiance);
  std::vector<double> light(tests.size(), 0.0);
  renderer.add_contributions(light);
  Image lattice(kLattice, kLattice, 1), unit(grid.width, grid.height, 1);
  for (std::size_t k = 0; k < light.size(); ++k) lattice.data[k] = static_cast<float>(std::max(0.0, light[k]) / length);
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const double u = std::clamp((x + 0.5) / grid.width, 0.0, 1.0) * (kLattice - 1);
      const double v = std::clamp((y + 0.5) / grid.height, 0.0, 1.0) * (kLattice - 1);
      const int i = std::min(kLattice - 2, static_cast<int>(u)), j = std::min(kLattice - 2, static_cast<int>(v));
      const auto fu = static_cast<float>(u - i), fv = static_cast<float>(v - j);
      unit.at(x, y) = (1 - fv) * ((1 - fu) * lattice.at(i, j) + fu * lattice.at(i + 1, j)) +
                      fv * ((1 - fu) * lattice.at(i, j + 1) + fu * lattice.at(i + 1, j + 1));
    }
  return unit;
}

Image light_weight(const Image& shown_light, const Image& encoded_target, const Image& mask) {
  // Softer in black than the curve itself: a stroke cannot be as dim as black asks for anyway.
  constexpr float kSoftening = 0.003F, kGamma = 1 / 2.2F;
  Image weight = encoded_target;
  tbb::parallel_for(0, weight.height, [&](int y) {
    for (std::size_t i = static_cast<std::size_t>(y) * weight.width; i < static_cast<std::size_t>(y + 1) * weight.width;
         ++i) {
      const float wanted = std::pow(std::max(0.0F, weight.data[i]), 2.2F) + kSoftening;
      const float shown = std::max(0.0F, shown_light.data[i]) + kSoftening, difference = wanted - shown;
      const float slope = std::abs(difference) > 1e-3F * wanted
                              ? (std::pow(wanted, kGamma) - std::pow(shown, kGamma)) / difference
                              : kGamma * std::pow(wanted, kGamma - 1);
      weight.data[i] = slope * slope * (mask.data.empty() ? 1 : mask.data[i] * mask.data[i]);
    }
  });
  return weight;
}

std::vector<Stroke> place_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, std::size_t count,
                                  std::uint64_t seed, double least_gain) {
  if (views.empty()) fail("start", "there are no views", "give at least one");
  const Grid grid = grid_of(views, rules);
  std::mt19937_64 random(seed);
  std::vector<Stroke> strokes;
  Path path;
  const double log_short = std::log(rules.shortest_mm), log_long = std::log(rules.longest_mm);
  int failures = 0;
  while (strokes.size() < count && failures < 64) {
    Candidate best;
    best.stroke.gain = least_gain;
    for (int c = 0; c < rules.candidates; ++c) {
      const double px = uniform(random) * grid.width - 0.5, py = uniform(random) * grid.height - 0.5;
      const auto v = std::min(views.size() - 1, static_cast<std::size_t>(uniform(random) * views.size()));
      const double length = std::exp(log_short + uniform(random) * (log_long - log_short));
      const double side = random() & 1 ? 1 : -1;
      const Eigen::Vector2d middle = grid.board(px, py);
      const Lean lean = lean_at(views[v].glint, {middle.x(), middle.y(), 0});
      const auto segment = [&](double direction, Eigen::Vector2d& a, Eigen::Vector2d& b) {
        const Eigen::Vector2d half = length / 2 * Eigen::Vector2d(std::cos(direction), std::sin(direction));
        a = middle - half;
        b = middle + half;
        return fit_inside(rules, a, b);
      };
      Eigen::Vector2d a, b;
      if (!segment(lean.scratch_direction(), a, b)) continue;
      path.trace(grid, a, b);
      const PathSums straight = sums_along(views[v], path);
      if (!(straight.linear > 0)) continue;
      const double wanted = std::clamp(straight.linear / straight.square, rules.dimmest, 1.0);
      // Other views rarely add to what it is meant for: one that is behind already need not be measured there.
      if (straight.gain(wanted) <= best.stroke.gain) continue;
      // Turned, it crosses other pixels: measure again there, in all views.
      if (wanted < 0.98) {
        if (!segment(lean.scratch_direction() + side * turn_for(lean.angle, wanted, rules.alpha), a, b)) continue;
        path.trace(grid, a, b);
      }
      const std::vector<double> lobes = lobes_at(views, rules, a, b);
      double gain = 0;
      for (std::size_t k = 0; k < views.size(); ++k)
        if (lobes[k] > 1e-3) gain += sums_along(views[k], path).gain(lobes[k]);
      if (gain > best.stroke.gain) best = {{a, b, gain}, lobes};
    }
    if (best.lobes.empty()) {
      ++failures;
      continue;
    }
    failures = 0;
    path.trace(grid, best.stroke.a_mm, best.stroke.b_mm);
    for (std::size_t k = 0; k < views.size(); ++k)
      if (best.lobes[k] > 1e-3) subtract(views[k], path, best.lobes[k]);
    strokes.push_back(best.stroke);
  }
  return strokes;
}

std::vector<double> worth_of(const std::vector<StrokeView>& views, const StrokeRules& rules,
                             const Scratches& scratches) {
  const Grid grid = grid_of(views, rules);
  std::vector<double> worth(scratches.size(), 0.0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scratches.size(), 256), [&](const auto& range) {
    Path path;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Eigen::Vector2d a(scratches.x0_mm[i], scratches.y0_mm[i]), b(scratches.x1_mm[i], scratches.y1_mm[i]);
      path.trace(grid, a, b);
      const std::vector<double> lobes = lobes_at(views, rules, a, b);
      // Without it, `missing` grows by its light: the error grows by 2 b linear + b^2 square.
      for (std::size_t k = 0; k < views.size(); ++k)
        if (lobes[k] > 1e-3) worth[i] -= sums_along(views[k], path).gain(-lobes[k]);
    }
  });
  return worth;
}

void lift_stroke(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                 std::size_t index) {
  const Grid grid = grid_of(views, rules);
  const Eigen::Vector2d a(scratches.x0_mm[index], scratches.y0_mm[index]),
      b(scratches.x1_mm[index], scratches.y1_mm[index]);
  Path path;
  path.trace(grid, a, b);
  const std::vector<double> lobes = lobes_at(views, rules, a, b);
  for (std::size_t k = 0; k < views.size(); ++k)
    if (lobes[k] > 1e-3) subtract(views[k], path, -lobes[k]);
}

}  // namespace burin
