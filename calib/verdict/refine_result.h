// burin/calib/verdict/refine_result.h - from a solved problem to results for people: bench.json's numbers, their sigmas
// and verdicts, and the fit of each photo. Used by refine.h.
#pragma once

#include <set>
#include <span>
#include <vector>

#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/verdict/identifiability.h"
#include "burin/calib/verdict/photo_uncertainty.h"
#include "burin/calib/verdict/refinement.h"
#include "burin/capture/photo.h"

namespace burin {

/// Fit of photo k.
PhotoFit photo_fit(const Problem& data, std::size_t k, const State& state, const Carved& carved, const Bench& bench);

/// Colors: with all other parameters known, each channel of a photo is linear in its lamp's intensity and the ambient
/// light. Splits the intensities and ambient light of `bench` (means of the channels) into channels; monochrome photos
/// change nothing. Returns the lights (indices into bench.lights) with photos in color.
std::set<std::size_t> fit_colors(const Problem& data, std::span<const MergedView> merged, const State& state,
                                 Bench& bench);

/// Lights without photos in color (not in `told`) keep the colors of the light with the same name in `given`: the ratio
/// of the channels, with the mean in `bench`. A note lists them.
std::vector<Finding> keep_colors(std::span<const Light> given, const std::set<std::size_t>& told, Bench& bench);

/// Writes state and uncertainty into out.bench, and judges each parameter (burin/calib/verdict/identifiability.h).
/// `session` is the session whose files the findings name; null: none.
Combinations fill_bench(const Problem& data, const State& state, const Uncertainty& uncertainty, const Stage& stage,
                        const Session* session, Refinement& out);

/// Correlations of the numbers in `bench` that have sigmas: material, machine map and lamps' positions. They are those
/// of the estimate of uncertainty with the largest variances; the sigmas are the bench's.
Correlations correlations_of(const Problem& data, const Uncertainty& uncertainty, const Bench& bench);

/// Resets undetermined parameters of grooves and face to board.json's prior, in `state` and `bench`. The verdict
/// reports it: an optimizer's undetermined result carries no information. Refuted priors
/// (Cause::Kind::believed_refuted) are exempt. Also records the board's commanded values.
void keep_believed(const Board& board, State& state, Bench& bench);

}  // namespace burin
