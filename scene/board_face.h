// burin/scene/board_face.h - the face of a board on a bench, whatever its shape: flat, bowed, bent to a cylinder, or a
// mesh with uv. Frame: board, mm. The one place that everything that draws, designs or looks asks.
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

/// A board's face. Where there is a mesh, `surface` has only its size.
struct BoardFace {
  Surface surface;
  std::shared_ptr<const BoardMesh> mesh{};

  /// Neither flat nor merely bowed.
  bool curved() const { return surface.bend.has_value() || mesh != nullptr; }
};

/// Flat, bowed or bent, as the bench measured it, or else as the board says. A board's mesh is not looked at.
Surface surface_of(const Board& board, const Bench& bench);

/// The same with a mesh, if the board has one. Throws Error as read_obj() and BoardMesh do.
BoardFace face_of(const Board& board, const Bench& bench);

/// What a bow found in photos makes of a bent sheet goes into its bend, and the bow is none; a board that is not bent
/// stays as it is.
void settle_bend(const Board& board, Bench& bench);

/// What uncertainties of a bent sheet's bow, mm, make of its bend.
Bend bend_sigma_of(const Surface& surface, const Eigen::Vector2d& bow_sigma_mm);

/// A place of the face in space, and its frame: `x` is the flat board's x direction as it lies on the face.
struct FacePlace {
  Eigen::Vector3d position_mm, normal, x;

  /// A direction in the frame (x, y, normal), in which grooves run as on the flat board.
  Eigen::Vector3d in_face(const Eigen::Vector3d& direction) const {
    return {x.dot(direction), normal.cross(x).dot(direction), normal.dot(direction)};
  }
};
/// Nothing where a mesh has a gap.
std::optional<FacePlace> face_place(const BoardFace& face, const Eigen::Vector2d& flat_mm);

/// See footprint_grid.h and board_mesh.h.
FootprintGrid camera_grid(const Lens& lens, const Eigen::Isometry3d& T_camera_board, const BoardFace& face,
                          const PixelWindow& window);
FootprintGrid board_grid(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int width, int height,
                         const BoardFace& face);

/// 1 for every pixel from whose center the face itself hides `from_mm`, or that has no footprint. Empty where a face of
/// that shape hides nothing from whoever stands in front of its tangent plane: flat, bowed, convex.
std::vector<std::uint8_t> hidden_pixels(const FootprintGrid& grid, const BoardFace& face,
                                        const Eigen::Vector3d& from_mm);

/// 1 where the face sends no light from the lamp to the eye because it hides itself from either. Empty where it never
/// does.
std::vector<std::uint8_t> hidden_on_the_way(const FootprintGrid& grid, const BoardFace& face,
                                            const Eigen::Vector3d& eye_mm, const Eigen::Vector3d& lamp_mm);

}  // namespace burin
