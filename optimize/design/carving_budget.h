// burin/optimize/design/carving_budget.h - designs within a limit of carving hours.
//
// The cost of a scratch is the machine's time for it: along it, down and up again
// (burin/optimize/toolpath/carving_time.h), and its share of the travel. Pruning removes the scratches with the least
// marginal contribution per cost (stroke_search.h, spare_order).
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "burin/optimize/design/design_views.h"
#include "burin/optimize/design/stroke_search.h"
#include "burin/optimize/design/to_metal.h"
#include "burin/optimize/design_result.h"
#include "burin/optimize/machine_profile.h"

namespace burin {

/// Costs of the scratches, s; their sum is carving_time_s().
std::vector<double> carving_costs_s(const Scratches& scratches, double depth_um, const MachineProfile& machine);

/// The scratches among the first `movable` whose removal saves at least `save_s` with the smallest loss, ascending. One
/// scratch always remains. Fewer result if `stop` (may be empty) returns true before.
std::vector<std::size_t> spare_for_time(std::vector<StrokeView> views, const StrokeRules& rules,
                                        const Scratches& scratches, std::size_t movable,
                                        const std::vector<double>& cost_s, double save_s,
                                        const std::function<bool()>& stop = {});

/// Quality and carving time if fewer and fewer of the first `movable` scratches are carved, from all of them down to a
/// tenth of the time. The other scratches are existing grooves. The curve only omits scratches, so a design made for
/// that time from the start shows more. `views` must be rendered with fitting exposures; the function overwrites their
/// radiance. Empty once `stop` (may be empty) returns true.
std::vector<CarvingPoint> carving_curve(std::vector<WorkView>& views, const std::vector<double>& log_exposure,
                                        const StrokeRules& rules, const Scratches& scratches, std::size_t movable,
                                        const Metal& metal, const MachineProfile& machine,
                                        const std::function<bool()>& stop = {});

/// The indices below `count` that are not in `gone`, ascending.
std::vector<std::size_t> all_but(std::size_t count, const std::vector<std::size_t>& gone);

}  // namespace burin
