#include "burin/calib/hold_out.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/calib/photo/bench_unknowns.h"
#include "burin/calib/photo/glare_fit.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/verdict/refine_result.h"

namespace burin {
namespace {

bool is_number(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) || c == '.'; });
}

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

}  // namespace

std::vector<std::vector<std::string>> hold_out_folds(const std::string& wanted, const std::vector<std::string>& views,
                                                     std::size_t fewest_left) {
  const auto refuse = [&](const std::string& what) {
    fail("--hold-out " + wanted, what,
         "there are " + std::to_string(views.size()) + " views (" + joined(views) +
             "); name some, or give a share below 1, a number of folds, or nothing");
  };
  constexpr std::size_t kUsualFolds = 4;
  if (views.size() <= fewest_left)
    refuse("leaves too few to solve from: at least " + std::to_string(fewest_left) + " must stay");
  const std::size_t spare = views.size() - fewest_left;  // limit of views held out at a time
  std::vector<std::vector<std::string>> folds;
  const auto into_folds = [&](std::size_t count) {
    folds.resize(count);
    for (std::size_t i = 0; i < views.size(); ++i) folds[i % count].push_back(views[i]);
  };
  if (wanted.empty()) {
    into_folds(std::clamp((views.size() + spare - 1) / spare, std::min(kUsualFolds, views.size()), views.size()));
  } else if (wanted == "all") {
    into_folds(views.size());
  } else if (is_number(wanted)) {
    double number = 0;
    std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (number > 0 && number < 1) {
      const auto count =
          std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(number * static_cast<double>(views.size()))));
      folds.resize(1);
      for (std::size_t i = 0; i < count; ++i) folds[0].push_back(views[(2 * i + 1) * views.size() / (2 * count)]);
    } else if (number >= 2 && number == std::floor(number) && number <= static_cast<double>(views.size())) {
      into_folds(static_cast<std::size_t>(number));
    } else {
      refuse("is neither a share nor a number of folds");
    }
  } else {
    folds.resize(1);
    std::istringstream stream(wanted);
    for (std::string name; std::getline(stream, name, ',');) {
      if (std::find(views.begin(), views.end(), name) == views.end()) refuse("there is no view \"" + name + "\"");
      if (std::find(folds[0].begin(), folds[0].end(), name) == folds[0].end()) folds[0].push_back(name);
    }
  }
  for (const auto& fold : folds)
    if (fold.empty() || fold.size() > spare)
      refuse("leaves " + counted(views.size() - fold.size(), "view") + " to solve from; at least " +
             std::to_string(fewest_left) + " must stay");
  return folds;
}

namespace {

// One held-out view: its measured corners, in a bundle of their own with the fold's lens, bow and tags.
struct HeldOutBundle {
  Bundle bundle;
  std::set<int> first_half;  // of its tags: every other one around the board
  int tags = 0;
};

HeldOutBundle held_out_bundle(const BoardSolution& solution, const BoardSolution& fold, const View& known, int view,
                              const Board& board) {
  std::set<int> solved_tags;
  for (const BundleCorner& c : fold.bundle.corners)
    if (c.used) solved_tags.insert(c.tag);
  HeldOutBundle out;
  out.bundle = fold.bundle;
  out.bundle.views = {known.T_camera_board};
  // Its own lens is unknown yet, but the lenses' scatter is known.
  out.bundle.view_lenses.clear();
  if (const auto at = static_cast<std::size_t>(view); at < solution.bundle.view_lenses.size())
    out.bundle.view_lenses = {solution.bundle.view_lenses[at]};
  out.bundle.corners.clear();
  const Eigen::Vector2d middle = 0.5 * board.size_mm;
  std::map<double, int> around;
  for (const BundleCorner& c : solution.bundle.corners) {
    if (c.view != view || !c.used || !solved_tags.count(c.tag)) continue;
    out.bundle.corners.push_back(c);
    out.bundle.corners.back().view = 0;
    const Eigen::Vector2d d = c.center_mm - middle;
    around[std::atan2(d.y(), d.x()) + 1e-9 * c.tag] = c.tag;
  }
  out.tags = static_cast<int>(around.size());
  std::size_t order = 0;
  for (const auto& [angle, tag] : around)
    if (order++ % 2 == 0) out.first_half.insert(tag);
  return out;
}

// Squared errors of corners, and their expectation, over both axes of each.
struct SquaredErrors {
  double sum = 0, expected = 0;
  std::size_t axes = 0;
};

// Predicts the corners of each half of the tags by the pose from the other half.
SquaredErrors predict_halves(const HeldOutBundle& held) {
  BundleOptions pose_only;
  pose_only.fix_lens = pose_only.fix_bow = pose_only.fix_tags = true;
  SquaredErrors out;
  for (const bool first : {true, false}) {
    Bundle half = held.bundle, other = held.bundle;
    for (std::size_t i = 0; i < held.bundle.corners.size(); ++i) {
      half.corners[i].used = (held.first_half.count(held.bundle.corners[i].tag) > 0) == first;
      other.corners[i].used = !half.corners[i].used;
    }
    solve_bundle(half, pose_only);
    other.views = half.views;
    other.view_lenses = half.view_lenses;
    const std::vector<Eigen::Vector2d> residuals = bundle_residuals_px(other);
    double sigma2 = 0;
    std::size_t judged_axes = 0;
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      if (!other.corners[i].used || !residuals[i].allFinite()) continue;
      out.sum += residuals[i].squaredNorm();
      sigma2 += 2 * other.corners[i].sigma_px * other.corners[i].sigma_px;
      judged_axes += 2;
    }
    out.axes += judged_axes;
    // The pose's uncertainty projected to the predicted corners: trace of P H.
    for (ViewLens& lens : other.view_lenses) lens.prior = without_prior(lens.prior);
    const Eigen::MatrixXd H = bundle_equations(half, pose_only).views[0].H;
    const Eigen::MatrixXd H_other = bundle_equations(other, pose_only).views[0].H;
    const double from_pose = H.ldlt().solve(H_other).trace() / std::max<double>(1, static_cast<double>(judged_axes));
    out.expected += sigma2 * (1 + from_pose);
  }
  return out;
}

double root_mean(double sum, std::size_t count) { return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0; }

double fit_rms_px(const BoardSolution& solution, const std::string& view) {
  double sum = 0;
  std::size_t axes = 0;
  for (const SolvedCorner& c : solution.corners)
    if (c.view == view && c.used) {
      sum += c.residual_px.squaredNorm();
      axes += 2;
    }
  return root_mean(sum, axes);
}

}  // namespace

HeldOutCorners hold_out_corners(const BoardSolution& solution, const Board& board,
                                const std::vector<ViewTags>& pictures,
                                const std::vector<std::vector<std::string>>& folds, const BoardSolverOptions& options,
                                const Progress& progress) {
  // The solution's views by name: solve_board numbers them by first appearance.
  std::vector<std::string> names;
  for (const ViewTags& p : pictures)
    if (std::find(names.begin(), names.end(), p.view) == names.end()) names.push_back(p.view);
  BoardSolverOptions fold_options = options;
  fold_options.check_with_mrcal = false;

  HeldOutCorners out;
  double fit2 = 0;
  SquaredErrors all;
  for (std::size_t f = 0; f < folds.size(); ++f) {
    if (progress)
      progress("solving without the photos held out", static_cast<double>(f) / static_cast<double>(folds.size()));
    const std::set<std::string> held(folds[f].begin(), folds[f].end());
    std::vector<ViewTags> left;
    for (const ViewTags& p : pictures)
      if (!held.count(p.view)) left.push_back(p);
    const BoardSolution fold = solve_board(board, left, solution.lens.width, solution.lens.height, fold_options);
    for (const std::string& name : folds[f]) {
      const auto known =
          std::find_if(solution.views.begin(), solution.views.end(), [&](const View& v) { return v.name == name; });
      if (known == solution.views.end()) continue;  // left out of the solution too
      const auto view = static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
      const HeldOutBundle one = held_out_bundle(solution, fold, *known, view, board);
      constexpr int kFewestTags = 4;
      if (one.tags < kFewestTags) continue;
      const SquaredErrors squares = predict_halves(one);
      if (squares.axes == 0) continue;
      const HeldOutView judged{name, one.tags, fit_rms_px(solution, name), root_mean(squares.sum, squares.axes),
                               root_mean(squares.expected, squares.axes)};
      out.views.push_back(judged);
      fit2 += static_cast<double>(squares.axes) * judged.fit_rms_px * judged.fit_rms_px;
      all.sum += squares.sum;
      all.expected += squares.expected;
      all.axes += squares.axes;
    }
  }
  out.fit_rms_px = root_mean(fit2, all.axes);
  out.held_out_rms_px = root_mean(all.sum, all.axes);
  out.expected_rms_px = root_mean(all.expected, all.axes);
  std::sort(out.views.begin(), out.views.end(),
            [](const HeldOutView& a, const HeldOutView& b) { return a.view < b.view; });
  return out;
}

std::vector<PhotoFit> predict_photos(const Refinement& refined, std::span<const MergedView> photos, const Board& board,
                                     const Sent& sent) {
  Bench bench = refined.bench;
  std::vector<Finding> findings;
  std::vector<LightView> views = make_light_views(photos, board, bench, findings);
  if (bench.sensor.glare.share > 0) add_scattered_light(photos, bench.sensor.glare, views);
  if (bench.lights.size() > refined.bench.lights.size())
    fail("the photos held out", "they are the only ones under lamp \"" + bench.lights.back().id + "\"",
         "hold out others, so that this lamp is measured");
  Problem data = make_problem(board, sent, bench);
  data.merged_bin = photos.empty() ? 1 : photos.front().bin;  // the bench's blur is in pixels of the photos
  if (!views.empty()) data.surroundings = views.front().surroundings;
  data.model.crossings = refined.bench.crossings;
  if (data.model.crossings != Crossings::add && !data.surroundings) data.model.cut.lanes = kLanes;
  data.model.alpha_jitter = refined.alpha_jitter;
  data.model.depth_jitter = refined.depth_jitter;
  const State state = state_of(bench, data);
  // The resolution of the fit.
  data.photos = photos_at(views, refined.bin, board, bench, bench.sensor.psf_sigma_px / data.merged_bin);
  light_around(state, data);
  correct_binning(data, views, board, bench, state);
  const Carved carved = carved_at(data.model, state.of(0));
  std::vector<PhotoFit> out;
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    // Counts outliers with the model error of the fit's own photos.
    PhotoData& photo = data.photos[k];
    const GrooveSlopes p = predict_with_slopes(data.model, photo, state.of(photo.photo.light), carved);
    for (std::size_t i = 0; i < photo.weight.size(); ++i)
      if (photo.weight[i] > 0)
        photo.weight[i] = static_cast<float>(
            1 / std::hypot(
                    std::hypot(static_cast<double>(photo.photo.sigma.data[i]), refined.model_error * p.value.data[i]),
                    refined.slope_error[0] * p.by_log_alpha.data[i], refined.slope_error[1] * p.by_log_depth.data[i]));
    out.push_back(photo_fit(data, k, state, carved, bench));
  }
  return out;
}

std::vector<HeldOutPhoto> hold_out_pixels(const Refinement& refined, std::span<const MergedView> photos,
                                          const Board& board, const Sent& sent, const Bench& measured,
                                          const std::vector<std::vector<std::string>>& folds,
                                          const RefineOptions& options, const Progress& progress) {
  std::vector<HeldOutPhoto> out;
  for (const auto& fold : folds) {
    const std::set<std::string> names(fold.begin(), fold.end());
    std::vector<MergedView> used, held;
    for (const MergedView& photo : photos) (names.count(photo.view) ? held : used).push_back(photo);
    const Refinement without = refine(used, board, sent, measured, options, progress);
    // The photo is judged in the same way as used and as held out: nothing is fitted, at the same resolution.
    const std::vector<PhotoFit> fits = predict_photos(refined, held, board, sent);
    const std::vector<PhotoFit> predictions = predict_photos(without, held, board, sent);
    for (const PhotoFit& prediction : predictions)
      for (const PhotoFit& fit : fits)
        if (fit.view == prediction.view && fit.light == prediction.light) out.push_back({fit, prediction});
  }
  return out;
}

}  // namespace burin
