// burin/calib/photo/photo_equations.h - one photo against the model: its cost, and its normal equations by every
// parameter. Frame: board, mm. What refine.h's problem is made of; see there for the residual.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "burin/base/cell_grid.h"
#include "burin/calib/geometry/geometry_prior.h"
#include "burin/calib/light/light_samples.h"
#include "burin/calib/photo/model_data.h"
#include "burin/calib/photo/unknowns.h"
#include "burin/calib/photo/workspace_pool.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/groove_field.h"
#include "burin/scene/scratches.h"

namespace burin {

/// A photo at one resolution, and all of it that does not change while the fit runs.
struct PhotoData {
  /// Grid and camera. Its lamp and material are overwritten with the unknowns by each function below, so that the grid
  /// is never copied: one thread at a time may work on one photo.
  mutable ViewScene scene;
  CameraView camera;
  LampSize lamp_size;                         ///< as the bench has it; a point's is unknown::size2, sides2
  double size_unit_mm = 0;                    ///< of both
  std::shared_ptr<WorkspacePool> workspaces;  ///< shared with the other photos of a fit
  /// Surroundings that shine beside the lamp, as the bench has them, and what the board sends back of them before blur:
  /// taken at some state (light_around) and held until it is taken again. Null: ambient light is even.
  std::shared_ptr<const Light> surroundings;
  Image around;
  std::vector<float> weight;   ///< 1 / expected error of each pixel; 0 where it is not used
  std::vector<float> radius2;  ///< vignetting's r^2
  /// What the photo's own pixels would add to the value predicted on binned ones (see correct_binning); empty: nothing.
  std::vector<float> correction;
  std::vector<float> blur_slope;    ///< with a correction: the value's derivative by log_blur, from the same pixels
  double log_blur_at = 0;           ///< where both were taken; binned pixels are blurred by this much then
  std::vector<float> groove_shift;  ///< what grooves that differ add to the mean of the value (shift_by_grooves)
  GrooveProfile profile;            ///< its kind; its numbers are unknowns
  LightView photo;
  int bin = 1;
};

class CarvedStates;  // burin/calib/photo/carved_states.h

/// Prepares a photo. `margin_px`: distance (in binned pixels) that used pixels keep from tags and the board's edge.
PhotoData make_photo_data(const LightView& binned_view, int bin, const Board& board, const Bench& bench,
                          double margin_px);

/// Sets `photo.around` at x, where the photo has surroundings. Of its derivatives only that by the scale of the
/// surroundings (unknown::ambient) is told to a fit: grooves show a lamp far more sharply.
void light_around(const Unknowns& x, const Carved& carved, PhotoData& photo);

/// Lets a photo of the whole show a sample alone: there is no footprint outside its surroundings, and no pixel outside
/// its squares counts.
void show_only(const BoardSample& sample, PhotoData& photo);

/// What one unit of ambient light adds to pixel i before blur.
inline double ambient_unit(const ModelData& model, const PhotoData& photo, std::size_t i) {
  return photo.surroundings == nullptr ? model.f0 : static_cast<double>(photo.around.data[i]);
}

/// The photo as predicted (linear value / exposure factor).
Image predict(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved);

/// The same with its derivatives by the logarithms of alpha and depth, from differences: for weights.
struct GrooveSlopes {
  Image value, by_log_alpha, by_log_depth;
};
GrooveSlopes predict_with_slopes(const ModelData& model, const PhotoData& photo, const Unknowns& x,
                                 const Carved& carved);

/// dE/d(log alpha) and dE/d(log depth) of each scratch, and by its place.
struct GrooveGradients {
  std::vector<double> by_log_alpha, by_log_depth;
  std::vector<double> by_x_mm, by_y_mm;  ///< of the groove as a whole
};
/// Those of several E, given dE/d(value) of each, one number a pixel: predict() backwards. `carved` must have depths
/// and roughnesses of its own (carved_pieces).
std::vector<GrooveGradients> groove_gradients(const PhotoData& photo, const Unknowns& x, const Carved& carved,
                                              std::span<const Image> dE_dvalue);

/// Sets `photo.groove_shift` at x: a pixel's value is not linear in a groove's roughness or depth, so grooves that
/// differ by model.alpha_jitter and depth_jitter send other light on average than equal ones. Their logarithms are
/// taken as normal, by Gauss and Hermite's rule of three points.
void shift_by_grooves(const ModelData& model, const Unknowns& x, const Carved& carved, PhotoData& photo);

/// Sets `photo.correction` at x: the prediction on the photo's own pixels (`whole`, the view that was binned),
/// averaged, less the one on binned pixels. What is not linear within a binned pixel (grooves that cover a pixel more
/// than once, the blur's shape, directions) is so predicted as on fine pixels, at the price of one rendering. The
/// blur, being finer than a binned pixel, is taken from the fine ones altogether: its effect (blur_slope) is linear
/// about this state. Pixels are at most `max_pixels` large images; larger ones are binned by the smallest divisor of
/// photo.bin that fits, and where none does, nothing is corrected.
void correct_binning(const ModelData& model, const LightView& whole, const Board& board, const Bench& bench,
                     const Unknowns& x, const Carved& carved, std::size_t max_pixels, PhotoData& photo);

/// What the photo shows at x before vignetting and corrections, lamp and ambient light blurred: what takes rendering.
Image seen_light(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved);

/// What a light that nobody named (stray_light.h) adds to it at x; nothing where there is none.
Image stray_seen(const PhotoData& photo, const Unknowns& x, const Carved& carved);

/// The photo's value at pixel i where `light` is seen, darkened towards the corners, with all corrections; the factor
/// that light comes with; and the value's derivative by the share of glare.
struct PixelSeen {
  double value = 0, factor = 1, by_glare = 0;
};
PixelSeen pixel_seen(const PhotoData& photo, const Unknowns& x, std::size_t i, const Image& light);

/// The same with its derivatives by all unknowns that it depends on otherwise than by a factor.
struct PhotoSlopes {
  Unknowns at = Unknowns::Zero();
  FreeUnknowns free{};
  Image light;                 ///< seen_light() at `at`
  std::vector<int> index;      ///< of the unknown that each column is by
  std::vector<Image> columns;  ///< before vignetting
};
/// `carved` is in the metal at x, `grooves` beside it.
PhotoSlopes photo_slopes(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved,
                         const CarvedStates& grooves, const FreeUnknowns& free);

/// Whether slopes that were taken elsewhere serve at x, where the photo shows `light`: they foretold what has changed
/// since, in expected errors, to a tenth, or it is less than one expected error in all pixels together.
bool slopes_hold(const ModelData& model, const PhotoData& photo, const PhotoSlopes& slopes, const Unknowns& x,
                 const Image& light);

/// Cost (half the sum of the robust loss), and its Gauss-Newton model by all unknowns (rows of held ones are 0).
struct PhotoEquations {
  double cost = 0;
  Eigen::MatrixXd JtJ;  ///< count x count, weighted
  Eigen::VectorXd Jtr;
  /// Scores summed over squares of the board, one column a square: count x tiles.
  Eigen::MatrixXd tile_scores;
  Eigen::MatrixXd noise_JtJ;      ///< with tile_scores: weighted by the photo's noise alone, without loss
  Eigen::MatrixXd curvature_JtJ;  ///< with tile_scores: weighted by the loss' curvature, where it is not negative
};

double photo_cost(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved);
/// The same where `light` is seen.
double photo_cost(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Image& light);

/// `tiles` ask for tile_scores, noise_JtJ and curvature_JtJ.
PhotoEquations photo_equations(const ModelData& model, const PhotoData& photo, const Unknowns& x,
                               const CarvedStates& grooves, const FreeUnknowns& free, const CellGrid* tiles = nullptr);
/// The same where `light` is seen, with slopes that hold there.
PhotoEquations photo_equations(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Image& light,
                               const PhotoSlopes& slopes, const CellGrid* tiles = nullptr);

}  // namespace burin
