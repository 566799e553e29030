// burin/calib/photo/field_choice.h - tests depth for variation over the board or along the carving order.
//
// Depth starts constant. Steps add linear terms over the board, then quadratic ones, then wear. Roughness stays
// constant: of 40 random benches without variation of it, two were given one, which is worse than missing one. A richer
// field must pass two tests.
// (a) It predicts held-out views better than the poorer one, view by view, by more than the standard error of the gain.
//     Each view in turn is left out, the field's terms are fitted to the rest, and the left-out view is judged.
// (b) It is significant with the model's own errors counted. Every groove has its own depth and roughness. A
//     field over a thousand grooves with variations of a tenth is not zero. Its terms are therefore compared with
//     two covariances, with scores summed over squares of the board and over views. Chance passes once in ten
//     thousand times, once in a million for quadratic terms.
// Held-out photos alone would not suffice: they show the same grooves as the others, with the same accidents.
//
// These tests, among the same steps, also choose glare: it brightens the dark parts of grooves, as less depth would.
// They further choose the size of lamps (if Problem::size_sought). An area light blurs all glints by the same angle; a
// rough groove blurs by a share of the glint's own. The falloff of a glint's wings, and the plain face, separate the
// two. Size and glare mask one another, so size is tested together with its glare. A size with weak evidence may still
// exist, with roughness absorbing it.
//
// Every view's normal equations are at hand, at the optimum without fields, all terms free, cameras and bow eliminated.
// Fits and tests are therefore small dense solves without rendering.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// The terms freed by a stage.
FreeField freed_by(const Stage& stage);

/// `state` must be at the optimum of `stage`; the stage's free terms stay. `shifts` receives changes of the answer over
/// all unknowns (global_index()). One is with a size of lamps of weak evidence, another with terms that pass held-out
/// photos and places but scatter too much between photos.
FreeField choose_depth_field(const Problem& data, const Stage& stage, const State& state,
                             std::vector<Eigen::VectorXd>* shifts = nullptr);

int terms_of(const FreeField& field);  ///< number of its terms, glare included; lamps' sizes count as one

}  // namespace burin
