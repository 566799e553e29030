#include "burin/simulate/bent_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace burin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Both distances along a ray to its intersections with the whole cylinder, the nearer first.
std::optional<std::array<double, 2>> meetings(const BentSheet& sheet, const Vector3d& origin, const Vector3d& ray) {
  const auto aside = [&](const Vector3d& v) { return Vector3d(v - sheet.axis * sheet.axis.dot(v)); };
  const Vector3d o = aside(origin - sheet.center_mm), d = aside(ray);
  const double a = d.squaredNorm(), half_b = o.dot(d), c = o.squaredNorm() - sheet.radius_mm * sheet.radius_mm;
  const double under = half_b * half_b - a * c;
  if (!(a > 0) || !(under > 0)) return std::nullopt;
  const double root = std::sqrt(under);
  return std::array{(-half_b - root) / a, (-half_b + root) / a};
}

double outside_by(const BentSheet& sheet, const Vector2d& p) {
  return std::max({-p.x(), -p.y(), p.x() - sheet.size_mm.x(), p.y() - sheet.size_mm.y()});
}

// Position on the flat sheet of a point of the cylinder, and the face's normal there.
Vector2d unrolled(const BentSheet& sheet, const Vector3d& p, Vector3d& normal) {
  const Vector3d from = p - sheet.center_mm, aside = from - sheet.axis * sheet.axis.dot(from);
  normal = aside / sheet.radius_mm;
  const Vector3d across = Vector3d::UnitZ().cross(sheet.axis);
  const double angle = std::atan2(normal.dot(across), normal.z());
  const Vector3d flat = sheet.axis * sheet.axis.dot(from) + across * (sheet.radius_mm * angle);
  return flat.head<2>() + sheet.size_mm / 2;
}

}  // namespace

BentSheet::BentSheet(double radius, double axis_deg, const Vector2d& size)
    : radius_mm(radius),
      size_mm(size),
      axis(std::cos(axis_deg * std::numbers::pi / 180), std::sin(axis_deg * std::numbers::pi / 180), 0),
      center_mm(size.x() / 2, size.y() / 2, -radius) {}

BentSheet::Place BentSheet::at(double x_mm, double y_mm) const {
  const Vector3d flat(x_mm - size_mm.x() / 2, y_mm - size_mm.y() / 2, 0);
  const Vector3d across = Vector3d::UnitZ().cross(axis);
  // The sheet rolls: a point s across the axis turns by s / radius, away from z if the radius is positive.
  const double angle = across.dot(flat) / radius_mm;
  Place place;
  place.turn = Eigen::AngleAxisd(-angle, axis).toRotationMatrix();
  place.position_mm = center_mm + axis * axis.dot(flat) + radius_mm * place.turn.col(2);
  return place;
}

std::optional<Vector2d> BentSheet::first_met(const Vector3d& origin_mm, const Vector3d& ray, double beyond_mm) const {
  const auto both = meetings(*this, origin_mm, ray);
  if (!both) return std::nullopt;
  std::optional<Vector2d> beside;
  for (const double way : *both) {
    if (!(way > 0)) continue;
    Vector3d normal;
    const Vector2d flat = unrolled(*this, origin_mm + way * ray, normal);
    const double outside = outside_by(*this, flat);
    const bool front = normal.dot(ray) < 0;
    if (outside <= 0) return front ? std::optional(flat) : std::nullopt;
    if (front && outside <= beyond_mm && !beside) beside = flat;
  }
  return beside;
}

bool BentSheet::shades(const Place& place, const Vector3d& lamp_mm) const {
  const Vector3d way = lamp_mm - place.position_mm;
  if (!(way.dot(place.normal()) > 0)) return true;
  const auto both = meetings(*this, place.position_mm, way);
  if (!both) return false;
  constexpr double kStart = 1e-9;  // share of the way: excludes the place itself
  return std::any_of(both->begin(), both->end(), [&](double part) {
    Vector3d normal;
    return part > kStart && part < 1 && outside_by(*this, unrolled(*this, place.position_mm + part * way, normal)) <= 0;
  });
}

}  // namespace burin
