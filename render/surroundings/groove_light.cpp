#include "burin/render/surroundings/groove_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace burin {

LightCurve::At LightCurve::at(double t) const {
  const double place = std::clamp(t / step + half_count, 0.0, 2.0 * half_count);
  const int k = std::min(2 * half_count - 1, static_cast<int>(place));
  const double u = place - k;
  const Node &a = nodes[k], &b = nodes[k + 1];
  const double a0 = a.light, a1 = step * a.slope, rise = b.light - a.light;
  const double a2 = 3 * rise - 2 * a1 - step * b.slope, a3 = a1 + step * b.slope - 2 * rise;
  At out;
  out.light = a0 + u * (a1 + u * (a2 + u * a3));
  out.sum = a.sum + step * u * (a0 + u * (a1 / 2 + u * (a2 / 3 + u * a3 / 4)));
  out.sum_of_sums =
      a.sum_of_sums + step * u * (a.sum + step * u * (a0 / 2 + u * (a1 / 6 + u * (a2 / 12 + u * a3 / 20))));
  return out;
}

void make_curve(const std::vector<double>& light, double step, LightCurve& curve) {
  const std::size_t n = light.size();
  curve.step = step;
  curve.half_count = static_cast<int>(n / 2);
  curve.nodes.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t before = k > 0 ? k - 1 : k, after = k + 1 < n ? k + 1 : k;
    curve.nodes[k].light = light[k];
    curve.nodes[k].slope = (light[after] - light[before]) / (step * static_cast<double>(after - before));
  }
  curve.nodes[0].sum = curve.nodes[0].sum_of_sums = 0;
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const LightCurve::Node &a = curve.nodes[k], &b = curve.nodes[k + 1];
    const double a1 = step * a.slope, rise = b.light - a.light;
    const double a2 = 3 * rise - 2 * a1 - step * b.slope, a3 = a1 + step * b.slope - 2 * rise;
    curve.nodes[k + 1].sum = a.sum + step * (a.light + a1 / 2 + a2 / 3 + a3 / 4);
    curve.nodes[k + 1].sum_of_sums = a.sum_of_sums + step * (a.sum + step * (a.light / 2 + a1 / 6 + a2 / 12 + a3 / 20));
  }
}

namespace {

using PieceKind = GroovePieces::Piece::Kind;

// The part of an edge between the rims, cut at its entry into and exit from the groove's length.
void add_edge(Eigen::Vector2d a, Eigen::Vector2d b, double rim, double length, GroovePieces& out) {
  const double low = std::min(a.x(), b.x()), high = std::max(a.x(), b.x());
  if (low >= rim || high <= -rim) return;
  const Eigen::Vector2d whole = b - a, first = a;
  const auto cut = [&](Eigen::Vector2d& p) {
    if (std::abs(p.x()) <= rim) return;
    const double t = p.x() > 0 ? rim : -rim;
    p = {t, first.y() + (t - first.x()) / whole.x() * whole.y()};
  };
  cut(a);
  cut(b);
  const auto kind_of = [&](double y) {
    return y < 0 ? PieceKind::at_start : y > length ? PieceKind::at_end : PieceKind::inside;
  };
  // Positions along it at which Y passes an end of the groove.
  std::array<double, 4> at{0, 1, 1, 1};
  int n = 1;
  const double dy = b.y() - a.y();
  for (const double y : {0.0, length})
    if ((a.y() < y) != (b.y() < y) && dy != 0) at[n++] = std::clamp((y - a.y()) / dy, 0.0, 1.0);
  if (n == 3 && at[1] > at[2]) std::swap(at[1], at[2]);
  at[n] = 1;
  for (int k = 0; k < n; ++k) {
    if (!(at[k + 1] > at[k])) continue;
    const Eigen::Vector2d p = a + at[k] * (b - a), q = a + at[k + 1] * (b - a);
    out.piece[out.count++] = {p.x(), std::clamp(p.y(), 0.0, length), q.x(), std::clamp(q.y(), 0.0, length),
                              kind_of(0.5 * (p.y() + q.y()))};
  }
}

// Length of a pixel's cut at t within the groove's length.
double extent_at(const std::array<Eigen::Vector2d, 4>& q, double t, double length) {
  double low = 1e300, high = -1e300;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d &a = q[i], &b = q[(i + 1) % 4];
    if ((a.x() <= t) == (b.x() <= t)) continue;
    const double y = a.y() + (t - a.x()) / (b.x() - a.x()) * (b.y() - a.y());
    low = std::min(low, y);
    high = std::max(high, y);
  }
  return high > low ? std::clamp(high, 0.0, length) - std::clamp(low, 0.0, length) : 0;
}

constexpr double kUpright = 1e-7;  // a piece with less extent across runs along the groove

struct Integrals {
  double of_light, first;  // integrals of R and of (t - middle) R over the piece, signed
  double mean;             // of R over it
};

Integrals over(const GroovePieces::Piece& p, const LightCurve& curve) {
  const double dt = p.t2 - p.t1, middle = 0.5 * (p.t1 + p.t2);
  if (std::abs(dt) < kUpright) {
    const double light = curve.at(middle).light;
    return {light * dt, 0, light};
  }
  const LightCurve::At a = curve.at(p.t1), b = curve.at(p.t2);
  const double sum = b.sum - a.sum;
  // By parts: the integral of (t - middle) R is [(t - middle) sum] minus the integral of the sum.
  const double first = 0.5 * dt * (a.sum + b.sum) - (b.sum_of_sums - a.sum_of_sums);
  return {sum, first, sum / dt};
}

Integrals over_one(const GroovePieces::Piece& p) { return {p.t2 - p.t1, 0, 1}; }

template <typename Over>
double value_of(const GroovePieces& pieces, const Over& integrals) {
  double sum = 0;
  const double level = pieces.count > 0 ? pieces.piece[0].y1 : 0;
  for (int k = 0; k < pieces.count; ++k) {
    const GroovePieces::Piece& p = pieces.piece[k];
    const Integrals i = integrals(p);
    const double dt = p.t2 - p.t1, slope = std::abs(dt) < kUpright ? 0 : (p.y2 - p.y1) / dt;
    sum += (0.5 * (p.y1 + p.y2) - level) * i.of_light + slope * i.first;
  }
  return -pieces.way * sum;
}

template <typename Over>
PieceSums sums_of(const GroovePieces& pieces, const Over& integrals) {
  PieceSums out;
  const double level = pieces.count > 0 ? pieces.piece[0].y1 : 0;
  for (int k = 0; k < pieces.count; ++k) {
    const GroovePieces::Piece& p = pieces.piece[k];
    const Integrals i = integrals(p);
    const double dt = p.t2 - p.t1, dy = p.y2 - p.y1, slope = std::abs(dt) < kUpright ? 0 : dy / dt;
    const double y = 0.5 * (p.y1 + p.y2), t = 0.5 * (p.t1 + p.t2);
    out.value -= (y - level) * i.of_light + slope * i.first;
    if (p.kind == PieceKind::at_end) out.by_length -= i.of_light;
    if (p.kind != PieceKind::inside) continue;
    // Along the piece: integrals of R dY, R dt, R Y dY, R t dt, R t dY, R Y dt.
    const double r_dy = i.mean * dy, r_dt = i.of_light;
    const double ry_dy = y * r_dy + slope * slope * i.first, rt_dt = t * r_dt + i.first;
    const double rt_dy = t * r_dy + slope * i.first, ry_dt = y * r_dt + slope * i.first;
    out.by_shift_t += r_dy;
    out.by_shift_y -= r_dt;
    out.by_turn -= ry_dy + rt_dt;
    out.by_growth += rt_dy - ry_dt;
  }
  for (double* v : {&out.value, &out.by_shift_t, &out.by_shift_y, &out.by_turn, &out.by_length, &out.by_growth})
    *v *= pieces.way;
  return out;
}

}  // namespace

GroovePieces groove_pieces(const std::array<Eigen::Vector2d, 4>& corners, double rim, double length) {
  GroovePieces out;
  const Eigen::Vector2d a = corners[2] - corners[0], b = corners[3] - corners[1];
  out.way = a.x() * b.y() - a.y() * b.x() >= 0 ? 1 : -1;
  for (int i = 0; i < 4; ++i) add_edge(corners[i], corners[(i + 1) % 4], rim, length, out);
  out.left_extent = extent_at(corners, -rim, length);
  out.right_extent = extent_at(corners, rim, length);
  return out;
}

double piece_value(const GroovePieces& pieces, const LightCurve& curve) {
  // Between the cuts at the rims the boundary runs along the rims, where dt is 0. So only pieces contribute.
  return value_of(pieces, [&](const GroovePieces::Piece& p) { return over(p, curve); });
}

PieceSums piece_sums(const GroovePieces& pieces, const LightCurve& curve, double rim) {
  PieceSums out = sums_of(pieces, [&](const GroovePieces::Piece& p) { return over(p, curve); });
  out.by_rim = curve.at(rim).light * pieces.right_extent + curve.at(-rim).light * pieces.left_extent;
  return out;
}

double piece_area(const GroovePieces& pieces) { return value_of(pieces, over_one); }

PieceSums piece_area_sums(const GroovePieces& pieces) {
  PieceSums out = sums_of(pieces, over_one);
  out.by_rim = pieces.right_extent + pieces.left_extent;
  return out;
}

}  // namespace burin
