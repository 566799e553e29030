#include "burin/calib/hold_out.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/photo/refine_result.h"
#include "burin/render/error.h"

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
  const std::size_t spare = views.size() - fewest_left;  // as many may be held out at a time
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
    std::istringstream(wanted) >> number;
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
      refuse("leaves " + std::to_string(views.size() - fold.size()) + " views to solve from; at least " +
             std::to_string(fewest_left) + " must stay");
  return folds;
}

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
  double fit2 = 0, held2 = 0, expected2 = 0;
  std::size_t axes = 0;
  for (std::size_t f = 0; f < folds.size(); ++f) {
    if (progress)
      progress("solving without the photos held out", static_cast<double>(f) / static_cast<double>(folds.size()));
    const std::set<std::string> held(folds[f].begin(), folds[f].end());
    std::vector<ViewTags> left;
    for (const ViewTags& p : pictures)
      if (!held.count(p.view)) left.push_back(p);
    const BoardSolution fold = solve_board(board, left, solution.lens.width, solution.lens.height, fold_options);
    std::set<int> solved_tags;
    for (const BundleCorner& c : fold.bundle.corners)
      if (c.used) solved_tags.insert(c.tag);

    for (const std::string& name : folds[f]) {
      const auto known =
          std::find_if(solution.views.begin(), solution.views.end(), [&](const View& v) { return v.name == name; });
      if (known == solution.views.end()) continue;  // left out of the solution too
      const int view = static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
      Bundle one = fold.bundle;
      one.views = {known->T_camera_board};
      one.corners.clear();
      double fit_sum = 0;
      std::size_t fit_axes = 0;
      for (const BundleCorner& c : solution.bundle.corners) {
        if (c.view != view || !c.used || !solved_tags.count(c.tag)) continue;
        one.corners.push_back(c);
        one.corners.back().view = 0;
      }
      for (const SolvedCorner& c : solution.corners)
        if (c.view == name && c.used) {
          fit_sum += c.residual_px.squaredNorm();
          fit_axes += 2;
        }
      // Halves: every other tag around the board.
      const Eigen::Vector2d middle = 0.5 * board.size_mm;
      std::map<double, int> around;
      for (const BundleCorner& c : one.corners) {
        const Eigen::Vector2d d = c.center_mm - middle;
        around[std::atan2(d.y(), d.x()) + 1e-9 * c.tag] = c.tag;
      }
      constexpr std::size_t kFewestTags = 4;
      if (around.size() < kFewestTags) continue;
      std::set<int> first_half;
      std::size_t order = 0;
      for (const auto& [angle, tag] : around)
        if (order++ % 2 == 0) first_half.insert(tag);

      HeldOutView judged;
      judged.view = name;
      judged.tags = static_cast<int>(around.size());
      double sum = 0, expected = 0;
      std::size_t n = 0;
      for (const bool first : {true, false}) {
        Bundle half = one, other = one;
        for (std::size_t i = 0; i < one.corners.size(); ++i) {
          half.corners[i].used = (first_half.count(one.corners[i].tag) > 0) == first;
          other.corners[i].used = !half.corners[i].used;
        }
        BundleOptions pose_only;
        pose_only.fix_lens = pose_only.fix_bow = pose_only.fix_tags = true;
        solve_bundle(half, pose_only);
        other.views = half.views;
        const std::vector<Eigen::Vector2d> residuals = bundle_residuals_px(other);
        double sigma2 = 0;
        std::size_t judged_axes = 0;
        for (std::size_t i = 0; i < residuals.size(); ++i) {
          if (!other.corners[i].used || !residuals[i].allFinite()) continue;
          sum += residuals[i].squaredNorm();
          sigma2 += 2 * other.corners[i].sigma_px * other.corners[i].sigma_px;
          judged_axes += 2;
        }
        n += judged_axes;
        // The pose's uncertainty, seen by the corners that are judged: trace of P H.
        const Eigen::Matrix<double, 6, 6> H = bundle_equations(half, pose_only).views[0].H;
        const Eigen::Matrix<double, 6, 6> H_other = bundle_equations(other, pose_only).views[0].H;
        const double from_pose =
            H.ldlt().solve(H_other).trace() / std::max<double>(1, static_cast<double>(judged_axes));
        expected += sigma2 * (1 + from_pose);
      }
      if (n == 0) continue;
      judged.fit_rms_px = fit_axes ? std::sqrt(fit_sum / static_cast<double>(fit_axes)) : 0;
      judged.held_out_rms_px = std::sqrt(sum / static_cast<double>(n));
      judged.expected_rms_px = std::sqrt(expected / static_cast<double>(n));
      out.views.push_back(judged);
      const auto weight = static_cast<double>(n);
      fit2 += weight * judged.fit_rms_px * judged.fit_rms_px;
      held2 += sum;
      expected2 += expected;
      axes += n;
    }
  }
  if (axes > 0) {
    const auto n = static_cast<double>(axes);
    out.fit_rms_px = std::sqrt(fit2 / n);
    out.held_out_rms_px = std::sqrt(held2 / n);
    out.expected_rms_px = std::sqrt(expected2 / n);
  }
  std::sort(out.views.begin(), out.views.end(),
            [](const HeldOutView& a, const HeldOutView& b) { return a.view < b.view; });
  return out;
}

std::vector<PhotoFit> predict_photos(const Refinement& refined, std::span<const MergedView> photos, const Board& board,
                                     const Sent& sent, const RefineOptions& options) {
  Bench bench = refined.bench;
  std::vector<std::string> findings;
  const std::vector<LightView> views = make_light_views(photos, board, bench, findings);
  if (bench.lights.size() > refined.bench.lights.size())
    fail("the photos held out", "they are the only ones under lamp \"" + bench.lights.back().id + "\"",
         "hold out others, so that this lamp is measured");
  Problem data;
  data.model.board = &board;
  data.model.sent = &sent;
  data.model.center_mm = 0.5 * (board.carve_min_mm + board.carve_max_mm);
  data.model.f0 = board.material.f0.mean();
  data.model.alpha_field = bench.alpha_field.terms;
  data.model.crossings = refined.bench.crossings;
  data.model.alpha_jitter = refined.alpha_jitter;
  data.model.depth_jitter = refined.depth_jitter;
  for (const Light& light : bench.lights) data.is_spot.push_back(light.falloff_exponent > 0);
  State state = state_of(bench, data.model);
  const int merged_bin = photos.empty() ? 1 : photos.front().bin;  // the bench's blur is in pixels of the photos
  state.shared[unknown::log_blur] -= std::log(merged_bin);
  std::vector<double> sizes;
  for (const LightView& view : views) sizes.push_back(pixel_mm(view, bench));
  const double size = median_of(sizes);
  const int bin = size > 0 ? std::max(1, static_cast<int>(std::ceil(options.finest_pixel_mm / size - 1e-9))) : 1;
  data.photos = photos_at(views, bin, board, bench, bench.sensor.psf_sigma_px / merged_bin);
  correct_binning(data, views, board, bench, state);
  const Carved carved = carved_at(data.model, state.of(0));
  std::vector<PhotoFit> out;
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    // Outliers are counted with the model error that the fit's own photos showed.
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
    // The photo as used and as held out are judged alike: nothing fitted, the same resolution.
    const std::vector<PhotoFit> fits = predict_photos(refined, held, board, sent, options);
    const std::vector<PhotoFit> predictions = predict_photos(without, held, board, sent, options);
    for (const PhotoFit& prediction : predictions)
      for (const PhotoFit& fit : fits)
        if (fit.view == prediction.view && fit.light == prediction.light) out.push_back({fit, prediction});
  }
  return out;
}

}  // namespace burin
