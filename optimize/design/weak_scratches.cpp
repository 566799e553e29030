#include "burin/optimize/design/weak_scratches.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace burin {

std::vector<std::size_t> weak_scratches(std::vector<StrokeView> views, const StrokeRules& rules,
                                        const Scratches& scratches, std::size_t movable,
                                        const std::vector<double>& light_sum, const DesignOptions& options,
                                        const std::function<bool()>& stop) {
  const double total_light =
      std::accumulate(light_sum.begin(), light_sum.begin() + static_cast<std::ptrdiff_t>(movable), 0.0);
  const double error = squared_error(views);
  const auto most = static_cast<std::size_t>(options.drop_share * static_cast<double>(movable));
  std::size_t gone = 0;
  double rise = 0, light = 0;
  return spare_order(std::move(views), rules, scratches, movable, {}, [&](std::size_t i, double worth) {
    if (++gone == movable || (stop && stop())) return false;  // one always remains
    rise += std::max(0.0, worth);
    light += light_sum[i];
    return options.drop_share > 0   ? gone <= most
           : options.drop_light > 0 ? light <= options.drop_light * total_light
                                    : rise <= options.drop_error * error;
  });
}

}  // namespace burin
