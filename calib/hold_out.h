// burin/calib/hold_out.h - how well photos that were not used are predicted: the proof that a fit is more than a fit.
//
// Corners: lens, bow and tags are solved without the photos held out. Of each of those, half the tags give its pose,
// and the corners of the other half are predicted; then the halves change places. Pixels: grooves, lamp and machine are
// fitted without the photos held out, and every pixel of those is predicted, with the pose that their tags gave.
// Frames: board (mm), camera, pixels (center of the top-left pixel is (0, 0)).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/geometry/board_solver.h"
#include "burin/calib/refine.h"
#include "burin/capture/photo.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"

namespace burin {

/// Which views to hold out, fold by fold, from what a person wrote:
///   ""           four folds (or as many as leave three views), each view held out once
///   "all"        as many folds as views
///   "5"          that many folds
///   "0.25"       one fold with that share of the views, spread evenly
///   "v03,v07"    one fold with these views
/// Throws Error for a view that is not there, or if fewer than `fewest_left` views are left to solve from.
std::vector<std::vector<std::string>> hold_out_folds(const std::string& wanted, const std::vector<std::string>& views,
                                                     std::size_t fewest_left);

/// One photo's corners, RMS per axis, px.
struct HeldOutView {
  std::string view;
  int tags = 0;                ///< judged
  double fit_rms_px = 0;       ///< when it was used
  double held_out_rms_px = 0;  ///< predicted without it
  /// What the corners' own noise alone would give: that of those judged, and of the pose from the other half.
  double expected_rms_px = 0;
};

/// How well corners are predicted in views that were not used.
struct HeldOutCorners {
  std::vector<HeldOutView> views;
  double fit_rms_px = 0, held_out_rms_px = 0, expected_rms_px = 0;  ///< over all views
};

/// Solves once more for each fold. `solution` is solve_board() of all `pictures` with the same options.
HeldOutCorners hold_out_corners(const BoardSolution& solution, const Board& board,
                                const std::vector<ViewTags>& pictures,
                                const std::vector<std::vector<std::string>>& folds,
                                const BoardSolverOptions& options = {}, const Progress& progress = {});

/// One photo's pixels.
struct HeldOutPhoto {
  PhotoFit fit;       ///< as refine() explains it when it was used
  PhotoFit held_out;  ///< as predicted without it
};

/// Fits once more for each fold. `refined` is refine() of all `photos`, from the same `measured` bench.
std::vector<HeldOutPhoto> hold_out_pixels(const Refinement& refined, std::span<const MergedView> photos,
                                          const Board& board, const Sent& sent, const Bench& measured,
                                          const std::vector<std::vector<std::string>>& folds,
                                          const RefineOptions& options = {}, const Progress& progress = {});

/// How a refined bench predicts photos, used or not: poses from `refined.bench`, nothing is fitted.
std::vector<PhotoFit> predict_photos(const Refinement& refined, std::span<const MergedView> photos, const Board& board,
                                     const Sent& sent);

}  // namespace burin
