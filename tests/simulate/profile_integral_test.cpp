// The footprint integral of cross-sections given in bands: against the paper's closed form where the section is the
// paper's, against sums over points of the section where it is not, and its derivatives against differences.
#include "burin/render/footprint/profile_integral.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>
#include <vector>

#include "burin/scene/groove.h"
#include "burin/simulate/groove_section.h"

namespace burin {
namespace {

constexpr double kWidth = 320, kDepth = 14, kLength = 5;
const Quad kAcross{{{-0.3, 1.0}, {0.35, 1.1}, {0.3, 1.6}, {-0.32, 1.5}}};  // whole groove, away from the ends

GrooveProfile rounded_v() {
  GrooveProfile p;
  p.kind = GrooveProfile::Kind::rounded_v;
  p.flank_deg = 24;
  p.burr_left_um = 1.2;
  p.burr_right_um = 0.7;
  p.burr_width_um = 10;
  p.across = 1.4;
  return p;
}

Eigen::Vector3d half_vector(double lean_deg, double turn) {
  const double lean = lean_deg * std::numbers::pi / 180;
  return Eigen::Vector3d(-std::sin(lean), turn, std::cos(lean)).normalized();
}

TEST(ProfileIntegral, OfThePapersSectionIsTheClosedForm) {
  const GrooveSegment groove{kWidth, kDepth, 0.05, kLength};
  const auto bands = profile_bands({}, kWidth, kDepth);
  for (const double lean : {0., 10., 23., 33., 40.})
    for (const double turn : {0.0, 0.05}) {
      const auto closed = footprint_integral(groove, kAcross, half_vector(lean, turn));
      const auto banded = profile_integral(groove, bands, 1, kAcross, half_vector(lean, turn));
      EXPECT_NEAR(banded.area_mm2, closed.area_mm2, 1e-12);
      // The footprint's slanted ends are taken as even over a band: 1e-3 of the whole.
      EXPECT_NEAR(banded.Dhat_mm2, closed.Dhat_mm2, 2e-3 * closed.Dhat_mm2) << lean << " " << turn;
    }
}

// The mean light of the section by a hundred thousand points of it, and its width.
double by_points(const GrooveProfile& profile, double depth, const Eigen::Vector3d& h, double alpha, double* width_um) {
  const GrooveSection section = section_of(profile, kWidth, depth);
  double sum = 0;
  constexpr int kPoints = 200000;
  const double step = 2 * section.reach_um / kPoints;
  *width_um = 0;
  for (int i = 0; i < kPoints; ++i) {
    const auto at = section_at(section, -section.reach_um + (i + 0.5) * step);
    if (!at) continue;
    *width_um += step;
    const double s = std::sin(at->lean), c = std::cos(at->lean);
    const double n_h = h.z() * c - h.x() * s, m_h = (h.x() * c + h.z() * s) / (profile.across * alpha);
    const double q = m_h * m_h + h.y() * h.y() / (alpha * alpha) + n_h * n_h;
    sum += step / (std::numbers::pi * profile.across * alpha * alpha * q * q);
  }
  return sum;
}

TEST(ProfileIntegral, OfARoundedVWithBurrsIsTheSumOverItsPoints) {
  for (const double depth : {5.0, kDepth})  // an arc alone; with flanks
    for (const double alpha : {0.02, 0.08})
      for (const double lean : {-30., -20., 0., 8., 24., 26., 35.}) {
        const Eigen::Vector3d h = half_vector(lean, 0.01);
        double width_um = 0;
        const double points = by_points(rounded_v(), depth, h, alpha, &width_um);
        double bands_sum = 0, bands_width = 0, peak = 0;
        for (const ProfileBand& band : profile_bands(rounded_v(), kWidth, depth)) {
          const double width = band.to_um - band.from_um, light = band_light(band, h, alpha, 1.4).value;
          EXPECT_GT(width, 0);
          bands_sum += width * light;
          bands_width += width;
          peak = std::max(peak, width * light);
        }
        EXPECT_NEAR(bands_width, width_um, 2e-3);  // a point's width
        EXPECT_NEAR(bands_sum, points, 2e-4 * points + 1e-6 * peak) << lean << " " << alpha << " " << depth;
      }
}

// The value alone takes areas as differences of what lies left of the bands' edges, and light by packets; with
// derivatives each band is cut out, and its light is summed node by node.
TEST(ProfileIntegral, IsTheSameWithDerivativesAndWithout) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> along(-0.5, kLength + 0.5), across(-0.12, 0.12), half(0.02, 0.4), turn(0, 3.2),
      lean(-70, 70), sideways(-0.2, 0.2);
  GrooveProfile arc = rounded_v();
  arc.kind = GrooveProfile::Kind::paper;
  int seen = 0;
  for (const GrooveProfile& profile : {rounded_v(), arc})
    for (int n = 0; n < 2000; ++n) {
      const GrooveSegment groove{kWidth, n % 2 == 0 ? 5.0 : kDepth, 0.01 * (1 + n % 20), kLength};
      const std::vector<ProfileBand> bands = profile_bands(profile, groove.width_um, groove.depth_um);
      const Eigen::Vector2d middle(across(random), along(random));
      const Eigen::Rotation2Dd turned(turn(random));
      const double a = half(random), b = half(random);
      Quad quad{{{-a, -b}, {a, -b}, {0.9 * a, b}, {-a, 0.8 * b}}};
      if (n % 3 == 0) std::swap(quad[1], quad[3]);  // the other way around
      for (Eigen::Vector2d& corner : quad) corner = middle + turned * corner;
      const Eigen::Vector3d h = half_vector(lean(random), sideways(random));
      const FootprintValue one = profile_integral(groove, bands, profile.across, quad, h),
                           other = profile_integral_gradient(groove, bands, profile.across, quad, h).value;
      EXPECT_NEAR(one.area_mm2, other.area_mm2, 1e-14) << n;
      EXPECT_NEAR(one.Dhat_mm2, other.Dhat_mm2, 1e-11 * other.Dhat_mm2 + 1e-14) << n;
      seen += other.area_mm2 > 0;
    }
  EXPECT_GT(seen, 1000);
}

TEST(ProfileIntegral, DerivativesAreThoseOfDifferences) {
  const Quad quad{{{-0.03, -0.2}, {0.12, 0.1}, {0.1, 0.6}, {-0.06, 0.4}}};  // over an end, cuts the groove lengthwise
  const GrooveProfile profile = rounded_v();
  const Eigen::Vector3d h = half_vector(22, 0.03);
  for (const double depth : {5.0, kDepth}) {
    const GrooveSegment groove{kWidth, depth, 0.06, kLength};
    const auto value = [&](const GrooveSegment& g, const Quad& q, const Eigen::Vector3d& half) {
      return profile_integral(g, profile_bands(profile, g.width_um, g.depth_um), profile.across, q, half);
    };
    const FootprintGradient d =
        profile_integral_gradient(groove, profile_bands(profile, kWidth, depth), profile.across, quad, h);
    const FootprintValue at = value(groove, quad, h);
    EXPECT_NEAR(d.value.Dhat_mm2, at.Dhat_mm2, 1e-13 * at.Dhat_mm2);
    const auto expect_slope = [&](double light, double area, double step, const auto& moved, const char* what) {
      const FootprintValue more = moved(step), less = moved(-step);
      const double scale = std::max(std::abs(light), at.Dhat_mm2);
      EXPECT_NEAR(light, (more.Dhat_mm2 - less.Dhat_mm2) / (2 * step), 2e-4 * scale) << what;
      EXPECT_NEAR(area, (more.area_mm2 - less.area_mm2) / (2 * step), 1e-6 + 1e-4 * std::abs(area)) << what;
    };
    expect_slope(
        d.dDhat_dalpha, 0, 1e-5,
        [&](double e) {
          auto g = groove;
          g.alpha += e;
          return value(g, quad, h);
        },
        "alpha");
    expect_slope(
        d.dDhat_ddepth_um, d.darea_ddepth_um, 1e-4,
        [&](double e) {
          auto g = groove;
          g.depth_um += e;
          return value(g, quad, h);
        },
        "depth");
    for (int k = 0; k < 4; ++k)
      for (int axis = 0; axis < 2; ++axis)
        expect_slope(
            d.dDhat_dcorner[k][axis], d.darea_dcorner[k][axis], 1e-6,
            [&](double e) {
              Quad q = quad;
              q[k][axis] += e;
              return value(groove, q, h);
            },
            "corner");
    const Eigen::Vector3d side = h.cross(Eigen::Vector3d::UnitY()).normalized();
    expect_slope(
        d.dDhat_dhalf.dot(side), 0, 1e-6, [&](double e) { return value(groove, quad, (h + e * side).normalized()); },
        "half vector");
  }
}

}  // namespace
}  // namespace burin
