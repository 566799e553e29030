#include "burin/calib/photo/field_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/held_out_gains.h"
#include "burin/calib/photo/normal_system.h"

namespace burin {
namespace {

void set_free(const FreeField& field, std::size_t lights, std::vector<bool>& free) {
  const Stage stage = Stage().free(field);
  for_each_unknown([&](const UnknownRow& row, int first) {
    if (row.group == Group::lamp_size && !field.size)
      for (std::size_t light = 0; light < lights; ++light)
        free[static_cast<std::size_t>(global_index(first, light))] = false;
    if (row.group == Group::depth_linear || row.group == Group::depth_quadratic || row.group == Group::depth_wear ||
        row.group == Group::glare)
      std::fill_n(free.begin() + first, row.size, stage.frees(row.group));
  });
}

// True if chance rarely makes chi^2 of `terms` terms as large, under a covariance from `samples` scores. The limit is
// once in ten thousand times for a slope or wear, and once in a million for more terms. These are rarer on real boards,
// and one random bench in ten had spurious ones (a spurious field does more harm than a missed one). Hotelling's T^2
// has an F distribution, and the cube root of F is nearly a ratio of normals (Paulson, Annals of Mathematical
// Statistics 13, 1942). A lamp's size and glare cannot be below 0, so only one half of the chance cases resembles them.
constexpr double kOnceInTenThousand = 3.719, kOnceInAMillion = 4.753;  // sigmas of a normal distribution
constexpr double kTwiceInTenThousand = 3.540;
constexpr double kLeastShare = 0.001;  // of glare; less counts as none, and below none is another effect
// Any brightening of dark places resembles glare: fingerprints and dust of an amateur's bench without glare gave 0.8 %,
// at 7.2 sigmas by places and 4.8 by views. Such small shares need stronger evidence.
constexpr double kMadeUpGlare = 0.015, kLittleGlareByPlace = 8, kLittleGlareByView = 6;

bool beyond_chance(double chi2, std::size_t terms, std::size_t samples, double sigmas) {
  if (samples < terms + 3) return false;
  const auto k = static_cast<double>(terms), n = static_cast<double>(samples);
  const double root = std::cbrt(chi2 * (n - k) / (k * (n - 1)));
  const double a = 2 / (9 * (n - k)), b = 2 / (9 * k);
  return (1 - a) * root - (1 - b) > sigmas * std::sqrt(a * root * root + b);
}

// Scatter of the photos' scores at the optimum of H and g, a step away: no rendering.
Eigen::MatrixXd scatter_by_view(const ViewEquations& e, const Eigen::VectorXd& step) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(step.size(), step.size());
  const auto views = static_cast<double>(e.H.size());
  for (std::size_t k = 0; k < e.H.size(); ++k) {
    const Eigen::VectorXd score = e.g[k] + e.H[k] * step;
    out += views / (views - 1) * score * score.transpose();
  }
  return out;
}

// Tests the terms `added` against the model's own errors, which are alike in all photos of a place and in all places of
// a photo. The scores are taken at the richer field's own optimum: its explained part is not scatter.
enum class Asked { no, by_places_only, yes };

Asked significance(const Problem& data, const Stage& all, const State& state, const ViewEquations& e,
                   const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const std::vector<bool>& free,
                   const std::vector<Eigen::Index>& added) {
  const Eigen::MatrixXd inverse = safe_inverse(H, free);
  const Eigen::VectorXd step = -inverse * g;
  const bool size = added.front() > kPaperIndex, glare = added.front() == unknown::glare_share;
  const bool little_glare = added.size() == 1 && glare && step[unknown::glare_share] < kMadeUpGlare;
  const double sigmas = added.size() > 2                       ? kOnceInAMillion
                        : added.size() == 1 && (size || glare) ? kTwiceInTenThousand
                                                               : kOnceInTenThousand;
  const auto beyond = [&](const Eigen::MatrixXd& scatter, std::size_t samples, double bar) {
    const Eigen::MatrixXd covariance = inverse * (scatter + e.prior_scatter) * inverse;
    return beyond_chance(chi_squared(step(added), covariance(added, added)), added.size(), samples, bar);
  };
  // Photos are few: their scatter cannot prove several terms, but it may contradict them.
  constexpr std::size_t kKnown = 1000;
  // Photos of an area light take many times as long to render: test them only if photos do not contradict already.
  if (size && !beyond(scatter_by_view(e, step), kKnown, sigmas)) return Asked::no;
  State optimum = moved_state(state, step);
  // poorly constrained unknowns move far, and cannot be rendered beyond their bounds
  keep_within_bounds(data, optimum);
  const ViewEquations at_optimum = view_equations(data, all, optimum);
  std::size_t places = 0;
  for (Eigen::Index t = 0; t < at_optimum.tiles.cols(); ++t)
    if (at_optimum.tiles(unknown::log_alpha, t) != 0) ++places;
  if (!beyond(at_optimum.tiles * at_optimum.tiles.transpose(), places, little_glare ? kLittleGlareByPlace : sigmas))
    return Asked::no;
  const Eigen::MatrixXd by_view = scatter_by_view(at_optimum, Eigen::VectorXd::Zero(H.rows()));
  if (beyond(by_view, kKnown, little_glare ? kLittleGlareByView : sigmas)) return Asked::yes;
  return little_glare ? Asked::no : Asked::by_places_only;
}

// The views' scores a step away: no rendering.
ViewEquations moved(ViewEquations e, const Eigen::VectorXd& step) {
  for (std::size_t k = 0; k < e.H.size(); ++k) e.g[k] += e.H[k] * step;
  return e;
}

constexpr FreeField kGlare{false, false, false, true}, kSize{false, false, false, false, true};

FreeField both(const FreeField& a, const FreeField& b) {
  return {a.linear || b.linear, a.quadratic || b.quadratic, a.wear || b.wear, a.glare || b.glare, a.size || b.size};
}

// True if a step gives any lamp a size above 0.
bool grows(const State& state, const Eigen::VectorXd& step) {
  for (std::size_t light = 0; light < state.lamps.size(); ++light)
    if (state.block(unknown::size2, light)[0] + step[global_index(unknown::size2, light)] > 0) return true;
  return false;
}

}  // namespace

FreeField freed_by(const Stage& stage) {
  return {stage.frees(Group::depth_linear), stage.frees(Group::depth_quadratic), stage.frees(Group::depth_wear),
          stage.frees(Group::glare), stage.frees(Group::lamp_size)};
}

int terms_of(const FreeField& f) {
  return (f.linear ? 2 : 0) + (f.quadratic ? 3 : 0) + (f.wear ? 1 : 0) + (f.glare ? 1 : 0) + (f.size ? 1 : 0);
}

FreeField choose_depth_field(const Problem& data, const Stage& stage, const State& state,
                             std::vector<Eigen::VectorXd>* shifts) {
  Stage all = stage;
  const bool any_size =
      std::any_of(data.size_sought.begin(), data.size_sought.end(), [](bool sought) { return sought; });
  all.free({true, true, true, true, any_size});
  const std::size_t lights = state.lamps.size();
  const ViewEquations equations = view_equations(data, all, state);
  FreeField choice = freed_by(stage);
  const std::size_t views = equations.H.size();
  constexpr std::size_t kFewest = 4;
  if (views < kFewest) return choice;
  Eigen::MatrixXd H = equations.prior_information;
  Eigen::VectorXd g = equations.prior_g;
  for (std::size_t k = 0; k < views; ++k) {
    H += equations.H[k];
    g += equations.g[k];
  }
  const auto free_with = [&](const FreeField& field) {
    std::vector<bool> free = equations.free;
    set_free(field, lights, free);
    return free;
  };
  // The optimum with this field, to first order.
  const auto optimum = [&](const FreeField& field) -> Eigen::VectorXd {
    return -safe_inverse(H, free_with(field)) * g;
  };
  // A lamp's size and glare mask each other: a disk dims the center of a glint, glare brightens dark places. A size is
  // therefore tested together with its glare, accepted or not.
  const auto beside_a_size = [&](const FreeField& field) {
    const FreeField with_glare = both(field, kGlare);
    return optimum(both(with_glare, kSize))[unknown::glare_share] > kLeastShare ? with_glare : field;
  };
  // of the last round, all terms together: accepted by held-out photos and by places, but with too much scatter between
  // photos
  FreeField pointed_to;
  for (bool stepped = true; stepped;) {
    stepped = false;
    pointed_to = {};
    FreeField best = choice;
    double best_gain = 0;
    for (const FreeField& more :
         {FreeField{true, false, false}, FreeField{true, true, false}, FreeField{false, false, true}, kGlare, kSize}) {
      const FreeField trial = both(choice, more);
      if (terms_of(trial) == terms_of(choice)) continue;
      const FreeField beside = more.size ? beside_a_size(choice) : choice;
      const std::vector<bool> others = free_with(beside), trial_free = free_with(both(trial, beside));
      std::vector<Eigen::Index> added;
      for (std::size_t i = 0; i < trial_free.size(); ++i)
        if (trial_free[i] && !others[i]) added.push_back(static_cast<Eigen::Index>(i));
      if (added.empty()) continue;  // no lamp whose size is sought
      const Eigen::VectorXd answer = optimum(both(trial, beside)), from = optimum(beside);
      if (more.size && !grows(state, answer)) continue;
      const Gain gain = gain_of(held_out_gains(moved(equations, from), H, g + H * from, others, added));
      if (!(gain.sum > gain.standard_error) || !(gain.sum > best_gain)) continue;
      if (trial.glare && !(answer[unknown::glare_share] > kLeastShare)) continue;
      const Asked asked = significance(data, all, state, equations, H, g, trial_free, added);
      if (asked == Asked::by_places_only) pointed_to = both(pointed_to, trial);
      if (asked != Asked::yes) continue;
      best = trial;
      best_gain = gain.sum;
      stepped = true;
    }
    choice = best;
  }
  if (shifts == nullptr) return choice;
  // For rejected terms: the change of the answer with them.
  const auto add_shift = [&](const FreeField& from, const FreeField& more) {
    if (free_with(both(from, more)) == free_with(from)) return;
    const Eigen::VectorXd answer = optimum(both(from, more));
    if (!more.size || grows(state, answer)) shifts->push_back(answer - optimum(from));
  };
  if (!choice.size) add_shift(beside_a_size(choice), kSize);
  pointed_to.size = false;  // counted above
  if (terms_of(pointed_to) > 0) add_shift(choice, pointed_to);
  return choice;
}

}  // namespace burin
