// tests/calib/mirror_ball_photos.h - photos of a mirror ball on a tagged board in a room that is known, by tracing
// rays: eye, ball, board, room, with a person behind the camera. Nothing of burin/calib/light/probe is used.
#pragma once

#include <OpenImageIO/imageio.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "burin/base/image.h"
#include "burin/capture/session.h"
#include "burin/capture/tags/tag_family.h"
#include "burin/scene/board.h"
#include "burin/scene/lens.h"
#include "burin/scene/sensor.h"

namespace burin {

/// A round lamp, far away.
struct RoomLamp {
  Eigen::Vector3d direction;
  double half_angle_deg;
  Eigen::Vector3d radiance;
  double solid_angle() const { return 2 * std::numbers::pi * (1 - std::cos(half_angle_deg * std::numbers::pi / 180)); }
};

inline Eigen::Vector3d direction_of(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * std::numbers::pi / 180, e = elevation_deg * std::numbers::pi / 180;
  return {std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)};
}

/// Walls that brighten upwards and are warm on one side, a window, lamps.
struct Room {
  std::vector<RoomLamp> lamps = {{direction_of(40, 62), 0.6, {3000, 2900, 2500}},
                                 {direction_of(200, 35), 2.0, {120, 140, 180}},
                                 {direction_of(300, 50), 1.2, {400, 300, 200}}};
  // The window: azimuth and elevation from, to, degrees.
  double window[4] = {105, 140, 15, 50};
  Eigen::Vector3d window_radiance{9, 10, 12};

  Eigen::Vector3d without_lamps(const Eigen::Vector3d& d) const {
    const double azimuth = std::fmod(std::atan2(d.y(), d.x()) * 180 / std::numbers::pi + 360, 360);
    const double elevation = std::asin(std::clamp(d.z(), -1.0, 1.0)) * 180 / std::numbers::pi;
    if (azimuth > window[0] && azimuth < window[1] && elevation > window[2] && elevation < window[3])
      return window_radiance;
    const double up = 0.5 + 0.4 * d.z(), side = 0.2 * d.x();
    return {up + side, up, up - side};
  }
  Eigen::Vector3d operator()(const Eigen::Vector3d& d) const {
    for (const RoomLamp& lamp : lamps) {
      const double cosine = d.dot(lamp.direction);
      if (cosine > 0.99 && cosine > std::cos(lamp.half_angle_deg * std::numbers::pi / 180)) return lamp.radiance;
    }
    return without_lamps(d);
  }
  /// Of a plane of that normal: lamps in closed form (they lie above it), the rest on a fine grid.
  Eigen::Vector3d irradiance(const Eigen::Vector3d& normal) const {
    Eigen::Vector3d sum(0, 0, 0);
    constexpr int kRows = 360;
    const double step = std::numbers::pi / kRows;
    for (int y = 0; y < kRows; ++y)
      for (int x = 0; x < 2 * kRows; ++x) {
        const double elevation = 90 - (y + 0.5) * 180 / kRows;
        const Eigen::Vector3d d = direction_of((x + 0.5) * 180 / kRows, elevation);
        if (d.dot(normal) > 0 && d.z() > 0)
          sum += d.dot(normal) * step * step * std::cos(elevation * std::numbers::pi / 180) * without_lamps(d);
      }
    for (const RoomLamp& lamp : lamps) {
      const double s = std::sin(lamp.half_angle_deg * std::numbers::pi / 180);
      sum += std::numbers::pi * s * s * lamp.direction.dot(normal) * (lamp.radiance - without_lamps(lamp.direction));
    }
    return sum;
  }
};

/// A board with ten tags around its rim, 240 x 180 mm.
inline Board probe_board() {
  Board board;
  board.size_mm = {240, 180};
  board.carve_min_mm = {45, 45};
  board.carve_max_mm = {195, 135};
  board.tags.family = "tag36h11";
  board.tags.z_mm = 0;
  int id = 1;
  for (const double x : {20., 87., 153., 220.})
    for (const double y : {20., 160.}) board.tags.list.push_back({id++, {x, y}, 24, 0});
  for (const double x : {20., 220.}) board.tags.list.push_back({id++, {x, 90}, 24, 0});
  return board;
}

struct BallScene {
  Board board = probe_board();
  Room room;
  bool has_ball = true;
  Eigen::Vector3d center_mm{128, 84, 25};
  double radius_mm = 25;
  Eigen::Vector3d stretch{1, 1, 1};  ///< of the ball's axes: no ball where they differ
  Eigen::Vector3d reflectance{0.62, 0.6, 0.55};
  double face_mirror = 0;  ///< what the plain face reflects as a mirror: then it shows the ball once more
  bool has_photographer = true;
  std::vector<int> covered_tags;
  bool has_card = false;  ///< a card hides the ball's right half as the camera sees it
  Lens lens;
  double blur_px = 0.6;
  int across = 4, across_lamp = 40;  ///< rays of a pixel, each way: at edges, and where the ball shows a lamp

  BallScene() { lens = {"LENSMODEL_OPENCV4", {1700, 1702, 452, 346, -0.11, 0.08, 0.0006, -0.0004}, 900, 700}; }
};

/// A camera that looks at the board's middle from that direction.
inline Eigen::Isometry3d looking_from(const BallScene& scene, double azimuth_deg, double elevation_deg,
                                      double distance_mm) {
  const Eigen::Vector3d middle(scene.board.size_mm.x() / 2, scene.board.size_mm.y() / 2, 0);
  const Eigen::Vector3d eye = middle + distance_mm * direction_of(azimuth_deg, elevation_deg);
  const Eigen::Vector3d forward = (middle - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear().row(0) = right;
  T.linear().row(1) = forward.cross(right);
  T.linear().row(2) = forward;
  T.translation() = -T.linear() * eye;
  return T;
}

/// What rays of one place meet.
class TracedScene {
 public:
  TracedScene(const BallScene& scene, const Eigen::Vector3d& eye)
      : scene_(scene), eye_(eye), white_(scene.room.irradiance(Eigen::Vector3d::UnitZ()) / std::numbers::pi) {
    const TagFamily family = make_tag_family(scene.board.tags.family, "test");
    for (const Tag& tag : scene.board.tags.list) patterns_[tag.id] = tag_pattern(*family, tag.id, "test");
    const Eigen::Vector3d away = (eye - scene.center_mm).normalized();
    person_ = eye + 130 * away - Eigen::Vector3d(0, 0, 30);
  }

  /// Whether a ray meets the ball, and where.
  std::optional<double> ball_at(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
    if (!scene_.has_ball) return std::nullopt;
    const Eigen::Vector3d o = (from - scene_.center_mm).cwiseQuotient(scene_.stretch * scene_.radius_mm);
    const Eigen::Vector3d d = ray.cwiseQuotient(scene_.stretch * scene_.radius_mm);
    const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 1, root = b * b - a * c;
    if (root < 0) return std::nullopt;
    const double t = (-b - std::sqrt(root)) / a;
    return t > 0 ? std::optional(t) : std::nullopt;
  }

  /// Whether a ray is reflected to about where a lamp is.
  bool lamp_near(const Eigen::Vector3d& ray) const {
    const auto t = ball_at(eye_, ray);
    if (!t) return false;
    const Eigen::Vector3d normal = normal_at(eye_ + *t * ray), out = (ray - 2 * ray.dot(normal) * normal).normalized();
    return std::any_of(scene_.room.lamps.begin(), scene_.room.lamps.end(), [&](const RoomLamp& lamp) {
      return out.dot(lamp.direction) > std::cos((lamp.half_angle_deg + 4) * std::numbers::pi / 180);
    });
  }

  Eigen::Vector3d seen(const Eigen::Vector3d& ray) const {
    if (scene_.has_card) {  // stands on the board through the ball's middle, facing the camera
      const Eigen::Vector3d to = scene_.center_mm - eye_;
      const Eigen::Vector3d right = to.cross(Eigen::Vector3d::UnitZ()).normalized();
      const Eigen::Vector3d at = ray * (to.squaredNorm() / ray.dot(to)) * 0.9 - to * 0.9;
      if (at.dot(right) > 0 && at.dot(right) < 40 && std::abs(at.z()) < 40) return 0.5 * white_;
    }
    return met(eye_, ray, 0);
  }

 private:
  Eigen::Vector3d normal_at(const Eigen::Vector3d& on_ball) const {
    return (on_ball - scene_.center_mm).cwiseQuotient(scene_.stretch.cwiseProduct(scene_.stretch)).normalized();
  }

  Eigen::Vector3d met(const Eigen::Vector3d& from, const Eigen::Vector3d& ray, int depth) const {
    const auto t = ball_at(from, ray);
    if (!t) return without_ball(from, ray, depth);
    const Eigen::Vector3d at = from + *t * ray, normal = normal_at(at);
    return scene_.reflectance.cwiseProduct(without_ball(at, ray - 2 * ray.dot(normal) * normal, depth));
  }

  Eigen::Vector3d without_ball(const Eigen::Vector3d& from, const Eigen::Vector3d& ray, int depth) const {
    if (scene_.has_photographer && from != eye_) {
      const Eigen::Vector3d to = person_ - from;
      const double along = to.dot(ray.normalized());
      if (along > 0 && to.squaredNorm() - along * along < 110 * 110) return 0.02 * white_;
    }
    if (ray.z() >= 0) return scene_.room(ray.normalized());
    const Eigen::Vector2d q = (from - from.z() / ray.z() * ray).head<2>();
    if (q.x() < 0 || q.y() < 0 || q.x() > scene_.board.size_mm.x() || q.y() > scene_.board.size_mm.y())
      return 0.06 * white_;
    for (const Tag& tag : scene_.board.tags.list) {
      if ((q - tag.center_mm).cwiseAbs().maxCoeff() > tag.size_mm) continue;
      const Eigen::Vector2d cell = (q - tag.center_mm) / tag.size_mm * patterns_.at(tag.id).border_cells;
      const int color = patterns_.at(tag.id).color_at(cell.x(), cell.y());
      if (color < 0 ||
          std::find(scene_.covered_tags.begin(), scene_.covered_tags.end(), tag.id) != scene_.covered_tags.end())
        continue;
      return (color == 1 ? scene_.board.tags.white_albedo : scene_.board.tags.black_albedo) * white_;
    }
    const Eigen::Vector3d face = (0.3 + 0.03 * std::sin(q.x() / 3)) * white_;
    if (scene_.face_mirror == 0 || depth > 2) return face;
    const Eigen::Vector3d at(q.x(), q.y(), 1e-6), up(ray.x(), ray.y(), -ray.z());
    return (1 - scene_.face_mirror) * face + scene_.face_mirror * met(at, up, depth + 1);
  }

  const BallScene& scene_;
  Eigen::Vector3d eye_, white_, person_;
  std::map<int, TagPattern> patterns_;
};

/// Radiance of each pixel, R G B, blurred by the lens.
inline Image traced(const BallScene& scene, const Eigen::Isometry3d& T_camera_board) {
  const Eigen::Isometry3d T_board_camera = T_camera_board.inverse();
  const TracedScene world(scene, T_board_camera.translation());
  Image image(scene.lens.width, scene.lens.height, 3);
  // Rays of the pixels' corners; a lens bends nothing within a pixel.
  const int stride = image.width + 1;
  std::vector<Eigen::Vector2d> corners;
  for (int y = 0; y <= image.height; ++y)
    for (int x = 0; x <= image.width; ++x) corners.emplace_back(x - 0.5, y - 0.5);
  std::vector<Eigen::Vector3d> rays(corners.size());
  unproject(scene.lens, corners, rays);
  for (Eigen::Vector3d& ray : rays) ray = T_board_camera.linear() * ray;
  const auto ray_at = [&](int x, int y, double a, double b) {
    const std::size_t i = static_cast<std::size_t>(y) * stride + x;
    return Eigen::Vector3d((1 - b) * ((1 - a) * rays[i] + a * rays[i + 1]) +
                           b * ((1 - a) * rays[i + stride] + a * rays[i + stride + 1]));
  };
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto mean_of = [&](int across) {
        Eigen::Vector3d sum(0, 0, 0);
        for (int j = 0; j < across; ++j)
          for (int i = 0; i < across; ++i) sum += world.seen(ray_at(x, y, (i + 0.5) / across, (j + 0.5) / across));
        return Eigen::Vector3d(sum / (across * across));
      };
      Eigen::Vector3d low = world.seen(ray_at(x, y, 0.5, 0.5)), high = low;
      for (const auto& [a, b] :
           {std::pair(0.05, 0.05), std::pair(0.95, 0.05), std::pair(0.05, 0.95), std::pair(0.95, 0.95)}) {
        const Eigen::Vector3d value = world.seen(ray_at(x, y, a, b));
        low = low.cwiseMin(value);
        high = high.cwiseMax(value);
      }
      Eigen::Vector3d mean = (low + high) / 2;
      if (world.lamp_near(ray_at(x, y, 0.5, 0.5)))
        mean = mean_of(scene.across_lamp);
      else if ((high - low).maxCoeff() > 0.02 * high.maxCoeff())
        mean = mean_of(scene.across);
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(mean[c]);
    }
  return blurred(image, scene.blur_px);
}

/// How a bracket is exposed: value = radiance * gain * exposure_s at ISO 100 and f/1.
struct BallExposures {
  double gain = 1;
  std::vector<double> exposure_s = {1, 1.0 / 8, 1.0 / 64, 1.0 / 512, 1.0 / 4096};
  double full_well_e = 20000, read_noise_e = 8;
  bool as_jpeg = false;  ///< with EXIF; otherwise 16 bits, linear
  int minute = 0;        ///< of the photo's time
};

/// Writes a bracket of one place, NAME-0.tif and on, and adds it to the session.
inline void photograph(const Image& radiance, const std::string& view, const BallExposures& how,
                       const std::filesystem::path& folder, Session& session) {
  std::filesystem::create_directories(folder);
  std::mt19937 random(static_cast<unsigned>(std::hash<std::string>{}(view)));
  std::normal_distribution<double> normal;
  for (std::size_t k = 0; k < how.exposure_s.size(); ++k) {
    std::vector<std::uint16_t> wide;
    std::vector<std::uint8_t> narrow;
    for (const float light : radiance.data) {
      const double electrons = how.full_well_e * how.gain * how.exposure_s[k] * light;
      const double noisy = electrons + std::sqrt(electrons + how.read_noise_e * how.read_noise_e) * normal(random);
      const double value = std::clamp(noisy / how.full_well_e, 0.0, 1.0);
      if (how.as_jpeg)
        narrow.push_back(static_cast<std::uint8_t>(std::lround(255 * linear_to_srgb(static_cast<float>(value)))));
      else
        wide.push_back(static_cast<std::uint16_t>(std::lround(65535 * value)));
    }
    OIIO::ImageSpec spec(radiance.width, radiance.height, 3,
                         how.as_jpeg ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16);
    const auto file = folder / (view + "-" + std::to_string(k) + (how.as_jpeg ? ".jpg" : ".tif"));
    if (how.as_jpeg) {
      spec.attribute("ExposureTime", static_cast<float>(how.exposure_s[k] * 1.000001));
      spec.attribute("FNumber", 1.0F);
      spec.attribute("Exif:PhotographicSensitivity", 100);
      char time[32];
      std::snprintf(time, sizeof time, "2024:05:01 12:%02d:%02d", how.minute, static_cast<int>(2 * k));
      spec.attribute("Exif:DateTimeOriginal", std::string(time));
      spec.attribute("Compression", "jpeg:97");
    }
    const auto out = OIIO::ImageOutput::create(file.string());
    out->open(file.string(), spec);
    if (how.as_jpeg)
      out->write_image(OIIO::TypeDesc::UINT8, narrow.data());
    else
      out->write_image(OIIO::TypeDesc::UINT16, wide.data());
    out->close();
    Photo photo;
    photo.file = file;
    photo.view = view;
    photo.exposure_s = how.exposure_s[k];
    photo.f_number = 1;
    photo.encoding = how.as_jpeg ? Encoding::srgb : Encoding::linear;
    session.photos.push_back(photo);
  }
}

}  // namespace burin
