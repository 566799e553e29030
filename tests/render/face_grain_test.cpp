// The brushed face's lobe: equal to GGX where it has no grain, to the textbook's two roughnesses (Heitz, JCGT 3(2),
// 2014) where it has one; its energy (the area it stands for) is one; its derivatives are those of differences.
#include "burin/scene/face_grain.h"

#include <gtest/gtest.h>

#include "burin/render/brdf.h"

namespace burin {
namespace {

constexpr double kAlpha = 0.15;
const FaceGrain kGrain = FaceGrain::of(25, 0.1, 0.225);

TEST(FaceGrain, IsGgxWithoutAGrain) {
  const Eigen::Vector3d h = Eigen::Vector3d(0.1, -0.2, 1).normalized();
  EXPECT_NEAR(grained_D(h.x(), h.y(), h.z(), kAlpha, 0.0, 0.0), ggx_D(h.z(), kAlpha), 1e-12);
  EXPECT_NEAR(grained_G1(h.x(), h.y(), h.z(), kAlpha, 0.0, 0.0), smith_G1(h.z(), kAlpha), 1e-12);
}

TEST(FaceGrain, HasTheTwoRoughnessesThatWereSaid) {
  EXPECT_NEAR(kGrain.along_deg(), 25, 1e-9);
  EXPECT_NEAR(kGrain.ratio(), 2.25, 1e-9);
  const double a = 25 * std::numbers::pi / 180, base = std::sqrt(0.1 * 0.225);
  const Eigen::Vector3d h = Eigen::Vector3d(0.15, 0.1, 1).normalized();
  const double along = h.x() * std::cos(a) + h.y() * std::sin(a), across = -h.x() * std::sin(a) + h.y() * std::cos(a);
  const double q = along * along / 0.01 + across * across / (0.225 * 0.225) + h.z() * h.z();
  EXPECT_NEAR(grained_D(h.x(), h.y(), h.z(), base, kGrain.c, kGrain.s), 1 / (std::numbers::pi * 0.0225 * q * q), 1e-9);
}

TEST(FaceGrain, StandsForAsMuchAreaAsTheFace) {
  // The integral of D (n.h) over the half sphere is 1: in slopes p, D dp / n.h^4.
  double sum = 0;
  constexpr int kSteps = 400;
  constexpr double kReach = 12;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double u = (i + 0.5) / kSteps * 2 - 1, v = (j + 0.5) / kSteps * 2 - 1;
      const double px = kReach * u * u * u, py = kReach * v * v * v;  // fine where the lobe is
      const double jacobian = kReach * kReach * 9 * u * u * v * v * 4.0 / (kSteps * kSteps);
      const Eigen::Vector3d h = Eigen::Vector3d(-px, -py, 1).normalized();
      sum += grained_D(h.x(), h.y(), h.z(), kAlpha, kGrain.c, kGrain.s) * std::pow(h.z(), 4) * jacobian;
    }
  EXPECT_NEAR(sum, 1, 2e-3);  // slopes beyond 12 hold a part in a thousand
}

TEST(FaceGrain, DerivativesAreThoseOfDifferences) {
  const Eigen::Vector3d h = Eigen::Vector3d(0.1, -0.15, 1).normalized(), wi = Eigen::Vector3d(0.5, 0.2, 1).normalized(),
                        wo = Eigen::Vector3d(-0.3, -0.5, 1).normalized();
  for (const FaceGrain grain : {kGrain, FaceGrain{1e-9, 0}}) {
    const GrainedLobe lobe = grained_lobe(h, wi, wo, kAlpha, grain);
    const auto value = [&](double a, double c, double s, const Eigen::Vector3d& dh, const Eigen::Vector3d& di) {
      const Eigen::Vector3d g = h + dh, i = wi + di;
      return grained_D(g.x(), g.y(), g.z(), a, c, s) * grained_G1(i.x(), i.y(), i.z(), a, c, s) *
             grained_G1(wo.x(), wo.y(), wo.z(), a, c, s);
    };
    const Eigen::Vector3d none = Eigen::Vector3d::Zero();
    EXPECT_NEAR(lobe.value, value(kAlpha, grain.c, grain.s, none, none), 1e-12);
    constexpr double kStep = 1e-5, kRelative = 1e-6;  // of central differences
    const auto slope = [&](const auto& at) { return (at(kStep) - at(-kStep)) / (2 * kStep); };
    EXPECT_NEAR(lobe.by_log_alpha,
                slope([&](double e) { return value(kAlpha * std::exp(e), grain.c, grain.s, none, none); }),
                kRelative * lobe.value);
    EXPECT_NEAR(lobe.by_c, slope([&](double e) { return value(kAlpha, grain.c + e, grain.s, none, none); }),
                kRelative * 10 * lobe.value);
    EXPECT_NEAR(lobe.by_s, slope([&](double e) { return value(kAlpha, grain.c, grain.s + e, none, none); }),
                kRelative * 10 * lobe.value);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(k);
      EXPECT_NEAR(lobe.by_h[k], slope([&](double e) { return value(kAlpha, grain.c, grain.s, e * unit, none); }),
                  1e-4 * lobe.value);
      EXPECT_NEAR(lobe.by_wi[k], slope([&](double e) { return value(kAlpha, grain.c, grain.s, none, e * unit); }),
                  1e-4 * lobe.value);
    }
  }
}

}  // namespace
}  // namespace burin
