#include "burin/optimize/design/obey.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "burin/optimize/toolpath/ends.h"

namespace burin {
namespace {

constexpr int kRounds = 6;  // of re-insertion; each finds a place for about half of the dropped scratches

std::vector<std::size_t> rows_without(std::size_t count, const std::vector<std::size_t>& rows) {
  std::vector<std::size_t> others;
  auto next = rows.begin();
  for (std::size_t i = 0; i < count; ++i) {
    if (next != rows.end() && *next == i)
      ++next;
    else
      others.push_back(i);
  }
  return others;
}

}  // namespace

Obeying obey(const Scratches& scratches, const CarvingLimits& limits, std::vector<WorkView>& views,
             const std::vector<double>& log_exposure, const StrokeRules& rules, const Metal& metal, std::uint64_t seed,
             const std::function<bool()>& stop) {
  std::vector<double> worth;
  if (has_pair_rules(limits.machine)) worth = worth_of(stroke_views(views, log_exposure, false), rules, scratches);
  Mended mended = mend(scratches, limits, worth);
  const std::vector<std::optional<Rule>> broken = std::move(mended.broken);
  Obeying out{std::move(mended.scratches), std::move(mended.rows), {}, {}};
  std::vector<char> placed(scratches.size(), 0);
  for (int round = 0; round < kRounds && out.rows.size() < scratches.size() && !(stop && stop()); ++round) {
    const std::vector<std::size_t> left_over = rows_without(scratches.size(), out.rows);
    render_all(views, grooves_in(out.scratches, metal, views));
    std::vector<StrokeView> light = stroke_views(views, log_exposure, false);
    const std::vector<Stroke> strokes = place_strokes(light, rules, left_over.size(), seed + round, stop);
    if (strokes.empty()) break;
    // Valid scratches come first and stay as they are; new ones follow by their gain.
    Scratches all = scratches;
    std::vector<double> value(scratches.size(), 0.0);
    for (std::size_t k = 0; k < out.rows.size(); ++k) {
      set_ends(all, out.rows[k], ends_of(out.scratches, k));
      value[out.rows[k]] = std::numeric_limits<double>::infinity();
    }
    std::vector<std::size_t> tried = out.rows;
    for (std::size_t k = 0; k < std::min(strokes.size(), left_over.size()); ++k) {
      set_ends(all, left_over[k], {strokes[k].a_mm, strokes[k].b_mm});
      value[left_over[k]] = strokes[k].gain;
      placed[left_over[k]] = 1;
      tried.push_back(left_over[k]);
    }
    std::sort(tried.begin(), tried.end());
    std::vector<double> tried_value;
    tried_value.reserve(tried.size());
    for (const std::size_t i : tried) tried_value.push_back(value[i]);
    Mended more = mend(selected(all, tried), limits, tried_value);
    for (std::size_t& row : more.rows) row = tried[row];
    out.scratches = std::move(more.scratches);
    out.rows = std::move(more.rows);
  }
  for (const std::size_t i : out.rows)
    if (placed[i]) out.placed.push_back(i);
  for (const std::size_t i : rows_without(scratches.size(), out.rows))
    if (broken[i]) ++out.dropped[static_cast<std::size_t>(*broken[i])];
  return out;
}

}  // namespace burin
