#include "burin/render/footprint/lights_along.h"

#include <algorithm>
#include <cmath>

namespace burin {
namespace {

constexpr double kStep = 0.12;    // of the roughness: from knot to knot, at most
constexpr double kBeside = 0.06;  // of the roughness: as far as light goes straight

}  // namespace

void LightsAlong::set(const GrooveSegment& groove, std::span<const ProfileBand> bands, double across,
                      std::span<const Eigen::Vector3d> half, bool slopes) {
  count_ = 0;
  if (half.size() < 2) return;
  const double rough = groove.alpha * std::min(1.0, across);
  // The ends of the chord: what lies furthest from any one of them, and what lies furthest from that.
  const auto furthest_from = [&](const Eigen::Vector3d& p) {
    return *std::max_element(half.begin(), half.end(), [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
      return (a - p).squaredNorm() < (b - p).squaredNorm();
    });
  };
  first_ = furthest_from(half.front());
  const Eigen::Vector3d chord = furthest_from(first_) - first_;
  const double wanted = std::ceil(chord.norm() / (kStep * rough));
  // A knot costs as much as a pixel with its slopes does without knots, or as three pixels without slopes.
  if (!((slopes ? 1.5 : 4) * (wanted + 1) < static_cast<double>(half.size()))) return;
  step_ = chord / std::max(1.0, wanted);
  beside2_ = kBeside * kBeside * rough * rough;
  count_ = static_cast<std::size_t>(wanted) + 1;
  if (knots_.size() < count_) knots_.resize(count_);
  for (std::size_t j = 0; j < count_; ++j) {
    const Eigen::Vector3d h = first_ + static_cast<double>(j) * step_;
    knots_[j].resize(bands.size());
    for (std::size_t k = 0; k < bands.size(); ++k)
      knots_[j].set(k, bands[k], band_light(bands[k], h, groove.alpha, across));
  }
}

bool LightsAlong::at(const Eigen::Vector3d& h, bool slopes, BandLights& out) const {
  if (count_ == 0) return false;
  // From the first knot, in steps. A lone one has no chord.
  const Eigen::Vector3d from = h - first_;
  const double last = static_cast<double>(count_ - 1), inverse2 = count_ > 1 ? 1 / step_.squaredNorm() : 0;
  const double t = std::clamp(from.dot(step_) * inverse2, 0.0, last);
  const Eigen::Vector3d beside = from - t * step_;
  if (beside.squaredNorm() > beside2_) return false;
  const std::size_t j = std::min(static_cast<std::size_t>(t), std::max<std::size_t>(count_, 2) - 2);
  const double u = t - static_cast<double>(j);
  const BandLights &a = knots_[j], &b = knots_[std::min(j + 1, count_ - 1)];
  const std::size_t n = a.value.size();
  if (out.value.size() != n) out.resize(n);
  const double dx = step_.x(), dy = step_.y(), dz = step_.z(), rx = beside.x(), ry = beside.y(), rz = beside.z();
  for (std::size_t k = 0; k < n; ++k) {
    const double a1 = a.by_hx[k] * dx + a.by_hy[k] * dy + a.by_hz[k] * dz,
                 b1 = b.by_hx[k] * dx + b.by_hy[k] * dy + b.by_hz[k] * dz, rise = b.value[k] - a.value[k];
    const double c2 = 3 * rise - 2 * a1 - b1, c3 = a1 + b1 - 2 * rise;
    double gx = a.by_hx[k] + u * (b.by_hx[k] - a.by_hx[k]), gy = a.by_hy[k] + u * (b.by_hy[k] - a.by_hy[k]),
           gz = a.by_hz[k] + u * (b.by_hz[k] - a.by_hz[k]);
    // Along the chord the cubic's own slope.
    const double more = (a1 + u * (2 * c2 + 3 * u * c3) - gx * dx - gy * dy - gz * dz) * inverse2;
    gx += more * dx;
    gy += more * dy;
    gz += more * dz;
    out.value[k] = std::max(0.0, a.value[k] + u * (a1 + u * (c2 + u * c3)) + gx * rx + gy * ry + gz * rz);
    if (!slopes) continue;
    out.by_hx[k] = gx;
    out.by_hy[k] = gy;
    out.by_hz[k] = gz;
    out.by_alpha[k] = a.by_alpha[k] + u * (b.by_alpha[k] - a.by_alpha[k]);
    out.by_depth[k] = a.by_depth[k] + u * (b.by_depth[k] - a.by_depth[k]);
  }
  return true;
}

}  // namespace burin
