// burin/scene/groove_field.h - variation of the grooves' depth or roughness over a board and along the carving order.
// Frame: uv = (x / width, y / height) of the board at a scratch's middle; age from 0 (first carved) to 1 (last).
//
//   factor(u, v, age) = (1 + gx U + gy V + qxx (U^2 - 1/12) + qxy U V + qyy (V^2 - 1/12)) (1 - wear (age - 1/2)),
//   U = u - 1/2, V = v - 1/2.
//
// The terms have mean zero over the board, so the shared depth or alpha that the factor multiplies stays the mean.
// docs/model.md 7.3.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace burin {

/// Dependence of a groove's depth or roughness on its place and its carving order: docs/model.md 7.
struct GrooveField {
  static constexpr int kTerms = 6;  ///< gx, gy, qxx, qxy, qyy, wear
  std::array<double, kTerms> terms{};
  std::optional<std::array<double, kTerms>> sigma;

  /// True if all grooves are alike.
  bool is_constant() const {
    for (const double t : terms)
      if (t != 0) return false;
    return true;
  }
  /// True if the factor has a gradient over the board.
  bool is_linear() const { return terms[0] != 0 || terms[1] != 0; }
  /// True if the factor has curvature over the board.
  bool is_quadratic() const { return terms[2] != 0 || terms[3] != 0 || terms[4] != 0; }
  /// Tool wear: the coefficient of the carving order.
  double wear() const { return terms[5]; }
};

/// Factors of the first five terms.
inline std::array<double, 5> field_terms_at(double u, double v) {
  const double U = u - 0.5, V = v - 0.5;
  return {U, V, U * U - 1.0 / 12, U * V, V * V - 1.0 / 12};
}

/// The spatial part of the factor, clamped below at 0.05.
inline double field_over_board(const std::array<double, GrooveField::kTerms>& terms, double u, double v) {
  const auto at = field_terms_at(u, v);
  double factor = 1;
  for (std::size_t i = 0; i < at.size(); ++i) factor += terms[i] * at[i];
  return factor < 0.05 ? 0.05 : factor;
}

inline double field_at_age(const std::array<double, GrooveField::kTerms>& terms, double age) {
  const double factor = 1 - terms[5] * (age - 0.5);
  return factor < 0.05 ? 0.05 : factor;
}

}  // namespace burin
