// burin/render/surroundings/table_range.h - roughnesses and leans of facets that a view's tables need.
#pragma once

#include <vector>

#include "burin/render/view_scene.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Roughnesses, ascending, 5 % apart: one, or at least three if grooves differ or the derivative by alpha is wanted.
/// Facets lean up to 2 atan(steepest_t). Grooves are |t| <= rim.
struct TableRange {
  std::vector<double> alphas;
  double steepest_t = 0, rim = 0;
};
TableRange table_range(const ViewScene& scene, const Scratches& scratches, bool by_alpha);

/// True if tables of a range also suit these scratches.
bool serves(const TableRange& range, const ViewScene& scene, const Scratches& scratches);

}  // namespace burin
