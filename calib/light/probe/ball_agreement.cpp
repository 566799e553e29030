#include "burin/calib/light/probe/ball_agreement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "burin/base/median.h"

namespace burin {
namespace {

constexpr int kDirections = 5000;
constexpr double kLowest = 0.06;  // z of a direction: objects on the table shift with the eye's place on the ball
constexpr double kLeastIncidence = 0.4;  // cosine: near blurred outlines views differ
constexpr double kClearOfCone = 1.25;

// Directions spread evenly over the hemisphere above the face (Fibonacci's spiral).
std::vector<Eigen::Vector3d> upper_directions() {
  std::vector<Eigen::Vector3d> out;
  for (int i = 0; i < kDirections; ++i) {
    const double z = kLowest + (1 - kLowest) * (i + 0.5) / kDirections;
    const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0)), s = std::sqrt(1 - z * z);
    out.emplace_back(s * std::cos(turn), s * std::sin(turn), z);
  }
  return out;
}

// Puts out log(value) by direction; NaN if the view does not show it well.
void show(const BallView& view, double dark, const MirrorBall& ball, double photographer_rad,
          const std::vector<Eigen::Vector3d>& directions, std::vector<double>& out) {
  out.assign(directions.size(), std::nan(""));
  const Eigen::Vector3d eye = view.eye_mm(), to_eye = (eye - ball.center_mm).normalized();
  const double cone = std::cos(std::min(kClearOfCone * photographer_rad, std::numbers::pi));
  std::vector<Eigen::Vector3d> points;
  std::vector<std::size_t> of;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (directions[i].dot(to_eye) > cone) continue;
    const auto normal = mirror_normal(ball, eye, directions[i]);
    if (!normal || normal->dot(directions[i]) < kLeastIncidence) continue;
    points.push_back(view.T_camera_board * (ball.center_mm + ball.radius_mm * *normal));
    of.push_back(i);
  }
  std::vector<Eigen::Vector2d> at(points.size());
  project(view.lens, points, at);
  for (std::size_t k = 0; k < at.size(); ++k) {
    const Eigen::Vector2d q = (at[k] - view.origin_px) / view.scale;
    if (!q.allFinite() || q.minCoeff() < 0 || q.x() >= view.gray.width - 1 || q.y() >= view.gray.height - 1) continue;
    const int x = static_cast<int>(q.x()), y = static_cast<int>(q.y());
    const double a = q.x() - x, b = q.y() - y;
    const double value = (1 - b) * ((1 - a) * view.gray.at(x, y) + a * view.gray.at(x + 1, y)) +
                         b * ((1 - a) * view.gray.at(x, y + 1) + a * view.gray.at(x + 1, y + 1));
    out[of[k]] = std::log(std::max(value, 0.0) + dark);
  }
}

double dark_of(const Image& gray) {
  std::vector<double> some;
  for (std::size_t i = 0; i < gray.data.size(); i += 1 + gray.data.size() / 20000) some.push_back(gray.data[i]);
  return std::max(1e-20, 0.05 * median_of(std::move(some)));
}

}  // namespace

double agreement(std::span<const BallView> views, const MirrorBall& ball, double photographer_rad) {
  if (views.size() < 2) return 0;
  const std::vector<Eigen::Vector3d> directions = upper_directions();
  std::vector<std::vector<double>> shown(views.size());
  for (std::size_t v = 0; v < views.size(); ++v)
    show(views[v], dark_of(views[v].gray), ball, photographer_rad, directions, shown[v]);
  double least = 1;
  for (std::size_t v = 0; v < shown.size(); ++v) {
    double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (std::size_t i = 0; i < shown[v].size(); ++i) {
      double sum = 0;
      int others = 0;
      for (std::size_t w = 0; w < shown.size(); ++w)
        if (w != v && !std::isnan(shown[w][i])) {
          sum += shown[w][i];
          ++others;
        }
      if (others == 0 || std::isnan(shown[v][i])) continue;
      const double x = shown[v][i], y = sum / others;
      n += 1;
      a += x;
      b += y;
      aa += x * x;
      bb += y * y;
      ab += x * y;
    }
    const double spread = (aa - a * a / n) * (bb - b * b / n);
    least = std::min(least, n > 50 && spread > 0 ? (ab - a * b / n) / std::sqrt(spread) : 0);
  }
  return least;
}

}  // namespace burin
