#include "burin/calib/light/probe/outline_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "burin/base/median.h"

namespace burin {
namespace {

constexpr double kLeastReach_px = 3;
constexpr double kLeastContrast = 0.05;       // of log(value), across an edge
constexpr double kPlainContrast = 0.2;        // half as good as the strongest
constexpr double kLeastOfStrongest = 0.2;     // of the strongest contrast nearby
constexpr double kWide_px = 8, kWide = 0.08;  // neighborhood: pixels, or a share of the radius
constexpr double kHit_px = 1, kHit = 0.01;    // on the outline

// A view's values along rays, linear; NaN outside of its picture.
void sample_rays(const BallView& view, std::span<const Eigen::Vector3d> rays, std::vector<double>& out) {
  std::vector<Eigen::Vector3d> camera(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) camera[i] = view.T_camera_board.linear() * rays[i];
  std::vector<Eigen::Vector2d> at(rays.size());
  project(view.lens, camera, at);
  out.assign(rays.size(), std::nan(""));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector2d q = (at[i] - view.origin_px) / view.scale;
    if (!(camera[i].z() > 0) || !q.allFinite() || q.minCoeff() < 0 || q.x() > view.gray.width - 1 ||
        q.y() > view.gray.height - 1)
      continue;
    const int x = std::min(static_cast<int>(q.x()), view.gray.width - 2);
    const int y = std::min(static_cast<int>(q.y()), view.gray.height - 2);
    const double a = q.x() - x, b = q.y() - y;
    out[i] = (1 - b) * ((1 - a) * view.gray.at(x, y) + a * view.gray.at(x + 1, y)) +
             b * ((1 - a) * view.gray.at(x, y + 1) + a * view.gray.at(x + 1, y + 1));
  }
}

// Steepness of a profile: at each place the step of a sharp edge there; 0 near its ends.
std::vector<double> steps_of(const std::vector<double>& profile, double blur_steps) {
  const int n = static_cast<int>(profile.size()), reach = std::max(1, static_cast<int>(std::lround(2 * blur_steps)));
  std::vector<double> out(profile.size(), 0);
  for (int i = reach; i < n - reach; ++i) {
    double sum = 0, weight = 0;
    for (int k = 1; k <= reach; ++k) {
      const double w = k * std::exp(-0.5 * k * k / (blur_steps * blur_steps));
      sum += w * (profile[i + k] - profile[i - k]);
      weight += w;
    }
    out[i] = std::abs(sum / weight);
  }
  return out;
}

// Steepness of the logarithm.
std::vector<double> contrast_of(const std::vector<double>& profile, double dark, double blur_steps) {
  std::vector<double> ratios(profile.size());
  std::transform(profile.begin(), profile.end(), ratios.begin(),
                 [&](double value) { return std::log(std::max(value, 0.0) + dark); });
  return steps_of(ratios, blur_steps);
}

// The place of the outline in a profile, in steps from its middle. Ratios choose the edge, since a lamp's reflection
// outweighs all others in differences. Differences locate it: light is blurred, not its logarithm.
std::optional<double> outline_in(const std::vector<double>& profile, double dark, int half, double blur_steps,
                                 PickEdge pick) {
  const int n = static_cast<int>(profile.size());
  const std::vector<double> contrast = contrast_of(profile, dark, blur_steps);
  const double least =
      std::max(kLeastContrast, kLeastOfStrongest * *std::max_element(contrast.begin(), contrast.end()));
  int best = -1;
  double best_score = 0;
  for (int i = 1; i < n - 1; ++i) {
    if (contrast[i] < contrast[i - 1] || contrast[i] < contrast[i + 1] || !(contrast[i] > least)) continue;
    const double off = (i - half) / (0.5 * half);
    const double score =
        pick == PickEdge::outermost ? i : contrast[i] / (contrast[i] + kPlainContrast) * std::exp(-0.5 * off * off);
    if (score > best_score) {
      best_score = score;
      best = i;
    }
  }
  if (best < 0) return std::nullopt;
  const std::vector<double> step = steps_of(profile, blur_steps);
  for (int moves = 0; moves < 6; ++moves) {  // up the nearest slope
    if (best > 1 && step[best - 1] > step[best] && step[best - 1] >= step[best + 1])
      --best;
    else if (best < n - 2 && step[best + 1] > step[best])
      ++best;
    else
      break;
  }
  const double l = step[best - 1], m = step[best], r = step[best + 1], bend = l - 2 * m + r;
  return best - half + (bend < 0 ? std::clamp(0.5 * (l - r) / bend, -0.5, 0.5) : 0);
}

double darkest(const Image& gray) {
  std::vector<double> some;
  for (std::size_t i = 0; i < gray.data.size(); i += 1 + gray.data.size() / 20000) some.push_back(gray.data[i]);
  return std::max(1e-20, 0.01 * median_of(std::move(some)));
}

// Steps of half a pixel across the outline.
struct Profiles {
  TangentCone cone;
  double per_rad = 1, step_px = 0.5;
  int half = 0;
  double dark = 0;
  std::vector<Eigen::Vector3d> rays;

  Profiles(const BallView& view, const TangentCone& tangent, double reach_px)
      : cone(tangent), per_rad(pixels_per_rad(view, tangent)), step_px(0.5 * view.scale), dark(darkest(view.gray)) {
    half = static_cast<int>(std::ceil(reach_px / step_px)) + 4;
    rays.resize(2 * static_cast<std::size_t>(half) + 1);
  }
  // False if it leaves the picture.
  bool sample(const BallView& view, double turn, std::vector<double>& profile) {
    for (std::size_t i = 0; i < rays.size(); ++i)
      rays[i] = cone.ray(cone.half_angle + (static_cast<int>(i) - half) * step_px / per_rad, turn);
    sample_rays(view, rays, profile);
    return std::none_of(profile.begin(), profile.end(), [](double value) { return std::isnan(value); });
  }
};

}  // namespace

double pixels_per_rad(const BallView& view, const TangentCone& cone) {
  const std::array<Eigen::Vector3d, 2> rays = {
      view.T_camera_board.linear() * cone.ray(cone.half_angle, 0),
      view.T_camera_board.linear() * cone.ray(cone.half_angle, std::numbers::pi)};
  std::array<Eigen::Vector2d, 2> at;
  project(view.lens, rays, at);
  return (at[0] - at[1]).norm() / (2 * cone.half_angle);
}

std::vector<OutlineEdge> edges_about(std::span<const BallView> views, const MirrorBall& ball, double reach,
                                     PickEdge pick) {
  std::vector<OutlineEdge> out;
  std::vector<double> profile;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto cone = tangent_cone(ball, views[v].eye_mm());
    if (!cone) continue;
    const double radius_px = pixels_per_rad(views[v], *cone) * cone->half_angle;
    const double reach_px = std::max(kLeastReach_px * views[v].scale, reach * radius_px);
    Profiles across(views[v], *cone, reach_px);
    const double blur_steps = std::clamp(0.15 * reach_px / across.step_px, 2.0, 8.0);
    for (int k = 0; k < kOutlineTurns; ++k) {
      const double turn = 2 * std::numbers::pi * k / kOutlineTurns;
      if (!across.sample(views[v], turn, profile)) continue;
      const auto at = outline_in(profile, across.dark, across.half, blur_steps, pick);
      if (!at) continue;
      const double off_px = *at * across.step_px;
      out.push_back({static_cast<int>(v), turn, off_px, cone->ray(cone->half_angle + off_px / across.per_rad, turn)});
    }
  }
  return out;
}

double share_with_edge(const BallView& view, const MirrorBall& ball) {
  const auto cone = tangent_cone(ball, view.eye_mm());
  if (!cone) return 0;
  const double radius_px = pixels_per_rad(view, *cone) * cone->half_angle;
  Profiles across(view, *cone, std::max(kWide_px * view.scale, kWide * radius_px));
  const double hit = std::max(kHit_px * view.scale, kHit * radius_px) / across.step_px;
  std::vector<double> profile;
  int count = 0;
  for (int k = 0; k < kOutlineTurns; ++k) {
    if (!across.sample(view, 2 * std::numbers::pi * k / kOutlineTurns, profile)) continue;
    const std::vector<double> contrast = contrast_of(profile, across.dark, 2);
    const double least =
        std::max(kLeastContrast, kLeastOfStrongest * *std::max_element(contrast.begin(), contrast.end()));
    bool found = false;
    for (int i = 1; i + 1 < static_cast<int>(contrast.size()); ++i)
      found = found || (std::abs(i - across.half) <= hit && contrast[i] > least && contrast[i] >= contrast[i - 1] &&
                        contrast[i] >= contrast[i + 1]);
    count += found;
  }
  return static_cast<double>(count) / kOutlineTurns;
}

}  // namespace burin
