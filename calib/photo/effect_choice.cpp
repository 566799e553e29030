#include "burin/calib/photo/effect_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/effect_unknowns.h"
#include "burin/calib/photo/held_out_gains.h"
#include "burin/calib/photo/machine_map.h"
#include "burin/calib/photo/normal_system.h"
#include "burin/calib/photo/photo_fit.h"
#include "burin/scene/groove.h"

namespace burin {

EffectEquations effect_equations(const Problem& data, const Stage& stage, const State& state,
                                 std::initializer_list<Group> asked) {
  EffectEquations out{stage, stage, {}, {}, {}};
  for (const Group group : asked) out.all.free(group);
  out.views = view_equations(data, out.all, state);
  out.H = out.views.prior_information;
  out.g = out.views.prior_g;
  for (std::size_t k = 0; k < out.views.H.size(); ++k) {
    out.H += out.views.H[k];
    out.g += out.views.g[k];
  }
  return out;
}

namespace {

// The slope of the paper's groove at its rim.
double rim_deg(const Problem& data, const State& state) {
  const double rim = groove_rim(data.model.board->tool_width_um, std::exp(state.shared[unknown::log_depth]));
  return 2 * std::atan(rim) * 180 / std::numbers::pi;
}

}  // namespace

void set_flanks_to_ask_for(const Problem& data, State& state) {
  constexpr double kLessSteep = 0.7;
  state.shared[unknown::flank] = kLessSteep * rim_deg(data, state);
}

bool photos_ask_for(const Problem& data, const State& state, const EffectEquations& equations, Group group,
                    const Evidence& least) {
  const ViewEquations& e = equations.views;
  constexpr std::size_t kFewestViews = 3;
  if (e.H.size() < kFewestViews || equations.stage.frees(group)) return false;
  Stage with = equations.stage;
  with.free(group);
  const std::vector<bool> held = free_unknowns(data, equations.stage, state.lamps.size()),
                          free = free_unknowns(data, with, state.lamps.size());
  std::vector<Eigen::Index> added;
  for (std::size_t i = 0; i < free.size(); ++i)
    if (free[i] && !held[i]) added.push_back(static_cast<Eigen::Index>(i));
  const Gain gain = gain_of(held_out_gains(e, equations.H, equations.g, held, added));
  // An effect in few views (a flank's flash, in views at its angle) scatters as much as it gains.
  if (!(gain.sum > least.standard_errors * gain.standard_error)) return false;
  // Beyond the scatter between places of the board: scores by square, without the effect's part.
  const Eigen::MatrixXd inverse = safe_inverse(equations.H, free);
  const Eigen::VectorXd step = -inverse * equations.g;
  Eigen::MatrixXd scores = e.tiles;
  const auto tiles = static_cast<double>(scores.cols());
  scores.colwise() -= scores.rowwise().sum() / tiles;
  const Eigen::MatrixXd covariance = inverse * (scores * scores.transpose() + e.prior_scatter) * inverse;
  return chi_squared(step(added), covariance(added, added)) > least.chi2;
}

namespace {

// Scores of one groove piece's place along x and y, and its commanded place.
struct Pulls {
  std::vector<Eigen::Vector2d> place_mm, pull;
};

Pulls pulls_of(const Problem& data, const State& state) {
  // Cut into pieces of a millimeter by a screw of this period with negligible error.
  constexpr double kPeriodMm = 8, kNothing = 1e-9;
  State cut = state;
  for (int axis = 0; axis < 2; ++axis) {
    if (data.uneven[axis]) continue;
    cut.shared[unknown::screw + 2 * axis] = kNothing;
    cut.shared[unknown::screw_period + axis] = std::log(kPeriodMm);
  }
  const Carved pieces = carved_pieces(data.model, cut.of(0));
  const std::size_t n = pieces.size();
  Pulls out;
  const MachineMap map = machine_map(state.shared);
  const Eigen::Matrix2d back = map.A.inverse();
  const Scratches& s = pieces.scratches;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d middle(0.5 * (s.x0_mm[i] + s.x1_mm[i]), 0.5 * (s.y0_mm[i] + s.y1_mm[i]));
    out.place_mm.emplace_back(data.model.center_mm + back * (middle - data.model.center_mm - map.shift_mm));
  }
  out.pull.assign(n, Eigen::Vector2d::Zero());
  // Every second photo of many: it suffices for a spectrum, and derivatives by every millimeter of groove are slow.
  constexpr std::size_t kMany = 8;
  const std::size_t stride = data.photos.size() >= kMany ? 2 : 1;
  std::vector<GrooveGradients> of_photos((data.photos.size() + stride - 1) / stride);
  each_photo(of_photos.size(), photos_at_once(data.model), [&](std::size_t k) {
    const PhotoData& photo = data.photos[k * stride];
    const Unknowns x = cut.of(photo.photo.light);
    const Image value = predict(data.model, photo, x, pieces);
    Image score(value.width, value.height, 1);
    const double c2 = data.model.cauchy * data.model.cauchy;
    for (std::size_t i = 0; i < value.data.size(); ++i) {
      if (!(photo.weight[i] > 0)) continue;
      const double weight = photo.weight[i],
                   r = weight * (photo.photo.value.data[i] - static_cast<double>(value.data[i]));
      score.data[i] = static_cast<float>(weight * r / (1 + r * r / c2));
    }
    of_photos[k] = std::move(groove_gradients(photo, x, pieces, {&score, 1}).front());
  });
  for (const GrooveGradients& one : of_photos)
    for (std::size_t i = 0; i < n; ++i) out.pull[i] += Eigen::Vector2d(one.by_x_mm[i], one.by_y_mm[i]);
  return out;
}

// The frequency (per mm) of the largest periodic pull, and its power over chance: |sum of pull exp(i 2 pi f place)|^2
// over its expectation for pulls without a period.
struct Peak {
  double frequency = 0, above_chance = 0;
};
Peak strongest_period(const Pulls& pulls, int axis, double extent_mm) {
  constexpr double kShortestMm = 1.5, kLongestMm = 25;
  const double step = 0.25 / extent_mm;
  const auto count = static_cast<std::size_t>((1 / kShortestMm - 1 / kLongestMm) / step);
  std::vector<double> real(count, 0), imaginary(count, 0);
  double expected = 0;
  for (std::size_t i = 0; i < pulls.pull.size(); ++i) {
    const double pull = pulls.pull[i][axis], place = pulls.place_mm[i][axis];
    expected += pull * pull;
    const double turn = 2 * std::numbers::pi * place, first = turn / kLongestMm, by = turn * step;
    double c = std::cos(first), s = std::sin(first);
    const double cb = std::cos(by), sb = std::sin(by);
    for (std::size_t f = 0; f < count; ++f) {
      real[f] += pull * c;
      imaginary[f] += pull * s;
      const double next = c * cb - s * sb;
      s = s * cb + c * sb;
      c = next;
    }
  }
  Peak out;
  for (std::size_t f = 0; f < count; ++f) {
    const double power = (real[f] * real[f] + imaginary[f] * imaginary[f]) / expected;
    if (power > out.above_chance) out = {1 / kLongestMm + step * static_cast<double>(f), power};
  }
  return out;
}

}  // namespace

ScrewPower start_screws(Problem& data, State& state, double least_power) {
  ScrewPower out(0, 0);
  if (data.uneven[0] && data.uneven[1]) return out;
  const Pulls pulls = pulls_of(data, state);
  if (pulls.pull.empty()) return out;
  const Board& board = *data.model.board;
  const Eigen::Vector2d extent = board.carve_max_mm - board.carve_min_mm;
  constexpr double kStartMm = 1e-4;
  for (int axis = 0; axis < 2; ++axis) {
    if (data.uneven[axis]) continue;
    const Peak peak = strongest_period(pulls, axis, extent[axis]);
    if (!(peak.above_chance > least_power)) continue;
    data.uneven[axis] = true;
    state.shared[unknown::screw_period + axis] = -std::log(peak.frequency);
    state.shared[unknown::screw + 2 * axis] = kStartMm;
    out[axis] = peak.above_chance;
  }
  return out;
}

namespace {

// Frees the profile's own numbers and fixes the others.
void use_profile(Problem& data, const GrooveProfile& profile) {
  data.model.profile = profile;
  for (PhotoData& photo : data.photos) photo.profile = profile;
}

void set_profile(Problem& data, const GrooveProfile& profile, State& state) {
  use_profile(data, profile);
  state.shared[unknown::flank] = profile.flank_deg;
  state.shared[unknown::burrs] = profile.burr_left_um;
  state.shared[unknown::burrs + 1] = profile.burr_right_um;
  state.shared[unknown::burr_width] = std::log(profile.burr_width_um);
  state.shared[unknown::log_across] = std::log(profile.across);
}

constexpr int kFirst = 3, kThen = 5, kToTheEnd = 12;  // iterations

struct Trial {
  GrooveProfile profile;
  State state;
  std::vector<Group> free;
  std::vector<double> costs;
  double cost = 0;
};

bool has(const Trial& trial, Group effect) {
  return std::find(trial.free.begin(), trial.free.end(), effect) != trial.free.end();
}

void add_costs(const Problem& data, Trial& trial) {
  trial.costs = costs_of_photos(data, trial.state);
  trial.cost = std::accumulate(trial.costs.begin(), trial.costs.end(), 0.0);
}

// Fits the trial's free groups. Known, expensive unknowns (a rendering each) are held. So is the blur, which coarse
// pixels do not show.
void fit_trial(Problem& data, Stage stage, int iterations, Trial& trial) {
  use_profile(data, trial.profile);
  for (const Group group : trial.free) stage.free(group);
  stage.hold({Group::backlash, Group::screw, Group::screw_period, Group::lamp_size, Group::lamp_sides, Group::blur});
  solve(data, stage, iterations, 1e-4, trial.state, {}, "");
  add_costs(data, trial);
}

// Fits a trial for a few iterations, and further if it then costs less than `less`: true effects pay from the start.
Trial tried(Problem& data, const Stage& stage, const State& from, const GrooveProfile& profile, std::vector<Group> free,
            const Trial* less = nullptr) {
  Trial out{profile, from, std::move(free), {}, 0};
  set_profile(data, profile, out.state);
  fit_trial(data, stage, kFirst, out);
  if (less != nullptr && out.cost < less->cost) fit_trial(data, stage, kThen, out);
  return out;
}

// True if `more` is better than `less` by far more than the scatter between views, and by a share beyond the gain of a
// few more parameters.
bool clearly_better(const Trial& more, const Trial& less) {
  const Gain gain = gain_between(less.costs, more.costs);
  constexpr double kShare = 0.03;
  return gain.sum > kShare * less.cost && gain.sum > gain.standard_error;
}

// Tries a rounded V in place of the paper's profile, and takes it if clearly better. Returns the flanks' slope.
double try_flanks(Problem& data, const Stage& stage, const std::function<void(const char*, double)>& told,
                  Trial& best) {
  std::vector<Trial> shapes;
  const std::array<double, 4> flanks{20, 26, 34, 45};
  for (std::size_t i = 0; i < flanks.size(); ++i) {
    told("trying other cross-sections", static_cast<double>(i) / 12);
    GrooveProfile v = best.profile;
    v.kind = GrooveProfile::Kind::rounded_v;
    v.flank_deg = flanks[i];
    shapes.push_back(tried(data, stage, best.state, v, {}));
  }
  const auto first =
      std::min_element(shapes.begin(), shapes.end(), [](const Trial& a, const Trial& b) { return a.cost < b.cost; });
  told("trying other cross-sections", 0.33);
  Trial v = tried(data, stage, first->state, first->profile, {Group::flank}, &best);
  v.profile = data.model.profile;
  const double flank_deg = v.state.shared[unknown::flank];
  if (clearly_better(v, best)) best = std::move(v);
  return flank_deg;
}

// If grooves end below the slope of their flanks, no data determine this slope: they are arcs.
void leave_flanks_out_of_arcs(const Problem& data, Trial& best) {
  constexpr double kHowMuchDeeper = 1.05;  // grooves vary
  const double depth_um = kHowMuchDeeper * std::exp(best.state.shared[unknown::log_depth]);
  if (!has(best, Group::flank) ||
      reaches_flanks(profile_of(best.profile, best.state.shared), data.model.board->tool_width_um, depth_um))
    return;
  best.state.shared[unknown::flank] = kSteepestFlank_deg;
  std::erase(best.free, Group::flank);
}

// A trial is implausible if a burr is higher than its groove is deep, or a groove is several times as rough one way as
// the other. Such a fit has another cause.
bool can_be(const Trial& trial) {
  constexpr double kMostAcross = 3;
  const auto& x = trial.state.shared;
  return std::max(x[unknown::burrs], x[unknown::burrs + 1]) < std::exp(x[unknown::log_depth]) &&
         std::abs(x[unknown::log_across]) < std::log(kMostAcross);
}

// Tries burrs from several heights, fits the best to the end, and takes them if clearly better. Burrs can reveal a
// hidden variation of depth over the board.
void try_burrs(Problem& data, const Stage& stage, bool may_vary, const std::function<void(const char*, double)>& told,
               Trial& best) {
  constexpr std::array<std::array<double, 2>, 2> kHeights_um{{{1.5, 0.75}, {0.75, 1.5}}};
  std::vector<Group> free = best.free;
  if (may_vary) free.push_back(Group::depth_linear);
  GrooveProfile profile = profile_of(best.profile, best.state.shared);
  const Trial without = tried(data, stage, best.state, profile, free);
  free.push_back(Group::burrs);
  std::vector<Trial> trials;
  for (std::size_t i = 0; i < kHeights_um.size(); ++i) {
    told("trying burrs", 0.4 + 0.06 * static_cast<double>(i));
    profile.burr_left_um = kHeights_um[i][0];
    profile.burr_right_um = kHeights_um[i][1];
    trials.push_back(tried(data, stage, best.state, profile, free));
  }
  Trial& more =
      *std::min_element(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) { return a.cost < b.cost; });
  if (more.cost < without.cost) fit_trial(data, stage, kThen, more);
  if (can_be(more) && clearly_better(more, without)) best = std::move(more);
}

// Tries different roughnesses across and along the groove, in addition to the present profile.
void try_across(Problem& data, const Stage& stage, const std::function<void(const char*, double)>& told, Trial& best) {
  told("trying roughness across grooves", 0.6);
  GrooveProfile profile = profile_of(best.profile, best.state.shared);
  profile.across = 1.1;
  std::vector<Group> free = best.free;
  free.push_back(Group::across);
  Trial more = tried(data, stage, best.state, profile, free, &best);
  if (can_be(more) && clearly_better(more, best)) best = std::move(more);
}

// A trial refitted without one of its effects.
Trial without(Problem& data, const Stage& stage, const Trial& from, Group effect) {
  GrooveProfile profile = profile_of(from.profile, from.state.shared);
  const GrooveProfile paper;
  if (effect == Group::flank) {
    profile.kind = paper.kind;
    profile.flank_deg = paper.flank_deg;
  } else if (effect == Group::burrs) {
    profile.burr_left_um = profile.burr_right_um = 0;
  } else {
    profile.across = 1;
  }
  std::vector<Group> free = from.free;
  std::erase(free, effect);
  Trial out = tried(data, stage, from.state, profile, std::move(free));
  fit_trial(data, stage, kThen, out);
  return out;
}

// True if a trial's last few parameters are worth keeping, for grooves unlike the paper's anyway.
bool worth_keeping(const Trial& more, const Trial& less) {
  constexpr double kShare = 0.01;
  return less.cost - more.cost > kShare * less.cost;
}

// A trial with its missing effects added at usual values, fitted to the end.
Trial with_all(Problem& data, const Stage& stage, const Trial& from, const std::vector<Group>& effects, bool may_vary,
               double flank_deg) {
  constexpr double kHeight_um = 0.75, kAcross = 1.2;
  GrooveProfile profile = profile_of(from.profile, from.state.shared);
  Trial out{profile, from.state, from.free, {}, 0};
  for (const Group effect : effects) {
    if (has(out, effect)) continue;
    out.free.push_back(effect);
    if (effect == Group::flank) {
      profile.kind = GrooveProfile::Kind::rounded_v;
      profile.flank_deg = flank_deg;
    } else if (effect == Group::burrs) {
      profile.burr_left_um = profile.burr_right_um = kHeight_um;
      if (may_vary && !has(out, Group::depth_linear)) out.free.push_back(Group::depth_linear);
    } else {
      profile.across = kAcross;
    }
  }
  out.profile = profile;
  set_profile(data, profile, out.state);
  fit_trial(data, stage, kToTheEnd, out);
  // A burr of height 0 hardly grows again, and photos hardly separate one burr from the other.
  constexpr double kNothing_um = 0.05;
  double* const burrs_um = out.state.block(unknown::burrs);
  if (!has(out, Group::burrs) || std::min(burrs_um[0], burrs_um[1]) > kNothing_um) return out;
  Trial even = out;
  std::fill_n(even.state.block(unknown::burrs), 2, std::max(kHeight_um / 2, (burrs_um[0] + burrs_um[1]) / 2));
  fit_trial(data, stage, kToTheEnd, even);
  return even.cost < out.cost ? even : out;
}

// Flanks, burrs and roughness across all spread light to other leans. Each alone absorbs the others and masks them, or
// explains nothing. All are therefore fitted together, and then superfluous ones are removed.
void try_all(Problem& data, const Stage& stage, bool may_vary, const Trial& bare, std::optional<double> flank_deg,
             const std::function<void(const char*, double)>& told, Trial& best) {
  constexpr double kBelowTheRim = 0.95;
  std::vector<Group> effects{Group::burrs, Group::across};
  if (flank_deg) effects.push_back(Group::flank);
  const double flank = std::min(flank_deg.value_or(0), kBelowTheRim * rim_deg(data, bare.state));
  told("trying all that a cross-section may have", 0.66);
  Trial all = with_all(data, stage, bare, effects, may_vary, flank);
  const bool is_other = !best.free.empty();
  if (is_other) {
    Trial further = with_all(data, stage, best, effects, may_vary, flank);
    if (!can_be(all) || further.cost < all.cost) all = std::move(further);
  }
  if (!can_be(all) || !(is_other ? worth_keeping(all, best) : clearly_better(all, best))) return;
  best = std::move(all);
  for (bool fewer = true; fewer;) {
    fewer = false;
    Trial fewest;
    for (const Group effect : effects) {
      if (!has(best, effect)) continue;
      told("trying less", 0.8);
      Trial less = without(data, stage, best, effect);
      if (!can_be(less) || worth_keeping(best, less) || (fewer && less.cost > fewest.cost)) continue;
      fewest = std::move(less);
      fewer = true;
    }
    if (fewer) best = std::move(fewest);
  }
}

}  // namespace

ProfileChoice choose_profile(const Problem& data, const Stage& stage, const State& state, bool may_vary,
                             const std::function<void(const char*, double)>& told) {
  constexpr std::size_t kFewestViews = 3;
  const GrooveProfile& paper = data.model.profile;
  if (data.photos.size() < kFewestViews) return {paper, state, 0, {}, {}};
  Problem seen = data;
  const bool all = !look_at_sample(kMostTried, state, seen);
  const Stage freed = all ? stage : stage_of_sample(stage);
  Trial best{paper, state, {}, {}, 0};
  set_profile(seen, paper, best.state);
  fit_trial(seen, freed, kToTheEnd, best);  // otherwise others would gain by its missing iterations
  const Trial bare = best;
  // Flanks from steep (an arc) to shallow, each fitted for a few iterations; then the best of them to the end.
  std::optional<double> flank_deg;
  if (paper.kind == GrooveProfile::Kind::paper) flank_deg = try_flanks(seen, freed, told, best);
  const auto without_burrs = best.state.shared;
  try_burrs(seen, freed, may_vary, told, best);
  try_across(seen, freed, told, best);
  try_all(seen, freed, may_vary, bare, flank_deg, told, best);
  Eigen::VectorXd trade;
  if (has(best, Group::burrs)) {
    trade.setZero(global_count(state.lamps.size()));
    // RMS errors on boards of known burrs: heights 0.32, depth 0.14 of its change by burrs (seven boards with burrs
    // alone). Depth was off some three percent beyond its other sigmas (nine boards with flanks, burrs and roughness
    // across).
    constexpr double kOfMoved = 0.3, kOfHeight = 0.3, kOfWidth = 0.2, kDepth = 0.03;
    for (const int i : {unknown::log_alpha, unknown::log_depth})
      trade[i] = kOfMoved * (best.state.shared[i] - without_burrs[i]);
    trade[unknown::log_depth] = std::copysign(std::hypot(trade[unknown::log_depth], kDepth), trade[unknown::log_depth]);
    for (const int i : {unknown::burrs, unknown::burrs + 1}) trade[i] = kOfHeight;
    trade[unknown::burr_width] = kOfWidth;
  }
  leave_flanks_out_of_arcs(seen, best);
  const GrooveProfile chosen = profile_of(best.profile, best.state.shared);
  set_profile(seen, chosen, best.state);
  if (all) return {chosen, best.state, best.cost, best.free, trade};
  State whole = state;  // with the sample's estimates
  constexpr std::array kOfGrooves{Group::groove, Group::depth, Group::flank, Group::burrs, Group::across};
  for_each_unknown([&](const UnknownRow& row, int first) {
    if (std::find(kOfGrooves.begin(), kOfGrooves.end(), row.group) != kOfGrooves.end())
      std::copy_n(best.state.block(first), row.size, whole.block(first));
  });
  return {chosen, whole, best.cost, best.free, trade};
}

}  // namespace burin
