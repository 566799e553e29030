// tools/view/board_view.h - contents of the viewer's page: a board on one or several benches, its viewpoints and their
// targets. view_sources.h collects them for `burin view`, and view_page.h writes the page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "burin/base/image.h"
#include "burin/base/progress.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "tools/match_views.h"

namespace burin {

/// A viewpoint under a lamp, with its target.
struct ViewedPicture {
  std::string view, light;  ///< names in the bench; several lights at once are joined by kBesides
  /// Target on the carve area, gamma-encoded, row 0 is the largest y; three channels in color; no pixels: no target.
  Image target;
  /// White balance in color: factors on R, G, B. With `each_channel`, each channel also has its own exposure.
  Eigen::Vector3d gains{1, 1, 1};
  bool each_channel = false;
};

/// The board on a nominal or measured bench.
struct ViewedBoard {
  std::string name;      ///< label of its button: "Before", "As carved"
  std::string sentence;  ///< its description
  Bench bench;
  Carved carved;
  std::vector<ViewedPicture> pictures;     ///< at least one
  std::vector<MatchTolerance> tolerances;  ///< by shown_tolerances(); may be empty
};

/// All contents of one page.
struct BoardView {
  std::string title;
  Board board;
  std::vector<ViewedBoard> boards;  ///< at least one; the page starts with the first
};

/// Renders a picture flat on the carve area, encoded for display, as in `burin design`, with `long_side_px` on its
/// longer side. `exposure` is a factor on radiance: the best one for the target or, without a target, the one at which
/// the brightest half per cent clips. In color, `gains` are the picture's, combined with the balance of channels that
/// have their own exposures.
struct FlatPicture {
  Image shown;
  double exposure = 1;
  Eigen::Vector3d gains{1, 1, 1};
};
FlatPicture flat_picture(const Board& board, const ViewedBoard& viewed, const ViewedPicture& picture, int long_side_px);

}  // namespace burin
