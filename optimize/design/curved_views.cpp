#include "burin/optimize/design/curved_views.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/scene/board_mesh.h"

namespace burin {
namespace {

// 1 if the face looks towards a position and none of it is in between; 0 elsewhere, and in gaps of a mesh.
std::vector<std::uint8_t> open_to(const FootprintGrid& grid, const BoardFace& face, const Eigen::Vector3d& from_mm) {
  const std::vector<std::uint8_t> hidden = hidden_pixels(grid, face, from_mm);
  std::vector<std::uint8_t> open(grid.center_mm.size());
  for (std::size_t i = 0; i < open.size(); ++i)
    open[i] = grid.center_mm[i].allFinite() && grid.normal[i].dot(from_mm - grid.center_mm[i]) > 0 &&
              (hidden.empty() || !hidden[i]);
  return open;
}

double share_of(const std::vector<std::uint8_t>& open) {
  return static_cast<double>(std::count(open.begin(), open.end(), 1)) / static_cast<double>(open.size());
}

}  // namespace

std::shared_ptr<const BoardFace> curved_face(const Board& board, const Bench& bench) {
  auto face = std::make_shared<const BoardFace>(face_of(board, bench));
  return face->curved() ? face : nullptr;
}

Image seen_from(const FootprintGrid& grid, const BoardFace& face, const Eigen::Vector3d& eye_mm) {
  const std::vector<std::uint8_t> open = open_to(grid, face, eye_mm);
  if (share_of(open) == 1) return {};
  Image seen(grid.width(), grid.height(), 1);
  std::copy(open.begin(), open.end(), seen.data.begin());
  return seen;
}

std::vector<Finding> check_seen(const std::string& view, const FootprintGrid& grid, const BoardFace& face,
                                const Eigen::Vector3d& eye_mm, const Eigen::Vector3d& lamp_mm) {
  const double seen = share_of(open_to(grid, face, eye_mm)), lit = share_of(open_to(grid, face, lamp_mm));
  const std::string where = "view " + view;
  for (const auto& [share, who] : {std::pair(seen, "eye"), std::pair(lit, "lamp")})
    if (share == 0)
      fail(where, "all of the bent board's carve area turns away from its " + std::string(who) + ", or hides itself",
           "move the " + std::string(who) + " to the front of the board, or bend it less");
  std::vector<Finding> findings;
  if (seen < 1)
    findings.push_back({FindingCode::view_hidden,
                        Finding::Severity::note,
                        {},
                        where + ": " + fixed(100 * (1 - seen), 1) +
                            " % of the carve area are not seen from there, for the board turns away or hides itself; "
                            "the picture is not compared there",
                        ""});
  if (lit < 1)
    findings.push_back(make_warning(
        FindingCode::view_hidden,
        where + ": " + fixed(100 * (1 - lit), 1) +
            " % of the carve area are not reached by its lamp, for the board turns away or hides itself: dark there",
        "move the lamp further in front of the board"));
  return findings;
}

std::vector<Finding> check_stretch(const BoardFace& face, const std::string& mesh_file) {
  constexpr double kMuch = 0.03;  // relative error of the grooves' widths and lengths
  if (face.mesh == nullptr || face.mesh->most_stretch() <= kMuch) return {};
  return {make_warning(FindingCode::mesh_stretched,
                       mesh_file + " stretches or squeezes the flat board by up to " +
                           fixed(100 * face.mesh->most_stretch(), 1) +
                           " %, which a sheet that is only bent does not: scratches come to lie elsewhere by as much",
                       "bend the mesh without stretching it, or make uv of its true lengths")};
}

double longest_straight_mm(const BoardFace& face, const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm,
                           double alpha, double longest_mm) {
  if (!face.curved()) return longest_mm;
  if (face.mesh == nullptr) {
    const double radius = 1 / std::abs(cylinder_of(face.surface).curvature);
    return std::min(longest_mm, radius * std::sqrt(2 * alpha));
  }
  // Curvature of a mesh: the turn of its normals between lattice points, which are wider apart than most meshes'
  // pieces.
  constexpr int kSide = 24;
  const Eigen::Vector2d step = (max_mm - min_mm) / kSide;
  double curvature = 0;
  for (int j = 0; j <= kSide; ++j)
    for (int i = 0; i <= kSide; ++i) {
      const Eigen::Vector2d p = min_mm + step.cwiseProduct(Eigen::Vector2d(i, j));
      const auto here = face_place(face, p);
      for (int k = 0; k < 2; ++k) {
        const auto next = face_place(face, p + step[k] * Eigen::Vector2d::Unit(k));
        if (here && next) curvature = std::max(curvature, (next->normal - here->normal).norm() / step[k]);
      }
    }
  return curvature > 0 ? std::min(longest_mm, std::sqrt(2 * alpha) / curvature) : longest_mm;
}

}  // namespace burin
