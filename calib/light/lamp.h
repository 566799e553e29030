// burin/calib/light/lamp.h - estimates lamps from the brightness of paper and of the plain face. docs/model.md 5 and 9
// 'Lamp'. Frame: board, mm. Intensities are with Sensor::gain = 1, the mean of the photo's channels.
//
// A lamp has three cues, two of which need no scratch. The shading of the tags' white and black paper (cosine and
// distance) gives its intensity, the ambient light and the lamp's place within some 30-100 mm. The mirror highlight of
// the plain face (its lobe around the lamp's mirror image) gives the lamp's direction and base_alpha. Both give a seed.
// The third cue, the glints of scratches, joins in burin/calib/refine.h, where everything is fitted to every pixel.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/calib/light/light_samples.h"
#include "burin/capture/photo.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/face_grain.h"
#include "burin/scene/light.h"

namespace burin {

struct LampOptions {
  double model_error = 0.02;  ///< relative error of a sample beyond its noise (uneven paper, haze, blur)
  bool fit_spot = true;       ///< try a spotlight if a bare lamp leaves large residuals
  /// Takes sigmas of positions and base_alpha from groups of samples left out in turn, if these exceed the noise.
  /// Errors of one photo, or of one place on the board, are alike. Takes a dozen fits.
  bool jackknife = false;
};

/// Estimates from paper and face.
struct LampSeed {
  bool found = false;         ///< false: too little paper and face; see `findings`
  std::vector<Light> lights;  ///< as bench.lights, with position, intensity, axis, exponent and position sigma
  std::vector<Eigen::Vector2d> aim_mm;
  double base_alpha = 0;
  double base_alpha_sigma = 0;
  FaceGrain grain;              ///< of a brushed face, if its highlight shows one
  PaperCoat paper;              ///< of glossy paper, if its shading shows one
  std::optional<Light> stray;   ///< unmodeled light some way off, if paper and face show one
  std::vector<LampSize> sizes;  ///< area of each lamp as a panel's sides, if paper and face show one; else a point's
  double ambient = 0;           ///< mean of the channels; for photos under surroundings, their scale
  double ambient_sigma = 0;     ///< 0, as in vignette_sigma: not known
  Eigen::Vector3d vignette{0, 0, 0}, vignette_sigma{0, 0, 0};
  double residual_rms = 0;  ///< of log(photo / model), over the samples within the robust loss's core
  std::vector<Finding> findings;
};

/// Fits lamps, ambient light, vignetting and base_alpha to `samples`. Shading to the power -2/3 is linear and gives the
/// initial guess. A ring of further starts helps if shading alone misleads (spotlights, vignetting).
LampSeed fit_lamps(std::span<const LightSample> samples, const Board& board, const Bench& bench,
                   const LampOptions& options = {});

/// The closed-form seed from paper alone. Brightness s of white minus black at points p of a plane is I Lz / (pi |L -
/// p|^3), so s^(-2/3) is linear in (1, |L|^2, Lx, Ly): docs/model.md 9.4. Empty if the solution has no lamp in front of
/// the board.
std::optional<Eigen::Vector3d> lamp_from_shading(std::span<const Eigen::Vector3d> p_board,
                                                 std::span<const double> shading);

/// A note on glossy paper; empty for other paper.
std::vector<Finding> paper_findings(const PaperCoat& paper);

/// Finds lamps from samples gathered earlier (light_samples.h); `measured` names their lights.
Bench with_lamps(std::span<const LightSample> samples, const Board& board, const Bench& measured,
                 std::vector<Finding>& findings);

/// Finds the lamps of a calibrated bench from paper and face alone, as `burin calibrate` writes them. Also fills in
/// material.base_alpha, ambient light and vignetting, and a verdict on each lamp. Appends failures to `findings`.
Bench with_lamps(std::span<const MergedView> photos, const Board& board, const Sent& sent, const Bench& measured,
                 std::vector<Finding>& findings);

}  // namespace burin
