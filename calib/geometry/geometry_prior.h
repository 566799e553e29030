// burin/calib/geometry/geometry_prior.h - prior of cameras, bow and lens from the tags, for fits with free geometry.
// Frame: board, mm. Poses move as the renderer's: T' = exp(r) T_camera_board, then its translation + t; (r, t) in
// radians and mm, camera axes. One vector holds the geometry's unknowns: (r, t) of each view, followed by its own lens
// if lenses differ (OwnLens: shift over the focal length, logarithm of focal_ratio); bow_mm (3); and the lens as in
// moved_lens().
//
// Tags give each pose to some hundredths of a pixel and the bow to a micrometer. These errors matter: a micrometer of
// bow moves the estimate of a lamp from its glints by half a millimeter, and scratches determine lamp and machine
// better. So cameras, bow and lens are unknowns of the fit, with the tags' corners as their prior. The tags' positions
// are eliminated from it. A fixed lens would also fix the cameras: a focal length too long by one tenth of its sigma
// moves all of them, and through the glints the lamp, further than their pixels allow. The moves are small, so one
// Gauss-Newton step suffices.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

using Vector6 = Eigen::Matrix<double, 6, 1>;

struct GeometryPrior {
  std::vector<Eigen::Isometry3d> T_camera_board;  ///< one per view of the bench
  Eigen::Index of_view = 6;                       ///< unknowns per view: 9 if its own lens moves
  Eigen::Index lens_parameters = 0;               ///< number of free ones
  Eigen::VectorXd moved;                          ///< moves of the geometry's unknowns since then
  Eigen::MatrixXd
      /// Inverse covariance of the geometry's unknowns: of_view per view, 3, the lens' parameters.
      information;
  double weight = 1;  ///< of the tags against the photos' pixels (burin/calib/photo/geometry_agreement.h)
};

/// Limit of a lens' free parameters: all of a lens with focal lengths and center and at most this number, else none.
constexpr int kMostLensParameters = 12;
std::size_t free_lens_parameters(const Lens& lens);

/// Unit of moved_lens() for parameter i of a lens.
double lens_unit(const Lens& lens, std::size_t i);

/// The lens after moves of fx and fy relative to themselves, of cx / fx and cy / fy, and of the other parameters in
/// their own units. The same numbers suit full and binned photos.
Lens moved_lens(const Lens& lens, const Eigen::VectorXd& by);

/// Prior of a calibrated bench, by bundle_equations(). Each view has the four corners of as many tags as it used, with
/// the view's reprojection RMS as sigma. Tags have board.tags.sigma_mm; their mean shift, turn and growth are zero,
/// because they define the frame. The lens is free unless the bench marks it as given. A view without tag data has an
/// exact pose. Views' own lenses move if the bench has a lens scatter and `own_lenses_move` is set; otherwise they add
/// to the poses' uncertainty.
GeometryPrior geometry_prior(const Board& board, const Bench& bench, bool own_lenses_move = true);

/// The own lens after a move by three of the geometry's unknowns; `lens` is the common lens.
OwnLens moved_own_lens(const OwnLens& own, const Lens& lens, const Eigen::Vector3d& by);

/// (r, t) that moves `from` to `to`.
Vector6 pose_difference(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to);

/// The pose after a move by (r, t).
Eigen::Isometry3d moved_pose(const Eigen::Isometry3d& T_camera_board, const Vector6& by);

}  // namespace burin
