// burin/optimize/toolpath/ends.h - one scratch of many by its two ends. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "burin/scene/scratches.h"

namespace burin {

struct Ends {
  Eigen::Vector2d a, b;
  double length() const { return (b - a).norm(); }
};

inline Ends ends_of(const Scratches& s, std::size_t i) { return {{s.x0_mm[i], s.y0_mm[i]}, {s.x1_mm[i], s.y1_mm[i]}}; }

inline void set_ends(Scratches& s, std::size_t i, const Ends& ends) {
  s.x0_mm[i] = ends.a.x(), s.y0_mm[i] = ends.a.y();
  s.x1_mm[i] = ends.b.x(), s.y1_mm[i] = ends.b.y();
}

}  // namespace burin
