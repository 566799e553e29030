#include "burin/calib/verdict/at_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "burin/base/files/decimals.h"
#include "burin/scene/parameter_name.h"

namespace burin {
namespace {

struct Held {
  int index;
  const char *name, *by;
};

constexpr std::array<Held, 3> kHeld{
    {{unknown::log_alpha, parameter::kAlpha,
      "photos whose half vectors lean a little along the grooves hold it: give board.json a roughness that is right to "
      "a "
      "factor of two, and take a photo from nearer to the lamp's mirror image"},
     {unknown::log_depth, parameter::kDepth,
      "photos from both sides of the grooves' cut-off hold it: check tool.width_um in board.json, and take one photo "
      "from further to the side"},
     {unknown::log_base_alpha, parameter::kBaseAlpha,
      "a photo that shows the lamp's mirror image on plain metal, with a short exposure, holds it; on a "
      "mirror-polished "
      "face no photo may"}}};

// Reports spotlights whose axis misses the board by diagonals, or whose beam is narrower than any lamp's.
void judge_spots(const Problem& data, const State& state, Bench& bench, std::vector<Finding>& out) {
  for (std::size_t light = 0; light < state.lamps.size(); ++light) {
    if (!data.is_spot[light] || data.spot_held[light]) continue;
    bool on_it = false;
    for_each_unknown([&](const UnknownRow& row, int first) {
      double low = 0, high = 0;
      if (!row.of_spot || !bounds_of(data, row, low, high)) return;
      const double near = 1e-3 * (high - low);
      for (int i = 0; i < row.size; ++i) {
        const double value = state.block(first, light)[i];
        on_it = on_it || value > high - near || (first == unknown::spot && value < low + near);
      }
    });
    if (!on_it) continue;
    const std::string& id = bench.lights[light].id;
    out.push_back(make_warning(
        FindingCode::parameter_at_bound,
        "axis and fall-off of light " + id + " ran to the end of what is possible: these photos do not hold them",
        "tags all around the board hold them, if their white paper is not clipped in a photo"));
    for (const std::string& name : {parameter::light_axis(id), parameter::light_falloff(id)})
      bench.verdict[name].degree = Degree::not_determined;
  }
}

}  // namespace

bool is_on_bound(const Problem& data, const State& state, int unknown) {
  constexpr double kOnIt = 1e-4;  // of a logarithm
  bool on_it = false;
  for_each_unknown([&](const UnknownRow& row, int first) {
    double low = 0, high = 0;
    if (first != unknown || !bounds_of(data, row, low, high)) return;
    const double value = state.block(first)[row.bounds.at];
    on_it = value <= low + kOnIt || value >= high - kOnIt;
  });
  return on_it;
}

std::vector<Finding> judge_bounds(const Problem& data, const Stage& stage, const State& state, Bench& bench) {
  std::vector<Finding> out;
  for_each_unknown([&](const UnknownRow& row, int first) {
    const auto held = std::find_if(kHeld.begin(), kHeld.end(), [&](const Held& h) { return h.index == first; });
    if (held == kHeld.end() || !stage.frees(row.group) || !is_on_bound(data, state, first)) return;
    const double value = state.block(first)[row.bounds.at];
    out.push_back(make_warning(FindingCode::parameter_at_bound,
                               parameter::in_words(held->name) + " ran to " + significant(std::exp(value), 3) +
                                   ", the end of what is possible: these photos do not hold it",
                               held->by));
    Verdict& verdict = bench.verdict[held->name];
    verdict.degree = Degree::not_determined;
  });
  if (stage.frees(Group::lamp)) judge_spots(data, state, bench, out);
  return out;
}

}  // namespace burin
