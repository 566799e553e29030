// burin/optimize/design_options.h - how a design is made: where it starts, how it searches, what it obeys and when it
// ends. Frame: board, mm.
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

/// Where scratches begin: anywhere in any direction (the paper), or where and how the pictures want them
/// (burin/optimize/design/stroke_search.h).
enum class Start { random, guided };

/// What has a brightness of its own: each lamp (one photo setting for all its views) or each view (an eye adapts).
enum class ExposureOf { light, view };

/// Of one iteration, or of one step of the start, for those who watch.
struct DesignFrame {
  int iteration = 0;  ///< 0: the start
  double loss = 0;    ///< 0 while the start is made
  std::vector<double> view_loss;
  std::vector<const Image*> pictures;  ///< a view, gamma-encoded as optimized, valid during the call
  double seconds = 0;                  ///< since the design began
  /// Mean of the views, of the grooves as they will be cut; nothing while the start is made, and where a search held
  /// what crossings leave. What hardly shows is held for some iterations, which may be a tenth of a dB.
  std::optional<double> psnr_db{};
};

struct DesignOptions {
  int pixels = 0;  ///< of the grid along the carve area's longer side; 0: 512, or from a guided start as many as
                   ///< strokes can fill (burin/optimize/design/picture_pixels.h)
  int iterations = 160;
  std::uint64_t seed = 1;
  double rate = 0;        ///< Adam's, in uv (fractions of the board's width and height) an iteration; 0: 1e-3 from a
                          ///< random start, else 0.2 pixels
  double final_rate = 0;  ///< the rate falls along a half cosine to this; 0: chosen
  LossWeights loss{.perceptual = 0, .l2 = 1, .gram = 0};  ///< what PSNR measures; the paper's are 1, 0, 0.01
  Start start = Start::guided;
  int start_sweeps = 1;          ///< guided start: times that each scratch is searched a better place
  double start_length_mm = 0;    ///< random start: mean length; searched scratches are a tenth to ten times as long; 0:
                                 ///< chosen from the number of scratches
  double start_light = 0.5;      ///< guided start: light of a pixel that a scratch of the best direction crosses along
                                 ///< one pixel's length, of white; sets the exposures
  int relocate_every = 2;        ///< iterations between such searches; 0: never
  int candidates = 16;           ///< places tried for each scratch in a search
  double relocate_until = 0.95;  ///< part of the iterations (or of the time limit) after which there are none;
                                 ///< at most 0.5 where their order shows, 0.6 where they cut each other's rims away
  double relocate_share = 0.02;  ///< of the scratches, the least worthy, that may change their view each time
  double balance = 0.5;          ///< how much views that are worse than others draw scratches (balance_views)
  double tolerance_mm =
      0;  ///< how far eye and lamp may stand aside (burin/optimize/design/design_views.h); 0: not at all
  double min_length = 1e-3;     ///< shortest scratch, as a fraction of the board's longer edge
  double max_length_mm = 0;     ///< longest scratch; 0: any
  MachineLimits machine;        ///< obeyed exactly by the result (burin/optimize/toolpath/carving_limits.h)
  Scratches carved;             ///< in the metal already, where they lie; DesignSpec::scratches counts them too
  double start_exposure = 0.2;  ///< random start: times the exposure that matches the pictures' means
  double exposure_rate = 0.02;  ///< Adam's, in log(exposure) an iteration; 0 holds it
  double log_rate = 0.01;       ///< Adam's, in log(width), log(depth), log(alpha) an iteration
  double drop_error = 0.01;  ///< the least worthy scratches go that together keep the squared error down by this share
  double drop_light = 0;     ///< or those that together carry this share of the light (if > 0)
  double drop_share = 0;     ///< or this share of the scratches (if > 0)
  double drop_at = 0.8;      ///< part of the iterations after which they go; the rest make up for them
  double carve_hours = 0;    ///< the time there is to carve the new ones; scratches go during the iterations. 0: any
  bool carve_curve = false;  ///< measure quality over carving time (always with carve_hours)
  bool report_tolerance = false;  ///< measure how far eye and lamp may stand aside (burin/optimize/design/tolerance.h)
  ExposureOf exposure_of = ExposureOf::view;
  double lift_blacks =
      1;  ///< times the lift of blacks where no scratch is dark (burin/optimize/design/lift_blacks.h); 0: none
  bool optimize_width = false, optimize_depth = false, optimize_alpha = false;  ///< one number for all scratches
  int contact_frames = 8;         ///< iterations kept for the contact sheet
  bool note_few_strokes = true;   ///< say so where strokes are few for the pixels (docs/design.md, "How many pixels")
  MachineProfile carve_machine;   ///< whose time it is
  double time_limit_s = 0;        ///< stop iterating so that everything ends about then; 0: no limit
  std::optional<Scratches> from;  ///< go on from these instead of starting anew (their number replaces the spec's);
                                  ///< those marked as carved stay as they are
  /// Told what was found of bench and pictures before the work begins; may be empty.
  std::function<void(const std::vector<Finding>&)> found;
  std::function<void(const DesignFrame&)> watch;  ///< called as the start grows, then once an iteration; may be empty
  std::function<bool()> stop;  ///< true ends the search, the iterations or a measurement that the scratches do not
                               ///< need, keeping what there is; asked often, by several threads at once
};

}  // namespace burin
