// burin/optimize/design/curved_views.h - views of a curved board: visibility, and the longest stroke of the search's
// light model. Frame: board, mm; images as in board_grid.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/image.h"
#include "burin/scene/board_face.h"

namespace burin {

/// The board's face for GlintView if it is curved; nothing for a flat or slightly warped one.
std::shared_ptr<const BoardFace> curved_face(const Board& board, const Bench& bench);

/// 1 in visible pixels, 0 in pixels that turn away or are hidden; no pixels if it sees all of the face.
Image seen_from(const FootprintGrid& grid, const BoardFace& face, const Eigen::Vector3d& eye_mm);

/// Reports invisible and unlit parts of the carve area, for the view's eye and lamp. Throws Error if one of them misses
/// the whole area.
std::vector<Finding> check_seen(const std::string& view, const FootprintGrid& grid, const BoardFace& face,
                                const Eigen::Vector3d& eye_mm, const Eigen::Vector3d& lamp_mm);

/// Warns of a mesh whose stretch is impossible for a bent sheet of metal.
std::vector<Finding> check_stretch(const BoardFace& face, const std::string& mesh_file);

/// The longest stroke along which the search may interpolate the half vector's lobe argument linearly: R sqrt(2 alpha).
/// R is the smallest radius of the face between min_mm and max_mm. In the stroke's middle the error is then a quarter
/// of the lobe's width. `longest_mm` if the face is not curved.
double longest_straight_mm(const BoardFace& face, const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm,
                           double alpha, double longest_mm);

}  // namespace burin
