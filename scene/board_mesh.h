// burin/scene/board_mesh.h - boards given as a mesh with uv: bowed, bent or dented; and occlusion of a face from camera
// or lamp.
//
// Frame: board, mm; z out of the metal. The face is a triangle mesh. Its uv give each point's place on the flat,
// designed board: uv = (x / width, y / height). Scratches keep their coordinates in scratches.csv, and the mesh bends
// them. Seen from the front, faces run counter-clockwise, in space and in uv.
//
// Embree casts the rays in float. The intersection with a triangle is computed again in double, so footprints keep
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

/// Triangles. `uv` and `normal` hold one entry per triangle and corner, or are empty.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> position_mm;
  std::vector<std::array<std::uint32_t, 3>> triangle;  ///< into position_mm
  std::vector<std::array<Eigen::Vector2d, 3>> uv;
  std::vector<std::array<Eigen::Vector3d, 3>> normal;
  std::vector<int> line;  ///< of the source file, per triangle, for messages; may be empty
};

/// Reads v, vt, vn and f of a Wavefront OBJ, mm. Polygons become fans of triangles. The reader skips faces without
/// area, groups, materials, lines and points. uv (normals) are empty if any face lacks them. Throws Error with file and
/// line for a non-finite number, an index out of range or a face with fewer than three corners. Throws Error for a
/// missing file and for a file without a face of positive area.
TriangleMesh read_obj(const std::filesystem::path& file);

/// A face and its occluders, ready for rays.
class BoardMesh {
 public:
  /// `name` is the file in messages. Throws Error for a face without uv or with uv without area. Throws Error for uv
  /// that run clockwise seen from the front, or that cover a place of the board twice (a fold). Throws Error for
  /// non-finite numbers and for a non-positive size.
  BoardMesh(const TriangleMesh& face, const Eigen::Vector2d& size_mm, const std::string& name,
            std::span<const TriangleMesh> occluders = {});
  ~BoardMesh();
  BoardMesh(BoardMesh&&) noexcept;
  BoardMesh& operator=(BoardMesh&&) noexcept;

  /// A point of the face.
  struct Place {
    Eigen::Vector2d board_mm;     ///< on the flat board: uv * size_mm
    Eigen::Vector3d position_mm;  ///< in space
    Eigen::Vector3d normal;       ///< unit, interpolated
    Eigen::Vector3d x;            ///< the flat board's x direction, unit, at right angles to the normal
  };

  /// First intersection of a ray, if it is the front of the face within 0 .. size_mm; otherwise nothing.
  std::optional<Place> first_hit(const Eigen::Vector3d& origin_mm, const Eigen::Vector3d& direction) const;

  /// The place with these board coordinates; nothing in a gap of the mesh.
  std::optional<Place> place(const Eigen::Vector2d& board_mm) const;

  /// True if the face itself or an occluder blocks the segment from a place of the face to `from_mm` (a lamp, a
  /// camera), or if `from_mm` is behind the face there.
  bool hidden_from(const Eigen::Vector3d& from_mm, const Eigen::Vector3d& position_mm,
                   const Eigen::Vector3d& normal) const;

  /// The flat board's size.
  const Eigen::Vector2d& size_mm() const;

  /// Largest stretch or compression of the flat board by the mesh: 0.1 is 10 %. A bent sheet of metal has none.
  double most_stretch() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The footprints of a photo's pixels on a mesh. Corners are board xy (uv * size); centers and normals are the mesh's.
/// A corner is NaN if its ray misses the face, meets its back, or is blocked. All corners of a pixel are NaN if its
/// center is hidden from the camera, as on the edge of a fold or of an occluder. There is no homography.
FootprintGrid camera_grid(const CornerRays& rays, const Eigen::Isometry3d& T_camera_board, const BoardMesh& mesh);
FootprintGrid camera_grid(const Lens& lens, const Eigen::Isometry3d& T_camera_board, const BoardMesh& mesh,
                          const PixelWindow& window);

/// The pixels of a picture on the board: rectangles on the flat board between min_mm and max_mm, row 0 at the top.
/// Centers and normals are the mesh's. Corners are finite, except for a pixel whose center falls into a gap of the
/// mesh: its corners are NaN.
FootprintGrid board_grid(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int width, int height,
                         const BoardMesh& mesh);

/// 1 for each pixel without a footprint, and for each pixel whose center is hidden from `from_mm` (see
/// BoardMesh::hidden_from).
std::vector<std::uint8_t> hidden_pixels(const FootprintGrid& grid, const BoardMesh& mesh,
                                        const Eigen::Vector3d& from_mm);

}  // namespace burin
