#include "burin/simulate/point_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "burin/base/cell_grid.h"
#include "burin/base/error.h"
#include "burin/base/scattered.h"
#include "burin/scene/far_light.h"
#include "burin/scene/lamp_size.h"
#include "burin/simulate/around_sampler.h"
#include "burin/simulate/bent_sheet.h"
#include "burin/simulate/brushed_face.h"
#include "burin/simulate/groove_section.h"
#include "burin/simulate/microfacets.h"
#include "burin/simulate/things_on_board.h"

namespace burin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Groove {
  double x0, y0, ex, ey, length, half_width, t_per_mm;  // along the scratch: (ex, ey); across it: (ey, -ex)
  double alpha;
  GrooveSection section;
};

// Grooves by place: the grooves that reach into each cell, lowest index first.
struct GrooveBins {
  CellGrid grid;
  std::vector<int> begin, list;
};

// Extent of a groove to either side of its middle, burrs included.
double reach_of(const Groove& g) { return g.section.paper ? g.half_width : 1e-3 * g.section.reach_um; }

double distance_to(const Groove& g, double x, double y) {
  const double dx = x - g.x0, dy = y - g.y0;
  const double along = std::clamp(dx * g.ex + dy * g.ey, 0.0, g.length);
  const double rx = dx - along * g.ex, ry = dy - along * g.ey;
  return std::sqrt(rx * rx + ry * ry);
}

GrooveBins bins_of(const std::vector<Groove>& grooves, const Vector2d& size_mm) {
  GrooveBins bins;
  bins.grid = cell_grid(size_mm, 1);
  const CellGrid& grid = bins.grid;
  const std::size_t cells = grid.cells();
  const double reach = grid.cell_mm * std::sqrt(0.5);
  const auto for_cells = [&](const Groove& g, const auto& visit) {
    const double x1 = g.x0 + g.length * g.ex, y1 = g.y0 + g.length * g.ey, w = reach_of(g);
    for (int r = grid.row(std::min(g.y0, y1) - w); r <= grid.row(std::max(g.y0, y1) + w); ++r)
      for (int c = grid.column(std::min(g.x0, x1) - w); c <= grid.column(std::max(g.x0, x1) + w); ++c)
        if (distance_to(g, (c + 0.5) * grid.cell_mm, (r + 0.5) * grid.cell_mm) <= w + reach) visit(grid.cell(c, r));
  };
  bins.begin.assign(cells + 1, 0);
  for (const Groove& g : grooves) for_cells(g, [&](std::size_t cell) { ++bins.begin[cell + 1]; });
  for (std::size_t i = 0; i < cells; ++i) bins.begin[i + 1] += bins.begin[i];
  bins.list.resize(bins.begin[cells]);
  std::vector<int> next(bins.begin.begin(), bins.begin.end() - 1);
  for (std::size_t i = 0; i < grooves.size(); ++i)
    for_cells(grooves[i], [&](std::size_t cell) { bins.list[next[cell]++] = static_cast<int>(i); });
  return bins;
}

// Cloth: value noise of three octaves, mean 1, never black.
double cloth_pattern(double x_mm, double y_mm, double strength, std::uint64_t seed) {
  const auto lattice = [&](int octave, long i, long j) {
    const auto key = static_cast<std::uint64_t>(i) * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(j) + seed +
                     static_cast<std::uint64_t>(octave) * 0x632be59bd9b4e019ULL;
    return static_cast<double>(scattered(key) >> 11) * 0x1.0p-53 - 0.5;
  };
  double sum = 0, scale_mm = 6, weight = 0.5;
  for (int octave = 0; octave < 3; ++octave, scale_mm /= 3, weight /= 1.5) {
    const double x = x_mm / scale_mm, y = y_mm / scale_mm;
    const double fx = std::floor(x), fy = std::floor(y);
    const long i = static_cast<long>(fx), j = static_cast<long>(fy);
    const auto ease = [](double t) { return t * t * (3 - 2 * t); };
    const double u = ease(x - fx), v = ease(y - fy);
    sum += weight * ((1 - v) * ((1 - u) * lattice(octave, i, j) + u * lattice(octave, i + 1, j)) +
                     v * ((1 - u) * lattice(octave, i, j + 1) + u * lattice(octave, i + 1, j + 1)));
  }
  return std::max(0.05, 1 + strength * sum);
}

// Light at a point: the direction to the lamp, and intensity's common factor / distance^2.
struct Arriving {
  Vector3d wi;
  double strength;
};

Arriving arriving(const Light& light, const Vector3d& p) {
  const Vector3d to_lamp = light.position_mm - p;
  const double d2 = to_lamp.squaredNorm();
  Arriving a{to_lamp / std::sqrt(d2), 1 / d2};
  if (light.falloff_exponent > 0) a.strength *= std::pow(std::max(0.0, -light.axis.dot(a.wi)), light.falloff_exponent);
  return a;
}

// Slowly varying quantities of a pixel, at one of its corners on the face.
struct Corner {
  double x = kNaN, y = kNaN;              // on the face; NaN if the ray misses it
  double cloth_x = kNaN, cloth_y = kNaN;  // on the cloth's plane
  double h_x = 0, h_y = 0, h_n = 0;       // half vector: board x and y (of a bent sheet turned flat), along the normal
  double geometry = 0;                    // strength / (4 wo.n); 0 if lamp or camera is below the face
  double fresnel = 0;                     // (1 - h.wo)^5
  double cos_i = 0, cos_o = 0;
  double base = 0;                                               // D G of the plain face times geometry
  Vector3d base_h{0, 0, 1}, base_wi{0, 0, 1}, base_wo{0, 0, 1};  // of a brushed face
};

/// A pixel by its corners, in the order of (u, v) = (0, 0), (1, 0), (0, 1), (1, 1), v downwards.
struct PixelCorners {
  std::array<const Corner*, 4> corner;

  double mean(double Corner::*field) const {
    return (corner[0]->*field + corner[1]->*field + corner[2]->*field + corner[3]->*field) / 4;
  }
  double at(double Corner::*field, double u, double v) const {
    return (1 - v) * ((1 - u) * corner[0]->*field + u * corner[1]->*field) +
           v * ((1 - u) * corner[2]->*field + u * corner[3]->*field);
  }
  /// Bounding box of the corners on the board.
  void box(Vector2d& low, Vector2d& high) const {
    const auto [x0, x1] = std::minmax({corner[0]->x, corner[1]->x, corner[2]->x, corner[3]->x});
    const auto [y0, y1] = std::minmax({corner[0]->y, corner[1]->y, corner[2]->y, corner[3]->y});
    low = {x0, y0};
    high = {x1, y1};
  }
};

/// A groove in one pixel.
struct SeenGroove {
  double x0, y0, ex, ey, length, half_width, t_per_mm, a2, scale, tilt;
  const GrooveSection* section;

  /// Signed distance of a point to the right of the groove's middle line; nothing beyond its ends.
  std::optional<double> across(double px, double py) const {
    const double dx = px - x0, dy = py - y0, along = dx * ex + dy * ey;
    if (along < 0 || along > length) return std::nullopt;
    return dx * ey - dy * ex;
  }
  /// The distance for points inside the groove; nothing for others.
  std::optional<double> within(double px, double py) const {
    const std::optional<double> aside = across(px, py);
    return aside && std::abs(*aside) <= half_width ? aside : std::nullopt;
  }
};

/// The face in one pixel: its normal, the direction to the camera, and that direction with the sheet turned flat.
struct SeenFace {
  Vector3d normal{0, 0, 1}, wo{0, 0, 1}, wo_flat{0, 0, 1};
  Vector3d grooves_lie{0, 0, 1};                       // reference normal of the grooves' directions
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // takes directions on the flat sheet to those in space
  bool shaded = false;                                 // by the sheet itself
};

/// Sums over the points of a pixel.
struct PointSums {
  Vector3d others = Vector3d::Zero();       // light of all objects other than metal
  double metal = 0, covered = 0;            // points on metal, and grooves over them
  double groove_light = 0;                  // D G times geometry
  double sum_u = 0, sum_v = 0, sum_uv = 0;  // over points on the plain face
  double plain = 0;
};

/// A groove or burr at a point: height and slope of the metal.
struct Met {
  double height_um, lean;
  const SeenGroove* groove;
};

/// Calls shine(met) for grooves of any cross-section at a point, with height and slope; returns if the plain face shows
/// there. A groove removes metal above the face; of several, the last one or the deepest remains. Outside of grooves
/// the highest burr remains.
template <typename Shine>
bool each_section(const std::vector<SeenGroove>& grooves, double px, double py, bool last_rules, bool deepest_rules,
                  const Shine& shine) {
  std::optional<Met> deepest, highest;
  bool shows_plain = true;
  for (std::size_t k = grooves.size(); k-- > 0;) {
    const SeenGroove& g = grooves[k];
    const std::optional<double> across = g.across(px, py);
    if (!across) continue;
    const std::optional<SectionPoint> point = section_at(*g.section, 1e3 * *across);
    if (!point) continue;
    const Met met{point->height_um, point->lean, &g};
    if (!last_rules) {
      shine(met);
      shows_plain = false;
    } else if (met.height_um > 0) {
      if (!highest || met.height_um > highest->height_um) highest = met;
    } else if (!deepest || (deepest_rules && met.height_um < deepest->height_um)) {
      deepest = met;
    }
  }
  if (!last_rules) return shows_plain;
  if (deepest)
    shine(*deepest);
  else if (highest)
    shine(*highest);
  return !deepest && !highest;
}

/// True if each_section() is needed: the paper's grooves have a faster path.
bool needs_sections(const std::vector<SeenGroove>& grooves, bool deepest_rules) {
  return !grooves.empty() && (deepest_rules || !grooves.front().section->paper);
}

bool add_sections(const std::vector<SeenGroove>& grooves, double px, double py, const Vector3d& h, double bare,
                  bool last_rules, bool deepest_rules, PointSums& sums) {
  return each_section(grooves, px, py, last_rules, deepest_rules, [&](const Met& met) {
    const SeenGroove& g = *met.groove;
    const double h_across = (h.x() * g.ey - h.y() * g.ex - h.z() * g.tilt) / std::sqrt(1 - g.tilt * g.tilt);
    const double h_along = h.x() * g.ex + h.y() * g.ey;
    const double sine = std::sin(met.lean), cosine = std::cos(met.lean);
    const double n_h = h.z() * cosine - h_across * sine, m_h = (h_across * cosine + h.z() * sine) / g.section->across;
    sums.covered += bare;
    if (!(n_h > 0)) return;
    // GGX with two roughnesses about the wall's normal.
    const double q = m_h * m_h + h_along * h_along + g.a2 * n_h * n_h;
    sums.groove_light += bare * g.scale / (g.section->across * q * q);
  });
}

/// Adds the grooves' light at a point of the metal, of which `bare` is visible; returns if the plain face shows there
/// too.
bool add_grooves(const std::vector<SeenGroove>& grooves, double px, double py, const Vector3d& h, double bare,
                 bool last_rules, bool deepest_rules, PointSums& sums) {
  if (needs_sections(grooves, deepest_rules))
    return add_sections(grooves, px, py, h, bare, last_rules, deepest_rules, sums);
  bool shows_plain = true;
  for (std::size_t k = grooves.size(); k-- > 0;) {
    const SeenGroove& g = grooves[k];
    const std::optional<double> across = g.within(px, py);
    if (!across) continue;
    sums.covered += bare;
    // The groove's normal (-2t, 0, 1 - t^2) / (1 + t^2) across it, along it, out of the face (docs/model.md 2.3).
    const double t = g.t_per_mm * *across;
    const double h_across = (h.x() * g.ey - h.y() * g.ex - h.z() * g.tilt) / std::sqrt(1 - g.tilt * g.tilt);
    const double n_h = (-2 * t * h_across + (1 - t * t) * h.z()) / (1 + t * t);
    if (n_h > 0) {
      const double q = n_h * n_h * (g.a2 - 1) + 1;
      sums.groove_light += bare * g.scale / (q * q);
    }
    shows_plain = false;
    if (last_rules) break;
  }
  return shows_plain;
}

}  // namespace

struct PointSampler::State {
  const BenchTruth& truth;
  std::vector<Groove> grooves;
  GrooveBins bins;
  ThingsOnBoard things;
  std::optional<BrushedFace> brushed;
  std::vector<Vector3d> rays;  // through the pixels' corners, (width + 1) x (height + 1), camera frame
  std::optional<BentSheet> bent;

  explicit State(const BenchTruth& t) : truth(t), things(t) {
    if (!t.board.material.grain.none()) brushed = brushed_face(t);
    if (t.board.bend) bent.emplace(t.board.bend->radius_mm, t.board.bend->axis_deg, t.board.size_mm);
  }
  bool has_streaks() const { return brushed && truth.streaks.slope > 0; }

  void fill_corners(const TruthView& view, const Light& light, int row, std::span<Corner> corners) const;
  Vector3d pixel(std::span<const Corner> above, std::span<const Corner> below, int x, const Light& light,
                 const Vector3d& camera, int samples, std::uint64_t seed) const;
  /// A pixel under surroundings; their light on paper is that of `flat`, a lamp straight above.
  Vector3d pixel_around(std::span<const Corner> above, std::span<const Corner> below, int x,
                        const AroundSampler& around, const Vector3d& factor, const Light& flat, const Vector3d& camera,
                        int samples, std::uint64_t seed) const;
  SeenFace face_seen(double x, double y, const Light& light, const Vector3d& camera) const;
  void near_grooves(const Vector2d& low, const Vector2d& high, std::vector<int>& found) const;
  Vector3d cloth_at(const PixelCorners& corners, const Light& light, double u, double v) const;
  void see_grooves(const std::vector<int>& near, const PixelCorners& corners, const Vector3d& normal,
                   std::vector<SeenGroove>& seen) const;
  void fill_bent_corner(const Vector3d& camera, const Vector3d& ray, const Light& light, Corner& corner) const;
  void shine(const Vector3d& camera, const Light& light, const Vector3d& p, const Vector3d& normal, bool shaded,
             const Eigen::Matrix3d& turned_flat, Corner& corner) const;
  /// Adds the light of objects above a point of the face; returns the unhidden share of the metal.
  double add_things(const std::vector<int>& near, double px, double py, const SeenFace& face, const Light& light,
                    Vector3d& others) const;
};

namespace {

// Rays through the upper corners of a row of pixels.
void unproject_row(const Lens& lens, int row, std::span<Vector3d> rays) {
  std::vector<Vector2d> q(rays.size());
  for (std::size_t x = 0; x < q.size(); ++x) q[x] = {static_cast<double>(x) - 0.5, row - 0.5};
  unproject(lens, q, rays);
}

}  // namespace

PointSampler::PointSampler(const BenchTruth& truth, const Carved& grooves) : state_(std::make_unique<State>(truth)) {
  const Scratches& carved = grooves.scratches;
  const std::size_t n = carved.size();
  if (carved.width_um.size() != n || carved.depth_um.size() != n || carved.alpha.size() != n)
    fail("PointSampler", "carved scratches without width, depth and alpha", "use carved_by()");
  for (std::size_t i = 0; i < n; ++i) {
    const double dx = carved.x1_mm[i] - carved.x0_mm[i], dy = carved.y1_mm[i] - carved.y0_mm[i];
    const double length = std::hypot(dx, dy);
    const GrooveSection section = section_of(truth.board.material.profile, carved.width_um[i], carved.depth_um[i]);
    state_->grooves.push_back({carved.x0_mm[i], carved.y0_mm[i], dx / length, dy / length, length,
                               1e-3 * section.half_width_um, 2 / (1e-3 * carved.width_um[i]), carved.alpha[i],
                               section});
  }
  state_->bins = bins_of(state_->grooves, truth.board.size_mm);

  const int w = truth.lens.width + 1, h = truth.lens.height + 1;
  state_->rays.resize(static_cast<std::size_t>(w) * h);
  tbb::parallel_for(0, h, [&](int y) {
    unproject_row(truth.lens, y, std::span(state_->rays).subspan(static_cast<std::size_t>(y) * w, w));
  });
}

PointSampler::~PointSampler() = default;

void PointSampler::State::fill_corners(const TruthView& view, const Light& light, int row,
                                       std::span<Corner> corners) const {
  const Eigen::Isometry3d T_board_camera = view.T_camera_board.inverse();
  const Vector3d camera = T_board_camera.translation();
  const Vector2d size = truth.board.size_mm;
  std::span<const Vector3d> of_row(rays.data() + static_cast<std::size_t>(row) * corners.size(), corners.size());
  std::vector<Vector3d> own;
  if (view.lens) {
    own.resize(corners.size());
    unproject_row(*view.lens, row, own);
    of_row = own;
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    Corner& corner = corners[i] = Corner{};
    const Vector3d ray = T_board_camera.linear() * of_row[i];
    const auto meet = [&](double z_mm) { return (z_mm - camera.z()) / ray.z(); };
    double s = meet(truth.cloth.z_mm);
    if (!(s > 0) || !std::isfinite(s)) continue;
    corner.cloth_x = camera.x() + s * ray.x();
    corner.cloth_y = camera.y() + s * ray.y();
    if (bent) {
      fill_bent_corner(camera, ray, light, corner);
      continue;
    }
    s = meet(0);
    Vector3d p = camera + s * ray;
    for (int step = 0; step < 4; ++step) {  // the bow moves a point by its height times the ray's slope: contracts
      const double x = std::clamp(p.x(), -0.2 * size.x(), 1.2 * size.x());
      const double y = std::clamp(p.y(), -0.2 * size.y(), 1.2 * size.y());
      p = camera + meet(height_mm(truth.surface, x, y)) * ray;
    }
    if (!p.allFinite() || !(s > 0)) continue;
    corner.x = p.x();
    corner.y = p.y();
    // Beyond the board's edge nothing reflects; only pixels across the edge need their outer corners.
    if (p.x() < -5 || p.y() < -5 || p.x() > size.x() + 5 || p.y() > size.y() + 5) continue;
    shine(camera, light, p, face_normal(truth.surface, p.x(), p.y()), false, Eigen::Matrix3d::Identity(), corner);
  }
}

void PointSampler::State::shine(const Vector3d& camera, const Light& light, const Vector3d& p, const Vector3d& normal,
                                bool shaded, const Eigen::Matrix3d& turned_flat, Corner& corner) const {
  const Arriving light_here = arriving(light, p);
  const Vector3d wo = (camera - p).normalized(), h = (light_here.wi + wo).normalized(), h_flat = turned_flat * h;
  corner.h_x = h_flat.x();
  corner.h_y = h_flat.y();
  corner.h_n = normal.dot(h);
  corner.cos_i = normal.dot(light_here.wi);
  corner.cos_o = normal.dot(wo);
  corner.fresnel = fresnel_share(h.dot(wo), 0.0);
  if (corner.cos_i > 0 && corner.cos_o > 0 && !shaded) corner.geometry = light_here.strength / (4 * corner.cos_o);
  if (brushed) {
    corner.base_h = h_flat;
    corner.base_wi = turned_flat * light_here.wi;
    corner.base_wo = turned_flat * wo;
    corner.base = 0;
    if (!has_streaks())  // streaks are finer than a pixel and are evaluated at its points
      corner.base =
          brushed_light(*brushed, turned_flat * normal, h_flat, corner.base_wi, corner.base_wo) * corner.geometry;
    return;
  }
  const double alpha = truth.board.material.base_alpha;
  corner.base =
      facets_leaning(corner.h_n, alpha) * share_lit_and_seen(corner.cos_i, corner.cos_o, alpha) * corner.geometry;
}

// A ray meets the nearest part of a bent sheet, or its back, which shows nothing.
void PointSampler::State::fill_bent_corner(const Vector3d& camera, const Vector3d& ray, const Light& light,
                                           Corner& corner) const {
  constexpr double kBeyond_mm = 5;
  const auto met = bent->first_met(camera, ray, kBeyond_mm);
  if (!met) return;
  corner.x = met->x();
  corner.y = met->y();
  const BentSheet::Place place = bent->at(met->x(), met->y());
  shine(camera, light, place.position_mm, place.normal(), bent->shades(place, light.position_mm),
        place.turn.transpose(), corner);
}

void PointSampler::State::near_grooves(const Vector2d& low, const Vector2d& high, std::vector<int>& found) const {
  found.clear();
  const CellGrid& grid = bins.grid;
  const int c0 = grid.column(low.x()), c1 = grid.column(high.x()), r0 = grid.row(low.y()), r1 = grid.row(high.y());
  const Vector2d middle = (low + high) / 2;
  const double radius = (high - low).norm() / 2;
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c) {
      const std::size_t cell = grid.cell(c, r);
      for (int k = bins.begin[cell]; k < bins.begin[cell + 1]; ++k) {
        const Groove& g = grooves[bins.list[k]];
        if (distance_to(g, middle.x(), middle.y()) <= reach_of(g) + radius) found.push_back(bins.list[k]);
      }
    }
  if (c0 == c1 && r0 == r1) return;
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

Vector3d PointSampler::State::cloth_at(const PixelCorners& corners, const Light& light, double u, double v) const {
  const double px = corners.at(&Corner::cloth_x, u, v), py = corners.at(&Corner::cloth_y, u, v);
  const Arriving here = arriving(light, {px, py, truth.cloth.z_mm});
  const Vector3d lit =
      light.intensity * (std::max(0.0, here.wi.z()) * here.strength / std::numbers::pi) + truth.ambient;
  return truth.cloth.albedo.cwiseProduct(lit) *
         (truth.cloth.noise > 0 ? cloth_pattern(px, py, truth.cloth.noise, truth.seed) : 1.0);
}

void PointSampler::State::see_grooves(const std::vector<int>& near, const PixelCorners& corners, const Vector3d& normal,
                                      std::vector<SeenGroove>& seen) const {
  seen.clear();
  for (const int i : near) {
    const Groove& g = grooves[i];
    const double a2 = g.alpha * g.alpha;
    seen.push_back({g.x0, g.y0, g.ex, g.ey, g.length, g.half_width, g.t_per_mm, a2,
                    a2 / std::numbers::pi *
                        share_lit_and_seen(corners.mean(&Corner::cos_i), corners.mean(&Corner::cos_o), g.alpha),
                    normal.x() * g.ey - normal.y() * g.ex, &g.section});
  }
}

double PointSampler::State::add_things(const std::vector<int>& near, double px, double py, const SeenFace& face,
                                       const Light& light, Vector3d& others) const {
  const Vector3d &normal = face.normal, &wo = face.wo;
  double bare = 1;
  for (const int thing : near) {
    const double z = things.z_mm(thing);
    const double tx = px + z * face.wo_flat.x() / face.wo_flat.z(), ty = py + z * face.wo_flat.y() / face.wo_flat.z();
    Coat coat;
    if (!things.at(thing, tx, ty, coat)) continue;
    Vector3d p(tx, ty, z);
    if (bent) {
      const BentSheet::Place place = bent->at(tx, ty);
      p = place.position_mm + z * place.normal();
    } else {
      p.z() += height_mm(truth.surface, tx, ty);
    }
    const Arriving here = arriving(light, p);
    const double cos_i = face.shaded ? 0.0 : std::max(0.0, normal.dot(here.wi));
    Vector3d seen =
        coat.albedo.cwiseProduct(light.intensity * (cos_i * here.strength / std::numbers::pi) + truth.ambient);
    if (coat.gloss_f0 > 0) {
      const Vector3d h = (here.wi + wo).normalized();
      const double cos_o = normal.dot(wo);
      if (cos_i > 0 && cos_o > 0)
        seen += light.intensity *
                (facets_leaning(normal.dot(h), coat.gloss_alpha) * share_lit_and_seen(cos_i, cos_o, coat.gloss_alpha) *
                 fresnel_share(h.dot(wo), coat.gloss_f0) * here.strength / (4 * cos_o));
      seen += truth.ambient * coat.gloss_f0;
    }
    others += bare * coat.share * seen;
    bare *= 1 - coat.share;
    if (bare <= 0) break;
  }
  return bare;
}

SeenFace PointSampler::State::face_seen(double x, double y, const Light& light, const Vector3d& camera) const {
  SeenFace face;
  if (!bent) {
    face.normal = face.grooves_lie = face_normal(truth.surface, x, y);
    // The camera's direction, for objects above the face.
    face.wo = face.wo_flat = (camera - Vector3d(x, y, height_mm(truth.surface, x, y))).normalized();
    return face;
  }
  const BentSheet::Place place = bent->at(x, y);
  face.turn = place.turn;
  face.normal = place.normal();
  face.wo = (camera - place.position_mm).normalized();
  face.wo_flat = place.turn.transpose() * face.wo;
  face.shaded = bent->shades(place, light.position_mm);
  return face;
}

Vector3d PointSampler::State::pixel(std::span<const Corner> above, std::span<const Corner> below, int x,
                                    const Light& light, const Vector3d& camera, int samples, std::uint64_t seed) const {
  const PixelCorners corners{{&above[x], &above[x + 1], &below[x], &below[x + 1]}};
  if (!std::isfinite(corners.mean(&Corner::cloth_x))) return Vector3d::Zero();  // beyond the horizon: nothing there
  const bool on_plane = std::isfinite(corners.mean(&Corner::x));
  Vector2d low(1, 1), high(0, 0);
  if (on_plane) corners.box(low, high);
  const Vector2d size = truth.board.size_mm;
  constexpr double kEdge_mm = 1;   // paper above the face is visible over the board's edge
  constexpr double kTorn_mm = 20;  // a pixel across the rim of a hollow sheet, which sees two distant parts of it
  const bool misses = !on_plane || high.x() < -kEdge_mm || high.y() < -kEdge_mm || low.x() > size.x() + kEdge_mm ||
                      low.y() > size.y() + kEdge_mm || (bent && (high - low).maxCoeff() > kTorn_mm);
  if (misses) return cloth_at(corners, light, 0.5, 0.5);  // no result depends on the resolution of the cloth
  const bool whole = low.x() >= 0 && low.y() >= 0 && high.x() <= size.x() && high.y() <= size.y();

  thread_local std::vector<int> near_things, near;
  things.near(low, high, near_things);
  near_grooves(low, high, near);
  const Vector3d f0 = truth.board.material.f0;
  const Vector3d F = f0 + (Vector3d::Ones() - f0) * corners.mean(&Corner::fresnel);
  if (whole && near.empty() && near_things.empty() && !has_streaks())  // plain face, and smooth: nothing to sample
    return light.intensity.cwiseProduct(F) * corners.mean(&Corner::base) + truth.ambient.cwiseProduct(f0);
  const int wanted = near.empty() ? std::min(samples, truth.samples_plain) : samples;
  const int side = std::max(1, static_cast<int>(std::lround(std::sqrt(wanted))));

  const double mean_x = corners.mean(&Corner::x), mean_y = corners.mean(&Corner::y);
  const SeenFace face = face_seen(mean_x, mean_y, light, camera);
  const Vector3d& grooves_lie = face.grooves_lie;
  thread_local std::vector<SeenGroove> seen_grooves;
  see_grooves(near, corners, grooves_lie, seen_grooves);
  const Vector3d mean_h(corners.mean(&Corner::h_x), corners.mean(&Corner::h_y), corners.mean(&Corner::h_n));

  PointSums sums;
  double streaked = 0;  // D G of the plain face, summed over its points
  const double cell = 1.0 / side;
  std::uint64_t state = seed;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const std::uint64_t bits = scattered(state += 0x9e3779b97f4a7c15ULL);
      const double u = (i + static_cast<double>(bits >> 32) * 0x1.0p-32) * cell;
      const double v = (j + static_cast<double>(bits & 0xffffffffU) * 0x1.0p-32) * cell;
      const double px = corners.at(&Corner::x, u, v), py = corners.at(&Corner::y, u, v);
      const double bare = add_things(near_things, px, py, face, light, sums.others);
      if (bare <= 0) continue;
      if (!whole && (px < 0 || py < 0 || px > size.x() || py > size.y())) {
        sums.others += bare * cloth_at(corners, light, u, v);
        continue;
      }
      sums.metal += bare;
      const Vector3d h = truth.h_at_center ? mean_h
                                           : Vector3d(corners.at(&Corner::h_x, u, v), corners.at(&Corner::h_y, u, v),
                                                      corners.at(&Corner::h_n, u, v));
      const bool shows_plain = add_grooves(seen_grooves, px, py, h, bare, truth.last_rules, truth.deepest_rules, sums);
      if ((shows_plain || !truth.last_rules) && has_streaks()) {
        const Vector3d tilted = streaked_normal(*brushed, grooves_lie, px, py);
        streaked += bare * brushed_light(*brushed, tilted, corners.corner[0]->base_h, corners.corner[0]->base_wi,
                                         corners.corner[0]->base_wo);
      }
      if (shows_plain || !truth.last_rules) {
        sums.plain += bare;
        sums.sum_u += bare * u;
        sums.sum_v += bare * v;
        sums.sum_uv += bare * u * v;
      }
    }

  // Sum of the bilinear base light over the points on the plain face.
  const auto& corner = corners.corner;
  double base_light = 0;
  if (sums.plain > 0)
    base_light = corner[0]->base * (sums.plain - sums.sum_u - sums.sum_v + sums.sum_uv) +
                 corner[1]->base * (sums.sum_u - sums.sum_uv) + corner[2]->base * (sums.sum_v - sums.sum_uv) +
                 corner[3]->base * sums.sum_uv;
  if (has_streaks()) base_light = streaked * corners.mean(&Corner::geometry);
  if (!truth.last_rules && sums.metal > 0) base_light *= 1 - std::min(1.0, sums.covered / sums.metal);
  const double reflected = sums.groove_light * corners.mean(&Corner::geometry) + base_light;
  const Vector3d sum =
      sums.others + light.intensity.cwiseProduct(F) * reflected + sums.metal * truth.ambient.cwiseProduct(f0);
  return sum / (side * side);
}

Vector3d PointSampler::State::pixel_around(std::span<const Corner> above, std::span<const Corner> below, int x,
                                           const AroundSampler& around, const Vector3d& factor, const Light& flat,
                                           const Vector3d& camera, int samples, std::uint64_t seed) const {
  const PixelCorners corners{{&above[x], &above[x + 1], &below[x], &below[x + 1]}};
  if (!std::isfinite(corners.mean(&Corner::cloth_x))) return Vector3d::Zero();
  Vector2d low(1, 1), high(0, 0);
  const bool on_plane = std::isfinite(corners.mean(&Corner::x));
  if (on_plane) corners.box(low, high);
  const Vector2d size = truth.board.size_mm;
  if (!on_plane || high.x() < 0 || high.y() < 0 || low.x() > size.x() || low.y() > size.y())
    return cloth_at(corners, flat, 0.5, 0.5);
  thread_local std::vector<int> near_things, near;
  things.near(low, high, near_things);
  near_grooves(low, high, near);
  const int side = std::max(1, static_cast<int>(std::lround(std::sqrt(samples))));
  const double mean_x = corners.mean(&Corner::x), mean_y = corners.mean(&Corner::y);
  const Vector3d f0 = truth.board.material.f0;
  const SeenFace middle = face_seen(mean_x, mean_y, flat, camera);
  const Vector3d& lie = middle.grooves_lie;
  thread_local std::vector<SeenGroove> seen;
  see_grooves(near, corners, lie, seen);
  Vector3d others = Vector3d::Zero(), grooves_light = Vector3d::Zero(), face_light = Vector3d::Zero();
  double metal = 0, covered = 0;
  std::uint64_t state = seed;
  const auto uniform = [&] { return static_cast<double>(scattered(state += 0x9e3779b97f4a7c15ULL) >> 11) * 0x1.0p-53; };
  const auto from = [&](const RoughFacet& facet, const Vector3d& wo) -> Vector3d {
    const double u[4] = {uniform(), uniform(), uniform(), uniform()};
    return around
        .reflected({middle.turn * facet.normal, middle.turn * facet.across, facet.alpha, facet.ratio}, middle.normal,
                   wo, f0, u)
        .cwiseProduct(factor);
  };
  // Across a groove, tangential to the face.
  const auto x_axis = [&](const SeenGroove& g) -> Vector3d {
    return (Vector3d(g.ey, -g.ex, 0) - g.tilt * lie) / std::sqrt(1 - g.tilt * g.tilt);
  };
  const RoughFacet plain{lie, lie.unitOrthogonal(), truth.board.material.base_alpha, 1};
  for (int k = 0; k < side * side; ++k) {
    const int column = k % side, row = k / side;
    const double u = (column + uniform()) / side, v = (row + uniform()) / side;
    const double px = corners.at(&Corner::x, u, v), py = corners.at(&Corner::y, u, v);
    const Vector3d wo = face_seen(px, py, flat, camera).wo;
    const double bare = add_things(near_things, px, py, middle, flat, others);
    if (bare <= 0) continue;
    if (px < 0 || py < 0 || px > size.x() || py > size.y()) {
      others += bare * cloth_at(corners, flat, u, v);
      continue;
    }
    metal += bare;
    const auto shine = [&](const SeenGroove& g, double sine, double cosine) {
      covered += bare;
      const Vector3d x = x_axis(g);
      grooves_light +=
          bare * from({cosine * lie - sine * x, cosine * x + sine * lie, std::sqrt(g.a2), g.section->across}, wo);
    };
    bool shows_plain = true;
    if (needs_sections(seen, truth.deepest_rules)) {
      shows_plain = each_section(seen, px, py, truth.last_rules, truth.deepest_rules,
                                 [&](const Met& met) { shine(*met.groove, std::sin(met.lean), std::cos(met.lean)); });
    } else {
      for (std::size_t i = seen.size(); i-- > 0;) {
        const SeenGroove& g = seen[i];
        const std::optional<double> across = g.within(px, py);
        if (!across) continue;
        const double t = g.t_per_mm * *across;
        shine(g, 2 * t / (1 + t * t), (1 - t * t) / (1 + t * t));
        shows_plain = false;
        if (truth.last_rules) break;
      }
    }
    if (shows_plain || !truth.last_rules) face_light += bare * from(plain, wo);
  }
  if (!truth.last_rules && metal > 0) face_light *= 1 - std::min(1.0, covered / metal);
  return (others + grooves_light + face_light + metal * truth.ambient.cwiseProduct(f0)) / (side * side);
}

namespace {

// A point lamp and its share of the pixel's points.
struct PointOfLamp {
  Light light;
  double share = 1;
};

// Evenly spread points of an area light: a sunflower pattern on a disk. On a panel it is a lattice on a quarter,
// mirrored to the others. A lattice on the whole panel would equal a panel turned by a degree.
std::vector<Vector3d> spread_over(const Light& light, int count) {
  if (light.size.is_point()) return {light.position_mm};
  const double golden = (std::sqrt(5.0) - 1) / 2;
  const Eigen::Matrix<double, 3, 2> across = across_axis(light.axis, light.size.turn_deg);
  std::vector<Vector3d> out;
  const auto add = [&](const Vector2d& at) { out.emplace_back(light.position_mm + across * at); };
  const bool disk = light.size.disk_mm > 0;
  const int steps = disk ? count : (count + 3) / 4;
  for (int i = 0; i < steps; ++i) {
    const double part = (i + 0.5) / steps, other = std::fmod((i + 0.5) * golden, 1.0);
    const double angle = 2 * std::numbers::pi * other;
    if (disk) {
      add(light.size.disk_mm * std::sqrt(part) * Vector2d(std::cos(angle), std::sin(angle)));
      continue;
    }
    const Vector2d at = 0.5 * light.size.panel_mm.cwiseProduct(Vector2d(part, other));
    for (const double x : {-at.x(), at.x()})
      for (const double y : {-at.y(), at.y()}) add({x, y});
  }
  return out;
}

// All lit lamps of a photo under `light`, one by one.
std::vector<Light> all_lit(const BenchTruth& truth, const Light& light) {
  std::vector<Light> lit{light};
  lit.front().also.clear();
  lit.insert(lit.end(), light.also.begin(), light.also.end());
  lit.insert(lit.end(), truth.stray_lights.begin(), truth.stray_lights.end());
  return lit;
}

// A lamp straight above a place that lights paper as surroundings do.
Light flat_light(const Light& around) {
  Light flat;
  flat.position_mm = {0, 0, kFar_mm};
  flat.intensity =
      irradiance(*around.far->surroundings, Vector3d::UnitZ()).cwiseProduct(around.intensity) * (kFar_mm * kFar_mm);
  return flat;
}

// All points of the lit lamps. Shares add up to 1, so light from other sources counts once. A point's brightness is
// divided by its share.
std::vector<PointOfLamp> points_of(const BenchTruth& truth, const Light& light) {
  const std::vector<Light> lit = all_lit(truth, light);
  std::vector<PointOfLamp> out;
  for (Light lamp : lit) {
    if (lamp.far && !lamp.far->is_sun()) continue;
    if (lamp.far) {
      const double radius = 0.5 * lamp.far->diameter_deg * std::numbers::pi / 180;
      lamp = sun_as_lamp(lamp);
      lamp.size.disk_mm = kFar_mm * std::tan(radius);
    }
    const std::vector<Vector3d> places = spread_over(lamp, truth.lamp_samples);
    const double of_all = 1.0 / static_cast<double>(lit.size()), of_lamp = 1.0 / static_cast<double>(places.size());
    for (const Vector3d& place : places) {
      PointOfLamp point{lamp, of_all * of_lamp};
      point.light.position_mm = place;
      point.light.size = {};
      point.light.intensity /= of_all;
      out.push_back(std::move(point));
    }
  }
  return out;
}

}  // namespace

Image PointSampler::radiance(const TruthView& view, const Light& light, const Progress& progress) const {
  const BenchTruth& truth = state_->truth;
  std::uint64_t view_seed = truth.seed;
  for (const char c : view.name + "/" + light.id) view_seed = scattered(view_seed ^ static_cast<unsigned char>(c));
  const std::vector<Light> lit = all_lit(truth, light);
  std::vector<PointOfLamp> points = points_of(truth, light);
  if (lit.size() == 1 && points.size() == 1)
    return radiance_of_point(view, points.front().light, truth.samples, view_seed, progress);
  // Each point of the lamp has pixel points of its own; the total grows slightly, as each pattern is coarser.
  constexpr int kFewest = 9;
  const int samples = std::max(kFewest, static_cast<int>(2 * truth.samples / std::max<std::size_t>(1, points.size())));
  Image sum(truth.lens.width, truth.lens.height, 3);
  const auto add = [&](const Image& one, double share) {
    for (std::size_t i = 0; i < sum.data.size(); ++i) sum.data[i] += static_cast<float>(share) * one.data[i];
  };
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double done = static_cast<double>(k) / static_cast<double>(points.size());
    const Progress within = [&](std::string_view what, double) {
      if (progress) progress(what, done);
    };
    add(radiance_of_point(view, points[k].light, samples, scattered(view_seed + k), within), points[k].share);
  }
  for (std::size_t k = 0; k < lit.size(); ++k)
    if (lit[k].far && !lit[k].far->is_sun())
      add(radiance_around(view, lit[k], static_cast<double>(lit.size()), truth.samples,
                          scattered(view_seed + 0x51ed2701ULL + k), progress),
          1.0 / static_cast<double>(lit.size()));
  return sum;
}

Image PointSampler::radiance_around(const TruthView& view, const Light& light, double times, int samples,
                                    std::uint64_t view_seed, const Progress& progress) const {
  const State& s = *state_;
  if (s.brushed)
    fail(s.truth.file.string(), "the simulated camera knows surroundings on a face without a grain alone",
         "leave out the material's \"brushed\", or the surroundings");
  const AroundSampler around(light.far->surroundings);
  const Light flat = [&] {
    Light out = flat_light(light);
    out.intensity *= times;
    return out;
  }();
  const Vector3d factor = times * light.intensity;
  const int w = s.truth.lens.width, h = s.truth.lens.height;
  const Vector3d camera = view.T_camera_board.inverse().translation();
  Image image(w, h, 3);
  constexpr int kRowsAtOnce = 32;  // between two calls of progress
  for (int first = 0; first < h; first += kRowsAtOnce) {
    if (progress) progress("photographing " + view.name, static_cast<double>(first) / h);
    tbb::parallel_for(first, std::min(first + kRowsAtOnce, h), [&](int y) {
      std::vector<Corner> above(w + 1), below(w + 1);
      s.fill_corners(view, flat, y, above);
      s.fill_corners(view, flat, y + 1, below);
      for (int x = 0; x < w; ++x) {
        const std::uint64_t place = static_cast<std::uint64_t>(y) * w + x;
        const Vector3d seen = s.pixel_around(above, below, x, around, factor, flat, camera, samples,
                                             scattered(view_seed + place * 0xd1b54a32d192ed03ULL));
        for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(seen[c]);
      }
    });
  }
  return image;
}

Image PointSampler::radiance_of_point(const TruthView& view, const Light& light, int samples, std::uint64_t view_seed,
                                      const Progress& progress) const {
  const State& s = *state_;
  const int w = s.truth.lens.width, h = s.truth.lens.height;
  const Vector3d camera = view.T_camera_board.inverse().translation();
  Image image(w, h, 3);
  constexpr int kBand = 8;          // rows whose corners are computed together
  constexpr int kBandsAtOnce = 16;  // between two calls of progress
  const int bands = (h + kBand - 1) / kBand;
  for (int first = 0; first < bands; first += kBandsAtOnce) {
    if (progress) progress("photographing " + view.name, static_cast<double>(first) / bands);
    tbb::parallel_for(first, std::min(first + kBandsAtOnce, bands), [&](int band) {
      const int y0 = band * kBand, y1 = std::min(y0 + kBand, h);
      std::vector<Corner> above(w + 1), below(w + 1);
      s.fill_corners(view, light, y0, above);
      for (int y = y0; y < y1; ++y) {
        s.fill_corners(view, light, y + 1, below);
        for (int x = 0; x < w; ++x) {
          const std::uint64_t place = static_cast<std::uint64_t>(y) * w + x;
          const Vector3d seen =
              s.pixel(above, below, x, light, camera, samples, scattered(view_seed + place * 0xd1b54a32d192ed03ULL));
          for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(seen[c]);
        }
        std::swap(above, below);
      }
    });
  }
  return image;
}

}  // namespace burin
