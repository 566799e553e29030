// burin/calib/light_probe.h - a room as it is: photos of a mirror ball that stands on the tagged board become
// surroundings in the board's frame. docs/model.md 11, docs/light.md. After Debevec, Rendering Synthetic Objects into
// Real Scenes (SIGGRAPH 1998).
//
// Lens and poses come from the tags (burin/calib/geometry/board_solver.h), the ball's place and size from its outline
// in all views, the light from merged brackets. What one view shows of the photographer, another one shows without.
// The ball's reflectance, color included, is what makes its light equal the light of the tags' white paper.
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

/// What is known before, and how the picture is made.
struct LightProbeOptions {
  const Bench* bench = nullptr;  ///< measured with this camera: its lens, tags and sensor are believed
  std::optional<Lens> lens;      ///< believed; without it or a bench, three views and more tell the lens
  /// The lens is about so: with three views and more it is solved for, with fewer it has to do. A bench's is, where
  /// nobody measured it (no .cameramodel).
  bool lens_is_a_guess = false;
  std::optional<double> ball_mm;               ///< the ball's diameter, where it was measured
  std::optional<Eigen::Vector3d> reflectance;  ///< of the ball, R G B; otherwise from the tags' paper
  double photographer_deg = 25;                ///< half of the cone about a camera that another view has to show
  int width = 0;                               ///< of the panorama; 0: as fine as the photos
};

/// A place of the camera.
struct ProbePlace {
  std::string view;
  int exposures = 0, tags = 0;
  double tags_rms_px = 0;
  double outline_found = 0;  ///< share of the ball's outline along which an edge lies
  double outline_rms_px = 0;
  double radius_px = 0;
};

/// The brightest light above the face: pixels about the brightest that are at least a fifth as bright.
struct BrightestLight {
  Eigen::Vector3d direction{0, 0, 1};  ///< unit, board: the middle of that light
  double irradiance_share = 0;         ///< of the face's light
};

/// Surroundings, and how well they are known. Shares are of the directions above the face, by solid angle.
struct LightProbe {
  Image radiance;          ///< latitude and longitude, R G B: PanoramaFrame::Kind::board. 1 / bench gain
  std::vector<Seen> seen;  ///< a pixel
  MirrorBall ball;
  double radius_sigma_mm = 0;
  double direction_sigma_deg = 0;  ///< of directions that are turned together, by the ball's place and size
  double agreement = 0;            ///< correlation of what the places show of the room; 0 with one place
  double pixel_deg = 0;            ///< what a photo's pixel spans in the ball's middle
  Eigen::Vector3d reflectance{0.6, 0.6, 0.6};
  bool reflectance_by_paper = false;
  double paper_spread = 0;  ///< by how much papers differ, standard deviation of the logarithm
  double seen_share = 0, photographer_share = 0, clipped_share = 0;
  BrightestLight brightest;
  std::vector<ProbePlace> places;
  std::vector<Finding> findings;
};

/// Throws Error, naming photos, for a lens of other photos, too few tags, no ball, one that is half hidden, not round
/// or too small in the photos, brackets without an exposure that holds the lights, and photos that cannot be read.
LightProbe light_probe(const Session& session, const Board& board, const LightProbeOptions& options = {},
                       const Progress& progress = {});

}  // namespace burin
