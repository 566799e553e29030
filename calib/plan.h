// burin/calib/plan.h - which photos to take of a board, before the first one: places of the camera and of the lamp,
// chosen one after the other by what they would tell.
//
// Each shot is the one, of all candidates (burin/calib/verdict/candidate_photo.h), after which
//   sum over parameters of log(sigma^2 + goal^2)
// is smallest: halving an uncertainty is worth the same for every parameter, until it reaches its goal. Sigmas are
// those of the normal equations of all shots so far and what is believed before; the depth of the grooves counts as
// unknown until half vectors lie on both sides of the cut-off (docs/model.md 2.4). The nominal bench has only to be
// about right; above all the depth is a guess before the first photos, so a plan holds for the depth believed, for one
// 30 % less and for one 30 % more: of the three sums the worst counts. Frame: board, mm.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/verdict/camera_place.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/verdict.h"

namespace burin {

/// A place that is photographed whatever it tells: an eye that a board is designed for.
struct DesignedPlace {
  std::string view;  ///< its name
  Eigen::Vector3d center_mm{0, 0, 0};
  std::string light;  ///< id of its lamp
};

/// How many photos a plan may ask for, and what it assumes of them.
struct PlanOptions {
  int shots = 8;                             ///< beside the designed places
  std::vector<DesignedPlace> designed = {};  ///< these come first
  /// What is sharp with the one focus that all photos keep: no shot but the designed places lies outside of it.
  /// Nothing: anywhere.
  std::optional<FocusRange> focus = {};
  /// How far the depth of the grooves may be from the nominal bench's: one sigma, and every shot is judged where it
  /// tells least, at the believed depth, at one so much less and at one so much more.
  double depth_share = 0.3;
  int lamp_places = 1;            ///< at how many places lamps may stand in all; above the bench's, they are proposed
  bool fix_lens = false;          ///< the lens is known
  double corner_sigma_px = 0.02;  ///< of a tag's corner, per axis
  LightCandidateOptions light;
  /// How many times larger the light's sigmas are than those of independent errors: what the model misses is alike in
  /// neighboring pixels and photos. A cautious guess: docs/calibration.md.
  double inflation = 4;
};

/// Something that the photos are to determine.
struct PlanParameter {
  std::string name;  ///< as in bench.json's verdict
  Unit unit = Unit::none;
  double goal = 0;    ///< a sigma that is good enough
  double before = 0;  ///< what is believed to be known without a photo
};

/// One place to photograph from, under one lamp.
struct PlannedShot {
  std::string view;  ///< of a designed place; else empty
  CameraPlace camera;
  std::size_t light = 0;  ///< index into Plan::bench.lights
  /// Exposures of the bracket in stops, relative to the one that shows the tags' white paper at 60 % of white: 0 for
  /// paper, then shorter ones until the glints are held.
  std::vector<double> stops;
  double paper_radiance = 0;  ///< predicted, in units of gain = 1: a measured bench's exposure follows from it
  std::vector<double> sigma;  ///< of each Plan::parameters after this shot and those before; the worst of all depths
};

/// What all shots together would tell of grooves of one depth.
struct PlanAtDepth {
  double depth_um = 0;
  bool straddles = false;     ///< whether half vectors straddle the cut-off
  std::vector<double> sigma;  ///< of each Plan::parameters
};

/// Photos to take, and what they would tell.
struct Plan {
  Bench bench;  ///< the nominal bench that was planned for; lamps that were proposed are added
  std::vector<PlanParameter> parameters;
  std::vector<PlannedShot> shots;
  bool straddles = false;             ///< whether half vectors straddle the cut-off, at every depth
  std::vector<PlanAtDepth> at_depth;  ///< the least depth first
  /// Designed places from which this lens sees no tag large enough: not among the shots.
  std::vector<std::string> unseen;
  /// How many times less well cameras are known because lenses differ from photo to photo, as the bench says
  /// (Bench::lens_scatter): as many tags or photos as its square would make up for it. 1: they do not.
  double own_lens_widening = 1;
};

/// Plans for `nominal`: its lens, its lamps (each shot is taken under one of them; several are places that the lamp can
/// be put at), its material. The sun and surroundings are left out: places that are designed for them are photographed
/// under the first lamp. Throws Error for a board without tags, a bench without lamps, no scratches, fewer than one
/// shot, and where there is nothing to plan: no place within the focus sees the whole board, no designed place a tag.
Plan plan_shots(const Board& board, const Bench& nominal, const Sent& sent, const PlanOptions& options = {},
                const Progress& progress = {});

/// Strokes in all directions over the carve area, for planning before there is a design.
Sent test_strokes(const Board& board);

}  // namespace burin
