#include "burin/calib/light/probe/probe_panorama.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "burin/scene/far_light.h"
#include "burin/scene/sensor.h"

namespace burin {
namespace {

constexpr double kLeastCosine = 0.17, kGoodCosine = 0.34;  // of incidence: 80 degrees, near the blurred rim, and 70
constexpr double kFaint = 1e-5;     // weight of light from the photographer, or clipped: used only without other light
constexpr double kSoftEdge = 1.25;  // the photographer's cone ends over a quarter of its angle
constexpr int kMostAcross = 8;      // directions of a pixel, each way

// One view of one direction.
struct Look {
  double weight = 0;
  bool photographer = false;
  Eigen::Vector3d ball_mm;  // on the ball, camera frame
};

double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// True if a ray from the ball ends on the board.
bool meets_board(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector2d& board_mm) {
  if (!(to.z() < 0)) return false;
  const Eigen::Vector2d at = (from - from.z() / to.z() * to).head<2>();
  return at.x() >= 0 && at.y() >= 0 && at.x() <= board_mm.x() && at.y() <= board_mm.y();
}

Look look_at(const BallPicture& picture, const Eigen::Vector3d& eye, const MirrorBall& ball, const Eigen::Vector3d& to,
             const ProbeMerge& how) {
  Look look;
  const auto normal = mirror_normal(ball, eye, to);
  if (!normal) return look;
  const double cosine = normal->dot(to);
  if (!(cosine > kLeastCosine)) return look;
  const Eigen::Vector3d at = ball.center_mm + ball.radius_mm * *normal;
  if (meets_board(at, to, how.board_mm)) return look;
  look.ball_mm = picture.T_camera_board * at;
  if (!(look.ball_mm.z() > 0)) return look;
  // Pixels per steradian: the projected surface, and the normal's half angle per angle of the direction.
  const double fine = picture.lens.intrinsics[0] * ball.radius_mm / (eye - at).norm();
  const double away = std::acos(std::clamp(to.dot((eye - ball.center_mm).normalized()), -1.0, 1.0));
  const double clear = smooth_step(how.photographer_rad, kSoftEdge * how.photographer_rad, away);
  look.photographer = away < how.photographer_rad;
  look.weight = fine * fine * cosine * smooth_step(kLeastCosine, kGoodCosine, cosine) * std::max(kFaint, clear);
  return look;
}

// Interpolates between pixels' centers. False outside of the picture.
bool sample_ball(const BallPicture& picture, const Eigen::Vector2d& photo_px, Eigen::Vector3d& value, bool& clipped) {
  const Eigen::Vector2d q = (photo_px - picture.origin_px) / picture.scale;
  const int w = picture.value.width, h = picture.value.height;
  if (!q.allFinite() || q.minCoeff() < 0 || q.x() > w - 1 || q.y() > h - 1) return false;
  const int x = std::min(static_cast<int>(q.x()), w - 2), y = std::min(static_cast<int>(q.y()), h - 2);
  const double a = q.x() - x, b = q.y() - y;
  const std::array<double, 4> share = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
  value.setZero();
  clipped = false;
  for (int k = 0; k < 4; ++k) {
    const int px = x + k % 2, py = y + k / 2;
    if (!picture.valid[static_cast<std::size_t>(py) * w + px] && share[k] > 0) clipped = true;
    for (int c = 0; c < 3; ++c) value[c] += share[k] * picture.value.at(px, py, c);
  }
  const double r2 = vignette_radius2(picture.lens.width, picture.lens.height, photo_px.x(), photo_px.y());
  value /= vignette_at(picture.vignette.data(), r2);
  return true;
}

// Sum over all views for one direction of a pixel.
struct Sum {
  Eigen::Vector3d light{0, 0, 0};
  double weight = 0, clipped = 0, photographer = 0;
};

// The ball's radius in pixels, in the picture that shows it largest.
double largest_radius_px(std::span<const BallPicture> pictures, const MirrorBall& ball) {
  double largest = 0;
  for (const BallPicture& p : pictures)
    largest = std::max(largest, p.lens.intrinsics[0] * ball.radius_mm / (p.eye_mm() - ball.center_mm).norm() / p.scale);
  return largest;
}

// Directions per pixel each way, without skipping a picture's pixel.
int directions_across(std::span<const BallPicture> pictures, const MirrorBall& ball, int width) {
  return std::clamp(static_cast<int>(std::ceil(2 * std::numbers::pi / width * largest_radius_px(pictures, ball))), 2,
                    kMostAcross);
}

// Adds one view's part of a row of directions.
void add_view(const BallPicture& picture, const MirrorBall& ball, const ProbeMerge& how,
              const std::vector<Eigen::Vector3d>& directions, std::vector<Sum>& sums) {
  const Eigen::Vector3d eye = picture.eye_mm();
  std::vector<Look> looks;
  std::vector<std::size_t> of;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Look look = look_at(picture, eye, ball, directions[i], how);
    if (!(look.weight > 0)) continue;
    looks.push_back(look);
    of.push_back(i);
    points.push_back(look.ball_mm);
  }
  std::vector<Eigen::Vector2d> at(points.size());
  project(picture.lens, points, at);
  for (std::size_t k = 0; k < looks.size(); ++k) {
    Eigen::Vector3d value;
    bool clipped = false;
    if (!sample_ball(picture, at[k], value, clipped)) continue;
    const double weight = looks[k].weight * (clipped ? kFaint * kFaint : 1);
    Sum& sum = sums[of[k]];
    sum.light += weight * value;
    sum.weight += weight;
    sum.clipped += clipped ? weight : 0;
    sum.photographer += looks[k].photographer ? weight : 0;
  }
}

}  // namespace

ProbePanorama probe_panorama(std::span<const BallPicture> pictures, const MirrorBall& ball, const ProbeMerge& how) {
  Panorama frame;
  frame.radiance = Image(how.width, how.width / 2, 3);
  ProbePanorama out;
  out.seen.assign(static_cast<std::size_t>(how.width) * (how.width / 2), Seen::nowhere);
  const int across = directions_across(pictures, ball, how.width);
  tbb::parallel_for(0, how.width / 2, [&](int row) {
    std::vector<Eigen::Vector3d> directions;
    for (int x = 0; x < how.width; ++x)
      for (int j = 0; j < across; ++j)
        for (int i = 0; i < across; ++i)
          directions.push_back(frame.direction(x + (i + 0.5) / across, row + (j + 0.5) / across));
    std::vector<Sum> sums(directions.size());
    for (const BallPicture& picture : pictures) add_view(picture, ball, how, directions, sums);
    const auto each = static_cast<std::size_t>(across) * across;
    for (int x = 0; x < how.width; ++x) {
      Eigen::Vector3d light(0, 0, 0);
      int count = 0, clipped = 0, photographer = 0;
      for (std::size_t k = x * each; k < (x + 1) * each; ++k) {
        const Sum& sum = sums[k];
        if (!(sum.weight > 0)) continue;
        light += sum.light / sum.weight;
        ++count;
        clipped += 2 * sum.clipped > sum.weight;
        photographer += 2 * sum.photographer > sum.weight;
      }
      if (2 * count < static_cast<int>(each)) continue;
      for (int c = 0; c < 3; ++c) frame.radiance.at(x, row, c) = static_cast<float>(std::max(0.0, light[c] / count));
      // One clipped direction makes a pixel's light a lower bound.
      out.seen[static_cast<std::size_t>(row) * how.width + x] = clipped > 0                ? Seen::clipped
                                                                : 2 * photographer > count ? Seen::photographer
                                                                                           : Seen::well;
    }
  });
  out.radiance = std::move(frame.radiance);
  return out;
}

int panorama_width(std::span<const BallPicture> pictures, const MirrorBall& ball) {
  // A pixel at the ball's middle rotates the direction by two over the ball's radius in pixels.
  const double pixels = std::numbers::pi * largest_radius_px(pictures, ball);
  return std::clamp(64 * static_cast<int>(std::ceil(pixels / 64)), 256, 2048);
}

}  // namespace burin
