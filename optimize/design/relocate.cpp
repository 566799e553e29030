#include "burin/optimize/design/relocate.h"

#include <algorithm>
#include <numeric>

#include "burin/optimize/design/cut_search.h"
#include "burin/optimize/design/stroke_field.h"
#include "burin/optimize/design/stroke_sweep.h"
#include "burin/optimize/toolpath/ends.h"

namespace burin {

std::vector<std::size_t> relocate(Scratches& scratches, const std::vector<WorkView>& views,
                                  const std::vector<double>& log_exposure, const CarvingLimits& limits,
                                  const StrokeRules& rules, std::size_t movable, double share, std::uint64_t seed,
                                  const std::function<bool()>& stop) {
  const Scratches before = scratches;
  std::vector<StrokeField> fields = stroke_fields(stroke_views(views, log_exposure, false), rules);
  std::vector<std::size_t> view = views_of(fields, scratches);
  std::vector<char> changed(scratches.size(), 0);
  const auto candidates = static_cast<std::size_t>(share * static_cast<double>(movable));
  if (candidates > 0) {
    const std::vector<double> worth = worth_in(fields, scratches, view);
    std::vector<std::size_t> order(movable);  // the carved ones, which come last, stay
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(candidates), order.end(),
                      [&](std::size_t a, std::size_t b) { return worth[a] != worth[b] ? worth[a] < worth[b] : a < b; });
    order.resize(candidates);
    const auto change = [&](std::size_t v, const Ends& e, float times) {
      fields[v].add(e.a, e.b, times, fields[v].whole());
    };
    for (const std::size_t i : order) change(view[i], ends_of(scratches, i), -1);
    std::vector<Stroke> strokes = place_in(fields, rules, candidates, seed, stop);
    std::stable_sort(strokes.begin(), strokes.end(), [](const Stroke& a, const Stroke& b) { return a.gain > b.gain; });
    std::size_t moved = 0;
    while (moved < strokes.size() && strokes[moved].gain > worth[order[moved]]) ++moved;
    // Unprofitable insertions are undone, and the scratches in their place return.
    for (std::size_t k = moved; k < strokes.size(); ++k)
      change(strokes[k].view, {strokes[k].a_mm, strokes[k].b_mm}, -1);
    for (std::size_t k = moved; k < order.size(); ++k) change(view[order[k]], ends_of(scratches, order[k]), 1);
    for (std::size_t k = 0; k < moved; ++k) {
      set_ends(scratches, order[k], {strokes[k].a_mm, strokes[k].b_mm});
      view[order[k]] = strokes[k].view;
      changed[order[k]] = 1;
    }
  }
  for (const std::size_t i : improve_in(fields, rules, scratches, view, movable, seed + 1, stop)) changed[i] = 1;
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < changed.size(); ++i)
    if (changed[i]) {
      moved.push_back(i);
      confine(scratches, i, limits, ends_of(before, i).a, ends_of(before, i).b);
    }
  return moved;
}

std::vector<std::size_t> relocate_cut(Scratches& scratches, const std::vector<WorkView>& views,
                                      const std::vector<double>& log_exposure, const CarvingLimits& limits,
                                      const StrokeRules& rules, const Metal& metal, std::size_t movable,
                                      std::uint64_t seed, const std::function<bool()>& stop) {
  const Scratches before = scratches;
  std::vector<StrokeField> fields = stroke_fields(stroke_views(views, log_exposure, false), rules);
  const std::vector<std::size_t> view = views_of(fields, scratches);
  std::vector<std::size_t> moved = improve_cut(fields, rules, metal, scratches, view, movable, seed, stop);
  for (const std::size_t i : moved) confine(scratches, i, limits, ends_of(before, i).a, ends_of(before, i).b);
  return moved;
}

}  // namespace burin
