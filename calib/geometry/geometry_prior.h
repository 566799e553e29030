// burin/calib/geometry/geometry_prior.h - what the tags say about cameras, bow and lens, for fits that let them move.
// Frame: board, mm. Poses move as the renderer's: T' = exp(r) T_camera_board, then its translation + t; (r, t) in
// radians and mm, camera axes. The geometry's unknowns in one vector: (r, t) of each view, behind it what its own lens
// differs by where lenses do (OwnLens: shift over the focal length, logarithm of focal_ratio); bow_mm (3), and the lens
// as moved_lens() takes it.
//
// Tags give each pose to some hundredths of a pixel and the bow to a micrometer. That is not nothing: a micrometer of
// bow moves a lamp that is seen by its glints by half a millimeter, and scratches tell lamp and machine better than
// that. So cameras, bow and lens are unknowns beside all others, with the tags' corners as their prior; where tags lie
// has been eliminated from it. A lens that was held would hold the cameras, too: a focal length that is one tenth of
// its sigma too long puts all of them, and through the glints the lamp, farther off than their pixels would allow. They
// move so little that one Gauss-Newton step does it.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

using Vector6 = Eigen::Matrix<double, 6, 1>;

struct GeometryPrior {
  std::vector<Eigen::Isometry3d> T_camera_board;  ///< one a view of the bench
  Eigen::Index of_view = 6;                       ///< numbers a view: 9 where its own lens moves
  Eigen::Index lens_parameters = 0;               ///< those that move
  Eigen::VectorXd moved;                          ///< how far the geometry's unknowns have been moved since
  Eigen::MatrixXd
      information;    ///< inverse covariance of the geometry's unknowns: of_view a view, 3, the lens' parameters
  double weight = 1;  ///< of the tags against the photos' pixels (burin/calib/photo/geometry_agreement.h)
};

/// How many parameters of a lens move: all of one that has focal lengths and center and at most so many, else none.
constexpr int kMostLensParameters = 12;
std::size_t free_lens_parameters(const Lens& lens);

/// What a unit of moved_lens() is in parameter i of a lens.
double lens_unit(const Lens& lens, std::size_t i);

/// The lens moved by fx and fy relative to themselves, cx / fx, cy / fy, and the rest as they are: the same numbers for
/// photos and for binned ones.
Lens moved_lens(const Lens& lens, const Eigen::VectorXd& by);

/// From a calibrated bench, by bundle_equations(): the four corners of as many tags as each view used, known to the
/// view's reprojection RMS; tags to board.tags.sigma_mm, their mean shift, turn and growth zero (they are the frame); a
/// lens that is free, unless the bench says that it was given. A view that says nothing of its tags has a pose that is
/// taken as exact. Views' own lenses move where the bench says that lenses differ, and where `own_lenses_move`: else
/// poses are as uncertain as they make them.
GeometryPrior geometry_prior(const Board& board, const Bench& bench, bool own_lenses_move = true);

/// The own lens moved by three numbers of the geometry's unknowns; `lens` is that of all views.
OwnLens moved_own_lens(const OwnLens& own, const Lens& lens, const Eigen::Vector3d& by);

/// (r, t) that takes `from` to `to`.
Vector6 pose_difference(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to);

/// The pose moved by (r, t).
Eigen::Isometry3d moved_pose(const Eigen::Isometry3d& T_camera_board, const Vector6& by);

}  // namespace burin
