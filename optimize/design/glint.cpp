#include "burin/optimize/design/glint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace burin {
namespace {

constexpr double kPiHalf = std::numbers::pi / 2;

}  // namespace

double Lean::scratch_direction() const { return azimuth + kPiHalf; }

GlintView glint_of(const DesignView& view, const Bench& bench) {
  return {view.view, find_view(bench, view.view, "design").T_camera_board.inverse().translation(),
          find_light(bench, view.light, "design").position_mm};
}

Eigen::Vector2d GlintField::at(const Eigen::Vector2d& p_mm) const {
  const auto place = [&](int axis) {
    const double part = (p_mm[axis] - min_mm[axis]) / (max_mm[axis] - min_mm[axis]);
    return std::clamp(part * side - 0.5, 0.0, side - 1.0);
  };
  const double x = place(0), y = place(1);
  const int i = std::min(std::max(0, side - 2), static_cast<int>(x)),
            j = std::min(std::max(0, side - 2), static_cast<int>(y));
  const auto node = [&](int c, int r) -> const Eigen::Vector2d& {
    return shadow[static_cast<std::size_t>(std::min(r, side - 1)) * side + std::min(c, side - 1)];
  };
  const double u = x - i, v = y - j;
  return (1 - v) * ((1 - u) * node(i, j) + u * node(i + 1, j)) +
         v * ((1 - u) * node(i, j + 1) + u * node(i + 1, j + 1));
}

Eigen::Vector3d half_vector_at(const GlintView& view, const Eigen::Vector3d& p_mm) {
  if (view.field) {
    constexpr double kMost = 0.999;  // of the sine of h's tilt
    const Eigen::Vector2d shadow = view.field->at(p_mm.head<2>());
    const Eigen::Vector2d kept = shadow * std::min(1.0, kMost / std::max(shadow.norm(), 1e-12));
    return {kept.x(), kept.y(), std::sqrt(1 - kept.squaredNorm())};
  }
  if (view.face == nullptr) return (view.light_mm - p_mm).normalized() + (view.camera_mm - p_mm).normalized();
  const auto place = face_place(*view.face, p_mm.head<2>());
  if (!place) return Eigen::Vector3d::UnitZ();  // a gap of a mesh
  const Eigen::Vector3d& p = place->position_mm;
  return place->in_face((view.light_mm - p).normalized() + (view.camera_mm - p).normalized());
}

Lean lean_at(const GlintView& view, const Eigen::Vector3d& p_mm) {
  const Eigen::Vector3d h = half_vector_at(view, p_mm).normalized();
  return {std::atan2(std::hypot(h.x(), h.y()), h.z()), std::atan2(h.y(), h.x())};
}

double lobe(double lean, double turn, double alpha) {
  const double q = std::sin(lean) * std::sin(turn) / alpha;
  return std::pow(1 + q * q, -1.5);
}

double lobe_place(const GlintView& view, const Eigen::Vector2d& p_mm, const Eigen::Vector2d& u, double alpha) {
  const Eigen::Vector3d h = half_vector_at(view, {p_mm.x(), p_mm.y(), 0});
  return (h.x() * u.x() + h.y() * u.y()) / (h.norm() * alpha);
}

double turn_between(double a, double b) { return std::abs(std::remainder(a - b, std::numbers::pi)); }

double ghost_of(const Lean& a, const Lean& b, double alpha) {
  const double apart = turn_between(a.azimuth, b.azimuth);
  return std::max(lobe(a.angle, apart, alpha), lobe(b.angle, apart, alpha));
}

double turn_for(double lean, double part, double alpha) {
  const double s = alpha * std::sqrt(std::max(0.0, std::pow(part, -2.0 / 3) - 1)) / std::max(1e-12, std::sin(lean));
  return s >= 1 ? kPiHalf : std::asin(s);
}

double reach(double lean, double steepest, double alpha) {
  const double x = (steepest - lean) / alpha;
  return 0.5 + (std::atan(x) + x / (1 + x * x)) / std::numbers::pi;
}

double depth_for_lean_um(double lean, double width_um) {
  const double rim = std::tan(lean / 2);
  return -width_um / 2 * std::log1p(-std::min(0.99, rim * rim));
}

}  // namespace burin
