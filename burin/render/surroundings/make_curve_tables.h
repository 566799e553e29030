// burin/render/surroundings/make_curve_tables.h - a groove's light across it, of all directions, as the fast path's
// tables (burin/render/fast/curve_tables.h). docs/model.md 10.8, 10.12.
#pragma once

#include <memory>
#include <vector>

#include "burin/render/fast/curve_tables.h"
#include "burin/render/surroundings/facet_table.h"

namespace burin {

/// Of facets at some roughnesses (`facets` and `alphas` in one order), one for each channel, for |t| <= steepest_t.
std::vector<std::shared_ptr<const CurveTables>> make_curve_tables(const std::vector<FacetTable>& facets,
                                                                  const std::vector<double>& alphas, double steepest_t,
                                                                  const PlaceLattice& lattice);

}  // namespace burin
