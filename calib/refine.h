// burin/calib/refine.h - what the grooves, the lamp and the machine really are, from every pixel of the photos.
// Frame: board, mm. docs/model.md 9.5 to 9.18.
//
// One least-squares problem over all photos: residual = photo value / exposure factor
//   - vignette(r) * blur( I(w) * radiance of a bare unit lamp + ambient * F0 ),
// weighted by the photo's noise and a model error that is estimated from the residuals (grooves that differ from one
// another included: weigh_photos_and_grooves), under a Cauchy loss. Unknown: alpha, d, base_alpha, lamp position and
// intensity (aim and exponent of a spot), ambient light, vignetting, blur, the machine's affine map, and how depth
// varies over the board and with wear, as far as the photos ask for it (field_choice.h). The renderer's own
// derivatives (render_with_derivatives) fill the Jacobian, and it is kept while it foretells what a step changes; each
// photo's is compressed to its normal equations. Coarse (binned) photos first: there the machine may be off by more
// than a groove's width.
//
// Cameras' poses, the bow and the lens move too (geometry_prior.h), with the tags as their prior.
//
// Sigmas are not those of white noise. Several estimates are made, and the largest is reported, all of them with the
// robust loss' own curvature at the optimum: the inverse of the normal equations times the residuals' scatter;
// sandwiches whose scores are summed over 20 mm squares of the board (errors that a place has in all photos: dust, a
// groove's own depth), over its quadrants, and over groups of photos with like half vectors (errors of the model
// itself); the delete-one-view jackknife (errors that all photos of a view share: its pose).
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

/// RefineOptions::finest_pixel_mm of grooves of which light adds where they cross, and of those that cut one another.
inline constexpr double kPixelMm = 0.8, kCutPixelMm = 0.25;

/// What `burin refine` fits, and how finely.
struct RefineOptions {
  std::optional<Crossings> crossings;  ///< where grooves cross; empty: whichever explains the photos better
  bool fit_lamp = true;                ///< false keeps bench.lights' positions
  bool fit_geometry = true;            ///< false: the bench's poses, bow and lens are exact
  bool fit_fields = true;              ///< let depth vary over the board and with wear (field_choice.h)
  bool fit_effects = true;  ///< seek backlash, uneven screws, a brushed face, other grooves (effect_choice.h)
  /// Photos are binned until a pixel is at least this large on the board, 0 for the photos as taken. Grooves are found
  /// far below a pixel, so binning loses little and is several times faster; what it distorts is corrected by
  /// predictions on the photos' own pixels (correct_binning). Empty: the number below that grooves ask for.
  std::optional<double> finest_pixel_mm;
  int max_iterations = 12;              ///< of the trust region, at each resolution
  const Session* session = nullptr;     ///< whose photos these are, to name files in findings
  std::size_t max_pixels = 12'000'000;  ///< of all photos together at the finest resolution; they are binned to fit
};

/// Reads the session's photos and completes `measured` (lens, poses, tags, bow from calibration; its lamps, where they
/// have no position sigma, are found from scratch). `sent` is what the machine was told. Throws Error if too
/// little is left to work on: no photo with a pose, no scratch in view; and for photos that show other grooves than
/// those of `sent`.
Refinement refine(const Session& session, const Board& board, const Sent& sent, const Bench& measured,
                  const RefineOptions& options = {}, const Progress& progress = {});

/// The session's photos as refine wants them: merged, and binned where they are large (light_bin).
std::vector<MergedView> photos_for_refine(const Session& session, const Board& board, const Bench& measured);

/// The same for photos in memory.
Refinement refine(std::span<const MergedView> photos, const Board& board, const Sent& sent, const Bench& measured,
                  const RefineOptions& options = {}, const Progress& progress = {});

}  // namespace burin
