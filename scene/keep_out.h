// burin/scene/keep_out.h - which parts of a straight line a forbidden place (burin/scene/board.h) leaves free.
// Frame: any plane, mm.
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include "burin/scene/board.h"

namespace burin {

/// A part of the line a + t (b - a), t from 0 to 1.
using LinePart = std::pair<double, double>;

/// Distance from a point to a place, mm; 0 inside.
double distance_mm(const Eigen::Vector2d& p, const KeepOut& place);

/// The parts of the segment that keep at least `clearance_mm` from every place, in order; exact: a place widened by
/// the clearance is the union of the place, of disks round its corners and of strips along its edges.
std::vector<LinePart> free_parts(const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::span<const KeepOut> places,
                                 double clearance_mm);

}  // namespace burin
