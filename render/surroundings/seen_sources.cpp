#include "burin/render/surroundings/seen_sources.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <xsimd/xsimd.hpp>

#include "burin/render/pixel_shading.h"
#include "burin/scene/far_light.h"
#include "burin/scene/lamp_size.h"

namespace burin {
namespace {

using Packet = xsimd::batch<float>;
constexpr std::size_t kLanes = Packet::size;

/// Light from one direction: radiance times solid angle, R G B. For a lamp: its share of the light, and `to` is a
/// position, mm.
struct FarRay {
  Eigen::Vector3d to;
  Eigen::Vector3d power;
};

// Pixels of the environment map, merged or split to the size that the roughness requires; half vectors turn half as
// much. Directions below the face of a flat board may be above a bowed face, so all with light are kept.
std::vector<FarRay> rays_of(const Panorama& panorama, double fine) {
  const Image& picture = panorama.radiance;
  const double wanted = 1.5 * fine, own = std::numbers::pi / picture.height;
  const int cut = std::clamp(static_cast<int>(std::ceil(own / wanted)), 1, 64);
  const int join = cut > 1 ? 1 : std::max(1, static_cast<int>(std::floor(wanted / own)));
  std::vector<FarRay> out;
  for (int y = 0; y < picture.height; y += join)
    for (int x = 0; x < picture.width; x += join) {
      Eigen::Vector3d power(0, 0, 0), middle(0, 0, 0);
      for (int j = y; j < std::min(y + join, picture.height); ++j)
        for (int i = x; i < std::min(x + join, picture.width); ++i) {
          const Eigen::Vector3d one =
              panorama.solid_angle(j) * Eigen::Vector3d(picture.at(i, j, 0), picture.at(i, j, 1), picture.at(i, j, 2));
          if (join > 1) middle += one.sum() * panorama.direction(i + 0.5, j + 0.5);
          power += one;
        }
      if (!(power.sum() > 0)) continue;
      if (cut == 1) {
        out.push_back({join > 1 ? middle.normalized() : panorama.direction(x + 0.5, y + 0.5), power});
        continue;
      }
      double whole = 0;
      const std::size_t first = out.size();
      for (int j = 0; j < cut; ++j)
        for (int i = 0; i < cut; ++i) {
          const double row = y + (j + 0.5) / cut;
          const double share = std::sin(std::numbers::pi * row / picture.height);
          whole += share;
          out.push_back({panorama.direction(x + (i + 0.5) / cut, row), share * power});
        }
      for (std::size_t k = first; k < out.size(); ++k) out[k].power /= whole;
    }
  return out;
}

// Points over a lamp's area, at the spacing that the roughness requires.
std::vector<FarRay> points_of(const Light& lamp, double fine) {
  const auto across = across_axis(lamp.axis, lamp.size.turn_deg);
  const bool disk = lamp.size.disk_mm > 0;
  const double size = disk ? 2 * lamp.size.disk_mm : lamp.size.panel_mm.maxCoeff();
  const double step = fine * 2 * std::max(1.0, std::abs(lamp.position_mm.z()));  // h turns half as much
  const int side = 2 * std::clamp(static_cast<int>(std::ceil(0.5 * size / step)) + 2, 2, 12), count = side * side;
  std::vector<FarRay> out;
  for (int k = 0; k < count; ++k) {
    Eigen::Vector2d at;
    if (disk) {  // four sunflower patterns, rotated by right angles: centered on the middle
      const int quarter = k / 4, each = count / 4;
      const double r = lamp.size.disk_mm * std::sqrt((quarter + 0.5) / each),
                   turn = quarter * std::numbers::pi * (3 - std::sqrt(5)) + k % 4 * std::numbers::pi / 2;
      at = {r * std::cos(turn), r * std::sin(turn)};
    } else {
      const int row = k / side;
      at = {(k % side + 0.5) / side - 0.5, (row + 0.5) / side - 0.5};
      at = at.cwiseProduct(lamp.size.panel_mm);
    }
    out.push_back({lamp.position_mm + across * at, Eigen::Vector3d::Constant(1.0 / count)});
  }
  return out;
}

struct Direction {
  Packet x, y, z;
  Packet dot(const Direction& o) const { return x * o.x + y * o.y + z * o.z; }
  Direction times(const Packet& by) const { return {x * by, y * by, z * by}; }
};

Direction broadcast(const Eigen::Vector3d& v) {
  const Eigen::Vector3f f = v.cast<float>();
  return {Packet(f.x()), Packet(f.y()), Packet(f.z())};
}

}  // namespace

LightSources light_sources(const Light& light, double fine) {
  const std::vector<FarRay> rays = light.far ? rays_of(*light.far->surroundings, fine) : points_of(light, fine);
  const std::size_t size = (rays.size() + kLanes - 1) / kLanes * kLanes;
  LightSources out;
  for (std::vector<float>* all : {&out.x, &out.y, &out.z, &out.power[0], &out.power[1], &out.power[2]})
    all->reserve(size);
  for (std::size_t k = 0; k < size; ++k) {
    const FarRay& ray = rays[std::min(k, rays.size() - 1)];
    const Eigen::Vector3f to = ray.to.cast<float>();
    out.x.push_back(to.x());
    out.y.push_back(to.y());
    out.z.push_back(to.z());
    for (int c = 0; c < 3; ++c) out.power[c].push_back(k < rays.size() ? static_cast<float>(ray.power[c]) : 0);
  }
  return out;
}

Eigen::Vector3d irradiance(const LightSources& sources, const Eigen::Vector3d& normal) {
  const Eigen::Vector3f n = normal.cast<float>();
  Eigen::Vector3d sum(0, 0, 0);
  for (std::size_t k = 0; k < sources.x.size(); ++k) {
    const float cosine = n.x() * sources.x[k] + n.y() * sources.y[k] + n.z() * sources.z[k];
    if (!(cosine > 0)) continue;
    for (int c = 0; c < 3; ++c) sum[c] += cosine * sources.power[c][k];
  }
  return sum;
}

void each_seen(const ViewScene& scene, const Light& light, int channels, std::size_t pixel, const LightSources& sources,
               const std::function<void(const SeenSources&)>& visit) {
  const Eigen::Matrix3d R = R_face_board(scene.grid->normal[pixel]);
  const Eigen::Vector3d wo_face = R * (scene.camera_center_mm - scene.grid->center_mm[pixel]).normalized();
  if (!(wo_face.z() > 0)) return;
  const Direction row_x = broadcast(R.row(0)), row_y = broadcast(R.row(1)), row_z = broadcast(R.row(2)),
                  wo = broadcast(wo_face), center = broadcast(scene.grid->center_mm[pixel]),
                  axis = broadcast(light.axis);
  const Packet zero(0.0F), one(1.0F), falloff(static_cast<float>(light.falloff_exponent));
  const bool near = !light.far, has_falloff = light.falloff_exponent > 0;
  Packet f0[3], intensity[3];
  for (int c = 0; c < 3; ++c) {
    f0[c] = Packet(static_cast<float>(scene.material.f0[c]));
    intensity[c] = Packet(static_cast<float>(light.intensity[c] / (4 * wo_face.z())));
  }
  SeenSources seen;
  seen.cos_o = static_cast<float>(wo_face.z());
  for (std::size_t first = 0; first < sources.x.size(); first += kLanes) {
    Direction to{Packet::load_unaligned(&sources.x[first]), Packet::load_unaligned(&sources.y[first]),
                 Packet::load_unaligned(&sources.z[first])};
    Packet falls = one;
    if (near) {
      to = {to.x - center.x, to.y - center.y, to.z - center.z};
      const Packet inverse = one / xsimd::sqrt(to.dot(to));
      to = to.times(inverse);
      falls = inverse * inverse;
      if (has_falloff) {
        const Packet beam = -axis.dot(to);
        falls *= xsimd::select(beam > zero, xsimd::pow(xsimd::max(beam, Packet(1e-6F)), falloff), zero);
      }
    }
    const Direction wi{row_x.dot(to), row_y.dot(to), row_z.dot(to)};
    const auto above = wi.z > Packet(1e-6F);
    if (!xsimd::any(above)) continue;
    Direction h{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
    h = h.times(one / xsimd::sqrt(xsimd::max(h.dot(h), Packet(1e-12F))));
    const Packet m = one - h.dot(wo), m2 = m * m, part = m2 * m2 * m;
    h.x.store_aligned(seen.x + seen.count);
    h.y.store_aligned(seen.y + seen.count);
    h.z.store_aligned(seen.z + seen.count);
    xsimd::select(above, wi.z, zero).store_aligned(seen.cos_i + seen.count);
    Packet strength[3];
    for (int c = 0; c < 3; ++c)
      strength[c] =
          (f0[c] + (one - f0[c]) * part) * intensity[c] * falls * Packet::load_unaligned(&sources.power[c][first]);
    if (channels == 1) strength[0] = (strength[0] + strength[1] + strength[2]) * Packet(1.0F / 3);
    for (int c = 0; c < channels; ++c) strength[c].store_aligned(seen.strength[c] + seen.count);
    seen.count += static_cast<int>(kLanes);
    if (seen.count + static_cast<int>(kLanes) <= SeenSources::kMost) continue;
    visit(seen);
    seen.count = 0;
  }
  if (seen.count > 0) visit(seen);
}

}  // namespace burin
