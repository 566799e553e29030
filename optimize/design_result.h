// burin/optimize/design_result.h - a finished design: its scratches, what each view will show, how it went. Frame:
// board, mm. design/design_output.h writes it into files.
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

/// Of a view in color.
struct DesignedColor {
  ColorQuality quality;  ///< of `shown`
  /// `shown` is (best_exposure * white_gain * radiance)^(1 / 2.2), channel by channel.
  std::array<double, 3> white_gain{1, 1, 1};
};

/// One view of the result. Pictures are gamma-encoded, clipped at white, of one channel or three (R, G, B); figures of
/// those in color are taken over all three.
struct DesignedView {
  std::string view, light;
  double rotation_deg = 0;  ///< as laid, with "viewer" resolved
  Image target;
  Image start, shown;            ///< at exposure_start and best_exposure
  Image achievable;              ///< the target within the contrast that the plain face leaves
  double exposure = 0;           ///< as optimized: picture = (exposure * radiance)^(1 / 2.2)
  double best_exposure = 0;      ///< the one scalar with which `shown` comes closest to the target
  double psnr_db = 0, ssim = 0;  ///< of `shown`
  double start_psnr_db = 0, start_ssim = 0;
  double eye_psnr_db = 0;                  ///< the same of DesignResult::eye_px pixels: the design's one figure
  double achievable_psnr_db = 0;           ///< of `achievable`: what the face's own light costs
  LossValue loss;                          ///< at `exposure`
  std::vector<double> ghost;               ///< correlation of `shown` with each view's target (its own included)
  std::vector<double> target_correlation;  ///< of this view's target with each view's target (of their luminance)
  std::optional<DesignedColor> color;      ///< of a picture in color
};

struct DesignIteration {
  double loss = 0;
  std::vector<double> view_loss;
  double seconds = 0;  ///< since the first iteration began
  bool as_carved =
      true;  ///< of grooves as they will be cut; else with what crossings left when they were looked at last
};

/// Frames of the contact sheet: one picture a view, small (for_contact_sheet()).
struct ContactFrame {
  int iteration = 0;
  std::vector<Image> pictures;
};

/// What a part of the scratches shows, and how long it takes to carve.
struct CarvingPoint {
  std::size_t scratches = 0;
  double hours = 0;
  std::vector<double> psnr_db, ssim;  ///< a view
};

struct DesignResult {
  Scratches scratches;  ///< after dropping; with width, depth or alpha columns if those were optimized, and with the
                        ///< carved ones last, marked, if there are any
  std::vector<DesignedView> views;
  std::vector<ViewTolerance> tolerance;  ///< one a view, if it was asked for
  std::vector<CarvingPoint> curve;       ///< from all scratches on down, if it was asked for
  std::vector<DesignIteration> history;  ///< loss before each iteration's step
  int eye_px = 0;  ///< along the carve area's longer side, of the pixels that eyes in the views' places tell apart
  double eye_from_m = 0;  ///< how far away these eyes are: farther ones tell less
  std::vector<ContactFrame> frames;
  std::vector<Finding> findings;  ///< of bench, pictures and the run: what to mind
  double final_loss = 0;          ///< of the scratches as returned, at the optimized exposures
  double loss_before_drop = 0;    ///< when the weak ones were dropped; 0 if none were
  std::size_t started_with = 0, dropped = 0, relocated = 0;  ///< of the new ones
  std::size_t carved = 0;                                    ///< of the scratches: in the metal already
  std::array<std::size_t, kRules> dropped_by_rule{};         ///< those that could not obey a limit, on top of `dropped`
  std::size_t pairs = 0;         ///< (pixel, scratch) pairs of the last iteration, all views
  double iteration_seconds = 0;  ///< in the iterations
  double total_seconds = 0;
  bool stopped_early = false;                       ///< by the time limit
  std::optional<double> width_um, depth_um, alpha;  ///< if optimized
};

}  // namespace burin
