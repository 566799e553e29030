#include "burin/calib/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/median.h"
#include "burin/calib/light/lamp.h"
#include "burin/calib/light/lamp_model.h"
#include "burin/calib/light/light_samples.h"
#include "burin/calib/light/photo_faults.h"
#include "burin/calib/photo/bench_unknowns.h"
#include "burin/calib/photo/crossing_choice.h"
#include "burin/calib/photo/effect_choice.h"
#include "burin/calib/photo/field_choice.h"
#include "burin/calib/photo/glare_fit.h"
#include "burin/calib/photo/held_out_gains.h"
#include "burin/calib/photo/lamp_size_choice.h"
#include "burin/calib/photo/normal_system.h"
#include "burin/calib/photo/photo_fit.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/photo/photo_weights.h"
#include "burin/calib/photo/spot_choice.h"
#include "burin/calib/photo/strange_regions.h"
#include "burin/calib/photo/stray_light_choice.h"
#include "burin/calib/verdict/at_bounds.h"
#include "burin/calib/verdict/effect_findings.h"
#include "burin/calib/verdict/green_alone.h"
#include "burin/calib/verdict/groove_agreement.h"
#include "burin/calib/verdict/model_tests.h"
#include "burin/calib/verdict/next_photo.h"
#include "burin/calib/verdict/odd_photos.h"
#include "burin/calib/verdict/photo_uncertainty.h"
#include "burin/calib/verdict/refine_result.h"
#include "burin/scene/board_face.h"
#include "burin/scene/parameter_name.h"

namespace burin {

namespace {

// Pieces of grooves that are cut where they cross: photos of a few times as many take minutes at each step, and tell
// hardly more.
constexpr double kMostLookedAt = 100'000;

// One refinement on its way: what is known so far, and the stages that lead to its end, in the order of kStages.
struct RefineRun {
  std::span<const MergedView> merged;
  const Board& board;
  const Sent& sent;
  const RefineOptions& options;
  const Progress& progress;
  std::span<const Light> given;  // the bench's, before any photo was looked at
  Refinement out{};

  std::vector<LightView> views{};
  Problem data{};
  std::vector<Eigen::VectorXd> pointed_to{};  // by what photos neither ask for nor exclude: a lamp's size, a reach
  std::vector<Eigen::VectorXd> to_spots{};    // by spots that photos point to so, when they were asked last
  Eigen::VectorXd burr_trade{};               // ProfileChoice::trade
  ScrewPower screw_power{0, 0};               // of the screws that were found
  std::vector<Eigen::Vector3d> by_tags_mm{};  // the cameras as calibrate had them, where lenses differ
  std::optional<Uncertainty> uncertainty{};   // of the state that the run ends with, if known
  State state{};
  Bins bins{};
  bool told_crowded = false;  // choose_crossings() did
  Stage stage{};

  void tell(const char* what, double fraction) const {
    if (progress) progress(what, fraction);
  }
  // A machine that has backlash is worn.
  double least_screw_power() const { return stage.frees(Group::backlash) ? kScrewPowerOfWorn : kScrewPower; }

  double blur_px() const { return std::exp(state.shared[unknown::log_blur]); }

  void look_at_photos(int bin) {
    data.photos = photos_at(views, bin, board, out.bench, blur_px());
    data.model.sample = {};
    if (data.model.cut.lanes == 0) sample_what_is_cut();
  }

  // In the end; until then a sample of what is cut into pieces does.
  bool comes_in_lanes() const { return data.model.crossings != Crossings::add && !data.surroundings; }
  Bins find_bins() const {
    const double finest_mm = options.finest_pixel_mm.value_or(comes_in_lanes() ? kCutPixelMm : kPixelMm);
    return bins_for(views, out.bench, finest_mm, options.max_pixels);
  }
  // Grooves that are cut into pieces, in as many steps as they crowd.
  int finest_steps() const {
    if (data.model.crossings != Crossings::deepest || comes_in_lanes()) return kCrossingSteps;
    return crossing_steps_for(covered_share(data.model, state.of(0)));
  }
  // All of the board, where grooves are in lanes.
  void look_at_finest() {
    data.model.cut = {finest_steps(), comes_in_lanes() ? kLanes : 0};
    look_at_photos(bins.finest);
  }

  // Lights of grooves that add are quickly rendered.
  void sample_what_is_cut() {
    if (data.model.crossings != Crossings::add) look_at_sample(kMostLookedAt, state, data);
  }

  // Of lamps that no person told it of; where it was found before, it is sought on.
  void seek_sizes() {
    if (stage.frees(Group::lamp_size)) return;
    for (std::size_t i = 0; i < data.size_sought.size(); ++i) data.size_sought[i] = out.bench.lights[i].size.is_point();
  }

  void require_pixels() const {
    std::size_t used = 0;
    for (const PhotoData& photo : data.photos)
      used += std::count_if(photo.weight.begin(), photo.weight.end(), [](float w) { return w > 0; });
    constexpr std::size_t kFewest = 1000;
    if (used < kFewest)
      fail("session", "hardly a pixel of bare metal is seen unclipped",
           "add shorter exposures, or photos nearer to the board and in focus");
  }

  void fit(int max_iterations, double tolerance, const std::string& name) {
    light_around(state, data);
    weigh_photos(data, state);
    solve(data, stage, max_iterations, tolerance, state, progress, name);
  }

  // Grooves that cover a binned pixel more than once in places, and less in others, send more than it foretells: on a
  // board that is half covered, as designs are, coarse pixels asked for lamps that nobody named and for burrs. So what
  // finer ones foretell is counted before anything is asked.
  void count_some_fine_pixels() {
    constexpr std::size_t kSome = 500'000;
    light_around(state, data);
    correct_binning(data, views, board, out.bench, state, kSome);
  }
  void fit_before_asking(double tolerance, const std::string& name) {
    count_some_fine_pixels();
    fit(options.max_iterations, tolerance, name);
  }

  // Photos weighed by what their pixels miss, and by how grooves differ.
  void fit_with_own_errors(const std::string& name) {
    weigh_photos_and_grooves(data, state);
    solve(data, stage, options.max_iterations, 3e-6, state, progress, name);
  }

  // Binned pixels are quick but not quite what the camera saw: the difference to the photo's own pixels is taken at the
  // solution and held while the fit goes on.
  void fit_corrected(const std::string& name) {
    require_pixels();
    light_around(state, data);
    correct_binning(data, views, board, out.bench, state);
    fit_with_own_errors(name);
  }

  // That difference takes as long as the fit: where move_geometry() takes it again, as it was will do.
  void fit_before_geometry(const std::string& name) {
    if (!options.fit_geometry) return fit_corrected(name);
    light_around(state, data);
    fit_with_own_errors(name);
  }

  // Cameras, bow and lens take one step with all others; where lenses differ they move so far that they take some.
  void move_geometry() {
    constexpr int kMostSteps = 4;
    constexpr double kNear_mm = 0.05;
    for (int step = 0; step < (out.bench.lens_scatter ? kMostSteps : 1); ++step) {
      const std::vector<View> before = out.bench.views;
      joint_step(data, stage, state, out.bench);
      take_lenses(out.bench, data.merged_bin, views);
      look_at_finest();
      fit_corrected("fitting photos, cameras, lens and bow");
      double most_mm = 0;
      for (std::size_t v = 0; v < before.size(); ++v)
        most_mm = std::max(most_mm, (out.bench.views[v].T_camera_board.inverse().translation() -
                                     before[v].T_camera_board.inverse().translation())
                                        .norm());
      if (most_mm < kNear_mm) break;
    }
  }

  void find_lamp();
  void try_grooves();
  void fit_coarse();
  bool explained_by_crossings(Problem found, const State& state_found);
  void find_large_lamps();
  void choose_crossings();
  void fit_middle();
  void refuse_other_grooves(const std::string& seen) const;
  std::string missing_in(const std::vector<std::size_t>& photos) const;
  void refuse_another_board();
  void compare_grooves();
  void compare_finest_grooves();
  void drop_spots();
  void find_spots();
  void drop_stray();
  void drop_faint_grain();
  void find_effects();
  bool may_have_another_section() const;
  std::optional<double> take_profile();
  void find_profile();
  void fit_finest();
  void leave_out_what_lies_on_the_board();
  void free_geometry();
  void free_depth_field();
  bool find_sides_of_lamps();
  void glare_at(const Glare& glare);
  void shape_glare();
  void find_stray();
  bool explained_by_profile(const std::vector<StrayNumbers>& places);
  void doubt_profile();
  void admit_what_machines_hide();
  void ask_of_believed_depth();
  void doubt_colors();
  void doubt_tones();
  void count_own_lenses();
  double depth_off_by_steps() const;
  void judge();
};

// From paper and plain face: lamps, ambient light, vignetting, roughness of the face; from the board: what is believed
// of the grooves.
void RefineRun::find_lamp() {
  tell("finding the lamp", 0);
  if (options.fit_lamp && options.fit_fields)
    for (Light& light : out.bench.lights)  // what photos told before, they shall tell again
      if (light.size.is_measured()) light.size = {};
  const std::vector<LightSample> samples = gather_light_samples(views, board, out.bench, sent);
  const LampSeed seed = fit_lamps(samples, board, out.bench);
  append(out.findings, seed.findings);
  Bench start = out.bench;
  start.material = board.material;
  start.depth_field = start.alpha_field = {};
  start.machine_errors = {};
  out.bench.material.profile = board.material.profile;  // what a person has seen decides
  start.sensor.vignette.setZero();
  start.sensor.glare = {};  // found anew
  start.stray = seed.stray;
  if (seed.found) {
    start.material.base_alpha = seed.base_alpha;
    start.material.grain = seed.grain;
    if (!seed.grain.none()) stage.free(Group::grain);
    if (seed.stray) stage.free(Group::stray);
    start.paper = out.bench.paper = seed.paper;
    start.ambient.setConstant(seed.ambient);
    start.sensor.vignette = seed.vignette;
    if (options.fit_lamp) start.lights = seed.lights;
    for (std::size_t i = 0; i < start.lights.size(); ++i) start.lights[i].intensity = seed.lights[i].intensity;
  }
  data = make_problem(board, sent, start);
  data.size_sought.assign(data.size_sought.size(), false);  // sought only later; one that is kept is as given
  data.merged_bin = merged.front().bin;
  data.surroundings = views.front().surroundings;
  for (const LightSample& sample : samples)
    if (sample.kind != SampleKind::face && sample.value > 0) data.paper.push_back(sample);
  state = state_of(start, data);
  if (data.surroundings) state.shared[unknown::ambient] = seed.found ? seed.ambient : 1;
}

// A grid of starts over alpha and depth: what is believed of them may be off by factors.
void RefineRun::try_grooves() {
  bins = find_bins();
  out.bin = bins.finest;
  look_at_photos(bins.coarse);
  light_around(state, data);
  require_pixels();
  for (PhotoData& photo : data.photos)
    for (std::size_t i = 0; i < photo.weight.size(); ++i)
      if (photo.weight[i] > 0)
        photo.weight[i] = 1 / std::hypot(photo.photo.sigma.data[i], 0.2F * photo.photo.value.data[i]);
  const std::size_t stride = 1 + (data.photos.size() - 1) / 5;
  State best = state;
  double best_cost = -1;
  const std::array<double, 5> alphas{0.02, 0.04, 0.08, 0.15, 0.3};
  const std::array<double, 4> depth_factors{0.4, 0.8, 1.5, 3};
  int tried = 0;
  for (const double alpha : alphas)
    for (const double factor : depth_factors) {
      State candidate = state;
      candidate.shared[unknown::log_alpha] = std::log(alpha);
      candidate.shared[unknown::log_depth] = std::log(factor * board.material.depth_um);
      const double cost = cost_of(data, candidate, stride);
      if (best_cost < 0 || cost < best_cost) {
        best_cost = cost;
        best = candidate;
      }
      tell("trying roughness and depth", static_cast<double>(++tried) / (alphas.size() * depth_factors.size()));
    }
  state = best;
}

void RefineRun::fit_coarse() {
  stage.free(Group::lamp, options.fit_lamp).free(Group::machine, false);
  fit(6, 1e-3, "fitting coarse photos");
  stage.free(Group::machine);
  fit(options.max_iterations, 1e-4, "fitting coarse photos and the machine");
  fit_before_asking(1e-4, "fitting coarse photos and the machine");
}

// Grooves of a crowded board that cut one another, rendered as if their light added, look like lamps that there are
// not. Whether they explain photos better than what was `found` beside grooves that add: then they are taken, and the
// fit stands with them; else all stays as it was.
bool RefineRun::explained_by_crossings(Problem found, const State& state_found) {
  if (options.crossings || data.model.crossings != Crossings::add || expected_pieces(data.model) > kMostPieces)
    return false;
  const Problem problem_before = data;
  const State state_before = state;
  choose_crossings();
  if (data.model.crossings != Crossings::add) {
    fit_before_asking(1e-4, "fitting coarse photos of grooves that cut one another");
    for (std::size_t k = 0; k < found.photos.size(); ++k) found.photos[k].weight = data.photos[k].weight;
    if (cost_of(data, state, 1) < cost_of(found, state_found, 1)) return true;
  }
  data = problem_before;
  state = state_before;
  out.bench.crossings = data.model.crossings;
  return false;
}

// Asked for before all else: under a panel or a softbox that is taken for a point, roughnesses and the lamp's place are
// others, and its highlight is drawn out like a brushed face's.
void RefineRun::find_large_lamps() {
  if (!options.fit_lamp || !options.fit_fields) return;
  tell("asking for the lamp's size", 0);
  seek_sizes();
  weigh_photos(data, state);
  const auto find = [&] {
    Stage stage_with = stage;
    State state_with = state;
    if (!choose_large_lamps(data, stage_with, state_with, progress)) return false;
    if (explained_by_crossings(data, state_with)) return choose_large_lamps(data, stage, state, progress);
    stage = stage_with;
    state = std::move(state_with);
    return true;
  };
  if (!find()) {
    data.size_sought.assign(data.size_sought.size(), false);
    return;
  }
  // Large lamps send less to the side. Which part of them shines brightest on a place shifts with that as with their
  // distance: held where paper did not tell it, and all that another fall-off would move is in the sigmas.
  for (std::size_t light = 0; light < state.lamps.size(); ++light) {
    if (data.is_spot[light]) continue;
    data.is_spot[light] = data.spot_held[light] = true;
    state.block(unknown::spot, light)[2] = kPlaneExponent;
  }
  fit(options.max_iterations, 1e-4, "fitting coarse photos and the lamp's size");
  if (std::find(data.spot_held.begin(), data.spot_held.end(), true) == data.spot_held.end()) return;
  constexpr int kIterations = 6;
  State other = state;
  for (std::size_t light = 0; light < state.lamps.size(); ++light)
    if (data.spot_held[light]) other.block(unknown::spot, light)[2] += kPlaneExponentSigma;
  solve(data, stage, kIterations, 1e-4, other, progress, "how far the lamp's fall-off moves the answer");
  pointed_to.push_back(step_between(state, other));
}

// Where scratches cross: whichever explains the photos best, unless it was asked for.
void RefineRun::choose_crossings() {
  data.model.crossings = options.crossings.value_or(Crossings::add);
  const bool crowded = expected_pieces(data.model) > kMostPieces;
  if (crowded && data.model.crossings != Crossings::add)
    fail("--crossings", "asks for grooves to be cut where they cross, which is too often here",
         "leave it out, or measure metal and tool by a board with fewer scratches");
  if (crowded && !options.crossings) {
    if (!std::exchange(told_crowded, true))
      out.findings.push_back(make_warning(
          FindingCode::crossings_ignored,
          "scratches cross one another too often to be cut where they do, so their light was added there",
          "depth may be 5 % off by that; a board with fewer scratches, or `burin coupon`, measures metal and tool"));
  } else if (!options.crossings) {
    weigh_photos(data, state);
    CrossingChoice choice = burin::choose_crossings(data, stage, state, progress);
    data.model.crossings = choice.rule;
    state = std::move(choice.state);
  }
  bins.finest = find_bins().finest;
  out.bin = bins.finest;
  for (PhotoData& photo : data.photos) photo.correction.clear();  // it was another rule's
  out.bench.crossings = data.model.crossings;
  sample_what_is_cut();
}

void RefineRun::fit_middle() {
  if (bins.middle < bins.coarse) look_at_photos(bins.middle);
  stage.free(Group::blur);
  fit(options.max_iterations, 1e-5, "fitting binned photos");
  fit_before_asking(1e-5, "fitting binned photos");
}

// Photos of another board have tags that fit, and every number that is fitted to them is a phantom's.
void RefineRun::refuse_other_grooves(const std::string& seen) const {
  fail(board.scratches.empty() ? "the scratches" : board.scratches.string(),
       "the grooves in the photos are not the ones that it lists: are these photos of another board, or of another "
       "round? (" +
           seen + ")",
       "give the photos of the board that was carved from it, or name the scratches of the board that they show");
}

std::string RefineRun::missing_in(const std::vector<std::size_t>& photos) const {
  std::set<std::string> names;  // a view has a photo for each lamp
  for (const std::size_t k : photos) names.insert(out.bench.views[data.photos[k].photo.view].name);
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return counted(photos.size(), "photo") + ", of views " + list + ", show none of them at its place";
}

// After the first fit only a plain case is refused. The fits that follow would look for long in such photos.
void RefineRun::refuse_another_board() {
  constexpr double kPlainly = 0.25;  // medians: own boards share 0.86 or more after the first fit, others at most 0.1
  light_around(state, data);
  const std::vector<GrooveAgreement> agreements = groove_agreements(data, state);
  const std::vector<std::size_t> other = photos_of_other_grooves(agreements);
  if (2 * other.size() <= data.photos.size()) return;
  std::vector<double> shares;
  for (const std::size_t k : other) shares.push_back(agreements[k].share);
  if (median_of(std::move(shares)) < kPlainly) refuse_other_grooves(missing_in(other));
}

void RefineRun::compare_grooves() {
  tell("comparing grooves", 0);
  light_around(state, data);
  const std::vector<GrooveAgreement> agreements = groove_agreements(data, state);
  const std::vector<std::size_t> other = photos_of_other_grooves(agreements);
  if (other.empty()) return;
  const auto telling = static_cast<std::size_t>(
      std::count_if(agreements.begin(), agreements.end(), [](const GrooveAgreement& a) { return a.tells; }));
  if (2 * other.size() > telling) refuse_other_grooves(missing_in(other));
  for (const std::size_t k : other) {  // reported when it is known whether a lamp's move explains them
    const std::string& view = out.bench.views[data.photos[k].photo.view].name;
    if (std::find(out.other_grooves.begin(), out.other_grooves.end(), view) == out.other_grooves.end())
      out.other_grooves.push_back(view);
  }
}

// Runs when the fit predicts each groove's place to a part of a pixel. Before, a board of the same pictures looks like
// this one.
void RefineRun::compare_finest_grooves() {
  if (data.model.crossings != Crossings::add && data.model.cut.lanes == 0) return;  // only a sample is rendered
  tell("comparing single grooves", 0);
  const SingleGrooves seen = compare_single_grooves(data, views, out.bench, state);
  const std::string share = significant(seen.share, 2) + " +- " + significant(seen.sigma, 1);
  if (shows_other_grooves(seen))
    refuse_other_grooves("of what single grooves add to the pictures they show " + share + ", and own photos show 1");
  if (shows_these_grooves(seen)) return;
  out.findings.push_back(make_warning(
      FindingCode::board_unconfirmed,
      "the photos are too coarse to know the board by single grooves" +
          (seen.photos == 0 ? std::string() : ": they show " + share + " of what these add to the pictures") +
          "; photos of another board of the same pictures would make roughness and depth wrong",
      "make sure that they show the board that was carved from these scratches; nearer photos show single grooves"));
}

// A spot whose fall-off the photos do not show is a bare lamp: its aim and exponent would only trade with each other,
// and the aim, which nothing holds then, keep a lamp's size from what it is. A large lamp's matters however small it
// is.
void RefineRun::drop_spots() {
  if (any_large_lamp(data, state)) return;
  for (std::size_t light = 0; light < state.lamps.size(); ++light) {
    double* const spot = state.block(unknown::spot, light);
    if (!data.is_spot[light] || spot[2] > kLeastFalloff) continue;
    data.is_spot[light] = false;
    make_spot(board, 0, spot);
    fit(options.max_iterations, 1e-5, "fitting a bare lamp");
  }
}

// Asked for where all but cross-sections and the machine is known, and again when there is another cross-section.
void RefineRun::find_spots() {
  if (!options.fit_lamp) return;
  tell("asking whether lamps shine less to the side", 0);
  light_around(state, data);
  weigh_photos(data, state);
  to_spots.clear();
  if (choose_spots(stage, data, state, to_spots, progress))
    fit(options.max_iterations, 1e-5, "fitting the lamp's fall-off");
}

// A light that nobody named, of which finer pixels leave hardly any, or which they let graze the face: it explains
// nothing, and takes as long as a lamp.
void RefineRun::drop_stray() {
  constexpr double kLeastShare = 0.002;  // of the brightest lamp's, on the board's middle
  if (!data.has_stray) return;
  const Eigen::Vector2d half_mm = 0.5 * board.size_mm;
  double brightest = 0;
  for (std::size_t light = 0; light < state.lamps.size(); ++light) {
    const Eigen::Vector3d lamp_mm = Eigen::Vector3d::Map(state.block(unknown::lamp_position, light));
    brightest = std::max(brightest, std::exp(state.block(unknown::log_intensity, light)[0]) /
                                        (lamp_mm - Eigen::Vector3d(half_mm.x(), half_mm.y(), 0)).squaredNorm());
  }
  double& irradiance = state.block(unknown::stray_light)[0];
  if (irradiance > kLeastShare * brightest && !grazes(state.block(unknown::stray))) return;
  irradiance = 0;
  data.has_stray = false;
  stage.hold({Group::stray, Group::stray_size});
}

// A face whose roughnesses along and across differ by less than a hundredth is not brushed: what asks for so little is
// something else.
void RefineRun::drop_faint_grain() {
  constexpr double kLeastRatio = 1.01;
  double* const grain = state.block(unknown::grain);
  if (!stage.frees(Group::grain) || std::exp(2 * std::hypot(grain[0], grain[1])) > kLeastRatio) return;
  grain[0] = grain[1] = 0;
  stage.hold({Group::grain});
}

// Looked for where the fit stands without them. Backlash first: what it does to a groove is larger than what a screw
// does.
void RefineRun::find_effects() {
  if (!options.fit_effects) return;
  tell("asking whether machine, face and grooves are as believed", 0);
  const bool is_paper = data.model.profile.is_paper();  // else one was found already, or is believed
  if (is_paper) set_flanks_to_ask_for(data, state);
  const EffectEquations equations = effect_equations(data, stage, state, {Group::backlash, Group::grain, Group::flank});
  bool more = false;
  // Nothing else moves grooves by the way they go, so that views foresee hardly any backlash where there is none.
  constexpr Evidence kOfBacklash{9, 3};
  for (const Group group : {Group::backlash, Group::grain}) {
    if (!photos_ask_for(data, state, equations, group, group == Group::backlash ? kOfBacklash : Evidence{})) continue;
    stage.free(group);
    more = true;
  }
  const bool as_told = board.said.profile && data.model.profile == board.material.profile;  // else one was found
  const bool other_section =
      may_have_another_section() && (as_told || (is_paper && photos_ask_for(data, state, equations, Group::flank)));
  if (more) fit(options.max_iterations, 1e-5, "fitting backlash and the face's direction");
  drop_faint_grain();
  tell("asking whether the machine's screws are uneven", 0);
  for (int more_axes = 0; more_axes < 2; ++more_axes) {
    // One that is strong hides one that is weak.
    const ScrewPower power = start_screws(data, state, least_screw_power());
    if (!(power.maxCoeff() > 0)) break;
    screw_power += power;
    // Until their height is known, the photos hold no period: it would go anywhere.
    stage.free(Group::screw).hold({Group::screw_period});
    fit(options.max_iterations, 1e-4, "fitting the machine's screws");
    stage.free(Group::screw_period);
    fit(options.max_iterations, 1e-5, "fitting the machine's screws and their periods");
  }
  if (other_section) find_profile();
}

// Of a cross-section that a person saw, flanks are held, and burrs where they were seen. What surroundings send is held
// while a fit goes on, so they would light the believed grooves.
bool RefineRun::may_have_another_section() const {
  const GrooveProfile& seen = board.material.profile;
  return !data.surroundings && !seen.has_burrs();
}

// Photos ask for another cross-section than the paper's: which. (Of one that board.json gives: its burrs.) What it
// leaves of a sample (kMostTried); none where there is none.
std::optional<double> RefineRun::take_profile() {
  const auto tried = [&](const char* what, double share) { tell(what, share); };
  const ProfileChoice choice = choose_profile(data, stage, state, options.fit_fields, tried);
  if (choice.profile.is_paper()) return std::nullopt;
  for (PhotoData& photo : data.photos) photo.profile = choice.profile;
  data.model.profile = out.bench.material.profile = choice.profile;
  state = choice.state;
  burr_trade = choice.trade;
  for (const Group group : choice.free) stage.free(group);
  return choice.cost;
}

void RefineRun::find_profile() {
  if (!take_profile()) return;
  choose_crossings();  // anew: rims that are cut away and rims that never were look alike
  fit_before_asking(1e-5, "fitting the grooves' cross-section");
  find_spots();  // which another cross-section may have hidden
}

void RefineRun::fit_finest() {
  if (bins.finest < bins.middle || finest_steps() != data.model.cut.steps || comes_in_lanes()) {
    const bool finer = bins.finest < bins.middle;
    look_at_finest();
    if (finer) fit(options.max_iterations, 1e-5, "fitting photos");
  }
  fit_corrected("fitting photos with their own errors");
}

void RefineRun::leave_out_what_lies_on_the_board() {
  const std::vector<StrangeRegion> strange = strange_regions(data, state);
  if (strange.empty()) return;
  for (const StrangeRegion& region : strange) out.findings.push_back(told(region));
  leave_out(strange, data, views);
  look_at_finest();
  fit_corrected("fitting photos without what lies on the board");
}

void RefineRun::free_geometry() {
  if (!options.fit_geometry) return;
  data.geometry = geometry_prior(board, out.bench);
  if (out.bench.lens_scatter)
    for (const View& view : out.bench.views) by_tags_mm.emplace_back(view.T_camera_board.inverse().translation());
  move_geometry();
}

// Only now: what cameras, bow or lamp still had wrong would look like grooves that vary.
void RefineRun::free_depth_field() {
  if (!options.fit_fields) return;
  tell("asking whether depth varies, for glare and the lamp's size", 0);
  glare_at(usual_glare(out.bench.lens));
  if (options.fit_lamp) seek_sizes();
  const FreeField before = freed_by(stage);
  const FreeField field = choose_depth_field(data, stage, state, &pointed_to);
  stage.free(field);
  if (!field.size) data.size_sought.assign(data.size_sought.size(), false);
  if (field.glare) shape_glare();
  out.bench.verdict[parameter::kDepthField] = {
      Source::measured,
      Degree::determined,
      {},
      Unit::none,
      {{Cause::Kind::field_chosen, {field.linear ? 1.0 : 0.0, field.quadratic ? 1.0 : 0.0, field.wear ? 1.0 : 0.0}}}};
  const bool more = terms_of(field) != terms_of(before);
  if (more) fit_before_geometry("fitting photos and how grooves vary");
  if (!find_sides_of_lamps() && !more) return;
  if (options.fit_geometry) move_geometry();
}

// A lamp whose size was found as a disk's may be longer one way than the other. Whether one is.
bool RefineRun::find_sides_of_lamps() {
  if (!stage.frees(Group::lamp_size) || stage.frees(Group::lamp_sides)) return false;
  if (!choose_sides(data, stage, state, progress)) return false;
  fit_before_geometry("fitting photos and the lamp's sides");
  return true;
}

// All photos' light as glare of that shape would scatter it.
void RefineRun::glare_at(const Glare& glare) {
  out.bench.sensor.glare = {state.shared[unknown::glare_share], glare.core_px, glare.reach_px};
  add_scattered_light(merged, glare, views);
  for (std::size_t k = 0; k < views.size(); ++k)
    data.photos[k].photo.scattered = binned(views[k], data.photos[k].bin).scattered;
}

// The reach that explains the photos best, and how far the answer would move with one that views do not speak against
// more than they scatter; then paper, which the lamp is held by, without its glare.
void RefineRun::shape_glare() {
  struct Trial {
    Glare glare;
    State state;
    double cost = 0;
    std::vector<double> of_photos;
  };
  std::vector<Trial> trials;
  for (const Glare& glare : possible_glares(out.bench.lens)) {
    glare_at(glare);
    Trial trial{glare, state, 0, {}};
    trial.cost = solve(data, stage, 2, 1e-4, trial.state, progress, "how far glare reaches");
    trial.of_photos = costs_of_photos(data, trial.state);
    trials.push_back(std::move(trial));
  }
  const auto best =
      std::min_element(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) { return a.cost < b.cost; });
  constexpr double kAgainst = 2;  // standard errors
  for (auto other = trials.begin(); other != trials.end(); ++other) {
    const Gain gain = gain_between(other->of_photos, best->of_photos);
    if (other != best && !(gain.sum > kAgainst * gain.standard_error))
      pointed_to.push_back(step_between(best->state, other->state));
  }
  state = best->state;
  glare_at(best->glare);
  take_glare_from_paper(views, state.shared[unknown::glare_share], out.bench, data.paper);
}

// Light that nobody named. Asked for early: what it adds to grooves of some directions would else be taken for other
// roughness, for crossings, for a fall-off of the lamp.
void RefineRun::find_stray() {
  if (!options.fit_effects || data.surroundings || data.has_stray) return;
  // Tags alone leave cameras whose lenses differ millimeters off, which looks like a second lamp.
  if (options.fit_geometry && out.bench.lens_scatter) return;
  weigh_photos(data, state);
  const auto likely = [&] {
    if (data.model.crossings == Crossings::add) return likely_stray_lights(data, stage, state, progress);
    Problem seen = data;  // a hundred renderings
    look_at_sample(kMostTried, state, seen);
    return likely_stray_lights(seen, stage, state, progress);
  };
  std::vector<StrayNumbers> places = likely();
  if (places.empty()) return;
  glare_at(usual_glare(out.bench.lens));  // which might explain the same light
  Problem with = data;
  Stage stage_with = stage;
  State state_with = state;
  if (!fit_stray_light(places, with, stage_with, state_with, progress)) return;
  if (explained_by_crossings(with, state_with)) {
    places = likely();
    with = data;
    stage_with = stage;
    state_with = state;
    if (places.empty() || !fit_stray_light(places, with, stage_with, state_with, progress)) return;
  }
  if (explained_by_profile(places)) {
    fit_before_asking(1e-4, "fitting coarse photos and the grooves' cross-section");
    places = likely();
    if (places.empty() || !fit_stray_light(places, data, stage, state, progress)) return;
  } else {
    data = std::move(with);
    stage = stage_with;
    state = std::move(state_with);
  }
  fit(options.max_iterations, 1e-4, "fitting coarse photos and unnamed lights");
}

// Grooves of another cross-section send light where the paper's send none, too, and are commoner than lamps that nobody
// named: takes one if it leaves less of the photos than such a lamp does. Else all stays as it was, and cross-sections
// are asked for in their turn. Not under a large lamp, as in doubt_profile(): burrs were made up there.
bool RefineRun::explained_by_profile(const std::vector<StrayNumbers>& places) {
  if (!may_have_another_section() || !data.model.profile.is_paper() || any_large_lamp(data, state)) return false;
  const Problem problem_before = data;
  const Stage stage_before = stage;
  const State state_before = state;
  choose_crossings();  // rims that are cut away look like another cross-section
  count_some_fine_pixels();
  weigh_photos(data, state);
  Problem seen = data;
  const State crossed = state;
  const Stage stage_seen = look_at_sample(kMostTried, state, seen) ? stage_of_sample(stage) : stage;
  constexpr int kIterations = 8;  // as many as cross-sections are tried with
  if (const std::optional<double> cost = take_profile();
      cost && *cost < cost_with_stray(places, std::move(seen), stage_seen, crossed, kIterations, progress))
    return true;
  data = problem_before;
  stage = stage_before;
  state = state_before;
  out.bench.material.profile = data.model.profile;
  out.bench.crossings = data.model.crossings;
  burr_trade = {};
  return false;
}

// Burrs do not show by flanks, which is how photos are asked first: they do where pixels contradict each other by how
// far half vectors lean, beside the steepest wall or beside the face's highlight. A large lamp blurs what would tell
// one cross-section from another, and takes dozens of renderings for one: what contradicts is then left to the sigmas.
void RefineRun::doubt_profile() {
  if (!options.fit_effects || !may_have_another_section() || !data.model.profile.is_paper()) return;
  if (any_large_lamp(data, state)) return;
  tell("asking whether the model is enough", 0);
  light_around(state, data);
  uncertainty = uncertainty_of(data, stage, state);
  const std::vector<Misfit>& misfits = uncertainty->misfits;
  const auto by_lean = [](const Misfit& m) { return m.test == "across" || m.test == "highlight"; };
  if (std::none_of(misfits.begin(), misfits.end(), by_lean)) return;
  // In coarser pixels: a cross-section of its own takes many renderings, under a lamp with a size several times as
  // many. It shows by directions, not by details.
  std::vector<PhotoData> finest = std::exchange(data.photos, {});
  Problem at_finest = data;
  const bool with_size = std::find(data.size_sought.begin(), data.size_sought.end(), true) != data.size_sought.end() ||
                         std::any_of(out.bench.lights.begin(), out.bench.lights.end(),
                                     [](const Light& light) { return !light.size.is_point(); });
  data.model.cut = {};
  look_at_photos(with_size ? bins.coarse : bins.middle);
  count_some_fine_pixels();
  weigh_photos(data, state);
  find_profile();
  if (data.model.profile.is_paper()) {
    data = std::move(at_finest);
    data.photos = std::move(finest);
    return;
  }
  uncertainty.reset();
  look_at_finest();
  fit_corrected("fitting photos and the grooves' cross-section");
  if (options.fit_geometry) move_geometry();
  free_depth_field();  // anew: what another cross-section hid
}

// Where all grooves go the same way along an axis, nothing tells its backlash; and a screw that is not seen may still
// be as uneven as would just have been found, beside one that was. What is found is a micrometer or two off beyond what
// pixels scatter: on seven machines that are known backlash was off by 3.5 um, RMS, and screws by 0.9.
void RefineRun::admit_what_machines_hide() {
  constexpr double kUsualBacklash_mm = 0.1, kBacklashOff_mm = 0.002, kScrewOff_mm = 0.001;
  MachineErrors& errors = out.bench.machine_errors;
  const auto widen = [](std::optional<Eigen::Vector2d>& sigma_mm, double by_mm) {
    if (sigma_mm) *sigma_mm = (sigma_mm->array().square() + by_mm * by_mm).sqrt();
  };
  widen(errors.backlash_sigma_mm, kBacklashOff_mm);
  widen(errors.screw_sigma_mm, kScrewOff_mm);
  for (int axis = 0; axis < 2; ++axis) {
    if (errors.backlash_sigma_mm && !data.both_ways[axis]) {
      (*errors.backlash_sigma_mm)[axis] = kUsualBacklash_mm;
      if (auto& sigma = out.bench.machine_affine_sigma)  // grooves lie half of it beside
        (*sigma)(axis, 2) = std::hypot((*sigma)(axis, 2), kUsualBacklash_mm / 2);
    }
    if (errors.screw_sigma_mm && !data.uneven[axis])
      (*errors.screw_sigma_mm)[axis] =
          errors.screw_mm()[1 - axis] * std::sqrt(least_screw_power() / screw_power[1 - axis]);
  }
}

// A depth that the photos do not tell may still be refuted by them: grooves that glint beyond its cut-off. Then the
// next board is better designed for the depth that explains them, though nothing says how far it may be off. Refuted is
// what no other answer makes up for: all else is fitted again with the believed depth held.
void RefineRun::ask_of_believed_depth() {
  constexpr double kRefuted = 1.02;  // the cost of all photos together; what is merely not seen leaves it as it is
  constexpr int kIterations = 6;
  Verdict& verdict = out.bench.verdict[parameter::kDepth];
  if (verdict.known() || is_on_bound(data, state, unknown::log_depth)) return;
  const double fitted_um = out.bench.material.depth_um, believed_um = board.material.depth_um;
  const double cost_fitted = cost_of(data, state, 1);
  State believed = state;
  believed.shared[unknown::log_depth] = std::log(believed_um);
  if (!(cost_of(data, believed, 1) > kRefuted * cost_fitted)) return;
  Stage held = stage;
  held.hold({Group::depth});
  solve(data, held, kIterations, 1e-4, believed, progress, "asking what speaks against the believed depth");
  if (!(cost_of(data, believed, 1) > kRefuted * cost_fitted)) return;
  verdict.source = Source::measured;
  verdict.causes.push_back({Cause::Kind::believed_refuted, {believed_um}});
  out.findings.push_back(make_warning(
      FindingCode::parameter_undetermined,
      "the photos do not determine the depth, but they contradict the " + significant(believed_um, 3) +
          " um that board.json believes: " + significant(fitted_um, 3) + " um explain them better, and are taken",
      "its error is unknown: take the photo that would help most (bench.json, "
      "verdict.depth_um.next_photo) before another board is designed"));
}

// By how much of itself a depth may be off because grooves that cut one another are cut in steps: on boards that
// grooves would cover 0.5, 0.8 and 1.4 times it was 0.5, 1.2 and 2.1 % too shallow.
double RefineRun::depth_off_by_steps() const {
  constexpr double kSparse = 0.3, kOfSteps = 0.2;
  if (data.model.crossings != Crossings::deepest || data.model.cut.lanes > 0) return 0;
  const double crowded = covered_share(data.model, state.of(0)) - kSparse;
  return crowded > 0 ? kOfSteps * crowded / (2 * data.model.cut.steps) : 0;
}

// What a mosaic's made-up colors lost of glints is in all photos, so that nothing else contradicts it.
void RefineRun::doubt_colors() {
  if (out.bench.sensor.green_sites == GreenSites::unknown || merged.front().value.channels != 3) return;
  tell("asking what made-up colors do", 0);
  const Eigen::VectorXd& half = pointed_to.emplace_back(half_shift_by_green_alone(merged, views, data, stage, state));
  Misfit moved;
  set_percents(half, moved);
  if (std::max({std::abs(half[unknown::log_alpha]), std::abs(half[unknown::log_depth]),
                std::abs(half[unknown::log_base_alpha])}) < kLeastShift)
    return;
  out.findings.push_back(
      make_warning(FindingCode::camera_colors,
                   "the colors that the camera makes up do not hold all of fine glints' light: read by what it "
                   "measured alone, green, the photos would ask for another answer, by " +
                       significant(2 * moved.alpha_percent, 2) + " % in alpha, " +
                       significant(2 * moved.depth_percent, 2) + " % in depth and " +
                       significant(2 * moved.base_alpha_percent, 2) + " % in base_alpha; sigmas count half of that",
                   "raw files, or TIFF and PNG, keep what JPEG does not"));
}

// Tones that the camera mapped place by place: by how far photos and paper without them would move the answer.
void RefineRun::doubt_tones() {
  const std::optional<LocalTones> tones = find_local_tones(views, data.paper, out.bench);
  if (!tones) return;
  tell("asking what local tones do", 0);
  const auto without = [&](std::size_t k) {
    LightView view = views[k];
    const Image factor = without_local_tones(view, *tones);
    for (std::size_t i = 0; i < factor.data.size(); ++i) view.value.data[i] *= factor.data[i];
    return view;
  };
  pointed_to.push_back(
      shift_if_read_otherwise(without, without_local_tones(views, data.paper, *tones, out.bench), data, stage, state));
  out.findings.push_back(told(*tones));
}

// Lenses of views' own move far along what tags hardly tell, by slopes that leave out how content grows: cameras of
// three benches that are known ended up 7 to 23 % of their move off.
void RefineRun::count_own_lenses() {
  constexpr double kOfMove = 0.2;
  for (std::size_t v = 0; v < by_tags_mm.size(); ++v) {
    View& view = out.bench.views[v];
    const double off_mm = kOfMove * (view.T_camera_board.inverse().translation() - by_tags_mm[v]).norm();
    if (view.center_sigma_mm) view.center_sigma_mm = (view.center_sigma_mm->array().square() + off_mm * off_mm).sqrt();
  }
}

void RefineRun::judge() {
  compare_finest_grooves();
  tell("judging the result", 0);
  light_around(state, data);
  if (!uncertainty) uncertainty = uncertainty_of(data, stage, state);
  Uncertainty& judged_by = *uncertainty;
  if (const auto shift = shift_by_stray_size(data, stage, state)) pointed_to.push_back(*shift);
  doubt_colors();
  doubt_tones();
  judged_by.shifts.insert(judged_by.shifts.end(), pointed_to.begin(), pointed_to.end());
  judged_by.shifts.insert(judged_by.shifts.end(), to_spots.begin(), to_spots.end());
  if (burr_trade.size() > 0) {
    judged_by.shifts.push_back(burr_trade);
    for (const int i : {unknown::burrs, unknown::burrs + 1}) judged_by.shifts.back()[i] *= state.shared[i];
  }
  if (const double off = depth_off_by_steps(); off > 0) {
    judged_by.shifts.emplace_back(Eigen::VectorXd::Zero(global_count(state.lamps.size())));
    judged_by.shifts.back()[unknown::log_depth] = off;
  }
  const Carved carved = carved_at(data.model, state.of(0));
  for (std::size_t k = 0; k < data.photos.size(); ++k)
    out.photos.push_back(photo_fit(data, k, state, carved, out.bench));
  add_odd_photos(out.photos, judged_by);
  const Combinations judged = fill_bench(data, state, judged_by, stage, options.session, out);
  admit_what_machines_hide();
  count_own_lenses();
  // Photos that do not fit the others are findings themselves, and explain the weight.
  constexpr double kWorthTelling = 4;  // twice the weight
  if (data.geometry && data.geometry->weight > kWorthTelling && !std::ranges::any_of(out.bench.misfits, is_of_photo))
    out.findings.push_back(make_warning(
        FindingCode::model_misfit,
        "the scratches' pictures would move cameras and lens by more than the tags allow, as they do where the model "
        "misses something of metal, lamp or camera: the tags decide, with " +
            significant(std::sqrt(data.geometry->weight), 2) + " times the weight that their noise gives them",
        "the other diagnostics name possible causes"));
  append(out.findings, judge_bounds(data, stage, state, out.bench));
  ask_of_believed_depth();
  keep_believed(board, state, out.bench);
  out.correlations = correlations_of(data, judged_by, out.bench);
  append(out.findings, effect_findings(out.bench, board));
  advise_light(data, state, judged_by, judged, out.bench, progress);
  append(out.findings, keep_colors(given, fit_colors(data, merged, state, out.bench), out.bench));
  out.alpha_jitter = data.model.alpha_jitter;
  out.depth_jitter = data.model.depth_jitter;
  const auto scatter = [](double value, double square_sigma) {
    // The sigma of a square root, where it is not near zero.
    return Scatter{value, value > 0 ? std::optional(square_sigma / (2 * value)) : std::nullopt};
  };
  out.bench.alpha_scatter = scatter(data.model.alpha_jitter, data.model.alpha_jitter2_sigma);
  out.bench.depth_scatter = scatter(data.model.depth_jitter, data.model.depth_jitter2_sigma);
  out.slope_error = data.slope_error;
  out.model_error = median_of(data.photo_model_error);
  out.looked_at = share_of(data.model.sample, board);
}

// From rough and quick to fine: each stage starts where the one before ended.
constexpr std::array kStages{&RefineRun::find_lamp,
                             &RefineRun::try_grooves,
                             &RefineRun::fit_coarse,
                             &RefineRun::refuse_another_board,
                             &RefineRun::drop_spots,
                             &RefineRun::find_large_lamps,
                             &RefineRun::find_stray,
                             &RefineRun::choose_crossings,
                             &RefineRun::fit_middle,
                             &RefineRun::compare_grooves,
                             &RefineRun::drop_spots,
                             &RefineRun::find_spots,
                             &RefineRun::drop_stray,
                             &RefineRun::find_effects,
                             &RefineRun::fit_finest,
                             &RefineRun::drop_stray,
                             &RefineRun::leave_out_what_lies_on_the_board,
                             &RefineRun::free_geometry,
                             &RefineRun::free_depth_field,
                             &RefineRun::doubt_profile,
                             &RefineRun::judge};

}  // namespace

Refinement refine(std::span<const MergedView> merged, const Board& board, const Sent& sent, const Bench& measured,
                  const RefineOptions& options, const Progress& progress) {
  if (sent.size() == 0)
    fail("scratches", "there is no scratch to refine against", "name the designed scratches in board.json");
  RefineRun run{merged, board, sent, options, progress, measured.lights};
  run.out.bench = measured;
  run.out.bench.findings.clear();  // what an old file lacks is measured now
  run.views = make_light_views(merged, board, run.out.bench, run.out.findings);
  if (run.views.empty())
    fail("session", "no photo has both a camera pose and the board in it", "run burin calibrate on this session first");
  for (const auto stage : kStages) (run.*stage)();
  settle_bend(board, run.out.bench);
  return std::move(run.out);
}

std::vector<MergedView> photos_for_refine(const Session& session, const Board& board, const Bench& measured) {
  // Photos of many megapixels resolve far more than the fit uses, and would not fit into memory together.
  std::vector<double> tag_sides_px;
  for (const View& view : measured.views)
    for (const Tag& tag : board.tags.list)
      tag_sides_px.push_back(tag.size_mm * measured.lens.intrinsics[0] / view.T_camera_board.translation().norm());
  const int bin = light_bin(measured.lens.width, measured.lens.height, median_of(std::move(tag_sides_px)));
  // Poses move a little while photos are fitted, and glare looks twelve pixels around each pixel.
  constexpr int kMarginPx = 24;
  Session lit = with_camera(session, measured.sensor);
  for (Photo& photo : lit.photos)  // as calibrate found that they ride on the camera
    if (const std::string own = lamp_on_camera(photo.light, photo.view);
        std::ranges::find(measured.lights, own, &Light::id) != measured.lights.end())
      photo.light = own;
  return merge_session(lit, bin, [&](MergedView&& photo) {
    const auto view = std::ranges::find(measured.views, photo.view, &View::name);
    return cropped(std::move(photo),
                   view == measured.views.end() ? PixelWindow{} : board_window(board, measured, *view, bin, kMarginPx));
  });
}

Refinement refine(const Session& session, const Board& board, const Sent& sent, const Bench& measured,
                  const RefineOptions& options, const Progress& progress) {
  if (progress) progress("reading photos", 0);
  RefineOptions named = options;
  named.session = &session;
  return refine(photos_for_refine(session, board, measured), board, sent, measured, named, progress);
}

}  // namespace burin
