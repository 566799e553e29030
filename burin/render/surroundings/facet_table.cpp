#include "burin/render/surroundings/facet_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <numbers>

#include "burin/render/brdf.h"
#include "burin/render/lamp_size.h"
#include "burin/render/pixel_shading.h"
#include "burin/render/surroundings/fourier.h"

namespace burin {
namespace {

constexpr double kFine = 0.2;  // of the roughness: steps of half vectors and of normals that cubics are good for

/// Light from one direction: radiance times solid angle, R G B. Of a lamp: its share of the light, and `to` is a place,
/// mm.
struct FarRay {
  Eigen::Vector3d to;
  Eigen::Vector3d power;
};

// The panorama's pixels, put together or cut up to the size that the roughness asks for: half vectors turn half as
// much. Directions below the face of a flat board may still lie above a bowed one: all are kept that bring light.
std::vector<FarRay> sources_of(const Panorama& panorama, double alpha) {
  const Image& picture = panorama.radiance;
  const double wanted = 1.5 * kFine * alpha, own = std::numbers::pi / picture.height;
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

// Points all over a lamp's area, as close together as the roughness asks for.
std::vector<FarRay> points_of(const Light& lamp, double alpha) {
  const auto across = across_axis(lamp.axis, lamp.size.turn_deg);
  const bool disk = lamp.size.disk_mm > 0;
  const double size = disk ? 2 * lamp.size.disk_mm : lamp.size.panel_mm.maxCoeff();
  const double step = kFine * alpha * 2 * std::max(1.0, std::abs(lamp.position_mm.z()));  // h turns half as much
  const int side = 2 * std::clamp(static_cast<int>(std::ceil(0.5 * size / step)) + 2, 2, 12), count = side * side;
  std::vector<FarRay> out;
  for (int k = 0; k < count; ++k) {
    Eigen::Vector2d at;
    if (disk) {  // four sunflowers, turned by right angles: about the middle
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

std::vector<FarRay> sources_of(const Light& light, double alpha) {
  return light.far ? sources_of(*light.far->surroundings, alpha) : points_of(light, alpha);
}

/// A source as one place of the face sees it: half vector (face) and what D is to be multiplied with.
struct Seen {
  Eigen::Vector3d h;
  std::array<double, 3> strength;
};

// visit(Seen, cos_i, cos_o) for the sources above the face at a pixel; shadowing is left to the visitor.
template <typename Visit>
void each_seen(const ViewScene& scene, const Light& light, int channels, std::size_t pixel,
               const std::vector<FarRay>& sources, const Visit& visit) {
  const Eigen::Vector3d& normal = scene.grid->normal[pixel];
  const Eigen::Matrix3d R = R_face_board(normal);
  const Eigen::Vector3d wo = R * (scene.camera_center_mm - scene.grid->center_mm[pixel]).normalized();
  if (!(wo.z() > 0)) return;
  const Eigen::Vector3d& f0 = scene.material.f0;
  for (const FarRay& s : sources) {
    Eigen::Vector3d to = s.to;
    double falls = 1;
    if (!light.far) {
      to -= scene.grid->center_mm[pixel];
      const double distance = to.norm(), beam = -light.axis.dot(to) / distance;
      if (light.falloff_exponent > 0 && !(beam > 0)) continue;
      falls = (light.falloff_exponent > 0 ? std::pow(beam, light.falloff_exponent) : 1) / (distance * distance);
      to /= distance;
    }
    const Eigen::Vector3d wi = R * to;
    if (!(wi.z() > 1e-6)) continue;
    Seen seen;
    seen.h = (wi + wo).normalized();
    const double cos_ho = seen.h.dot(wo), part = schlick_F(cos_ho, 0.0);
    for (int c = 0; c < 3; ++c)
      seen.strength[c] = (f0[c] + (1 - f0[c]) * part) * light.intensity[c] * falls * s.power[c] / (4 * wo.z());
    if (channels == 1) seen.strength[0] = (seen.strength[0] + seen.strength[1] + seen.strength[2]) / 3;
    visit(seen, wi.z(), wo.z());
  }
}

/// Rings of half vectors: lean (k + 1/2) step, `azimuths` places each.
struct Rings {
  int count = 0, azimuths = 0;
  double step = 0;
};

// Puts strength onto 4 x 4 places of the rings so that polynomials up to the third degree are summed as they are.
void spread(const Rings& rings, const Seen& seen, double times, int channels, std::vector<float>& on) {
  const double lean = std::atan2(std::hypot(seen.h.x(), seen.h.y()), seen.h.z());
  double azimuth = std::atan2(seen.h.y(), seen.h.x()) / (2 * std::numbers::pi);
  azimuth -= std::floor(azimuth);
  const double at = lean / rings.step - 0.5, below = std::floor(at);
  const CubicShares a = cubic_shares(azimuth * rings.azimuths, rings.azimuths, true);
  const CubicShares r = cubic_shares(at - below + 1, 4, false);
  for (int j = 0; j < 4; ++j) {
    int ring = static_cast<int>(below) - 1 + j, turn = 0;
    if (ring < 0) {  // over the pole
      ring = -1 - ring;
      turn = rings.azimuths / 2;
    }
    if (ring >= rings.count) continue;
    for (int i = 0; i < 4; ++i) {
      const int place = (a.first + i + turn + rings.azimuths) & (rings.azimuths - 1);
      const double share = times * a.share[i] * r.share[j];
      for (int c = 0; c < channels; ++c)
        on[(static_cast<std::size_t>(c) * rings.count + ring) * rings.azimuths + place] +=
            static_cast<float>(share * seen.strength[c]);
    }
  }
}

// Fourier's transform of D over azimuth, for each lean of a normal and of a half vector: real, half of it.
std::vector<float> lobe_spectra(const FacetTable& table, const Rings& rings, double alpha) {
  const int half = rings.azimuths / 2 + 1;
  std::vector<float> out(static_cast<std::size_t>(table.t_count) * rings.count * half);
  tbb::parallel_for(0, table.t_count, [&](int n) {
    std::vector<std::complex<float>> ring(rings.azimuths);
    const double lean = 2 * std::atan(n * table.t_step);
    for (int k = 0; k < rings.count; ++k) {
      const double other = (k + 0.5) * rings.step;
      for (int j = 0; j < rings.azimuths; ++j) {
        const double cosine = std::cos(lean) * std::cos(other) +
                              std::sin(lean) * std::sin(other) * std::cos(2 * std::numbers::pi * j / rings.azimuths);
        ring[j] = static_cast<float>(ggx_D(cosine, alpha));
      }
      fourier(ring, false);
      for (int m = 0; m < half; ++m) out[(static_cast<std::size_t>(n) * rings.count + k) * half + m] = ring[m].real();
    }
  });
  return out;
}

void convolve(const FacetTable& table, const Rings& rings, const std::vector<float>& lobes, std::vector<float>& on,
              float* to) {
  const int half = rings.azimuths / 2 + 1, n_az = rings.azimuths;
  std::vector<std::complex<float>> ring(n_az), spectra(static_cast<std::size_t>(rings.count) * half);
  std::vector<char> lit(rings.count);
  for (int c = 0; c < table.channels; ++c) {
    for (int k = 0; k < rings.count; ++k) {
      const float* from = &on[(static_cast<std::size_t>(c) * rings.count + k) * n_az];
      lit[k] = std::any_of(from, from + n_az, [](float v) { return v != 0; }) ? 1 : 0;
      if (!lit[k]) continue;
      std::copy(from, from + n_az, ring.begin());
      fourier(ring, false);
      std::copy_n(ring.begin(), half, spectra.begin() + static_cast<std::ptrdiff_t>(k) * half);
    }
    for (int n = 0; n < table.t_count; ++n) {
      std::fill(ring.begin(), ring.end(), std::complex<float>());
      for (int k = 0; k < rings.count; ++k) {
        if (!lit[k]) continue;
        const float* lobe = &lobes[(static_cast<std::size_t>(n) * rings.count + k) * half];
        const std::complex<float>* spectrum = &spectra[static_cast<std::size_t>(k) * half];
        for (int m = 0; m < half; ++m) ring[m] += lobe[m] * spectrum[m];
      }
      for (int m = 1; m < n_az - half + 1; ++m) ring[n_az - m] = std::conj(ring[m]);
      fourier(ring, true);
      for (int j = 0; j < n_az; ++j)
        to[static_cast<std::size_t>(j) * table.ring_size() + static_cast<std::size_t>(c) * table.t_count + n] =
            ring[j].real() / static_cast<float>(n_az);
    }
  }
}

}  // namespace

PlaceLattice place_lattice(const ViewScene& scene, const Light& light, double alpha) {
  constexpr double kStep = 0.3;  // of the roughness: from a node to the next
  constexpr int kMost = 40;
  const FootprintGrid& grid = *scene.grid;
  const int w = grid.width(), h = grid.height();
  std::vector<std::size_t> valid;
  for (std::size_t i = 0; i < grid.center_mm.size(); ++i)
    if (grid.center_mm[i].allFinite() && grid.normal[i].allFinite()) valid.push_back(i);
  PlaceLattice out;
  if (valid.empty()) return out;
  // How far the eye's direction, and the face, turn over the picture: from its box of extremes.
  const auto turned = [&](std::size_t a, std::size_t b) {
    const auto wo = [&](std::size_t i) -> Eigen::Vector3d {
      return (scene.camera_center_mm - grid.center_mm[i]).normalized();
    };
    const auto wi = [&](std::size_t i) -> Eigen::Vector3d {
      return (light.position_mm - grid.center_mm[i]).normalized();
    };
    const double by_lamp = light.far ? 0 : 0.5 * (wi(a) - wi(b)).norm();
    return 0.5 * (wo(a) - wo(b)).norm() + by_lamp + (grid.normal[a] - grid.normal[b]).norm();
  };
  double by_column = 0, by_row = 0;  // radians a pixel
  const std::size_t stride = std::max<std::size_t>(1, valid.size() / 400);
  for (std::size_t k = 0; k < valid.size(); k += stride)
    for (const std::size_t to : {valid.front(), valid[valid.size() / 2], valid.back()}) {
      const std::size_t from = valid[k];
      const std::size_t row_from = from / w, row_to = to / w;
      const double dx = std::abs(static_cast<double>(from % w) - static_cast<double>(to % w)),
                   dy = std::abs(static_cast<double>(row_from) - static_cast<double>(row_to));
      const double each = turned(from, to) / std::max(1.0, std::hypot(dx, dy));
      if (dx >= dy) by_column = std::max(by_column, each);
      if (dy >= dx) by_row = std::max(by_row, each);
    }
  out.lean_per_pixel = std::max(by_column, by_row);
  out.columns = std::clamp(static_cast<int>(std::ceil(w * by_column / (kStep * alpha))) + 1, 4, kMost);
  out.rows = std::clamp(static_cast<int>(std::ceil(h * by_row / (kStep * alpha))) + 1, 4, kMost);
  out.column_pixels = std::max(1, w - 1) / static_cast<double>(out.columns - 1);
  out.row_pixels = std::max(1, h - 1) / static_cast<double>(out.rows - 1);
  std::vector<char> is_valid(grid.center_mm.size(), 0);
  for (const std::size_t i : valid) is_valid[i] = 1;
  for (int r = 0; r < out.rows; ++r)
    for (int c = 0; c < out.columns; ++c) {
      const double x = c * out.column_pixels, y = r * out.row_pixels;
      std::size_t best = std::min(h - 1, static_cast<int>(std::lround(y))) * static_cast<std::size_t>(w) +
                         std::min(w - 1, static_cast<int>(std::lround(x)));
      if (!is_valid[best]) {
        double nearest = std::numeric_limits<double>::infinity();
        // Of large pictures some pixels will do: a place outside is only there to be interpolated from.
        for (std::size_t k = 0; k < valid.size(); k += std::max<std::size_t>(1, valid.size() / 10'000)) {
          const std::size_t i = valid[k], row = i / w;
          const double d = std::hypot(static_cast<double>(i % w) - x, static_cast<double>(row) - y);
          if (d >= nearest) continue;
          nearest = d;
          best = i;
        }
      }
      out.pixel.push_back(best);
    }
  return out;
}

FacetTable make_facet_table(const ViewScene& scene, const Light& light, int channels, const PlaceLattice& lattice,
                            double alpha, double steepest_t) {
  FacetTable table;
  table.channels = channels;
  table.columns = lattice.columns;
  table.rows = lattice.rows;
  table.column_pixels = lattice.column_pixels;
  table.row_pixels = lattice.row_pixels;
  table.t_step = 0.5 * kFine * alpha;
  table.t_count = std::max(4, static_cast<int>(std::ceil(steepest_t / table.t_step)) + 2);
  const double steepest = 2 * std::atan(table.t_count * table.t_step);
  Rings rings;
  rings.step = kFine * alpha;
  rings.count = static_cast<int>(std::ceil(0.5 * std::numbers::pi / rings.step));
  rings.azimuths = 64;
  while (rings.azimuths < 2048 &&
         2 * std::numbers::pi * std::sin(std::min(steepest, 0.5 * std::numbers::pi)) / rings.azimuths >
             1.2 * rings.step)
    rings.azimuths *= 2;
  table.azimuths = rings.azimuths;
  const std::size_t nodes = lattice.pixel.size();
  table.light.assign(static_cast<std::size_t>(table.columns) * table.rows * table.azimuths * table.ring_size(), 0);
  if (nodes == 0) return table;
  const std::vector<FarRay> sources = sources_of(light, alpha);
  const std::vector<float> lobes = lobe_spectra(table, rings, alpha);
  tbb::parallel_for(std::size_t{0}, nodes, [&](std::size_t node) {
    std::vector<float> on(static_cast<std::size_t>(channels) * rings.count * rings.azimuths, 0.0F);
    each_seen(scene, light, channels, lattice.pixel[node], sources, [&](const Seen& seen, double cos_i, double cos_o) {
      spread(rings, seen, smith_G(cos_i, cos_o, alpha), channels, on);
    });
    convolve(table, rings, lobes, on, &table.light[node * table.azimuths * table.ring_size()]);
  });
  return table;
}

FaceTable make_face_table(const ViewScene& scene, const Light& light, int channels, const PlaceLattice& lattice) {
  const Material& m = scene.material;
  FaceTable table;
  const std::size_t size = static_cast<std::size_t>(lattice.columns) * lattice.rows * channels;
  table.light.assign(size, 0);
  table.by_log_alpha.assign(size, 0);
  const std::vector<FarRay> sources = sources_of(light, m.base_alpha);
  tbb::parallel_for(std::size_t{0}, lattice.pixel.size(), [&](std::size_t node) {
    std::array<double, 3> sum{}, by_log{};
    const std::size_t pixel = lattice.pixel[node];
    const Eigen::Matrix3d R = R_face_board(scene.grid->normal[pixel]);
    const Eigen::Vector3d wo = R * (scene.camera_center_mm - scene.grid->center_mm[pixel]).normalized();
    each_seen(scene, light, channels, pixel, sources, [&](const Seen& seen, double cos_i, double cos_o) {
      double value = 0, slope = 0;
      if (m.grain.none()) {
        const BaseLobe lobe = base_lobe(seen.h.z(), m.base_alpha);
        const Shadowing g = shadowing(cos_i, cos_o, m.base_alpha);
        value = lobe.D * g.G;
        slope = m.base_alpha * (lobe.dD_dalpha * g.G + lobe.D * g.dG_dalpha);
      } else {
        const Eigen::Vector3d wi = 2 * seen.h.dot(wo) * seen.h - wo;
        const GrainedLobe lobe = grained_lobe(seen.h, wi, wo, m.base_alpha, m.grain);
        value = lobe.value;
        slope = lobe.by_log_alpha;
      }
      for (int c = 0; c < channels; ++c) {
        sum[c] += value * seen.strength[c];
        by_log[c] += slope * seen.strength[c];
      }
    });
    for (int c = 0; c < channels; ++c) {
      table.light[node * channels + c] = static_cast<float>(sum[c]);
      table.by_log_alpha[node * channels + c] = static_cast<float>(by_log[c]);
    }
  });
  return table;
}

}  // namespace burin
