#include "burin/scene/board_face.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

#include "burin/scene/board_mesh.h"
#include "burin/scene/surface.h"

namespace burin {

Surface surface_of(const Board& board, const Bench& bench) {
  return {board.size_mm, bench.bow_mm, bench.bend ? bench.bend : board.bend};
}

BoardFace face_of(const Board& board, const Bench& bench) {
  if (board.mesh.empty()) return {surface_of(board, bench), nullptr};
  return {Surface{board.size_mm, Eigen::Vector3d::Zero(), {}},
          std::make_shared<const BoardMesh>(read_obj(board.mesh), board.size_mm, board.mesh.string())};
}

void settle_bend(const Board& board, Bench& bench) {
  const Surface surface = surface_of(board, bench);
  if (!surface.bend) return;
  bench.bend = bench.bow_mm.isZero() ? *surface.bend : bend_of(cylinder_of(surface));
  bench.bow_mm.setZero();
}

Bend bend_sigma_of(const Surface& surface, const Eigen::Vector2d& bow_sigma_mm) {
  // cylinder_of() is linear in both numbers, in curvature and axis.
  const Cylinder at = cylinder_of(surface);
  Surface moved = surface;
  moved.bow_mm.head<2>() += bow_sigma_mm;
  const Cylinder there = cylinder_of(moved);
  const double turn =
      std::atan2(at.along.x() * there.along.y() - at.along.y() * there.along.x(), at.along.dot(there.along));
  return {std::abs(there.curvature - at.curvature) / (at.curvature * at.curvature),
          std::abs(turn) * 180 / std::numbers::pi};
}

std::optional<FacePlace> face_place(const BoardFace& face, const Eigen::Vector2d& flat_mm) {
  if (face.mesh != nullptr) {
    const auto place = face.mesh->place(flat_mm);
    if (!place) return std::nullopt;
    return FacePlace{place->position_mm, place->normal, place->x};
  }
  const Eigen::Vector3d normal = face_normal(face.surface, flat_mm.x(), flat_mm.y());
  return FacePlace{face_point(face.surface, flat_mm.x(), flat_mm.y()), normal, R_face_board(normal).row(0).transpose()};
}

FootprintGrid camera_grid(const Lens& lens, const Eigen::Isometry3d& T_camera_board, const BoardFace& face,
                          const PixelWindow& window) {
  if (face.mesh != nullptr) return camera_grid(lens, T_camera_board, *face.mesh, window);
  return camera_grid(lens, T_camera_board, face.surface, window);
}

FootprintGrid board_grid(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int width, int height,
                         const BoardFace& face) {
  if (face.mesh != nullptr) return board_grid(min_mm, max_mm, width, height, *face.mesh);
  return board_grid(min_mm, max_mm, width, height, face.surface);
}

std::vector<std::uint8_t> hidden_pixels(const FootprintGrid& grid, const BoardFace& face,
                                        const Eigen::Vector3d& from_mm) {
  if (face.mesh != nullptr) return hidden_pixels(grid, *face.mesh, from_mm);
  if (!face.surface.bend) return {};
  const Cylinder cylinder = cylinder_of(face.surface);
  if (cylinder.curvature >= 0) return {};
  std::vector<std::uint8_t> hidden(grid.center_mm.size(), 1);
  tbb::parallel_for(std::size_t{0}, hidden.size(), [&](std::size_t i) {
    const Eigen::Vector2d flat = footprint_middle_mm(grid, i);
    if (flat.allFinite()) hidden[i] = hidden_from(cylinder, bent_place(cylinder, flat), from_mm);
  });
  return hidden;
}

std::vector<std::uint8_t> hidden_on_the_way(const FootprintGrid& grid, const BoardFace& face,
                                            const Eigen::Vector3d& eye_mm, const Eigen::Vector3d& lamp_mm) {
  std::vector<std::uint8_t> hidden = hidden_pixels(grid, face, lamp_mm);
  const std::vector<std::uint8_t> from_eye = hidden_pixels(grid, face, eye_mm);
  for (std::size_t i = 0; i < hidden.size(); ++i) hidden[i] = hidden[i] || from_eye[i];
  return hidden;
}

}  // namespace burin
