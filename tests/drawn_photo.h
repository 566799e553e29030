// tests/drawn_photo.h - photos of a board with tags and glints, drawn by sampling points of it through a pinhole: their
// blur, exposure and pose are known, and they cost milliseconds. Nothing of the renderer is used.
#pragma once

#include <OpenImageIO/imageio.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "burin/base/image.h"
#include "burin/capture/tags/tag_family.h"
#include "burin/scene/board.h"
#include "burin/scene/sensor.h"

namespace burin {

/// 200 x 150 mm, six tags of 20 mm at its rim, a carve area in the middle.
inline Board drawn_board() {
  Board board;
  board.size_mm = {200, 150};
  board.carve_min_mm = {45, 20};
  board.carve_max_mm = {155, 130};
  board.tags.family = "tag36h11";
  board.tags.z_mm = 0;
  int id = 10;
  for (const double x : {20., 180.})
    for (const double y : {20., 75., 130.}) board.tags.list.push_back({id++, {x, y}, 20, 0});
  return board;
}

/// A camera `distance_mm` from the middle of a board, turned from its normal to the right and up, looking at it.
inline Eigen::Isometry3d looking_at_board(const Board& board, double distance_mm, double right_deg, double up_deg) {
  const double right_rad = right_deg * std::numbers::pi / 180, up_rad = up_deg * std::numbers::pi / 180;
  const Eigen::Vector3d away(std::sin(right_rad) * std::cos(up_rad), std::sin(up_rad),
                             std::cos(right_rad) * std::cos(up_rad));
  const Eigen::Vector3d center = Eigen::Vector3d(board.size_mm.x() / 2, board.size_mm.y() / 2, 0) + distance_mm * away;
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(away).normalized();
  Eigen::Matrix3d R;  // rows: right, down, towards the board
  R << right.transpose(), -away.cross(right).transpose(), -away.transpose();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = -R * center;
  return T;
}

struct DrawnPhoto {
  Board board = drawn_board();
  Eigen::Isometry3d T_camera_board = looking_at_board(board, 500, 0, 0);
  int width = 900, height = 700;
  double focal_px = 1600;
  double blur_px = 0;                                     ///< Gaussian, beside the pixel's own square
  double shake_px = 0;                                    ///< the picture is smeared so far along its rows
  double paper = 0.6;                                     ///< value of white paper
  double glint = 12;                                      ///< of the glints, over that of paper
  std::vector<int> left_out;                              ///< tags that are covered
  std::map<int, Eigen::Vector2d> moved_mm;                ///< tags that were stuck elsewhere
  double exposure_s = 1.0 / 60, f_number = 8, iso = 100;  ///< as EXIF tells; 0: nothing
  std::string taken_at = "2024:05:01 12:00:00";           ///< empty: nothing
  double focal_35mm = 0, focal_mm = 0;                    ///< 0: nothing
  std::string model = "M12";
};

/// Linear values as the sensor would have them if it never clipped.
inline Image drawn(const DrawnPhoto& p) {
  constexpr int kAcross = 4;  // points of a pixel, each way
  const TagFamily family = make_tag_family(p.board.tags.family, "test");
  std::map<int, TagPattern> patterns;
  for (const Tag& tag : p.board.tags.list) patterns[tag.id] = tag_pattern(*family, tag.id, "test");
  const Eigen::Isometry3d T_board_camera = p.T_camera_board.inverse();
  const Eigen::Vector3d eye = T_board_camera.translation();
  const auto value_at = [&](double u, double v) {
    const Eigen::Vector3d ray = T_board_camera.linear() * Eigen::Vector3d((u - (p.width - 1) / 2.0) / p.focal_px,
                                                                          (v - (p.height - 1) / 2.0) / p.focal_px, 1);
    const Eigen::Vector2d q = (eye - eye.z() / ray.z() * ray).head<2>();
    if (q.x() < 0 || q.y() < 0 || q.x() > p.board.size_mm.x() || q.y() > p.board.size_mm.y()) return 0.03 * p.paper;
    for (const Tag& tag : p.board.tags.list) {
      if (std::find(p.left_out.begin(), p.left_out.end(), tag.id) != p.left_out.end()) continue;
      const auto moved = p.moved_mm.find(tag.id);
      const TagPattern& pattern = patterns.at(tag.id);
      const Eigen::Vector2d at =
          q - tag.center_mm - (moved == p.moved_mm.end() ? Eigen::Vector2d(0, 0) : moved->second);
      const Eigen::Vector2d cell = at / tag.size_mm * pattern.border_cells;
      const int color = pattern.color_at(cell.x(), cell.y());
      if (color >= 0) return color == 1 ? p.paper : 0.05 * p.paper;
    }
    const bool carved =
        (q.array() > p.board.carve_min_mm.array()).all() && (q.array() < p.board.carve_max_mm.array()).all();
    if (carved && std::fmod(q.x(), 10) < 0.8 && std::fmod(q.y(), 7) < 5) return p.glint * p.paper;
    return 0.15 * p.paper;
  };
  Image image(p.width, p.height, 1);
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      double sum = 0;
      for (int j = 0; j < kAcross; ++j)
        for (int i = 0; i < kAcross; ++i) sum += value_at(x + (i + 0.5) / kAcross - 0.5, y + (j + 0.5) / kAcross - 0.5);
      image.at(x, y) = static_cast<float>(sum / (kAcross * kAcross));
    }
  if (p.blur_px > 0) image = blurred(image, p.blur_px);
  if (p.shake_px >= 1) {
    const Image still = image;
    const int reach = static_cast<int>(p.shake_px / 2);
    for (int y = 0; y < p.height; ++y)
      for (int x = 0; x < p.width; ++x) {
        double sum = 0;
        for (int k = -reach; k <= reach; ++k) sum += still.at(std::clamp(x + k, 0, p.width - 1), y);
        image.at(x, y) = static_cast<float>(sum / (2 * reach + 1));
      }
  }
  return image;
}

/// Clips, encodes (sRGB, 8 bits) and writes it, by the file's ending; false where that kind cannot be written here.
inline bool write_drawn(const Image& linear, const DrawnPhoto& p, const std::filesystem::path& file) {
  OIIO::ImageSpec spec(linear.width, linear.height, 3, OIIO::TypeDesc::UINT8);
  // OpenImageIO 2.4 writes 1/4 s and other exact powers of two as 1/0.
  if (p.exposure_s > 0) spec.attribute("ExposureTime", static_cast<float>(p.exposure_s * 1.000001));
  if (p.f_number > 0) spec.attribute("FNumber", static_cast<float>(p.f_number));
  if (p.iso > 0) spec.attribute("Exif:PhotographicSensitivity", static_cast<int>(p.iso));
  if (p.focal_mm > 0) spec.attribute("Exif:FocalLength", static_cast<float>(p.focal_mm));
  if (p.focal_35mm > 0) spec.attribute("Exif:FocalLengthIn35mmFilm", static_cast<int>(p.focal_35mm));
  if (!p.taken_at.empty()) spec.attribute("Exif:DateTimeOriginal", p.taken_at);
  spec.attribute("Make", "Altair");
  spec.attribute("Model", p.model);
  spec.attribute("Exif:ColorSpace", 1);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("Compression", "jpeg:95");
  std::vector<unsigned char> bytes;
  for (const float v : linear.data)
    bytes.insert(bytes.end(), 3,
                 static_cast<unsigned char>(std::lround(255 * linear_to_srgb(std::clamp(v, 0.0F, 1.0F)))));
  const auto out = OIIO::ImageOutput::create(file.string());
  return out && out->open(file.string(), spec) && out->write_image(OIIO::TypeDesc::UINT8, bytes.data()) && out->close();
}

inline bool write_drawn(const DrawnPhoto& p, const std::filesystem::path& file) {
  return write_drawn(drawn(p), p, file);
}

}  // namespace burin
