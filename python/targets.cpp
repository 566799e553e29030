#include "targets.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "burin/base/error.h"
#include "burin/optimize/design/bright_part.h"
#include "burin/optimize/design/carving_budget.h"
#include "burin/optimize/design/crossing_loss.h"
#include "burin/optimize/design/design_start.h"
#include "burin/optimize/design/lift_blacks.h"
#include "burin/optimize/design/relocate.h"
#include "burin/optimize/design/weak_scratches.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/toolpath/ends.h"
#include "burin/scene/carve.h"

namespace burin::python {

Targets::Targets(DesignSpec spec, Board board, Bench bench, DesignOptions options)
    : spec_(std::move(spec)),
      board_(std::move(board)),
      bench_(std::move(bench)),
      search_bench_(adding_rims(bench_)),
      options_(std::move(options)) {
  check_options(options_, board_);
  limits_ = design_limits(board_, bench_, options_);
  views_ = prepare_views(spec_, board_, bench_, options_, options_.pixels, limits_, findings_);
  for (WorkView& v : views_) v.sees_lines = glints_along_lines(v, bench_);
  append(findings_, lift_blacks(views_, options_.lift_blacks, options_.loss));
}

void Targets::take(std::span<const Image> radiance, const std::vector<double>& log_exposure) {
  if (radiance.size() != views_.size()) fail("radiance", "has another number of views", "give what render() gives");
  if (log_exposure.size() != views_.size()) fail("log_exposure", "has the wrong size", "give one per view");
  forget_crossings(views_);
  for (std::size_t k = 0; k < views_.size(); ++k) {
    if (radiance[k].width != width() || radiance[k].height != height() || radiance[k].channels != 1)
      fail("radiance", "has another shape than the targets", "give what render() gives");
    views_[k].radiance = radiance[k];
  }
}

TargetLoss Targets::loss(std::span<const Image> radiance, const std::vector<double>& log_exposure) {
  const std::lock_guard lock(mutex_);
  take(radiance, log_exposure);
  TargetLoss out;
  Image dE_dpicture;
  for (std::size_t k = 0; k < views_.size(); ++k) {
    WorkView& v = views_[k];
    const double exposure = std::exp(log_exposure[k]);
    picture_from_radiance(v.radiance, exposure, v.picture);
    out.view_loss.push_back(v.loss.evaluate(v.picture, dE_dpicture).total);
    out.dE_dlog_exposure.push_back(
        radiance_gradient(v.radiance, exposure, v.picture, dE_dpicture, out.dE_dradiance.emplace_back()));
  }
  return out;
}

std::vector<double> Targets::fitting(std::span<const Image> radiance, const std::vector<double>& log_exposure) {
  const std::lock_guard lock(mutex_);
  take(radiance, log_exposure);
  return fitting_exposures(views_, log_exposure);
}

std::vector<double> Targets::psnr_db(std::span<const Image> radiance, const std::vector<double>& log_exposure) {
  const std::lock_guard lock(mutex_);
  take(radiance, log_exposure);
  std::vector<double> out;
  for (const std::span<WorkView> channels : shown_channels(views_))
    out.push_back(color_psnr_db(shown_of(channels, best_exposures(channels, log_exposure)), target_of(channels),
                                channels[0].target.mask));
  return out;
}

// As DesignRun::choose_stroke_rules() for a guided start: scratches of this length in a row would cover 0.8 of a view's
// pixels.
double Targets::mean_length_mm(std::size_t count) const {
  const Eigen::Vector2d area = limits_.max_mm - limits_.min_mm;
  const double pixel_mm = views_.front().pitch_mm;
  return std::clamp(0.8 * area.x() * area.y() * static_cast<double>(views_served(views_).size()) /
                        (static_cast<double>(count) * pixel_mm),
                    3 * pixel_mm, 0.2 * area.minCoeff());
}

StrokeRules Targets::rules_for(std::size_t count) const {
  return stroke_rules(limits_, mean_length_mm(count), bench_, board_, options_.candidates);
}

double Targets::cover_of_pixel(const Scratches& s) const {
  double length_mm = 0;
  for (std::size_t i = 0; i < s.size(); ++i) length_mm += std::hypot(s.x1_mm[i] - s.x0_mm[i], s.y1_mm[i] - s.y0_mm[i]);
  const double area = area_mm2(metal_.carved_alone(s).scratches, bench_, board_);
  return length_mm > 0 ? area / (length_mm * views_.front().pitch_mm) : 0;
}

void Targets::render(const Scratches& scratches) {
  forget_crossings(views_);
  render_all(views_, LyingGrooves(carve(Designed(scratches), search_bench_, board_)));
}

Searched Targets::start(std::size_t count, std::uint64_t seed, const Stop& stop) {
  const std::lock_guard lock(mutex_);
  forget_crossings(views_);
  const StrokeRules rules = rules_for(count);
  Searched out;
  out.log_exposure = starting_exposures(views_, views_.size(), options_.start_light);
  std::vector<StrokeView> light = stroke_views(views_, out.log_exposure, true);
  const Scratches placed = burin::scratches_of(place_strokes(light, rules, count, seed, stop));
  const double length_mm = mean_length_mm(count);
  out.scratches = joined(placed, random_start(count - placed.size(), limits_, length_mm, seed + 1),
                         board_.tool_width_um, bench_.material.depth_um, bench_.material.alpha);
  settle(out.scratches, limits_, length_mm, seed + 2);
  for (int sweep = 0; sweep <= options_.start_sweeps; ++sweep) {
    render(out.scratches);
    out.log_exposure = fitting_exposures(views_, out.log_exposure);
    if (sweep < options_.start_sweeps && !(stop && stop()))
      relocate(out.scratches, views_, out.log_exposure, limits_, rules, count, 0,
               seed + 100 + static_cast<std::uint64_t>(sweep), stop);
  }
  return out;
}

Searched Targets::search(Scratches scratches, const std::vector<double>& log_exposure, double share, std::uint64_t seed,
                         const Stop& stop) {
  const std::lock_guard lock(mutex_);
  if (log_exposure.size() != views_.size()) fail("log_exposure", "has the wrong size", "give one per view");
  const std::size_t count = scratches.size();
  for (std::size_t i = 0; i < count; ++i)
    confine(scratches, i, limits_, ends_of(scratches, i).a, ends_of(scratches, i).b);
  const StrokeRules rules = rules_for(count);
  Searched out;
  if (grooves_cut_each_other()) {
    const LyingGrooves grooves = grooves_in(scratches, metal_, views_);
    forget_crossings(views_);
    render_all(views_, grooves);
    std::vector<Image> uncut(views_.size());
    for (std::size_t k = 0; k < views_.size(); ++k) views_[k].renderer.forward(grooves.whole, uncut[k]);
    see_crossings(views_, log_exposure, std::move(uncut), cover_of_pixel(scratches));
    balance_views(views_, log_exposure, options_.balance);
    out.rows = relocate_cut(scratches, views_, log_exposure, limits_, rules, metal_, count, seed, stop);
  } else {
    render(scratches);
    balance_views(views_, log_exposure, options_.balance);
    out.rows = relocate(scratches, views_, log_exposure, limits_, rules, count, share, seed, stop);
  }
  out.log_exposure = log_exposure;
  out.scratches = std::move(scratches);
  return out;
}

Searched Targets::drop(const Scratches& scratches, const std::vector<double>& log_exposure, double error, double share,
                       const Stop& stop) {
  const std::lock_guard lock(mutex_);
  if (log_exposure.size() != views_.size()) fail("log_exposure", "has the wrong size", "give one per view");
  const std::size_t count = scratches.size();
  std::vector<double> light_sum(count, 0.0);
  const LyingGrooves lying = grooves_in(scratches, metal_, views_);
  forget_crossings(views_);
  for (std::size_t k = 0; k < views_.size(); ++k) {
    WorkView& v = views_[k];
    const Carved grooves = seen_by(v, lying);
    std::vector<double> of_groove(grooves.size(), 0.0);
    v.renderer.forward(grooves, v.radiance);
    v.renderer.add_contributions(of_groove);
    const std::vector<double> light = by_design(grooves, of_groove, count);
    for (std::size_t i = 0; i < count; ++i) light_sum[i] += std::exp(log_exposure[k]) * light[i];
  }
  DesignOptions options;
  options.drop_error = error;
  options.drop_share = share;
  const std::vector<std::size_t> weak = weak_scratches(stroke_views(views_, log_exposure, false), rules_for(count),
                                                       scratches, count, light_sum, options, stop);
  Searched out;
  out.rows = all_but(count, weak);
  out.scratches = selected(scratches, out.rows);
  out.log_exposure = log_exposure;
  return out;
}

}  // namespace burin::python
