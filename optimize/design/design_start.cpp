#include "burin/optimize/design/design_start.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "burin/base/error.h"
#include "burin/optimize/design/curved_views.h"
#include "burin/optimize/design/random.h"
#include "burin/optimize/toolpath/ends.h"

namespace burin {
namespace {

// A random position in the area, and a random direction.
Stroke random_stroke(const CarvingLimits& limits, double mean_length_mm, std::mt19937_64& random) {
  const Eigen::Vector2d middle(limits.min_mm.x() + uniform(random) * (limits.max_mm.x() - limits.min_mm.x()),
                               limits.min_mm.y() + uniform(random) * (limits.max_mm.y() - limits.min_mm.y()));
  const double angle = std::numbers::pi * uniform(random), half = mean_length_mm * (0.25 + 0.5 * uniform(random));
  const Eigen::Vector2d u(std::cos(angle), std::sin(angle));
  return {middle - half * u, middle + half * u, 0};
}

}  // namespace

void check_options(const DesignOptions& o, const Board& board) {
  const auto need = [](bool ok, const char* field, const char* what, const char* remedy) {
    if (!ok) fail(std::string("design option ") + field, what, remedy);
  };
  need(o.pixels == 0 || (o.pixels >= 16 && o.pixels <= 8192), "pixels", "is out of range",
       "give 16 to 8192; 0 chooses");
  need(!o.iterations || (*o.iterations >= 0 && *o.iterations <= 1000000), "iterations", "is out of range",
       "100 is usual");
  need(o.rate >= 0 && o.rate < 1 && o.final_rate >= 0 && o.final_rate < 1, "rate", "is out of range",
       "0.001 is usual, 0 chooses");
  need(o.loss.perceptual >= 0 && o.loss.l2 >= 0 && o.loss.gram >= 0 && o.loss.perceptual + o.loss.l2 + o.loss.gram > 0,
       "loss", "has a negative weight, or all are 0", "the paper's are perceptual 1, gram 0.01");
  need(o.min_length > 0 && o.min_length < 0.5, "min_length", "is out of range", "0.001 is usual");
  const double shortest = o.min_length * board.size_mm.maxCoeff();
  need(o.max_length_mm == 0 || o.max_length_mm > shortest, "max_length_mm", "is below the smallest length",
       "give more, or 0 for any length");
  need(o.carve_hours >= 0 && o.carve_hours < 1e5, "carve_hours", "is out of range", "5 to 10 is usual");
  need(o.lift_blacks >= 0 && o.lift_blacks <= 1, "lift_blacks", "is out of range", "a share from 0 to 1: 1 is usual");
  need(o.start_light > 0 && o.start_light < 1e3, "start_light", "is out of range", "0.5 is usual");
  need(o.candidates >= 1 && o.candidates <= 10000, "candidates", "is out of range", "16 is usual");
  need(o.balance >= 0 && o.balance <= 10, "balance", "is out of range", "0 is for the mean of the views, 1 is strong");
  need(o.tolerance_mm >= 0 && o.tolerance_mm < 1e6, "tolerance_mm", "is out of range", "20 mm is a start");
  need(o.drop_error >= 0 && o.drop_error < 1 && o.drop_light >= 0 && o.drop_light < 1 && o.drop_share >= 0 &&
           o.drop_share < 1,
       "drop", "is not a share from 0 to 1", "0.01 of the error is usual");
  const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
  if (!(area.minCoeff() > 4 * shortest))
    fail("board: carve_mm", "is too small to carve in", "give a rectangle with sides of several mm");
}

CarvingLimits design_limits(const Board& board, const Bench& bench, const DesignOptions& options) {
  MachineLimits machine = options.machine;
  machine.shortest_mm = std::max(machine.shortest_mm, options.min_length * board.size_mm.maxCoeff());
  if (options.max_length_mm > 0)
    machine.longest_mm =
        machine.longest_mm > 0 ? std::min(machine.longest_mm, options.max_length_mm) : options.max_length_mm;
  if (machine.longest_mm > 0 && machine.longest_mm < machine.shortest_mm + 2 * machine.step_mm)
    fail("design", "the longest scratch allowed is shorter than the shortest", "allow longer or shorter ones");
  return carving_limits(board, machine, bench.material.depth_um, bench.machine_affine);
}

StrokeRules stroke_rules(const CarvingLimits& limits, double mean_length_mm, const Bench& bench, const Board& board,
                         int candidates) {
  StrokeRules rules;
  rules.candidates = candidates;
  rules.min_mm = limits.min_mm;
  rules.max_mm = limits.max_mm;
  // Flat parts of a picture need long strokes. Short ones cost much machine time for little light.
  const double most = longest_straight_mm(face_of(board, bench), limits.min_mm, limits.max_mm, bench.material.alpha,
                                          std::min(10 * mean_length_mm, 0.9 * (limits.max_mm - limits.min_mm).norm()));
  rules.longest_mm = limits.machine.longest_mm > 0 ? std::min(limits.machine.longest_mm, most) : most;
  rules.shortest_mm = std::min(std::max(limits.machine.shortest_mm, 0.1 * mean_length_mm), rules.longest_mm);
  rules.alpha = bench.material.alpha;
  rules.alpha_field = bench.alpha_field;
  rules.board_size_mm = board.size_mm;
  return rules;
}

Scratches scratches_of(const std::vector<Stroke>& strokes) {
  Scratches s;
  for (auto* a : {&s.x0_mm, &s.y0_mm, &s.x1_mm, &s.y1_mm}) a->resize(strokes.size());
  for (std::size_t i = 0; i < strokes.size(); ++i) set_ends(s, i, {strokes[i].a_mm, strokes[i].b_mm});
  return s;
}

Scratches random_start(std::size_t count, const CarvingLimits& limits, double mean_length_mm, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Stroke> strokes;
  for (std::size_t i = 0; i < count; ++i) strokes.push_back(random_stroke(limits, mean_length_mm, random));
  return scratches_of(strokes);
}

void settle(Scratches& scratches, const CarvingLimits& limits, double mean_length_mm, std::uint64_t seed) {
  constexpr int kTries = 1000;
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < scratches.size(); ++i) {
    bool lawful = confine(scratches, i, limits, ends_of(scratches, i).a, ends_of(scratches, i).b);
    for (int k = 0; !lawful && k < kTries; ++k) {
      const Stroke stroke = random_stroke(limits, mean_length_mm, random);
      set_ends(scratches, i, {stroke.a_mm, stroke.b_mm});
      lawful = confine(scratches, i, limits, stroke.a_mm, stroke.b_mm);
    }
    if (!lawful)
      fail("design", "keep-outs and tags leave no room for a scratch in the carve area",
           "make carve_mm larger or keep_out smaller in board.json, or allow shorter scratches");
  }
}

}  // namespace burin
