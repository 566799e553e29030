#include "tests/bench/interval_work.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "burin/render/footprint/footprint_core.h"

namespace burin {
namespace {

// A float that counts what is done to it.
struct Counted {
  using value_type = float;  // constants and tables are float's
  float v = 0;
  static inline long operations = 0;
  Counted() = default;
  Counted(double x) : v(float(x)) {}
  Counted operator-() const { return Counted(-v); }
};
Counted counted(float v) {
  ++Counted::operations;
  return Counted(v);
}
Counted operator+(Counted a, Counted b) { return counted(a.v + b.v); }
Counted operator-(Counted a, Counted b) { return counted(a.v - b.v); }
Counted operator*(Counted a, Counted b) { return counted(a.v * b.v); }
Counted operator/(Counted a, Counted b) { return counted(a.v / b.v); }
Counted sqrt(Counted a) { return counted(std::sqrt(a.v)); }
Counted log1p(Counted a) { return counted(std::log1p(a.v)); }
Counted abs(Counted a) { return Counted(std::abs(a.v)); }
Counted max(Counted a, Counted b) { return Counted(std::max(a.v, b.v)); }
Counted select(bool mask, Counted a, Counted b) { return mask ? a : b; }
bool operator<(Counted a, Counted b) { return a.v < b.v; }
bool operator>(Counted a, Counted b) { return a.v > b.v; }
bool operator>=(Counted a, Counted b) { return a.v >= b.v; }

}  // namespace

IntervalWork::IntervalWork(int count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(0, 1);
  const auto push = [](std::vector<float>& v, double x) { v.push_back(float(x)); };
  for (int i = 0; i < count; ++i) {
    const double tilt = 0.6 * u(random), azimuth = 6.2831853 * u(random), T = 0.2 + 0.15 * u(random);
    push(hx, std::sin(tilt) * std::cos(azimuth));
    push(hy, std::sin(tilt) * std::sin(azimuth));
    push(hz, std::cos(tilt));
    push(alpha, 0.02 * std::pow(10, u(random)));
    double a = -T, b = T;
    if (u(random) > 0.62) {
      a = -T + 2 * T * u(random);
      b = -T + 2 * T * u(random);
    }
    push(t1, std::min(a, b));
    push(t2, std::max(a, b));
    const auto lobes = footprint::make_lobes<double>(hx[i], hy[i], hz[i], alpha[i]);
    m0.push_back(footprint::moments<double>(lobes, t1[i], t2[i]).m0);
    most.push_back((double(t2[i]) - t1[i]) * std::pow(lobes.s2, -2));
  }
  for (auto& v : r) v.resize(count);
}

double IntervalWork::error() const {
  double e = 0;
  for (std::size_t i = 0; i < m0.size(); ++i) {
    if (most[i] > 0) e = std::max(e, std::abs(r[0][i] - m0[i]) / most[i]);
  }
  return e;
}

double operations_per_interval(const IntervalWork& w, bool derivatives) {
  Counted::operations = 0;
  for (std::size_t i = 0; i < w.t1.size(); ++i) {
    const auto lobes = footprint::make_lobes<Counted>(w.hx[i], w.hy[i], w.hz[i], w.alpha[i]);
    if (derivatives) {
      benchmark::DoNotOptimize(footprint::moments_with_derivatives<Counted>(lobes, w.t1[i], w.t2[i]));
    } else {
      benchmark::DoNotOptimize(footprint::moments<Counted>(lobes, w.t1[i], w.t2[i]));
    }
  }
  return double(Counted::operations) / double(w.t1.size());
}

}  // namespace burin
