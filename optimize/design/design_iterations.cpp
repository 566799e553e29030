// The iterations of a DesignRun: Adam's steps, re-insertion searches, and pruning.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/optimize/design/carving_budget.h"
#include "burin/optimize/design/crossing_loss.h"
#include "burin/optimize/design/design_output.h"
#include "burin/optimize/design/design_run.h"
#include "burin/optimize/design/relocate.h"
#include "burin/optimize/design/weak_scratches.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/toolpath/carving_time.h"
#include "burin/optimize/toolpath/ends.h"
#include "burin/render/brdf.h"

namespace burin {
namespace {

constexpr int kBudgetSteps = 6;  // steps of pruning; the remaining scratches compensate in between

// Part of the iterations from which cut rims count exactly, and part at which the carving order is settled. A new order
// changes the upper groove of crossings. The second half of the iterations compensates for this. Less is not enough
// (measured: 0.5 dB), and strokes searched later would make the order's travel long.
constexpr double kRimsFrom = 0.6, kSettledFrom = 0.5;

constexpr double kLooksToEnd = 3;  // the stages after the iterations take about as long as this many evaluations

// The iterations in the contact sheet: dense at first, when most changes.
std::vector<int> contact_iterations(int iterations, int frames) {
  std::vector<int> kept;
  for (int f = 0; f < frames; ++f) {
    const double t = frames > 1 ? static_cast<double>(f) / (frames - 1) : 1;
    kept.push_back(static_cast<int>(std::lround(iterations * t * t)));
  }
  return kept;
}

}  // namespace

void DesignRun::iterate() {
  log_shared_ = {std::log(board_.tool_width_um), std::log(bench_.material.depth_um), std::log(bench_.material.alpha)};
  spread_shared();
  momenta_ = {Adam(count()), Adam(count()), Adam(count()), Adam(count()), Adam(log_exposure_.size()), Adam(3)};
  contact_ = contact_iterations(iterations_, options_.contact_frames);
  iterations_began_s_ = deadline_.seconds();
  drop_at_ = static_cast<int>(std::lround(options_.drop_at * iterations_));
  bright_.assign(views_.size(), {});
  // After a random start, scratches learn their direction from faint light.
  if (!starts_at_random())
    for (std::size_t k = 0; k < views_.size(); ++k) bright_[k].apart = bright_part_shows(views_[k], bench_, board_);
  cut_ = bright_;
  if (options_.carve_hours > 0)
    full_carving_s_ = carving_time_s(new_ones(), bench_.material.depth_um, options_.carve_machine);
  // A searched start only needs corrections; a random start needs long moves.
  first_rate_ = options_.rate > 0 ? options_.rate : starts_at_random() ? 1e-3 : 0.2 / pixels_;
  last_rate_ = options_.final_rate > 0 ? options_.final_rate : starts_at_random() ? 1e-4 : 0.0125 / pixels_;
  part_ = 0;
  for (iteration_ = 0;; ++iteration_) {
    const bool last = iteration_ == iterations_ || result_.stopped_early;
    count_time();
    // After a stop, no evaluation of whole grooves as they would be cut follows.
    if (last && deadline_.wished() && !rims_count_ && best_) {
      merit_ = -std::numeric_limits<double>::infinity();
      rims_count_ = true;
      break;
    }
    const bool rendered = (last || searches_are_over()) && count_rims();
    look_at_crossings();
    look(last, rendered);
    record(last);
    if (last) break;
    move_ends();
    if (rims_count_) relocate_cut_some();
    if (searches_are_over())
      settle_order();
    else
      relocate_some();
    if (is_time_to_drop()) drop_weak();
    keep_to_part_of_budget();
    if (options_.exposure_rate > 0) momenta_.exposure.step(log_exposure_, d_log_exposure_, options_.exposure_rate);
    hold_exposures(views_, log_exposure_);
    move_shared();
    if (time_to_end()) result_.stopped_early = true;
  }
  take_back_best();
  if (!weak_dropped_ && !result_.stopped_early) {
    drop_weak();
    look_as_carved(in_the_metal(), Faint::anew);
    take_back_best();
  }
  cut_look_.reset();
  result_.iteration_seconds = deadline_.seconds() - iterations_began_s_;
  if (options_.carve_hours > 0) keep_to_budget(3600 * options_.carve_hours);
  if (iterations_ > 0) settle_order();  // a design without iterations measures its scratches as they are
}

// The last evaluation, pruning and the figures cost about two evaluations more.
bool DesignRun::time_to_end() { return deadline_.wished_or_used(1, kLooksToEnd * look_s_); }

// Progress of the iterations. Iterations with exact cuts are a quarter of all and take about half of the time.
void DesignRun::count_time() {
  constexpr double kSearched = 0.5;  // part of the time with whole strokes
  const double time = deadline_.part_since(iterations_began_s_, kLooksToEnd * look_s_);
  time_part_ = !grooves_cut_each_other() ? time
               : time < kSearched        ? kRimsFrom * time / kSearched
                                         : kRimsFrom + (1 - kRimsFrom) * (time - kSearched) / (1 - kSearched);
  // Iterations within the time limit do not depend on the clock, so the same input gives the same bits.
  const double all = std::max(1, iterations_ - 1), by_number = iteration_ / all;
  part_ = std::max(part_, time_part_ > (iteration_ + 1) / all ? time_part_ : by_number);
}

// Pruning precedes the end, and the last iterations compensate for it.
bool DesignRun::is_time_to_drop() const {
  if (weak_dropped_ || iteration_ == 0) return false;
  return iteration_ == drop_at_ || time_part_ >= options_.drop_at;
}

Scratches DesignRun::new_ones() const {
  std::vector<std::size_t> rows(movable_);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return selected(scratches_, rows);
}

// Discards the held light of faint grooves; the next evaluation renders them.
void DesignRun::forget_others() {
  for (BrightPart& part : bright_) part.others = {};
}

// Computes every view's picture and loss and, unless `last`, the gradient. `rendered`: the pictures show all grooves at
// their present places.
void DesignRun::look(bool last, bool rendered) {
  const double began_s = deadline_.seconds();
  const LyingGrooves grooves = in_the_metal();
  by_carved_ = std::move(gradients_);  // reuses its memory, because the step is done
  by_carved_.resize(grooves.whole.size());
  d_log_exposure_.assign(log_exposure_.size(), 0.0);
  DesignIteration now;
  now.view_loss.assign(shown_, 0.0);
  result_.pairs = 0;
  if (iteration_ % kOthersEvery == 0) forget_others();
  const bool all_seen =
      std::all_of(bright_.begin(), bright_.end(), [](const BrightPart& p) { return p.others.data.empty(); });
  for (std::size_t k = 0; k < views_.size(); ++k) {
    WorkView& v = views_[k];
    const double exposure = std::exp(log_exposure_[v.exposure_group]);
    if (last && !rendered) v.renderer.forward(seen_by(v, grooves), v.radiance);
    if (!last) render_view(v, bright_[k], bench_, grooves, true);
    leave_crossings(v, v.radiance);
    picture_from_radiance(v.radiance, exposure, v.picture);
    v.value = v.loss.evaluate(v.picture, dE_dpicture_);
    now.loss += v.value.total;
    now.view_loss[v.of] += v.value.total;
    result_.pairs += v.renderer.pair_count();
    if (last) continue;
    d_log_exposure_[v.exposure_group] +=
        radiance_gradient(v.radiance, exposure, v.picture, dE_dpicture_, dE_dradiance_);
    leave_crossings(v, dE_dradiance_);
    view_backward(v, bright_[k], {even_bench_, board_}, grooves, dE_dradiance_, by_carved_);
  }
  if (!last) {
    gradients_ = pull_back(grooves.whole, designed_, search_bench_, board_, std::move(by_carved_));
    for (auto* g : {&gradients_.x0_mm, &gradients_.y0_mm, &gradients_.x1_mm, &gradients_.y1_mm})
      std::fill(g->begin() + static_cast<std::ptrdiff_t>(movable_), g->end(), 0.0);  // existing grooves stay
  }
  if (all_seen && rims_count_) look_s_ = deadline_.seconds() - began_s;
  if (rims_count_) judge(last ? Exposed::best : Exposed::as_optimized, last);
  now.as_carved = rims_count_;
  if (cut_look_) now = *std::exchange(cut_look_, std::nullopt);
  now.seconds = deadline_.seconds() - iterations_began_s_;
  result_.history.push_back(std::move(now));
  if (!std::isfinite(result_.history.back().loss))
    fail("design", "the loss is not finite at iteration " + std::to_string(iteration_),
         "check the bench's numbers; report this if they are sound");
}

// Evaluates the grooves as they will be carved, separately from the iterations' own pictures.
void DesignRun::look_as_carved(const LyingGrooves& grooves, Faint faint) {
  if (faint == Faint::anew)
    render_all(views_, grooves);
  else
    for (std::size_t k = 0; k < views_.size(); ++k) render_view(views_[k], cut_[k], bench_, grooves, false);
  const std::vector<double> as_worked_on = std::exchange(log_exposure_, fitting_exposures(views_, log_exposure_));
  cut_look_ = DesignIteration{0, std::vector<double>(shown_, 0.0), 0, true};
  for (WorkView& v : views_) {
    picture_from_radiance(v.radiance, std::exp(log_exposure_[v.exposure_group]), v.picture);
    v.value = v.loss.evaluate(v.picture, dE_dpicture_);
    cut_look_->loss += v.value.total;
    cut_look_->view_loss[v.of] += v.value.total;
  }
  judge(Exposed::best, faint == Faint::anew);
  record_start();
  log_exposure_ = as_worked_on;
}

double DesignRun::psnr_db(std::span<const WorkView> channels, Exposed exposed) const {
  const Image picture =
      exposed == Exposed::best ? shown_of(channels, best_exposures(channels, log_exposure_)) : picture_of(channels);
  return color_psnr_db(picture, target_of(channels), channels[0].target.mask);
}

// Whether the loss equals PSNR's error, for the original pictures without off-axis viewpoints.
bool DesignRun::psnr_is_minimized() const {
  return options_.loss.perceptual == 0 && options_.loss.gram == 0 && !views_.back().aside &&
         std::all_of(views_.begin(), views_.end(), [](const WorkView& v) { return v.wanted.data.empty(); });
}

// Judges the last evaluation as carved. Views count by their weights. The logarithm prevents the sacrifice of one view
// for another.
void DesignRun::judge(Exposed exposed, bool exactly) {
  const bool by_psnr = psnr_is_minimized();
  std::vector<double> loss(shown_, 0.0);
  for (const WorkView& v : views_) loss[v.of] += v.value.total;
  double sum = 0, weights = 0, mean_db = 0;
  const auto shown = shown_views();
  for (std::size_t k = 0; k < shown_; ++k) {
    const double db = psnr_db(shown[k], exposed), weight = spec_.views[k].weight;
    sum += weight * (by_psnr ? db : -10 * std::log10(std::max(loss[k], 1e-12)));
    weights += weight;
    mean_db += db / static_cast<double>(shown_);
  }
  looked_db_ = mean_db;
  merit_ = weights > 0 ? sum / weights : 0;
  if (!best_ || merit_ > best_->merit) best_ = as_looked_at(exactly);
}

DesignRun::Iterate DesignRun::as_looked_at(bool exactly) const {
  return {scratches_, log_exposure_, log_shared_, movable_, result_.dropped, result_.loss_before_drop, merit_, exactly};
}

void DesignRun::go_back_to(const Iterate& iterate) {
  scratches_ = iterate.scratches;
  log_exposure_ = iterate.log_exposure;
  log_shared_ = iterate.log_shared;
  movable_ = iterate.movable;
  result_.dropped = iterate.dropped;
  result_.loss_before_drop = iterate.loss_before_drop;
  merit_ = iterate.merit;
}

// Returns to the best iterate if the last evaluation, which was exact, is worse.
void DesignRun::take_back_best() {
  if (best_ && best_->merit > merit_) {
    const Iterate last = as_looked_at(true);
    go_back_to(*best_);
    if (!best_->exactly) {
      best_ = last;
      look_as_carved(in_the_metal(), Faint::anew);
      if (!(merit_ > last.merit)) go_back_to(last);
    }
  }
  momenta_ = {Adam(count()), Adam(count()), Adam(count()), Adam(count()), Adam(log_exposure_.size()), Adam(3)};
  forget_others();
}

// Records the last evaluation for the result and the observer.
void DesignRun::record(bool last) {
  record_start();
  if (last || std::find(contact_.begin(), contact_.end(), iteration_) != contact_.end()) {
    ContactFrame frame{iteration_, {}};
    for (const std::span<WorkView> channels : shown_views()) {
      Image picture = picture_of(channels);
      for (float& p : picture.data) p = std::min(1.0F, p);
      // Small, because whole ones of large designs would take a gigabyte.
      frame.pictures.push_back(for_contact_sheet(picture));
    }
    result_.frames.push_back(std::move(frame));
  }
  show(iteration_, result_.history.back().loss, result_.history.back().view_loss,
       std::exchange(looked_db_, std::nullopt));
  report("designing", iterations_ > 0 ? static_cast<double>(iteration_) / iterations_ : 1);
}

void DesignRun::show(int iteration, double loss, const std::vector<double>& view_loss, std::optional<double> psnr_db) {
  if (!options_.watch) return;
  DesignFrame frame{iteration, loss, view_loss, {}, deadline_.seconds(), psnr_db};
  const auto shown = shown_views();
  color_pictures_.clear();
  color_pictures_.reserve(shown.size());
  for (const std::span<WorkView> channels : shown) {
    const bool gray = channels.size() == 1;
    if (!gray) color_pictures_.push_back(picture_of(channels));
    const Image& picture = gray ? channels[0].picture : color_pictures_.back();
    frame.pictures.push_back(&picture);
  }
  options_.watch(frame);
}

// Shows the start as last rendered.
void DesignRun::show_start() {
  if (!options_.watch) return;
  for (const std::span<WorkView> channels : shown_views())
    for (WorkView& v : channels)
      picture_from_radiance(v.radiance, std::exp(log_exposure_[v.exposure_group]), v.picture);
  show(0, 0, {}, std::nullopt);
}

void DesignRun::record_start() {
  if (!result_.views.empty()) return;
  for (const std::span<WorkView> channels : shown_views()) {
    DesignedView out;
    const Image target = target_of(channels);
    out.start = shown_of(channels, best_exposures(channels, log_exposure_));
    out.start_psnr_db = color_psnr_db(out.start, target, channels[0].target.mask);
    out.start_ssim = color_ssim(out.start, target, channels[0].target.mask);
    result_.views.push_back(std::move(out));
  }
}

void DesignRun::move_ends() {
  const double rate = last_rate_ + (first_rate_ - last_rate_) * 0.5 * (1 + std::cos(std::numbers::pi * part_));
  const Scratches before = scratches_;
  momenta_.x0.step(scratches_.x0_mm, gradients_.x0_mm, rate * board_.size_mm.x());
  momenta_.y0.step(scratches_.y0_mm, gradients_.y0_mm, rate * board_.size_mm.y());
  momenta_.x1.step(scratches_.x1_mm, gradients_.x1_mm, rate * board_.size_mm.x());
  momenta_.y1.step(scratches_.y1_mm, gradients_.y1_mm, rate * board_.size_mm.y());
  for (std::size_t i = 0; i < movable_; ++i) {
    const Ends e = ends_of(before, i);
    confine(scratches_, i, limits_, e.a, e.b);
  }
}

bool DesignRun::searches_are_over() const {
  const double latest = order_matters(bench_) ? kSettledFrom : grooves_cut_each_other() ? kRimsFrom : 1;
  return part_ >= std::min(options_.relocate_until, latest);
}

// Settles the carving order once no search moves scratches any more.
void DesignRun::settle_order() {
  if (in_last_order_ || !order_matters(bench_) || deadline_.wished()) return;
  report("ordering scratches", 0);
  put_in_carving_order(true);
  best_.reset();  // it has another order
  in_last_order_ = true;
  forget_others();
}

// Switches to grooves as they will be cut; the pictures lose light by this. Returns whether they were rendered so.
bool DesignRun::count_rims() {
  if (rims_count_) return false;
  report("cutting rims away where scratches cross", 0);
  rims_count_ = true;
  forget_others();
  render_all(views_, in_the_metal());
  log_exposure_ = fitting_exposures(views_, log_exposure_);
  return true;
}

std::vector<Image> DesignRun::uncut_radiances(const std::vector<BrightPart>& parts, const Carved& whole) {
  std::vector<Image> out;
  for (std::size_t k = 0; k < views_.size(); ++k) out.push_back(uncut_radiance(views_[k], parts[k], bench_, whole));
  return out;
}

// Before cuts count, their effect is rendered now and then.
void DesignRun::look_at_crossings() {
  constexpr int kEvery = 5, kFaintEvery = 20;
  if (rims_count_ || iteration_ % kEvery != 0) return;
  const bool anew = iteration_ % kFaintEvery == 0;
  if (anew)
    for (BrightPart& part : cut_) part.others = {};
  const LyingGrooves whole = in_the_metal();
  const double began_s = deadline_.seconds();
  look_as_carved(in_the_metal(true), Faint::held);
  if (anew) look_s_ = deadline_.seconds() - began_s;
  see_crossings(views_, log_exposure_, uncut_radiances(cut_, whole.whole), cover_of_pixel());
  if (iteration_ > 0) return;
  render_all(views_, whole);
  for (WorkView& v : views_) leave_what_crossings_do(v, v.radiance);
  log_exposure_ = fitting_exposures(views_, log_exposure_);
}

// Applies the crossings' loss to pictures of whole grooves.
void DesignRun::leave_crossings(const WorkView& view, Image& image) const {
  if (!rims_count_) leave_what_crossings_do(view, image);
}

// Covered part of a pixel, by a groove that crosses it along one pixel's length.
double DesignRun::cover_of_pixel() const {
  const Scratches& s = scratches_;
  double length_mm = 0;
  for (std::size_t i = 0; i < count(); ++i) length_mm += std::hypot(s.x1_mm[i] - s.x0_mm[i], s.y1_mm[i] - s.y0_mm[i]);
  const double area = area_mm2(metal_.carved_alone(scratches_).scratches, bench_, board_);
  return length_mm > 0 ? area / (length_mm * views_.front().pitch_mm) : 0;
}

// Runs a sweep with every single crossing, once grooves are cut.
void DesignRun::relocate_cut_some() {
  constexpr int kEvery = 2;  // searches of whole strokes per sweep, which takes about twice as long
  constexpr double kUntil = 0.97;
  if (!grooves_cut_each_other() || options_.relocate_every <= 0 || part_ > kUntil ||
      iteration_ % (kEvery * options_.relocate_every) != 0)
    return;
  const LyingGrooves grooves = in_the_metal();
  for (std::size_t k = 0; k < views_.size(); ++k) render_view(views_[k], bright_[k], bench_, grooves, false);
  see_crossings(views_, log_exposure_, uncut_radiances(bright_, grooves.whole), cover_of_pixel());
  balance_views(views_, log_exposure_, options_.balance);
  const std::vector<std::size_t> moved =
      relocate_cut(scratches_, views_, log_exposure_, limits_, rules_, metal_, movable_,
                   options_.seed + 3000 + iteration_, [this] { return time_to_end(); });
  for (const std::size_t i : moved) momenta_.each_end([i](Adam& adam) { adam.restart(i); });
  result_.relocated += moved.size();
}

void DesignRun::relocate_some() {
  if (options_.relocate_every <= 0 || iteration_ == 0 || iteration_ % options_.relocate_every != 0) return;
  // The views are rendered again: strokes placed before Adam's step by its picture come out 0.3 dB worse.
  const LyingGrooves grooves = in_the_metal();
  for (std::size_t k = 0; k < views_.size(); ++k) {
    render_view(views_[k], bright_[k], bench_, grooves, false);
    leave_crossings(views_[k], views_[k].radiance);
  }
  balance_views(views_, log_exposure_, options_.balance);
  const std::vector<std::size_t> moved =
      relocate(scratches_, views_, log_exposure_, limits_, rules_, movable_, options_.relocate_share,
               options_.seed + 1000 + iteration_, [this] { return time_to_end(); });
  for (const std::size_t i : moved) momenta_.each_end([i](Adam& adam) { adam.restart(i); });
  result_.relocated += moved.size();
}

void DesignRun::keep_only(const std::vector<std::size_t>& kept) {  // new ones first, as always
  if (kept.size() == count()) return;
  if (result_.loss_before_drop == 0) result_.loss_before_drop = result_.history.back().loss;
  movable_ -= count() - kept.size();
  forget_others();
  scratches_ = selected(scratches_, kept);
  momenta_.each_end([&](Adam& adam) { adam.keep(kept); });
}

void DesignRun::drop_weak() {
  weak_dropped_ = true;
  if (!(options_.drop_share > 0 || options_.drop_light > 0 || options_.drop_error > 0)) return;
  report("dropping weak scratches", 0);
  const LyingGrooves lying = in_the_metal();
  std::vector<double> light_sum(count(), 0.0);
  for (WorkView& v : views_) {
    const Carved grooves = seen_by(v, lying);
    std::vector<double> of_groove(grooves.size(), 0.0);
    v.renderer.forward(grooves, v.radiance);
    v.renderer.add_contributions(of_groove);
    const std::vector<double> light = by_design(grooves, of_groove, count());
    for (std::size_t i = 0; i < count(); ++i) light_sum[i] += std::exp(log_exposure_[v.exposure_group]) * light[i];
  }
  const std::vector<std::size_t> weak =
      weak_scratches(stroke_views(views_, log_exposure_, false), rules_, scratches_, movable_, light_sum, options_,
                     [this] { return deadline_.wished(); });
  result_.dropped += weak.size();
  keep_only(all_but(count(), weak));
  // The final result may restore scratches of negligible effect, if it is worse without them. Other pruning is final.
  constexpr double kHardlyMatters = 0.01;  // of the error
  if (options_.drop_share > 0 || options_.drop_light > 0 || options_.drop_error > kHardlyMatters) best_.reset();
}

// Prunes down to the available time, by least marginal contribution per cost. Existing grooves take no time.
void DesignRun::keep_to_budget(double allowed_s) {
  constexpr int kRounds = 8;  // each round divides the travel again; a few meet the time
  for (int round = 0; round < kRounds && movable_ > 1; ++round) {
    const std::vector<double> cost = carving_costs_s(new_ones(), bench_.material.depth_um, options_.carve_machine);
    const double now_s = std::accumulate(cost.begin(), cost.end(), 0.0);
    if (now_s <= allowed_s) return;
    if (deadline_.wished()) {
      result_.findings.push_back(make_warning(
          FindingCode::carve_time,
          "was stopped before its scratches were few enough: they take " + fixed(now_s / 3600, 1) + " hours to carve",
          "continue it, or design again"));
      return;
    }
    report("keeping to the carving time", 0);
    render_all(views_, in_the_metal());
    const std::vector<std::size_t> spared =
        spare_for_time(stroke_views(views_, log_exposure_, false), rules_, scratches_, movable_, cost,
                       now_s - allowed_s, [this] { return deadline_.wished(); });
    result_.dropped += spared.size();
    keep_only(all_but(count(), spared));
    best_.reset();
    // Fewer scratches have to be brighter.
    render_all(views_, in_the_metal());
    log_exposure_ = fitting_exposures(views_, log_exposure_);
  }
}

void DesignRun::keep_to_part_of_budget() {
  const double budget_s = 3600 * options_.carve_hours;
  if (!(budget_s > 0 && full_carving_s_ > budget_s) || drop_at_ < kBudgetSteps) return;
  if (iteration_ == 0 || iteration_ > drop_at_ || iteration_ % (drop_at_ / kBudgetSteps) != 0) return;
  if (deadline_.wished()) return;
  const double part = std::min(1.0, static_cast<double>(iteration_) / drop_at_);
  keep_to_budget(full_carving_s_ * std::pow(budget_s / full_carving_s_, part));
}

// Moves the common width, depth and alpha in logarithms: d/dlog p = p d/dp, summed over the scratches.
void DesignRun::move_shared() {
  if (!optimizes_shared()) return;
  const auto sum = [](const std::vector<double>& g) { return std::accumulate(g.begin(), g.end(), 0.0); };
  const std::vector<double> d_log{options_.optimize_width ? std::exp(log_shared_[0]) * sum(gradients_.width_um) : 0.0,
                                  options_.optimize_depth ? std::exp(log_shared_[1]) * sum(gradients_.depth_um) : 0.0,
                                  options_.optimize_alpha ? std::exp(log_shared_[2]) * sum(gradients_.alpha) : 0.0};
  momenta_.shared.step(log_shared_, d_log, options_.log_rate);
  log_shared_[2] = std::min(log_shared_[2], 0.0);
  spread_shared();
}

void DesignRun::spread_shared() {
  if (options_.optimize_width) scratches_.width_um.assign(count(), std::exp(log_shared_[0]));
  if (options_.optimize_depth) scratches_.depth_um.assign(count(), std::exp(log_shared_[1]));
  if (options_.optimize_alpha) scratches_.alpha.assign(count(), std::exp(log_shared_[2]));
}

}  // namespace burin
