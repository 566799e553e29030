// tools/view/board_view.h - what the viewer's page shows: a board as one or several benches show it, the places to look
// from, and what each was to show. `burin view` gathers it (view_sources.h) and writes it (view_page.h).
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

/// A place to look from, under a lamp, and what is to be seen from there.
struct ViewedPicture {
  std::string view, light;  ///< names in the bench; of light several joined by kBesides, which shine at once
  Image target;  ///< on the carve area, gamma-encoded, row 0 the largest y; in color three channels; no pixels: none
  /// In color what makes white of what is to look white: factors on R, G, B. Each channel is then shown at an exposure
  /// of its own if `each_channel`.
  Eigen::Vector3d gains{1, 1, 1};
  bool each_channel = false;
};

/// The board on a bench, believed or measured.
struct ViewedBoard {
  std::string name;      ///< a button's: "Before", "As carved"
  std::string sentence;  ///< what it is
  Bench bench;
  Carved carved;
  std::vector<ViewedPicture> pictures;     ///< at least one
  std::vector<MatchTolerance> tolerances;  ///< by shown_tolerances(); may be empty
};

/// All that goes into one page.
struct BoardView {
  std::string title;
  Board board;
  std::vector<ViewedBoard> boards;  ///< at least one; the page begins with the first
};

/// What a picture looks like when it is laid flat on the carve area, encoded as it is shown, and the exposure (times
/// radiance) that it is shown at: what comes nearest to the target, or, without one, all but the brightest half per
/// cent below white. In color `gains` are the picture's, with the balance of those whose channels have exposures of
/// their own. Rendered as `burin design` sees it, `long_side_px` on its longer side.
struct FlatPicture {
  Image shown;
  double exposure = 1;
  Eigen::Vector3d gains{1, 1, 1};
};
FlatPicture flat_picture(const Board& board, const ViewedBoard& viewed, const ViewedPicture& picture, int long_side_px);

}  // namespace burin
