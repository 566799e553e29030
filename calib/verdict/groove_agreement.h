// burin/calib/verdict/groove_agreement.h - whether the grooves that photos show are those of the scratches that were
// sent. Photos of another board have the right tags, and a fit then finds phantoms that make up for its grooves.
//
// Each photo is predicted twice: with the grooves where they are, and all of them aside by a few widths of a pixel. A
// photo of these grooves lies at the first prediction, one of others half way between the two. Fitted to photos that
// show none of its grooves, they fade until no photo by itself tells the predictions apart; all photos together still
// do.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// How a photo lies between the predictions.
struct GrooveAgreement {
  bool tells = false;  ///< the two predictions differ by far more than the photo's noise
  double share = 0;    ///< 1: it shows the grooves at their places; 0: it has nothing to do with them
  double sigmas = 0;   ///< by how many of its standard deviations 1 lies from 0, noise and model error counted
};

/// One entry per photo of the problem, at `state`.
std::vector<GrooveAgreement> groove_agreements(const Problem& data, const State& state);

/// The photos, as indices, that show other grooves: one among good ones, or all of them.
std::vector<std::size_t> photos_of_other_grooves(const std::vector<GrooveAgreement>& agreements);

}  // namespace burin
