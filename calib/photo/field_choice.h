// burin/calib/photo/field_choice.h - whether depth varies over the board or along the carving order.
//
// It starts constant and takes a step only for good reasons: linear over the board, quadratic, wear. Roughness stays
// constant: of 40 random benches without a field of it, two were given one, which is worse than to miss one. A richer
// field must (a) predict held-out views better than the poorer one, view by view, by more than their scatter's standard
// error:
//     each view in turn is left out, the field's terms are fitted to the rest, and that one is judged;
// (b) be significant with the model's own errors counted: every groove has a depth and a roughness of its own, and a
//     field over a thousand of them that vary by a tenth is not zero, so its terms are held against a covariance whose
//     scores are summed over squares of the board, and against one by views. Chance passes once in ten thousand times,
//     once in a million where terms are quadratic.
// Held-out photos alone would not do: they show the same grooves as the others, with the same accidents.
//
// Glare is chosen by the same two reasons, among the same steps: it fills what grooves leave dark, as less depth would.
// So is the size of lamps (of those that Problem::size_sought seeks it of). A lamp with an area blurs all glints by the
// same angle, a rough groove by a share of its own: what tells one from the other is how a glint's wings fall, and the
// plain face. Size and glare hide one another, so a size is asked for beside the glare that photos have with it. A size
// that photos point to but do not ask for may still be there, with roughness taking it up.
//
// With every view's normal equations at hand (at the optimum without fields, all terms free, cameras and bow
// eliminated), fits and judgments are small dense solves, no rendering.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// The terms that a stage frees.
FreeField freed_by(const Stage& stage);

/// `state` must be at the optimum of `stage`; what that frees already stays. To `shifts` is appended, over all unknowns
/// (global_index()), by how much the answer would move with a size of lamps that photos point to but do not ask for,
/// and with terms that held-out photos and places ask for but whose photos scatter too much.
FreeField choose_depth_field(const Problem& data, const Stage& stage, const State& state,
                             std::vector<Eigen::VectorXd>* shifts = nullptr);

int terms_of(const FreeField& field);  ///< how many numbers it has, glare included; lamps' sizes count as one

}  // namespace burin
