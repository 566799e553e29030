// burin/optimize/design/stroke_types.h - what strokes are searched by (stroke_search.h): a view's pictures, the rules,
// and a stroke. Frame: board, mm; images as board_grid lays them, row 0 at the top.
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

/// What a view shows when its eye and lamp stand a little aside, or in another channel.
struct StrokeAside {
  GlintView glint;
  Image light, unit;
  double weight = 1;  ///< of the errors seen from there
  Image target{};     ///< no pixels: the view's own
  int picture = -1;   ///< as StrokeView::picture
  /// What matters of it, where that is not what matters of the view (a picture of another view): as StrokeView::mask.
  std::optional<Image> mask{};
  Image kept{};  ///< as StrokeView::kept
};

/// One view as strokes see it. All images have the grid's size; light is relative to white. A view in color is one for
/// each of its lamps: the channels that the lamp has stand in it as asides do, each with its own target, so that a
/// stroke is judged by what it does to all of them.
struct StrokeView {
  GlintView glint;
  Image light;        ///< shown now; follows the strokes that are placed or taken away
  Image target;       ///< gamma-encoded
  Image mask;         ///< what matters (1) and what does not (0); no pixels: everything
  Image unit;         ///< light of a pixel crossed along one pixel's length by a scratch of the best direction
  double weight = 1;  ///< of the errors seen from where eye and lamp are meant to be
  std::vector<StrokeAside> asides{};  ///< further places that count (at most kMostAsides)
  /// Views (and asides) of the same number from 0 on are the same picture under several lamps: a stroke of one of them
  /// changes the light of all, and its errors count once. -1: a picture of its own.
  int picture = -1;
  Image cost{};  ///< of a pixel crossed along one pixel's length, off the gain; no pixels: nothing
  Image kept{};  ///< the share of a stroke's light that others which cut it leave, in `unit` already; no pixels: all
};

inline constexpr std::size_t kMostAsides = 8;

struct StrokeRules {
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};  ///< the carve area, on which the images lie
  double shortest_mm = 0, longest_mm = 0;      ///< of a stroke
  double alpha = 0.04;                         ///< where it does not vary
  GrooveField alpha_field{};                   ///< how it does
  Eigen::Vector2d board_size_mm{1, 1};
  double dimmest = 0.01;  ///< least part of the lobe a stroke is turned to
  int candidates = 16;    ///< a stroke is the best of

  double alpha_at(const Eigen::Vector2d& p_mm) const {
    return alpha_field.is_constant() ? alpha : std::min(1.0, at_place(alpha_field, alpha, board_size_mm, p_mm));
  }
};

/// A stroke and by how much it lowers the squared error.
struct Stroke {
  Eigen::Vector2d a_mm{0, 0}, b_mm{0, 0};
  double gain = 0;
  std::size_t view = 0;  ///< that it is meant for
};

}  // namespace burin
