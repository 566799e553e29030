// burin/calib/light_probe.h - measures an environment map: photos of a mirror ball on the tagged board become
// surroundings in the board's frame. docs/model.md 11, docs/light.md. After Debevec, Rendering Synthetic Objects into
// Real Scenes (SIGGRAPH 1998).
//
// Tags give lens and poses (burin/calib/geometry/board_solver.h). The ball's outline in all views gives its place and
// size. Merged brackets give the light. Another view replaces the directions in which one view shows the photographer.
// The ball's reflectance, color included, makes its light equal the light of the tags' white paper.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/image.h"
#include "burin/base/progress.h"
#include "burin/calib/light/probe/mirror_ball.h"
#include "burin/calib/light/probe/seen.h"
#include "burin/capture/session.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Prior knowledge, and the picture's resolution.
struct LightProbeOptions {
  const Bench* bench = nullptr;  ///< measured with this camera: its lens, tags and sensor are used
  std::optional<Lens> lens;      ///< fixed; without it or a bench, three or more views give the lens
  /// The lens is an initial guess: three or more views refine it, fewer views keep it. True of a bench's unmeasured
  /// lens (no .cameramodel).
  bool lens_is_a_guess = false;
  std::optional<double> ball_mm;               ///< the ball's diameter, if measured
  std::optional<Eigen::Vector3d> reflectance;  ///< of the ball, R G B; otherwise from the tags' paper
  double photographer_deg = 25;                ///< half angle of the cone about a camera, replaced by another view
  int width = 0;                               ///< of the panorama; 0: as fine as the photos
};

/// A viewpoint.
struct ProbePlace {
  std::string view;
  int exposures = 0, tags = 0;
  double tags_rms_px = 0;
  double outline_found = 0;  ///< share of the ball's outline along which an edge is found
  double outline_rms_px = 0;
  double radius_px = 0;
};

/// The brightest light above the face: pixels around the brightest with at least a fifth of its brightness.
struct BrightestLight {
  Eigen::Vector3d direction{0, 0, 1};  ///< unit, board: the center of this light
  double irradiance_share = 0;         ///< share of the face's irradiance
};

/// Environment map and its uncertainty. Shares are of the directions above the face, by solid angle.
struct LightProbe {
  Image radiance;          ///< latitude and longitude, R G B: PanoramaFrame::Kind::board. 1 / bench gain
  std::vector<Seen> seen;  ///< per pixel
  MirrorBall ball;
  double radius_sigma_mm = 0;
  double direction_sigma_deg = 0;  ///< common rotation error of all directions, from the ball's place and size
  double agreement = 0;            ///< correlation of the room between viewpoints; 0 with one viewpoint
  double pixel_deg = 0;            ///< angle of a photo's pixel at the ball's middle
  Eigen::Vector3d reflectance{0.6, 0.6, 0.6};
  bool reflectance_by_paper = false;
  double paper_spread = 0;  ///< scatter between papers, standard deviation of the logarithm
  double seen_share = 0, photographer_share = 0, clipped_share = 0;
  BrightestLight brightest;
  std::vector<ProbePlace> places;
  std::vector<Finding> findings;
};

/// Throws Error, naming photos, for unreadable photos, a lens of other photos, or too few tags. Also throws without a
/// ball, for a ball half hidden, not round or too small, and for brackets without an exposure of unclipped lights.
LightProbe light_probe(const Session& session, const Board& board, const LightProbeOptions& options = {},
                       const Progress& progress = {});

}  // namespace burin
