// burin/calib/photo/effect_choice.h - tests photos for effects of some benches only: backlash, lead-screw errors, a
// brushed face, groove profiles other than the paper's. docs/model.md 9, 'Effects'.
//
// Each test starts from the fit without the effect, at the middle resolution. Backlash and grain take one look at the
// photos' equations. Screws take one spectrum of the scores by the grooves' places. Profiles take fits starting with
// the effect. A spurious effect does more harm than a missed one. Each must therefore predict held-out views better, by
// far more than their scatter, and exceed the model's own errors.
#pragma once

#include <functional>
#include <initializer_list>
#include <vector>

#include "burin/calib/photo/normal_system.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// The photos' equations near the optimum of a stage, for its unknowns and the tested ones: one look serves all tests.
struct EffectEquations {
  Stage stage, all;
  ViewEquations views;
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
};
EffectEquations effect_equations(const Problem& data, const Stage& stage, const State& state,
                                 std::initializer_list<Group> asked);

/// Evidence required of an effect: its chi^2 against the scatter between places of the board, and its gain in held-out
/// views in standard errors. Two numbers exceed the default chi^2 by chance once in three million times.
struct Evidence {
  double chi2 = 30, standard_errors = 1;
};

/// True if unknowns of `group`, which the stage holds, explain held-out views and exceed the scatter between places of
/// the board. For flanks of grooves with the paper's profile: tests flanks of the state's slope.
bool photos_ask_for(const Problem& data, const State& state, const EffectEquations& equations, Group group,
                    const Evidence& least = {});

/// Puts into `state` the flanks that Group::flank tests as a whole: less steep than the grooves' walls.
void set_flanks_to_ask_for(const Problem& data, State& state);

/// Power of periodic displacements of grooves along x and y, as a lead-screw error causes them: relative to the mean by
/// chance.
using ScrewPower = Eigen::Array2d;
/// Threshold of a lead-screw error, and of one on a machine with known wear. Without displacements powers are
/// distributed as exp(-power), at some forty frequencies along 60 mm. Pieces of one groove have like displacements,
/// which raises it: the largest of 22 such spectra was 8.5 with the rest of the bench known.
inline constexpr double kScrewPower = 40, kScrewPowerOfWorn = 12;

/// Seeks lead-screw errors along axes without one. For each one found it creates the unknowns (Problem::uneven), and
/// puts the period and an initial error of a tenth of a micrometer into `state`. Returns 0 for other axes.
ScrewPower start_screws(Problem& data, State& state, double least_power);

/// The best profile for the photos, with the state of its fit; the paper's unless another is much better. `may_vary`:
/// depth may vary over the board while burrs are tested. `told` is called with the name of a trial and the share of all
/// work done.
struct ProfileChoice {
  GrooveProfile profile;
  State state;
  double cost = 0;          ///< over the pieces of the trials (kMostTried)
  std::vector<Group> free;  ///< its unknowns determined by the photos
  /// Uncertainty of detected burrs, over all unknowns (global_index()): a share of their changes of roughness and
  /// depth, and errors of width and relative heights. All of these are correlated, and unmodeled light decides how far.
  /// Else empty.
  Eigen::VectorXd trade;
};
ProfileChoice choose_profile(const Problem& data, const Stage& stage, const State& state, bool may_vary,
                             const std::function<void(const char*, double)>& told);

}  // namespace burin
