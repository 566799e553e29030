// Grooves that cut each other's rims away, as a design of three views on 88 x 68 mm sees them: the pieces that all
// crossings leave of each groove's glint line (burin/optimize/design/glint_lines.h), everything found anew. `pieces`:
// their number; `per_piece`: processor time of all threads over it.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "burin/optimize/design/glint_lines.h"

namespace burin {
namespace {

Scratches crowded_scratches(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(16, 104), y(16, 84), turn(-0.05, 0.05), half(1, 6);
  Scratches out;
  for (int i = 0; i < count; ++i) {
    const double angle = std::numbers::pi * (i % 3) / 3 + turn(random), length = half(random), px = x(random),
                 py = y(random);
    out.x0_mm.push_back(px - length * std::cos(angle)), out.y0_mm.push_back(py - length * std::sin(angle));
    out.x1_mm.push_back(px + length * std::cos(angle)), out.y1_mm.push_back(py + length * std::sin(angle));
  }
  return out;
}

void PiecesOfGlintLines(benchmark::State& state) {
  Board board;
  board.size_mm = {120, 100};
  Bench bench;
  bench.crossings = Crossings::deepest;
  const GlintView glint{"view", {60, 8, 599}, {60, 436, 460}};
  const Scratches grooves = crowded_scratches(static_cast<int>(state.range(0)));
  std::vector<std::size_t> rows(grooves.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
  const std::vector<const GlintView*> glints(rows.size(), &glint);
  std::size_t pieces = 0;
  for (auto _ : state) {
    const Carved left = GlintCuts(grooves, bench, board).left_of(rows, glints);
    benchmark::DoNotOptimize(left.source.data());
    pieces = left.size();
  }
  state.counters["pieces"] = static_cast<double>(pieces);
  state.counters["per_piece"] =
      benchmark::Counter(static_cast<double>(pieces) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(PiecesOfGlintLines)->Arg(3000)->Arg(10000)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace burin
