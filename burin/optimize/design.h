// burin/optimize/design.h - the inverse problem: scratches that show a target picture in each view of a bench.
//
// Minimises the loss of burin/optimize/loss/loss.h, summed over views, over both ends of every scratch (paper, 3.4-3.5;
// two end points beat midpoint, direction and length, Fig. 20) and over the lamps' exposure, with Adam; afterwards
// drops the scratches that hardly contribute. The pixels are those of the picture as it lies on the carve area
// (board_grid), seen from each view's camera center under its lamp: the lens does not matter. The bench may be nominal
// or measured; its machine's affine is not applied, because the tool path compensates for it. Frame: board, mm. Same
// seed, same bits, for any number of threads. Sources: docs/model.md 6.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "burin/optimize/carving/carving_limits.h"
#include "burin/optimize/design/tolerance.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/loss/loss.h"
#include "burin/optimize/machine_profile.h"
#include "burin/render/bench.h"
#include "burin/render/board.h"
#include "burin/render/image.h"
#include "burin/render/progress.h"
#include "burin/render/scratches.h"

namespace burin {

/// Where scratches begin: anywhere in any direction (the paper), or where and how the pictures want them
/// (burin/optimize/design/stroke_search.h).
enum class Start { random, guided };

/// What has a brightness of its own: each lamp (one photo setting for all its views) or each view (an eye adapts).
enum class ExposureOf { light, view };

/// Of one iteration, for those who watch.
struct DesignFrame {
  int iteration = 0;  ///< 0: the start
  double loss = 0;
  std::vector<double> view_loss;
  std::vector<const Image*> pictures;  ///< a view, gamma-encoded as optimized, valid during the call
};

struct DesignOptions {
  int pixels = 512;  ///< of the grid along the carve area's longer side
  int iterations = 100;
  std::uint64_t seed = 1;
  double rate = 0;        ///< Adam's, in uv (fractions of the board's width and height) an iteration; 0: 1e-3 from a
                          ///< random start, else 0.3 pixels
  double final_rate = 0;  ///< the rate falls along a half cosine to this; 0: chosen
  LossWeights loss{.perceptual = 0, .l2 = 1, .gram = 0};  ///< what PSNR measures; the paper's are 1, 0, 0.01
  Start start = Start::guided;
  int start_sweeps = 4;          ///< guided start: times that each scratch is searched a better place
  double start_length_mm = 0;    ///< random start: mean length; searched scratches are a tenth to ten times as long; 0:
                                 ///< chosen from the number of scratches
  double start_light = 0.5;      ///< guided start: light of a pixel that a scratch of the best direction crosses along
                                 ///< one pixel's length, of white; sets the exposures
  int relocate_every = 2;        ///< iterations between such searches; 0: never
  int candidates = 24;           ///< places tried for each scratch in a search
  double relocate_until = 0.95;  ///< part of the iterations (or of the time limit) after which there are none
  double relocate_share = 0.02;  ///< of the scratches, the least worthy, that may change their view each time
  double balance = 0.5;          ///< how much views that are worse than others draw scratches (balance_views)
  double tolerance_mm =
      0;  ///< how far eye and lamp may stand aside (burin/optimize/design/design_views.h); 0: not at all
  double min_length = 1e-3;     ///< shortest scratch, as a fraction of the board's longer edge
  double max_length_mm = 0;     ///< longest scratch; 0: any
  MachineLimits machine;        ///< obeyed exactly by the result (burin/optimize/carving/carving_limits.h)
  Scratches carved;             ///< in the metal already, where they lie; DesignSpec::scratches counts them too
  double start_exposure = 0.2;  ///< random start: times the exposure that matches the pictures' means
  double exposure_rate = 0.02;  ///< Adam's, in log(exposure) an iteration; 0 holds it
  double log_rate = 0.01;       ///< Adam's, in log(width), log(depth), log(alpha) an iteration
  double drop_error = 0.01;  ///< the least worthy scratches go that together keep the squared error down by this share
  double drop_light = 0;     ///< or those that together carry this share of the light (if > 0)
  double drop_count = 0;     ///< or this share of the scratches (if > 0)
  double drop_at = 0.8;      ///< part of the iterations after which they go; the rest make up for them
  double carve_hours = 0;    ///< the time there is to carve the new ones; scratches go during the iterations. 0: any
  bool carve_curve = false;  ///< measure quality over carving time (always with carve_hours)
  bool report_tolerance = false;  ///< measure how far eye and lamp may stand aside (burin/optimize/design/tolerance.h)
  ExposureOf exposure_of = ExposureOf::view;
  bool optimize_width = false, optimize_depth = false, optimize_alpha = false;  ///< one number for all scratches
  int contact_frames = 8;         ///< iterations kept for the contact sheet
  MachineProfile carve_machine;   ///< whose time it is
  double time_limit_s = 0;        ///< stop iterating so that everything ends about then; 0: no limit
  std::optional<Scratches> from;  ///< go on from these instead of starting anew (their number replaces the spec's);
                                  ///< those marked as carved stay as they are
  std::function<void(const DesignFrame&)> watch;  ///< called once an iteration; may be empty
  std::function<bool()> stop;  ///< true ends the search or the iterations, keeping what there is; asked often, within
                               ///< a sweep of the search too, by several threads at once
};

/// One view of the result. Pictures are gamma-encoded, clipped at white.
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
  double achievable_psnr_db = 0;           ///< of `achievable`: what the face's own light costs
  LossValue loss;                          ///< at `exposure`
  std::vector<double> ghost;               ///< correlation of `shown` with each view's target (its own included)
  std::vector<double> target_correlation;  ///< of this view's target with each view's target
};

struct DesignIteration {
  double loss = 0;
  std::vector<double> view_loss;
  double seconds = 0;  ///< since the first iteration began
};

/// Frames of the contact sheet: one picture a view.
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
  std::vector<ContactFrame> frames;
  std::vector<std::string> warnings;
  double final_loss = 0;        ///< of the scratches as returned, at the optimized exposures
  double loss_before_drop = 0;  ///< when the weak ones were dropped; 0 if none were
  std::size_t started_with = 0, dropped = 0, relocated = 0;  ///< of the new ones
  std::size_t carved = 0;                                    ///< of the scratches: in the metal already
  std::array<std::size_t, kRules> dropped_by_rule{};         ///< those that could not obey a limit, on top of `dropped`
  std::size_t pairs = 0;         ///< (pixel, scratch) pairs of the last iteration, all views
  double iteration_seconds = 0;  ///< in the iterations
  double total_seconds = 0;
  bool stopped_early = false;                       ///< by the time limit
  std::optional<double> width_um, depth_um, alpha;  ///< if optimized
};

/// Designs a board. Throws Error for a view or lamp the bench does not have, targets that cannot be used, a bench on
/// which no groove can glint, options out of range. Collisions of views and the like are warnings in the result.
/// `progress` may throw to stop the work.
DesignResult design(const DesignSpec& spec, const Board& board, const Bench& bench, const DesignOptions& options,
                    const Progress& progress);

}  // namespace burin
