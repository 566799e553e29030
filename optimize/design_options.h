// burin/optimize/design_options.h - options of a design: start, search, limits and end. Frame: board, mm.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/image.h"
#include "burin/optimize/loss/loss.h"
#include "burin/optimize/machine_profile.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Initialization of scratches: random (the paper), or greedy initialization by the pictures' errors
/// (burin/optimize/design/stroke_search.h).
enum class Start { random, guided };

/// Owner of an exposure: each lamp (one photo setting for all its views) or each view (an eye adapts).
enum class ExposureOf { light, view };

/// State after one iteration, or after one step of the start, for an observer.
struct DesignFrame {
  int iteration = 0;  ///< 0: the start
  double loss = 0;    ///< 0 during the start
  std::vector<double> view_loss;
  std::vector<const Image*> pictures;  ///< one per view, gamma-encoded as optimized, valid during the call
  double seconds = 0;                  ///< since the design began
  /// Mean of the views, for the grooves as they will be cut. Nothing during the start, or if a search held the light
  /// after crossings. Faint contributions stay fixed for some iterations, which can change it by a tenth of a dB.
  std::optional<double> psnr_db{};
};

/// Options of a design.
struct DesignOptions {
  /// Pixels of the grid along the carve area's longer side. 0: 512 for a random start, else those that eyes at the
  /// viewpoints resolve, or as many as strokes can fill (burin/optimize/design/picture_pixels.h).
  int pixels = 0;
  /// None: 160; 70 if grooves cut each other, where an iteration takes longer and the last ones gain less
  /// (docs/results/design.md).
  std::optional<int> iterations;
  std::uint64_t seed = 1;
  /// Adam's step per iteration in uv (fractions of the board's width and height). 0: 1e-3 after a random start, else
  /// 0.2 pixels.
  double rate = 0;
  double final_rate = 0;  ///< end of the half cosine along which the rate falls; 0: chosen
  LossWeights loss{.perceptual = 0, .l2 = 1, .gram = 0};  ///< plain squared error, as in PSNR; the paper has 1, 0, 0.01
  Start start = Start::guided;
  int start_sweeps = 1;  ///< guided start: number of searches for a better place of each scratch
  /// Random start: mean length; searched scratches have 0.1 to 10 times this length. 0: chosen from the number of
  /// scratches.
  double start_length_mm = 0;
  /// Guided start: light of a pixel that a scratch of the best direction crosses along one pixel's length, as a
  /// fraction of white. It sets the exposures.
  double start_light = 0.5;
  int relocate_every = 2;  ///< iterations between re-insertion searches; 0: never
  int candidates = 16;     ///< per scratch in a search
  /// Part of the iterations (or of the time limit) with searches. It is at most 0.5 if the carving order shows, 0.6 if
  /// grooves cut each other's rims away.
  double relocate_until = 0.95;
  /// Share of the scratches, of least marginal contribution, which a search may give to another view.
  double relocate_share = 0.02;
  double balance = 0.5;  ///< strength of view reweighting (balance_views)
  /// Off-axis viewpoints: distance of eye and lamp from their places (burin/optimize/design/design_views.h); 0: none.
  double tolerance_mm = 0;
  double min_length = 1e-3;  ///< shortest scratch, as a fraction of the board's longer edge
  double max_length_mm = 0;  ///< longest scratch; 0: any
  MachineLimits machine;     ///< the result obeys them exactly (burin/optimize/toolpath/carving_limits.h)
  Scratches carved;  ///< existing grooves, at their carved positions; DesignSpec::scratches includes their number
  double start_exposure = 0.2;  ///< random start: times the exposure that matches the pictures' means
  double exposure_rate = 0.02;  ///< Adam's step of log(exposure) per iteration; 0: fixed
  double log_rate = 0.01;       ///< Adam's step of log(width), log(depth), log(alpha) per iteration
  double drop_error = 0.01;     ///< pruning: share by which dropped scratches may increase the squared error together
  double drop_light = 0;        ///< or their share of the light (if > 0)
  double drop_share = 0;        ///< or share of the scratches to drop (if > 0)
  double drop_at = 0.8;         ///< part of the iterations before pruning; the rest compensate for it
  /// Limit of the new scratches' carving time; the iterations drop scratches to meet it. 0: any.
  double carve_hours = 0;
  bool carve_curve = false;       ///< report quality over carving time (always with carve_hours)
  bool report_tolerance = false;  ///< report the viewing zone of eye and lamp (burin/optimize/design/tolerance.h)
  ExposureOf exposure_of = ExposureOf::view;
  /// Factor of the lift of blacks if no scratch is dark (burin/optimize/design/lift_blacks.h); 0: none.
  double lift_blacks = 1;
  bool optimize_width = false, optimize_depth = false, optimize_alpha = false;  ///< one value for all
  int contact_frames = 8;                                                       ///< iterations in the contact sheet
  bool note_few_strokes = true;  ///< report too few strokes for the pixels (docs/design.md, "How many pixels")
  MachineProfile carve_machine;  ///< machine of the carving time
  double time_limit_s = 0;  ///< wall-clock limit of the whole design: iterations stop in time for the rest; 0: no limit
  /// Initial scratches; their number replaces the spec's, and scratches marked as carved stay fixed.
  std::optional<Scratches> from;
  /// Receives the findings on bench and pictures before the work begins; may be empty.
  std::function<void(const std::vector<Finding>&)> found;
  std::function<void(const DesignFrame&)> watch;  ///< called during the start, then once per iteration; may be empty
  /// True ends the search, the iterations or an optional measurement, and keeps the result so far. Several threads call
  /// it often.
  std::function<bool()> stop;
};

}  // namespace burin
