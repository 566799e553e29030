// burin/calib/geometry/chessboard.h - views of a chessboard for lens calibration: corners detected in photos, or read
// from the table of mrcal's tools. Frames: the target's (x along a row of corners, y along a column, mm; origin at the
// first corner), pixels (center of the top-left pixel is (0, 0)).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"
#include "burin/calib/geometry/lens_solver.h"

namespace burin {

/// A chessboard, described by its inner corners.
struct Chessboard {
  int columns = 9, rows = 6;
  double square_mm = 25;

  /// From the first inner corner to the last.
  Eigen::Vector2d size_mm() const { return {(columns - 1) * square_mm, (rows - 1) * square_mm}; }
};

/// Corners found in a folder of photos of a chessboard.
struct ChessboardViews {
  std::vector<TargetView> views;
  std::vector<Finding> findings;  ///< skipped photos, with reasons
  int width = 0, height = 0;      ///< of the photos, pixels
};

/// Half the side of the window in which OpenCV refines a corner, in pixels of a picture 1600 wide (smaller pictures:
/// their own pixels). OpenCV's examples use 11. 0: the largest that each photo's squares allow, which is better for
/// small squares.
constexpr int kCornerWindow_px = 11;

/// All photos of a folder in which OpenCV finds the whole board; saddle points are refined at full size. Pixels are as
/// stored, without EXIF orientation. Throws Error for a folder without photos, and for photos of different sizes.
ChessboardViews find_chessboards(const std::filesystem::path& folder, const Chessboard& board,
                                 int corner_window_px = kCornerWindow_px, const Progress& progress = {});

/// Reads a vnlog table with the columns filename, x, y and optionally level or weight. A corner found on the picture
/// halved `level` times has the weight 2^-level. Lines of a photo are contiguous, row by row of the board; "-" marks a
/// missing corner. `width`, `height`: of the photos. Throws Error with the line for any other content.
ChessboardViews read_corners(const std::filesystem::path& vnl, const Chessboard& board, int width, int height);

}  // namespace burin
