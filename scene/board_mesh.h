// burin/scene/board_mesh.h - boards given as a mesh with uv: bowed, bent, dented; and what hides a face from camera or
// lamp.
//
// Frame: board, mm; z out of the metal. The face is a triangle mesh whose uv say which place of the flat, designed
// board each point is: uv = (x / width, y / height), so scratches stay where scratches.csv has them and the mesh bends
// them along. Seen from the front, faces run counter-clockwise, in space and in uv.
//
// Rays are cast by Embree, in float; where a ray meets its triangle is computed again in double, so footprints keep
// their digits. Normals are interpolated: the file's vn, or the mean of the neighboring faces weighted by their area.
// docs/file-formats.md (`mesh`), docs/curved.md.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "burin/scene/footprint_grid.h"
#include "burin/scene/lens.h"

namespace burin {

/// Triangles. `uv` and `normal` hold one entry a triangle and corner, or are empty.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> position_mm;
  std::vector<std::array<std::uint32_t, 3>> triangle;  ///< into position_mm
  std::vector<std::array<Eigen::Vector2d, 3>> uv;
  std::vector<std::array<Eigen::Vector3d, 3>> normal;
  std::vector<int> line;  ///< of the file each triangle came from, for messages; may be empty
};

/// Reads v, vt, vn and f of a Wavefront OBJ, mm; polygons become fans of triangles; faces without area are left out;
/// groups, materials, lines and points are passed over. uv (normals) are empty if any face lacks them. Throws Error
/// naming file and line for a number that is not finite, an index that does not exist or a face of fewer than three
/// corners; and for a file that is missing or holds no face with an area.
TriangleMesh read_obj(const std::filesystem::path& file);

/// A face and what stands around it, ready for rays.
class BoardMesh {
 public:
  /// `name` stands in messages: the file. Throws Error for a face without uv, with uv that have no area or run
  /// clockwise seen from the front or cover a place of the board twice (a mesh that folds), with numbers that are not
  /// finite, or for a size that is not positive.
  BoardMesh(const TriangleMesh& face, const Eigen::Vector2d& size_mm, const std::string& name,
            std::span<const TriangleMesh> occluders = {});
  ~BoardMesh();
  BoardMesh(BoardMesh&&) noexcept;
  BoardMesh& operator=(BoardMesh&&) noexcept;

  /// A point of the face.
  struct Place {
    Eigen::Vector2d board_mm;     ///< where it is on the flat board: uv * size_mm
    Eigen::Vector3d position_mm;  ///< where it is in space
    Eigen::Vector3d normal;       ///< unit, interpolated
    Eigen::Vector3d x;            ///< where the flat board's x direction points, unit, at right angles to the normal
  };

  /// Where a ray first meets anything, if that is the front of the face within 0 .. size_mm; else nothing.
  std::optional<Place> first_hit(const Eigen::Vector3d& origin_mm, const Eigen::Vector3d& direction) const;

  /// The place with these board coordinates; nothing where the mesh has a gap.
  std::optional<Place> place(const Eigen::Vector2d& board_mm) const;

  /// Whether the straight way from a place of the face to `from_mm` (a lamp, a camera) is blocked by the face itself,
  /// by an occluder, or because `from_mm` lies behind the face there.
  bool hidden_from(const Eigen::Vector3d& from_mm, const Eigen::Vector3d& position_mm,
                   const Eigen::Vector3d& normal) const;

  /// The flat board's size.
  const Eigen::Vector2d& size_mm() const;

  /// By how much the mesh stretches or squeezes the flat board where it does so most: 0.1 is 10 %. A sheet of metal
  /// that is only bent has none.
  double most_stretch() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The footprints of a photo's pixels on a mesh. Corners are board xy (uv * size), centers and normals those of the
/// mesh there. NaN at corners whose ray misses the face, meets its back, or is blocked; and at all corners of a pixel
/// whose center is hidden from the camera, as where it straddles the edge of a fold or of an occluder. There is no
/// homography.
FootprintGrid camera_grid(const CornerRays& rays, const Eigen::Isometry3d& T_camera_board, const BoardMesh& mesh);
FootprintGrid camera_grid(const Lens& lens, const Eigen::Isometry3d& T_camera_board, const BoardMesh& mesh,
                          const PixelWindow& window);

/// Rectangles laid on the flat board between min_mm and max_mm, row 0 at the top, centers and normals those of the
/// mesh: the pixels of a picture as it lies on the board. Corners are all finite; a pixel whose center falls into a gap
/// of the mesh has NaN at its corners.
FootprintGrid board_grid(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int width, int height,
                         const BoardMesh& mesh);

/// 1 for every pixel whose footprint's center is hidden from `from_mm` (see BoardMesh::hidden_from), or has no
/// footprint.
std::vector<std::uint8_t> hidden_pixels(const FootprintGrid& grid, const BoardMesh& mesh,
                                        const Eigen::Vector3d& from_mm);

}  // namespace burin
