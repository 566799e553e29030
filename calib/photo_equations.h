// calib/photo_equations.h - one photo against the model: its cost, and its normal equations by every parameter.
// Frame: board, mm. What refine.h's problem is made of; see there for the residual.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "calib/light_samples.h"
#include "render/bench.h"
#include "render/board.h"
#include "render/scratches.h"
#include "render/view_renderer.h"

namespace burin {

/// The unknowns of a photo under one lamp, as one vector. Groups are what a fit frees or holds together.
namespace unknown {
enum Index : int {
  log_alpha = 0,
  log_depth = 1,
  log_base_alpha = 2,
  depth_gradient = 3,  // gx, gy: see Refinement
  machine = 5,  // a00 a01 a10 a11 tx ty: carved = center + A (designed - center) + t, mm, about the carve area's center
  ambient = 11,        // radiance, mean of the channels
  vignette = 12,       // v1 v2 v3
  log_blur = 15,       // of the Gaussian's sigma in pixels of the photo as taken
  lamp_position = 16,  // mm
  log_intensity = 19,
  spot = 20,  // aim x, aim y (mm), exponent; exponent 0 (held): a bare lamp
  pose = 23,  // rotation vector on the left of T_camera_board, about the board's center; then translation, mm
  count = 29
};
}  // namespace unknown

using Unknowns = Eigen::Matrix<double, unknown::count, 1>;
using FreeUnknowns = std::array<bool, unknown::count>;

/// A photo at one resolution, and all of it that does not change while the fit runs.
struct PhotoData {
  LightView photo;
  int bin = 1;
  /// Grid and camera. Its lamp and material are overwritten with the unknowns by each function below, so that the grid
  /// is never copied: one thread at a time may work on one photo.
  mutable ViewScene scene;
  CameraView camera;
  std::vector<float> weight;   ///< 1 / expected error of each pixel; 0 where it is not used
  std::vector<float> radius2;  ///< vignetting's r^2
};

/// What all photos share.
struct ModelData {
  const Board* board = nullptr;
  const Scratches* designed = nullptr;
  bool last_carved_rules = false;   ///< overlap: see calib/overlap.h
  Eigen::Vector2d center_mm{0, 0};  ///< of the carve area
  double f0 = 0.92;                 ///< mean of the channels
  double cauchy = 3;                ///< scale of the robust loss, in expected errors
};

/// Prepares a photo. `margin_px`: distance (in binned pixels) that used pixels keep from tags and the board's edge.
PhotoData make_photo_data(const LightView& binned_view, int bin, const Board& board, const Bench& bench,
                          double margin_px);

/// The scratches as carved under these unknowns, cut where later ones rule if the model says so.
Scratches carved_scratches(const ModelData& model, const Unknowns& x);

/// The photo as predicted (linear value / exposure factor).
Image predict(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Scratches& carved);

/// Cost (half the sum of the robust loss), and its Gauss-Newton model by all unknowns (rows of held ones are 0).
struct PhotoEquations {
  double cost = 0;
  Eigen::MatrixXd JtJ;  ///< count x count, weighted
  Eigen::VectorXd Jtr;
  /// Scores summed over squares of the board, tile_columns x tile_rows, one column a square: count x tiles.
  Eigen::MatrixXd tile_scores;
};

double photo_cost(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Scratches& carved);

/// `tile_mm` > 0 asks for tile_scores.
PhotoEquations photo_equations(const ModelData& model, const PhotoData& photo, const Unknowns& x,
                               const Scratches& carved, const FreeUnknowns& free, double tile_mm = 0);

}  // namespace burin
