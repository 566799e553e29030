// burin/calib/photo/photo_equations.h - compares one photo with the model: its cost, and its normal equations by every
// parameter. Frame: board, mm. They make up refine.h's problem, which defines the residual.
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

/// A photo at one resolution, with all of its constant data during the fit.
struct PhotoData {
  /// Grid and camera. Each function below overwrites its lamp and material with the unknowns, so the grid is never
  /// copied. One thread at a time may work on one photo.
  mutable ViewScene scene;
  CameraView camera;
  LampSize lamp_size;                         ///< from the bench; a point's size is in unknown::size2, sides2
  double size_unit_mm = 0;                    ///< of both
  std::shared_ptr<WorkspacePool> workspaces;  ///< shared with the other photos of a fit
  /// The bench's surroundings, in addition to the lamp. `around` is the board's reflection of them before blur. It is
  /// computed at some state (light_around) and held until the next call. Null: ambient light is uniform.
  std::shared_ptr<const Light> surroundings;
  Image around;
  std::vector<float> weight;   ///< 1 / expected error of each pixel; 0 for unused pixels
  std::vector<float> radius2;  ///< vignetting's r^2
  /// Difference of the photo's own pixels from the prediction on binned ones (see correct_binning); empty: 0.
  std::vector<float> correction;
  std::vector<float> blur_slope;    ///< with a correction: the value's derivative by log_blur, from the same pixels
  double log_blur_at = 0;           ///< log blur of both; binned pixels then have this blur
  std::vector<float> groove_shift;  ///< change of the mean value by groove-to-groove variation (shift_by_grooves)
  GrooveProfile profile;            ///< its kind; its numbers are unknowns
  LightView photo;
  int bin = 1;
};

class CarvedStates;  // burin/calib/photo/carved_states.h

/// Prepares a photo. `margin_px`: distance (in binned pixels) of used pixels from tags and the board's edge.
PhotoData make_photo_data(const LightView& binned_view, int bin, const Board& board, const Bench& bench,
                          double margin_px);

/// Sets `photo.around` at x, if the photo has surroundings. A fit uses only its derivative by the scale of the
/// surroundings (unknown::ambient): grooves show a lamp far more sharply.
void light_around(const Unknowns& x, const Carved& carved, PhotoData& photo);

/// Restricts a photo of the whole board to a sample: no footprint outside its surroundings, and no weight outside its
/// squares.
void show_only(const BoardSample& sample, PhotoData& photo);

/// Value of pixel i per unit of ambient light, before blur.
inline double ambient_unit(const ModelData& model, const PhotoData& photo, std::size_t i) {
  return photo.surroundings == nullptr ? model.f0 : static_cast<double>(photo.around.data[i]);
}

/// The predicted photo (linear value / exposure factor).
Image predict(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved);

/// The predicted photo with its derivatives by the logarithms of alpha and depth, by finite differences: for weights.
struct GrooveSlopes {
  Image value, by_log_alpha, by_log_depth;
};
GrooveSlopes predict_with_slopes(const ModelData& model, const PhotoData& photo, const Unknowns& x,
                                 const Carved& carved);

/// dE/d(log alpha) and dE/d(log depth) of each scratch, and by its position.
struct GrooveGradients {
  std::vector<double> by_log_alpha, by_log_depth;
  std::vector<double> by_x_mm, by_y_mm;  ///< of the groove as a whole
};
/// Gradients of several E from dE/d(value) of each, one number per pixel: the backward pass (adjoint) of predict().
/// `carved` must have depths and roughnesses of its own (carved_pieces).
std::vector<GrooveGradients> groove_gradients(const PhotoData& photo, const Unknowns& x, const Carved& carved,
                                              std::span<const Image> dE_dvalue);

/// Sets `photo.groove_shift` at x. A pixel's value is not linear in a groove's roughness or depth. Grooves that vary by
/// model.alpha_jitter and depth_jitter therefore change the mean light. Their logarithms are normal, integrated by
/// Gauss-Hermite quadrature with three points.
void shift_by_grooves(const ModelData& model, const Unknowns& x, const Carved& carved, PhotoData& photo);

/// Sets `photo.correction` at x: the prediction on the photo's own pixels (`whole`, the view before binning), averaged,
/// less the one on binned pixels. Nonlinear effects within a binned pixel thereby get the accuracy of fine pixels for
/// one rendering: overlapping grooves, the blur's shape, directions. The blur, finer than a binned pixel, comes from
/// the fine ones entirely: its effect (blur_slope) is linear about this state. `max_pixels` limits the images. Larger
/// ones are binned by the smallest fitting divisor of photo.bin; without one, nothing is corrected.
void correct_binning(const ModelData& model, const LightView& whole, const Board& board, const Bench& bench,
                     const Unknowns& x, const Carved& carved, std::size_t max_pixels, PhotoData& photo);

/// The photo at x before vignetting and corrections, lamp and ambient light blurred: the rendered part.
Image seen_light(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved);

/// Light of an unmodeled lamp (stray_light.h) in it at x; empty without one.
Image stray_seen(const PhotoData& photo, const Unknowns& x, const Carved& carved);

/// The photo's value at pixel i for the light image `light`, with vignetting and all corrections; the factor on this
/// light; and the value's derivative by the share of glare.
struct PixelSeen {
  double value = 0, factor = 1, by_glare = 0;
};
PixelSeen pixel_seen(const PhotoData& photo, const Unknowns& x, std::size_t i, const Image& light);

/// seen_light() with its derivatives by all unknowns other than factors.
struct PhotoSlopes {
  Unknowns at = Unknowns::Zero();
  FreeUnknowns free{};
  Image light;                 ///< seen_light() at `at`
  std::vector<int> index;      ///< unknown of each column
  std::vector<Image> columns;  ///< before vignetting
};
/// `carved` holds the grooves at x, `grooves` further states for differences.
PhotoSlopes photo_slopes(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved,
                         const CarvedStates& grooves, const FreeUnknowns& free);

/// True if derivatives taken at another state serve at x, whose light image is `light`. They must predict the change
/// since then, in expected errors, to a tenth. Or the change is less than one expected error in all pixels together.
bool slopes_hold(const ModelData& model, const PhotoData& photo, const PhotoSlopes& slopes, const Unknowns& x,
                 const Image& light);

/// Cost (half the sum of the robust loss), and its Gauss-Newton model by all unknowns (rows of held ones are 0).
struct PhotoEquations {
  double cost = 0;
  Eigen::MatrixXd JtJ;  ///< count x count, weighted
  Eigen::VectorXd Jtr;
  /// Scores summed over squares of the board, one column per square: count x tiles.
  Eigen::MatrixXd tile_scores;
  Eigen::MatrixXd noise_JtJ;      ///< with tile_scores: weighted by the photo's noise alone, without loss
  Eigen::MatrixXd curvature_JtJ;  ///< with tile_scores: weighted by the loss' curvature, clamped at 0
};

double photo_cost(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved);
/// Cost for the light image `light`.
double photo_cost(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Image& light);

/// If given, `tiles` requests tile_scores, noise_JtJ and curvature_JtJ.
PhotoEquations photo_equations(const ModelData& model, const PhotoData& photo, const Unknowns& x,
                               const CarvedStates& grooves, const FreeUnknowns& free, const CellGrid* tiles = nullptr);
/// Equations for the light image `light`, with derivatives valid there.
PhotoEquations photo_equations(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Image& light,
                               const PhotoSlopes& slopes, const CellGrid* tiles = nullptr);

}  // namespace burin
