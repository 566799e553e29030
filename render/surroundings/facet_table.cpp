#include "burin/render/surroundings/facet_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <xsimd/xsimd.hpp>

#include "burin/render/brdf.h"
#include "burin/render/pixel_shading.h"
#include "burin/render/surroundings/fourier.h"
#include "burin/render/surroundings/seen_sources.h"

namespace burin {
namespace {

constexpr double kFine = 0.2;  // of the roughness: largest step of half vectors and of normals for cubic interpolation

/// Rings of half vectors: lean (k + 1/2) step, `azimuths` positions each.
struct Rings {
  int count = 0, azimuths = 0;
  double step = 0;
};

// Half vectors of a run with their positions on the rings.
struct Places {
  alignas(64) float lean[SeenSources::kMost];
  alignas(64) float turn[SeenSources::kMost];  // azimuth / (2 pi), 0 .. 1
  alignas(64) float shadowing[SeenSources::kMost];
};

void place(const SeenSources& seen, float alpha, Places& at) {
  using Packet = xsimd::batch<float>;
  const Packet one(1.0F), a2(alpha * alpha), per_turn(static_cast<float>(0.5 / std::numbers::pi));
  const auto g1 = [&](const Packet& cosine) {
    const Packet c2 = cosine * cosine;
    return Packet(2.0F) / (one + xsimd::sqrt(one + a2 * (one - c2) / c2));
  };
  const Packet out = g1(Packet(seen.cos_o));
  for (int k = 0; k < seen.count; k += static_cast<int>(Packet::size)) {
    const Packet x = Packet::load_aligned(seen.x + k), y = Packet::load_aligned(seen.y + k),
                 z = Packet::load_aligned(seen.z + k);
    xsimd::atan2(xsimd::sqrt(x * x + y * y), z).store_aligned(at.lean + k);
    const Packet turn = xsimd::atan2(y, x) * per_turn;
    xsimd::select(turn < Packet(0.0F), turn + one, turn).store_aligned(at.turn + k);
    (out * g1(Packet::load_aligned(seen.cos_i + k))).store_aligned(at.shadowing + k);
  }
}

// Spreads strength over 4 x 4 positions of the rings, which preserves sums of polynomials up to the third degree.
void spread(const Rings& rings, const SeenSources& seen, const Places& places, int channels, std::vector<float>& on) {
  const float per_step = static_cast<float>(1 / rings.step), azimuths = static_cast<float>(rings.azimuths);
  for (int k = 0; k < seen.count; ++k) {
    if (!seen.is_above(k)) continue;
    const float at = places.lean[k] * per_step - 0.5F, below = std::floor(at);
    const float around = places.turn[k] * azimuths, before = std::floor(around);
    float by_ring[4], by_azimuth[4], slope[4];
    lagrange_cubic(at - below, by_ring, slope);
    lagrange_cubic(around - before, by_azimuth, slope);
    for (int j = 0; j < 4; ++j) {
      int ring = static_cast<int>(below) - 1 + j, first = static_cast<int>(before) - 1 + rings.azimuths;
      if (ring < 0) {  // over the pole
        ring = -1 - ring;
        first += rings.azimuths / 2;
      }
      if (ring >= rings.count) continue;
      for (int c = 0; c < channels; ++c) {
        float* to = &on[(static_cast<std::size_t>(c) * rings.count + ring) * rings.azimuths];
        const float share = places.shadowing[k] * by_ring[j] * seen.strength[c][k];
        for (int i = 0; i < 4; ++i) to[(first + i) & (rings.azimuths - 1)] += share * by_azimuth[i];
      }
    }
  }
}

// Fourier transform of D over azimuth, for each lean of a normal and of a half vector: real, half of it. A facet's
// axes, across and along its groove, turn with the azimuth of its lean. So D (docs/model.md 3.7) still depends on the
// difference of azimuths alone.
std::vector<float> lobe_spectra(const FacetTable& table, const Rings& rings, const FourierTurns& turns, double alpha,
                                double across) {
  const int half = rings.azimuths / 2 + 1;
  std::vector<float> out(static_cast<std::size_t>(table.t_count) * rings.count * half);
  tbb::parallel_for(0, table.t_count, [&](int n) {
    std::vector<std::complex<float>> ring(rings.azimuths);
    const double lean = 2 * std::atan(n * table.t_step);
    for (int k = 0; k < rings.count; ++k) {
      const double other = (k + 0.5) * rings.step;
      for (int j = 0; j < rings.azimuths; ++j) {
        const double azimuth = 2 * std::numbers::pi * j / rings.azimuths;
        const double x = std::sin(other) * std::cos(azimuth), y = std::sin(other) * std::sin(azimuth),
                     z = std::cos(other);
        const double cosine = std::cos(lean) * z + std::sin(lean) * x, m = std::cos(lean) * x - std::sin(lean) * z;
        const double q = cosine * cosine + (m * m / (across * across) + y * y) / (alpha * alpha);
        ring[j] = across == 1  ? static_cast<float>(ggx_D(cosine, alpha))
                  : cosine > 0 ? static_cast<float>(1 / (std::numbers::pi * across * alpha * alpha * q * q))
                               : 0.0F;
      }
      fourier(ring, turns, false);
      for (int m = 0; m < half; ++m) out[(static_cast<std::size_t>(n) * rings.count + k) * half + m] = ring[m].real();
    }
  });
  return out;
}

void convolve(const FacetTable& table, const Rings& rings, const FourierTurns& turns, const std::vector<float>& lobes,
              const std::vector<float>& on, float* to) {
  const int half = rings.azimuths / 2 + 1, n_az = rings.azimuths;
  std::vector<std::complex<float>> ring(n_az), spectra(static_cast<std::size_t>(rings.count) * half);
  std::vector<char> lit(rings.count);
  for (int c = 0; c < table.channels; ++c) {
    for (int k = 0; k < rings.count; ++k) {
      const float* from = &on[(static_cast<std::size_t>(c) * rings.count + k) * n_az];
      lit[k] = std::any_of(from, from + n_az, [](float v) { return v != 0; }) ? 1 : 0;
      if (!lit[k]) continue;
      std::copy(from, from + n_az, ring.begin());
      fourier(ring, turns, false);
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
      fourier(ring, turns, true);
      for (int j = 0; j < n_az; ++j)
        to[static_cast<std::size_t>(j) * table.ring_size() + static_cast<std::size_t>(c) * table.t_count + n] =
            ring[j].real() / static_cast<float>(n_az);
    }
  }
}

}  // namespace

PlaceLattice place_lattice(const ViewScene& scene, const Light& light, double alpha) {
  constexpr double kStep = 0.3;  // of the roughness: turn between nodes
  constexpr int kMost = 40;
  const FootprintGrid& grid = *scene.grid;
  const int w = grid.width(), h = grid.height();
  std::vector<std::size_t> valid;
  for (std::size_t i = 0; i < grid.center_mm.size(); ++i)
    if (grid.center_mm[i].allFinite() && grid.normal[i].allFinite()) valid.push_back(i);
  PlaceLattice out;
  if (valid.empty()) return out;
  // Turn of the eye's direction, and of the face, over the picture: from its box of extremes.
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
  double by_column = 0, by_row = 0;  // radians per pixel
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
        // In large pictures a subset of pixels is enough, because places off the face serve interpolation alone.
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
  const double across = scene.material.profile.across, fine = kFine * alpha * std::min(1.0, across);
  table.t_step = 0.5 * fine;
  table.t_count = std::max(4, static_cast<int>(std::ceil(steepest_t / table.t_step)) + 2);
  const double steepest = 2 * std::atan(table.t_count * table.t_step);
  Rings rings;
  rings.step = fine;
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
  const LightSources sources = light_sources(light, fine);
  const FourierTurns turns = fourier_turns(static_cast<std::size_t>(rings.azimuths));
  const std::vector<float> lobes = lobe_spectra(table, rings, turns, alpha, across);
  tbb::parallel_for(std::size_t{0}, nodes, [&](std::size_t node) {
    std::vector<float> on(static_cast<std::size_t>(channels) * rings.count * rings.azimuths, 0.0F);
    Places places;
    each_seen(scene, light, channels, lattice.pixel[node], sources, [&](const SeenSources& seen) {
      place(seen, static_cast<float>(alpha), places);
      spread(rings, seen, places, channels, on);
    });
    convolve(table, rings, turns, lobes, on, &table.light[node * table.azimuths * table.ring_size()]);
  });
  return table;
}

FaceTable make_face_table(const ViewScene& scene, const Light& light, int channels, const PlaceLattice& lattice) {
  const Material& m = scene.material;
  FaceTable table;
  const std::size_t size = static_cast<std::size_t>(lattice.columns) * lattice.rows * channels;
  table.light.assign(size, 0);
  table.by_log_alpha.assign(size, 0);
  const LightSources sources = light_sources(light, kFine * m.base_alpha);
  tbb::parallel_for(std::size_t{0}, lattice.pixel.size(), [&](std::size_t node) {
    std::array<double, 3> sum{}, by_log{};
    const std::size_t pixel = lattice.pixel[node];
    const Eigen::Matrix3d R = R_face_board(scene.grid->normal[pixel]);
    const Eigen::Vector3d wo = R * (scene.camera_center_mm - scene.grid->center_mm[pixel]).normalized();
    each_seen(scene, light, channels, pixel, sources, [&](const SeenSources& seen) {
      for (int k = 0; k < seen.count; ++k) {
        if (!seen.is_above(k)) continue;
        const Eigen::Vector3d h = Eigen::Vector3d(seen.x[k], seen.y[k], seen.z[k]).normalized();
        double value = 0, slope = 0;
        if (m.grain.none()) {
          const BaseLobe lobe = base_lobe(h.z(), m.base_alpha);
          const Shadowing g = shadowing(static_cast<double>(seen.cos_i[k]), wo.z(), m.base_alpha);
          value = lobe.D * g.G;
          slope = m.base_alpha * (lobe.dD_dalpha * g.G + lobe.D * g.dG_dalpha);
        } else {
          const Eigen::Vector3d wi = 2 * h.dot(wo) * h - wo;
          const GrainedLobe lobe = grained_lobe(h, wi, wo, m.base_alpha, m.grain);
          value = lobe.value;
          slope = lobe.by_log_alpha;
        }
        for (int c = 0; c < channels; ++c) {
          sum[c] += value * static_cast<double>(seen.strength[c][k]);
          by_log[c] += slope * static_cast<double>(seen.strength[c][k]);
        }
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
