// burin/optimize/design_result.h - a finished design: scratches, predicted pictures, and a record of the run.
//
// Frame: board, mm. design/design_output.h writes it to files.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/image.h"
#include "burin/optimize/design/tolerance.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/loss/loss.h"
#include "burin/optimize/toolpath/carving_limits.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Quality and white balance of a view in color.
struct DesignedColor {
  ColorQuality quality;  ///< of `shown`
  /// `shown` is (best_exposure * white_gain * radiance)^(1 / 2.2), channel by channel.
  std::array<double, 3> white_gain{1, 1, 1};
};

/// One view of the result. Pictures are gamma-encoded, clipped at white, and have one channel or three (R, G, B).
/// Figures of a picture in color cover all three channels.
struct DesignedView {
  std::string view, light;
  double rotation_deg = 0;  ///< counter-clockwise, with "viewer" resolved
  Image target;
  Image start, shown;            ///< at exposure_start and best_exposure, or at the view's fixed exposure
  Image achievable;              ///< the target within the plain face's contrast
  double exposure = 0;           ///< as optimized: picture = (exposure * radiance)^(1 / 2.2)
  double best_exposure = 0;      ///< the scalar with which `shown` would be closest to the target
  double psnr_db = 0, ssim = 0;  ///< of `shown`
  double start_psnr_db = 0, start_ssim = 0;
  double eye_psnr_db = 0;         ///< the same at DesignResult::eye_px pixels: the figure of merit of the design
  double achievable_psnr_db = 0;  ///< of `achievable`: the cost of the face's own light
  LossValue loss;                 ///< at `exposure`
  std::vector<double> ghost;      ///< crosstalk: correlation of `shown` with each view's target (its own included)
  std::vector<double> target_correlation;  ///< of this view's target with each view's target (of their luminance)
  std::optional<DesignedColor> color;      ///< if the picture is in color
};

/// Loss and time of one iteration.
struct DesignIteration {
  double loss = 0;
  std::vector<double> view_loss;
  double seconds = 0;  ///< since the first iteration began
  /// The loss is of grooves as they will be cut. Otherwise it uses the light after crossings at the last check.
  bool as_carved = true;
};

/// Pictures of one iteration for the contact sheet: one per view, small (for_contact_sheet()).
struct ContactFrame {
  int iteration = 0;
  std::vector<Image> pictures;
};

/// Quality and carving time of a part of the scratches.
struct CarvingPoint {
  std::size_t scratches = 0;
  double hours = 0;
  std::vector<double> psnr_db, ssim;  ///< one per view
};

/// A design: its scratches, predicted quality and diagnostics.
struct DesignResult {
  /// After pruning. Width, depth or alpha columns exist if those were optimized. The carved ones are last and marked.
  Scratches scratches;
  std::vector<DesignedView> views;
  std::vector<ViewTolerance> tolerance;  ///< one per view, if requested
  std::vector<CarvingPoint> curve;       ///< from all scratches down, if requested
  std::vector<DesignIteration> history;  ///< the loss is the value before each iteration's step
  /// Resolution of an eye at a viewpoint, in pixels along the carve area's longer side; one more if the design fitted
  /// exactly these.
  int eye_px = 0;
  double eye_from_m = 0;  ///< distance of these eyes; a farther eye resolves fewer
  std::vector<ContactFrame> frames;
  std::vector<Finding> findings;                             ///< on bench, pictures and the run
  double final_loss = 0;                                     ///< of the returned scratches, at the optimized exposures
  double loss_before_drop = 0;                               ///< at the time of pruning; 0 without pruning
  std::size_t started_with = 0, dropped = 0, relocated = 0;  ///< of the new ones
  std::size_t carved = 0;                                    ///< existing grooves among the scratches
  /// Scratches removed for a violated limit, not counted in `dropped`.
  std::array<std::size_t, kRules> dropped_by_rule{};
  std::size_t pairs = 0;         ///< (pixel, scratch) pairs of the last iteration, all views
  double iteration_seconds = 0;  ///< time of the iterations
  double total_seconds = 0;
  bool stopped_early = false;                       ///< by the time limit
  std::optional<double> width_um, depth_um, alpha;  ///< if optimized
};

}  // namespace burin
