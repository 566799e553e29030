#include "burin/optimize/design/to_metal.h"

namespace burin {

Carved Metal::carved_alone(const Scratches& designed) const {
  constexpr std::size_t kWear = GrooveField::kTerms - 1;
  Bench alone = bench;
  alone.crossings = Crossings::add;
  alone.depth_field.terms[kWear] = alone.alpha_field.terms[kWear] = 0;
  return carve(Designed(designed), alone, board);
}

Bench adding_rims(Bench bench) {
  if (bench.crossings == Crossings::deepest) bench.crossings = Crossings::add;
  return bench;
}

std::vector<double> by_design(const Carved& carved, const std::vector<double>& by_groove, std::size_t rows) {
  if (carved.source.empty()) return by_groove;
  std::vector<double> sum(rows, 0.0);
  for (std::size_t k = 0; k < by_groove.size(); ++k) sum[carved.source[k]] += by_groove[k];
  return sum;
}

}  // namespace burin
