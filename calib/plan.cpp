#include "burin/calib/plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <string_view>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/median.h"
#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/bench_unknowns.h"
#include "burin/calib/photo/machine_map.h"
#include "burin/calib/verdict/candidate_photo.h"
#include "burin/calib/verdict/half_samples.h"
#include "burin/calib/verdict/planned_tags.h"
#include "burin/scene/board_face.h"
#include "burin/scene/parameter_name.h"

namespace burin {
namespace {

// Priors before the first photo, as sigmas: of logarithms, mm, or shares.
constexpr double kBelievedLog = 1;           // roughness, blur: a factor of e
constexpr double kBelievedIntensityLog = 3;  // a sensor's gain is unknown
constexpr double kBelievedScale = 0.005;     // the machine's scales, skew and turn
constexpr double kBelievedShift_mm = 1;
constexpr double kBelievedLampShare = 0.3;  // of its distance
constexpr double kBelievedExponent = 10;
constexpr double kBelievedAmbientShare = 0.5;  // of the lamp's light on paper

// A parameter's sigma, as the root mean square, or the largest, over some linear combinations.
struct Measure {
  PlanParameter parameter;
  bool of_light = false;
  bool worst = false;
  std::vector<Eigen::VectorXd> rows;  // scaled to the parameter's unit
  int lamp = -1;                      // of a proposed lamp: its position is no goal

  double sigma(const Eigen::MatrixXd& covariance) const {
    double out = 0;
    for (const Eigen::VectorXd& a : rows) {
      const double variance = std::max(0.0, a.dot(covariance * a));
      out = worst ? std::max(out, variance) : out + variance / static_cast<double>(rows.size());
    }
    return std::min(parameter.before, std::sqrt(out));
  }
};

double worth(double sigma, double goal) { return std::log(sigma * sigma + goal * goal); }

std::vector<Measure> geometry_measures(const BundleEquations& e, const Lens& lens, const Board& board,
                                       const BundleOptions& options) {
  const auto unit = [&](int at, double by) { return Eigen::VectorXd(by * Eigen::VectorXd::Unit(e.columns, at)); };
  std::vector<Measure> out;
  if (e.lens_at >= 0) {
    const double longer = std::max(lens.width, lens.height);
    out.push_back({{parameter::kLensFocal, Unit::percent, 0.05, 100},
                   false,
                   true,
                   {unit(e.lens_at, 100 / lens.intrinsics[0]), unit(e.lens_at + 1, 100 / lens.intrinsics[1])}});
    out.push_back({{parameter::kLensCenter, Unit::px, 5e-4 * longer, 0.1 * longer},
                   false,
                   true,
                   {unit(e.lens_at + 2, 1), unit(e.lens_at + 3, 1)}});
  }
  Measure tags{{parameter::kTags, Unit::mm, 0.01, std::max(1e-4, board.tags.sigma_mm)}, false, false, {}};
  for (const int at : e.tag_at)
    for (int i = 0; at >= 0 && i < 2; ++i) tags.rows.push_back(unit(at + i, 1));
  if (!tags.rows.empty()) out.push_back(tags);
  if (e.shared_at >= 0)
    out.push_back({{parameter::kBow, Unit::mm, 0.005, options.bow_prior_mm},
                   false,
                   true,
                   {unit(e.shared_at + 1, 1), unit(e.shared_at + 2, 1), unit(e.shared_at + 3, 1)}});
  return out;
}

// Sigma of the depth's logarithm before the first photo.
double believed_depth_log(double depth_share) { return depth_share > 0 ? depth_share : kBelievedLog; }

std::vector<Measure> light_measures(const Problem& data, const Bench& bench, std::size_t own_lamps, Eigen::Index n,
                                    double paper, double depth_share) {
  const Board& board = *data.model.board;
  const auto unit = [&](int at, double by) { return Eigen::VectorXd(by * Eigen::VectorXd::Unit(n, at)); };
  std::vector<Measure> out;
  const auto share = [&](const char* name, int at, double goal, double believed = kBelievedLog) {
    out.push_back({{name, Unit::percent, goal, 100 * believed}, true, false, {unit(at, 100)}});
  };
  share(parameter::kAlpha, unknown::log_alpha, 1);
  share(parameter::kDepth, unknown::log_depth, 1.5, believed_depth_log(depth_share));
  share(parameter::kBaseAlpha, unknown::log_base_alpha, 2);
  Measure machine{{parameter::kMachine, Unit::mm, 0.01, 0}, true, true, {}};
  const Eigen::Vector2d c = data.model.center_mm;
  for (const double x : {board.carve_min_mm.x(), board.carve_max_mm.x()})
    for (const double y : {board.carve_min_mm.y(), board.carve_max_mm.y()})
      for (int row = 0; row < 2; ++row) {
        machine.rows.push_back(machine_combination(n, row, {x - c.x(), y - c.y(), 1}));
        machine.parameter.before =
            std::max(machine.parameter.before,
                     std::hypot(kBelievedShift_mm, kBelievedScale * (Eigen::Vector2d(x, y) - c).norm()));
      }
  out.push_back(machine);
  out.push_back({{parameter::kAmbient, Unit::percent, 0.5, 100 * kBelievedAmbientShare},
                 true,
                 false,
                 {unit(unknown::ambient, 100 / paper)}});
  Measure vignette{{parameter::kVignette, Unit::percent, 1, 25}, true, false, {Eigen::VectorXd::Zero(n)}};
  for (int i = 0; i < 3; ++i) vignette.rows[0] += unit(unknown::vignette + i, 100 * std::pow(0.5, i + 1));
  out.push_back(vignette);
  share(parameter::kBlur, unknown::log_blur, 10);
  const Eigen::Vector3d center(c.x(), c.y(), 0);
  for (std::size_t i = 0; i < bench.lights.size(); ++i) {
    const Light& light = bench.lights[i];
    const double distance = (light.position_mm - center).norm();
    Measure position{{parameter::light_position(light.id), Unit::mm, 2e-3 * distance, kBelievedLampShare * distance},
                     true,
                     true,
                     {}};
    for (int k = 0; k < 3; ++k) position.rows.push_back(unit(global_index(unknown::lamp_position + k, i), 1));
    Measure intensity{{parameter::light_intensity(light.id), Unit::percent, 1, 100 * kBelievedIntensityLog},
                      true,
                      false,
                      {unit(global_index(unknown::log_intensity, i), 100)}};
    if (i >= own_lamps) position.lamp = intensity.lamp = static_cast<int>(i);
    out.push_back(position);
    out.push_back(intensity);
    if (data.is_spot[i])
      out.push_back({{parameter::light_falloff(light.id), Unit::none, 0.5, kBelievedExponent},
                     true,
                     false,
                     {unit(global_index(unknown::spot + 2, i), 1)},
                     position.lamp});
  }
  return out;
}

// Information of the priors.
Eigen::MatrixXd light_prior(const Problem& data, const Bench& bench, Eigen::Index n, double paper, double depth_share) {
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  for (const int at : {unknown::log_alpha, unknown::log_base_alpha, unknown::log_blur}) sigma[at] = kBelievedLog;
  sigma[unknown::log_depth] = believed_depth_log(depth_share);
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) sigma[machine_index(row, column)] = kBelievedScale;
    sigma[machine_index(row, 2)] = kBelievedShift_mm;
  }
  sigma[unknown::ambient] = kBelievedAmbientShare * paper;
  for_each_unknown([&](const UnknownRow& row, int first) {
    if (row.prior_sigma[0] > 0)
      std::copy_n(row.prior_sigma.begin(), row.size, sigma.begin() + (row.scope == Scope::paper ? kPaperIndex : first));
  });
  const Eigen::Vector3d center(data.model.center_mm.x(), data.model.center_mm.y(), 0);
  for (std::size_t i = 0; i < bench.lights.size(); ++i) {
    const double distance = (bench.lights[i].position_mm - center).norm();
    for (int k = 0; k < 3; ++k) sigma[global_index(unknown::lamp_position + k, i)] = kBelievedLampShare * distance;
    sigma[global_index(unknown::log_intensity, i)] = kBelievedIntensityLog;
    for (int k = 0; k < 2; ++k) sigma[global_index(unknown::spot + k, i)] = data.model.board->size_mm.norm();
    sigma[global_index(unknown::spot + 2, i)] = kBelievedExponent;
  }
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) H(i, i) = std::isfinite(sigma[i]) ? 1 / (sigma[i] * sigma[i]) : 1e30;
  return H;
}

std::vector<double> bracket_stops(const PredictedLight& light) {
  constexpr double kPaperAt = 0.6, kGlintsAt = 0.9, kStep = 3;
  std::vector<double> stops{0};
  if (!(light.paper > 0)) return stops;
  const double needed = std::log2(std::max(1e-9, kPaperAt * light.metal / light.paper / kGlintsAt));
  constexpr int kMost = 4;  // photos of a bracket
  while (stops.back() > -needed && static_cast<int>(stops.size()) < kMost)
    stops.push_back(stops.back() - kStep);  // the same step as the advice without a plan
  return stops;
}

}  // namespace

Sent test_strokes(const Board& board) {
  std::mt19937_64 random(1);
  const auto uniform = [&] { return std::generate_canonical<double, 53>(random); };
  const Eigen::Vector2d size = board.carve_max_mm - board.carve_min_mm;
  const double length = std::min(5.0, 0.2 * size.minCoeff());
  Scratches out;
  constexpr double kPerMm2 = 0.4;
  const auto count = static_cast<std::size_t>(std::clamp(kPerMm2 * size.x() * size.y(), 200.0, 20'000.0));
  while (out.size() < count) {
    const Eigen::Vector2d p = board.carve_min_mm + Eigen::Vector2d(uniform() * size.x(), uniform() * size.y());
    const double turn = std::numbers::pi * uniform();
    const Eigen::Vector2d half = 0.5 * length * Eigen::Vector2d(std::cos(turn), std::sin(turn));
    const Eigen::Vector2d a = p - half, b = p + half;
    if ((a.cwiseMin(b) - board.carve_min_mm).minCoeff() < 0 || (board.carve_max_mm - a.cwiseMax(b)).minCoeff() < 0)
      continue;
    out.x0_mm.push_back(a.x());
    out.y0_mm.push_back(a.y());
    out.x1_mm.push_back(b.x());
    out.y1_mm.push_back(b.y());
  }
  return Sent(std::move(out));
}

namespace {

void require_something_to_plan(const Board& board, const Bench& nominal, const Sent& sent, const PlanOptions& options) {
  if (options.shots < 1) fail("the plan", "is zero", "ask for at least one");
  if (board.tags.list.size() < 3)
    fail("board.json: tags.list", "has " + counted(board.tags.list.size(), "tag"),
         "list at least three, better ten around the carved area");
  if (!(options.depth_share >= 0 && options.depth_share < 1))
    fail("the plan", "is to hold for depths up to " + fixed(100 * options.depth_share, 0) + " % off",
         "ask for 0 to 99 %");
  if (nominal.lights.empty())
    fail("the bench", "has no near lamp, and photos are measured under one alone", "give its intended place, roughly");
  if (sent.size() == 0) fail("scratches", "there is none", "name the designed scratches, or plan with test strokes");
}

// Photos are fitted only under one near lamp; sun and surroundings serve viewing.
Bench under_near_lamps(Bench bench) {
  std::erase_if(bench.lights, [](const Light& light) { return !light.is_lamp(); });
  return bench;
}

// Replaces the lamp of places designed for another light by the first lamp.
PlanOptions under_lamps_of(const Bench& bench, PlanOptions options) {
  for (DesignedPlace& place : options.designed)
    if (!bench.lights.empty() && std::none_of(bench.lights.begin(), bench.lights.end(),
                                              [&](const Light& light) { return light.id == place.light; }))
      place.light = bench.lights.front().id;
  return options;
}

// The nominal bench, with lamps at proposed places if more are allowed than it has.
Bench with_proposed_lamps(const Board& board, const Bench& nominal, const PlanOptions& options) {
  Bench bench = nominal;
  if (options.lamp_places > static_cast<int>(nominal.lights.size()))
    for (const Light& light : turned_lamps(nominal.lights.front(), board, {60, 120, 180, 240, 300}))
      bench.lights.push_back(light);
  return bench;
}

// Tags seen from each place; lenses scatter as in the bench.
Bundle tags_from(const std::vector<CameraPlace>& places, const Board& board, const Bench& bench,
                 double corner_sigma_px) {
  Bundle bundle;
  bundle.lens = bench.lens;
  bundle.surface = surface_of(board, bench);
  for (const Tag& tag : board.tags.list) {
    TagPlacement placement;
    placement.sigma_mm = std::max(board.tags.sigma_mm, 1e-4);
    placement.sigma_rad = placement.sigma_mm / (tag.size_mm / 2);
    bundle.tags.push_back(placement);
  }
  append_candidates(bundle, board, places, corner_sigma_px, bench.lens_scatter);
  return bundle;
}

// Factor on the cameras' sigmas if lenses differ: the median over places, with all shared parameters held.
double widening_by_own_lenses(const Bundle& bundle) {
  if (bundle.view_lenses.empty()) return 1;
  BundleOptions held;
  held.fix_lens = held.fix_bow = held.fix_tags = true;
  Bundle one_lens = bundle;
  one_lens.view_lenses.clear();
  const BundleUncertainty with = bundle_uncertainty(bundle, held), without = bundle_uncertainty(one_lens, held);
  std::vector<double> times;
  for (std::size_t v = 0; v < bundle.views.size(); ++v)
    if (const double before = without.center_mm2[v].trace(); before > 0)
      times.push_back(std::sqrt(with.center_mm2[v].trace() / before));
  return times.empty() ? 1 : median_of(std::move(times));
}

// Information of grooves and paper from each direction under each lamp: [direction][lamp].
using LightTable = std::vector<std::vector<LightCandidate>>;
LightTable light_from(const std::vector<CameraPlace>& places, const Problem& data, const State& state,
                      const Bench& bench, const PlanOptions& options, const Progress& progress) {
  const std::vector<bool> free = free_unknowns(data, Stage().free(Group::blur), bench.lights.size());
  std::size_t directions = 0;
  for (const CameraPlace& place : places) directions = std::max(directions, place.direction + 1);
  LightTable out(directions);
  for (const CameraPlace& place : places) {
    if (!out[place.direction].empty()) continue;  // the first of a direction is the nearest, upright
    if (progress)
      progress("looking at the grooves from everywhere",
               static_cast<double>(place.direction) / static_cast<double>(directions));
    for (std::size_t lamp = 0; lamp < bench.lights.size(); ++lamp) {
      out[place.direction].push_back(light_candidate(data, state, bench, place, lamp, free, options.light));
      out[place.direction].back().information /= options.inflation * options.inflation;
    }
  }
  return out;
}

// One hypothesis of the grooves' depth: information of candidate shots, and of the shots taken so far.
struct AtDepth {
  double depth_um = 0;
  LightTable light;
  Eigen::MatrixXd H;
  Straddle straddle{};
};

// The shots taken so far, and their information.
struct Planning {
  const Board& board;
  const Bench& bench;
  const PlanOptions& options;
  const std::size_t own_lamps;
  const std::vector<CameraPlace>& places;
  const BundleEquations& geometry;
  const std::vector<Measure>& measures;
  std::vector<AtDepth> depths;
  Eigen::MatrixXd H_geometry;
  std::set<std::size_t> lamps_used{};
  std::set<std::pair<std::size_t, std::size_t>> taken{};  // direction, lamp

  // The sum over measures of one kind; `sigmas`, if given, gets the worst of them.
  double score(bool of_light, const Eigen::MatrixXd& covariance, bool straddles, std::vector<double>* sigmas) const {
    double sum = 0;
    for (std::size_t i = 0; i < measures.size(); ++i) {
      const Measure& m = measures[i];
      if (m.of_light != of_light) continue;
      double sigma = m.sigma(covariance);
      if (m.parameter.name == parameter::kDepth && !straddles) sigma = m.parameter.before;
      if (sigmas) (*sigmas)[i] = std::max((*sigmas)[i], sigma);
      if (m.lamp < 0) sum += worth(sigma, m.parameter.goal);
    }
    return sum;
  }

  bool may_use(std::size_t lamp) const {
    std::set<std::size_t> lamps = lamps_used;
    lamps.insert(lamp);
    return lamp < own_lamps || static_cast<int>(std::max(lamps.size(), own_lamps + 1)) <= options.lamp_places;
  }

  bool is_lit(std::size_t direction, std::size_t lamp) const {
    return depths.front().light[direction][lamp].light.paper > 0;
  }

  // Score with one more photo, at the least informative depth.
  double worst_light_score(std::size_t direction, std::size_t lamp) const {
    double worst = -std::numeric_limits<double>::infinity();
    for (const AtDepth& at : depths) {
      const LightCandidate& candidate = at.light[direction][lamp];
      const Straddle with{at.straddle.inside + candidate.straddle.inside,
                          at.straddle.outside + candidate.straddle.outside};
      worst = std::max(worst, score(true, inverse_information(at.H + candidate.information), with.both(), nullptr));
    }
    return worst;
  }

  // The place and the lamp with the best score; empty if no place is left.
  std::optional<std::pair<std::size_t, std::size_t>> best_shot() const {
    // Light and geometry share no unknown, so a shot's worth is the sum of both.
    constexpr double kNever = std::numeric_limits<double>::infinity();
    std::vector<double> geometry_score(places.size(), kNever);
    for (std::size_t p = 0; p < places.size(); ++p)
      if (geometry.views[p].used)
        geometry_score[p] =
            score(false, inverse_information(H_geometry + geometry.views[p].information), false, nullptr);
    double best = kNever;
    std::optional<std::pair<std::size_t, std::size_t>> out;
    for (std::size_t direction = 0; direction < depths.front().light.size(); ++direction)
      for (std::size_t lamp = 0; lamp < bench.lights.size(); ++lamp) {
        if (taken.count({direction, lamp}) || !is_lit(direction, lamp) || !may_use(lamp)) continue;
        const double light_score = worst_light_score(direction, lamp);
        for (std::size_t p = 0; p < places.size(); ++p)
          if (places[p].direction == direction && geometry_score[p] + light_score < best &&
              !in_the_way(places[p].center_mm(), bench.lights[lamp].position_mm, board)) {
            best = geometry_score[p] + light_score;
            out = {p, lamp};
          }
      }
    return out;
  }

  // The present sigmas: of light, the worst at these depths.
  std::vector<double> sigmas_now(std::span<const AtDepth> at_depths) const {
    std::vector<double> out(measures.size(), 0);
    score(false, inverse_information(H_geometry), false, &out);
    for (const AtDepth& at : at_depths) score(true, inverse_information(at.H), at.straddle.both(), &out);
    return out;
  }

  PlannedShot take(std::size_t place, std::size_t lamp) {
    const std::size_t direction = places[place].direction;
    taken.insert({direction, lamp});
    lamps_used.insert(lamp);
    H_geometry += geometry.views[place].information;
    PredictedLight seen;
    for (AtDepth& at : depths) {
      const LightCandidate& chosen = at.light[direction][lamp];
      at.H += chosen.information;
      at.straddle.inside += chosen.straddle.inside;
      at.straddle.outside += chosen.straddle.outside;
      seen.paper = chosen.light.paper;
      seen.metal = std::max(seen.metal, chosen.light.metal);
    }
    PlannedShot shot;
    shot.camera = places[place];
    shot.light = lamp;
    shot.stops = bracket_stops(seen);
    shot.paper_radiance = seen.paper;
    shot.sigma = sigmas_now(depths);
    return shot;
  }
};

// The depths of a plan, least first, with the photos' information at each.
std::vector<AtDepth> depths_of(const std::vector<CameraPlace>& places, const Problem& data, const Bench& bench,
                               const PlanOptions& options, const Progress& progress) {
  std::vector<double> factors{1};
  if (options.depth_share > 0) factors = {1 - options.depth_share, 1, 1 + options.depth_share};
  std::vector<AtDepth> out;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    State state = state_of(bench, data);
    *state.block(unknown::log_depth) += std::log(factors[i]);
    const Progress part = !progress ? Progress{} : [&, i](std::string_view what, double share) {
      progress(what, (static_cast<double>(i) + share) / static_cast<double>(factors.size()));
    };
    out.push_back(
        {factors[i] * bench.material.depth_um, light_from(places, data, state, bench, options, part), {}, {}});
  }
  return out;
}

[[noreturn]] void fail_out_of_focus(const Board& board, const Lens& lens, const FocusRange& focus) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const CameraPlace& place : camera_places(board, lens, false)) nearest = std::min(nearest, place.distance_mm);
  fail("the focus",
       "from " + fixed(focus.near_mm, 0) + " to " + fixed(focus.far_mm, 0) +
           " mm holds no place that sees the whole board: this lens does from " + fixed(nearest, 0) + " mm on",
       "focus further away, or use a lens of shorter focal length");
}

PlannedShot take_designed(Planning& planning, const DesignedPlace& designed, std::size_t place) {
  const std::vector<Light>& lights = planning.bench.lights;
  const auto lamp =
      std::find_if(lights.begin(), lights.end(), [&](const Light& light) { return light.id == designed.light; });
  if (lamp == lights.end())
    fail("view " + designed.view, "is designed for a lamp \"" + designed.light + "\" that the bench has not",
         "name one of its lamps");
  PlannedShot shot = planning.take(place, static_cast<std::size_t>(lamp - lights.begin()));
  shot.view = designed.view;
  return shot;
}

}  // namespace

Plan plan_shots(const Board& whole_board, const Bench& whole_bench, const Sent& sent, const PlanOptions& asked,
                const Progress& progress) {
  const Bench nominal = under_near_lamps(whole_bench);
  const PlanOptions options = under_lamps_of(nominal, asked);
  require_something_to_plan(whole_board, nominal, sent, options);
  const Board board = with_planned_tags(whole_board);
  Plan out;
  out.bench = with_proposed_lamps(board, nominal, options);
  if (board.tags.list.size() < whole_board.tags.list.size())
    std::erase_if(out.bench.tags, [&](const Tag& measured) {
      return std::none_of(board.tags.list.begin(), board.tags.list.end(),
                          [&](const Tag& tag) { return tag.id == measured.id; });
    });
  const Bench& bench = out.bench;
  const std::size_t own_lamps = nominal.lights.size();
  std::vector<CameraPlace> places = camera_places(board, bench.lens, true, options.focus);
  if (places.empty() && options.designed.empty()) fail_out_of_focus(board, bench.lens, *options.focus);
  const std::size_t first_designed = places.size(), free_directions = places.empty() ? 0 : places.back().direction + 1;
  for (std::size_t k = 0; k < options.designed.size(); ++k)
    places.push_back(camera_place_at(options.designed[k].center_mm, board, free_directions + k));
  if (progress) progress("looking at the tags from everywhere", 0);
  BundleOptions bundle_options;
  bundle_options.fix_lens = options.fix_lens;
  const Bundle tags = tags_from(places, board, bench, options.corner_sigma_px);
  const BundleEquations geometry = bundle_equations(tags, bundle_options);
  out.own_lens_widening = widening_by_own_lenses(tags);

  const Problem data = make_problem(board, sent, bench);
  std::vector<AtDepth> depths = depths_of(places, data, bench, options, progress);
  double paper = 0;
  for (const auto& of_direction : depths.front().light)
    for (const LightCandidate& candidate : of_direction) paper = std::max(paper, candidate.light.paper);
  if (!(paper > 0))
    fail("the bench", "its lamps light no tag of the board",
         "put the lamp in front of the board: position_mm, z above 0");

  const Eigen::Index n = global_count(bench.lights.size());
  std::vector<Measure> measures = geometry_measures(geometry, bench.lens, board, bundle_options);
  for (Measure& m : light_measures(data, bench, own_lamps, n, paper, options.depth_share))
    measures.push_back(std::move(m));
  for (const Measure& m : measures) out.parameters.push_back(m.parameter);
  for (AtDepth& at : depths) at.H = light_prior(data, bench, n, paper, options.depth_share);

  Planning planning{board, bench, options, own_lamps, places, geometry, measures, std::move(depths), geometry.prior};
  for (std::size_t k = 0; k < options.designed.size(); ++k)
    if (geometry.views[first_designed + k].used)
      out.shots.push_back(take_designed(planning, options.designed[k], first_designed + k));
    else
      out.unseen.push_back(options.designed[k].view);
  for (int shot = 0; shot < options.shots; ++shot) {
    if (progress) progress("choosing places", static_cast<double>(shot) / options.shots);
    const auto best = planning.best_shot();
    if (!best) break;  // no place is left
    out.shots.push_back(planning.take(best->first, best->second));
  }
  if (out.shots.empty())
    fail("the plan", "there is no place from which lamp, tags and board are seen",
         "check the lens and the lamp's place");
  out.straddles = true;
  for (const AtDepth& at : planning.depths) {
    out.at_depth.push_back({at.depth_um, at.straddle.both(), planning.sigmas_now({&at, 1})});
    out.straddles = out.straddles && at.straddle.both();
  }
  // Proposed lamps are reported only if a shot uses them.
  for (std::size_t i = measures.size(); i-- > 0;)
    if (measures[i].lamp >= 0 && !planning.lamps_used.count(static_cast<std::size_t>(measures[i].lamp))) {
      out.parameters.erase(out.parameters.begin() + static_cast<std::ptrdiff_t>(i));
      for (PlannedShot& shot : out.shots) shot.sigma.erase(shot.sigma.begin() + static_cast<std::ptrdiff_t>(i));
      for (PlanAtDepth& at : out.at_depth) at.sigma.erase(at.sigma.begin() + static_cast<std::ptrdiff_t>(i));
    }
  return out;
}

}  // namespace burin
