#include "burin/scene/bend.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "burin/base/degrees.h"
#include "burin/base/files/decimals.h"

namespace burin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Fraction of a full tube. A nearly closed tube has no opening for a view, and the frame of the face (1.1) is singular
// if its normal has turned by 180 degrees.
constexpr double kMostOfTube = 0.95;

Vector3d in_space(const Vector2d& v) { return {v.x(), v.y(), 0}; }

// sin(a) / a and (1 - cos(a)) / a^2, with series near a = 0 for a flat sheet.
double sine_over(double a) { return std::abs(a) < 1e-4 ? 1 - a * a / 6 : std::sin(a) / a; }
double versine_over(double a) {
  const double half = sine_over(a / 2);
  return half * half / 2;
}

// Half a diagonal: distance of the rim that moves by a millimeter.
double rim_mm(const Vector2d& size_mm) { return size_mm.norm() / 2; }

bool on_sheet(const Cylinder& c, const Vector2d& p) {
  return p.x() >= 0 && p.y() >= 0 && p.x() <= c.size_mm.x() && p.y() <= c.size_mm.y();
}

// Components of a point or direction: across the axis, along it, and out of the middle.
struct Parts {
  double across, along, out;
};
Parts parts_of(const Cylinder& c, const Vector3d& v) {
  return {c.across.dot(v.head<2>()), c.along.dot(v.head<2>()), v.z()};
}

Vector2d flat_of(const Cylinder& c, const Parts& p) {
  const double s =
      c.curvature == 0 ? p.across : std::atan2(c.curvature * p.across, 1 + c.curvature * p.out) / c.curvature;
  return 0.5 * c.size_mm + s * c.across + p.along * c.along;
}

Parts along_ray(const Parts& origin, const Parts& direction, double lambda) {
  return {origin.across + lambda * direction.across, origin.along + lambda * direction.along,
          origin.out + lambda * direction.out};
}

}  // namespace

Cylinder cylinder_of(const Bend& bend, const Vector2d& size_mm, const Vector2d& moved_mm) {
  Cylinder c;
  c.size_mm = size_mm;
  const double rim = rim_mm(size_mm), axis = bend.axis_deg * kDegree_rad + moved_mm[1] / rim;
  c.along = {std::cos(axis), std::sin(axis)};
  c.across = {-c.along.y(), c.along.x()};
  c.curvature = 1 / bend.radius_mm - 2 * moved_mm[0] / (rim * rim);
  return c;
}

Bend bend_of(const Cylinder& c) {
  double axis = std::atan2(c.along.y(), c.along.x()) / kDegree_rad;
  if (axis < 0) axis += 180;
  return {1 / c.curvature, axis >= 180 ? axis - 180 : axis};
}

BentPlace bent_place(const Cylinder& c, const Vector2d& flat_mm) {
  const Vector2d from_middle = flat_mm - 0.5 * c.size_mm;
  const double s = c.across.dot(from_middle), t = c.along.dot(from_middle), turn = c.curvature * s;
  const double cosine = std::cos(turn), sine = std::sin(turn);
  const Vector3d across = in_space(c.across), along = in_space(c.along), out = Vector3d::UnitZ();
  return {in_space(0.5 * c.size_mm) + t * along + s * sine_over(turn) * across - s * turn * versine_over(turn) * out,
          sine * across + cosine * out, along, cosine * across - sine * out};
}

BentMotion bent_motion(const Cylinder& c, const Vector2d& flat_mm) {
  const Vector2d from_middle = flat_mm - 0.5 * c.size_mm;
  const double s = c.across.dot(from_middle), t = c.along.dot(from_middle), turn = c.curvature * s;
  const BentPlace place = bent_place(c, flat_mm);
  const Vector3d across = in_space(c.across), along = in_space(c.along), out = Vector3d::UnitZ();
  // d/dcurvature of s sin(turn)/turn and -s (1 - cos(turn))/turn: s^2 times the derivatives of these functions.
  const bool small = std::abs(turn) < 1e-2;
  const double sine_slope =
      small ? -turn / 3 * (1 - turn * turn / 10) : (turn * std::cos(turn) - std::sin(turn)) / (turn * turn);
  const double versine_slope = small ? 0.5 - turn * turn / 8 * (1 - turn * turn / 18)
                                     : (turn * std::sin(turn) - 1 + std::cos(turn)) / (turn * turn);
  const Vector3d position_by_curvature = s * s * (sine_slope * across - versine_slope * out);
  const Vector3d normal_by_curvature = s * place.across;
  // As the axis rotates, along turns to across and across to -along; s falls by t and t grows by s.
  const Vector3d position_by_axis = s * along + t * across - s * sine_over(turn) * along - t * place.across;
  const Vector3d normal_by_axis = -std::sin(turn) * along - t * c.curvature * place.across;
  const double rim = rim_mm(c.size_mm), by_rise = -2 / (rim * rim), by_turn = 1 / rim;
  return {{by_rise * position_by_curvature, by_turn * position_by_axis},
          {by_rise * normal_by_curvature, by_turn * normal_by_axis}};
}

std::optional<Vector2d> flat_place(const Cylinder& c, const Vector3d& origin_mm, const Vector3d& direction) {
  // On the cylinder k (across^2 + out^2) + 2 out = 0, with k the curvature. Along the ray this is a quadratic A l^2 + 2
  // B l + C = 0. A l + B is the ray's component along the normal there: negative if it meets the front.
  const Parts o = parts_of(c, origin_mm - in_space(0.5 * c.size_mm)), d = parts_of(c, direction);
  const double k = c.curvature;
  const double A = k * (d.across * d.across + d.out * d.out);
  const double B = k * (o.across * d.across + o.out * d.out) + d.out;
  const double C = k * (o.across * o.across + o.out * o.out) + 2 * o.out;
  const double discriminant = B * B - A * C;
  if (!(discriminant > 0)) return std::nullopt;
  const double root = std::sqrt(discriminant);
  const double front = B <= 0 ? C / (root - B) : -(B + root) / A, back = B <= 0 ? (root - B) / A : -C / (B + root);
  if (!(front > 0) || !std::isfinite(front)) return std::nullopt;
  const Vector2d flat = flat_of(c, along_ray(o, d, front));
  if (!on_sheet(c, flat)) return std::nullopt;
  if (back > 0 && back < front && on_sheet(c, flat_of(c, along_ray(o, d, back)))) return std::nullopt;
  return flat;
}

bool hidden_from(const Cylinder& c, const BentPlace& place, const Vector3d& from_mm) {
  const Vector3d way = from_mm - place.position_mm;
  const double rise = way.dot(place.normal);
  if (!(rise > 0)) return true;
  if (c.curvature >= 0) return false;  // a convex sheet is behind the tangent plane of every place
  const Parts d = parts_of(c, way);
  const double A = c.curvature * (d.across * d.across + d.out * d.out);
  const double again = -2 * rise / A;  // second intersection of the segment with the cylinder
  if (!(again < 1)) return false;
  return on_sheet(c, flat_of(c, along_ray(parts_of(c, place.position_mm - in_space(0.5 * c.size_mm)), d, again)));
}

double least_radius_mm(const Vector2d& size_mm, double axis_deg) {
  const double axis = axis_deg * kDegree_rad;
  const double reach = 0.5 * (std::abs(std::sin(axis)) * size_mm.x() + std::abs(std::cos(axis)) * size_mm.y());
  return reach / (kMostOfTube * std::numbers::pi);
}

std::optional<BendFault> fault_of(const Bend& bend, const Vector2d& size_mm) {
  if (!std::isfinite(bend.axis_deg))
    return BendFault{"axis_deg", "is not a number",
                     "write the cylinder's direction, degrees from +x counter-clockwise"};
  if (!std::isfinite(bend.radius_mm) || bend.radius_mm == 0)
    return BendFault{
        "radius_mm", "is " + significant(bend.radius_mm, 6),
        "write the face's radius in mm, above 0 where it bulges towards the viewer and below 0 where it is "
        "hollow; leave bend out for a flat board"};
  const double least = least_radius_mm(size_mm, bend.axis_deg);
  if (std::abs(bend.radius_mm) >= least) return std::nullopt;
  return BendFault{"radius_mm",
                   "is " + significant(bend.radius_mm, 6) + ", so tight that the sheet's edges meet behind it",
                   "the least for a sheet of " + significant(size_mm.x(), 6) + " x " + significant(size_mm.y(), 6) +
                       " mm about that axis is " + significant(std::ceil(10 * least) / 10, 6) +
                       " mm: write a larger radius, or cut the sheet smaller"};
}

}  // namespace burin
