// burin/render/surroundings/make_curve_tables.h - a groove's light across it, for all directions, as tables of the fast
// path (burin/render/fast/curve_tables.h). docs/model.md 10.8, 10.12.
#pragma once

#include <memory>
#include <vector>

#include "burin/render/fast/curve_tables.h"
#include "burin/render/surroundings/facet_table.h"
#include "burin/render/surroundings/table_range.h"
#include "burin/render/view_scene.h"

namespace burin {

/// One table per channel, from facets at the range's roughnesses: for the scene's grooves and the burrs next to them.
std::vector<std::shared_ptr<const CurveTables>> make_curve_tables(const ViewScene& scene,
                                                                  const std::vector<FacetTable>& facets,
                                                                  const TableRange& range, const PlaceLattice& lattice);

}  // namespace burin
