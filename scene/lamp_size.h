// burin/scene/lamp_size.h - area lights as sample points. docs/model.md 5.5.
// Frame: board, mm.
//
// An area light sends the mean of its points' light; each point is a near lamp with the same axis and falloff.
// lamp_points() approximates this mean by a quadrature rule with few points. A point's offset moves half vectors by
// about half of offset / distance. If the farthest point moves them by less than half of the roughness, the rules have
// an error below a hundredth of the glint's center value. tests/scene/lamp_size_test.cpp compares them with thousands
// of points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/scene/light.h"

namespace burin {

/// One sample point of a lamp: its offset from the lamp's middle and its weight (all add up to 1).
struct LampPoint {
  Eigen::Vector3d offset_mm{0, 0, 0};
  double share = 1;
};

/// Two unit vectors across `axis`: the columns. The first is the board's x made orthogonal to the axis (its y if the
/// axis runs along x), turned by `turn_deg` about the axis.
Eigen::Matrix<double, 3, 2> across_axis(const Eigen::Vector3d& axis, double turn_deg);

/// The sample points of a lamp. Their number grows with the ratio of a disk's radius, or a panel's half side, to the
/// distance along the axis to the plane of the board. A disk has four points up to 1/25 (exact for polynomials of
/// degree 3), seven above (Radon's rule, degree 5), and 24 above 0.075 (three rings, degree 7). Each side of a panel
/// has two Gauss-Legendre points below 1/25, three from there on, four from 0.075 on and six from 0.15 on. `few`: at
/// most four points per side of a panel.
std::vector<LampPoint> lamp_points(const Light& light, bool few = false);

}  // namespace burin
