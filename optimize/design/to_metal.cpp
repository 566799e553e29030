#include "burin/optimize/design/to_metal.h"

#include <cmath>

#include "burin/scene/groove_profile.h"

namespace burin {

Carved Metal::carved_alone(const Scratches& designed) const {
  constexpr std::size_t kWear = GrooveField::kTerms - 1;
  Bench alone = bench;
  alone.crossings = Crossings::add;
  alone.depth_field.terms[kWear] = alone.alpha_field.terms[kWear] = 0;
  return carve(Designed(designed), alone, board);
}

double area_mm2(const Scratches& s, const Bench& bench, const Board& board) {
  double sum = 0;
  for (std::size_t i = 0; i < s.size(); ++i)
    sum += std::hypot(s.x1_mm[i] - s.x0_mm[i], s.y1_mm[i] - s.y0_mm[i]) * 2e-3 *
           half_width_um(bench.material.profile, s.width_um.empty() ? board.tool_width_um : s.width_um[i],
                         s.depth_um.empty() ? bench.material.depth_um : s.depth_um[i]);
  return sum;
}

Bench adding_rims(Bench bench) {
  if (bench.crossings == Crossings::deepest) bench.crossings = Crossings::add;
  return bench;
}

Bench without_fields(Bench bench) {
  bench.depth_field = bench.alpha_field = {};
  return bench;
}

std::vector<double> by_design(const Carved& carved, const std::vector<double>& by_groove, std::size_t rows) {
  if (carved.source.empty()) return by_groove;
  std::vector<double> sum(rows, 0.0);
  for (std::size_t k = 0; k < by_groove.size(); ++k) sum[carved.source[k]] += by_groove[k];
  return sum;
}

}  // namespace burin
