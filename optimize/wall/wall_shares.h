// burin/optimize/wall/wall_shares.h - couplings between the boards of a wall: one exposure per view, and the share of
// each board in the wall's scratches or machine hours. docs/walls.md.
//
// Boards are seen together, so a view has one exposure for all of them. A preview of each board gives the exposure that
// would suit it best, and how much its error grows beside it. The common exposure minimizes the sum of these errors.
//
// Previews with several numbers of scratches give a board's error over the number, E = floor + a / n. The floor is what
// scratches cannot mend, such as the plain face's light in a dark part. Strokes that each approximate their share of an
// area leave an error in proportion to this share, hence 1 / n. The wall's error is least where one scratch more (or
// one second more on the machine) lowers each board's error alike.
#pragma once

#include <vector>

namespace burin {

/// One view of a board's preview.
struct ViewPreview {
  double best_exposure = 0;  ///< at which the preview is closest to its target
  double stiffness = 0;      ///< growth of its error, mm^2, per squared difference of log(exposure); 0: a black picture
};

/// A preview with one number of scratches.
struct PreviewTrial {
  double scratches = 0;
  double error = 0;    ///< squared differences from the targets over all views and the carve area, mm^2
  double carve_s = 0;  ///< time to carve them
};

/// Preview of one board.
struct BoardPreview {
  std::vector<ViewPreview> views;  ///< in the wall's order
  std::vector<PreviewTrial> trials;
};

/// The exposure of each view that minimizes the sum of the boards' errors, with six significant digits; 0 for a view
/// that is black on every board.
std::vector<double> common_exposures(const std::vector<BoardPreview>& boards);

/// Error of a board over its scratches: E = floor + a / n, fitted to its trials by least squares; `a` is not negative.
struct ErrorCurve {
  double floor = 0, a = 0;
  double at(double scratches) const { return floor + a / scratches; }
};
ErrorCurve error_curve(const std::vector<PreviewTrial>& trials);

/// Scratches of each board, whose sum is at most `total` and minimizes the sum of the boards' errors. Shares stay
/// between the fewest and the most of a board's trials, because the curve is unknown beyond. A `total` beyond the sums
/// of these limits gives the nearest limits.
std::vector<int> shared_scratches(const std::vector<BoardPreview>& boards, double total);

/// The same for `total_s` seconds of carving on all machines together.
std::vector<int> shared_hours(const std::vector<BoardPreview>& boards, double total_s);

}  // namespace burin
