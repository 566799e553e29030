// burin/calib/geometry/chessboard.h - views of a chessboard, for a lens of one's own: corners found in photos, or read
// from the table that mrcal's tools keep them in. Frames: the target's (x along a row of corners, y along a column, mm;
// origin at the first corner), pixels (center of the top-left pixel is (0, 0)).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"
#include "burin/calib/geometry/lens_solver.h"

namespace burin {

/// The corners where four squares meet.
struct Chessboard {
  int columns = 9, rows = 6;
  double square_mm = 25;

  /// From the first inner corner to the last.
  Eigen::Vector2d size_mm() const { return {(columns - 1) * square_mm, (rows - 1) * square_mm}; }
};

/// Corners found in a folder of photos of a chessboard.
struct ChessboardViews {
  std::vector<TargetView> views;
  std::vector<Finding> findings;  ///< photos that were passed over, and why
  int width = 0, height = 0;      ///< of the photos, pixels
};

/// Half the side of the window in which OpenCV refines a corner, in pixels of a picture 1600 wide (of smaller ones,
/// their own): OpenCV's own examples use 11. 0: as large as each photo's squares allow, which is better where squares
/// are small.
constexpr int kCornerWindow_px = 11;

/// All photos of a folder in which OpenCV finds the whole board; saddle points refined on the photo's full size. Pixels
/// as stored, EXIF orientation not applied. Throws Error for a folder without photos, and for photos whose sizes
/// differ.
ChessboardViews find_chessboards(const std::filesystem::path& folder, const Chessboard& board,
                                 int corner_window_px = kCornerWindow_px, const Progress& progress = {});

/// A vnlog table with the columns filename, x, y and, if it has one, level (a corner found on the picture halved so
/// often counts 2^-level) or weight. Lines of a photo follow each other, row by row of the board; "-" is a corner that
/// was not found. `width`, `height`: of the photos. Throws Error, naming the line, for anything else.
ChessboardViews read_corners(const std::filesystem::path& vnl, const Chessboard& board, int width, int height);

}  // namespace burin
