#include "burin/optimize/design/design_run.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "burin/base/degrees.h"
#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/limits.h"
#include "burin/optimize/design/bright_part.h"
#include "burin/optimize/design/carving_budget.h"
#include "burin/optimize/design/crowding.h"
#include "burin/optimize/design/design_memory.h"
#include "burin/optimize/design/design_start.h"
#include "burin/optimize/design/lift_blacks.h"
#include "burin/optimize/design/obey.h"
#include "burin/optimize/design/picture_pixels.h"
#include "burin/optimize/design/relocate.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/loss/picture_metrics.h"
#include "burin/optimize/target.h"
#include "burin/optimize/toolpath/carving_order.h"
#include "burin/optimize/toolpath/carving_time.h"
#include "burin/scene/crossings.h"

namespace burin {
namespace {

constexpr double kStartShare = 0.4;  // of the time limit: iterations gain more than a better start

// The scratches to design, if the design continues an earlier one, and the existing grooves.
std::pair<Scratches, Scratches> new_and_carved(const DesignOptions& options, const Board& board, const Bench& bench) {
  if (options.carved.size() > 0 && (options.optimize_width || options.optimize_depth || options.optimize_alpha))
    fail("design", "the groove of what is carved already cannot be chosen any more",
         "leave out --free width, --free depth and --free alpha, or --carved");
  if (!options.from) return {{}, options.carved};
  std::vector<std::size_t> fresh, done;
  for (std::size_t i = 0; i < options.from->size(); ++i) (options.from->is_carved(i) ? done : fresh).push_back(i);
  Scratches carved = selected(*options.from, done), from = selected(*options.from, fresh);
  carved.carved.clear();
  from.carved.clear();
  return {from, joined(carved, options.carved, board.tool_width_um, bench.material.depth_um, bench.material.alpha)};
}

}  // namespace

DesignRun::DesignRun(const DesignSpec& spec, const Board& board, const Bench& bench, const DesignOptions& options,
                     const Progress& progress)
    : spec_(spec),
      board_(board),
      bench_(bench),
      options_(options),
      progress_(progress),
      iterations_(options.iterations.value_or(grooves_cut_each_other() ? 70 : 160)),
      deadline_(options.time_limit_s, options.stop) {
  check_options(options, board);
  if (spec.scratches < 1 || spec.views.empty())
    fail("design", "there are no scratches or no views", "give at least one of each");
}

DesignResult DesignRun::run() {
  take_stock();
  read_targets();
  do {
    place();
    expose();
    improve_start();
  } while (looks_too_closely() || is_crowded() || start_with_less_to_cut());
  if (too_many_to_cut_ > 0)
    result_.findings.push_back(make_warning(FindingCode::scratch_count,
                                            std::to_string(too_many_to_cut_) +
                                                " scratches would cross each other too often for their crossings to be "
                                                "cut: began with " +
                                                std::to_string(movable_)));
  if (pixels_ < asked_pixels() && options_.note_few_strokes)
    result_.findings.push_back(pixels_were_chosen(views_, movable_ + carved_.size(), bench_.crossings));
  iterate();
  obey_all_rules();
  measure();
  result_.stopped_early = result_.stopped_early || deadline_.wished();
  result_.total_seconds = deadline_.seconds();
  return std::move(result_);
}

void DesignRun::take_stock() {
  std::tie(from_, carved_) = new_and_carved(options_, board_, bench_);
  result_.carved = carved_.size();
  if (options_.from && from_.size() == 0)
    fail("design", "there are no scratches to go on from", "give a scratches.csv that holds some");
  if (!options_.from && carved_.size() >= static_cast<std::size_t>(spec_.scratches))
    fail("design",
         counted(static_cast<std::size_t>(spec_.scratches), "scratch") + " asked for, and " +
             std::to_string(carved_.size()) + " carved already",
         "ask for more: the number counts what is carved");
  movable_ = new_at_first();
}

void DesignRun::read_targets() {
  report("reading targets", 0);
  limits_ = design_limits(board_, bench_, options_);
  pixels_ = asked_pixels();
  const Eigen::Vector2d area = board_.carve_max_mm - board_.carve_min_mm;
  const double pictures = static_cast<double>(spec_.views.size()) * (options_.tolerance_mm > 0 ? 3 : 1);
  require_memory(pictures * pixels_ * pixels_ * area.minCoeff() / area.maxCoeff(), pixels_,
                 static_cast<double>(new_at_first() + carved_.size()), free_bytes());
  std::vector<Finding> found;
  do {
    found.clear();
    lay_targets(found);
  } while (take_fewer_pixels());
  append(result_.findings, found);
  if (options_.note_few_strokes && !options_.from && pixels_ == asked_pixels())
    if (const auto many = pixels_are_many(views_, movable_ + carved_.size(), bench_.crossings))
      result_.findings.push_back(*many);
  if (options_.found) options_.found(result_.findings);
  look_at_the_carved();
}

// The pixels that eyes at the viewpoints resolve, by which designs are compared. A random start is the paper's.
int DesignRun::asked_pixels() const {
  if (options_.pixels > 0) return options_.pixels;
  return starts_at_random() ? kUsualPixels : pixels_of_eyes(limits_.max_mm - limits_.min_mm, eye_distance_mm());
}

// Prepares the views on `pixels_` pixels.
void DesignRun::lay_targets(std::vector<Finding>& found) {
  views_ = prepare_views(spec_, board_, bench_, options_, pixels_, limits_, found);
  for (WorkView& v : views_) v.sees_lines = glints_along_lines(v, bench_);
  append(found, lift_blacks(views_, options_.lift_blacks, options_.loss));
  shown_ = spec_.views.size();
  const int last_group = std::max_element(views_.begin(), views_.end(), [](const WorkView& a, const WorkView& b) {
                           return a.exposure_group < b.exposure_group;
                         })->exposure_group;
  log_exposure_.assign(static_cast<std::size_t>(last_group) + 1, 0.0);
}

bool DesignRun::take_fewer_pixels() {
  if (options_.pixels > 0 || starts_at_random()) return false;
  const bool crowded = grooves_cut_each_other() && count() > 0 && pixels_crowd(cover_now());
  const auto fewer = fewer_pixels(pixels_, pixels_a_stroke(views_, movable_ + carved_.size()), crowded);
  if (fewer) pixels_ = *fewer;
  return fewer.has_value();
}

// Reduces the pixels if strokes cannot fill them. The number of strokes was found by trying, which fixed their length;
// in larger pixels they are shorter and more.
bool DesignRun::looks_too_closely() {
  if (options_.from || deadline_.wished_or_used(kStartShare) || !take_fewer_pixels()) return false;
  result_.findings.resize(findings_before_start_);
  movable_ = new_at_first();
  too_many_to_cut_ = 0;
  std::vector<Finding> told_before;
  lay_targets(told_before);
  look_at_the_carved();
  return true;
}

// Checks the unchangeable parts: the face and its existing grooves.
void DesignRun::look_at_the_carved() {
  findings_before_start_ = result_.findings.size();
  if (carved_.size() == 0) return;
  Scratches lying = carved_;
  lying.carved.assign(lying.size(), 1);
  const Carved grooves = metal_.carved(lying);
  for (WorkView& v : views_) v.renderer.forward(grooves, v.face);
}

void DesignRun::place() {
  do {
    choose_stroke_rules();
    start_strokes();
    settle(scratches_, limits_, mean_length_mm_, options_.seed + 2);
  } while (start_with_fewer() || start_with_less_to_cut());
  result_.started_with = movable_;
  join_carved();
  if (!options_.from) put_in_carving_order(false);
}

void DesignRun::choose_stroke_rules() {
  const Eigen::Vector2d area = limits_.max_mm - limits_.min_mm;
  // Guided start: the search chooses every length within this bound. Scratches of this length in a row would cover 0.8
  // of a view's pixels.
  const double pixel_mm = views_.front().pitch_mm;
  const std::size_t all = movable_ + carved_.size();
  const double covering = std::clamp(0.8 * area.x() * area.y() * static_cast<double>(views_served(views_).size()) /
                                         (static_cast<double>(all) * pixel_mm),
                                     3 * pixel_mm, 0.2 * area.minCoeff());
  mean_length_mm_ = options_.start_length_mm > 0      ? options_.start_length_mm
                    : options_.start == Start::guided ? covering
                                                      : 0.03 * area.maxCoeff();
  rules_ = stroke_rules(limits_, mean_length_mm_, bench_, board_, options_.candidates);
}

void DesignRun::start_strokes() {
  if (options_.from) {
    scratches_ = from_;
    return;
  }
  if (options_.start == Start::random) {
    scratches_ = random_start(movable_, limits_, mean_length_mm_, options_.seed);
    return;
  }
  // Exposures hardly change afterwards, because existing strokes have the right brightness for them.
  log_exposure_ = starting_exposures(views_, log_exposure_.size(), options_.start_light);
  report("placing scratches", 0);
  const auto enough = [this] { return deadline_.wished_or_used(kStartShare); };
  std::vector<StrokeView> light = stroke_views(views_, log_exposure_, true);
  scratches_ = scratches_of(place_strokes(light, rules_, movable_, options_.seed, enough));
  if (scratches_.size() < movable_ && enough())
    result_.findings.push_back(make_warning(FindingCode::start_cut_short,
                                            "the start was ended early: " + std::to_string(scratches_.size()) + " of " +
                                                std::to_string(movable_) +
                                                " scratches begin where the pictures want them, the rest anywhere"));
  // If the model finds no further gain, the rest starts at random places: re-insertion may still find places for them.
  scratches_ =
      joined(scratches_, random_start(movable_ - scratches_.size(), limits_, mean_length_mm_, options_.seed + 1),
             board_.tool_width_um, bench_.material.depth_um, bench_.material.alpha);
}

// Reduces the number of scratches if their carving takes too long, and returns whether the start has to be repeated. Up
// to a quarter more than fit the time may start and be pruned. More would only make the others dimmer.
bool DesignRun::start_with_fewer() {
  constexpr double kMore = 1.25;
  if (!(options_.carve_hours > 0) || options_.from) return false;
  const double hours = carving_time_s(scratches_, bench_.material.depth_um, options_.carve_machine) / 3600;
  const auto fewer = static_cast<std::size_t>(kMore * options_.carve_hours / hours * static_cast<double>(movable_));
  if (!(hours > 1.1 * kMore * options_.carve_hours) || fewer == 0) return false;
  result_.findings.push_back(
      make_warning(FindingCode::carve_time, std::to_string(movable_) + " scratches would take " + fixed(hours, 1) +
                                                " hours to carve: began with " + std::to_string(fewer) + " for the " +
                                                fixed(options_.carve_hours, 1) + " there are"));
  movable_ = fewer;
  return true;
}

// Reduces the number of scratches if crossings would leave too many pieces, and returns whether the start has to be
// repeated. Strokes grow during the design, but pay for their crossings: a fifth of the permitted pieces is reserved
// for growth. Fewer strokes may be longer, so their number is found by trying.
bool DesignRun::start_with_less_to_cut() {
  constexpr double kFewer = 0.85;
  constexpr std::size_t kMostPieces = limit::kCuts / 5 * 4;
  constexpr double kFarFromMost = 0.25;  // counting the pieces by cutting takes as long as an iteration
  if (options_.from || bench_.crossings == Crossings::add) return false;
  const Scratches all =
      joined(new_ones(), carved_, board_.tool_width_um, bench_.material.depth_um, bench_.material.alpha);
  const Eigen::Vector2d area = limits_.max_mm - limits_.min_mm;
  if (expected_pieces(all, area.prod()) < kFarFromMost * static_cast<double>(kMostPieces)) return false;
  if (!are_more_pieces(all, board_.tool_width_um, bench_.material.depth_um, bench_.material.profile, bench_.crossings,
                       kMostPieces))
    return false;
  const auto fewer = static_cast<std::size_t>(kFewer * static_cast<double>(movable_));
  if (fewer == 0) return false;
  too_many_to_cut_ = std::max(too_many_to_cut_, movable_);
  movable_ = fewer;
  return true;
}

// Without time left for a start, it stays as it is.
bool DesignRun::is_crowded() {
  if (!grooves_cut_each_other() || options_.from || deadline_.wished_or_used(kStartShare)) return false;
  const double cover = cover_now();
  // Details below the eyes' resolution need no strokes of their own.
  const double eye_px = pixels_of_eyes(limits_.max_mm - limits_.min_mm, eye_distance_mm()),
               told_apart = std::pow(std::min(1.0, eye_px / pixels_), 2);
  const auto fewer = fewer_strokes(count(), told_apart * pixels_a_stroke(views_, count()), cover);
  if (!fewer) return false;
  // Existing grooves stay; at least a fifth of the best number is new.
  const std::size_t fewer_new =
      std::max(*fewer > carved_.size() ? *fewer - carved_.size() : 0, std::max<std::size_t>(*fewer / 5, 1));
  if (fewer_new >= movable_) return false;
  result_.findings.push_back(
      make_warning(FindingCode::scratch_count,
                   std::to_string(movable_) + " scratches would cover the carve area " + fixed(cover, 1) +
                       " times and cut each other's rims away, and with them most of their light: began with " +
                       std::to_string(fewer_new) + ", which show more"));
  movable_ = fewer_new;
  return true;
}

// How many times all grooves, side by side, would cover the carve area.
double DesignRun::cover_now() const {
  const Eigen::Vector2d size = limits_.max_mm - limits_.min_mm;
  return area_mm2(metal_.carved_alone(scratches_).scratches, bench_, board_) / (size.x() * size.y());
}

void DesignRun::join_carved() {
  if (carved_.size() == 0) return;
  scratches_ = joined(scratches_, carved_, board_.tool_width_um, bench_.material.depth_um, bench_.material.alpha);
  scratches_.carved.assign(movable_, 0);
  scratches_.carved.resize(movable_ + carved_.size(), 1);
}

// Grooves as the search uses them, or as they will cut each other.
LyingGrooves DesignRun::in_the_metal(bool cut) const {
  return cut ? grooves_in(scratches_, metal_, views_) : LyingGrooves(carve(designed_, search_bench_, board_));
}

void DesignRun::put_in_carving_order(bool thoroughly) {
  if (!order_matters(bench_)) return;
  CarvingOrderOptions options;
  options.stop = [this] { return deadline_.wished(); };
  if (!thoroughly) options.kicks_per_scratch = 0;
  std::vector<CarvingStep> order = carving_order(new_ones(), options);
  for (std::size_t i = movable_; i < count(); ++i) order.push_back({static_cast<std::uint32_t>(i), false});
  scratches_ = in_carving_order(scratches_, order);
  if (momenta_.x0.size() != count()) return;  // before the iterations
  std::vector<std::size_t> rows;
  rows.reserve(order.size());
  for (const CarvingStep& step : order) rows.push_back(step.scratch);
  momenta_.each_end([&](Adam& adam) { adam.keep(rows); });
  for (std::size_t i = 0; i < movable_; ++i)
    if (order[i].reversed) {
      momenta_.x0.exchange(i, momenta_.x1);
      momenta_.y0.exchange(i, momenta_.y1);
    }
}

void DesignRun::expose() {
  render_all(views_, in_the_metal());
  std::vector<double> wanted(log_exposure_.size(), 0.0), given(log_exposure_.size(), 0.0);
  for (const WorkView& v : views_) {
    const double mean = mean_value(v.radiance);
    if (!(mean > 0)) fail("view " + v.spec.view, "is black", "check the lamp's intensity and position in the bench");
    if (v.exposed_by != v.channel) continue;  // it has no exposure of its own
    wanted[v.exposure_group] += mean_light(v.target.picture);
    given[v.exposure_group] += mean;
  }
  for (const WorkView& v : views_)
    if (!(wanted[v.exposure_group] > 0) && !v.spec.exposure)
      fail("view " + v.spec.view, "is to show a picture that is black all over, which no exposure fits",
           "give one with something bright in it");
  const double start = starts_at_random() ? options_.start_exposure : 1;
  for (std::size_t g = 0; g < log_exposure_.size(); ++g) log_exposure_[g] = std::log(start * wanted[g] / given[g]);
  hold_exposures(views_, log_exposure_);
  if (!starts_at_random()) log_exposure_ = fitting_exposures(views_, log_exposure_);
  show_start();
}

void DesignRun::improve_start() {
  if (options_.from || options_.start != Start::guided) return;
  const auto enough = [this] { return deadline_.wished_or_used(kStartShare); };
  for (int k = 0; k < options_.start_sweeps && !enough(); ++k) {
    report("searching places", static_cast<double>(k) / options_.start_sweeps);
    relocate(scratches_, views_, log_exposure_, limits_, rules_, movable_, 0, options_.seed + 100 + k, enough);
    render_all(views_, in_the_metal());
    log_exposure_ = fitting_exposures(views_, log_exposure_);
    show_start();
  }
}

// Re-inserts or drops invalid scratches.
void DesignRun::obey_all_rules() {
  if (options_.optimize_width) limits_.width_um = std::exp(log_shared_[0]);
  Obeying obeying = obey(scratches_, limits_, views_, log_exposure_, rules_, metal_, options_.seed + 2000,
                         [this] { return deadline_.wished_or_used(1); });
  for (std::size_t r = 0; r < kRules; ++r) result_.dropped_by_rule[r] += obeying.dropped[r];
  if (obeying.rows.size() == result_.carved)
    fail("design", "no scratch can obey the machine's limits (" + dropped_text(obeying.dropped) + " were dropped)",
         "loosen them, or make the board's keep-outs smaller");
  scratches_ = std::move(obeying.scratches);
  fail_unless_good(check_limits(scratches_, limits_), "design");
  movable_ = count() - result_.carved;
}

void DesignRun::measure() {
  measure_pictures();
  // A stop skips all optional measurements.
  const auto wished = [this] { return deadline_.wished(); };
  if ((options_.report_tolerance || options_.tolerance_mm > 0) && !wished()) {
    std::vector<ToleranceTarget> targets;
    const auto shown = shown_views();
    for (std::size_t k = 0; k < shown_; ++k)
      targets.push_back({result_.views[k].target, shown[k][0].target.mask, result_.views[k].best_exposure,
                         result_.views[k].color ? result_.views[k].color->white_gain : std::array<double, 3>{1, 1, 1}});
    result_.tolerance = measure_tolerance(spec_, board_, bench_, targets, scratches_, progress_, wished);
  }
  measure_ghosts();
  if ((options_.carve_curve || options_.carve_hours > 0) && !wished()) {
    report("measuring the curve over carving time", 0);
    result_.curve =
        carving_curve(views_, log_exposure_, rules_, scratches_, movable_, metal_, options_.carve_machine, wished);
  }
  measure_for_eyes();
  const bool more_fit = result_.started_with == new_at_first();
  for (std::size_t k = 0; k < view_limits_.size(); ++k)
    result_.findings.push_back(
        limits_in_words(result_.views[k].view, result_.views[k].eye_psnr_db, view_limits_[k], more_fit));
  if (options_.optimize_width) result_.width_um = std::exp(log_shared_[0]);
  if (options_.optimize_depth) result_.depth_um = std::exp(log_shared_[1]);
  if (options_.optimize_alpha) result_.alpha = std::exp(log_shared_[2]);
  result_.scratches = std::move(scratches_);
  warn_if_hardly_any_is_left();
}

// Warns if pruning leaves few scratches. A scratch that helps one picture and harms another at the same place has no
// value for either, and is dropped.
void DesignRun::warn_if_hardly_any_is_left() {
  constexpr double kHardlyAny = 0.1;
  const std::size_t left = result_.scratches.size() - result_.carved;
  if (static_cast<double>(left) > kHardlyAny * static_cast<double>(result_.started_with)) return;
  result_.findings.push_back(make_warning(
      FindingCode::scratch_count,
      "only " + std::to_string(left) + " of " + counted(result_.started_with, "scratch") +
          " showed anything, so the board will show next to nothing" +
          (shown_ > 1 ? ": the " + std::to_string(shown_) +
                            " views need the same scratches for different pictures, or see them too weakly"
                      : ": the view sees them too weakly"),
      "design for fewer views, further apart, or move the lamp; burin sheet draws where eyes and lamps are"));
}

void DesignRun::measure_pictures() {
  const LyingGrooves grooves = in_the_metal();
  render_all(views_, grooves);
  for (WorkView& v : views_) {
    picture_from_radiance(v.radiance, std::exp(log_exposure_[v.exposure_group]), v.picture);
    v.value = v.loss.evaluate(v.picture, dE_dpicture_);
    result_.final_loss += v.value.total;
  }
  const auto shown = shown_views();
  for (std::size_t k = 0; k < shown_; ++k) {
    measure_picture(shown[k], result_.views[k]);
    report("measuring", static_cast<double>(k + 1) / static_cast<double>(shown_));
  }
  if (options_.note_few_strokes && !deadline_.wished()) measure_limits(grooves);
}

// Measures the limits of each view: the same grooves, rendered without one effect at a time.
void DesignRun::measure_limits(const LyingGrooves& grooves) {
  report("measuring what limits the views", 0);
  for (const std::span<WorkView> channels : shown_views())
    view_limits_.push_back(limits_of(channels, log_exposure_, grooves, bench_, board_));
}

void DesignRun::measure_picture(std::span<const WorkView> channels, DesignedView& out) const {
  const WorkView& v = channels[0];
  out.view = v.spec.view;
  out.light = v.spec.light;
  out.rotation_deg = v.rotation_deg;
  out.exposure = std::exp(log_exposure_[v.exposure_group]);
  out.loss = v.value;
  for (const WorkView& more : channels.subspan(1)) {
    out.loss.total += more.value.total;
    out.loss.perceptual += more.value.perceptual;
    out.loss.l2 += more.value.l2;
    out.loss.gram += more.value.gram;
  }
  out.target = target_of(channels);
  const std::vector<double> exposures = best_exposures(channels, log_exposure_);
  const std::vector<double> free = free_exposures(channels, log_exposure_);
  out.best_exposure = std::accumulate(free.begin(), free.end(), 0.0) / static_cast<double>(free.size());
  out.shown = shown_of(channels, exposures);
  out.psnr_db = color_psnr_db(out.shown, out.target, v.target.mask);
  out.ssim = color_ssim(out.shown, out.target, v.target.mask);
  // The plain face alone at the same exposure is the darkest possible picture.
  std::vector<Image> achievable;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    Image face = channels[c].face;
    for (float& f : face.data) f *= static_cast<float>(exposures[c]);
    const Image& mixable = channels[c].mixable;
    achievable.push_back(within_contrast(mixable.data.empty() ? asked_for(channels[c]) : mixable, face));
  }
  out.achievable = channels.size() == 1 ? achievable[0] : in_color(achievable[0], achievable[1], achievable[2]);
  out.achievable_psnr_db = color_psnr_db(out.achievable, out.target, v.target.mask);
  if (channels.size() == 1) return;
  DesignedColor color{color_quality(out.shown, out.target, v.target.mask), {}};
  for (std::size_t c = 0; c < 3; ++c)
    color.white_gain[c] = channels[c].gains[static_cast<Eigen::Index>(c)] * free[c] / out.best_exposure;
  out.color = color;
}

double DesignRun::eye_distance_mm() const {
  const Eigen::Vector2d middle = (limits_.min_mm + limits_.max_mm) / 2;
  double mean = 0;
  for (const DesignView& v : spec_.views)
    mean += (find_view(bench_, v.view, "design").T_camera_board * Eigen::Vector3d(middle.x(), middle.y(), 0)).norm() /
            static_cast<double>(spec_.views.size());
  return mean;
}

// Measures the figure of merit at the resolution of eyes at the viewpoints. A design fits its own pixels up to 2 dB
// better than any others, which no eye and no camera has; so the pixels are always others.
void DesignRun::measure_for_eyes() {
  result_.eye_from_m = eye_distance_mm() / 1000;
  const int resolved = pixels_of_eyes(limits_.max_mm - limits_.min_mm, eye_distance_mm());
  result_.eye_px = resolved == pixels_ ? resolved + 1 : resolved;
  report("measuring what eyes see", 0);
  std::vector<char> lines;
  for (const WorkView& v : views_) lines.push_back(v.sees_lines);
  views_.clear();  // frees their memory
  views_ = views_to_look_at(spec_, board_, bench_, options_, result_.eye_px, limits_);
  for (std::size_t k = 0; k < views_.size(); ++k) views_[k].sees_lines = lines[k];
  render_all(views_, in_the_metal());
  const auto shown = shown_views();
  for (std::size_t k = 0; k < shown_; ++k) {
    DesignedView& out = result_.views[k];
    out.eye_psnr_db = psnr_db(shown[k], Exposed::best);
    if (resolved > pixels_ && k < view_limits_.size())
      view_limits_[k].pixels = pixels_limit_db(shown[k], log_exposure_, out.target);
  }
}

void DesignRun::measure_ghosts() {
  const auto shown = shown_views();
  for (std::size_t k = 0; k < shown_; ++k) {
    DesignedView& out = result_.views[k];
    const Image seen = shown_luminance(out.shown), own = shown_luminance(out.target);
    for (const DesignedView& other : result_.views) {
      const Image target = shown_luminance(other.target);
      out.ghost.push_back(correlation(seen, target, shown[k][0].target.mask));
      out.target_correlation.push_back(correlation(own, target, shown[k][0].target.mask));
    }
  }
}

}  // namespace burin
