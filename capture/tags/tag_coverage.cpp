#include "burin/capture/tags/tag_coverage.h"
#include "burin/base/median.h"
#include "burin/capture/tags/board_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace burin {
namespace {

struct Points {
  std::vector<cv::Point3f> board;
  std::vector<cv::Point2f> pixel;
};

Points agreeing(const PhotoLook& look, const TagSet& tags) {
  const AgreeingCorners corners = agreeing_corners(look.tags, tags, 0.01 * look.width);
  Points points;
  for (std::size_t i = 0; i < corners.pixel.size(); ++i) {
    points.board.emplace_back(static_cast<float>(corners.board_mm[i].x()), static_cast<float>(corners.board_mm[i].y()),
                              0.0F);
    points.pixel.emplace_back(static_cast<float>(corners.pixel[i].x()), static_cast<float>(corners.pixel[i].y()));
  }
  return points;
}

// Sides of the tags on the board over size_mm; the board's scale is that of the tags' centers.
void add_size_ratios(const PhotoLook& look, const TagSet& tags, std::vector<double>& ratios) {
  std::vector<cv::Point2f> board, pixel, corners;
  std::vector<double> size_mm;
  for (const TagLook& seen : look.tags) {
    const auto tag = std::find_if(tags.list.begin(), tags.list.end(), [&](const Tag& t) { return t.id == seen.id; });
    if (tag == tags.list.end()) continue;
    Eigen::Vector2d middle(0, 0);
    for (const Eigen::Vector2d& q : seen.corner_px) {
      middle += q / 4;
      corners.emplace_back(static_cast<float>(q.x()), static_cast<float>(q.y()));
    }
    board.emplace_back(static_cast<float>(tag->center_mm.x()), static_cast<float>(tag->center_mm.y()));
    pixel.emplace_back(static_cast<float>(middle.x()), static_cast<float>(middle.y()));
    size_mm.push_back(tag->size_mm);
  }
  constexpr std::size_t kFewest = 4;
  if (board.size() < kFewest) return;
  const cv::Mat H = cv::findHomography(pixel, board, cv::RANSAC, 0.05 * cv::boundingRect(board).width, cv::noArray());
  if (H.empty()) return;
  std::vector<cv::Point2f> on_board;
  cv::perspectiveTransform(corners, on_board, H);
  for (std::size_t i = 0; i < size_mm.size(); ++i) {
    double around = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const cv::Point2f side = on_board[4 * i + (k + 1) % 4] - on_board[4 * i + k];
      around += std::hypot(side.x, side.y);
    }
    ratios.push_back(around / 4 / size_mm[i]);
  }
}

struct Fit {
  double error_px = std::numeric_limits<double>::infinity();  // median
  Eigen::Vector3d normal{0, 0, -1};
  double tilt_deg = 0;
};

Fit fit(const Points& points, double focal_px, int width, int height) {
  Fit best;
  if (points.board.size() < 4) return best;
  const cv::Matx33d K(focal_px, 0, (width - 1) / 2.0, 0, focal_px, (height - 1) / 2.0, 0, 0, 1);
  std::vector<cv::Mat> rotations, translations;
  try {
    cv::solvePnPGeneric(points.board, points.pixel, K, cv::noArray(), rotations, translations, false,
                        cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return best;  // degenerate points: no pose
  }
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    std::vector<cv::Point2f> predicted;
    cv::projectPoints(points.board, rotations[i], translations[i], K, cv::noArray(), predicted);
    std::vector<double> errors;
    for (std::size_t k = 0; k < predicted.size(); ++k)
      errors.push_back(std::hypot(predicted[k].x - points.pixel[k].x, predicted[k].y - points.pixel[k].y));
    const double error = median_of(std::move(errors));
    if (!(error < best.error_px) || !(translations[i].at<double>(2) > 0)) continue;
    cv::Matx33d R;
    cv::Rodrigues(rotations[i], R);
    const Eigen::Vector3d normal(R(0, 2), R(1, 2), R(2, 2));
    cv::Point3f middle(0, 0, 0);
    for (const cv::Point3f& p : points.board) middle += p * (1.0F / static_cast<float>(points.board.size()));
    const cv::Matx31d at = R * cv::Matx31d(middle.x, middle.y, middle.z) + cv::Matx31d(translations[i]);
    const Eigen::Vector3d sight(at(0), at(1), at(2));
    best = {error, normal, 180 / std::numbers::pi * std::acos(std::min(1.0, std::abs(normal.dot(sight.normalized()))))};
  }
  return best;
}

}  // namespace

TagCoverage tag_coverage(std::span<const PhotoLook* const> looks, const TagSet& tags) {
  TagCoverage out;
  std::vector<Points> points;
  std::vector<double> size_ratios;
  constexpr int kAcross = 64, kDown = 48;
  cv::Mat within = cv::Mat::zeros(kDown, kAcross, CV_8U);
  for (const PhotoLook* look : looks) {
    TagView view;
    view.tags = static_cast<int>(look->tags.size());
    std::vector<double> sides;
    std::vector<cv::Point> corners;
    for (const TagLook& tag : look->tags) {
      sides.push_back((tag.corner_px[1] - tag.corner_px[0]).norm());
      for (const Eigen::Vector2d& q : tag.corner_px)
        corners.emplace_back(static_cast<int>(kAcross * q.x() / look->width),
                             static_cast<int>(kDown * q.y() / look->height));
    }
    if (!corners.empty()) {
      std::vector<cv::Point> hull;
      cv::convexHull(corners, hull);
      cv::fillConvexPoly(within, hull, cv::Scalar(1));
    }
    view.side_px = median_of(sides);
    out.views.push_back(view);
    points.push_back(agreeing(*look, tags));
    add_size_ratios(*look, tags, size_ratios);
  }
  out.frame_share = cv::countNonZero(within) / static_cast<double>(kAcross * kDown);

  if (!size_ratios.empty()) out.size_ratio = median_of(std::move(size_ratios));

  // One focal length for all: the value of a fine scale with the best median photo.
  constexpr double kStep = 1.06;
  double best_error = std::numeric_limits<double>::infinity();
  for (const double f : focal_scale(kStep)) {
    std::vector<double> errors;
    for (std::size_t v = 0; v < looks.size(); ++v) {
      const PhotoLook& look = *looks[v];
      const Fit here = fit(points[v], f * look.width, look.width, look.height);
      if (!std::isfinite(here.error_px)) continue;
      errors.push_back(here.error_px);
      TagView& view = out.views[v];
      if (view.own_focal_px == 0 || here.error_px < view.own_error_px) {
        view.own_focal_px = f * look.width;
        view.own_error_px = here.error_px;
      }
    }
    const double error = errors.empty() ? best_error : median_of(errors);
    if (error < best_error) {
      best_error = error;
      out.focal_px = f * looks.front()->width;
    }
  }
  for (std::size_t v = 0; v < looks.size(); ++v) {
    const Fit here = fit(points[v], out.focal_px, looks[v]->width, looks[v]->height);
    if (!std::isfinite(here.error_px)) continue;
    out.views[v].error_px = here.error_px;
    out.views[v].normal = here.normal;
    out.views[v].tilt_deg = here.tilt_deg;
    for (std::size_t other = 0; other < v; ++other)
      if (out.views[other].normal)
        out.direction_deg =
            std::max(out.direction_deg, 180 / std::numbers::pi *
                                            std::acos(std::clamp(here.normal.dot(*out.views[other].normal), -1., 1.)));
  }
  return out;
}

}  // namespace burin
