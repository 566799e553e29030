#include "burin/calib/light/probe/find_ball.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/median.h"
#include "burin/calib/light/probe/ball_agreement.h"
#include "burin/calib/light/probe/ball_search.h"

namespace burin {
namespace {

constexpr double kLeastFound = 0.5;        // of an outline: less is half hidden, or no ball
constexpr double kMostOutOfRound = 0.012;  // of the radius: direction errors are four times this (rad)
constexpr double kContactSigma_mm = 0.03;  // paper, dust, a bowed sheet
constexpr double kNearlyWhole = 0.8;
constexpr double kMostOutOfRound_px = 0.6;             // accuracy of a small ball's outline
constexpr double kAgreed = 0.8, kSurelyAgreed = 0.85;  // agreement of views about one room
constexpr double kWorseStanding = 0.03;                // of likeness
constexpr double kLeastRadius_px = 12;
constexpr std::size_t kFitted = 10;  // of the search's places
constexpr double kWellFound = 0.6;   // resting on the face: then no other heights are tried

double mean_found(const FittedBall& ball) {
  double sum = 0;
  for (const OutlineLook& look : ball.views) sum += look.found;
  return ball.views.empty() ? 0 : sum / static_cast<double>(ball.views.size());
}

double out_of_round(const FittedBall& ball) {
  std::vector<double> round;
  for (const OutlineLook& look : ball.views) round.push_back(look.out_of_round);
  return round.empty() ? 0 : median_of(std::move(round));
}

// Similarity of a fit to a ball. Pieces of other outlines match in places, but they are not round, and no two views
// agree about their content.
double likeness(const FittedBall& ball) { return mean_found(ball) - 8 * out_of_round(ball) + 2 * ball.agreement; }

BallPrior prior_of(std::size_t views, const Board& board, std::optional<double> ball_mm) {
  BallPrior prior;
  if (ball_mm) prior.radius_mm = *ball_mm / 2;
  // Two views determine its height by themselves; one view does if the size is known.
  const bool told = views > 1 || ball_mm.has_value();
  prior.lift_sigma_mm = board.bend || !board.mesh.empty() ? (told ? 100 : 1) : told ? 5 : 0.2;
  return prior;
}

std::string of_outline(double share) { return significant(100 * share, 2) + " %"; }

std::string where_it_stands(const MirrorBall& ball) {
  return "a ball of " + significant(2 * ball.radius_mm, 3) + " mm about (" + significant(ball.center_mm.x(), 3) + ", " +
         significant(ball.center_mm.y(), 3) + ") mm";
}

}  // namespace

std::optional<FittedBall> fit_ball(std::span<const BallView> views, const MirrorBall& guess, const Board& board,
                                   const BallHints& hints) {
  BallPrior prior = prior_of(views.size(), board, hints.ball_mm);
  auto best = fit_ball(views, guess, prior);
  if (!best) return best;
  best->agreement = agreement(views, best->ball, hints.photographer_rad);
  if (board.bend || !board.mesh.empty()) return best;
  // It rests on the face unless this fits worse.
  prior.lift_sigma_mm = kContactSigma_mm;
  MirrorBall standing = best->ball;
  standing.center_mm.z() = standing.radius_mm;
  for (const MirrorBall& from : {standing, guess}) {
    auto fit = fit_ball(views, from, prior);
    if (!fit) continue;
    fit->agreement = agreement(views, fit->ball, hints.photographer_rad);
    const bool stands = std::abs(best->ball.center_mm.z() - best->ball.radius_mm) < 3 * kContactSigma_mm;
    if (likeness(*fit) > likeness(*best) - (stands ? 0 : kWorseStanding)) best = std::move(fit);
  }
  return best;
}

std::optional<FittedBall> find_ball(std::span<const BallView> views, const Board& board, const BallHints& hints,
                                    const Progress& progress) {
  std::optional<FittedBall> best;
  double done = 0;  // of four heights
  for (const double lift : {0., 0.3, 0.7, 1.2}) {
    if (progress) progress("looking for the ball", done / 4);
    if (lift > 0 && views.size() < 2 && !hints.ball_mm) break;
    BallSearch search;
    search.board_mm = board.size_mm;
    search.lift = lift;
    if (hints.ball_mm) search.radius_mm = *hints.ball_mm / 2;
    const std::vector<FoundBall> found = search_ball(views, search);
    const std::size_t fitted = std::min(kFitted, found.size());
    for (std::size_t i = 0; i < fitted; ++i) {
      if (progress) progress("looking for the ball", (done + static_cast<double>(i) / static_cast<double>(fitted)) / 4);
      auto fit = fit_ball(views, found[i].ball, board, hints);
      if (fit && !hides_what_is_seen(views, fit->ball) && (!best || likeness(*fit) > likeness(*best)))
        best = std::move(fit);
    }
    if (best && (views.size() > 1 ? best->agreement > kAgreed : likeness(*best) > kWellFound)) break;
    ++done;
  }
  return best;
}

bool shows_ball(const FittedBall& ball, std::size_t v) {
  return ball.views[v].found >= kLeastFound || ball.agreement > kAgreed;
}

void require_ball(const std::optional<FittedBall>& ball, std::span<const std::filesystem::path> files) {
  constexpr const char* kPlace =
      "stand one mirror ball on the board, whole in the picture, nothing touching its outline but the face, in front "
      "of plain metal or paper";
  if (!ball) fail(files.front().string(), "no mirror ball is seen on the board", kPlace);
  std::size_t best = 0;
  for (std::size_t v = 0; v < ball->views.size(); ++v)
    if (ball->views[v].found > ball->views[best].found) best = v;
  const double off = out_of_round(*ball);
  const OutlineLook& look = ball->views[best];
  // An oval one is found in part; the shape is known only if nearly all of the outline is found.
  const bool oval =
      off > kMostOutOfRound && off * look.radius_px > kMostOutOfRound_px && ball->agreement < kSurelyAgreed;
  if (!shows_ball(*ball, best) || (oval && look.found < kNearlyWhole))
    fail(files[best].string(),
         "no whole round ball is seen: " + where_it_stands(ball->ball) + " fits best, and along only " +
             of_outline(look.found) + " of its outline an edge is seen: it is half hidden, not round, or not there",
         kPlace);
  if (oval)
    fail(files[best].string(),
         where_it_stands(ball->ball) + " is not round: its outline is off by " + of_outline(off) +
             " of its radius, which turns directions by " + significant(4 * off * 180 / std::numbers::pi, 2) +
             " degrees",
         "take a bearing ball, or turn a Christmas ball so that its cap and seam are not seen; and check that the lens "
         "is this camera's");
  if (look.radius_px < kLeastRadius_px)
    fail(files[best].string(),
         "the ball is only " + significant(2 * look.radius_px, 2) + " pixels wide: a pixel spans " +
             significant(2 / look.radius_px * 180 / std::numbers::pi, 2) + " degrees of the room",
         "come closer, or take a larger ball: 200 pixels and more are good");
}

}  // namespace burin
