#include "burin/calib/photo/model_data.h"

#include <cmath>
#include <cstddef>
#include <numeric>

#include "burin/calib/photo/effect_unknowns.h"
#include "burin/calib/photo/machine_map.h"
#include "burin/scene/groove_profile.h"

namespace burin {

std::array<double, GrooveField::kTerms> depth_field_of(const Unknowns& x) {
  std::array<double, GrooveField::kTerms> terms{};
  for (int i = 0; i < GrooveField::kTerms; ++i) terms[i] = x[unknown::depth_field + i];
  return terms;
}

Bench bench_at(const ModelData& model, const Unknowns& x) {
  Bench bench;
  bench.machine_affine = affine_of(machine_map(x), model.center_mm);
  bench.material.depth_um = std::exp(x[unknown::log_depth]);
  bench.material.alpha = std::exp(x[unknown::log_alpha]);
  bench.material.profile = profile_of(model.profile, x);
  bench.machine_errors = machine_errors_of(x);
  bench.depth_field.terms = depth_field_of(x);
  bench.alpha_field.terms = model.alpha_field;
  bench.crossings = model.crossings;
  return bench;
}

double expected_pieces(const ModelData& model) {
  if (!model.sample.is_whole()) return model.sample.pieces;
  return expected_pieces(model.sent->scratches, (model.board->carve_max_mm - model.board->carve_min_mm).prod());
}

double covered_share(const ModelData& model, const Unknowns& x) {
  const Scratches& s = model.sent->scratches;
  const Bench bench = bench_at(model, x);
  double area_mm2 = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double width_um = s.width_um.empty() ? model.board->tool_width_um : s.width_um[i];
    area_mm2 += 2e-3 * half_width_um(bench.material.profile, width_um, bench.material.depth_um) *
                std::hypot(s.x1_mm[i] - s.x0_mm[i], s.y1_mm[i] - s.y0_mm[i]);
  }
  return area_mm2 / (model.board->carve_max_mm - model.board->carve_min_mm).prod();
}

Carved carved_at(const ModelData& model, const Unknowns& x) {
  return carve(*model.sent, bench_at(model, x), *model.board, model.sample.surroundings, model.cut);
}

Carved carved_pieces(const ModelData& model, const Unknowns& x) {
  Carved carved = carved_at(model, x);
  const std::size_t n = carved.size();
  if (carved.scratches.depth_um.empty()) carved.scratches.depth_um.assign(n, std::exp(x[unknown::log_depth]));
  if (carved.scratches.alpha.empty()) carved.scratches.alpha.assign(n, std::exp(x[unknown::log_alpha]));
  if (carved.source.empty()) {
    carved.source.resize(n);
    std::iota(carved.source.begin(), carved.source.end(), 0U);
  }
  return carved;
}

}  // namespace burin
