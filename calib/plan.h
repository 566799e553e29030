// burin/calib/plan.h - plans the photos of a board before the first one. It chooses viewpoints and lamp positions one
// after the other, by their added information.
//
// Each shot is the candidate (burin/calib/verdict/candidate_photo.h) after which
//   sum over parameters of log(sigma^2 + goal^2)
// is smallest. Halving an uncertainty is worth the same for every parameter, until it reaches its goal. Sigmas come
// from the normal equations of all shots so far and of the priors. Groove depth counts as unknown until half vectors
// are on both sides of the cut-off (docs/model.md 2.4). The nominal bench has only to be about right. Above all the
// depth is a guess before the first photos. A plan therefore covers the prior depth, 30 % less and 30 % more; the worst
// of the three sums counts. Frame: board, mm.
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

/// A viewpoint that is photographed in any case: an eye that a board is designed for.
struct DesignedPlace {
  std::string view;  ///< its name
  Eigen::Vector3d center_mm{0, 0, 0};
  std::string light;  ///< id of its lamp
};

/// Number of photos in a plan, and assumptions about them.
struct PlanOptions {
  int shots = 8;                             ///< besides the designed places
  std::vector<DesignedPlace> designed = {};  ///< these come first
  /// Range that is sharp with the one focus of all photos. No shot except the designed places is outside of it. Empty:
  /// anywhere.
  std::optional<FocusRange> focus = {};
  /// Relative sigma of the nominal bench's groove depth. Every shot is judged at the least informative of three depths:
  /// the prior's, one sigma less and one sigma more.
  double depth_share = 0.3;
  int lamp_places = 1;            ///< number of lamp positions in all; positions beyond the bench's are proposed
  bool fix_lens = false;          ///< the lens is known
  double corner_sigma_px = 0.02;  ///< of a tag's corner, per axis
  LightCandidateOptions light;
  /// Factor of the light's sigmas over those of independent errors: unmodeled effects are alike in neighboring pixels
  /// and photos. A cautious guess: docs/calibration.md.
  double inflation = 4;
};

/// A quantity for the photos to determine.
struct PlanParameter {
  std::string name;  ///< as in bench.json's verdict
  Unit unit = Unit::none;
  double goal = 0;    ///< a sigma that is good enough
  double before = 0;  ///< sigma of the prior, without a photo
};

/// One viewpoint under one lamp.
struct PlannedShot {
  std::string view;  ///< of a designed place; else empty
  CameraPlace camera;
  std::size_t light = 0;  ///< index into Plan::bench.lights
  /// Exposures of the bracket in stops, relative to the one with the tags' white paper at 60 % of white: 0 for paper,
  /// then shorter ones until the glints are unclipped.
  std::vector<double> stops;
  double paper_radiance = 0;  ///< predicted, in units of gain = 1: a measured bench's exposure follows from it
  std::vector<double> sigma;  ///< of each Plan::parameters after this and all earlier shots; the worst of all depths
};

/// Information of all shots together about grooves of one depth.
struct PlanAtDepth {
  double depth_um = 0;
  bool straddles = false;     ///< half vectors are on both sides of the cut-off
  std::vector<double> sigma;  ///< of each Plan::parameters
};

/// Photos to take, and their expected information.
struct Plan {
  Bench bench;  ///< the nominal bench of the plan, with proposed lamps added
  std::vector<PlanParameter> parameters;
  std::vector<PlannedShot> shots;
  bool straddles = false;             ///< half vectors are on both sides of the cut-off, at every depth
  std::vector<PlanAtDepth> at_depth;  ///< the least depth first
  /// Designed places from which this lens sees no tag large enough: not among the shots.
  std::vector<std::string> unseen;
  /// Factor by which cameras are known less well because lenses differ between photos (Bench::lens_scatter). Its square
  /// times the tags or photos makes up for it. 1: they do not differ.
  double own_lens_widening = 1;
};

/// Plans for `nominal`: its lens, its material and its lamps. Each shot is taken under one lamp; several lamps are
/// places for one lamp. Sun and surroundings are left out: places designed for them are photographed under the first
/// lamp. Throws Error for a board without tags, a bench without lamps, no scratches, and fewer than one shot. Also
/// throws if nothing can be planned: no place within the focus sees the whole board, and no designed place sees a tag.
Plan plan_shots(const Board& board, const Bench& nominal, const Sent& sent, const PlanOptions& options = {},
                const Progress& progress = {});

/// Strokes in all directions over the carve area, for planning without a design.
Sent test_strokes(const Board& board);

}  // namespace burin
