#include "burin/render/footprint/profile_integral.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "burin/render/footprint/lobe_nodes.h"

namespace burin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Shape = ProfileBand::Shape;

// The NDF on a wall of a given lean (as sine and cosine), with its derivatives: docs/model.md 3.7.
struct PointLight {
  double D, by_alpha;
  Vector3d by_h;
};
PointLight point_light(const Vector3d& h, double sine, double cosine, double alpha, double across, bool slopes) {
  const double across2 = 1 / (across * across * alpha * alpha), along2 = 1 / (alpha * alpha);
  const double m = h.x() * cosine + h.z() * sine, nh = h.z() * cosine - h.x() * sine;
  PointLight out{0, 0, Vector3d::Zero()};
  if (!(nh > 0)) return out;
  const double Q = m * m * across2 + h.y() * h.y() * along2 + nh * nh;
  out.D = along2 / (std::numbers::pi * across * Q * Q);
  if (!slopes) return out;
  const double scale = -4 * out.D / Q;
  out.by_h = scale * Vector3d(m * cosine * across2 - nh * sine, h.y() * along2, m * sine * across2 + nh * cosine);
  out.by_alpha = out.D * (-2 + 4 * (m * m * across2 + h.y() * h.y() * along2) / Q) / alpha;
  return out;
}

// dx / d(lean) of a band's shape up to a factor, and its integral.
double density(Shape shape, double cosine) {
  return shape == Shape::circle ? cosine : shape == Shape::paper ? 1 / (1 + cosine) : 1 / (cosine * cosine);
}
double density_integral(Shape shape, double sine, double cosine) {
  return shape == Shape::circle ? sine : shape == Shape::paper ? sine / (1 + cosine) : sine / cosine;
}
double density_integral(const ProfileBand& band) {
  return density_integral(band.shape, band.to_sine, band.to_cosine) -
         density_integral(band.shape, band.from_sine, band.from_cosine);
}

constexpr std::array<double, 4> kNode{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> kWeight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};

// A footprint cut with a groove's length: a convex polygon. Each side knows the line that it is part of.
enum Side : int { kQuadSides = 4, kFirstEnd = 4, kSecondEnd };
struct Corner {
  Vector2d p;
  int side;  // of the side that begins here: 0 to 3 of the quadrilateral, or a Side
};
struct Polygon {
  std::array<Corner, 12> corner;
  int count = 0;
  void add(const Vector2d& p, int side) {
    if (count < static_cast<int>(corner.size())) corner[count++] = {p, side};
  }
};

// Part of a polygon with sign (p[axis] - at) >= 0; the new side is `side`.
Polygon clipped(const Polygon& in, int axis, double at, double sign, int side) {
  Polygon out;
  for (int i = 0; i < in.count; ++i) {
    const Corner &a = in.corner[i], &b = in.corner[(i + 1) % in.count];
    const double da = sign * (a.p[axis] - at), db = sign * (b.p[axis] - at);
    if (da >= 0) out.add(a.p, a.side);
    if ((da >= 0) == (db >= 0)) continue;
    Vector2d p = a.p + da / (da - db) * (b.p - a.p);
    p[axis] = at;
    out.add(p, da >= 0 ? side : a.side);
  }
  return out;
}

// The quadrilateral, counter-clockwise, cut with the groove's length. `order[i]`: index of corner i in the input.
struct Cut {
  Quad quad;
  std::array<int, 4> order{0, 1, 2, 3};
  Polygon polygon;
  double left = 0, right = 0;
};
Cut cut_to_length(const Quad& corners, double length_mm) {
  Cut out;
  const Vector2d a = corners[2] - corners[0], b = corners[3] - corners[1];
  if (a.x() * b.y() - a.y() * b.x() < 0) out.order = {0, 3, 2, 1};
  for (int i = 0; i < 4; ++i) out.quad[i] = corners[out.order[i]];
  for (int i = 0; i < 4; ++i) out.polygon.add(out.quad[i], i);
  double least = corners[0].y(), most = least;
  for (const Vector2d& p : corners) {
    least = std::min(least, p.y());
    most = std::max(most, p.y());
  }
  if (least < 0) out.polygon = clipped(out.polygon, 1, 0, 1, kFirstEnd);
  if (most > length_mm) out.polygon = clipped(out.polygon, 1, length_mm, -1, kSecondEnd);
  if (out.polygon.count == 0) return out;
  out.left = out.right = out.polygon.corner[0].p.x();
  for (int i = 1; i < out.polygon.count; ++i) {
    out.left = std::min(out.left, out.polygon.corner[i].p.x());
    out.right = std::max(out.right, out.polygon.corner[i].p.x());
  }
  return out;
}

// Derivatives of the integral over a polygon of a quantity that is constant per band. They are by the footprint's
// corners, through its sides, and by the groove's length.
struct SideSums {
  std::array<Vector2d, 4> by_corner{Vector2d::Zero(), Vector2d::Zero(), Vector2d::Zero(), Vector2d::Zero()};
  double by_length = 0;
};

// A band's area in a polygon, and the polygon's length along the groove at the band's two edges.
struct BandShare {
  double area = 0, at_from = 0, at_to = 0;
};

// Walks around the polygon, band by band, and fills `shares` (Green's theorem: minus the integral of y dx). Also adds
// the changes of area and light, band by band, as a side moves outwards.
void walk(const Cut& cut, std::span<const ProfileBand> bands, std::span<const double> light,
          std::span<BandShare> shares, SideSums& by_area, SideSums& by_light) {
  const double y0 = cut.polygon.corner[0].p.y();
  const double first = 1e-3 * bands.front().from_um, last = 1e-3 * bands.back().to_um;
  for (int i = 0; i < cut.polygon.count; ++i) {
    const Corner& corner = cut.polygon.corner[i];
    const Vector2d &a = corner.p, &b = cut.polygon.corner[i + 1 < cut.polygon.count ? i + 1 : 0].p;
    const double dx = b.x() - a.x(), left = std::min(a.x(), b.x()), right = std::max(a.x(), b.x());
    const double way = dx >= 0 ? 1 : -1, slope = dx == 0 ? 0 : (b.y() - a.y()) / dx;
    if (right < first || left > last) continue;
    const bool on_quad = corner.side < kQuadSides;
    const Vector2d c = on_quad ? cut.quad[corner.side] : a;
    const Vector2d e = on_quad ? Vector2d(cut.quad[(corner.side + 1) % 4] - c) : Vector2d(0, 0);
    const double length2 = e.squaredNorm();
    for (std::size_t k = 0; k < bands.size(); ++k) {
      const double from = 1e-3 * bands[k].from_um, to = 1e-3 * bands[k].to_um;
      if (to <= left && (dx != 0 || to < left)) continue;
      if (from >= right) break;
      const double x1 = std::max(left, from), x2 = std::min(right, to);
      const auto y_at = [&](double x) { return a.y() + slope * (x - a.x()) - y0; };
      const double y1 = dx == 0 ? a.y() - y0 : y_at(x1), y2 = dx == 0 ? b.y() - y0 : y_at(x2);
      BandShare& share = shares[k];
      share.area -= way * (x2 - x1) * 0.5 * (y1 + y2);
      if (from >= left && from < right) share.at_from -= way * y1;
      if (to >= left && to < right) share.at_to -= way * y2;
      const Vector2d outwards = way * Vector2d(y2 - y1, x1 - x2);  // times the length of the part
      if (corner.side == kSecondEnd) {
        by_area.by_length += outwards.y();
        by_light.by_length += light[k] * outwards.y();
      }
      if (!on_quad || !(length2 > 0)) continue;
      const Vector2d middle(0.5 * (x1 + x2), y0 + 0.5 * (y1 + y2));
      const double second = std::clamp((middle - c).dot(e) / length2, 0.0, 1.0);
      const int at = corner.side, after = (at + 1) % 4;
      by_area.by_corner[at] += (1 - second) * outwards;
      by_area.by_corner[after] += second * outwards;
      by_light.by_corner[at] += (1 - second) * light[k] * outwards;
      by_light.by_corner[after] += second * light[k] * outwards;
    }
  }
}

// The NDF along a groove's section, after docs/model.md 4.25: tan(lean - lean of h) = s tan(psi).
struct SectionLobe {
  double H, along2, across, C, s, sine_h, cosine_h;

  SectionLobe(const Vector3d& h, double alpha, double roughness_across)
      : H(std::hypot(h.x(), h.z())), along2(1 / (alpha * alpha)), across(roughness_across) {
    const double y2 = h.y() * h.y() * along2;
    C = y2 + H * H;
    s = std::sqrt(C / (y2 + H * H * along2 / (across * across)));
    sine_h = -h.x() / H;
    cosine_h = h.z() / H;
  }
  bool dark() const { return !(H > 1e-12); }
  // From a lean's sine and cosine. Walls that lean away from the light by a right angle or more are dark.
  double psi(double sine, double cosine) const {
    const double away = sine * cosine_h - cosine * sine_h, towards = cosine * cosine_h + sine * sine_h;
    return towards > 1e-9 ? std::atan(away / (s * towards)) : std::copysign(std::numbers::pi / 2, away);
  }
  // Factor from the sum over the nodes to the mean over a band.
  double factor(double half_psi, double whole) const {
    return half_psi * s * along2 / (std::numbers::pi * across * C * C) / whole;
  }
};

constexpr int kNodes = 8;

// psi at a band's nodes; returns half of their span.
double fill_nodes(double psi_from, double psi_to, double* psi) {
  const double middle = (psi_from + psi_to) / 2, half = (psi_to - psi_from) / 2;
  for (int k = 0; k < kNodes; ++k) psi[k] = middle + (k < 4 ? kNode[k] : -kNode[k - 4]) * half;
  return half;
}

// Light of several bands together, so SIMD vectors serve all of them.
struct BandSum {
  static constexpr int kMost = 12;
  const SectionLobe& lobe;
  int count = 0;
  std::array<double, kMost> scale;  // a band's area within the footprint times its factor
  std::array<Shape, kMost> shape;
  std::array<double, kMost * kNodes> psi, r2, cos_lean;
  double sum = 0;

  explicit BandSum(const SectionLobe& of) : lobe(of) {}
  void add(const ProfileBand& band, double psi_from, double psi_to, double area) {
    const double half = fill_nodes(psi_from, psi_to, psi.data() + static_cast<std::ptrdiff_t>(kNodes) * count);
    shape[count] = band.shape;
    scale[count] = area * lobe.factor(half, density_integral(band));
    if (++count == kMost) flush();
  }
  void flush() {
    lobe_nodes(kNodes * count, psi.data(), lobe.s, lobe.sine_h, lobe.cosine_h,
               {r2.data(), cos_lean.data(), nullptr, nullptr});
    for (int i = 0; i < count; ++i) {
      double mean = 0;
      for (int k = 0; k < kNodes; ++k)
        mean += kWeight[k % 4] * r2[kNodes * i + k] * density(shape[i], cos_lean[kNodes * i + k]);
      sum += scale[i] * mean;
    }
    count = 0;
  }
};

// Area of a polygon left of x: minus the integral of y dx around it; the side at x adds nothing.
double area_left_of(double x, const Polygon& polygon) {
  const double y0 = polygon.corner[0].p.y();
  double area = 0;
  for (int i = 0; i < polygon.count; ++i) {
    const Vector2d &a = polygon.corner[i].p, &b = polygon.corner[i + 1 < polygon.count ? i + 1 : 0].p;
    const double left = std::min(a.x(), b.x()), right = std::max(a.x(), b.x()), end = std::min(x, right);
    if (!(end > left)) continue;
    const double slope = (b.y() - a.y()) / (b.x() - a.x()), yl = a.x() < b.x() ? a.y() : b.y();
    const double under = (end - left) * (yl - y0 + 0.5 * slope * (end - left));
    area += a.x() < b.x() ? -under : under;
  }
  return area;
}

// visit(which, area) for the bands that a footprint reaches, from left to right. Neighbors share an edge.
template <typename Visit>
void each_area(const Cut& cut, std::span<const ProfileBand> bands, const Visit& visit) {
  double at_mm = cut.left, area_before = 0;
  for (std::size_t k = 0; k < bands.size(); ++k) {
    const double from = 1e-3 * bands[k].from_um, to = 1e-3 * bands[k].to_um;
    if (to <= cut.left || from >= cut.right) continue;
    if (from > at_mm) area_before = area_left_of(from, cut.polygon);
    const double area_after = area_left_of(to, cut.polygon);
    visit(k, std::max(0.0, area_after - area_before));
    at_mm = to;
    area_before = area_after;
  }
}

// band_light() of all bands of a section, in order.
struct BandLights {
  std::vector<double> value, by_hx, by_hy, by_hz, by_alpha;
  std::vector<double> by_depth;  // through the leans of a band's ends, um^-1

  void resize(std::size_t count);
  void set(std::size_t k, const ProfileBand& band, const BandLight& light);
};

void BandLights::resize(std::size_t count) {
  for (std::vector<double>* v : {&value, &by_hx, &by_hy, &by_hz, &by_alpha, &by_depth}) v->assign(count, 0);
}

void BandLights::set(std::size_t k, const ProfileBand& band, const BandLight& light) {
  value[k] = light.value;
  by_hx[k] = light.by_h.x();
  by_hy[k] = light.by_h.y();
  by_hz[k] = light.by_h.z();
  by_alpha[k] = light.by_alpha;
  by_depth[k] = light.by_from_lean * band.from_lean_by_depth + light.by_to_lean * band.to_lean_by_depth;
}

}  // namespace

BandLight band_light(const ProfileBand& band, const Vector3d& h, double alpha, double across) {
  BandLight out;
  if (band.shape == Shape::flank || band.from_lean == band.to_lean) {
    const PointLight p = point_light(h, band.from_sine, band.from_cosine, alpha, across, true);
    out.value = p.D;
    out.by_alpha = p.by_alpha;
    out.by_h = p.by_h;
    return out;
  }
  const SectionLobe lobe(h, alpha, across);
  if (lobe.dark()) return out;
  const double psi_from = lobe.psi(band.from_sine, band.from_cosine), psi_to = lobe.psi(band.to_sine, band.to_cosine);
  std::array<double, kNodes> psi, r2, cos_away, sin_away, cos_lean;
  const double half = fill_nodes(psi_from, psi_to, psi.data()), whole = density_integral(band),
               factor = lobe.factor(half, whole);
  lobe_nodes(kNodes, psi.data(), lobe.s, lobe.sine_h, lobe.cosine_h,
             {r2.data(), cos_lean.data(), cos_away.data(), sin_away.data()});
  // By h in the lobe's own frame: Q = m^2 across2 + y^2 along2 + n^2, with m along the wall and n out of it.
  const double along2 = lobe.along2, across2 = along2 / (across * across), y2 = h.y() * h.y() * along2;
  Vector2d by_h(0, 0);
  double by_Q = 0;
  for (int k = 0; k < kNodes; ++k) {
    const double weight = kWeight[k % 4] * factor * r2[k] * density(band.shape, cos_lean[k]);
    out.value += weight;
    const double m = lobe.H * sin_away[k], n = lobe.H * cos_away[k], m2 = m * m * across2, Q = m2 + y2 + n * n;
    const double share = 4 * weight / Q;
    by_h -= share * Vector2d(m * across2 * cos_away[k] - n * sin_away[k], m * across2 * sin_away[k] + n * cos_away[k]);
    by_Q += share;
    out.by_alpha += share * (m2 + y2) - 2 * weight;
  }
  out.by_alpha /= alpha;
  out.by_h = {lobe.cosine_h * by_h.x() - lobe.sine_h * by_h.y(), -h.y() * along2 * by_Q,
              lobe.sine_h * by_h.x() + lobe.cosine_h * by_h.y()};
  const auto at = [&](double sine, double cosine) { return point_light(h, sine, cosine, alpha, across, false).D; };
  out.by_to_lean = density(band.shape, band.to_cosine) * (at(band.to_sine, band.to_cosine) - out.value) / whole;
  out.by_from_lean =
      -density(band.shape, band.from_cosine) * (at(band.from_sine, band.from_cosine) - out.value) / whole;
  return out;
}

FootprintValue profile_integral(const GrooveSegment& groove, std::span<const ProfileBand> bands, double across,
                                const Quad& corners_mm, const Vector3d& h_scratch) {
  FootprintValue out{};
  const Cut cut = cut_to_length(corners_mm, groove.length_mm);
  if (cut.polygon.count < 3) return out;
  const Vector3d h = h_scratch.normalized();
  const SectionLobe lobe(h, groove.alpha, across);
  BandSum arcs(lobe);
  double lean = 0, psi = 0;  // at the edge that a band shares with the next
  bool psi_known = false;
  each_area(cut, bands, [&](std::size_t k, double area) {
    const ProfileBand& band = bands[k];
    out.area_mm2 += area;
    if (band.shape == Shape::flank || band.from_lean == band.to_lean) {
      out.Dhat_mm2 += area * point_light(h, band.from_sine, band.from_cosine, groove.alpha, across, false).D;
      return;
    }
    if (lobe.dark()) return;
    if (!psi_known || lean != band.from_lean) psi = lobe.psi(band.from_sine, band.from_cosine);
    const double psi_to = lobe.psi(band.to_sine, band.to_cosine);
    arcs.add(band, psi, psi_to, area);
    psi = psi_to;
    lean = band.to_lean;
    psi_known = true;
  });
  arcs.flush();
  out.Dhat_mm2 += arcs.sum;
  return out;
}

namespace {

FootprintGradient gradient_within(const Cut& cut, std::span<const ProfileBand> bands, const BandLights& lights) {
  FootprintGradient out{};
  out.dDhat_dcorner.fill(Vector2d::Zero());
  out.darea_dcorner.fill(Vector2d::Zero());
  out.dDhat_dhalf.setZero();
  if (cut.polygon.count >= 3) {
    thread_local std::vector<BandShare> shares;
    shares.assign(bands.size(), {});
    SideSums by_area, by_light;
    walk(cut, bands, lights.value, shares, by_area, by_light);
    for (std::size_t k = 0; k < bands.size(); ++k) {
      const ProfileBand& band = bands[k];
      const double area = std::max(0.0, shares[k].area);
      out.value.area_mm2 += area;
      out.value.Dhat_mm2 += area * lights.value[k];
      const double by_depth = 1e-3 * (shares[k].at_to * band.to_by_depth - shares[k].at_from * band.from_by_depth);
      out.darea_ddepth_um += by_depth;
      out.dDhat_ddepth_um += lights.value[k] * by_depth + area * lights.by_depth[k];
      const double by_width = 1e-3 * (shares[k].at_to * band.to_by_width - shares[k].at_from * band.from_by_width);
      out.darea_dwidth_um += by_width;
      out.dDhat_dwidth_um += lights.value[k] * by_width + area * band.depth_for_width * lights.by_depth[k];
      out.dDhat_dalpha += area * lights.by_alpha[k];
      out.dDhat_dhalf += area * Vector3d(lights.by_hx[k], lights.by_hy[k], lights.by_hz[k]);
    }
    for (int i = 0; i < 4; ++i) {
      out.darea_dcorner[cut.order[i]] = by_area.by_corner[i];
      out.dDhat_dcorner[cut.order[i]] = by_light.by_corner[i];
    }
    out.darea_dlength_mm = by_area.by_length;
    out.dDhat_dlength_mm = by_light.by_length;
  }
  return out;
}

}  // namespace

FootprintGradient profile_integral_gradient(const GrooveSegment& groove, std::span<const ProfileBand> bands,
                                            double across, const Quad& corners_mm, const Vector3d& h_scratch) {
  const Vector3d h = h_scratch.normalized();
  const Cut cut = cut_to_length(corners_mm, groove.length_mm);
  thread_local BandLights lights;  // buffers of the thread, because the caller runs per pixel and groove
  lights.resize(bands.size());
  for (std::size_t k = 0; k < bands.size() && cut.polygon.count >= 3; ++k)
    if (1e-3 * bands[k].to_um > cut.left && 1e-3 * bands[k].from_um < cut.right)
      lights.set(k, bands[k], band_light(bands[k], h, groove.alpha, across));
  return gradient_within(cut, bands, lights);
}

}  // namespace burin
