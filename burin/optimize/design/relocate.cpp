#include "burin/optimize/design/relocate.h"

#include <algorithm>
#include <numeric>

#include "burin/optimize/carving/ends.h"

namespace burin {

std::vector<std::size_t> relocate(Scratches& scratches, const std::vector<WorkView>& views,
                                  const std::vector<double>& log_exposure, const CarvingLimits& limits,
                                  const StrokeRules& rules, std::size_t movable, double share, std::uint64_t seed,
                                  const std::function<bool()>& stop) {
  const Scratches before = scratches;
  std::vector<StrokeView> light = stroke_views(views, log_exposure, false);
  std::vector<double> worth = worth_of(light, rules, scratches);
  std::vector<std::size_t> order(movable);  // the carved ones, which come last, stay
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto candidates = static_cast<std::ptrdiff_t>(share * static_cast<double>(order.size()));
  std::partial_sort(order.begin(), order.begin() + candidates, order.end(),
                    [&](std::size_t a, std::size_t b) { return worth[a] != worth[b] ? worth[a] < worth[b] : a < b; });
  order.resize(static_cast<std::size_t>(candidates));
  std::vector<char> changed(scratches.size(), 0);
  {
    std::vector<StrokeView> lifted = light;
    lift_strokes(lifted, rules, scratches, order);
    std::vector<Stroke> strokes = place_strokes(lifted, rules, order.size(), seed, stop);
    std::stable_sort(strokes.begin(), strokes.end(), [](const Stroke& a, const Stroke& b) { return a.gain > b.gain; });
    std::size_t moved = 0;
    while (moved < strokes.size() && strokes[moved].gain > worth[order[moved]]) ++moved;
    order.resize(moved);
    lift_strokes(light, rules, scratches, order);
    for (std::size_t k = 0; k < moved; ++k) {
      set_ends(scratches, order[k], {strokes[k].a_mm, strokes[k].b_mm});
      changed[order[k]] = 1;
    }
    add_strokes(light, rules, scratches, order);
  }
  for (const std::size_t i : improve_strokes(light, rules, scratches, movable, seed + 1, stop)) changed[i] = 1;
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < changed.size(); ++i)
    if (changed[i]) {
      moved.push_back(i);
      confine(scratches, i, limits, ends_of(before, i).a, ends_of(before, i).b);
    }
  return moved;
}

}  // namespace burin
