#include "burin/render/groove_field.h"

#include <algorithm>

namespace burin {

void apply_fields(const GrooveField& depth, const GrooveField& roughness, double depth_um, double alpha,
                  const Eigen::Vector2d& board_size_mm, Scratches& carved) {
  const std::size_t n = carved.size();
  const auto apply = [&](const GrooveField& field, double shared, double most, std::vector<double>& values) {
    if (field.is_constant()) return;
    if (values.empty()) values.assign(n, shared);
    for (std::size_t i = 0; i < n; ++i) {
      const double u = 0.5 * (carved.x0_mm[i] + carved.x1_mm[i]) / board_size_mm.x();
      const double v = 0.5 * (carved.y0_mm[i] + carved.y1_mm[i]) / board_size_mm.y();
      const double age = n > 1 ? static_cast<double>(i) / static_cast<double>(n - 1) : 0.5;
      values[i] = std::min(most, values[i] * field_over_board(field.terms, u, v) * field_at_age(field.terms, age));
    }
  };
  apply(depth, depth_um, 1e9, carved.depth_um);
  apply(roughness, alpha, 1, carved.alpha);
}

}  // namespace burin
