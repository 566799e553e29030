// Proves: the simulated camera's own reflection terms obey physics: facets cover the face once, what shadowing leaves
// them is the face as seen (Heitz 2014, Eqn. 14), a white rough mirror sends back no more than it gets and, smooth, all
// of it; lamp and eye may change places. All by quadrature, and none of it by the renderer.
#include "burin/simulate/microfacets.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>

namespace burin {
namespace {

using Eigen::Vector3d;

/// Integral over the upper half of the directions, by the middles of steps in tan(lean / 2) and azimuth: fine near the
/// normal, where facets crowd.
template <typename F>
double over_half_sphere(double roughness, const F& f) {
  constexpr int kLeans = 2000, kTurns = 360;
  double sum = 0;
  // lean = atan(roughness * tan(u)), u from 0 to pi/2
  for (int i = 0; i < kLeans; ++i) {
    const double du = std::numbers::pi / 2 / kLeans, u = (i + 0.5) * du;
    const double t = roughness * std::tan(u), lean = std::atan(t);
    const double dlean = roughness / (std::cos(u) * std::cos(u)) / (1 + t * t) * du;
    for (int j = 0; j < kTurns; ++j) {
      const double turn = (j + 0.5) * 2 * std::numbers::pi / kTurns;
      const Vector3d m(std::sin(lean) * std::cos(turn), std::sin(lean) * std::sin(turn), std::cos(lean));
      sum += f(m) * std::sin(lean) * dlean * 2 * std::numbers::pi / kTurns;
    }
  }
  return sum;
}

TEST(Microfacets, CoverTheFaceOnce) {
  for (const double roughness : {0.03, 0.1, 0.4, 1.0})
    EXPECT_NEAR(
        over_half_sphere(roughness, [&](const Vector3d& m) { return facets_leaning(m.z(), roughness) * m.z(); }), 1,
        1e-5)
        << roughness;
}

TEST(Microfacets, WhatIsSeenOfThemIsTheFaceAsSeen) {
  for (const double roughness : {0.05, 0.3})
    for (const double lean : {0.0, 0.5, 1.0, 1.4}) {
      const Vector3d v(std::sin(lean), 0, std::cos(lean));
      EXPECT_NEAR(over_half_sphere(roughness,
                                   [&](const Vector3d& m) {
                                     return facets_leaning(m.z(), roughness) * std::max(0.0, v.dot(m)) *
                                            share_unshadowed(v.z(), roughness);
                                   }),
                  v.z(), 2e-4)
          << roughness << " " << lean;
    }
}

// Light sent back from a white lamp direction: the facets that mirror it, seen from everywhere.
double sent_back(const Vector3d& lamp, double roughness) {
  return over_half_sphere(roughness, [&](const Vector3d& m) {
    const double cos_m = lamp.dot(m);
    if (cos_m <= 0) return 0.0;
    const Vector3d eye = 2 * cos_m * m - lamp;
    if (eye.z() <= 0) return 0.0;
    return facets_leaning(m.z(), roughness) * share_lit_and_seen(lamp.z(), eye.z(), roughness) * cos_m / lamp.z() *
           fresnel_share(cos_m, 1.0);
  });
}

TEST(Microfacets, AWhiteMirrorSendsBackNoMoreThanItGets) {
  for (const double lean : {0.0, 0.7, 1.2}) {
    const Vector3d lamp(std::sin(lean), 0, std::cos(lean));
    for (const double roughness : {0.02, 0.2, 0.6}) EXPECT_LE(sent_back(lamp, roughness), 1 + 1e-4) << lean;
    EXPECT_NEAR(sent_back(lamp, 0.02), 1, lean < 1 ? 2e-3 : 1e-2) << lean;
    EXPECT_GT(sent_back(lamp, 0.2), sent_back(lamp, 0.6)) << lean;
  }
}

TEST(Microfacets, LampAndEyeMayChangePlaces) {
  for (const double a : {0.1, 0.6, 0.99})
    for (const double b : {0.2, 0.8}) EXPECT_EQ(share_lit_and_seen(a, b, 0.3), share_lit_and_seen(b, a, 0.3));
  EXPECT_EQ(facets_leaning(0, 0.1), 0);
  EXPECT_EQ(share_unshadowed(-0.1, 0.1), 0);
  EXPECT_EQ(fresnel_share(1, 0.2), 0.2);
  EXPECT_EQ(fresnel_share(0, 0.2), 1);
}

}  // namespace
}  // namespace burin
