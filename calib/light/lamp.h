// burin/calib/light/lamp.h - where the lamp is, from the brightness of paper and of the plain face. docs/model.md 5 and
// 9 'Lamp'. Frame: board, mm. Intensities are with Sensor::gain = 1, the mean of the photo's channels.
//
// Two of the lamp's three cues, which need no scratch: the shading of the tags' white and black paper (cosine and
// distance: where the lamp is within some 30-100 mm, its intensity, the ambient light) and the mirror highlight of the
// plain face (its lobe around the lamp's mirror image: the lamp's direction, base_alpha). What they give is a seed; the
// third cue, the glints of scratches, joins in burin/calib/refine.h, where everything is fitted to every pixel.
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
  double model_error = 0.02;  ///< relative error that a sample may have beyond its noise (uneven paper, haze, blur)
  bool fit_spot = true;       ///< try a spot where a bare lamp leaves more than it must
  /// Sigmas of positions and base_alpha from groups of samples that are left out in turn, where these say more than
  /// noise: errors of one photo, or of one place on the board, are alike. Takes a dozen fits.
  bool jackknife = false;
};

/// What paper and face say.
struct LampSeed {
  bool found = false;         ///< false: too little paper and face to say anything; see `findings`
  std::vector<Light> lights;  ///< as bench.lights, position, intensity, axis, exponent and position sigma filled in
  std::vector<Eigen::Vector2d> aim_mm;
  double base_alpha = 0;
  double base_alpha_sigma = 0;
  FaceGrain grain;              ///< where the face's shine asks for one
  PaperCoat paper;              ///< where paper's does
  std::optional<Light> stray;   ///< a lamp that nobody named, where paper and face ask for one, some way off
  std::vector<LampSize> sizes;  ///< of each lamp, as a panel's sides, where paper and face ask for one; else a point's
  double ambient = 0;           ///< mean of the channels; of photos under surroundings, their scale
  double ambient_sigma = 0;     ///< 0, as vignette_sigma: not known
  Eigen::Vector3d vignette{0, 0, 0}, vignette_sigma{0, 0, 0};
  double residual_rms = 0;  ///< of log(photo / model), over the samples within the robust loss's core
  std::vector<Finding> findings;
};

/// Fits lamps, ambient light, vignetting and base_alpha to `samples`. Seeds: shading is linear after raising to the
/// power -2/3, and a ring of starts for where shading alone misleads (spots, vignetting).
LampSeed fit_lamps(std::span<const LightSample> samples, const Board& board, const Bench& bench,
                   const LampOptions& options = {});

/// The closed-form seed from paper alone: brightness s of white minus black at points p of a plane is
/// I Lz / (pi |L - p|^3), so s^(-2/3) is linear in (1, |L|^2, Lx, Ly): docs/model.md 9.4. Empty where that has no lamp
/// in front of the board.
std::optional<Eigen::Vector3d> lamp_from_shading(std::span<const Eigen::Vector3d> p_board,
                                                 std::span<const double> shading);

/// A note on paper that shines; none on other paper.
std::vector<Finding> paper_findings(const PaperCoat& paper);

/// The same from samples that were gathered before (light_samples.h); `measured` names their lights.
Bench with_lamps(std::span<const LightSample> samples, const Board& board, const Bench& measured,
                 std::vector<Finding>& findings);

/// Finds the lamps of a calibrated bench from paper and face alone: what `burin calibrate` writes.
/// Also fills in material.base_alpha, ambient light and vignetting, and a verdict on each lamp.
/// Appends to `findings` what could not be found.
Bench with_lamps(std::span<const MergedView> photos, const Board& board, const Sent& sent, const Bench& measured,
                 std::vector<Finding>& findings);

}  // namespace burin
