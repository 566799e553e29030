// burin/scene/footprint_grid.h - footprints of a view's pixels on the board's face.
// Frame: board xy, mm. Pixels: the center of the top-left pixel is (0, 0), so corner (c, r) is at (c - 0.5, r - 0.5).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "burin/scene/lens.h"
#include "burin/scene/surface.h"

namespace burin {

/// A rectangle of a photo's pixels: columns x0 .. x0 + width - 1, rows y0 .. y0 + height - 1.
struct PixelWindow {
  int x0 = 0, y0 = 0, width = 0, height = 0;
};

/// Pixels and their footprints. Pixel (c, r) has the corners (c, r), (c + 1, r), (c + 1, r + 1), (c, r + 1). A corner
/// that misses the face (or is hidden) is NaN; a pixel with such a corner renders as `Image` value 0.
struct FootprintGrid {
  PixelWindow window;                            ///< of the photo; x0 = y0 = 0 for a grid without a photo
  std::vector<double> corner_x_mm, corner_y_mm;  ///< (width + 1) * (height + 1), row-major
  std::vector<Eigen::Vector3d> center_mm;        ///< width * height: the mean of the corners, on the face, board frame
  std::vector<Eigen::Vector3d> normal;           ///< width * height: the face's unit normal there
  /// width * height: the flat board's x direction there, unit, at right angles to the normal. Empty for all faces but
  /// meshes: the shortest turn of z to the normal gives it (docs/model.md 1.1).
  std::vector<Eigen::Vector3d> x_axis;
  std::optional<Eigen::Matrix3d> board_from_pixel;  ///< homography from window pixels to board xy, if there is one

  /// Pixels per row.
  int width() const { return window.width; }
  /// Number of rows.
  int height() const { return window.height; }
};

/// A grid for several views: the views of a design have the same footprints on the board.
inline std::shared_ptr<const FootprintGrid> share(FootprintGrid grid) {
  return std::make_shared<const FootprintGrid>(std::move(grid));
}

/// The four corners of a pixel's footprint, in order around it. Board xy, mm.
inline std::array<Eigen::Vector2d, 4> footprint_corners_mm(const FootprintGrid& grid, int c, int r) {
  const std::size_t top = static_cast<std::size_t>(r) * (grid.window.width + 1) + c;
  const std::size_t bottom = top + grid.window.width + 1;
  const auto corner = [&](std::size_t i) { return Eigen::Vector2d(grid.corner_x_mm[i], grid.corner_y_mm[i]); };
  return {corner(top), corner(top + 1), corner(bottom + 1), corner(bottom)};
}

/// The mean of a pixel's corners: its center's flat place, mm. On a face without a bend, it is center_mm's xy.
inline Eigen::Vector2d footprint_middle_mm(const FootprintGrid& grid, std::size_t pixel) {
  const auto width = static_cast<std::size_t>(grid.width());
  const auto q = footprint_corners_mm(grid, static_cast<int>(pixel % width), static_cast<int>(pixel / width));
  return 0.25 * (q[0] + q[1] + q[2] + q[3]);
}

/// Area between four corners in order, negative if they run clockwise.
inline double signed_area_mm2(const std::array<Eigen::Vector2d, 4>& q) {
  const Eigen::Vector2d a = q[2] - q[0], b = q[3] - q[1];
  return 0.5 * (a.x() * b.y() - a.y() * b.x());
}

/// The rays of a window's pixel corners in camera coordinates, as (x / z, y / z); NaN if the lens has no inverse there.
/// They depend on the lens alone, so callers keep them while poses change.
struct CornerRays {
  PixelWindow window;
  std::vector<Eigen::Vector2d> slope;  ///< (width + 1) * (height + 1), row-major
  bool undistorted = false;            ///< a pinhole, or a model with zero distortion
  Eigen::Vector4d fxycxy{1, 1, 0, 0};  ///< of an undistorted lens, for window pixels
};
CornerRays corner_rays(const Lens& lens, const PixelWindow& window);

/// The footprints of a photo's pixels on a flat or bowed board, for any of mrcal's lens models. A ray misses the face
/// if it meets it outside 0 .. surface.size_mm, from behind, or not at all. Throws Error for an empty window or a board
/// without size.
FootprintGrid camera_grid(const Lens& lens, const Eigen::Isometry3d& T_camera_board, const Surface& surface,
                          const PixelWindow& window);

/// From precomputed rays.
FootprintGrid camera_grid(const CornerRays& rays, const Eigen::Isometry3d& T_camera_board, const Surface& surface);

/// The pixels of a picture on the board, independent of any camera: width x height rectangles between min_mm and
/// max_mm, row 0 at the top (largest y). Designs use it.
FootprintGrid board_grid(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int width, int height,
                         const Surface& surface);

/// Smallest window of the photo that holds the board rectangle min_mm .. max_mm and `margin_px` around it, clipped to
/// the photo. Width or height is 0 if the rectangle is outside. If part of it is behind the camera, the result is the
/// whole photo.
PixelWindow window_of(const Lens& lens, const Eigen::Isometry3d& T_camera_board, const Surface& surface,
                      const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int margin_px);

}  // namespace burin
