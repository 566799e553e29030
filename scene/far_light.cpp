#include "burin/scene/far_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "burin/base/error.h"

namespace burin {
namespace {

// Rows of the rotation are the picture's axes in board coordinates. z is up. x is the direction of the middle column if
// the picture turns right, and of the first column's left edge if columns run by azimuth.
Eigen::Matrix3d axes_of(const PanoramaFrame& frame, const std::string& where) {
  if (frame.kind == PanoramaFrame::Kind::board) return Eigen::Matrix3d::Identity();
  const Eigen::Vector3d z = frame.up.normalized();
  const Eigen::Vector3d level = frame.middle - frame.middle.dot(z) * z;
  if (!z.allFinite() || !(level.norm() > 1e-6 * frame.middle.norm()))
    fail(where, "the panorama's \"middle\" runs along its \"up\", or one of both has no direction",
         "write the board's directions that its top row and its middle column look to, as [0, 1, 0] and [0, 0, 1]");
  Eigen::Matrix3d R;
  R.row(0) = level.normalized();
  R.row(2) = z;
  R.row(1) = z.cross(level.normalized());
  return R;
}

void check_values(const Image& picture, const std::string& where) {
  const auto [w, h] = std::pair(picture.width, picture.height);
  if (w < 2 || h < 1 || std::abs(w - 2 * h) > 1)
    fail(where, "is " + std::to_string(w) + " x " + std::to_string(h) + " pixels, no latitude-longitude picture",
         "give one that is twice as wide as high: 360 by 180 degrees");
  if (picture.channels != 1 && picture.channels != 3)
    fail(where, "has " + std::to_string(picture.channels) + " channels", "give one or three");
  for (std::size_t i = 0; i < picture.data.size(); ++i) {
    const float v = picture.data[i];
    if (std::isfinite(v) && v >= 0) continue;
    const std::size_t pixel = i / static_cast<std::size_t>(picture.channels);
    fail(where,
         "holds a radiance that is " + std::string(std::isfinite(v) ? "negative" : "no finite number") + " (column " +
             std::to_string(pixel % w) + ", row " + std::to_string(pixel / w) + ")",
         "radiance is 0 or more and finite: mend the picture, for example by painting over the sun and giving that as "
         "a light of its own");
  }
}

// A distant light, with its position in the direction of most of its light.
Light far_away(const char* id, FarLight far, const Eigen::Vector3d& intensity) {
  Light light;
  light.id = id;
  light.position_mm = kFar_mm * far.direction;
  light.axis = -far.direction;
  light.intensity = intensity;
  light.far = std::make_shared<FarLight>(std::move(far));
  return light;
}

}  // namespace

Eigen::Vector3d Panorama::direction(double column, double row) const {
  const double polar = std::numbers::pi * row / radiance.height;
  const double turned = column / radiance.width;
  const double azimuth = turns_right ? 2 * std::numbers::pi * (0.5 - turned) : 2 * std::numbers::pi * turned;
  const Eigen::Vector3d d(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
  return R_picture_board.transpose() * d;
}

std::size_t Panorama::pixel(const Eigen::Vector3d& to) const {
  const Eigen::Vector3d d = R_picture_board * to;
  const double azimuth = std::atan2(d.y(), d.x()) / (2 * std::numbers::pi);
  double turned = turns_right ? 0.5 - azimuth : azimuth;
  turned -= std::floor(turned);
  const int column = std::min(radiance.width - 1, static_cast<int>(turned * radiance.width));
  const double polar = std::atan2(std::hypot(d.x(), d.y()), d.z());
  const int row = std::clamp(static_cast<int>(polar / std::numbers::pi * radiance.height), 0, radiance.height - 1);
  return static_cast<std::size_t>(row) * radiance.width + column;
}

double Panorama::solid_angle(int row) const {
  return 2 * std::numbers::pi / radiance.width *
         (std::cos(std::numbers::pi * row / radiance.height) -
          std::cos(std::numbers::pi * (row + 1) / radiance.height));
}

std::shared_ptr<const Panorama> make_panorama(Image picture, const PanoramaFrame& frame, const std::string& where) {
  check_values(picture, where);
  auto out = std::make_shared<Panorama>();
  if (picture.channels == 1) {
    out->radiance = Image(picture.width, picture.height, 3);
    for (std::size_t i = 0; i < picture.data.size(); ++i)
      std::fill_n(out->radiance.data.begin() + 3 * i, 3, picture.data[i]);
  } else {
    out->radiance = std::move(picture);
  }
  out->turns_right = frame.kind == PanoramaFrame::Kind::inside;
  out->R_picture_board = axes_of(frame, where);
  if (!(irradiance(*out, Eigen::Vector3d::UnitZ()).sum() > 0))
    fail(where, "is black in all directions above the board's face",
         "check its \"frame\": row 0 lies at +z, straight out of the face, or write \"inside\" with \"up\" and "
         "\"middle\"");
  return out;
}

Light sun_light(const Eigen::Vector3d& direction, const Eigen::Vector3d& irradiance, double diameter_deg) {
  FarLight far;
  far.direction = direction.normalized();
  far.diameter_deg = diameter_deg;
  return far_away("sun", std::move(far), irradiance);
}

Light surroundings_light(std::shared_ptr<const Panorama> panorama, const Eigen::Vector3d& factor) {
  // Direction of most of the light: the mean over the brightest tenth of the irradiance.
  const Image& picture = panorama->radiance;
  struct Spot {
    double radiance, power;
    Eigen::Vector3d to;
  };
  std::vector<Spot> spots;
  double all = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const Eigen::Vector3d to = panorama->direction(x + 0.5, y + 0.5);
      if (!(to.z() > 0)) continue;
      const double sum = picture.at(x, y, 0) + picture.at(x, y, 1) + picture.at(x, y, 2);
      spots.push_back({sum, sum * panorama->solid_angle(y) * to.z(), to});
      all += spots.back().power;
    }
  std::stable_sort(spots.begin(), spots.end(), [](const Spot& a, const Spot& b) { return a.radiance > b.radiance; });
  Eigen::Vector3d mean(0, 0, 0);
  double gathered = 0;
  for (const Spot& s : spots) {
    mean += s.power * s.to;
    gathered += s.power;
    if (gathered > 0.1 * all) break;
  }
  FarLight far;
  far.direction = mean.norm() > 0 ? Eigen::Vector3d(mean.normalized()) : Eigen::Vector3d::UnitZ();
  far.surroundings = std::move(panorama);
  return far_away("surroundings", std::move(far), factor);
}

Light sun_as_lamp(const Light& sun) {
  Light lamp = sun;
  lamp.position_mm = kFar_mm * sun.far->direction;
  lamp.intensity = sun.intensity * (kFar_mm * kFar_mm);
  lamp.falloff_exponent = 0;
  lamp.far = nullptr;
  lamp.also.clear();
  return lamp;
}

double widening(double diameter_deg) {
  const double radius = 0.5 * diameter_deg * std::numbers::pi / 180;
  return 0.1875 * radius * radius;
}

Eigen::Vector3d irradiance(const Panorama& panorama, const Eigen::Vector3d& normal) {
  const Image& picture = panorama.radiance;
  Eigen::Vector3d sum(0, 0, 0);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double cosine = normal.dot(panorama.direction(x + 0.5, y + 0.5));
      if (!(cosine > 0)) continue;
      for (int c = 0; c < 3; ++c) sum[c] += cosine * panorama.solid_angle(y) * picture.at(x, y, c);
    }
  return sum;
}

}  // namespace burin
