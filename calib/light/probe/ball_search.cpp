#include "burin/calib/light/probe/ball_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "burin/base/median.h"

namespace burin {
namespace {

constexpr std::size_t kMostViews = 6;  // more do not improve an initial guess
constexpr int kCoarse_px = 200;        // longer side of the maps for the full search
constexpr int kFine_px = 500;          // and of the maps for refining the best
constexpr int kAround = 32;            // points of an outline
constexpr double kSmallest_px = 5;     // radius on the coarse map: smaller balls are useless anyway
constexpr double kLargestShare = 0.5;  // radius, of the board's shorter side
constexpr double kHighestShare = 1;    // of the same: height of the maps above the face
constexpr double kLeastScore = 0.4;
constexpr std::size_t kCandidates = 30;
// Balls are equal if their places and sizes differ by less than this share of their radius.
constexpr double kAlikeCoarse = 0.35, kAlike = 0.05;

// Edges of one view without lens distortion: directions of the steepest change of log(value). Their length is from 0 to
// 1 regardless of contrast. Pixels are places on the plane z = 1 of the camera.
struct EdgeMap {
  Eigen::Isometry3d T_camera_board;
  Eigen::Vector2d first;  // of the first pixel's center
  double step = 0;
  int width = 0, height = 0;
  std::vector<Eigen::Vector2f> edge;
};

// The part of the plane z = 1 that contains the board and objects on it.
bool seen_part(const BallView& view, const Eigen::Vector2d& board_mm, Eigen::Vector2d& low, Eigen::Vector2d& high) {
  low.setConstant(std::numeric_limits<double>::infinity());
  high = -low;
  const double top = kHighestShare * board_mm.minCoeff();
  for (const double z : {0., top})
    for (const double x : {0., board_mm.x()})
      for (const double y : {0., board_mm.y()}) {
        const Eigen::Vector3d p = view.T_camera_board * Eigen::Vector3d(x, y, z);
        if (!(p.z() > 1e-3 * board_mm.norm())) {
          if (z > 0) continue;  // the camera is close: the visible part of the face must suffice
          return false;
        }
        low = low.cwiseMin(p.head<2>() / p.z());
        high = high.cwiseMax(p.head<2>() / p.z());
      }
  return true;
}

// log(value) over the map, from means over the photo's pixels inside a map's pixel.
cv::Mat log_map(const BallView& view, const EdgeMap& map) {
  const cv::Mat gray(view.gray.height, view.gray.width, CV_32F, const_cast<float*>(view.gray.data.data()));
  std::vector<Eigen::Vector3d> rays;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      rays.emplace_back(map.first.x() + x * map.step, map.first.y() + y * map.step, 1);
  std::vector<Eigen::Vector2d> at(rays.size());
  project(view.lens, rays, at);
  const double covered = map.step * view.lens.intrinsics[0] / view.scale;
  cv::Mat smooth;
  if (covered > 1.5)
    cv::blur(gray, smooth, cv::Size(static_cast<int>(std::lround(covered)), static_cast<int>(std::lround(covered))));
  else
    smooth = gray;
  cv::Mat places(map.height, map.width, CV_32FC2), value;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Eigen::Vector2d q = (at[i] - view.origin_px) / view.scale;
    places.at<cv::Vec2f>(static_cast<int>(i) / map.width, static_cast<int>(i) % map.width) = {
        static_cast<float>(q.x()), static_cast<float>(q.y())};
  }
  cv::remap(smooth, value, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  const float usual = median_of(std::vector<float>(value.begin<float>(), value.end<float>()));
  const float dark = std::max(1e-20F, 0.02F * usual);
  for (auto v = value.begin<float>(); v != value.end<float>(); ++v) *v = std::log(std::max(*v, 0.0F) + dark);
  return value;
}

EdgeMap edge_map(const BallView& view, const Eigen::Vector2d& board_mm, int longer_px) {
  EdgeMap map;
  map.T_camera_board = view.T_camera_board;
  Eigen::Vector2d high;
  if (!seen_part(view, board_mm, map.first, high)) return map;
  const Eigen::Vector2d size = high - map.first;
  map.step = size.maxCoeff() / longer_px;
  map.width = static_cast<int>(size.x() / map.step) + 1;
  map.height = static_cast<int>(size.y() / map.step) + 1;
  cv::Mat value = log_map(view, map), dx, dy;
  cv::GaussianBlur(value, value, cv::Size(0, 0), 1.2);
  cv::Sobel(value, dx, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(value, dy, CV_32F, 0, 1, 3, 1.0 / 8);
  constexpr float kFaint = 0.03F;  // of log(value) per pixel: half as good as any stronger edge
  map.edge.reserve(static_cast<std::size_t>(map.width) * map.height);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const Eigen::Vector2f g(dx.at<float>(y, x), dy.at<float>(y, x));
      map.edge.emplace_back(g / (g.norm() + kFaint));
    }
  return map;
}

struct Around {
  std::array<double, kAround> cosine, sine;
};
Around around() {
  Around out;
  for (int k = 0; k < kAround; ++k) {
    out.cosine[k] = std::cos(2 * std::numbers::pi * k / kAround);
    out.sine[k] = std::sin(2 * std::numbers::pi * k / kAround);
  }
  return out;
}

// Match of edges with the outline in one view, 0 to 1. Points outside of the map count as no edge.
double outline_score(const EdgeMap& map, const MirrorBall& ball, const Around& turn) {
  const Eigen::Vector3d center = map.T_camera_board * ball.center_mm;
  const auto cone = tangent_cone({center, ball.radius_mm}, Eigen::Vector3d::Zero());
  if (!cone || map.edge.empty()) return 0;
  const double sine = std::sin(cone->half_angle), cosine = std::cos(cone->half_angle);
  double sum = 0;
  for (int k = 0; k < kAround; ++k) {
    const Eigen::Vector3d across = turn.cosine[k] * cone->right + turn.sine[k] * cone->up;
    const Eigen::Vector3d ray = cosine * cone->axis + sine * across, out = cosine * across - sine * cone->axis;
    if (!(ray.z() > 1e-3)) continue;
    const Eigen::Vector2d at = ray.head<2>() / ray.z();
    const int x = static_cast<int>(std::lround((at.x() - map.first.x()) / map.step));
    const int y = static_cast<int>(std::lround((at.y() - map.first.y()) / map.step));
    if (x < 0 || y < 0 || x >= map.width || y >= map.height) continue;
    // The outline's normal in the picture: motion of its points when the ball grows.
    const Eigen::Vector2d normal = (out.head<2>() - at * out.z()).normalized();
    sum += std::abs(normal.dot(map.edge[static_cast<std::size_t>(y) * map.width + x].cast<double>()));
  }
  return sum / kAround;
}

double score_of(const std::vector<EdgeMap>& maps, const MirrorBall& ball, const Around& turn) {
  double sum = 0;
  for (const EdgeMap& map : maps) sum += outline_score(map, ball, turn);
  return sum / static_cast<double>(maps.size());
}

bool by_score(const FoundBall& a, const FoundBall& b) { return a.score > b.score; }

// The first of similar balls, in their order.
std::vector<FoundBall> differing(const std::vector<FoundBall>& all, double least_mm, double share, std::size_t most) {
  std::vector<FoundBall> out;
  for (const FoundBall& ball : all) {
    if (out.size() == most) break;
    const bool known = std::any_of(out.begin(), out.end(), [&](const FoundBall& other) {
      const double near = std::max(least_mm, share * other.ball.radius_mm);
      return (ball.ball.center_mm - other.ball.center_mm).norm() < near &&
             std::abs(ball.ball.radius_mm - other.ball.radius_mm) < near;
    });
    if (!known) out.push_back(ball);
  }
  return out;
}

// mm at the board's middle per pixel of a map, the largest of all.
double coarsest_mm(const std::vector<EdgeMap>& maps, const Eigen::Vector2d& board_mm) {
  double most = 0;
  for (const EdgeMap& map : maps)
    most = std::max(most, map.step * (map.T_camera_board * Eigen::Vector3d(board_mm.x() / 2, board_mm.y() / 2, 0)).z());
  return most;
}

MirrorBall standing_at(double x, double y, double radius, double lift) { return {{x, y, (1 + lift) * radius}, radius}; }

// Moves and grows the ball step by step, with halved steps, until the score stops rising.
FoundBall climbed(FoundBall found, const std::vector<EdgeMap>& maps, const BallSearch& search, double step_mm,
                  const Around& turn) {
  found.score = score_of(maps, found.ball, turn);
  for (double step = step_mm; step > step_mm / 20; step /= 2)
    for (bool better = true; better;) {
      better = false;
      for (const Eigen::Vector3d& move :
           {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0),
            Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0, 1, 1),
            Eigen::Vector3d(0, -1, -1)}) {
        if (search.radius_mm && move.z() != 0) continue;
        const double radius = found.ball.radius_mm + step * move.z();
        if (!(radius > 0)) continue;
        const MirrorBall tried = standing_at(found.ball.center_mm.x() + step * move.x(),
                                             found.ball.center_mm.y() + step * move.y(), radius, search.lift);
        const double score = score_of(maps, tried, turn);
        if (score <= found.score + 1e-9) continue;
        found = {tried, score};
        better = true;
      }
    }
  return found;
}

}  // namespace

bool hides_what_is_seen(std::span<const BallView> views, const MirrorBall& ball) {
  constexpr double kWithin = 0.95;  // of the cone: corners are known to about a pixel
  return std::any_of(views.begin(), views.end(), [&](const BallView& view) {
    const auto cone = tangent_cone(ball, view.eye_mm());
    return !cone || std::any_of(view.free_rays.begin(), view.free_rays.end(), [&](const Eigen::Vector3d& ray) {
      return ray.dot(cone->axis) > std::cos(kWithin * cone->half_angle);
    });
  });
}

std::vector<FoundBall> search_ball(std::span<const BallView> views, const BallSearch& search) {
  std::vector<EdgeMap> coarse, fine;
  for (std::size_t k = 0; k < std::min(kMostViews, views.size()); ++k) {
    const BallView& view = views[k * views.size() / std::min(kMostViews, views.size())];
    coarse.push_back(edge_map(view, search.board_mm, kCoarse_px));
    fine.push_back(edge_map(view, search.board_mm, kFine_px));
    if (coarse.back().edge.empty()) {
      coarse.pop_back();
      fine.pop_back();
    }
  }
  if (coarse.empty()) return {};
  const Around turn = around();
  const double pixel_mm = coarsest_mm(coarse, search.board_mm), step = 1.5 * pixel_mm;
  std::vector<double> radii;
  if (search.radius_mm)
    radii = {*search.radius_mm};
  else
    for (double r = kSmallest_px * pixel_mm; r < kLargestShare * search.board_mm.minCoeff(); r += 1.2 * pixel_mm)
      radii.push_back(r);
  const int rows = static_cast<int>(search.board_mm.y() / step) + 1;
  std::vector<std::vector<FoundBall>> best(rows);  // of each place, sizes with a local maximum of the score
  tbb::parallel_for(0, rows, [&](int row) {
    for (double x = 0; x <= search.board_mm.x(); x += step) {
      // Sizes with a local maximum of the score: a reflected ring must not hide the ball's outline.
      std::vector<double> score;
      for (const double radius : radii)
        score.push_back(score_of(coarse, standing_at(x, row * step, radius, search.lift), turn));
      for (std::size_t k = 0; k < radii.size(); ++k) {
        const bool peak = (k == 0 || score[k] >= score[k - 1]) && (k + 1 == radii.size() || score[k] > score[k + 1]);
        const MirrorBall ball = standing_at(x, row * step, radii[k], search.lift);
        if (peak && score[k] > kLeastScore && !hides_what_is_seen(views, ball)) best[row].push_back({ball, score[k]});
      }
    }
  });
  std::vector<FoundBall> all;
  for (const auto& row : best) all.insert(all.end(), row.begin(), row.end());
  std::stable_sort(all.begin(), all.end(), by_score);
  std::vector<FoundBall> found = differing(all, 3 * step, kAlikeCoarse, kCandidates);
  tbb::parallel_for(std::size_t{0}, found.size(),
                    [&](std::size_t i) { found[i] = climbed(found[i], fine, search, step, turn); });
  std::stable_sort(found.begin(), found.end(), by_score);
  return differing(found, 0, kAlike, kCandidates);
}

}  // namespace burin
