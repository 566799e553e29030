// burin/optimize/design/curved_views.h - what a design must know of a board that is not flat: which of it a view sees,
// and how long a stroke may be for the search's model of light. Frame: board, mm; images as board_grid lays them.
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

/// The board's face where it is curved, to be asked by GlintView; nothing for a flat or bowed one.
std::shared_ptr<const BoardFace> curved_face(const Board& board, const Bench& bench);

/// 1 where the eye sees the face, 0 where the face turns away or is hidden; no pixels if it sees all of it.
Image seen_from(const FootprintGrid& grid, const BoardFace& face, const Eigen::Vector3d& eye_mm);

/// Says how much of the carve area the view's eye does not see and its lamp does not reach; throws Error where one of
/// them meets nothing of it.
std::vector<Finding> check_seen(const std::string& view, const FootprintGrid& grid, const BoardFace& face,
                                const Eigen::Vector3d& eye_mm, const Eigen::Vector3d& lamp_mm);

/// Warns of a mesh that stretches the board as no bent sheet of metal does.
std::vector<Finding> check_stretch(const BoardFace& face, const std::string& mesh_file);

/// The longest stroke along which the search may interpolate the half vector's place on the lobe linearly:
/// R sqrt(2 alpha), where the middle of the stroke is off by a quarter of the lobe's width, with R the tightest radius
/// that the face has between min_mm and max_mm. `longest_mm` where the face is not curved.
double longest_straight_mm(const BoardFace& face, const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm,
                           double alpha, double longest_mm);

}  // namespace burin
