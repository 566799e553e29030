// burin/optimize/design/carving_budget.h - designs that can be carved in the hours there are.
//
// What a scratch costs is the machine's time for it: along it, down and up again
// (burin/optimize/toolpath/carving_time.h), and its share of the ways through the air. To save time, the scratches go
// that are worth least for what they cost (stroke_search.h, spare_order).
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

/// Seconds that each scratch costs; they add up to carving_time_s().
std::vector<double> carving_costs_s(const Scratches& scratches, double depth_um, const MachineProfile& machine);

/// The scratches among the first `movable` whose absence saves at least `save_s` and costs the pictures least,
/// ascending; one is always left. Fewer where `stop` (may be empty) returns true before.
std::vector<std::size_t> spare_for_time(std::vector<StrokeView> views, const StrokeRules& rules,
                                        const Scratches& scratches, std::size_t movable,
                                        const std::vector<double>& cost_s, double save_s,
                                        const std::function<bool()>& stop = {});

/// Quality and carving time when less and less of the first `movable` scratches is carved (the rest is in the metal
/// already): from all of them down to a tenth of the time. Only leaves
/// out, so a design made for that time from the start shows more. `views` must be as rendered, exposures fitting;
/// their radiance is overwritten. Empty once `stop` (may be empty) returns true.
std::vector<CarvingPoint> carving_curve(std::vector<WorkView>& views, const std::vector<double>& log_exposure,
                                        const StrokeRules& rules, const Scratches& scratches, std::size_t movable,
                                        const Metal& metal, const MachineProfile& machine,
                                        const std::function<bool()>& stop = {});

/// Which of `count` stay, ascending, when these go.
std::vector<std::size_t> all_but(std::size_t count, const std::vector<std::size_t>& gone);

}  // namespace burin
