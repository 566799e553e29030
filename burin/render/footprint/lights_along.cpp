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
  known_ = 0;
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
  steps_ = std::max<std::size_t>(1, static_cast<std::size_t>(wanted));
  step_ = chord / static_cast<double>(steps_);
  step2_ = step_.squaredNorm();
  beside2_ = kBeside * kBeside * rough * rough;
  known_ = step2_ > 0 ? steps_ + 1 : 1;
  if (knots_.size() < known_) knots_.resize(known_);
  for (std::size_t j = 0; j < known_; ++j) {
    const Eigen::Vector3d h = first_ + static_cast<double>(j) * step_;
    knots_[j].resize(bands.size());
    for (std::size_t k = 0; k < bands.size(); ++k)
      knots_[j].set(k, bands[k], band_light(bands[k], h, groove.alpha, across));
  }
}

bool LightsAlong::knows(const Eigen::Vector3d& h) const {
  if (known_ == 0) return false;
  const Eigen::Vector3d from = h - first_;
  const double t = known_ == 1 ? 0 : std::clamp(from.dot(step_) / step2_, 0.0, static_cast<double>(steps_));
  return (from - t * step_).squaredNorm() <= beside2_;
}

void LightsAlong::at(const Eigen::Vector3d& h, bool slopes, BandLights& out) const {
  const Eigen::Vector3d from = h - first_;
  const double t = known_ == 1 ? 0 : std::clamp(from.dot(step_) / step2_, 0.0, static_cast<double>(steps_));
  const std::size_t j = known_ == 1 ? 0 : std::min(steps_ - 1, static_cast<std::size_t>(t));
  const double u = t - static_cast<double>(j);
  const Eigen::Vector3d beside = from - t * step_;
  const BandLights &a = knots_[j], &b = knots_[known_ == 1 ? j : j + 1];
  const std::size_t n = a.value.size();
  if (out.value.size() != n) out.resize(n);
  const double dx = step_.x(), dy = step_.y(), dz = step_.z(), rx = beside.x(), ry = beside.y(), rz = beside.z();
  const double inverse2 = step2_ > 0 ? 1 / step2_ : 0;
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
}

}  // namespace burin
