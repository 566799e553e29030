#include "burin/optimize/toolpath/height_map.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/base/limits.h"
#include "burin/base/median.h"
#include "burin/scene/physical_bounds.h"

namespace burin {
namespace {

constexpr double kLeastOutlier_mm = 0.03, kMostOutlier_mm = 0.15;  // chips and dust; a sheet's own waves are smooth
constexpr double kOnGrid_mm = 0.05;
constexpr double kZero_mm = 0.005;  // rounding error of a height of 0

std::string place_text(const Eigen::Vector2d& p) { return "X" + fixed(p.x(), 2) + " Y" + fixed(p.y(), 2); }
std::string um_text(double mm) { return fixed(1e3 * mm, 1) + " um"; }

// Terms of the smooth surface at a place of the grid, X and Y from -1 to 1 over it.
Eigen::VectorXd smooth_terms(const HeightMap& map, std::size_t i, int count) {
  const auto side = [](int place, int places) { return places < 2 ? 0.0 : 2.0 * place / (places - 1) - 1; };
  const double X = side(static_cast<int>(i) % map.columns, map.columns);
  const double Y = side(static_cast<int>(i) / map.columns, map.rows);
  Eigen::VectorXd terms(6);
  terms << 1, X, Y, X * X, X * Y, Y * Y;
  return terms.head(count);
}

Json rows_of(const HeightMap& map) {
  Json rows = Json::array();
  for (int r = 0; r < map.rows; ++r) {
    Json row = Json::array();
    for (int c = 0; c < map.columns; ++c) {
      const std::size_t i = static_cast<std::size_t>(r) * map.columns + c;
      // To a tenth of a micrometer: no controller is finer.
      row.push_back(map.probed[i] ? Json(std::round(map.z_mm[i] * 1e4) / 1e4) : Json(nullptr));
    }
    rows.push_back(row);
  }
  return rows;
}

void read_rows(JsonObject& json, HeightMap& map) {
  const Json& rows = json.raw("z_mm");
  const char* remedy =
      "write a row for each y, lowest first, each with a number (or null, where none was probed) for each x";
  if (!rows.is_array() || rows.size() < 2 || !rows[0].is_array() || rows[0].size() < 2)
    json.fail_field("z_mm", "is no grid of at least two rows and columns", remedy);
  map.rows = static_cast<int>(rows.size());
  map.columns = static_cast<int>(rows[0].size());
  for (const Json& row : rows) {
    if (!row.is_array() || row.size() != rows[0].size()) json.fail_field("z_mm", "has rows of several lengths", remedy);
    for (const Json& z : row) {
      const bool probed = z.is_number() && std::isfinite(z.get<double>());
      if (!probed && !z.is_null()) json.fail_field("z_mm", "has " + z.dump() + " for a height", remedy);
      map.z_mm.push_back(probed ? z.get<double>() : 0);
      map.probed.push_back(probed);
    }
  }
  require_at_most(map.z_mm.size(), limit::kHeights, json.where() + ": z_mm", "heights",
                  "probe at a greater distance: a sheet bends slowly");
  if (std::count(map.probed.begin(), map.probed.end(), true) < 4)
    json.fail_field("z_mm", "has fewer than four heights", "probe the face again (burin probe)");
}

}  // namespace

double height_mm(const HeightMap& map, const Eigen::Vector2d& p_mm) {
  const Eigen::Vector2d g = (p_mm - map.first_mm).cwiseQuotient(map.step_mm);
  const auto cell = [](double at, int points) {
    return std::clamp(static_cast<int>(std::floor(at)), 0, std::max(0, points - 2));
  };
  const int c = cell(g.x(), map.columns), r = cell(g.y(), map.rows);
  const double fx = g.x() - c, fy = g.y() - r;
  const auto z = [&](int column, int row) { return map.z_mm[static_cast<std::size_t>(row) * map.columns + column]; };
  return (1 - fy) * ((1 - fx) * z(c, r) + fx * z(c + 1, r)) + fy * ((1 - fx) * z(c, r + 1) + fx * z(c + 1, r + 1));
}

double beyond_mm(const HeightMap& map, const Eigen::Vector2d& p_mm) {
  const Eigen::Vector2d last = map.at(map.z_mm.size() - 1);
  const Eigen::Vector2d nearest = p_mm.cwiseMax(map.first_mm).cwiseMin(last);
  return (p_mm - nearest).norm();
}

double range_mm(const HeightMap& map) {
  double low = INFINITY, high = -INFINITY;
  for (std::size_t i = 0; i < map.z_mm.size(); ++i) {
    if (!map.probed[i]) continue;
    low = std::min(low, map.z_mm[i]);
    high = std::max(high, map.z_mm[i]);
  }
  return high > low ? high - low : 0;
}

std::vector<double> smooth_heights(const HeightMap& map) {
  const auto probed = std::count(map.probed.begin(), map.probed.end(), true);
  // A curved surface needs three points along each side, and some more.
  const int terms = map.columns >= 3 && map.rows >= 3 && probed >= 8 ? 6 : 3;
  Eigen::MatrixXd A(probed, terms);
  Eigen::VectorXd b(probed);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < map.z_mm.size(); ++i) {
    if (!map.probed[i]) continue;
    A.row(row) = smooth_terms(map, i, terms).transpose();
    b[row++] = map.z_mm[i];
  }
  const Eigen::VectorXd x = A.completeOrthogonalDecomposition().solve(b);
  std::vector<double> smooth(map.z_mm.size());
  for (std::size_t i = 0; i < smooth.size(); ++i) smooth[i] = smooth_terms(map, i, terms).dot(x);
  return smooth;
}

void fill_in(HeightMap& map) {
  const std::vector<double> smooth = smooth_heights(map);
  for (std::size_t i = 0; i < map.z_mm.size(); ++i) {
    if (map.probed[i]) continue;
    double weights = 0, left = 0;
    for (std::size_t k = 0; k < map.z_mm.size(); ++k) {
      if (!map.probed[k]) continue;
      const double square = (map.at(k) - map.at(i)).squaredNorm(), weight = 1 / (square * square);
      weights += weight;
      left += weight * (map.z_mm[k] - smooth[k]);
    }
    map.z_mm[i] = smooth[i] + left / weights;
  }
}

void fail_unless_plausible(const HeightMap& map, const std::string& name) {
  const std::vector<double> smooth = smooth_heights(map);
  const std::size_t last_column = map.columns - 1, last_row = map.z_mm.size() - map.columns;
  const Eigen::Vector2d size = map.at(map.z_mm.size() - 1) - map.first_mm;
  const Eigen::Vector2d tilt((smooth[last_column] - smooth[0] + smooth.back() - smooth[last_row]) / (2 * size.x()),
                             (smooth[last_row] - smooth[0] + smooth.back() - smooth[last_column]) / (2 * size.y()));
  if (!(tilt.norm() <= bound::kTilt))
    fail(name,
         "the face tilts by " + significant(100 * tilt.norm(), 3) + " mm in 100 mm, more than a clamped sheet does (" +
             shortest(100 * bound::kTilt) + " mm)",
         "clamp the sheet flat on the table and probe again");
  std::vector<double> left;
  for (std::size_t i = 0; i < map.z_mm.size(); ++i)
    if (map.probed[i]) left.push_back(std::abs(map.z_mm[i] - smooth[i]));
  const double limit_mm = std::clamp(8 * 1.4826 * median_of(left), kLeastOutlier_mm, kMostOutlier_mm);
  for (std::size_t i = 0; i < map.z_mm.size(); ++i)
    if (map.probed[i] && !(std::abs(map.z_mm[i] - smooth[i]) <= limit_mm))
      fail(name,
           "the point at " + place_text(map.at(i)) + " lies " + um_text(std::abs(map.z_mm[i] - smooth[i])) +
               (map.z_mm[i] > smooth[i] ? " above" : " below") + " the smooth face round it (more than " +
               um_text(limit_mm) + ")",
           "look for a chip or dust there, clean the sheet and the tool, and probe again");
  // A step between neighbors shows two sheets or a slipped contact. The plane's part is subtracted first.
  for (std::size_t i = 0; i < map.z_mm.size(); ++i)
    for (const std::size_t next : {i + 1, i + map.columns}) {
      const bool along = next == i + 1;
      if (next >= map.z_mm.size() || (along && next % map.columns == 0) || !map.probed[i] || !map.probed[next])
        continue;
      const double way_mm = along ? map.step_mm.x() : map.step_mm.y();
      const double step_mm = std::abs(map.z_mm[next] - map.z_mm[i] - way_mm * (along ? tilt.x() : tilt.y()));
      if (step_mm > bound::kTilt * way_mm + kLeastOutlier_mm)
        fail(name,
             "the face steps by " + um_text(step_mm) + " between " + place_text(map.at(i)) + " and " +
                 place_text(map.at(next)) + ", more than a sheet does",
             "look for a chip, dust or a second sheet there, and probe again");
    }
}

HeightMap read_heights(const std::filesystem::path& file) {
  const Json content = read_json(file, "burin/heights", 1);
  JsonObject json(content, file.string());
  HeightMap map;
  map.zero_mm = json.vec2("zero_mm");
  map.first_mm = json.vec2("first_mm");
  map.step_mm = json.vec2("step_mm");
  if (!(map.step_mm.array() > 0).all())
    json.fail_field("step_mm", "is " + to_json(map.step_mm).dump(), "write the distances between columns and rows, mm");
  map.drift_mm = 1e-3 * json.number("drift_um", 0);
  if (json.has("log")) map.log = resolve_path(file, json.text("log"));
  read_rows(json, map);
  json.finish();
  fill_in(map);
  fail_unless_plausible(map, file.string());
  if (!(beyond_mm(map, map.zero_mm) <= kOnGrid_mm))
    json.fail_field("zero_mm", "is " + to_json(map.zero_mm).dump() + ", beyond the grid",
                    "write the place where Z zero was set, in machine coordinates");
  if (!(std::abs(height_mm(map, map.zero_mm)) <= kZero_mm))
    json.fail_field("z_mm", "has the face at zero_mm at " + fixed(height_mm(map, map.zero_mm), 4) + " mm, and not at 0",
                    "count heights from the place where Z zero was set, or probe again (burin probe)");
  return map;
}

void write_heights(const HeightMap& map, const std::filesystem::path& file) {
  Json json;
  json["format"] = "burin/heights";
  json["version"] = 1;
  json["zero_mm"] = to_json(map.zero_mm);
  json["first_mm"] = to_json(map.first_mm);
  json["step_mm"] = to_json(map.step_mm);
  json["z_mm"] = rows_of(map);
  json["drift_um"] = std::round(map.drift_mm * 1e4) / 10;
  if (!map.log.empty()) json["log"] = path_beside(file, map.log);
  write_json(json, file);
}

}  // namespace burin
