// burin/calib/calibrate.h - a session into a measured bench: lens, poses, bow, tags, and the lamps' first estimate.
//
//   Session s = read_session("session.json");
//   Calibration c = calibrate(s, read_board(s.board));
//   write_calibration(c, "out");     // out/bench.json, out/camera.cameramodel, out/residuals.vnl
//
// One view after another, its exposures are merged (burin/capture/photo.h) and its tags found
// (burin/capture/tags/tag_detector.h); kept is a picture without color, binned if it is large. Photos that are blurred
// are left out, everything geometric is solved at once (burin/calib/geometry/board_solver.h); then the lamps are sought
// from paper and face (burin/calib/light/lamp.h), photos under a lamp that moved are left out, and what else is strange
// is named (burin/calib/light/photo_faults.h). What scratches say about lamp, alpha and depth is
// burin/calib/refine.h's. Frames: board (mm), camera, pixels (center of the top-left pixel is (0, 0)). docs/model.md 1
// and 9 and docs/file-formats.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/progress.h"
#include "burin/calib/camera_look.h"
#include "burin/calib/geometry/board_solver.h"
#include "burin/capture/session.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// What `burin calibrate` takes as known, and what it leaves out.
struct CalibrateOptions {
  std::string lens_model;    ///< "LENSMODEL_OPENCV8", ...; empty: the smallest that the data support
  std::optional<Lens> lens;  ///< a lens of one's own: a start for the solve, or fixed
  bool fix_lens = false;     ///< needs `lens`; then one view is enough
  bool check_with_mrcal = true;
  bool find_lamps = true;
  CurveFrom curve = CurveFrom::as_told;  ///< the camera's response; with none, sharpening is not looked for either
};

/// What `burin calibrate` found, with all that led to it.
struct Calibration {
  Bench bench;                             ///< views, lens, bow, tags, lamps; material as board.json believes it
  BoardSolution geometry;                  ///< residuals of every corner, covariances
  std::vector<std::string> photos;         ///< one a picture (SolvedCorner::picture): the photo that stands for it
  std::vector<RejectedTag> rejected;       ///< tags seen and not used,
  std::vector<std::string> rejected_view;  ///< and in which view
  std::vector<Finding> findings;           ///< what was left out and why
  std::vector<ViewTags> pictures;          ///< the tags found in each picture,
  BoardSolverOptions solver;               ///< and how they were solved: for burin/calib/hold_out.h
  double tool_width_um = 400;              ///< of the board, for bench.json's half_width_um
};

/// Throws Error, naming photo and remedy, for: a session without photos, photos whose sizes differ or that cannot be
/// read, no tags of the board's family in any photo (saying which family is in them), tags that board.json does not
/// list, a single view, too few usable views, a given lens for another picture size.
Calibration calibrate(const Session& session, const Board& board, const CalibrateOptions& options = {},
                      const Progress& progress = {});

/// Writes `folder`/bench.json, camera.cameramodel and residuals.vnl (one line a corner), making the folder.
void write_calibration(const Calibration& calibration, const std::filesystem::path& folder);

/// The table of residuals as vnlog text:
///   # view tag corner x_px y_px dx_px dy_px sigma_px used photo
/// (x_px, y_px): measured; (dx_px, dy_px): measured minus predicted; used: 0 where left out. Spaces in names become
/// %20.
std::string residual_table(const Calibration& calibration);

}  // namespace burin
