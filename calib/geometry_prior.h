// calib/geometry_prior.h - what the tags say about cameras and bow, for fits that let them move.
// Frame: board, mm. Poses move as the renderer's: T' = exp(r) T_camera_board, then its translation + t; (r, t) in
// radians and mm, camera axes. The geometry's unknowns in one vector: (r, t) of each view, then bow_mm (3).
//
// Tags give each pose to some hundredths of a pixel and the bow to a micrometre. That is not nothing: a micrometre of
// bow moves a lamp that is seen by its glints by half a millimetre, and scratches tell lamp and machine better than
// that. So cameras and bow are unknowns beside all others, with the tags' corners as their prior; where tags lie and
// what the lens is have been eliminated from it. They move so little that one Gauss-Newton step does it.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "render/bench.h"
#include "render/board.h"

namespace burin {

using Vector6 = Eigen::Matrix<double, 6, 1>;

struct GeometryPrior {
  std::vector<Eigen::Isometry3d> T_camera_board;  ///< one a view of the bench
  Eigen::Vector3d bow_mm{0, 0, 0};
  Eigen::MatrixXd information;  ///< inverse covariance of the geometry's unknowns: 6 a view, then 3
};

/// From a calibrated bench, by bundle_equations(): the four corners of as many tags as each view used, known to the
/// view's reprojection RMS; tags to board.tags.sigma_mm, their mean shift, turn and growth zero (they are the frame); a
/// lens that is free. A view that says nothing of its tags has a pose that is taken as exact.
GeometryPrior geometry_prior(const Board& board, const Bench& bench);

/// (r, t) that takes `from` to `to`.
Vector6 pose_difference(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to);

/// The pose moved by (r, t).
Eigen::Isometry3d moved_pose(const Eigen::Isometry3d& T_camera_board, const Vector6& by);

}  // namespace burin
