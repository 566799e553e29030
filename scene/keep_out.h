// burin/scene/keep_out.h - parts of a straight line outside the keep-outs (burin/scene/board.h).
// Frame: any plane, mm.
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include "burin/scene/board.h"

namespace burin {

/// A part of the line a + t (b - a), with t from 0 to 1.
using LinePart = std::pair<double, double>;

/// Distance from a point to a keep-out, mm; 0 inside.
double distance_mm(const Eigen::Vector2d& p, const KeepOut& place);

/// The parts of the segment at a distance of at least `clearance_mm` from every keep-out, in order. The result is
/// exact: a keep-out widened by the clearance is the union of the keep-out, disks around its corners and strips along
/// its edges.
std::vector<LinePart> free_parts(const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::span<const KeepOut> places,
                                 double clearance_mm);

}  // namespace burin
