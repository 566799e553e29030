#include "burin/calib/photo/crossing_choice.h"

#include <string>
#include <vector>

#include "burin/calib/photo/photo_fit.h"

namespace burin {

CrossingChoice choose_crossings(const Problem& data, const Stage& stage, const State& state, const Progress& progress) {
  constexpr std::size_t kPhotos = 4;
  Problem seen = data;
  const bool all = !look_at_sample(kMostTried, state, seen);
  if (all) {  // all photos of a sample have as many pixels as a few of the whole
    const std::size_t stride = 1 + (data.photos.size() - 1) / kPhotos;
    std::vector<PhotoData> few;
    for (std::size_t k = 0; k < data.photos.size(); k += stride) few.push_back(std::move(seen.photos[k]));
    seen.photos = std::move(few);
  }
  for (PhotoData& photo : seen.photos) photo.correction.clear();  // which is for binning under one of the rules
  const Stage freed = all ? stage : stage_of_sample(stage);
  CrossingChoice best;
  double best_cost = 0;
  for (const auto& [rule, name] : kCrossingsNames) {
    seen.model.crossings = rule;
    State trial = state;
    const double cost =
        solve(seen, freed, 2, 1e-4, trial, progress, "crossing scratches, " + std::string(in_words(rule)));
    if (rule != kCrossingsNames.front().first && !(cost < best_cost)) continue;
    best_cost = cost;
    best.rule = rule;
    best.state = trial;
  }
  if (all) return best;
  State whole = state;
  for (const int at : {unknown::log_alpha, unknown::log_depth}) whole.shared[at] = best.state.shared[at];
  best.state = whole;
  return best;
}

}  // namespace burin
