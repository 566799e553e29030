#include "burin/calib/photo/crossing_choice.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "burin/calib/photo/photo_fit.h"

namespace burin {
namespace {

struct Square {
  Eigen::Vector2d low{0, 0}, high{0, 0};
  bool holds(const Eigen::Vector2d& p) const {
    return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
  }
};

double length_mm(const Scratches& s, std::size_t i) {
  return std::hypot(s.x1_mm[i] - s.x0_mm[i], s.y1_mm[i] - s.y0_mm[i]);
}

// Whether any of a stroke is in there: places along it, at most a millimeter apart.
bool touches(const Scratches& s, std::size_t i, const Square& square) {
  const int steps = 1 + static_cast<int>(length_mm(s, i));
  for (int k = 0; k <= steps; ++k) {
    const double at = static_cast<double>(k) / steps;
    if (square.holds({s.x0_mm[i] + at * (s.x1_mm[i] - s.x0_mm[i]), s.y0_mm[i] + at * (s.y1_mm[i] - s.y0_mm[i])}))
      return true;
  }
  return false;
}

std::vector<std::size_t> strokes_in(const Scratches& s, const Square& square) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < s.size(); ++i)
    if (touches(s, i, square)) out.push_back(i);
  return out;
}

// The fullest square of the carve area that makes no more pieces than are cut in a few seconds; none if all of it does.
std::optional<Square> part_to_look_at(const ModelData& model) {
  constexpr double kMost = 450'000, kLeastMm = 10, kSmaller = 0.8;
  constexpr int kPlaces = 4;  // either way
  const Scratches& s = model.sent->scratches;
  const Board& board = *model.board;
  const Eigen::Vector2d size = board.carve_max_mm - board.carve_min_mm;
  if (expected_pieces(model) <= kMost) return std::nullopt;
  Square best;
  for (double side = kSmaller * size.minCoeff();; side *= kSmaller) {
    double fullest = -1, pieces = 0;
    for (int j = 0; j <= kPlaces; ++j)
      for (int i = 0; i <= kPlaces; ++i) {
        const Eigen::Vector2d share(static_cast<double>(i) / kPlaces, static_cast<double>(j) / kPlaces);
        const Eigen::Vector2d low = board.carve_min_mm + share.cwiseProduct((size.array() - side).matrix());
        const Square square{low, (low.array() + side).matrix()};
        double length = 0;
        const std::vector<std::size_t> there = strokes_in(s, square);
        for (const std::size_t k : there) length += length_mm(s, k);
        if (length <= fullest) continue;
        fullest = length;
        best = square;
        const double reach = side + length / std::max<double>(1, static_cast<double>(there.size()));
        pieces = expected_pieces(selected(s, there), reach * reach);
      }
    if (pieces <= kMost || side * kSmaller < kLeastMm) return best;
  }
}

}  // namespace

CrossingChoice choose_crossings(const Problem& data, const Stage& stage, const State& state, const Progress& progress) {
  constexpr std::size_t kPhotos = 4;
  Problem part = data;
  part.photos.clear();
  const std::optional<Square> square = part_to_look_at(data.model);
  Sent strokes;
  if (square) {
    const Scratches& all = data.model.sent->scratches;
    strokes = Sent(selected(all, strokes_in(all, *square)));
    part.model.sent = &strokes;
  }
  // All photos of a part have as many pixels as a few of the whole.
  const std::size_t stride = square ? 1 : 1 + (data.photos.size() - 1) / kPhotos;
  for (std::size_t k = 0; k < data.photos.size(); k += stride) {
    PhotoData& photo = part.photos.emplace_back(data.photos[k]);
    if (!square) continue;
    for (std::size_t i = 0; i < photo.weight.size(); ++i)
      if (!square->holds(footprint_middle_mm(*photo.scene.grid, i))) photo.weight[i] = 0;
  }
  // Where grooves cover all of it a part does not show the plain face, nor the lamp and the machine as the whole does.
  Stage freed = stage;
  if (square)
    for (const Group group : {Group::base, Group::machine, Group::lamp, Group::vignette}) freed.free(group, false);
  CrossingChoice best;
  double best_cost = 0;
  for (const auto& [rule, name] : kCrossingsNames) {
    part.model.crossings = rule;
    State trial = state;
    const double cost =
        solve(part, freed, 2, 1e-4, trial, progress, "crossing scratches, " + std::string(in_words(rule)));
    if (rule != kCrossingsNames.front().first && !(cost < best_cost)) continue;
    best_cost = cost;
    best.rule = rule;
    best.state = trial;
  }
  if (!square) return best;
  State whole = state;
  for (const int at : {unknown::log_alpha, unknown::log_depth}) whole.shared[at] = best.state.shared[at];
  best.state = whole;
  return best;
}

}  // namespace burin
