#include "burin/calib/coupon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "burin/base/degrees.h"
#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/calib/light/light_samples.h"
#include "burin/calib/photo/bench_unknowns.h"
#include "burin/calib/photo/coupon_fit.h"
#include "burin/calib/photo/photo_weights.h"
#include "burin/calib/refine.h"
#include "burin/calib/verdict/camera_place.h"
#include "burin/calib/verdict/refine_result.h"
#include "burin/scene/groove.h"
#include "burin/scene/parameter_name.h"

namespace burin {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDetermined = 0.2, kWeakly = 0.6;  // sigmas of a depth or roughness, relative
constexpr double kBeyond = 1;                       // the same for photos beyond its walls, where little light is left
constexpr double kReach = 1.5;  // roughnesses about the steepest wall within which a photo shows the depth

// A fan in one photo.
struct FanInPhoto {
  double lean = 0;     // of the half vector at its center
  double clipped = 0;  // share of its pixels
  std::size_t pixels = 0;
};

void check_told(const Coupon& coupon, const Scratches& told) {
  for (const CouponFan& fan : coupon.fans)
    if (fan.first_row + fan.rows > told.size())
      fail("scratches.csv", "has " + std::to_string(told.size()) + " scratches, and coupon.json speaks of more",
           "take both files of the same coupon, as burin coupon wrote them");
}

// Data of the rounds. The second round starts from the first one's result.
struct Rounds {
  std::span<const MergedView> photos;
  const Board& board;
  FanProblem problem{};
  State state{};
  FanValues values{};
  Bench bench{};
  Sent sent{};
  std::vector<LightView> views{};

  Rounds(std::span<const MergedView> seen, const Board& believed) : photos(seen), board(believed) {}

  void correct() {
    sent = scratches_of(problem.told, *problem.coupon, values);
    problem.data.model.sent = &sent;
    correct_binning(problem.data, views, board, bench, state);
  }
};

// The photos as a problem of fans, from a bench fitted to them on average.
void set_up(Rounds& run, const Bench& calibrated, const CouponReadOptions& options) {
  FanProblem& problem = run.problem;
  run.sent = scratches_of(problem.told, *problem.coupon, run.values);
  std::vector<Finding> told_before;
  run.views = make_light_views(run.photos, run.board, run.bench, told_before);
  for (const LightView& view : run.views)
    if (view.surroundings)
      fail("photos under \"" + run.photos[view.merged].light + "\"", "show the coupon in the light of a room",
           "photograph it in the dark, under its lamp alone");
  problem.data = make_problem(run.board, run.sent, run.bench);
  problem.data.merged_bin = run.photos.front().bin;
  for (const LightSample& sample : gather_light_samples(run.views, run.board, run.bench, run.sent))
    if (sample.kind != SampleKind::face && sample.value > 0) problem.data.paper.push_back(sample);
  run.state = state_of(run.bench, problem.data);
  // Grooves have values of their own; the shared ones are the board's prior, as their reference.
  run.state.shared[unknown::log_alpha] = std::log(run.board.material.alpha);
  run.state.shared[unknown::log_depth] = std::log(run.board.material.depth_um);
  const Bins bins = bins_for(run.views, run.bench, options.finest_pixel_mm, RefineOptions().max_pixels);
  problem.data.photos =
      photos_at(run.views, bins.finest, run.board, run.bench, std::exp(run.state.shared[unknown::log_blur]));
  problem.data.geometry = geometry_prior(run.board, calibrated, false);
  run.correct();
  weigh_photos(problem.data, run.state);
  find_fans(run.state, problem);
}

Stage stage_of_fans() {
  Stage stage;
  return stage.free(Group::blur);
}

double lean_at(const Vector3d& p, const Vector3d& eye, const Vector3d& lamp) {
  const Vector3d h = ((lamp - p).normalized() + (eye - p).normalized()).normalized();
  return std::acos(std::clamp(h.z(), -1.0, 1.0));
}

// [fan][photo]
std::vector<std::vector<FanInPhoto>> fans_in_photos(const Rounds& run) {
  const Coupon& coupon = *run.problem.coupon;
  std::vector<std::vector<FanInPhoto>> out(coupon.fans.size());
  for (std::size_t k = 0; k < run.problem.data.photos.size(); ++k) {
    const PhotoData& photo = run.problem.data.photos[k];
    const Vector3d eye = run.bench.views[photo.photo.view].T_camera_board.inverse().translation();
    const Vector3d lamp = run.bench.lights[photo.photo.light].position_mm;
    std::vector<FanInPhoto> seen(coupon.fans.size());
    for (std::size_t f = 0; f < seen.size(); ++f) {
      const Vector2d& c = coupon.fans[f].center_mm;
      seen[f].lean = lean_at({c.x(), c.y(), 0}, eye, lamp);
    }
    for (std::size_t i = 0; i < photo.weight.size(); ++i) {
      const int fan = run.problem.fan_of_pixel[k][i];
      if (fan < 0) continue;
      FanInPhoto& at = seen[static_cast<std::size_t>(fan)];
      ++at.pixels;
      at.clipped += photo.photo.valid[i] ? 0 : 1;
    }
    for (std::size_t f = 0; f < seen.size(); ++f) {
      if (seen[f].pixels > 0) seen[f].clipped /= static_cast<double>(seen[f].pixels);
      out[f].push_back(seen[f]);
    }
  }
  return out;
}

// Place of the camera for a half vector of this lean, with the lamp fixed.
std::string place_for_lean(double lean, const Bench& bench, const Board& board) {
  const Vector3d middle(board.size_mm.x() / 2, board.size_mm.y() / 2, 0);
  const Vector3d wi = (bench.lights.front().position_mm - middle).normalized();
  double distance_mm = 0;
  for (const View& view : bench.views)
    distance_mm +=
        (view.T_camera_board.inverse().translation() - middle).norm() / static_cast<double>(bench.views.size());
  Vector3d best(0, 0, -1);
  for (int i = 0; i < 72; ++i) {
    const double azimuth = 2 * std::numbers::pi * i / 72;
    const Vector3d h(std::sin(lean) * std::cos(azimuth), std::sin(lean) * std::sin(azimuth), std::cos(lean));
    const Vector3d wo = 2 * wi.dot(h) * h - wi;
    if (wo.z() > best.z() && (wo - wi).norm() > 0.3) best = wo;
  }
  if (best.z() < 0.3) return "with the lamp moved further to the side";
  return "from " + place_in_words(Vector3d(middle + distance_mm * best), board);
}

// Evidence against a depth regardless of its sigma: no photo near its cut-off, or clipped photos. Fills in the cell's
// leans.
CouponCause against_depth(double depth_um, double alpha, std::span<const FanInPhoto> seen, const Board& board,
                          CellReading& cell) {
  cell.steepest_rad = 2 * std::atan(groove_rim(board.tool_width_um, depth_um));
  cell.least_lean_rad = std::numbers::pi;
  std::size_t clipped = 0;
  constexpr double kClipped = 0.1;
  for (const FanInPhoto& fan : seen) {
    clipped += fan.clipped > kClipped || fan.pixels == 0 ? 1 : 0;
    if (fan.pixels == 0 || fan.clipped > 0.5) continue;
    cell.least_lean_rad = std::min(cell.least_lean_rad, fan.lean);
    cell.most_lean_rad = std::max(cell.most_lean_rad, fan.lean);
  }
  if (2 * clipped > seen.size()) return CouponCause::overexposed;
  if (cell.most_lean_rad < cell.steepest_rad - kReach * alpha) return CouponCause::inside_reach;
  if (cell.least_lean_rad > cell.steepest_rad + kBeyond * alpha) return CouponCause::beyond_reach;
  return CouponCause::none;
}

CouponNumber number_of(const Estimate& log_value, CouponCause against) {
  CouponNumber out;
  out.cause = log_value.known ? against : against == CouponCause::none ? CouponCause::unseen : against;
  if (!log_value.known) return out;
  out.value = std::exp(log_value.value);
  out.sigma = out.value * log_value.sigma;
  if (out.cause != CouponCause::none) return out;
  out.degree = log_value.sigma < kDetermined ? Degree::determined
               : log_value.sigma < kWeakly   ? Degree::weakly
                                             : Degree::not_determined;
  if (out.degree != Degree::determined) out.cause = CouponCause::large_sigma;
  return out;
}

TravelReading travel_of(const Vector2d& along, const Eigen::Matrix2d& covariance) {
  TravelReading out;
  out.share = 2 * along.norm();
  const Vector2d u = along.norm() > 0 ? Vector2d(along.normalized()) : Vector2d(1, 0);
  const double worst = 2 * std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  out.sigma = 2 * std::sqrt(u.dot(covariance * u));
  out.towards_deg = kRadian_deg * std::atan2(u.y(), u.x());
  const Vector2d across(-u.y(), u.x());
  if (along.norm() > 0) out.towards_sigma_deg = kRadian_deg * std::sqrt(across.dot(covariance * across)) / along.norm();
  constexpr double kTells = 0.1, kChance = 9.21;  // chi^2 of two degrees of freedom, 1 %
  out.known = worst < kTells;
  out.seen = out.known && along.dot(covariance.inverse() * along) > kChance;
  return out;
}

// The usable fans (`serve`), as one number per cell.
CellStatistics statistics_of(const Rounds& run, const std::vector<double>& values, const Eigen::MatrixXd& covariance,
                             Index first, const std::vector<bool>& serve, const std::optional<TiltPrior>& tilt) {
  const Coupon& coupon = *run.problem.coupon;
  const auto rows = static_cast<double>(run.problem.told.size() - 1);
  std::vector<FanSample> samples;
  std::vector<Index> kept;
  for (std::size_t f = 0; f < coupon.fans.size(); ++f) {
    if (!serve[f]) continue;
    const CouponFan& fan = coupon.fans[f];
    const double age = (static_cast<double>(fan.first_row) + 0.5 * static_cast<double>(fan.rows - 1)) / rows;
    samples.push_back({fan.cell, values[f], age, fan.center_mm.cwiseQuotient(run.board.size_mm).array() - 0.5});
    kept.push_back(first + static_cast<Index>(f));
  }
  return cell_statistics(samples, covariance(kept, kept), coupon.cells.size(), tilt);
}

// Prior of the slope over the coupon from the slope within fans.
TiltPrior tilt_of(const Rounds& run, const Eigen::MatrixXd& covariance) {
  constexpr double kModel = 0.03;  // model error across a fan, times the coupon's size in radii
  TiltPrior out;
  const Vector2d radii = run.board.size_mm / run.problem.coupon->fans.front().radius_mm;
  const auto across = static_cast<Index>(2 * run.problem.coupon->fans.size() + 2);
  for (Index i = 0; i < 2; ++i) {
    out.value[i] = radii[i] * run.values.across[i];
    out.sigma[i] = std::hypot(radii[i] * std::sqrt(covariance(across + i, across + i)), kModel);
  }
  return out;
}

// Combines fans to cells.
void fill_reading(const Rounds& run, const Eigen::MatrixXd& covariance, CouponReading& out) {
  const Coupon& coupon = *run.problem.coupon;
  const std::size_t n = coupon.fans.size();
  const auto alpha_at = static_cast<Index>(n);
  for (std::size_t f = 0; f < n; ++f) {
    const auto at = static_cast<Index>(f);
    out.fans.push_back({run.values.log_depth[f], std::sqrt(covariance(at, at)), run.values.log_alpha[f],
                        std::sqrt(covariance(alpha_at + at, alpha_at + at))});
  }
  // Fans without information on depth or roughness would only mask others' evidence of wear.
  const std::vector<std::vector<FanInPhoto>> seen = fans_in_photos(run);
  std::vector<CouponCause> against(coupon.cells.size());
  std::vector<bool> tells_depth(n), tells_alpha(n);
  std::size_t cells_with_depth = 0;
  for (std::size_t c = 0; c < coupon.cells.size(); ++c) {
    CellReading& cell = out.cells.emplace_back();
    std::vector<FanInPhoto> all;
    double log_depth = 0, log_alpha = 0;
    for (std::size_t f = 0; f < n; ++f) {
      if (coupon.fans[f].cell != c) continue;
      ++cell.fans;
      log_depth += run.values.log_depth[f];
      log_alpha += run.values.log_alpha[f];
      all.insert(all.end(), seen[f].begin(), seen[f].end());
    }
    const auto fans = static_cast<double>(std::max<std::size_t>(cell.fans, 1));
    against[c] = against_depth(std::exp(log_depth / fans), std::exp(log_alpha / fans), all, run.board, cell);
    cells_with_depth += against[c] == CouponCause::none ? 1 : 0;
  }
  constexpr double kOfPrior = 0.8;
  for (std::size_t f = 0; f < n; ++f) {
    tells_depth[f] =
        against[coupon.fans[f].cell] == CouponCause::none && out.fans[f].log_depth_sigma < kOfPrior * kFanDepthPrior;
    tells_alpha[f] = against[coupon.fans[f].cell] != CouponCause::overexposed &&
                     out.fans[f].log_alpha_sigma < kOfPrior * kFanAlphaPrior;
  }
  out.depth = statistics_of(run, run.values.log_depth, covariance, 0, tells_depth, tilt_of(run, covariance));
  out.alpha = statistics_of(run, run.values.log_alpha, covariance, alpha_at, tells_alpha, std::nullopt);
  for (std::size_t c = 0; c < coupon.cells.size(); ++c) {
    out.cells[c].depth_um = number_of(out.depth.cells[c], against[c]);
    out.cells[c].alpha = number_of(
        out.alpha.cells[c], against[c] == CouponCause::overexposed ? CouponCause::overexposed : CouponCause::none);
  }
  out.travel = travel_of(run.values.travel, covariance.block<2, 2>(2 * alpha_at, 2 * alpha_at));
  // If no photo is near a cut-off, an apparent difference in depth has another cause.
  constexpr std::size_t kCutOffs = 2;
  if (cells_with_depth < kCutOffs) out.travel.known = out.travel.seen = false;
}

// Reports undetermined numbers, one sentence per cause, with the photo to determine them.
void judge_cells(const Rounds& run, CouponReading& out) {
  const Coupon& coupon = *run.problem.coupon;
  const auto degrees = [](double low, double high) {
    const std::string a = significant(kRadian_deg * low, 2), b = significant(kRadian_deg * high, 2);
    return (a == b ? a : a + " to " + b) + " degrees";
  };
  for (const bool of_depth : {true, false})
    for (const CouponCause cause : {CouponCause::overexposed, CouponCause::inside_reach, CouponCause::beyond_reach,
                                    CouponCause::unseen, CouponCause::large_sigma}) {
      std::string which;
      std::size_t count = 0;
      double low = 9, high = 0, least = 9, most = 0, worst = 0;
      for (std::size_t c = 0; c < out.cells.size(); ++c) {
        const CellReading& cell = out.cells[c];
        const CouponNumber& number = of_depth ? cell.depth_um : cell.alpha;
        if (number.cause != cause) continue;
        constexpr std::size_t kNamed = 4;
        if (count < kNamed)
          which += (count == 0 ? "" : ", ") + significant(coupon.cells[c].command, 4) + " at " +
                   significant(coupon.cells[c].feed_mm_min, 4);
        ++count;
        low = std::min(low, cell.steepest_rad), high = std::max(high, cell.steepest_rad);
        least = std::min(least, cell.least_lean_rad), most = std::max(most, cell.most_lean_rad);
        if (number.value > 0) worst = std::max(worst, number.sigma / number.value);
      }
      if (count == 0) continue;
      const std::string what = std::string(of_depth ? "depth" : "roughness") + " of " + std::to_string(count) + " of " +
                               std::to_string(out.cells.size()) + " kinds of fans (" + which + " mm/min" +
                               (count > 4 ? ", ..." : "") + "): ";
      const auto tell = [&](const std::string& why, const std::string& remedy) {
        out.findings.push_back(make_warning(FindingCode::coupon_cell, what + why, remedy));
      };
      switch (cause) {
        case CouponCause::overexposed:
          tell("they are overexposed in most photos", "take a bracket with shorter exposures");
          break;
        case CouponCause::inside_reach:
          tell("all photos look inside the grooves' reach, where light does not depend on depth (they lean up to " +
                   degrees(most, most) + ", the walls are as steep as " + degrees(low, high) + " or more)",
               "add a photo " + place_for_lean(0.5 * (low + high), run.bench, run.board));
          break;
        case CouponCause::beyond_reach:
          tell("no photo looks where the grooves shine (they lean " + degrees(least, least) +
                   " or more, the walls are as steep as " + degrees(low, high) + " or less)",
               "add a photo " + place_for_lean(0.45 * (low + high), run.bench, run.board));
          break;
        case CouponCause::unseen:
          tell("no photo shows them", "see that the whole coupon is in every photo, sharp and not overexposed");
          break;
        default:
          tell("one sigma is up to " + significant(100 * worst, 2) + " %",
               "add photos from nearer, with shorter and longer exposures");
      }
    }
}

// Reports unusable photos with reasons.
void judge_photos(const Rounds& run, CouponReading& out) {
  const std::vector<std::vector<FanInPhoto>> seen = fans_in_photos(run);
  constexpr double kMirror = 9 / kRadian_deg, kClipped = 0.01;
  for (std::size_t k = 0; k < run.problem.data.photos.size(); ++k) {
    const std::string& view = run.bench.views[run.problem.data.photos[k].photo.view].name;
    double lean = 0;
    std::size_t clipped = 0;
    for (const std::vector<FanInPhoto>& fan : seen) {
      lean += fan[k].lean / static_cast<double>(seen.size());
      clipped += fan[k].clipped > kClipped ? 1 : 0;
    }
    if (lean < kMirror)
      out.findings.push_back(make_warning(
          FindingCode::photo_quality,
          "photo " + view + " looks almost into the face's mirror image of the lamp, which hides the grooves' light",
          "take it from the place in coupon.json's shots"));
    if (clipped > 0)
      out.findings.push_back(
          make_warning(FindingCode::exposure,
                       "in photo " + view + " light of " + std::to_string(clipped) + " of " +
                           std::to_string(seen.size()) + " fans is overexposed",
                       "add shorter exposures of it (a bracket), so that the brightest glints are not clipped"));
  }
}

}  // namespace

CouponReading read_coupon_photos(std::span<const MergedView> photos, const Coupon& coupon, const Board& board,
                                 const Scratches& told, const Bench& calibrated, const CouponReadOptions& options,
                                 const Progress& progress) {
  check_told(coupon, told);
  CouponReading out;
  Rounds run(photos, board);
  run.problem.coupon = &coupon;
  run.problem.told = told;
  run.problem.prior = run.values = believed_fans(coupon, board.material.alpha);
  RefineOptions shared;
  shared.fit_fields = false;
  shared.crossings = Crossings::add;
  shared.finest_pixel_mm = options.finest_pixel_mm;
  constexpr int kRounds = 2, kIterations = 12;
  for (int round = 0; round < kRounds; ++round) {
    Refinement refined = refine(photos, board, scratches_of(told, coupon, run.values), calibrated, shared, progress);
    run.bench = refined.bench;
    // The shared part moves into each fan.
    for (double& v : run.values.log_depth) v += std::log(run.bench.material.depth_um / board.material.depth_um);
    for (double& v : run.values.log_alpha) v += std::log(run.bench.material.alpha / board.material.alpha);
    if (round == 0) run.problem.prior.log_alpha = run.values.log_alpha;
    set_up(run, calibrated, options);
    if (round == 0) try_fans(run.problem, run.state, run.values, progress);
    fit_fans(run.problem, stage_of_fans(), kIterations, run.state, run.values, progress);
    run.correct();
    weigh_photos_and_grooves(run.problem.data, run.state);
    find_fans(run.state, run.problem);
    fit_fans(run.problem, stage_of_fans(), kIterations, run.state, run.values, progress);
    out.photos = std::move(refined.photos);
  }
  if (progress) progress("judging the result", 0);
  put_state(run.state, run.problem.data, run.bench);
  fill_reading(run, fan_covariance(run.problem, stage_of_fans(), run.state, run.values), out);
  judge_cells(run, out);
  judge_photos(run, out);
  out.bench = std::move(run.bench);
  return out;
}

}  // namespace burin
