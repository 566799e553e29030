#include "burin/optimize/design.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>
#include <span>
#include <utility>

#include "burin/optimize/carving/carving_limits.h"
#include "burin/optimize/carving/carving_time.h"
#include "burin/optimize/design/carving_budget.h"
#include "burin/optimize/design/design_views.h"
#include "burin/optimize/design/obey.h"
#include "burin/optimize/design/stroke_search.h"
#include "burin/optimize/loss/adam.h"
#include "burin/optimize/loss/picture_metrics.h"
#include "burin/optimize/target.h"
#include "burin/render/brdf.h"
#include "burin/render/error.h"
#include "burin/render/view_renderer.h"

namespace burin {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void check_options(const DesignOptions& o, const Board& board) {
  const auto need = [](bool ok, const char* field, const char* what, const char* remedy) {
    if (!ok) fail(std::string("design option ") + field, what, remedy);
  };
  need(o.pixels >= 16 && o.pixels <= 8192, "pixels", "is out of range", "give 16 to 8192; 512 is usual");
  need(o.iterations >= 0 && o.iterations <= 1000000, "iterations", "is out of range", "100 is usual");
  need(o.rate >= 0 && o.rate < 1 && o.final_rate >= 0 && o.final_rate < 1, "rate", "is out of range",
       "0.001 is usual, 0 chooses");
  need(o.loss.perceptual >= 0 && o.loss.l2 >= 0 && o.loss.gram >= 0 && o.loss.perceptual + o.loss.l2 + o.loss.gram > 0,
       "loss", "has a negative weight, or all are 0", "the paper's are perceptual 1, gram 0.01");
  need(o.min_length > 0 && o.min_length < 0.5, "min_length", "is out of range", "0.001 is usual");
  const double shortest = o.min_length * board.size_mm.maxCoeff();
  need(o.max_length_mm == 0 || o.max_length_mm > shortest, "max_length_mm", "is below the smallest length",
       "give more, or 0 for any length");
  need(o.carve_hours >= 0 && o.carve_hours < 1e5, "carve_hours", "is out of range", "5 to 10 is usual");
  need(o.start_light > 0 && o.start_light < 1e3, "start_light", "is out of range", "0.5 is usual");
  need(o.candidates >= 1 && o.candidates <= 10000, "candidates", "is out of range", "24 is usual");
  need(o.balance >= 0 && o.balance <= 10, "balance", "is out of range", "0 is for the mean of the views, 1 is strong");
  need(o.tolerance_mm >= 0 && o.tolerance_mm < 1e6, "tolerance_mm", "is out of range", "20 mm is a start");
  need(o.drop_error >= 0 && o.drop_error < 1 && o.drop_light >= 0 && o.drop_light < 1 && o.drop_count >= 0 &&
           o.drop_count < 1,
       "drop", "is not a share from 0 to 1", "0.01 of the error is usual");
  const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
  if (!(area.minCoeff() > 4 * shortest))
    fail("board: carve_mm", "is too small to carve in", "give a rectangle with sides of several mm");
}

Eigen::Vector2d first_end(const Scratches& s, std::size_t i) { return {s.x0_mm[i], s.y0_mm[i]}; }
Eigen::Vector2d second_end(const Scratches& s, std::size_t i) { return {s.x1_mm[i], s.y1_mm[i]}; }

// Uniform in [0, 1), the same on every platform.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

// Anywhere in the area, in any direction.
Stroke random_stroke(const CarvingLimits& limits, double mean_length_mm, std::mt19937_64& random) {
  const Eigen::Vector2d middle(limits.min_mm.x() + uniform(random) * (limits.max_mm.x() - limits.min_mm.x()),
                               limits.min_mm.y() + uniform(random) * (limits.max_mm.y() - limits.min_mm.y()));
  const double angle = std::numbers::pi * uniform(random), half = mean_length_mm * (0.25 + 0.5 * uniform(random));
  const Eigen::Vector2d u(std::cos(angle), std::sin(angle));
  return {middle - half * u, middle + half * u, 0};
}

void set_scratch(Scratches& s, std::size_t i, const Stroke& stroke) {
  s.x0_mm[i] = stroke.a_mm.x();
  s.y0_mm[i] = stroke.a_mm.y();
  s.x1_mm[i] = stroke.b_mm.x();
  s.y1_mm[i] = stroke.b_mm.y();
}

Scratches append(Scratches s, const std::vector<Stroke>& strokes) {
  for (const Stroke& stroke : strokes) {
    for (auto* a : {&s.x0_mm, &s.y0_mm, &s.x1_mm, &s.y1_mm}) a->push_back(0);
    set_scratch(s, s.size() - 1, stroke);
  }
  return s;
}

// Every scratch to where it may be carved; one that is hopeless where it lies starts somewhere else.
void settle(Scratches& scratches, const CarvingLimits& limits, double mean_length_mm, std::uint64_t seed) {
  constexpr int kTries = 1000;
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < scratches.size(); ++i) {
    bool lawful = confine(scratches, i, limits, first_end(scratches, i), second_end(scratches, i));
    for (int k = 0; !lawful && k < kTries; ++k) {
      const Stroke stroke = random_stroke(limits, mean_length_mm, random);
      set_scratch(scratches, i, stroke);
      lawful = confine(scratches, i, limits, stroke.a_mm, stroke.b_mm);
    }
    if (!lawful)
      fail("design", "keep-outs and tags leave no room for a scratch in the carve area",
           "make carve_mm larger or keep_out smaller in board.json, or allow shorter scratches");
  }
}

Scratches random_start(std::size_t count, const CarvingLimits& limits, double mean_length_mm, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Stroke> strokes;
  for (std::size_t i = 0; i < count; ++i) strokes.push_back(random_stroke(limits, mean_length_mm, random));
  return append({}, strokes);
}

// The rules of the machine and of the design together.
CarvingLimits design_limits(const Board& board, const Bench& bench, const DesignOptions& options) {
  MachineLimits machine = options.machine;
  machine.shortest_mm = std::max(machine.shortest_mm, options.min_length * board.size_mm.maxCoeff());
  if (options.max_length_mm > 0)
    machine.longest_mm =
        machine.longest_mm > 0 ? std::min(machine.longest_mm, options.max_length_mm) : options.max_length_mm;
  if (machine.longest_mm > 0 && machine.longest_mm < machine.shortest_mm + 2 * machine.step_mm)
    fail("design", "the longest scratch allowed is shorter than the shortest", "allow longer or shorter ones");
  return carving_limits(board, machine, bench.material.depth_um, bench.machine_affine);
}

// ---- Placing scratches by burin/optimize/design/stroke_search.h
// ------------------------------------------------------------

StrokeRules stroke_rules(const CarvingLimits& limits, double mean_length_mm, double alpha, int candidates) {
  StrokeRules rules;
  rules.candidates = candidates;
  rules.min_mm = limits.min_mm;
  rules.max_mm = limits.max_mm;
  // Flat parts of a picture want long strokes. Short ones cost the machine as much as they bring light.
  const double most = std::min(10 * mean_length_mm, 0.9 * (limits.max_mm - limits.min_mm).norm());
  rules.longest_mm = limits.machine.longest_mm > 0 ? std::min(limits.machine.longest_mm, most) : most;
  rules.shortest_mm = std::min(std::max(limits.machine.shortest_mm, 0.1 * mean_length_mm), rules.longest_mm);
  rules.alpha = alpha;
  return rules;
}

// Moves the scratches whose absence costs least to where the pictures of all views miss most, as far as that pays, then
// searches a better place for each, until `stop` says so. The views must be as rendered. Returns the moved ones,
// ascending.
std::vector<std::size_t> relocate(Scratches& scratches, const std::vector<WorkView>& views,
                                  const std::vector<double>& log_exposure, const CarvingLimits& limits,
                                  const StrokeRules& rules, std::size_t movable, double share, std::uint64_t seed,
                                  const std::function<bool()>& stop) {
  const Scratches before = scratches;
  std::vector<StrokeView> light = stroke_views(views, log_exposure, false);
  std::vector<double> worth = worth_of(light, rules, scratches);
  std::vector<std::size_t> order(movable);  // the carved ones, which come last, stay
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto candidates = static_cast<std::ptrdiff_t>(share * static_cast<double>(order.size()));
  std::partial_sort(order.begin(), order.begin() + candidates, order.end(),
                    [&](std::size_t a, std::size_t b) { return worth[a] != worth[b] ? worth[a] < worth[b] : a < b; });
  order.resize(static_cast<std::size_t>(candidates));
  std::vector<char> changed(scratches.size(), 0);
  {
    std::vector<StrokeView> lifted = light;
    lift_strokes(lifted, rules, scratches, order);
    std::vector<Stroke> strokes = place_strokes(lifted, rules, order.size(), seed, stop);
    std::stable_sort(strokes.begin(), strokes.end(), [](const Stroke& a, const Stroke& b) { return a.gain > b.gain; });
    std::size_t moved = 0;
    while (moved < strokes.size() && strokes[moved].gain > worth[order[moved]]) ++moved;
    order.resize(moved);
    lift_strokes(light, rules, scratches, order);
    for (std::size_t k = 0; k < moved; ++k) {
      set_scratch(scratches, order[k], strokes[k]);
      changed[order[k]] = 1;
    }
    add_strokes(light, rules, scratches, order);
  }
  for (const std::size_t i : improve_strokes(light, rules, scratches, movable, seed + 1, stop)) changed[i] = 1;
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < changed.size(); ++i)
    if (changed[i]) {
      moved.push_back(i);
      confine(scratches, i, limits, first_end(before, i), second_end(before, i));
    }
  return moved;
}

// The iterations kept for the contact sheet: dense at first, where most happens.
std::vector<int> contact_iterations(int iterations, int frames) {
  std::vector<int> kept;
  for (int f = 0; f < frames; ++f) {
    const double t = frames > 1 ? static_cast<double>(f) / (frames - 1) : 1;
    kept.push_back(static_cast<int>(std::lround(iterations * t * t)));
  }
  return kept;
}

// What is to be designed, when going on, and what is in the metal already.
std::pair<Scratches, Scratches> new_and_carved(const DesignOptions& options, const Board& board, const Bench& bench) {
  if (options.carved.size() > 0 && (options.optimize_width || options.optimize_depth || options.optimize_alpha))
    fail("design", "the groove of what is carved already cannot be chosen any more",
         "leave out --free-width, --free-depth and --free-alpha, or --carved");
  if (!options.from) return {{}, options.carved};
  std::vector<std::size_t> fresh, done;
  for (std::size_t i = 0; i < options.from->size(); ++i) (options.from->is_carved(i) ? done : fresh).push_back(i);
  Scratches carved = selected(*options.from, done), from = selected(*options.from, fresh);
  carved.carved.clear();
  from.carved.clear();
  return {from, joined(carved, options.carved, board.tool_width_um, bench.material.depth_um, bench.material.alpha)};
}

// The last word on the rules: ends on steps, pairs apart; what cannot obey is placed anew or dropped.
void have_the_last_word(Scratches& scratches, CarvingLimits limits, std::vector<WorkView>& views,
                        const std::vector<double>& log_exposure, const StrokeRules& rules, const DesignOptions& options,
                        const std::vector<double>& log_shared, const std::function<bool()>& stop,
                        DesignResult& result) {
  if (options.optimize_width) limits.width_um = std::exp(log_shared[0]);
  Obeying obeying = obey(scratches, limits, views, log_exposure, rules, options.seed + 2000, stop);
  for (std::size_t r = 0; r < kRules; ++r) result.dropped_by_rule[r] += obeying.dropped[r];
  if (obeying.rows.size() == result.carved)
    fail("design", "no scratch can obey the machine's limits (" + dropped_text(obeying.dropped) + " were dropped)",
         "loosen them, or make the board's keep-outs smaller");
  scratches = std::move(obeying.scratches);
  fail_unless_good(check_limits(scratches, limits), "design");
}

}  // namespace

DesignResult design(const DesignSpec& spec, const Board& board, const Bench& bench, const DesignOptions& options,
                    const Progress& progress) {
  const Clock::time_point began = Clock::now();
  check_options(options, board);
  if (spec.scratches < 1 || spec.views.empty())
    fail("design", "no scratches or no views were asked for", "ask for at least one of each");
  const auto report = [&](const char* stage, double fraction) {
    if (progress) progress(stage, fraction);
  };
  report("reading targets", 0);

  DesignResult result;
  const CarvingLimits limits = design_limits(board, bench, options);
  std::vector<WorkView> views = prepare_views(spec, board, bench, options, limits, result.warnings);
  const std::size_t shown = spec.views.size();  // of the views; the rest stand aside of these
  const std::span<WorkView> shown_views(views.data(), shown);
  const auto [from, carved] = new_and_carved(options, board, bench);
  result.carved = carved.size();
  if (options.from && from.size() == 0)
    fail("design", "there are no scratches to go on from", "give a scratches.csv that holds some");
  if (!options.from && carved.size() >= static_cast<std::size_t>(spec.scratches))
    fail("design",
         std::to_string(spec.scratches) + " scratches are asked for, and " + std::to_string(carved.size()) +
             " are carved already",
         "ask for more: the number counts what is carved");
  // The new ones come first in `scratches`, `movable` of them; then those that are carved already, which never change.
  std::size_t movable = options.from ? from.size() : static_cast<std::size_t>(spec.scratches) - carved.size();
  std::size_t count = movable + carved.size();
  result.started_with = movable;
  const Eigen::Vector2d area = limits.max_mm - limits.min_mm;
  // Guided: the search chooses every length itself; this bounds them. Scratches of a view of this length, laid end to
  // end, would cover 0.8 of its pixels.
  const double pixel_mm = views.front().pitch_mm;
  const double covering =
      std::clamp(0.8 * area.x() * area.y() * static_cast<double>(shown) / (static_cast<double>(count) * pixel_mm),
                 3 * pixel_mm, 0.2 * area.minCoeff());
  const double mean_length = options.start_length_mm > 0      ? options.start_length_mm
                             : options.start == Start::guided ? covering
                                                              : 0.03 * area.maxCoeff();
  const StrokeRules rules = stroke_rules(limits, mean_length, bench.material.alpha, options.candidates);
  // One exposure a group, in logarithms.
  const int group_count = 1 + std::max_element(views.begin(), views.end(), [](const WorkView& a, const WorkView& b) {
                                return a.exposure_group < b.exposure_group;
                              })->exposure_group;
  std::vector<double> log_exposure(group_count, 0.0);
  if (carved.size() > 0)
    for (WorkView& v : views)
      v.renderer.forward(in_metal(carved), v.face);  // what cannot be undone: the face and what is in it
  constexpr double kStartShare = 0.4;                // of the time limit: iterations gain more than a better start
  // Asked within sweeps too, by several threads; a wish to stop holds.
  std::atomic<bool> wished{false};
  const auto stop_wished = [&] {
    if (!wished && options.stop && options.stop()) wished = true;
    return wished.load();
  };
  const auto enough = [&] {
    return stop_wished() || (options.time_limit_s > 0 && seconds_since(began) > kStartShare * options.time_limit_s);
  };
  const auto time_over = [&] {
    return stop_wished() || (options.time_limit_s > 0 && seconds_since(began) > options.time_limit_s);
  };
  Scratches scratches;
  if (options.from) {
    scratches = from;
  } else if (options.start == Start::random) {
    scratches = random_start(movable, limits, mean_length, options.seed);
  } else {
    // Later on exposures hardly change any more: the strokes that stand are of the right brightness for them.
    log_exposure = starting_exposures(views, log_exposure.size(), options.start_light);
    report("placing scratches", 0);
    std::vector<StrokeView> light = stroke_views(views, log_exposure, true);
    scratches = append({}, place_strokes(light, rules, movable, options.seed, enough));
    if (scratches.size() < movable && enough())
      result.warnings.push_back("the start was ended early: " + std::to_string(scratches.size()) + " of " +
                                std::to_string(movable) +
                                " scratches begin where the pictures want them, the rest anywhere");
    // Where the model finds no more to gain, the rest start anywhere: relocation may yet find them a place.
    scratches = joined(scratches, random_start(movable - scratches.size(), limits, mean_length, options.seed + 1),
                       board.tool_width_um, bench.material.depth_um, bench.material.alpha);
  }
  settle(scratches, limits, mean_length, options.seed + 2);
  if (options.carve_hours > 0 && !options.from) {
    // A quarter more than fit may start and be weeded out. More would only teach the rest to be dim: start anew.
    constexpr double kMore = 1.25;
    const double hours = carving_time_s(scratches, bench.material.depth_um, options.carve_machine) / 3600;
    const auto fewer = static_cast<std::size_t>(kMore * options.carve_hours / hours * static_cast<double>(movable));
    if (hours > 1.1 * kMore * options.carve_hours && fewer > 0) {
      DesignSpec smaller = spec;
      smaller.scratches = static_cast<int>(fewer + carved.size());
      DesignResult made = design(smaller, board, bench, options, progress);
      char words[160];
      std::snprintf(words, sizeof words,
                    "%zu scratches would take %.1f hours to carve: began with %zu for the %.1f there are", movable,
                    hours, made.started_with, options.carve_hours);
      made.warnings.emplace_back(words);
      return made;
    }
  }
  if (carved.size() > 0) {
    scratches = joined(scratches, carved, board.tool_width_um, bench.material.depth_um, bench.material.alpha);
    scratches.carved.assign(movable, 0);
    scratches.carved.resize(count, 1);
  }
  render_all(views, scratches);
  std::vector<double> wanted(group_count, 0.0), given(group_count, 0.0);
  for (WorkView& v : views) {
    const double mean = mean_value(v.radiance);
    if (!(mean > 0)) fail("view " + v.spec.view, "is black", "check the lamp's intensity and position in the bench");
    wanted[v.exposure_group] += mean_light(v.target.picture);
    given[v.exposure_group] += mean;
  }
  const bool random = !options.from && options.start == Start::random;
  for (int g = 0; g < group_count; ++g)
    log_exposure[g] = std::log((random ? options.start_exposure : 1) * wanted[g] / given[g]);
  if (!random) log_exposure = fitting_exposures(views, log_exposure);
  if (!options.from && options.start == Start::guided)
    for (int k = 0; k < options.start_sweeps && !enough(); ++k) {
      report("searching places", static_cast<double>(k) / options.start_sweeps);
      relocate(scratches, views, log_exposure, limits, rules, movable, 0, options.seed + 100 + k, enough);
      render_all(views, scratches);
      log_exposure = fitting_exposures(views, log_exposure);
    }

  // Optional shared parameters, in logarithms.
  std::vector<double> log_shared{std::log(board.tool_width_um), std::log(bench.material.depth_um),
                                 std::log(bench.material.alpha)};
  const bool optimize_shared = options.optimize_width || options.optimize_depth || options.optimize_alpha;
  const auto spread_shared = [&] {
    if (options.optimize_width) scratches.width_um.assign(count, std::exp(log_shared[0]));
    if (options.optimize_depth) scratches.depth_um.assign(count, std::exp(log_shared[1]));
    if (options.optimize_alpha) scratches.alpha.assign(count, std::exp(log_shared[2]));
  };
  spread_shared();

  Adam adam_x0(count), adam_y0(count), adam_x1(count), adam_y1(count), adam_exposure(group_count), adam_shared(3);
  ScratchGradients gradients;
  Scratches before;
  const std::vector<int> contact = contact_iterations(options.iterations, options.contact_frames);
  const Clock::time_point iterations_began = Clock::now();
  // Weak scratches go before the end, so that the last iterations make up for them.
  const int drop_at = static_cast<int>(std::lround(options.drop_at * options.iterations));
  const auto keep_only = [&](const std::vector<std::size_t>& kept) {  // new ones first, as ever
    if (kept.size() == count) return;
    if (result.loss_before_drop == 0) result.loss_before_drop = result.history.back().loss;
    scratches = selected(scratches, kept);
    for (Adam* adam : {&adam_x0, &adam_y0, &adam_x1, &adam_y1}) adam->keep(kept);
    movable -= count - kept.size();
    count = kept.size();
  };
  bool weak_dropped = false;
  const auto drop_weak = [&] {
    weak_dropped = true;
    if (!(options.drop_count > 0 || options.drop_light > 0 || options.drop_error > 0)) return;
    report("dropping weak scratches", 0);
    // Each view's light in units of its own white, so that a bright lamp's views do not rule.
    std::vector<double> light_sum(count, 0.0);
    for (WorkView& v : views) {
      std::vector<double> light(count, 0.0);
      v.renderer.forward(in_metal(scratches), v.radiance);
      v.renderer.add_contributions(light);
      for (std::size_t i = 0; i < count; ++i) light_sum[i] += std::exp(log_exposure[v.exposure_group]) * light[i];
    }
    const double total_light =
        std::accumulate(light_sum.begin(), light_sum.begin() + static_cast<std::ptrdiff_t>(movable), 0.0);
    std::vector<StrokeView> now = stroke_views(views, log_exposure, false);
    const double error = squared_error(now);
    const auto most = static_cast<std::size_t>(options.drop_count * static_cast<double>(movable));
    std::size_t gone = 0;
    double rise = 0, light = 0;
    std::vector<std::size_t> kept =
        all_but(count, spare_order(now, rules, scratches, movable, {}, [&](std::size_t i, double worth) {
                  if (++gone == movable) return false;  // one stays, whatever is asked
                  rise += std::max(0.0, worth);
                  light += light_sum[i];
                  return options.drop_count > 0   ? gone <= most
                         : options.drop_light > 0 ? light <= options.drop_light * total_light
                                                  : rise <= options.drop_error * error;
                }));
    result.dropped += count - kept.size();
    keep_only(kept);
  };
  // Down to the time there is, in steps, so that the scratches that stay can make up for those that go. What is carved
  // already takes none.
  const double budget_s = 3600 * options.carve_hours;
  const auto new_ones = [&] {
    std::vector<std::size_t> rows(movable);
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    return selected(scratches, rows);
  };
  const auto keep_to_budget = [&](double allowed_s) {
    // The air is shared anew after each round; a few meet the time.
    for (int round = 0; round < 8 && movable > 1; ++round) {
      const std::vector<double> cost = carving_costs_s(new_ones(), bench.material.depth_um, options.carve_machine);
      const double now_s = std::accumulate(cost.begin(), cost.end(), 0.0);
      if (now_s <= allowed_s) return;
      report("keeping to the carving time", 0);
      render_all(views, scratches);
      const std::vector<std::size_t> spared =
          spare_for_time(stroke_views(views, log_exposure, false), rules, scratches, movable, cost, now_s - allowed_s);
      result.dropped += spared.size();
      keep_only(all_but(count, spared));
      // Fewer have to be brighter.
      render_all(views, scratches);
      log_exposure = fitting_exposures(views, log_exposure);
    }
  };
  constexpr int kBudgetSteps = 6;
  // What it would take to carve all that the design began with.
  const double full_s = budget_s > 0 ? carving_time_s(new_ones(), bench.material.depth_um, options.carve_machine) : 0;
  // A design that starts where it should be is only set right; a random one has a way to go.
  const double first_rate = options.rate > 0 ? options.rate : random ? 1e-3 : 0.3 / options.pixels;
  const double last_rate = options.final_rate > 0 ? options.final_rate : random ? 1e-4 : 0.0125 / options.pixels;
  int iteration = 0;
  double look_s = 0;  // what all views' pictures and gradients took last
  // Room for the last look, dropping and the figures, which cost about two more.
  const auto time_to_end = [&] {
    return stop_wished() || (options.time_limit_s > 0 && seconds_since(began) + 3 * look_s > options.time_limit_s);
  };
  for (;; ++iteration) {
    const bool last = iteration == options.iterations || result.stopped_early;
    const Clock::time_point look_began = Clock::now();
    gradients.resize(count);
    std::vector<double> d_log_exposure(group_count, 0.0);
    DesignIteration record;
    record.view_loss.assign(shown, 0.0);
    result.pairs = 0;
    for (std::size_t k = 0; k < views.size(); ++k) {
      WorkView& v = views[k];
      const double exposure = std::exp(log_exposure[v.exposure_group]);
      v.renderer.forward_with_jacobian(in_metal(scratches), v.radiance);
      picture_from_radiance(v.radiance, exposure, v.picture);
      v.value = v.loss.evaluate(v.picture, v.dE_dpicture);
      record.loss += v.value.total;
      record.view_loss[v.of] += v.value.total;
      result.pairs += v.renderer.pair_count();
      if (!last) {
        d_log_exposure[v.exposure_group] +=
            radiance_gradient(v.radiance, exposure, v.picture, v.dE_dpicture, v.dE_dradiance);
        v.renderer.backward(v.dE_dradiance, gradients);
        for (auto* g : {&gradients.x0_mm, &gradients.y0_mm, &gradients.x1_mm, &gradients.y1_mm})
          std::fill(g->begin() + static_cast<std::ptrdiff_t>(movable), g->end(), 0.0);  // what is carved stays
      }
    }
    look_s = seconds_since(look_began);
    record.seconds = seconds_since(iterations_began);
    result.history.push_back(record);
    if (!std::isfinite(record.loss))
      fail("design", "the loss is not finite at iteration " + std::to_string(iteration),
           "check the bench's numbers; report this if they are sound");
    if (iteration == 0)
      for (WorkView& v : shown_views) {
        DesignedView out;
        const double exposure =
            best_exposure(v.radiance, v.target.picture, std::exp(log_exposure[v.exposure_group]), v.target.mask);
        out.start = shown_picture(v.radiance, exposure);
        out.start_psnr_db = psnr_db(out.start, v.target.picture, v.target.mask);
        out.start_ssim = ssim(out.start, v.target.picture, v.target.mask);
        result.views.push_back(std::move(out));
      }
    if (last || std::find(contact.begin(), contact.end(), iteration) != contact.end()) {
      ContactFrame frame{iteration, {}};
      for (const WorkView& v : shown_views) {
        frame.pictures.push_back(v.picture);
        for (float& p : frame.pictures.back().data) p = std::min(1.0F, p);
      }
      result.frames.push_back(std::move(frame));
    }
    if (options.watch) {
      DesignFrame frame{iteration, record.loss, record.view_loss, {}};
      for (const WorkView& v : shown_views) frame.pictures.push_back(&v.picture);
      options.watch(frame);
    }
    report("designing", options.iterations > 0 ? static_cast<double>(iteration) / options.iterations : 1);
    if (last) break;

    const double t = static_cast<double>(iteration) / std::max(1, options.iterations - 1);
    const double rate = last_rate + (first_rate - last_rate) * 0.5 * (1 + std::cos(std::numbers::pi * t));
    before = scratches;
    adam_x0.step(scratches.x0_mm, gradients.x0_mm, rate * board.size_mm.x());
    adam_y0.step(scratches.y0_mm, gradients.y0_mm, rate * board.size_mm.y());
    adam_x1.step(scratches.x1_mm, gradients.x1_mm, rate * board.size_mm.x());
    adam_y1.step(scratches.y1_mm, gradients.y1_mm, rate * board.size_mm.y());
    for (std::size_t i = 0; i < movable; ++i)
      confine(scratches, i, limits, first_end(before, i), second_end(before, i));
    const bool may_move =
        t < options.relocate_until &&
        (options.time_limit_s <= 0 || seconds_since(began) < options.relocate_until * options.time_limit_s);
    if (options.relocate_every > 0 && iteration > 0 && iteration % options.relocate_every == 0 && may_move) {
      render_all(views, scratches);
      balance_views(views, log_exposure, options.balance);
      const std::vector<std::size_t> moved =
          relocate(scratches, views, log_exposure, limits, rules, movable, options.relocate_share,
                   options.seed + 1000 + iteration, time_to_end);
      for (const std::size_t i : moved) {
        for (Adam* adam : {&adam_x0, &adam_y0, &adam_x1, &adam_y1}) adam->restart(i);
      }
      result.relocated += moved.size();
    }
    if (iteration == drop_at && iteration > 0) drop_weak();
    if (budget_s > 0 && full_s > budget_s && drop_at >= kBudgetSteps && iteration > 0 && iteration <= drop_at &&
        iteration % (drop_at / kBudgetSteps) == 0) {
      const double part = std::min(1.0, static_cast<double>(iteration) / drop_at);
      keep_to_budget(full_s * std::pow(budget_s / full_s, part));
    }
    if (options.exposure_rate > 0) adam_exposure.step(log_exposure, d_log_exposure, options.exposure_rate);
    if (optimize_shared) {
      // Gradients by the logarithms: d/dlog p = p d/dp, summed over the scratches.
      const auto sum = [](const std::vector<double>& g) { return std::accumulate(g.begin(), g.end(), 0.0); };
      const std::vector<double> d_log{options.optimize_width ? std::exp(log_shared[0]) * sum(gradients.width_um) : 0.0,
                                      options.optimize_depth ? std::exp(log_shared[1]) * sum(gradients.depth_um) : 0.0,
                                      options.optimize_alpha ? std::exp(log_shared[2]) * sum(gradients.alpha) : 0.0};
      adam_shared.step(log_shared, d_log, options.log_rate);
      log_shared[2] = std::min(log_shared[2], 0.0);
      spread_shared();
    }
    if (time_to_end()) result.stopped_early = true;
  }
  result.iteration_seconds = seconds_since(iterations_began);
  if (!weak_dropped && !result.stopped_early) drop_weak();
  if (budget_s > 0) keep_to_budget(budget_s);
  have_the_last_word(scratches, limits, views, log_exposure, rules, options, log_shared, time_over, result);
  movable = scratches.size() - result.carved;
  result.scratches = scratches;

  for (WorkView& v : views) {
    v.renderer.forward(in_metal(result.scratches), v.radiance);
    picture_from_radiance(v.radiance, std::exp(log_exposure[v.exposure_group]), v.picture);
    v.value = v.loss.evaluate(v.picture, v.dE_dpicture);
    result.final_loss += v.value.total;
  }
  for (std::size_t k = 0; k < shown; ++k) {
    WorkView& v = views[k];
    DesignedView& out = result.views[k];
    out.view = v.spec.view;
    out.light = v.spec.light;
    out.rotation_deg = v.rotation_deg;
    out.exposure = std::exp(log_exposure[v.exposure_group]);
    out.loss = v.value;
    out.target = v.target.picture;
    out.best_exposure = best_exposure(v.radiance, out.target, out.exposure, v.target.mask);
    out.shown = shown_picture(v.radiance, out.best_exposure);
    out.psnr_db = psnr_db(out.shown, out.target, v.target.mask);
    out.ssim = ssim(out.shown, out.target, v.target.mask);
    // The plain face alone, at the same exposure: nothing can be darker.
    Image face = v.face;
    for (float& f : face.data) f *= static_cast<float>(out.best_exposure);
    out.achievable = within_contrast(out.target, face);
    out.achievable_psnr_db = psnr_db(out.achievable, out.target, v.target.mask);
    report("measuring", static_cast<double>(k + 1) / static_cast<double>(shown));
  }
  if (options.report_tolerance || options.tolerance_mm > 0) {
    std::vector<ToleranceTarget> targets;
    for (std::size_t k = 0; k < shown; ++k)
      targets.push_back({result.views[k].target, views[k].target.mask, result.views[k].best_exposure});
    result.tolerance = measure_tolerance(spec, board, bench, targets, result.scratches, progress);
  }
  for (std::size_t k = 0; k < shown; ++k)
    for (const DesignedView& other : result.views) {
      DesignedView& out = result.views[k];
      out.ghost.push_back(correlation(out.shown, other.target, views[k].target.mask));
      out.target_correlation.push_back(correlation(out.target, other.target, views[k].target.mask));
    }
  if (options.carve_curve || budget_s > 0) {
    report("measuring the curve over carving time", 0);
    result.curve = carving_curve(views, shown, log_exposure, rules, result.scratches, movable, bench.material.depth_um,
                                 options.carve_machine);
  }
  if (options.optimize_width) result.width_um = std::exp(log_shared[0]);
  if (options.optimize_depth) result.depth_um = std::exp(log_shared[1]);
  if (options.optimize_alpha) result.alpha = std::exp(log_shared[2]);
  result.total_seconds = seconds_since(began);
  return result;
}

}  // namespace burin
