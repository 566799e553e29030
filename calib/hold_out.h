// burin/calib/hold_out.h - predicts held-out photos, as a test against overfitting.
//
// Corners: lens, bow and tags are solved without the held-out photos. Half the tags of such a photo give its pose, and
// the corners of the other half are predicted; then the halves swap. Pixels: grooves, lamp and machine are fitted
// without the held-out photos. Every pixel of these is then predicted, with the pose from their tags. Frames: board
// (mm), camera, pixels (center of the top-left pixel is (0, 0)).
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

/// Views to hold out, fold by fold, from an option's text:
///   ""           four folds (or as many as leave three views), each view held out once
///   "all"        as many folds as views
///   "5"          this number of folds
///   "0.25"       one fold with this share of the views, spread evenly
///   "v03,v07"    one fold with these views
/// Throws Error for an unknown view, or if fewer than `fewest_left` views are left to solve from.
std::vector<std::vector<std::string>> hold_out_folds(const std::string& wanted, const std::vector<std::string>& views,
                                                     std::size_t fewest_left);

/// One photo's corners, RMS per axis, px.
struct HeldOutView {
  std::string view;
  int tags = 0;                ///< number predicted
  double fit_rms_px = 0;       ///< when the view is used
  double held_out_rms_px = 0;  ///< predicted without it
  /// RMS that the corners' own noise alone gives: noise of the predicted corners, and of the pose from the other half.
  double expected_rms_px = 0;
};

/// Prediction errors of corners in held-out views.
struct HeldOutCorners {
  std::vector<HeldOutView> views;
  double fit_rms_px = 0, held_out_rms_px = 0, expected_rms_px = 0;  ///< over all views
};

/// Solves again for each fold. `solution` is solve_board() of all `pictures` with the same options.
HeldOutCorners hold_out_corners(const BoardSolution& solution, const Board& board,
                                const std::vector<ViewTags>& pictures,
                                const std::vector<std::vector<std::string>>& folds,
                                const BoardSolverOptions& options = {}, const Progress& progress = {});

/// One photo's pixels.
struct HeldOutPhoto {
  PhotoFit fit;       ///< as refine() explains it when it is used
  PhotoFit held_out;  ///< as predicted without it
};

/// Fits again for each fold. `refined` is refine() of all `photos`, from the same `measured` bench.
std::vector<HeldOutPhoto> hold_out_pixels(const Refinement& refined, std::span<const MergedView> photos,
                                          const Board& board, const Sent& sent, const Bench& measured,
                                          const std::vector<std::vector<std::string>>& folds,
                                          const RefineOptions& options = {}, const Progress& progress = {});

/// Predicts photos, used or not, by a refined bench. Poses come from `refined.bench`; nothing is fitted.
std::vector<PhotoFit> predict_photos(const Refinement& refined, std::span<const MergedView> photos, const Board& board,
                                     const Sent& sent);

}  // namespace burin
