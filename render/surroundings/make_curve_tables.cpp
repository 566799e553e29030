#include "burin/render/surroundings/make_curve_tables.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "burin/base/machine_clones.h"
#include "burin/render/fast/groove_strips.h"
#include "burin/render/fast/lamp_curves.h"
#include "burin/render/fast/tile.h"
#include "burin/render/surroundings/groove_light.h"

namespace burin {
namespace {

constexpr double kStepsANode = 6.5;      // steps of the facets' table per node of a curve
constexpr double kFiner = 2.0;           // factor of the number of places, if light is linear between them
constexpr double kLinear = 0.2;          // of the roughness: largest turn of h over a tile for linear light
constexpr std::size_t kMostCorners = 3;  // times the finer places: largest number of tile corners that replace them
constexpr std::size_t kMostFloats = 32'000'000;  // limit of a table with finer places; beyond it the coarse ones stay

BURIN_MACHINE_CLONES void add_times(const float* from, float by, std::size_t n, float* to) {
  for (std::size_t k = 0; k < n; ++k) to[k] += by * from[k];
}

// Facets of a curve, at nodes and between them: tan(lean / 2), evenly spread over -half_count * step .. half_count *
// step in t. Empty for the paper's grooves, for which it equals t.
using CurveFacets = std::vector<double>;
CurveFacets curve_facets(const ViewScene& scene, SectionPart part, const SectionNodes& nodes) {
  constexpr int kEachNode = 8;
  CurveFacets out;
  for (int k = -kEachNode * nodes.half_count; k <= kEachNode * nodes.half_count; ++k)
    out.push_back(std::tan(0.5 * lean_at_node(scene.material.profile, scene.tool_width_um, part, nodes,
                                              static_cast<double>(k) / kEachNode)));
  return out;
}

// A tabulated curve of one direction at one place. The normal (-2t, 0, 1 - t^2) leans along `across` for negative t
// (docs/model.md 2.3).
void add_row(const FacetTable& facets, const CurveFacets& through, int place, int channel, double across,
             const CurveTables& table, float* to) {
  const int n = facets.t_count;
  std::vector<double> light(2 * static_cast<std::size_t>(n) - 1, 0.0);
  for (const int side : {-1, 1}) {
    const double turned = (side < 0 ? across : across + std::numbers::pi) / (2 * std::numbers::pi);
    const CubicShares a = cubic_shares((turned - std::floor(turned)) * facets.azimuths, facets.azimuths, true);
    for (int j = 0; j < 4; ++j) {
      const float* from =
          facets.at(place, (a.first + j + facets.azimuths) % facets.azimuths) + static_cast<std::size_t>(channel) * n;
      for (int k = side < 0 ? 1 : 0; k < n; ++k) light[n - 1 + side * k] += a.share[j] * from[k];
    }
  }
  LightCurve curve;
  make_curve(light, facets.t_step, curve);
  if (!through.empty()) {
    light.clear();
    for (const double t : through) light.push_back(curve.at(t).light);
    make_curve(light, 2.0 * table.half_count * table.step / static_cast<double>(through.size() - 1), curve);
  }
  const LightCurve::At middle = curve.at(0);
  for (int k = -table.half_count; k <= table.half_count; ++k, to += kCurveNode) {
    const double t = k * static_cast<double>(table.step);
    const LightCurve::At at = curve.at(t);
    to[0] = static_cast<float>(at.sum_of_sums - middle.sum_of_sums - middle.sum * t);
    to[1] = static_cast<float>(table.step * (at.sum - middle.sum));
    to[2] = static_cast<float>(0.5 * table.step * table.step * at.light);
  }
}

// Pixels at tile boundaries along a side of `pixels` pixels.
std::vector<float> tile_corners(double pixels) {
  std::vector<float> out{0};
  for (int corner = kTile; corner < pixels; corner += kTile) out.push_back(static_cast<float>(corner) - 0.5F);
  out.push_back(static_cast<float>(pixels - 1));
  return out;
}

// Resamples the curves at other places, given in steps of the table's.
void take_places(CurveTables& table, CurveFloats& curves, const std::vector<double>& columns,
                 const std::vector<double>& rows) {
  const std::size_t floats = table.place_floats(), tables = table.tables();
  const std::size_t coarse = static_cast<std::size_t>(table.columns) * table.rows, fine = columns.size() * rows.size();
  CurveFloats data(tables * fine * floats, 0.0F);
  tbb::parallel_for(std::size_t{0}, tables * fine, [&](std::size_t k) {
    const std::size_t t = k / fine;
    const CubicShares x = cubic_shares(columns[k % fine % columns.size()], table.columns, false),
                      y = cubic_shares(rows[k % fine / columns.size()], table.rows, false);
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) {
        const std::size_t from = t * coarse + static_cast<std::size_t>(y.first + j) * table.columns + x.first + i;
        add_times(&curves[from * floats], static_cast<float>(x.share[i] * y.share[j]), floats, &data[k * floats]);
      }
  });
  table.columns = static_cast<int>(columns.size());
  table.rows = static_cast<int>(rows.size());
  curves = std::move(data);
  table.cubic = false;
}

// Sets the table's numbers to those of `curves`.
void keep(const CurveFloats& curves, CurveTables& table) {
  constexpr float kMost = std::numeric_limits<std::int16_t>::max();
  const auto n = static_cast<std::size_t>(table.row_floats);
  table.unit.assign(n, 0.0F);
  for (std::size_t i = 0; i < curves.size(); i += n)
    for (std::size_t k = 0; k < n; ++k) table.unit[k] = std::max(table.unit[k], std::abs(curves[i + k]));
  std::vector<float> per(n);
  for (std::size_t k = 0; k < n; ++k) {
    per[k] = table.unit[k] > 0 ? kMost / table.unit[k] : 0;
    table.unit[k] /= kMost;
  }
  table.data.resize(curves.size());
  tbb::parallel_for(std::size_t{0}, curves.size() / n, [&](std::size_t row) {
    for (std::size_t k = 0; k < n; ++k)
      table.data[row * n + k] = static_cast<std::int16_t>(std::lround(curves[row * n + k] * per[k]));
  });
}

// Places of the tiles' corners, in the table's steps.
std::vector<double> places_of(const std::vector<float>& corners, double per_pixel) {
  std::vector<double> out;
  out.reserve(corners.size());
  for (const float corner : corners) out.push_back(corner * per_pixel);
  return out;
}

// `count` denser places, between which light is linear.
std::vector<double> finer(int coarse, int count) {
  std::vector<double> out;
  out.reserve(count);
  for (int k = 0; k < count; ++k) out.push_back(static_cast<double>(k) * (coarse - 1) / (count - 1));
  return out;
}

}  // namespace

std::vector<std::shared_ptr<const CurveTables>> make_curve_tables(const ViewScene& scene,
                                                                  const std::vector<FacetTable>& facets,
                                                                  const TableRange& range,
                                                                  const PlaceLattice& lattice) {
  const GrooveProfile& profile = scene.material.profile;
  const std::vector<double>& alphas = range.alphas;
  const double node_t = kStepsANode * facets.front().t_step;
  SectionNodes nodes;
  std::vector<CurveFacets> through;
  if (profile.is_paper()) {
    nodes.half_count = std::max(2, static_cast<int>(std::ceil(range.rim / node_t)));
    nodes.step = range.rim / nodes.half_count;
    through.emplace_back();
  } else {
    nodes = section_nodes(profile, scene.tool_width_um, range.rim, 2 * node_t);
    for (int part = 0; part < (profile.has_burrs() ? kSectionParts : 1); ++part)
      through.push_back(curve_facets(scene, static_cast<SectionPart>(part), nodes));
  }
  std::vector<std::shared_ptr<const CurveTables>> out;
  const int columns = static_cast<int>(std::ceil(kFiner * (lattice.columns - 1))) + 1,
            rows = static_cast<int>(std::ceil(kFiner * (lattice.rows - 1))) + 1;
  for (int c = 0; c < facets.front().channels; ++c) {
    auto table = std::make_shared<CurveTables>();
    table->half_count = nodes.half_count;
    table->step = static_cast<float>(nodes.step);
    table->parts = static_cast<int>(through.size());
    table->row_floats = (kCurveNode * (2 * table->half_count + 1) + 16) / 16 * 16;
    for (const FacetTable& f : facets) table->directions = std::max(table->directions, f.azimuths / 2);
    table->columns = lattice.columns;
    table->rows = lattice.rows;
    table->columns_per_pixel = 1 / lattice.column_pixels;
    table->rows_per_pixel = 1 / lattice.row_pixels;
    table->cubic = true;
    table->lean_per_pixel = lattice.lean_per_pixel / std::min(1.0, profile.across);
    for (const double alpha : alphas) table->log_alpha.push_back(static_cast<float>(std::log(alpha)));
    const std::size_t places = static_cast<std::size_t>(table->columns) * table->rows, floats = table->place_floats();
    CurveFloats curves(table->tables() * places * floats, 0.0F);
    if (!lattice.pixel.empty())
      tbb::parallel_for(std::size_t{0}, table->tables() * places, [&](std::size_t k) {
        for (int d = -1; d <= table->directions + 1; ++d)
          add_row(facets[k / places % facets.size()], through[k / places / facets.size()], static_cast<int>(k % places),
                  c, std::numbers::pi * d / table->directions, *table,
                  &curves[k * floats + static_cast<std::size_t>(d + 1) * table->row_floats]);
      });
    table->column_corners = tile_corners((lattice.columns - 1) * lattice.column_pixels + 1);
    table->row_corners = tile_corners((lattice.rows - 1) * lattice.row_pixels + 1);
    table->linear_over_tiles = kTile * table->lean_per_pixel < kLinear * alphas.front();
    const std::size_t corners = table->column_corners.size() * table->row_corners.size(),
                      fine = static_cast<std::size_t>(columns) * rows;
    const auto fits = [&](std::size_t all) { return table->tables() * all * floats <= kMostFloats; };
    if (table->linear_over_tiles && corners <= kMostCorners * fine && fits(corners)) {
      take_places(*table, curves, places_of(table->column_corners, table->columns_per_pixel),
                  places_of(table->row_corners, table->rows_per_pixel));
      table->of_tiles = true;
    } else if (fits(fine)) {
      table->columns_per_pixel *= (columns - 1.0) / (table->columns - 1);
      table->rows_per_pixel *= (rows - 1.0) / (table->rows - 1);
      take_places(*table, curves, finer(table->columns, columns), finer(table->rows, rows));
    }
    keep(curves, *table);
    out.push_back(std::move(table));
  }
  return out;
}

}  // namespace burin
