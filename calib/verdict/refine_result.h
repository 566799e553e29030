// burin/calib/verdict/refine_result.h - from a solved problem to what a person is told: bench.json's numbers, their
// sigmas and verdicts, how each photo is explained. Used by refine.h.
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

/// How photo k is explained.
PhotoFit photo_fit(const Problem& data, std::size_t k, const State& state, const Carved& carved, const Bench& bench);

/// Colors: with everything else known, each channel of a photo is linear in its lamp's intensity and the ambient
/// light. Splits the intensities and ambient light of `bench` (means of the channels) into channels; nothing for mono
/// photos. Returns which lights (indices into bench.lights) photos in color showed.
std::set<std::size_t> fit_colors(const Problem& data, std::span<const MergedView> merged, const State& state,
                                 Bench& bench);

/// Lights that photos in color did not show (`told` are those that they did) keep the colors that lights of their names
/// have in `given`: the ratio of the channels, their mean being as in `bench`. Says in a note which those are.
std::vector<Finding> keep_colors(std::span<const Light> given, const std::set<std::size_t>& told, Bench& bench);

/// Writes state and uncertainty into out.bench, and judges each parameter (burin/calib/verdict/identifiability.h).
/// `session`: whose files the findings name; null: none.
Combinations fill_bench(const Problem& data, const State& state, const Uncertainty& uncertainty, const Stage& stage,
                        const Session* session, Refinement& out);

/// What the photos do not tell of grooves and face goes back to what board.json believes, in `state` and `bench`, and
/// the verdict says so: where an optimizer strayed to is no knowledge. Not what the verdict calls refuted
/// (Cause::Kind::believed_refuted). Also notes what the board was told.
void keep_believed(const Board& board, State& state, Bench& bench);

}  // namespace burin
