#include "burin/render/surroundings/exact_surroundings.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <type_traits>
#include <utility>

#include "burin/base/machine_clones.h"
#include "burin/render/exact/exact_view.h"
#include "burin/render/exact/scratch_pair.h"
#include "burin/render/fast/pairs.h"
#include "burin/render/surroundings/face_light.h"
#include "burin/render/surroundings/facet_table.h"
#include "burin/render/surroundings/groove_light.h"
#include "burin/render/surroundings/table_range.h"
#include "burin/scene/groove.h"

namespace burin {
namespace {

constexpr double kKnot = 0.15;  // of the roughness: largest turn of h between knots along a scratch

BURIN_MACHINE_CLONES void add_times(const float* from, float by, float by_too, int n, float* to, float* to_too) {
  for (int k = 0; k < n; ++k) {
    to[k] += by * from[k];
    to_too[k] += by_too * from[k];
  }
}

/// A scratch's light across it at a position along it: per channel, and by its direction and log(alpha).
struct Knot {
  double s = 0;  // along the scratch, in half widths
  std::array<LightCurve, 3> light, by_turn, by_log_alpha;
};

/// The pairs of a scratch with their light.
struct ScratchPairs {
  std::vector<std::uint32_t> pixel;
  std::vector<float> light;  // channels per pair, mm^2 of R
  std::vector<float> area;   // mm^2
};

/// Buffers of one thread.
struct Work {
  std::vector<PixelSpan> spans;
  std::vector<float> sum, slope;
  std::vector<double> values;
  std::vector<Knot> knots;
};

/// Data of a scratch for all of its pairs.
struct SeenScratch {
  ScratchFrame frame;
  double half_mm = 0, rim = 0, length = 0;  // half the width; T; length in half widths
};

std::array<Eigen::Vector2d, 4> in_groove(const SeenScratch& s, const std::array<Eigen::Vector2d, 4>& corners_mm) {
  std::array<Eigen::Vector2d, 4> out = in_scratch(s.frame, corners_mm);
  for (Eigen::Vector2d& q : out) q /= s.half_mm;
  return out;
}

}  // namespace

struct ExactSurroundings::Data {
  ViewScene scene;
  Light light;
  int channels = 1, width = 0, height = 0;
  bool material = false;
  PixelIndex index;
  PlaceLattice lattice;
  TableRange range;
  std::vector<FacetTable> tables;  // by roughness
  FaceLight face;
  std::vector<double> area_mm2;
  // From the last forward.
  Scratches scratches;
  std::vector<ScratchPairs> pairs;
  std::vector<float> covered;  // as a fraction of a pixel
  mutable tbb::enumerable_thread_specific<Work> work;

  Data(const ViewScene& s, const Light& l, const RenderOptions& o)
      : scene(s),
        light(l),
        channels(o.channels),
        width(s.grid->width()),
        height(s.grid->height()),
        material(o.material_gradients),
        index(*s.grid) {}

  void shade_face();
  void make_tables();
  SeenScratch seen(std::size_t i) const {
    SeenScratch out{scratch_frame(scratches, i, scene.tool_width_um, scene.material), 0, 0, 0};
    out.half_mm = 5e-4 * out.frame.groove.width_um;
    out.rim = groove_rim(out.frame.groove.width_um, out.frame.groove.depth_um);
    out.length = out.frame.groove.length_mm / out.half_mm;
    return out;
  }
  std::array<Eigen::Vector2d, 4> corners(const SeenScratch& s, std::size_t pixel) const {
    return in_groove(
        s, footprint_corners_mm(*scene.grid, static_cast<int>(pixel % width), static_cast<int>(pixel / width)));
  }
  void add_table(const FacetTable& table, std::size_t pixel, double across, double share, int side, Work& w) const;
  void curves_at(const SeenScratch& s, std::size_t pixel, bool with_slopes, Work& w, Knot& knot) const;
  void make_knots(const SeenScratch& s, const std::vector<std::uint32_t>& pixel, bool with_slopes, Work& w) const;
  void find_scratch_pairs(std::size_t i, const Strip& strip);
  void differentiate(std::size_t i, const std::vector<double>& by_light, const std::vector<double>& by_area,
                     std::array<double, 7>& sums) const;
};

void ExactSurroundings::Data::shade_face() {
  lattice = place_lattice(scene, light, std::min(scene.material.alpha, scene.material.base_alpha));
  face = face_light(scene, light, channels, lattice);
  area_mm2.assign(static_cast<std::size_t>(width) * height, 0);
  for (std::size_t i = 0; i < area_mm2.size(); ++i) {
    if (!index.has_footprint()[i]) continue;
    const Eigen::Vector3d way = scene.camera_center_mm - scene.grid->center_mm[i];
    if (!(way.dot(scene.grid->normal[i]) > 0)) continue;
    area_mm2[i] = std::abs(
        signed_area_mm2(footprint_corners_mm(*scene.grid, static_cast<int>(i % width), static_cast<int>(i / width))));
  }
}

void ExactSurroundings::Data::make_tables() {
  if (serves(range, scene, scratches)) return;
  range = table_range(scene, scratches, material);
  tables.clear();
  for (const double alpha : range.alphas)
    tables.push_back(make_facet_table(scene, light, channels, lattice, alpha, range.steepest_t));
}

// The table's light for normals that lean along `across` (azimuth), for one place. Writes values and derivatives by the
// azimuth to w.sum and w.slope; `side` -1 and 1 are the halves of the groove.
void ExactSurroundings::Data::add_table(const FacetTable& table, std::size_t pixel, double across, double share,
                                        int side, Work& w) const {
  const double turned = across / (2 * std::numbers::pi);
  const CubicShares a = cubic_shares((turned - std::floor(turned)) * table.azimuths, table.azimuths, true);
  const std::size_t column = pixel % width, row = pixel / width;
  const CubicShares x = cubic_shares(static_cast<double>(column) / table.column_pixels, table.columns, false);
  const CubicShares y = cubic_shares(static_cast<double>(row) / table.row_pixels, table.rows, false);
  const double per_turn = table.azimuths / (2 * std::numbers::pi);
  const std::size_t n = table.ring_size();
  float *sum = &w.sum[side > 0 ? n : 0], *slope = &w.slope[side > 0 ? n : 0];
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const int node = (y.first + j) * table.columns + x.first + i;
      const double here = share * x.share[i] * y.share[j];
      for (int k = 0; k < 4; ++k)
        add_times(table.at(node, (a.first + k + table.azimuths) % table.azimuths),
                  static_cast<float>(here * a.share[k]), static_cast<float>(here * a.slope[k] * per_turn),
                  static_cast<int>(n), sum, slope);
    }
}

namespace {

// The three tables nearest to a roughness (or the only one), with Lagrange weights in log(alpha).
struct AlphaShares {
  int first = 0, count = 1;
  std::array<double, 3> share{1, 0, 0}, slope{};
};

AlphaShares alpha_shares(const std::vector<double>& alphas, double alpha) {
  AlphaShares out;
  if (alphas.size() < 3) return out;
  const double x = std::log(alpha);
  int near = 1;
  for (int k = 1; k + 1 < static_cast<int>(alphas.size()); ++k)
    if (std::abs(std::log(alphas[k]) - x) < std::abs(std::log(alphas[near]) - x)) near = k;
  out.first = near - 1;
  out.count = 3;
  std::array<double, 3> at{};
  for (int k = 0; k < 3; ++k) at[k] = std::log(alphas[out.first + k]);
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    const double below = (at[k] - at[a]) * (at[k] - at[b]);
    out.share[k] = (x - at[a]) * (x - at[b]) / below;
    out.slope[k] = (2 * x - at[a] - at[b]) / below;
  }
  return out;
}

}  // namespace

void ExactSurroundings::Data::curves_at(const SeenScratch& s, std::size_t pixel, bool with_slopes, Work& w,
                                        Knot& knot) const {
  const double across = std::atan2(s.frame.x.y(), s.frame.x.x());
  const AlphaShares shares = alpha_shares(range.alphas, s.frame.groove.alpha);
  // Tables of other roughnesses have other steps: each is read at the nodes of the middle one.
  const FacetTable& middle = tables[shares.first + shares.count / 2];
  const int n = middle.t_count;
  const std::size_t nodes = 2 * static_cast<std::size_t>(n) - 1;
  std::array<std::vector<double>, 9> values;
  for (auto& v : values) v.assign(nodes, 0.0);
  for (int t = 0; t < shares.count; ++t) {
    const FacetTable& table = tables[shares.first + t];
    w.sum.assign(2 * table.ring_size(), 0.0F);
    w.slope.assign(2 * table.ring_size(), 0.0F);
    // The normal (-2t, 0, 1 - t^2) leans away from x for positive t (docs/model.md 2.3).
    add_table(table, pixel, across, 1, -1, w);
    add_table(table, pixel, across + std::numbers::pi, 1, 1, w);
    const double ratio = middle.t_step / table.t_step;
    for (int k = 0; k < n; ++k) {
      const CubicShares at = cubic_shares(std::min(k * ratio, table.t_count - 1.0), table.t_count, false);
      for (int side = 0; side < 2; ++side)
        for (int c = 0; c < channels; ++c) {
          double value = 0, slope = 0;
          for (int m = 0; m < 4; ++m) {
            const std::size_t from =
                side * table.ring_size() + static_cast<std::size_t>(c) * table.t_count + at.first + m;
            value += at.share[m] * w.sum[from];
            slope += at.share[m] * w.slope[from];
          }
          if (k == 0 && side == 0) continue;  // both sides meet there
          const std::size_t node = side > 0 ? n - 1 + k : n - 1 - k;
          values[c][node] += shares.share[t] * value;
          values[3 + c][node] += shares.share[t] * slope;
          values[6 + c][node] += shares.slope[t] * value;
        }
    }
  }
  for (int c = 0; c < channels; ++c) {
    make_curve(values[c], middle.t_step, knot.light[c]);
    if (!with_slopes) continue;
    make_curve(values[3 + c], middle.t_step, knot.by_turn[c]);
    if (shares.count > 1) make_curve(values[6 + c], middle.t_step, knot.by_log_alpha[c]);
  }
}

void ExactSurroundings::Data::make_knots(const SeenScratch& s, const std::vector<std::uint32_t>& pixel,
                                         bool with_slopes, Work& w) const {
  const auto along = [&](std::uint32_t p) {
    const std::array<Eigen::Vector2d, 4> q = corners(s, p);
    return 0.25 * (q[0].y() + q[1].y() + q[2].y() + q[3].y());
  };
  std::vector<double> place(pixel.size());
  for (std::size_t k = 0; k < pixel.size(); ++k) place[k] = along(pixel[k]);
  const auto [low, high] = std::minmax_element(place.begin(), place.end());
  const std::uint32_t a = pixel[low - place.begin()], b = pixel[high - place.begin()];
  const std::size_t row_a = a / width, row_b = b / width;
  const double pixels = std::hypot(static_cast<double>(a % width) - static_cast<double>(b % width),
                                   static_cast<double>(row_a) - static_cast<double>(row_b));
  const double turned = pixels * lattice.lean_per_pixel / (kKnot * s.frame.groove.alpha);
  const int steps = turned < 0.25 ? 0 : static_cast<int>(std::ceil(turned));
  w.knots.resize(steps + 1);
  const double first = *low, last = *high;
  for (int k = 0; k <= steps; ++k) {
    const double wanted = steps == 0 ? 0.5 * (first + last) : first + (last - first) * k / steps;
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < place.size(); ++i)
      if (std::abs(place[i] - wanted) < std::abs(place[nearest] - wanted)) nearest = i;
    w.knots[k].s = place[nearest];
    curves_at(s, pixel[nearest], with_slopes, w, w.knots[k]);
  }
}

namespace {

// The two knots around a position, and the weight of the second.
struct Between {
  std::size_t a = 0, b = 0;
  double share = 0;
};

Between between(const std::vector<Knot>& knots, double s) {
  std::size_t k = 1;
  while (k < knots.size() && knots[k].s < s) ++k;
  if (k >= knots.size()) return {knots.size() - 1, knots.size() - 1, 0};
  const double length = knots[k].s - knots[k - 1].s;
  if (!(length > 0)) return {k, k, 0};
  return {k - 1, k, std::clamp((s - knots[k - 1].s) / length, 0.0, 1.0)};
}

// Interpolates a sum between both knots, for any of their curves.
template <typename Of>
auto blended(const std::vector<Knot>& knots, const Between& at, const Of& of) {
  auto sum = of(knots[at.a]);
  if (at.share == 0) return sum;
  const auto other = of(knots[at.b]);
  if constexpr (std::is_same_v<decltype(sum), double>) {
    return sum + at.share * (other - sum);
  } else {
    for (double PieceSums::*field :
         {&PieceSums::value, &PieceSums::by_shift_t, &PieceSums::by_shift_y, &PieceSums::by_turn, &PieceSums::by_length,
          &PieceSums::by_rim, &PieceSums::by_growth})
      sum.*field += at.share * (other.*field - sum.*field);
    return sum;
  }
}

double middle_of(const std::array<Eigen::Vector2d, 4>& q) { return 0.25 * (q[0].y() + q[1].y() + q[2].y() + q[3].y()); }

}  // namespace

void ExactSurroundings::Data::find_scratch_pairs(std::size_t i, const Strip& strip) {
  Work& w = work.local();
  ScratchPairs& p = pairs[i];
  p.pixel.clear();
  p.light.clear();
  p.area.clear();
  w.spans.clear();
  find_spans(index, strip, w.spans);
  for (const PixelSpan& span : w.spans)
    for (int c = span.begin; c < span.end; ++c) {
      const std::size_t pixel = static_cast<std::size_t>(span.row) * width + c;
      if (area_mm2[pixel] > 0) p.pixel.push_back(static_cast<std::uint32_t>(pixel));
    }
  const SeenScratch s = seen(i);
  if (!(s.length > 0)) p.pixel.clear();
  if (p.pixel.empty()) return;
  make_knots(s, p.pixel, false, w);
  const double unit = s.half_mm * s.half_mm;
  for (const std::uint32_t pixel : p.pixel) {
    const std::array<Eigen::Vector2d, 4> q = corners(s, pixel);
    const GroovePieces pieces = groove_pieces(q, s.rim, s.length);
    p.area.push_back(static_cast<float>(unit * std::max(0.0, piece_area(pieces))));
    const Between at = between(w.knots, middle_of(q));
    for (int c = 0; c < channels; ++c)
      p.light.push_back(static_cast<float>(
          unit * blended(w.knots, at, [&](const Knot& knot) { return piece_value(pieces, knot.light[c]); })));
  }
}

// Sums over a scratch's pairs: by x0, y0, x1, y1, width, depth, alpha.
void ExactSurroundings::Data::differentiate(std::size_t i, const std::vector<double>& by_light,
                                            const std::vector<double>& by_area, std::array<double, 7>& sums) const {
  sums = {};
  const ScratchPairs& p = pairs[i];
  if (p.pixel.empty()) return;
  Work& w = work.local();
  const SeenScratch s = seen(i);
  make_knots(s, p.pixel, true, w);
  const double half = s.half_mm, unit = half * half;
  double shift_x = 0, shift_y = 0, turn = 0, length = 0, rim = 0, growth = 0, value = 0, log_alpha = 0;
  const auto add = [&](double by, const PieceSums& g) {
    value += by * g.value;
    shift_x += by * g.by_shift_t;
    shift_y += by * g.by_shift_y;
    turn -= by * g.by_turn;  // a turn of the frame turns its contents back
    length += by * g.by_length;
    rim += by * g.by_rim;
    growth += by * g.by_growth;
  };
  for (const std::uint32_t pixel : p.pixel) {
    const std::array<Eigen::Vector2d, 4> q = corners(s, pixel);
    const GroovePieces pieces = groove_pieces(q, s.rim, s.length);
    const Between at = between(w.knots, middle_of(q));
    for (int c = 0; c < channels; ++c) {
      const double by = by_light[static_cast<std::size_t>(pixel) * channels + c];
      if (by == 0) continue;
      add(by, blended(w.knots, at, [&](const Knot& knot) { return piece_sums(pieces, knot.light[c], s.rim); }));
      turn += by * blended(w.knots, at, [&](const Knot& knot) { return piece_value(pieces, knot.by_turn[c]); });
      if (material)
        log_alpha +=
            by * blended(w.knots, at, [&](const Knot& knot) { return piece_value(pieces, knot.by_log_alpha[c]); });
    }
    if (by_area[pixel] != 0) add(by_area[pixel], piece_area_sums(pieces));
  }
  // From half widths to mm, and from the frame to the ends (docs/model.md 4.23).
  const GrooveSegment& g = s.frame.groove;
  const Eigen::Vector2d& x = s.frame.x;
  const Eigen::Vector2d& y = s.frame.y;
  const Eigen::Vector2d end = -x * (unit * turn / g.length_mm) + y * (half * length);
  const Eigen::Vector2d start = -end - x * (half * shift_x) - y * (half * shift_y);
  const double rim_by_depth = std::exp(-2 * g.depth_um / g.width_um) / (g.width_um * s.rim);
  const double by_depth = unit * rim * rim_by_depth;
  // Euler's relation, 4.22: all lengths in mm scale alike.
  const double by_width =
      (2 * unit * value - unit * growth - half * length * g.length_mm - by_depth * g.depth_um) / g.width_um;
  sums = {start.x(), start.y(), end.x(), end.y(), by_width, by_depth, unit * log_alpha / g.alpha};
}

ExactSurroundings::ExactSurroundings(const ViewScene& scene, const Light& light, const RenderOptions& options)
    : data_(std::make_unique<Data>(scene, light, options)) {
  data_->shade_face();
}

ExactSurroundings::~ExactSurroundings() = default;

std::size_t ExactSurroundings::pair_count() const {
  std::size_t sum = 0;
  for (const ScratchPairs& p : data_->pairs) sum += p.pixel.size();
  return sum;
}

void ExactSurroundings::add_radiance(const Scratches& scratches, Image& radiance) {
  Data& d = *data_;
  d.scratches = scratches;
  const std::size_t n = static_cast<std::size_t>(d.width) * d.height;
  std::vector<double> light(n * d.channels, 0), area(n, 0);
  d.pairs.resize(scratches.size());
  if (scratches.size() > 0) {
    d.make_tables();
    const std::vector<Strip> strips = strips_of(scratches, d.scene.tool_width_um, d.scene.material);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scratches.size(), 32), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) d.find_scratch_pairs(i, strips[i]);
    });
  }
  for (const ScratchPairs& p : d.pairs)  // in one order, for any number of threads
    for (std::size_t k = 0; k < p.pixel.size(); ++k) {
      area[p.pixel[k]] += p.area[k];
      for (int c = 0; c < d.channels; ++c)
        light[static_cast<std::size_t>(p.pixel[k]) * d.channels + c] += p.light[k * d.channels + c];
    }
  d.covered.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (!(d.area_mm2[i] > 0)) continue;
    d.covered[i] = static_cast<float>(area[i] / d.area_mm2[i]);
    const double open = 1 - std::min(1.0, area[i] / d.area_mm2[i]);
    for (int c = 0; c < d.channels; ++c)
      radiance.data[i * d.channels + c] +=
          static_cast<float>(light[i * d.channels + c] / d.area_mm2[i] + open * d.face.light[i * d.channels + c]);
  }
}

void ExactSurroundings::backward(const Image& dE_dradiance, ScratchGradients& gradients) const {
  const Data& d = *data_;
  const std::size_t n = static_cast<std::size_t>(d.width) * d.height;
  std::vector<double> by_light(n * d.channels, 0), by_area(n, 0);
  double by_log_base = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(d.area_mm2[i] > 0)) continue;
    for (int c = 0; c < d.channels; ++c) {
      const double by = dE_dradiance.data[i * d.channels + c];
      by_light[i * d.channels + c] = by / d.area_mm2[i];
      if (d.covered[i] >= 1) continue;
      by_area[i] -= by * d.face.light[i * d.channels + c] / d.area_mm2[i];
      by_log_base += by * (1 - d.covered[i]) * d.face.by_log_alpha[i * d.channels + c];
    }
  }
  std::vector<std::array<double, 7>> sums(d.pairs.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, d.pairs.size(), 32), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) d.differentiate(i, by_light, by_area, sums[i]);
  });
  for (std::size_t i = 0; i < sums.size(); ++i) {
    gradients.x0_mm[i] += sums[i][0];
    gradients.y0_mm[i] += sums[i][1];
    gradients.x1_mm[i] += sums[i][2];
    gradients.y1_mm[i] += sums[i][3];
    if (!d.material) continue;
    gradients.width_um[i] += sums[i][4];
    gradients.depth_um[i] += sums[i][5];
    gradients.alpha[i] += sums[i][6];
    gradients.shared_width_um += sums[i][4];
    gradients.shared_depth_um += sums[i][5];
    gradients.shared_alpha += sums[i][6];
  }
  if (d.material) gradients.shared_base_alpha += by_log_base / d.scene.material.base_alpha;
}

void ExactSurroundings::add_contributions(std::vector<double>& contribution) const {
  const Data& d = *data_;
  for (std::size_t s = 0; s < d.pairs.size(); ++s) {
    const ScratchPairs& p = d.pairs[s];
    for (std::size_t k = 0; k < p.pixel.size(); ++k)
      for (int c = 0; c < d.channels; ++c)
        contribution[s] += p.light[k * d.channels + c] / (d.area_mm2[p.pixel[k]] * d.channels);
  }
}

}  // namespace burin
