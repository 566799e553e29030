// What the footprint integral promises: the right value and gradient everywhere, and never NaN.
// Oracles: a table of 50-digit values made without any closed form; slicing and quadrature in long double, written here
// from docs/model.md 2 to 4 alone (D through |n x h|^2, not through the two lobes); limits and symmetries that hold
// exactly.
#include "burin/render/footprint/footprint_integral.h"
#include "tests/places.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "burin/render/footprint/footprint_core.h"
#include "burin/render/footprint/ndf_cases.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/groove.h"

namespace burin {
namespace {

using Real = long double;

// ---- The oracle: Dhat = integral over x of (length of the region at x) * D(h, n(x)), pieces graded towards D's peak.
// ----

struct Problem {
  GrooveSegment groove;
  Quad corners_mm;
  Eigen::Vector3d h{0, 0, 1};
};

struct LegendreRule {
  std::vector<Real> x, weight;
};

const LegendreRule& legendre_rule() {
  static const LegendreRule rule = [] {
    constexpr int n = 24;
    LegendreRule r;
    for (int i = 0; i < n; ++i) {
      Real x = std::cos(std::numbers::pi_v<Real> * (i + 0.75L) / (n + 0.5L)), slope = 0;
      for (int step = 0; step < 50; ++step) {
        Real before = 1, here = x;
        for (int k = 2; k <= n; ++k) {
          const Real next = ((2 * k - 1) * x * here - (k - 1) * before) / k;
          before = here;
          here = next;
        }
        slope = n * (x * here - before) / (x * x - 1);
        x -= here / slope;
      }
      r.x.push_back(x);
      r.weight.push_back(2 / ((1 - x * x) * slope * slope));
    }
    return r;
  }();
  return rule;
}

// D through sin^2: 1 - r^2 (n.h)^2 = |n x h|^2 + alpha^2 (n.h)^2 for unit vectors.
Real point_ndf(Real t, const Problem& p) {
  Real hx = p.h.x(), hy = p.h.y(), hz = p.h.z();
  const Real norm = std::sqrt(hx * hx + hy * hy + hz * hz);
  hx /= norm, hy /= norm, hz /= norm;
  const Real a = 1 + t * t, nx = -2 * t / a, nz = (1 - t * t) / a;
  const Real c = nx * hx + nz * hz;
  if (!(c > 0)) return 0;
  const Real cross_y = nz * hx - nx * hz, alpha = p.groove.alpha;
  const Real sin2 = hy * hy + cross_y * cross_y;
  const Real q = sin2 + alpha * alpha * c * c;
  return alpha * alpha / (std::numbers::pi_v<Real> * q * q);
}

// Length along y of the convex quadrilateral at x, cut to the scratch.
Real extent(Real x, const Problem& p) {
  Real low = INFINITY, high = -INFINITY;
  for (int i = 0; i < 4; ++i) {
    const Real x1 = p.corners_mm[i].x(), y1 = p.corners_mm[i].y();
    const Real x2 = p.corners_mm[(i + 1) % 4].x(), y2 = p.corners_mm[(i + 1) % 4].y();
    if ((x1 <= x) == (x2 <= x)) continue;
    const Real y = y1 + (y2 - y1) * ((x - x1) / (x2 - x1));
    low = std::min(low, y);
    high = std::max(high, y);
  }
  if (low > high) return 0;
  const Real length = p.groove.length_mm;
  return std::clamp(high, Real(0), length) - std::clamp(low, Real(0), length);
}

struct Quadrature {
  Real Dhat_mm2, area_mm2;
};

Quadrature quadrature(const Problem& p) {
  const Real wt = Real(p.groove.width_um) / 1000, d = Real(p.groove.depth_um) / 1000;
  const Real w = wt / 2 * std::sqrt(-std::expm1(-2 * d / wt));
  std::vector<Real> cuts{-w, w};
  const auto cut = [&](Real x) {
    if (x > -w && x < w) cuts.push_back(x);
  };
  for (int i = 0; i < 4; ++i) {
    const Real x1 = p.corners_mm[i].x(), y1 = p.corners_mm[i].y();
    const Real x2 = p.corners_mm[(i + 1) % 4].x(), y2 = p.corners_mm[(i + 1) % 4].y();
    cut(x1);
    for (const Real end : {Real(0), Real(p.groove.length_mm)}) {
      if ((y1 < end) != (y2 < end)) cut(x1 + (x2 - x1) * ((end - y1) / (y2 - y1)));
    }
  }
  // Peak where n lies in the plane of h; its width in t is of the order of the angle between h and that plane, and
  // alpha.
  const Real H = std::hypot(Real(p.h.x()), Real(p.h.z())), hz = p.h.z(), hx = p.h.x();
  const Real peak = -hx / (H + hz), half_angle = std::hypot(Real(p.h.y()), Real(p.groove.alpha)) / 4;
  cut(peak * wt / 2);
  for (Real away = half_angle; away < 2; away *= 1.6L) {
    cut((peak - away) * wt / 2);
    cut((peak + away) * wt / 2);
  }
  cut((hx >= 0 ? hz / (hx + H) : -hz / (H - hx)) * wt / 2);  // n.h = 0
  std::sort(cuts.begin(), cuts.end());
  Quadrature sum{0, 0};
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const Real middle = (cuts[i] + cuts[i + 1]) / 2, half = (cuts[i + 1] - cuts[i]) / 2;
    for (std::size_t k = 0; k < legendre_rule().x.size(); ++k) {
      const Real x = middle + half * legendre_rule().x[k];
      const Real dA = half * legendre_rule().weight[k] * extent(x, p);
      sum.area_mm2 += dA;
      sum.Dhat_mm2 += dA * point_ndf(2 * x / wt, p);
    }
  }
  return sum;
}

// ---- Problems drawn at random, realistic and beyond. ----

double diameter_mm(const Quad& q) {
  double d = 0;
  for (const auto& a : q) {
    for (const auto& b : q) d = std::max(d, (a - b).norm());
  }
  return d;
}

double peak(const Problem& p) { return 1 / (std::numbers::pi * p.groove.alpha * p.groove.alpha); }

class DrawnCase {
 public:
  explicit DrawnCase(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<>(low, high)(engine_); }
  double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }

  // A convex quadrilateral over the scratch: four places on an ellipse, in order.
  Problem problem(double least_alpha = 0.005, double most_tilt_rad = 1.2) {
    Problem p;
    p.groove = {log_uniform(50, 800), 0, log_uniform(least_alpha, 1), log_uniform(0.5, 20)};
    p.groove.depth_um = p.groove.width_um * log_uniform(0.003, 0.6);
    const double w_mm = half_width_um(p.groove.width_um, p.groove.depth_um) / 1000;
    const double radius_mm = w_mm * log_uniform(0.05, 20);
    const Eigen::Vector2d center(uniform(-1, 1) * (w_mm + 0.5 * radius_mm),
                                 uniform(-0.5 * radius_mm, p.groove.length_mm + 0.5 * radius_mm));
    const double turn = uniform(0, 6.28), squash = uniform(0.3, 1);
    for (int i = 0; i < 4; ++i) {
      const double angle = std::numbers::pi / 2 * (i + uniform(-0.4, 0.4));
      const Eigen::Vector2d on_ellipse(std::cos(angle), squash * std::sin(angle));
      p.corners_mm[i] = center + radius_mm * (Eigen::Rotation2Dd(turn) * on_ellipse);
    }
    const double tilt = uniform(0, most_tilt_rad), azimuth = uniform(-3.2, 3.2);
    p.h = {std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)};
    return p;
  }

 private:
  std::mt19937 engine_;
};

FootprintValue value(const Problem& p) { return footprint_integral(p.groove, p.corners_mm, p.h); }

// Proves value and gradient against numbers that no closed form made, over all kinds of cases.
TEST(FootprintIntegral, EveryRowOfTheTableOfKnownCases) {
  const std::filesystem::path file = std::filesystem::path(places::data()) / "ndf-cases.csv";
  const auto cases = read_ndf_cases(file);
  EXPECT_GE(cases.size(), 100u);
  for (const auto& c : cases) {
    EXPECT_TRUE(c.Dhat_gradient && c.area_gradient && c.area_mm2);
    const auto r = compare(c);
    EXPECT_TRUE(r.ok()) << ndf_line(r);
  }
}

// Proves the value and area where the table has no row. 1e-12: a decade and a half above what is seen, and the oracle's
// own cuts carry 1e-16 of the scratch's size. The floor is the table's: D's conditioning in h where the lobe looks
// elsewhere.
TEST(FootprintIntegral, AgreesWithSlicingInLongDouble) {
  DrawnCase draw(1);
  int lit = 0;
  for (int i = 0; i < 1500; ++i) {
    const Problem p = draw.problem();
    const auto got = value(p);
    const auto want = quadrature(p);
    const double floor = 1e-15 * std::pow(diameter_mm(p.corners_mm), 2);
    EXPECT_NEAR(got.Dhat_mm2, double(want.Dhat_mm2), 1e-12 * double(want.Dhat_mm2) + floor * peak(p)) << i;
    EXPECT_NEAR(got.area_mm2, double(want.area_mm2), 1e-12 * double(want.area_mm2) + floor) << i;
    lit += got.Dhat_mm2 > 0;
  }
  EXPECT_GT(lit, 700);  // the draw does hit scratches
}

// Proves every derivative against fourth-order central differences of the oracle, not of the code under test. Long
// double leaves about 1e-19 / step; the steps are 1e-4 of the variable's own scale, their truncation about 1e-16 to
// 1e-10 of the gradient except where a corner crosses the rim or an end within the step (few draws; they are left out
// by asking two step sizes to agree).
TEST(FootprintIntegral, GradientAgreesWithDifferencesOfTheOracle) {
  DrawnCase draw(2);
  int compared = 0;
  for (int i = 0; i < 80; ++i) {
    const Problem p = draw.problem(0.02, 1.0);
    if (value(p).Dhat_mm2 == 0) continue;
    const auto g = footprint_integral_gradient(p.groove, p.corners_mm, p.h);
    EXPECT_EQ(g.value.Dhat_mm2, value(p).Dhat_mm2);
    EXPECT_EQ(g.value.area_mm2, value(p).area_mm2);

    const double size_mm =
        std::min(diameter_mm(p.corners_mm), half_width_um(p.groove.width_um, p.groove.depth_um) / 1000);
    // Two directions tangential to h.
    const Eigen::Vector3d along_y =
        Eigen::Vector3d(-p.h.x() * p.h.y(), 1 - p.h.y() * p.h.y(), -p.h.z() * p.h.y()).normalized();
    const Eigen::Vector3d across = p.h.cross(along_y);
    struct Variable {
      const char* name;
      std::function<void(Problem&, double)> move;
      double step, dDhat, darea;
    };
    std::vector<Variable> variables{
        {"h along y", [&](Problem& q, double s) { q.h += s * along_y; }, 1e-3 * p.groove.alpha,
         along_y.dot(g.dDhat_dhalf), 0},
        {"h across", [&](Problem& q, double s) { q.h += s * across; }, 1e-3 * p.groove.alpha, across.dot(g.dDhat_dhalf),
         0},
        {"alpha", [](Problem& q, double s) { q.groove.alpha += s; }, 1e-4 * p.groove.alpha, g.dDhat_dalpha, 0},
        {"width_um", [](Problem& q, double s) { q.groove.width_um += s; }, 1e-5 * p.groove.width_um, g.dDhat_dwidth_um,
         g.darea_dwidth_um},
        {"depth_um", [](Problem& q, double s) { q.groove.depth_um += s; }, 1e-5 * p.groove.depth_um, g.dDhat_ddepth_um,
         g.darea_ddepth_um},
        {"length_mm", [](Problem& q, double s) { q.groove.length_mm += s; }, 1e-4 * size_mm, g.dDhat_dlength_mm,
         g.darea_dlength_mm}};
    for (int c = 0; c < 4; ++c) {
      for (int k = 0; k < 2; ++k) {
        variables.push_back({k ? "corner y" : "corner x", [c, k](Problem& q, double s) { q.corners_mm[c][k] += s; },
                             1e-4 * size_mm, g.dDhat_dcorner[c][k], g.darea_dcorner[c][k]});
      }
    }
    double scale_D = 0, scale_area = 0;  // a variable's derivative times its own scale: one measure for all of them
    for (const auto& v : variables) {
      scale_D = std::max(scale_D, std::abs(v.dDhat * v.step));
      scale_area = std::max(scale_area, std::abs(v.darea * v.step));
    }
    for (const auto& v : variables) {
      const auto at = [&](double s) {
        Problem q = p;
        v.move(q, s);
        return quadrature(q);
      };
      const auto difference = [&](double s) {
        const auto a = at(s), b = at(-s), a2 = at(2 * s), b2 = at(-2 * s);
        return Quadrature{(8 * (a.Dhat_mm2 - b.Dhat_mm2) - (a2.Dhat_mm2 - b2.Dhat_mm2)) / (12 * Real(s)),
                          (8 * (a.area_mm2 - b.area_mm2) - (a2.area_mm2 - b2.area_mm2)) / (12 * Real(s))};
      };
      const auto coarse = difference(v.step), fine = difference(v.step / 2);
      const double tolerance = 1e-7 * scale_D / v.step, area_tolerance = 1e-7 * scale_area / v.step;
      if (std::abs(coarse.Dhat_mm2 - fine.Dhat_mm2) > tolerance / 4 ||
          std::abs(coarse.area_mm2 - fine.area_mm2) > area_tolerance / 4 + 1e-30) {
        continue;
      }
      ++compared;
      EXPECT_NEAR(v.dDhat, double(fine.Dhat_mm2), tolerance) << v.name << ", case " << i;
      EXPECT_NEAR(v.darea, double(fine.area_mm2), area_tolerance + 1e-20) << v.name << ", case " << i;
    }
  }
  EXPECT_GT(compared, 400);
}

// Proves that what is cut in two adds up: no gap and no overlap at any line, for values and shared derivatives. The
// points of the cut are rounded to doubles, which moves the cut by 1e-16 of their coordinates: the floor knows it.
TEST(FootprintIntegral, SplitQuadsAddUp) {
  DrawnCase draw(3);
  for (int i = 0; i < 500; ++i) {
    Problem p = draw.problem();
    const double at = draw.uniform(0, 1), at2 = draw.uniform(0, 1);
    const Eigen::Vector2d a = p.corners_mm[0] + at * (p.corners_mm[1] - p.corners_mm[0]);
    const Eigen::Vector2d b = p.corners_mm[3] + at2 * (p.corners_mm[2] - p.corners_mm[3]);
    Problem left = p, right = p;
    left.corners_mm = {p.corners_mm[0], a, b, p.corners_mm[3]};
    right.corners_mm = {a, p.corners_mm[1], p.corners_mm[2], b};
    const auto whole = footprint_integral_gradient(p.groove, p.corners_mm, p.h);
    const auto l = footprint_integral_gradient(p.groove, left.corners_mm, p.h);
    const auto r = footprint_integral_gradient(p.groove, right.corners_mm, p.h);
    const double size = diameter_mm(p.corners_mm);
    const double floor = size * (1e-14 * size + 1e-15 * p.corners_mm[0].cwiseAbs().maxCoeff());
    EXPECT_NEAR(whole.value.Dhat_mm2, l.value.Dhat_mm2 + r.value.Dhat_mm2,
                1e-12 * whole.value.Dhat_mm2 + floor * peak(p));
    EXPECT_NEAR(whole.value.area_mm2, l.value.area_mm2 + r.value.area_mm2, 1e-12 * whole.value.area_mm2 + floor);
    const double sum_alpha = l.dDhat_dalpha + r.dDhat_dalpha;
    EXPECT_NEAR(whole.dDhat_dalpha, sum_alpha, (1e-11 * whole.value.Dhat_mm2 + floor * peak(p)) * 10 / p.groove.alpha);
  }
}

// Proves invariances: order of corners, mirror images, moving along the scratch, the choice of units, the length of h.
TEST(FootprintIntegral, SymmetriesHold) {
  DrawnCase draw(4);
  for (int i = 0; i < 500; ++i) {
    const Problem p = draw.problem();
    const auto reference = value(p);
    const double floor = 1e-15 * std::pow(diameter_mm(p.corners_mm), 2) * peak(p);
    const auto same = [&](const Problem& q, const char* what, double factor = 1) {
      EXPECT_NEAR(value(q).Dhat_mm2, factor * reference.Dhat_mm2, factor * (2e-12 * reference.Dhat_mm2 + floor))
          << what;
      EXPECT_NEAR(value(q).area_mm2, factor * reference.area_mm2, factor * (2e-12 * reference.area_mm2 + floor))
          << what;
    };
    Problem q = p;
    std::reverse(q.corners_mm.begin(), q.corners_mm.end());
    same(q, "clockwise");
    q = p;
    std::rotate(q.corners_mm.begin(), q.corners_mm.begin() + 1, q.corners_mm.end());
    same(q, "another first corner");
    q = p;
    for (auto& c : q.corners_mm) c.x() = -c.x();
    q.h.x() = -q.h.x();
    same(q, "mirrored across");
    q = p;
    for (auto& c : q.corners_mm) c.y() = p.groove.length_mm - c.y();
    q.h.y() = -q.h.y();
    same(q, "seen from the other end");
    q = p;
    for (auto& c : q.corners_mm) c *= 3;
    q.groove.width_um *= 3;
    q.groove.depth_um *= 3;
    q.groove.length_mm *= 3;
    same(q, "three times as large", 9);
    q = p;
    q.h *= 2;
    same(q, "h of another length");
  }
}

// Proves the limit of a perfectly rough wall: D = 1 / pi wherever n.h > 0, so Dhat is the area of that part over pi.
TEST(FootprintIntegral, RoughnessOneIsTheVisibleAreaOverPi) {
  DrawnCase draw(5);
  for (int i = 0; i < 200; ++i) {
    Problem p = draw.problem(0.005, 1.5);
    p.groove.alpha = 1;
    const double tilt = std::acos(p.h.z()), wall = 2 * std::atan(groove_rim(p.groove.width_um, p.groove.depth_um));
    if (tilt + wall > 1.5) continue;  // some of the wall may turn its back
    EXPECT_NEAR(value(p).Dhat_mm2, value(p).area_mm2 / std::numbers::pi, 1e-13 * value(p).area_mm2);
  }
  // n.h = 0 exactly at the bottom of the groove when h lies in the plane across it: half of the groove is visible.
  Problem p;
  p.groove = {400, 60, 1, 10};
  p.corners_mm = {Eigen::Vector2d(-1, 2), {1, 2}, {1, 3}, {-1, 3}};
  p.h = {1, 0, 0};
  EXPECT_NEAR(value(p).Dhat_mm2, value(p).area_mm2 / 2 / std::numbers::pi, 1e-14);
}

// Proves the absolute scale, which no comparison of two codes for D can: GGX is normalized, so the integral of D (n.h)
// over all h is 1 for each n. Dhat has no (n.h), but for a shallow groove n is nearly z, and the integral of Dhat h_z
// over all h is the area but for the square of the slope, here 4e-4.
TEST(FootprintIntegral, AllHalfVectorsTogetherGiveTheArea) {
  Problem p;
  p.groove = {400, 0.02, 0.2, 10};  // slopes up to 0.02 rad
  p.corners_mm = {Eigen::Vector2d(-0.1, 2), {0.1, 2}, {0.1, 2.1}, {-0.1, 2.1}};
  Real sum = 0;
  constexpr int kAzimuths = 64;
  for (int panel = 0; panel < 8; ++panel) {
    for (std::size_t k = 0; k < legendre_rule().x.size(); ++k) {
      const Real u = (panel + (legendre_rule().x[k] + 1) / 2) / 8, tilt = u * std::numbers::pi_v<Real> / 2;
      const Real d_tilt = legendre_rule().weight[k] / 2 / 8 * std::numbers::pi_v<Real> / 2;
      for (int j = 0; j < kAzimuths; ++j) {
        const Real azimuth = 2 * std::numbers::pi_v<Real> * j / kAzimuths;
        p.h = {double(std::sin(tilt) * std::cos(azimuth)), double(std::sin(tilt) * std::sin(azimuth)),
               double(std::cos(tilt))};
        sum += value(p).Dhat_mm2 * std::cos(tilt) * std::sin(tilt) * d_tilt * 2 * std::numbers::pi_v<Real> / kAzimuths;
      }
    }
  }
  EXPECT_NEAR(double(sum), value(p).area_mm2, 1e-3 * value(p).area_mm2);
}

// Proves that normal incidence is a limit like any other: the value there is what values beside it approach, from all
// sides, for glossy and for nearly mirror-like walls.
TEST(FootprintIntegral, NormalIncidenceIsALimit) {
  for (const double alpha : {4e-4, 0.02, 0.3}) {
    Problem p;
    p.groove = {400, 14, alpha, 10};
    p.corners_mm = {Eigen::Vector2d(-0.03, 2), {0.15, 2.05}, {0.1, 2.2}, {-0.05, 2.17}};
    const auto at_normal = footprint_integral_gradient(p.groove, p.corners_mm, p.h);
    for (const double tilt : {1e-12, 1e-9}) {
      for (const double azimuth : {0.0, 1.0, 1.5707963267948966, 3.0}) {
        p.h = {tilt * std::cos(azimuth), tilt * std::sin(azimuth), 1};
        const auto beside = footprint_integral_gradient(p.groove, p.corners_mm, p.h);
        EXPECT_NEAR(beside.value.Dhat_mm2, at_normal.value.Dhat_mm2,
                    (1e-12 + 3 * tilt / alpha) * at_normal.value.Dhat_mm2);
        EXPECT_NEAR(beside.dDhat_dalpha, at_normal.dDhat_dalpha,
                    (1e-11 + 10 * tilt / alpha) * std::abs(at_normal.dDhat_dalpha));
      }
    }
  }
}

// Proves that touching, missing and degenerate footprints give exactly nothing.
TEST(FootprintIntegral, NothingWhereThereIsNothing) {
  const GrooveSegment groove{400, 20, 0.05, 5};
  const double w = half_width_um(400.0, 20.0) / 1000;
  const Eigen::Vector3d h(0.1, 0.05, 0.99);
  const auto nothing = [&](const GrooveSegment& g, const Quad& q) {
    const auto r = footprint_integral_gradient(g, q, h);
    return r.value.Dhat_mm2 == 0 && r.value.area_mm2 == 0;
  };
  EXPECT_TRUE(nothing(groove, {Eigen::Vector2d(w + 0.1, 1), {w + 0.2, 1}, {w + 0.2, 2}, {w + 0.1, 2}})) << "beside";
  EXPECT_TRUE(nothing(groove, {Eigen::Vector2d(-0.1, -1), {0.1, -1}, {0.1, 0}, {-0.1, 0}})) << "touching the first end";
  EXPECT_TRUE(nothing(groove, {Eigen::Vector2d(-0.1, 5), {0.1, 5}, {0.1, 6}, {-0.1, 6}})) << "touching the second end";
  EXPECT_TRUE(nothing(groove, {Eigen::Vector2d(0, 1), {0, 1}, {0, 1}, {0, 1}})) << "a point";
  const Quad across{Eigen::Vector2d(-0.1, 1), {0.1, 1}, {0.1, 2}, {-0.1, 2}};
  EXPECT_FALSE(nothing(groove, across));
  EXPECT_TRUE(nothing({0, 20, 0.05, 5}, across)) << "no width";
  EXPECT_TRUE(nothing({400, 0, 0.05, 5}, across)) << "no depth";
  EXPECT_TRUE(nothing({400, 20, 0.05, 0}, across)) << "no length";
  EXPECT_EQ(footprint_integral(groove, across, {0, 1, 0}).Dhat_mm2, 0) << "h along the groove: n.h = 0";
  EXPECT_EQ(footprint_integral(groove, across, {0, 0, -1}).Dhat_mm2, 0) << "h below the face";
  EXPECT_EQ(footprint_integral(groove, across, {0, 0, 0}).Dhat_mm2, 0) << "h of no direction";
  EXPECT_GT(footprint_integral(groove, across, {0, 0, 0}).area_mm2, 0);
}

bool all_finite(const FootprintGradient& g) {
  double sum = g.value.Dhat_mm2 + g.value.area_mm2 + g.dDhat_dhalf.sum() + g.dDhat_dalpha + g.dDhat_dwidth_um +
               g.darea_dwidth_um + g.dDhat_ddepth_um + g.darea_ddepth_um + g.dDhat_dlength_mm + g.darea_dlength_mm;
  for (int i = 0; i < 4; ++i) sum += g.dDhat_dcorner[i].sum() + g.darea_dcorner[i].sum();
  return std::isfinite(sum);
}

// Proves that no finite input gives NaN, infinity or a negative number, and no value exceeds area times peak: quads of
// any shape (crossed, folded, collapsed), of any size and distance, special and general half vectors, extreme grooves.
TEST(FootprintIntegral, NeverNaN) {
  DrawnCase draw(6);
  for (int i = 0; i < 60000; ++i) {
    Problem p;
    p.groove = {draw.log_uniform(1e-3, 1e5), draw.log_uniform(1e-4, 1e5), draw.log_uniform(1e-7, 1),
                draw.log_uniform(1e-6, 1e4)};
    if (i % 17 == 0) p.groove.alpha = 1;
    const double size = draw.log_uniform(1e-9, i % 5 ? 10 : 1e9), far = i % 3 ? 0 : draw.log_uniform(1e-6, 1e12);
    for (auto& c : p.corners_mm) {
      c = {far * draw.uniform(-1, 1) + size * draw.uniform(-1, 1),
           size * draw.uniform(-1, 1) + far * draw.uniform(-1, 1)};
    }
    if (i % 7 == 0) p.corners_mm[1] = p.corners_mm[0];
    if (i % 11 == 0) p.corners_mm[2].x() = p.corners_mm[1].x();
    if (i % 13 == 0) p.corners_mm[3] = p.corners_mm[1];
    if (i % 19 == 0) p.corners_mm[0].x() = half_width_um(p.groove.width_um, p.groove.depth_um) / 1000;
    p.h = {draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1)};
    if (i % 2) p.h.z() = std::abs(p.h.z());
    if (i % 23 == 0) p.h.x() = 0;
    if (i % 29 == 0) p.h.y() = 0;
    if (i % 31 == 0) p.h.z() = 0;
    if (i % 37 == 0) p.h = {draw.log_uniform(1e-300, 1), 0, 1};
    if (i % 41 == 0) p.h *= draw.log_uniform(1e-200, 1e200);
    const auto g = footprint_integral_gradient(p.groove, p.corners_mm, p.h);
    ASSERT_TRUE(all_finite(g)) << i;
    ASSERT_GE(g.value.Dhat_mm2, 0) << i;
  }
  // And convex ones stay below area times peak.
  for (int i = 0; i < 5000; ++i) {
    const Problem p = draw.problem(4e-4, 1.57);
    const auto v = value(p);
    EXPECT_LE(v.Dhat_mm2,
              v.area_mm2 * peak(p) * (1 + 1e-12) + 1e-15 * std::pow(diameter_mm(p.corners_mm), 2) * peak(p));
  }
  EXPECT_EQ(value({{400, 20, 0.05, 5}, {Eigen::Vector2d(1e300, 0), {1.1e300, 0}, {1.1e300, 1}, {1e300, 1}}, {0, 0, 1}})
                .Dhat_mm2,
            0);
}

// Proves h far below the face right as well: it never lights a bench, but a calibration may stray there.
TEST(FootprintIntegral, HalfVectorsBelowTheFace) {
  DrawnCase draw(7);
  int lit = 0;
  for (int i = 0; i < 2000; ++i) {
    Problem p = draw.problem(0.01);
    const double below = draw.uniform(0, 1.4), azimuth = draw.uniform(-3.2, 3.2);
    p.h = {std::cos(below) * std::cos(azimuth), std::cos(below) * std::sin(azimuth), -std::sin(below)};
    const auto want = quadrature(p);
    lit += want.Dhat_mm2 > 0;
    const double floor = 1e-15 * std::pow(diameter_mm(p.corners_mm), 2) * peak(p);
    EXPECT_NEAR(value(p).Dhat_mm2, double(want.Dhat_mm2), 1e-11 * double(want.Dhat_mm2) + floor) << i;
  }
  EXPECT_GT(lit, 100);
}

// One pixel of that shape on one groove, seen from straight above from afar, with the half vector h.
ViewScene lone_pixel(const Problem& p) {
  const Eigen::Vector2d groove_mm(50, 50);
  FootprintGrid grid;
  grid.window = {0, 0, 1, 1};
  Eigen::Vector2d middle(0, 0);
  for (const int k : {0, 1, 3, 2}) {
    const Eigen::Vector2d corner = groove_mm + p.corners_mm[k];
    grid.corner_x_mm.push_back(corner.x());
    grid.corner_y_mm.push_back(corner.y());
    middle += 0.25 * corner;
  }
  constexpr double kFar = 1e4;
  const Eigen::Vector3d center(middle.x(), middle.y(), 0), up(0, 0, 1);
  grid.center_mm = {center};
  grid.normal = {up};
  ViewScene scene;
  scene.grid = share(std::move(grid));
  scene.camera_center_mm = center + kFar * up;
  scene.light.position_mm = center + kFar * (2 * p.h.z() * p.h - up);
  scene.light.intensity.setConstant(kFar * kFar);
  scene.material.alpha = p.groove.alpha;
  scene.material.depth_um = p.groove.depth_um;
  scene.tool_width_um = p.groove.width_um;
  return scene;
}

// Proves the float packets for whatever shape a pixel has: 0.2 to 5 groove widths large, alpha >= 0.015. 2e-5 relative
// and 5e-6 of what the pixel could send (its groove's area times the peak).
TEST(FootprintIntegral, FloatPacketsKeepTheirDigitsInLonePixelsOfAnyShape) {
  int compared = 0;
  double sum_squares = 0;
  for (unsigned seed = 8; seed < 28; ++seed) {
    DrawnCase draw(seed);
    for (int i = 0; i < 4000; ++i) {
      const Problem p = draw.problem(0.015, 0.7);
      const double size = diameter_mm(p.corners_mm) / (p.groove.width_um / 1000);
      if (size < 0.2 || size > 5) continue;
      const ViewScene scene = lone_pixel(p);
      Carved carved;
      for (const auto column : {&Scratches::x0_mm, &Scratches::x1_mm, &Scratches::y0_mm})
        (carved.scratches.*column).push_back(50);
      carved.scratches.y1_mm = {50 + p.groove.length_mm};
      RenderOptions in_double;
      in_double.use_double = true;
      Image exact, fast;
      ViewRenderer(scene, in_double).forward(carved, exact);
      ViewRenderer(scene).forward(carved, fast);
      const double covered = value(p).area_mm2 / std::abs(signed_area_mm2(p.corners_mm)), most = covered * peak(p) / 4;
      const double off = static_cast<double>(fast.data[0]) - exact.data[0];
      EXPECT_NEAR(off, 0, 2e-5 * exact.data[0] + 5e-6 * most) << "seed " << seed << ", problem " << i;
      if (most > 0) sum_squares += std::pow(off / (exact.data[0] + most), 2);
      compared += most > 0;
    }
  }
  EXPECT_GT(compared, 20000);
  EXPECT_LT(std::sqrt(sum_squares / compared), 1e-6);
}

// Proves that means are moments over lengths, and that the mean of an empty interval is the integrand itself.
TEST(FootprintCore, MeansAndMomentsAgree) {
  const auto lobes = footprint::make_lobes(0.2, 0.1, std::sqrt(0.95), 0.1);
  for (const auto& [t1, t2] : {std::pair{-0.4, 0.3}, {-0.2, -0.1}, {0.1, 0.1001}}) {
    const auto moments = footprint::moments_with_derivatives(lobes, t1, t2);
    const auto means = footprint::mean_moments_with_derivatives(lobes, t1, t2);
    const double length = t2 - t1;
    EXPECT_NEAR(moments.value.m0, length * means.value.m0, 1e-13 * moments.value.m0);
    EXPECT_NEAR(moments.value.m1, length * length / 2 * means.value.m1, 1e-13 * moments.value.m0 * length);
    EXPECT_NEAR(moments.turn.m0, length * means.turn.m0, 1e-12 * moments.value.m0 / 0.1);
    EXPECT_NEAR(moments.radial_over_r2.m1, length * length / 2 * means.radial_over_r2.m1,
                1e-11 * moments.value.m0 * length);
  }
  EXPECT_NEAR(footprint::mean_moments(lobes, 0.15, 0.15).m0, footprint::weight(lobes, 0.15),
              1e-13 * footprint::weight(lobes, 0.15));
  EXPECT_EQ(footprint::mean_moments(lobes, 0.15, 0.15).m1, 0);
}

// Proves where the groove turns its back: n.h changes sign at the limits, and only there.
TEST(FootprintCore, FrontFacingLimits) {
  DrawnCase draw(9);
  for (int i = 0; i < 1000; ++i) {
    const double hx = draw.uniform(-1, 1), hz = draw.uniform(-1, 1), rim = draw.uniform(0.01, 1);
    const auto limits = footprint::front_facing(hx, hz, rim);
    for (int k = 0; k < 20; ++k) {
      const double t = draw.uniform(-rim, rim);
      const double n_dot_h = -2 * t * hx + (1 - t * t) * hz;
      EXPECT_EQ(n_dot_h > 0, t > limits.lo && t < limits.hi) << hx << " " << hz << " " << t;
    }
  }
}

}  // namespace
}  // namespace burin
