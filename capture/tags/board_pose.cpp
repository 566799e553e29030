#include "burin/capture/tags/board_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <set>
#include <utility>

#include "burin/base/median.h"

namespace burin {

AgreeingCorners agreeing_corners(std::span<const TagLook> seen, const TagSet& tags, double tolerance_px,
                                 bool one_is_enough) {
  std::vector<cv::Point2f> board, pixel;
  std::vector<int> id;
  for (const TagLook& look : seen) {
    const auto tag = std::find_if(tags.list.begin(), tags.list.end(), [&](const Tag& t) { return t.id == look.id; });
    if (tag == tags.list.end()) continue;
    const auto corners = tag_corners_mm(*tag);
    for (int k = 0; k < 4; ++k) {
      board.emplace_back(static_cast<float>(corners[k].x()), static_cast<float>(corners[k].y()));
      pixel.emplace_back(static_cast<float>(look.corner_px[k].x()), static_cast<float>(look.corner_px[k].y()));
      id.push_back(look.id);
    }
  }
  AgreeingCorners out;
  if (board.size() < (one_is_enough ? 4 : 8)) return out;
  std::vector<unsigned char> inlier;
  const cv::Mat H = cv::findHomography(board, pixel, cv::RANSAC, tolerance_px, inlier, 2000, 0.999);
  if (H.empty()) return out;
  for (std::size_t i = 0; i < inlier.size(); ++i) {
    if (i % 4 == 0 && !inlier[i] && !inlier[i + 1] && !inlier[i + 2] && !inlier[i + 3]) out.stray.push_back(id[i]);
    if (!inlier[i]) continue;
    out.board_mm.emplace_back(board[i].x, board[i].y);
    out.pixel.emplace_back(pixel[i].x, pixel[i].y);
    out.id.push_back(id[i]);
  }
  return out;
}

std::optional<BoardPose> board_pose(const AgreeingCorners& corners, const Lens& lens) {
  if (corners.board_mm.size() < 4) return std::nullopt;
  std::vector<Eigen::Vector3d> directions(corners.pixel.size());
  unproject(lens, corners.pixel, directions);
  std::vector<cv::Point3d> board;
  std::vector<cv::Point2d> seen;  // on the plane z = 1, without distortion
  std::vector<Eigen::Vector2d> pixel;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (!directions[i].allFinite() || !(directions[i].z() > 0)) continue;
    board.emplace_back(corners.board_mm[i].x(), corners.board_mm[i].y(), 0);
    seen.emplace_back(directions[i].x() / directions[i].z(), directions[i].y() / directions[i].z());
    pixel.push_back(corners.pixel[i]);
  }
  if (board.size() < 4) return std::nullopt;
  std::vector<cv::Mat> rotations, translations;
  const cv::Matx33d plain = cv::Matx33d::eye();
  try {
    cv::solvePnPGeneric(board, seen, plain, cv::noArray(), rotations, translations, false, cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return std::nullopt;  // for example, collinear points
  }
  std::optional<BoardPose> best;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    cv::solvePnPRefineLM(board, seen, plain, cv::noArray(), rotations[i], translations[i]);
    cv::Matx33d R;
    cv::Rodrigues(rotations[i], R);
    BoardPose pose;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) pose.T_camera_board.linear()(r, c) = R(r, c);
      pose.T_camera_board.translation()[r] = translations[i].at<double>(r);
    }
    std::vector<Eigen::Vector3d> p_camera;
    bool in_front = pose.T_camera_board.inverse().translation().z() > 0;
    for (const cv::Point3d& p : board) {
      p_camera.push_back(pose.T_camera_board * Eigen::Vector3d(p.x, p.y, p.z));
      in_front = in_front && p_camera.back().z() > 0;
    }
    if (!in_front) continue;
    std::vector<Eigen::Vector2d> predicted(p_camera.size());
    project(lens, p_camera, predicted);
    std::vector<double> errors;
    for (std::size_t k = 0; k < predicted.size(); ++k) errors.push_back((predicted[k] - pixel[k]).norm());
    pose.error_px = median_of(std::move(errors));
    if (std::isfinite(pose.error_px) && (!best || pose.error_px < best->error_px)) best = pose;
  }
  return best;
}

namespace {

AgreeingCorners without(const AgreeingCorners& corners, int id) {
  AgreeingCorners out;
  out.stray = corners.stray;
  for (std::size_t i = 0; i < corners.id.size(); ++i) {
    if (corners.id[i] == id) continue;
    out.board_mm.push_back(corners.board_mm[i]);
    out.pixel.push_back(corners.pixel[i]);
    out.id.push_back(corners.id[i]);
  }
  return out;
}

// Distance of the worst corner from its place under the best pose.
double worst_error_px(const AgreeingCorners& corners, const Lens& lens) {
  const auto pose = board_pose(corners, lens);
  if (!pose) return std::numeric_limits<double>::infinity();
  std::vector<Eigen::Vector3d> p_camera;
  for (const Eigen::Vector2d& p : corners.board_mm)
    p_camera.push_back(pose->T_camera_board * Eigen::Vector3d(p.x(), p.y(), 0));
  std::vector<Eigen::Vector2d> predicted(p_camera.size());
  project(lens, p_camera, predicted);
  double worst = 0;
  for (std::size_t i = 0; i < predicted.size(); ++i) worst = std::max(worst, (predicted[i] - corners.pixel[i]).norm());
  return worst;
}

}  // namespace

void drop_stray_tag(AgreeingCorners& corners, const Lens& lens, double tolerance_px) {
  const std::set<int> ids(corners.id.begin(), corners.id.end());
  if (ids.size() < 3 || worst_error_px(corners, lens) <= tolerance_px) return;
  double best = tolerance_px;
  std::optional<AgreeingCorners> agreeing;
  for (const int id : ids) {
    AgreeingCorners rest = without(corners, id);
    const double error = worst_error_px(rest, lens);
    if (error > best) continue;
    best = error;
    rest.stray.push_back(id);
    agreeing = std::move(rest);
  }
  if (!agreeing) return;
  corners = std::move(*agreeing);
  std::sort(corners.stray.begin(), corners.stray.end());
}

Lens plain_lens(double focal_px, int width, int height) {
  Lens lens;
  lens.model = "LENSMODEL_PINHOLE";
  lens.intrinsics = {focal_px, focal_px, (width - 1) / 2.0, (height - 1) / 2.0};
  lens.width = width;
  lens.height = height;
  return lens;
}

std::vector<double> focal_scale(double step) {
  constexpr double kShortest = 0.3, kLongest = 10;
  std::vector<double> focals;
  double focal = kShortest;
  while (focal < kLongest) {
    focals.push_back(focal);
    focal *= step;
  }
  return focals;
}

}  // namespace burin
