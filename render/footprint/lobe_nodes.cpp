#include "burin/render/footprint/lobe_nodes.h"

#include <cmath>

#include "burin/base/machine_clones.h"

namespace burin {
namespace {

// Taylor series up to pi/4, where the remainder is below 1e-16.
BURIN_INLINED double sine_below_quarter(double y) {
  const double t = y * y;
  return y * (1 + t * (-1. / 6 +
                       t * (1. / 120 + t * (-1. / 5040 + t * (1. / 362880 + t * (-1. / 39916800 +
                                                                                 t * (1. / 6227020800. +
                                                                                      t * (-1. / 1307674368000.))))))));
}
BURIN_INLINED double cosine_below_quarter(double y) {
  const double t = y * y;
  return 1 + t * (-1. / 2 +
                  t * (1. / 24 + t * (-1. / 720 + t * (1. / 40320 +
                                                       t * (-1. / 3628800 + t * (1. / 479001600. +
                                                                                 t * (-1. / 87178291200. +
                                                                                      t * (1. / 20922789888000.))))))));
}

struct Node {
  double sine, cosine;  // of psi
  double square, root;  // r2, and one over its root
};
BURIN_INLINED Node node_at(double psi, double s) {
  const double y = 0.5 * psi, sy = sine_below_quarter(y), cy = cosine_below_quarter(y);
  const double sine = 2 * sy * cy, cosine = 1 - 2 * sy * sy, square = cosine * cosine + s * s * sine * sine;
  return {sine, cosine, square, 1 / std::sqrt(square)};
}

}  // namespace

BURIN_MACHINE_CLONES
void lobe_nodes(int count, const double* psi, double s, double sine_h, double cosine_h, const LobeNodes& out) {
  double* __restrict const r2 = out.r2;
  double* __restrict const cos_lean = out.cos_lean;
  if (out.cos_away == nullptr) {
    for (int i = 0; i < count; ++i) {
      const Node n = node_at(psi[i], s);
      r2[i] = n.square;
      cos_lean[i] = (cosine_h * n.cosine - sine_h * s * n.sine) * n.root;
    }
    return;
  }
  double* __restrict const cos_away = out.cos_away;
  double* __restrict const sin_away = out.sin_away;
  for (int i = 0; i < count; ++i) {
    const Node n = node_at(psi[i], s);
    r2[i] = n.square;
    cos_lean[i] = (cosine_h * n.cosine - sine_h * s * n.sine) * n.root;
    cos_away[i] = n.cosine * n.root;
    sin_away[i] = s * n.sine * n.root;
  }
}

}  // namespace burin
