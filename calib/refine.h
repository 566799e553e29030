// burin/calib/refine.h - estimates grooves, lamp and machine from every pixel of the photos. Frame: board, mm.
// docs/model.md 9.5 to 9.18.
//
// One least-squares problem covers all photos: residual = photo value / exposure factor
//   - vignette(r) * blur( I(w) * radiance of a bare unit lamp + ambient * F0 ).
// The photo's noise and a model error weight each residual, under a Cauchy loss. The residuals themselves give the
// model error, which includes groove-to-groove variation (weigh_photos_and_grooves). The unknowns are alpha, d,
// base_alpha, lamp position and intensity, a spotlight's aim and exponent, ambient light, vignetting, blur and the
// affine machine calibration. Variation of depth over the board and with wear joins as far as the photos support it
// (field_choice.h). The renderer's own derivatives (render_with_derivatives) fill the Jacobian. A Jacobian is kept
// while it predicts the change of a step. Each photo's Jacobian is compressed to its normal equations. Coarse (binned)
// photos come first: there the machine may be off by more than a groove's width.
//
// Camera poses, the bow and the lens move too (geometry_prior.h), with the tags as their prior.
//
// Sigmas do not assume white noise. Several estimates are made, and the largest is reported. All of them use the robust
// loss' own curvature at the optimum:
//   - the inverse of the normal equations times the residuals' scatter;
//   - sandwiches whose scores are summed over 20 mm squares of the board: errors of a place in all photos, such
//     as dust or a groove's own depth;
//   - sandwiches over the board's quadrants, and over groups of photos with like half vectors: errors of the
//     model itself;
//   - the delete-one-view jackknife: common errors of all photos of a view, such as its pose.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/verdict/refinement.h"
#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"

namespace burin {

/// RefineOptions::finest_pixel_mm for grooves whose light adds at crossings, and for grooves that cut one another.
inline constexpr double kPixelMm = 0.8, kCutPixelMm = 0.25;

/// Unknowns and resolution of `burin refine`.
struct RefineOptions {
  std::optional<Crossings> crossings;  ///< crossing rule; empty: the better explanation of the photos
  bool fit_lamp = true;                ///< false keeps bench.lights' positions
  bool fit_geometry = true;            ///< false: the bench's poses, bow and lens are exact
  bool fit_fields = true;              ///< let depth vary over the board and with wear (field_choice.h)
  bool fit_effects = true;  ///< seek backlash, uneven screws, a brushed face, other grooves (effect_choice.h)
  /// Photos are binned until a pixel is at least this large on the board; 0 keeps the photos as taken. Grooves are
  /// located far below a pixel, so binning loses little and is several times faster. Predictions on the photos' own
  /// pixels correct the distortion by binning (correct_binning). Empty: kPixelMm or kCutPixelMm, as the grooves
  /// require.
  std::optional<double> finest_pixel_mm;
  int max_iterations = 12;              ///< of the trust region, at each resolution
  const Session* session = nullptr;     ///< session of the photos, to name files in findings
  std::size_t max_pixels = 12'000'000;  ///< of all photos together at the finest resolution; they are binned to fit
};

/// Reads the session's photos and completes `measured`, the result of calibration: lens, poses, tags, bow. Lamps
/// without a position sigma are found from scratch. `sent` is the commanded trajectory. Throws Error if no photo has a
/// pose, if no scratch is in view, or if the photos show other grooves than those of `sent`.
Refinement refine(const Session& session, const Board& board, const Sent& sent, const Bench& measured,
                  const RefineOptions& options = {}, const Progress& progress = {});

/// The session's photos as refine needs them: merged, and binned if they are large (light_bin).
std::vector<MergedView> photos_for_refine(const Session& session, const Board& board, const Bench& measured);

/// Refines from photos in memory.
Refinement refine(std::span<const MergedView> photos, const Board& board, const Sent& sent, const Bench& measured,
                  const RefineOptions& options = {}, const Progress& progress = {});

}  // namespace burin
