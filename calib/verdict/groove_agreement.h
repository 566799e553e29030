// burin/calib/verdict/groove_agreement.h - test that the photos show the grooves of the sent scratches. Photos of
// another board have the right tags, and a fit then finds wrong parameters that compensate for its grooves.
//
// The test predicts each photo twice: with the grooves at their places, and with all of them shifted by 2.7 mm, in each
// of four directions. A photo of these grooves agrees with the first prediction; a photo of others is halfway between
// the two. In a fit to photos without its grooves, they fade until no single photo distinguishes the predictions. All
// photos together still distinguish them. A second pair of predictions has the grooves' directions exchanged among
// neighbors: other grooves may glint at the same places.
//
// Boards of the same pictures (another seed, the next round) pass this test, because their grooves nearly coincide. A
// second test compares the contribution of single grooves in the photos' own pixels.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "burin/calib/light/light_samples.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/scene/bench.h"

namespace burin {

/// Position of a photo between the two predictions.
struct GrooveAgreement {
  bool tells = false;  ///< true: the predictions differ by far more than the photo's noise
  double share = 0;    ///< 1: it shows the grooves at their places; 0: it is unrelated to them
  double sigmas = 0;   ///< distance of 1 from 0 in the share's standard deviations, with noise and model error
};

/// One entry per photo of the problem, at `state`.
std::vector<GrooveAgreement> groove_agreements(const Problem& data, const State& state);

/// Share of the contribution of single grooves that photos show.
struct SingleGrooves {
  std::size_t photos = 0;  ///< number of photos with enough of it
  double share = 0;        ///< their median; 1: these grooves; 0: unrelated photos
  double sigma = 1;        ///< its standard deviation, from the scatter of squares of the photos; 1: unknown
};

/// At `state`, in full pixels of the photos nearest to the board. `views` are the photos of `data`, not binned.
SingleGrooves compare_single_grooves(const Problem& data, const std::vector<LightView>& views, const Bench& bench,
                                     const State& state);

/// Whether the photos show other grooves, and whether they show these, by two standard deviations.
bool shows_other_grooves(const SingleGrooves& seen);
bool shows_these_grooves(const SingleGrooves& seen);

/// Indices of photos with other grooves: single ones among good ones, or all.
std::vector<std::size_t> photos_of_other_grooves(const std::vector<GrooveAgreement>& agreements);

}  // namespace burin
