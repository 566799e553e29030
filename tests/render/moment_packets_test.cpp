// What packets promise: every width gives what double gives, within float's own limits; lanes do not disturb each
// other; any length of array; wrong arrays and missing machines refused. The oracle is the same formula in double,
// which footprint_integral_test proves against numbers made without it.
#include "tests/moment_packets/moment_packets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/simd_choice.h"
#include "burin/render/footprint/footprint_core.h"

namespace burin::footprint {
namespace {

struct MomentTable {
  std::vector<float> hx, hy, hz, alpha, t1, t2;
  std::vector<float> r[6];

  void add(double x, double y, double z, double a, double from, double to) {
    const double norm = std::sqrt(x * x + y * y + z * z);
    hx.push_back(float(x / norm));
    hy.push_back(float(y / norm));
    hz.push_back(float(z / norm));
    alpha.push_back(float(a));
    t1.push_back(float(std::min(from, to)));
    t2.push_back(float(std::max(from, to)));
    for (auto& v : r) v.push_back(std::numeric_limits<float>::quiet_NaN());
  }
  Intervals intervals() const { return {hx, hy, hz, alpha, t1, t2}; }
  MomentArrays results() { return {r[0], r[1], r[2], r[3], r[4], r[5]}; }
};

/// Intervals of all lengths anywhere on the front-facing groove; with `extreme` half vectors down to the horizon, alpha
/// from 1e-3 to 1, and special directions.
MomentTable random_table(int count, bool extreme) {
  MomentTable t;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < count; ++i) {
    const double tilt = (extreme ? 1.5 : 0.6) * u(random), azimuth = 6.2831853 * u(random);
    double x = std::sin(tilt) * std::cos(azimuth), y = std::sin(tilt) * std::sin(azimuth), z = std::cos(tilt);
    if (extreme && i % 11 == 0) x = 0;
    if (extreme && i % 13 == 0) y = 0;
    if (extreme && i % 17 == 0) x = y = 0;
    const double alpha = extreme ? std::pow(10, -3 * u(random)) : 0.015 * std::pow(20, u(random));
    const double rim = extreme ? u(random) : 0.1 + 0.4 * u(random);
    const auto limits = front_facing(x, z, rim);
    if (!(limits.lo < limits.hi)) continue;
    double a = limits.lo, b = limits.hi;
    const int kind = i % 5;
    if (kind > 1) a += (b - a) * u(random);
    if (kind > 2) b = a + (limits.hi - a) * std::pow(10, -(kind == 3 ? 1 : 4) * u(random));
    t.add(x, y, z, alpha, a, b);
  }
  return t;
}

constexpr SimdWidth kPacketWidths[] = {SimdWidth::generic, SimdWidth::avx2, SimdWidth::avx512};

// Largest error of each of the six results, over what it could at most be: the interval's length (times half its length
// for m1) times the peak of the integrand, s^-4, s^-5 (a turn by s crosses the peak) and s^-6.
std::array<double, 6> worst_errors(const MomentTable& t) {
  std::array<double, 6> worst{};
  for (std::size_t i = 0; i < t.t1.size(); ++i) {
    const auto l = make_lobes<double>(t.hx[i], t.hy[i], t.hz[i], t.alpha[i]);
    const auto m = moments_with_derivatives<double>(l, t.t1[i], t.t2[i]);
    const double length = double(t.t2[i]) - t.t1[i];
    const std::array<double, 6> want{m.value.m0, m.value.m1,          m.turn.m0,
                                     m.turn.m1,  m.radial_over_r2.m0, m.radial_over_r2.m1};
    for (int k = 0; k < 6; ++k) {
      const double peak = std::pow(l.s, k < 2 ? -4 : k < 4 ? -5 : -6);
      const double most = length * (k % 2 ? length / 2 : 1) * peak;
      EXPECT_TRUE(std::isfinite(t.r[k][i])) << i << " " << k;
      if (most > 0) worst[k] = std::max(worst[k], std::abs(t.r[k][i] - want[k]) / most);
    }
  }
  return worst;
}

// Proves each width against double: 2e-6 of the peak for boards as they are (a few float roundings and the six-node
// rule's 1e-7), 2e-5 for anything that passes the preconditions, down to the horizon.
TEST(MomentPackets, EveryWidthAgreesWithDouble) {
  for (const bool extreme : {false, true}) {
    MomentTable t = random_table(20000, extreme);
    for (const auto width : kPacketWidths) {
      if (!has_kernel(width)) continue;
      for (auto& v : t.r) std::fill(v.begin(), v.end(), std::numeric_limits<float>::quiet_NaN());
      moments_with_derivatives(t.intervals(), t.results(), width);
      const auto worst = worst_errors(t);
      for (int k = 0; k < 6; ++k)
        EXPECT_LT(worst[k], extreme ? 2e-5 : k < 2 ? 2e-6 : 1e-5) << name(width) << " result " << k;
      const std::vector<float> m0 = t.r[0], m1 = t.r[1];
      moments(t.intervals(), t.results(), width);
      double m0_difference = 0;
      for (std::size_t i = 0; i < m0.size(); ++i) {
        m0_difference = std::max(m0_difference, double(std::abs(m0[i] - t.r[0][i]) / m0[i]));
      }
      EXPECT_LT(m0_difference, 1e-5) << "with and without derivatives, " << name(width);
    }
  }
}

// Proves the same of plain float, the type between double and the packets.
TEST(MomentPackets, PlainFloatAgreesWithDouble) {
  MomentTable t = random_table(20000, false);
  for (std::size_t i = 0; i < t.t1.size(); ++i) {
    const auto m = moments_with_derivatives(make_lobes(t.hx[i], t.hy[i], t.hz[i], t.alpha[i]), t.t1[i], t.t2[i]);
    const float results[] = {m.value.m0, m.value.m1, m.turn.m0, m.turn.m1, m.radial_over_r2.m0, m.radial_over_r2.m1};
    for (int k = 0; k < 6; ++k) t.r[k][i] = results[k];
  }
  const auto worst = worst_errors(t);
  for (int k = 0; k < 6; ++k) EXPECT_LT(worst[k], k < 2 ? 2e-6 : 1e-5) << "result " << k;
}

// Proves that a lane's result does not depend on its neighbors or its place: any order, any length of array gives the
// same bits. Images that do not depend on how work is cut rest on this.
TEST(MomentPackets, LanesAreIndependent) {
  const MomentTable t = random_table(1000, true);
  for (const auto width : kPacketWidths) {
    if (!has_kernel(width)) continue;
    MomentTable whole = t;
    moments_with_derivatives(whole.intervals(), whole.results(), width);
    std::vector<std::size_t> order(t.t1.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    for (const std::size_t length : {std::size_t(1), std::size_t(7), std::size_t(16), std::size_t(37), order.size()}) {
      MomentTable part;
      for (std::size_t k = 0; k < length; ++k) {
        const std::size_t i = order[k];
        part.hx.push_back(t.hx[i]), part.hy.push_back(t.hy[i]), part.hz.push_back(t.hz[i]);
        part.alpha.push_back(t.alpha[i]), part.t1.push_back(t.t1[i]), part.t2.push_back(t.t2[i]);
        for (auto& v : part.r) v.push_back(0);
      }
      moments_with_derivatives(part.intervals(), part.results(), width);
      for (std::size_t k = 0; k < length; ++k) {
        for (int j = 0; j < 6; ++j) EXPECT_EQ(part.r[j][k], whole.r[j][order[k]]) << name(width);
      }
    }
  }
}

// Proves that the width that is used everywhere can be chosen, and ends with the choice.
TEST(SimdChoice, IsWhatBestMeansWhileItLives) {
  const SimdWidth widest = resolved_simd(SimdWidth::best);
  {
    const SimdChoice plain(SimdWidth::generic);
    EXPECT_EQ(resolved_simd(SimdWidth::best), SimdWidth::generic);
    EXPECT_STREQ(name(SimdWidth::best), name(SimdWidth::generic));
    {
      const SimdChoice inner(widest);
      EXPECT_EQ(resolved_simd(SimdWidth::best), widest);
    }
    EXPECT_EQ(resolved_simd(SimdWidth::best), SimdWidth::generic);
  }
  EXPECT_EQ(resolved_simd(SimdWidth::best), widest);
  EXPECT_THROW(SimdChoice(static_cast<SimdWidth>(99)), Error);
  for (const SimdWidth width : {SimdWidth::generic, SimdWidth::avx2, SimdWidth::avx512})
    EXPECT_EQ(simd_named(name(width)), width);
  EXPECT_EQ(simd_named("mmx"), std::nullopt);
}

// Proves that the choice of width is sound on this machine, and that misuse is told.
TEST(MomentPackets, WidthsAndErrors) {
  EXPECT_TRUE(has_kernel(SimdWidth::generic));
  EXPECT_TRUE(has_kernel(resolved_simd(SimdWidth::best)));
  const auto none = static_cast<SimdWidth>(99);
  EXPECT_FALSE(has_kernel(none));
  MomentTable t = random_table(20, false);
  EXPECT_THROW(moments(t.intervals(), t.results(), none), Error);
  MomentArrays short_results = t.results();
  short_results.m1 = short_results.m1.first(3);
  EXPECT_THROW(moments(t.intervals(), short_results), Error);
  Intervals short_intervals = t.intervals();
  short_intervals.hz = short_intervals.hz.first(3);
  EXPECT_THROW(moments(short_intervals, t.results()), Error);
  EXPECT_NO_THROW(moments({}, {}));
}

}  // namespace
}  // namespace burin::footprint
