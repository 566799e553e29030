// burin/calib/calibrate.h - turns a session into a measured bench: lens, poses, bow, tags, and the lamps' first
// estimate.
//
//   Session s = read_session("session.json");
//   Calibration c = calibrate(s, read_board(s.board));
//   write_calibration(c, "out");     // out/bench.json, out/camera.cameramodel, out/residuals.vnl
//
// Each view's exposures are merged (burin/capture/photo.h) and its tags found (burin/capture/tags/tag_detector.h). Kept
// is a picture without color, binned if it is large. Blurred photos are left out. One solve then fits everything
// geometric (burin/calib/geometry/board_solver.h). After it, paper and face give the lamps (burin/calib/light/lamp.h).
// Photos under a lamp that moved are left out. Findings name other faults (burin/calib/light/photo_faults.h). Scratches
// give lamp, alpha and depth in burin/calib/refine.h. Frames: board (mm), camera, pixels (center of the top-left pixel
// is (0, 0)). docs/model.md 1 and 9, docs/file-formats.md.
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

/// Prior knowledge for `burin calibrate`, and skipped parts.
struct CalibrateOptions {
  std::string lens_model;    ///< "LENSMODEL_OPENCV8", ...; empty: the smallest supported by the data
  std::optional<Lens> lens;  ///< a known lens: an initial guess, or fixed
  bool fix_lens = false;     ///< needs `lens`; then one view is enough
  bool check_with_mrcal = true;
  bool find_lamps = true;
  CurveFrom curve = CurveFrom::as_told;  ///< camera response function; with `none`, sharpening is not sought either
};

/// Result of `burin calibrate`, with the data that led to it.
struct Calibration {
  Bench bench;                             ///< views, lens, bow, tags, lamps; material from board.json
  BoardSolution geometry;                  ///< residuals of every corner, covariances
  std::vector<std::string> photos;         ///< one per picture (SolvedCorner::picture): its representative photo
  std::vector<RejectedTag> rejected;       ///< tags seen and not used,
  std::vector<std::string> rejected_view;  ///< and their views
  std::vector<Finding> findings;           ///< parts left out, with reasons
  std::vector<ViewTags> pictures;          ///< the tags found in each picture,
  BoardSolverOptions solver;               ///< and the options of their solve: for burin/calib/hold_out.h
  double tool_width_um = 400;              ///< of the board, for bench.json's half_width_um
};

/// Throws Error, naming photo and remedy:
///   - for a session without photos, unreadable photos, or photos of different sizes;
///   - for photos without tags of the board's family (naming the family found), or with tags absent from board.json;
///   - for a single view, or too few usable views;
///   - for a given lens of another picture size.
Calibration calibrate(const Session& session, const Board& board, const CalibrateOptions& options = {},
                      const Progress& progress = {});

/// Writes `folder`/bench.json, camera.cameramodel and residuals.vnl (one line per corner), creating the folder.
void write_calibration(const Calibration& calibration, const std::filesystem::path& folder);

/// The table of residuals as vnlog text:
///   # view tag corner x_px y_px dx_px dy_px sigma_px used photo
/// (x_px, y_px) is the measurement, (dx_px, dy_px) measured minus predicted. `used` is 0 for corners left out. Spaces
/// in names become %20.
std::string residual_table(const Calibration& calibration);

}  // namespace burin
