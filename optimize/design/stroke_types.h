// burin/optimize/design/stroke_types.h - data of the search (stroke_search.h): a view's pictures, the rules, and a
// stroke. Frame: board, mm; images as in board_grid, row 0 at the top.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "burin/base/image.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/design/to_metal.h"
#include "burin/scene/groove_field.h"

namespace burin {

/// An off-axis viewpoint of a view, or another channel of it.
struct StrokeAside {
  GlintView glint;
  Image light, unit;
  double weight = 1;  ///< of the errors seen from there
  Image target{};     ///< no pixels: the view's own
  int picture = -1;   ///< as StrokeView::picture
  /// The mask, as StrokeView::mask, if it differs from the view's (a picture of another view).
  std::optional<Image> mask{};
  Image kept{};  ///< as StrokeView::kept
};

/// One view in the search. All images have the grid's size; light is relative to white. A view in color has one
/// StrokeView per lamp. The lamp's channels are asides of it, each with its own target, so all of them judge a stroke.
struct StrokeView {
  GlintView glint;
  Image light;        ///< as shown; the search updates it
  Image target;       ///< gamma-encoded
  Image mask;         ///< 1: counts, 0: ignored; no pixels: every pixel counts
  Image unit;         ///< light of a pixel that a scratch of the best direction crosses along one pixel's length
  double weight = 1;  ///< of the errors seen from the intended position of eye and lamp
  std::vector<StrokeAside> asides{};  ///< further positions that count (at most kMostAsides)
  /// Views (and asides) of the same number from 0 on are one picture under several lamps. A stroke of one of them
  /// changes the light of all, and its errors count once. -1: a picture of its own.
  int picture = -1;
  Image cost{};  ///< reduction of the gain for a pixel crossed along one pixel's length; no pixels: none
  Image kept{};  ///< share of a stroke's light after cuts by others, already in `unit`; no pixels: all
};

inline constexpr std::size_t kMostAsides = 8;

struct StrokeRules {
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};  ///< the carve area, which the images cover
  double shortest_mm = 0, longest_mm = 0;      ///< of a stroke
  double alpha = 0.04;                         ///< if it is constant
  GrooveField alpha_field{};                   ///< its variation
  Eigen::Vector2d board_size_mm{1, 1};
  double dimmest = 0.01;  ///< smallest part of the lobe for a turned stroke
  int candidates = 16;    ///< tried for each stroke

  double alpha_at(const Eigen::Vector2d& p_mm) const {
    return alpha_field.is_constant() ? alpha : std::min(1.0, at_place(alpha_field, alpha, board_size_mm, p_mm));
  }
};

/// A stroke and its decrease of the squared error.
struct Stroke {
  Eigen::Vector2d a_mm{0, 0}, b_mm{0, 0};
  double gain = 0;
  std::size_t view = 0;  ///< for which it is made
};

}  // namespace burin
