// burin/optimize/toolpath/carving_time.h - how long a machine takes to carve scratches.
//
// A scratch is: through the air to its first end, down, settle, along it, up again; each of these moves from rest to
// rest with the profile's feeds and accelerations (move_time_s). Frame: any plane, mm. The estimate is of the built-in
// way to carve; a profile with blocks of its own is timed by replaying what it writes
// (burin/optimize/toolpath/toolpath_check.h).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/carving_order.h"
#include "burin/scene/scratches.h"

namespace burin {

struct CarvingTime {
  double metal_s = 0;  ///< along the scratches
  double air_s = 0;    ///< from each scratch to the next, and from work zero to the first
  double down_s = 0;   ///< down, settling and up again

  double total_s() const { return metal_s + air_s + down_s; }
};

/// Of one scratch, from where the tool stands before it (lifted).
CarvingTime scratch_time(const Eigen::Vector2d& at_mm, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm,
                         double depth_mm, const MachineProfile& machine);

/// Of all, in this order, beginning at work zero. `depth_um` is that of scratches without a depth of their own.
CarvingTime carving_time(const Scratches& scratches, const std::vector<CarvingStep>& order, double depth_um,
                         const MachineProfile& machine);

/// Seconds to carve these scratches, for budgets: ordered by the quick part of carving_order (no random changes), which
/// costs 0.6 s for 40,000 scratches instead of 4.8 and says 0.2 % more than the final order.
double carving_time_s(const Scratches& scratches, double depth_um, const MachineProfile& machine);

}  // namespace burin
