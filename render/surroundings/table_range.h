// burin/render/surroundings/table_range.h - which roughnesses and which leans of facets a view's tables must hold.
#pragma once

#include <vector>

#include "burin/render/view_scene.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Roughnesses, ascending, 5 % apart: one, or three and more where grooves differ or the derivative by alpha is asked
/// for; facets lean up to 2 atan(steepest_t); grooves reach up to |t| = rim across.
struct TableRange {
  std::vector<double> alphas;
  double steepest_t = 0, rim = 0;
};
TableRange table_range(const ViewScene& scene, const Scratches& scratches, bool by_alpha);

/// Whether tables of a range serve these scratches as well.
bool serves(const TableRange& range, const ViewScene& scene, const Scratches& scratches);

}  // namespace burin
