#include "burin/render/surroundings/make_curve_tables.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burin/render/fast/machine_clones.h"
#include "burin/render/surroundings/groove_light.h"

namespace burin {
namespace {

constexpr double kStepsANode = 5;                // steps of the facets' table: from a node of a curve to the next
constexpr double kFiner = 2.0;                   // times as many places, where light between them is taken as straight
constexpr std::size_t kMostFloats = 32'000'000;  // of a table with the finer places: else the coarse ones are kept

BURIN_MACHINE_CLONES void add_times(const float* from, float by, std::size_t n, float* to) {
  for (std::size_t k = 0; k < n; ++k) to[k] += by * from[k];
}

// A curve of one direction at one place, as it is tabulated. The normal (-2t, 0, 1 - t^2) leans along `across` where t
// is negative (docs/model.md 2.3).
void add_row(const FacetTable& facets, int place, int channel, double across, const CurveTables& table, float* to) {
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
  const LightCurve::At middle = curve.at(0);
  for (int k = -table.half_count; k <= table.half_count; ++k, to += kCurveNode) {
    const double t = k * static_cast<double>(table.step);
    const LightCurve::At at = curve.at(t);
    to[0] = static_cast<float>(at.sum_of_sums - middle.sum_of_sums - middle.sum * t);
    to[1] = static_cast<float>(table.step * (at.sum - middle.sum));
    to[2] = static_cast<float>(0.5 * table.step * table.step * at.light);
  }
}

// The same table with places closer together.
void refine_places(CurveTables& table, int columns, int rows) {
  const std::size_t floats = table.place_floats(), tables = table.log_alpha.size();
  const std::size_t coarse = static_cast<std::size_t>(table.columns) * table.rows,
                    fine = static_cast<std::size_t>(columns) * rows;
  CurveFloats data(tables * fine * floats, 0.0F);
  tbb::parallel_for(std::size_t{0}, tables * fine, [&](std::size_t k) {
    const std::size_t t = k / fine, row = k % fine / columns, column = k % columns;
    const CubicShares x = cubic_shares(static_cast<double>(column) * (table.columns - 1) / (columns - 1), table.columns,
                                       false),
                      y = cubic_shares(static_cast<double>(row) * (table.rows - 1) / (rows - 1), table.rows, false);
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) {
        const std::size_t from = t * coarse + static_cast<std::size_t>(y.first + j) * table.columns + x.first + i;
        add_times(&table.data[from * floats], static_cast<float>(x.share[i] * y.share[j]), floats, &data[k * floats]);
      }
  });
  table.columns_per_pixel *= (columns - 1.0) / (table.columns - 1);
  table.rows_per_pixel *= (rows - 1.0) / (table.rows - 1);
  table.columns = columns;
  table.rows = rows;
  table.data = std::move(data);
}

}  // namespace

std::vector<std::shared_ptr<const CurveTables>> make_curve_tables(const std::vector<FacetTable>& facets,
                                                                  const std::vector<double>& alphas, double steepest_t,
                                                                  const PlaceLattice& lattice) {
  std::vector<std::shared_ptr<const CurveTables>> out;
  const int columns = static_cast<int>(std::ceil(kFiner * (lattice.columns - 1))) + 1,
            rows = static_cast<int>(std::ceil(kFiner * (lattice.rows - 1))) + 1;
  for (int c = 0; c < facets.front().channels; ++c) {
    auto table = std::make_shared<CurveTables>();
    table->half_count = std::max(2, static_cast<int>(std::ceil(steepest_t / (kStepsANode * facets.front().t_step))));
    table->step = static_cast<float>(steepest_t / table->half_count);
    table->row_floats = (kCurveNode * (2 * table->half_count + 1) + 16) / 16 * 16;
    for (const FacetTable& f : facets) table->directions = std::max(table->directions, f.azimuths / 2);
    table->columns = lattice.columns;
    table->rows = lattice.rows;
    table->columns_per_pixel = 1 / lattice.column_pixels;
    table->rows_per_pixel = 1 / lattice.row_pixels;
    table->cubic = true;
    table->lean_per_pixel = lattice.lean_per_pixel;
    for (const double alpha : alphas) table->log_alpha.push_back(static_cast<float>(std::log(alpha)));
    const std::size_t places = static_cast<std::size_t>(table->columns) * table->rows, floats = table->place_floats();
    table->data.assign(facets.size() * places * floats, 0.0F);
    if (!lattice.pixel.empty())
      tbb::parallel_for(std::size_t{0}, facets.size() * places, [&](std::size_t k) {
        for (int d = -1; d <= table->directions + 1; ++d)
          add_row(facets[k / places], static_cast<int>(k % places), c, std::numbers::pi * d / table->directions, *table,
                  &table->data[k * floats + static_cast<std::size_t>(d + 1) * table->row_floats]);
      });
    if (facets.size() * columns * rows * floats <= kMostFloats) {
      refine_places(*table, columns, rows);
      table->cubic = false;
    }
    out.push_back(std::move(table));
  }
  return out;
}

}  // namespace burin
