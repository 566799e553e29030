#include "burin/optimize/toolpath/carving_time.h"

#include <utility>

namespace burin {

CarvingTime scratch_time(const Eigen::Vector2d& at_mm, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm,
                         double depth_mm, const MachineProfile& machine) {
  CarvingTime time;
  time.metal_s = move_time_s((to_mm - from_mm).norm(), machine.carve_feed_mm_min, machine.acceleration_mm_s2);
  time.air_s = move_time_s((from_mm - at_mm).norm(), machine.rapid_mm_min, machine.acceleration_mm_s2);
  if (machine.depth_by == DepthBy::servo) {
    time.down_s = 2 * machine.dwell_s;
    return time;
  }
  const double z_mm = machine.safe_z_mm + plunge_mm(machine, depth_mm);
  time.down_s = move_time_s(z_mm, machine.plunge_feed_mm_min, machine.acceleration_z_mm_s2) + machine.dwell_s +
                move_time_s(z_mm, machine.rapid_z_mm_min, machine.acceleration_z_mm_s2);
  return time;
}

CarvingTime carving_time(const Scratches& scratches, const std::vector<CarvingStep>& order, double depth_um,
                         const MachineProfile& machine) {
  CarvingTime sum;
  Eigen::Vector2d at(0, 0);
  for (const CarvingStep& step : order) {
    const std::size_t i = step.scratch;
    Eigen::Vector2d from(scratches.x0_mm[i], scratches.y0_mm[i]), to(scratches.x1_mm[i], scratches.y1_mm[i]);
    if (step.reversed) std::swap(from, to);
    const double depth_mm = 1e-3 * (scratches.depth_um.empty() ? depth_um : scratches.depth_um[i]);
    const CarvingTime time = scratch_time(at, from, to, depth_mm, machine);
    sum.metal_s += time.metal_s;
    sum.air_s += time.air_s;
    sum.down_s += time.down_s;
    at = to;
  }
  return sum;
}

double carving_time_s(const Scratches& scratches, double depth_um, const MachineProfile& machine) {
  CarvingOrderOptions quick;
  quick.kicks_per_scratch = 0;
  return carving_time(scratches, carving_order(scratches, quick), depth_um, machine).total_s();
}

}  // namespace burin
