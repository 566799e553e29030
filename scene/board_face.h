// burin/scene/board_face.h - the face of a board in a setup, of any shape: flat, bowed, bent to a cylinder, or a mesh
// with uv.
// Frame: board, mm. Rendering, design and calibration all use this interface.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/footprint_grid.h"
#include "burin/scene/surface.h"

namespace burin {

class BoardMesh;

/// A board's face. With a mesh, `surface` holds only the size.
struct BoardFace {
  Surface surface;
  std::shared_ptr<const BoardMesh> mesh{};

  /// True for a bent sheet and a mesh; false for a flat or bowed face.
  bool curved() const { return surface.bend.has_value() || mesh != nullptr; }
};

/// Flat, bowed or bent: as measured in the setup, otherwise as in board.json. The function ignores a board's mesh.
Surface surface_of(const Board& board, const Bench& bench);

/// surface_of() plus the mesh, if the board has one. Throws Error as read_obj() and BoardMesh do.
BoardFace face_of(const Board& board, const Bench& bench);

/// Moves a measured bow of a bent sheet into its bend and clears the bow. A board without a bend stays unchanged.
void settle_bend(const Board& board, Bench& bench);

/// Standard deviations of the bend, from the sigmas of a bent sheet's bow, mm.
Bend bend_sigma_of(const Surface& surface, const Eigen::Vector2d& bow_sigma_mm);

/// A point of the face and its frame. `x` is the flat board's x direction on the face.
struct FacePlace {
  Eigen::Vector3d position_mm, normal, x;

  /// A direction in the frame (x, y, normal). In this frame grooves have the directions of the flat board.
  Eigen::Vector3d in_face(const Eigen::Vector3d& direction) const {
    return {x.dot(direction), normal.cross(x).dot(direction), normal.dot(direction)};
  }
};
/// Nothing in a gap of a mesh.
std::optional<FacePlace> face_place(const BoardFace& face, const Eigen::Vector2d& flat_mm);

/// See footprint_grid.h and board_mesh.h.
FootprintGrid camera_grid(const Lens& lens, const Eigen::Isometry3d& T_camera_board, const BoardFace& face,
                          const PixelWindow& window);
FootprintGrid board_grid(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int width, int height,
                         const BoardFace& face);

/// 1 for each pixel without a footprint, and for each pixel whose center the face itself hides from `from_mm`. Empty
/// for flat, bowed and convex faces: they hide nothing from a point in front of the tangent plane.
std::vector<std::uint8_t> hidden_pixels(const FootprintGrid& grid, const BoardFace& face,
                                        const Eigen::Vector3d& from_mm);

/// 1 for each pixel hidden by the face from the eye or the lamp. Empty for a face without self-occlusion.
std::vector<std::uint8_t> hidden_on_the_way(const FootprintGrid& grid, const BoardFace& face,
                                            const Eigen::Vector3d& eye_mm, const Eigen::Vector3d& lamp_mm);

}  // namespace burin
