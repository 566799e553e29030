// burin/scene/lamp_size.h - a lamp with an area, as points of it. docs/model.md 5.5. Frame: board, mm.
//
// What a lamp with an area sends is the mean of what its points send: each a near lamp of the same axis and fall-off.
// The mean is taken by a rule of few points (lamp_points). A point's offset moves half vectors by about half of
// offset / distance. While the farthest point moves them by less than half of the roughness, the rules are good to a
// hundredth of a glint's middle (tests/scene/lamp_size_test.cpp holds them against thousands of points).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/scene/light.h"

namespace burin {

/// One point of a lamp: where it lies from the lamp's middle, and its share of the light (all add up to 1).
struct LampPoint {
  Eigen::Vector3d offset_mm{0, 0, 0};
  double share = 1;
};

/// Two unit vectors across `axis`: the columns. The first is the board's x made orthogonal to the axis (its y where the
/// axis runs along x), turned by `turn_deg` about the axis.
Eigen::Matrix<double, 3, 2> across_axis(const Eigen::Vector3d& axis, double turn_deg);

/// The points that stand for a lamp: the more, the larger a disk's radius or a panel's half side is beside the distance
/// that its axis runs to the plane of the board. Below a 25th of it one for a point lamp, four for a disk (right for
/// polynomials of the third degree), Gauss and Legendre's two for each side of a panel. Above: seven (Radon's, of the
/// fifth degree), and three; from 0.075 on 24 (three rings, of the seventh degree), and four; six from 0.15 on. `few`:
/// seven and three at most.
std::vector<LampPoint> lamp_points(const Light& light, bool few = false);

}  // namespace burin
