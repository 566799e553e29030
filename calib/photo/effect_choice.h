// burin/calib/photo/effect_choice.h - what only some benches have, and whether photos ask for it: backlash, uneven
// screws, a brushed face, grooves of another cross-section. docs/model.md 9, 'Effects'.
//
// Each test is taken where the fit stands without the effect, at the middle resolution: one look at the photos'
// equations (backlash, grain), one spectrum of what pulls at the grooves' places (screws), or fits that begin with the
// effect (cross-sections). An effect made up does more harm than one missed, so each must predict views that it was not
// fitted to, by far more than they scatter, and be beyond what the model's own errors make up.
#pragma once

#include <functional>
#include <initializer_list>
#include <vector>

#include "burin/calib/photo/normal_system.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// The photos' equations near the optimum of a stage, of what it frees and of what is asked for too: one look serves
/// all their tests.
struct EffectEquations {
  Stage stage, all;
  ViewEquations views;
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
};
EffectEquations effect_equations(const Problem& data, const Stage& stage, const State& state,
                                 std::initializer_list<Group> asked);

/// What photos have to show of an effect: chi^2 beyond what places of the board make up (the default: what two numbers
/// have by chance once in three million times), and by how many times what they scatter by views that it was not fitted
/// to have to gain.
struct Evidence {
  double chi2 = 30, standard_errors = 1;
};

/// Whether unknowns of `group`, which the stage holds, explain views that they were not fitted to, and are beyond what
/// places of the board make up. For flanks, where grooves have the paper's cross-section: whether flanks of state's
/// slope would.
bool photos_ask_for(const Problem& data, const State& state, const EffectEquations& equations, Group group,
                    const Evidence& least = {});

/// Puts into `state` the flanks that Group::flank asks for as a whole: less steep than the grooves' walls.
void set_flanks_to_ask_for(const Problem& data, State& state);

/// How strongly something pulls grooves to and fro with their place along x and y, as an uneven screw does: times what
/// chance gives in the mean.
using ScrewPower = Eigen::Array2d;
/// Beyond it there is a screw; and where a machine is worn already. Where nothing pulls powers are distributed as
/// exp(-power), at some forty frequencies along 60 mm; pieces of one groove pull alike, so higher: 8.5 was the most of
/// 22 such spectra where the rest of the bench was known.
inline constexpr double kScrewPower = 40, kScrewPowerOfWorn = 12;

/// Seeks uneven screws along those axes that have none yet. Where there is one its unknowns are made (Problem::uneven),
/// and its period, and an error of a tenth of a micrometer to start from, are put into `state`. 0 for other axes.
ScrewPower start_screws(Problem& data, State& state, double least_power);

/// The cross-section that explains the photos best, with the state that it was fitted to; the paper's where none does
/// so by far enough. `may_vary`: depth may vary over the board where burrs are asked for. `told` is called with what is
/// tried, and the share of all that is done.
struct ProfileChoice {
  GrooveProfile profile;
  State state;
  double cost = 0;          ///< of what trials look at (kMostTried)
  std::vector<Group> free;  ///< what of it the photos tell
  /// Of burrs that were found: a share of what they moved roughness and depth by, and how far width, and heights in
  /// shares of themselves, may be off, over all unknowns (global_index()). All of them trade with each other, and what
  /// else the photos' light misses decides how far. Else empty.
  Eigen::VectorXd trade;
};
ProfileChoice choose_profile(const Problem& data, const Stage& stage, const State& state, bool may_vary,
                             const std::function<void(const char*, double)>& told);

}  // namespace burin
