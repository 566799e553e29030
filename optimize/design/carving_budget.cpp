#include "burin/optimize/design/carving_budget.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/toolpath/carving_time.h"

namespace burin {

std::vector<double> carving_costs_s(const Scratches& scratches, double depth_um, const MachineProfile& machine) {
  std::vector<double> cost;
  for (std::size_t i = 0; i < scratches.size(); ++i) {
    const Eigen::Vector2d a(scratches.x0_mm[i], scratches.y0_mm[i]), b(scratches.x1_mm[i], scratches.y1_mm[i]);
    const double depth_mm = (scratches.depth_um.empty() ? depth_um : scratches.depth_um[i]) / 1000;
    cost.push_back(scratch_time(a, a, b, depth_mm, machine).total_s());
  }
  const double own = std::accumulate(cost.begin(), cost.end(), 0.0);
  const double air =
      (carving_time_s(scratches, depth_um, machine) - own) / static_cast<double>(std::max<std::size_t>(1, cost.size()));
  for (double& c : cost) c = std::max(1e-6, c + air);
  return cost;
}

std::vector<std::size_t> spare_for_time(std::vector<StrokeView> views, const StrokeRules& rules,
                                        const Scratches& scratches, std::size_t movable,
                                        const std::vector<double>& cost_s, double save_s,
                                        const std::function<bool()>& stop) {
  double saved = 0;
  std::size_t gone = 0;
  std::vector<std::size_t> spared =
      spare_order(std::move(views), rules, scratches, movable, cost_s, [&](std::size_t i, double) {
        if (saved >= save_s || gone + 1 >= scratches.size() || (stop && stop())) return false;
        saved += cost_s[i];
        ++gone;
        return true;
      });
  std::sort(spared.begin(), spared.end());
  return spared;
}

std::vector<CarvingPoint> carving_curve(std::vector<WorkView>& views, const std::vector<double>& log_exposure,
                                        const StrokeRules& rules, const Scratches& scratches, std::size_t movable,
                                        const Metal& metal, const MachineProfile& machine,
                                        const std::function<bool()>& stop) {
  const auto stopped = [&stop] { return stop && stop(); };
  constexpr int kPoints = 10;
  const double depth_um = metal.bench.material.depth_um;
  std::vector<std::size_t> rows(movable);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  const std::vector<double> cost = carving_costs_s(selected(scratches, rows), depth_um, machine);
  const double total = std::accumulate(cost.begin(), cost.end(), 0.0);
  const std::vector<std::size_t> order = spare_order(stroke_views(views, log_exposure, false), rules, scratches,
                                                     movable, cost, [&](std::size_t, double) { return !stopped(); });
  std::vector<CarvingPoint> curve;
  std::size_t next = 0;
  double saved = 0;
  for (int k = kPoints; k > 0; --k) {
    if (stopped()) return {};
    while (next < order.size() && saved < total * (kPoints - k) / kPoints) saved += cost[order[next++]];
    const std::vector<std::size_t> gone(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(next));
    const Scratches left = selected(scratches, all_but(scratches.size(), gone));
    const Scratches to_carve = selected(scratches, all_but(movable, gone));
    if (to_carve.size() == 0) break;
    CarvingPoint point{to_carve.size(), carving_time_s(to_carve, depth_um, machine) / 3600, {}, {}};
    render_all(views, grooves_in(left, metal, views));
    for (const std::span<WorkView> channels : shown_channels(views)) {
      const Image picture = shown_of(channels, best_exposures(channels, log_exposure)), target = target_of(channels);
      point.psnr_db.push_back(color_psnr_db(picture, target, channels[0].target.mask));
      point.ssim.push_back(color_ssim(picture, target, channels[0].target.mask));
    }
    curve.push_back(std::move(point));
  }
  return curve;
}

std::vector<std::size_t> all_but(std::size_t count, const std::vector<std::size_t>& gone) {
  std::vector<char> goes(count, 0);
  for (const std::size_t i : gone) goes[i] = 1;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < count; ++i)
    if (!goes[i]) kept.push_back(i);
  return kept;
}

}  // namespace burin
