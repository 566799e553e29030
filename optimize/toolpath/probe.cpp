#include "burin/optimize/toolpath/probe.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/table.h"
#include "burin/optimize/toolpath/carving_limits.h"
#include "burin/optimize/toolpath/gcode_line.h"
#include "burin/scene/keep_out.h"

namespace burin {
namespace {

constexpr double kSearch_mm = 2;        // depth of the search for the face below zero
constexpr double kStop_mm = 5e-4;       // stopping distance
constexpr double kTravel_mm = 2;        // above the first point, at least: the sheet may tilt
constexpr double kClear_mm = 1.5;       // of tags and keep-outs
constexpr double kSamePlace_mm = 0.05;  // between a probed point and its planned place
constexpr double kDrift_mm = 0.005, kMostDrift_mm = 0.025;

struct Point {
  Eigen::Vector3d p;
  std::size_t line = 0;  ///< of the log
  bool touched = true;
};

std::string word_of_place(const Eigen::Vector2d& p) { return "X" + fixed(p.x(), 2) + " Y" + fixed(p.y(), 2); }
std::string um(double mm) { return fixed(1e3 * mm, 1) + " um"; }

// Calls `take(line, number)` for each line, numbers from 1.
template <typename Take>
void each_line(std::string_view text, const Take& take) {
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    take(line, number);
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
}

// Numbers between separators; nothing if any part is none.
std::optional<std::vector<double>> numbers_in(std::string_view text, std::string_view separators) {
  std::vector<double> out;
  while (!text.empty()) {
    const std::size_t begin = text.find_first_not_of(separators);
    if (begin == std::string_view::npos) break;
    text.remove_prefix(begin);
    const std::size_t end = text.find_first_of(separators);
    const std::optional<double> value = number_in(text.substr(0, end));
    if (!value) return std::nullopt;
    out.push_back(*value);
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end);
  }
  return out;
}

// grbl's answers: [PRB:-123.450,-80.120,-15.332:1]. Empty if the log holds none.
std::vector<Point> grbl_points(std::string_view log, const std::string& name) {
  std::vector<Point> points;
  each_line(log, [&](std::string_view line, std::size_t number) {
    const std::size_t at = line.find("[PRB:");
    if (at == std::string_view::npos) return;
    const std::size_t close = line.find(']', at);
    const std::string_view inside =
        close == std::string_view::npos ? std::string_view{} : line.substr(at + 5, close - at - 5);
    const auto values = numbers_in(inside, ",:");
    if (!values || values->size() < 4)
      fail(name + ":" + std::to_string(number), "has a broken answer \"" + std::string(line.substr(at)) + "\"",
           "save the whole serial log again, or probe again");
    points.push_back({{(*values)[0], (*values)[1], (*values)[2]}, number, values->back() != 0});
  });
  return points;
}

// Output of PROBEOPEN: X Y Z and six further axes per line.
std::vector<Point> linuxcnc_points(std::string_view log, const std::string& name) {
  std::vector<Point> points;
  each_line(log, [&](std::string_view line, std::size_t number) {
    if (line.empty()) return;
    const auto values = numbers_in(line, " \t,");
    if (!values || values->size() < 3)
      fail(name + ":" + std::to_string(number),
           "is neither an answer of grbl ([PRB:x,y,z:1]) nor a line that LinuxCNC's PROBEOPEN writes (x y z ...)",
           "give the log that was kept while the probing file ran");
    points.push_back({{(*values)[0], (*values)[1], (*values)[2]}, number, true});
  });
  return points;
}

// Places where the probing file touches the face. `logged`: only those in LinuxCNC's log.
std::vector<Eigen::Vector2d> probed_places(std::string_view gcode, const std::string& name, bool logged) {
  std::vector<Eigen::Vector2d> places;
  Eigen::Vector2d at(NAN, NAN);
  bool log_open = !logged;
  each_line(gcode, [&](std::string_view line, std::size_t) {
    if (line.find("PROBEOPEN") != std::string_view::npos) log_open = true;
    const std::size_t x = line.find('X'), y = line.find('Y');
    if (line.starts_with("G0 ") && x != std::string_view::npos && y != std::string_view::npos && y > x) {
      const auto xy =
          numbers_in(std::string(line.substr(x + 1, y - x - 1)) + " " + std::string(line.substr(y + 1)), " ");
      if (xy && xy->size() == 2) at = {(*xy)[0], (*xy)[1]};
    }
    if (line.starts_with("G38.2") && log_open) places.push_back(at);
  });
  if (places.size() < 6 || !places.front().allFinite())
    fail(name, "is no probing file of Burin's", "give the file that the machine ran (burin probe write)");
  return places;
}

// The last `places.size()` points of the log, in work coordinates up to a constant, which is subtracted from x and y.
std::vector<Point> last_run(const std::vector<Point>& all, const std::vector<Eigen::Vector2d>& places,
                            const std::string& name) {
  for (const Point& p : all)
    if (!p.touched && all.size() - static_cast<std::size_t>(&p - all.data()) <= places.size())
      fail(name + ":" + std::to_string(p.line), "a probing found no contact (\":0\")",
           "check the probe's wire and that the face lies within " + shortest(kSearch_mm) + " mm; then probe again");
  if (all.size() < places.size())
    fail(name, "holds " + std::to_string(all.size()) + " probed points of " + std::to_string(places.size()),
         "let the probing file run to its end, and save the whole log");
  std::vector<Point> run(all.end() - static_cast<std::ptrdiff_t>(places.size()), all.end());
  const Eigen::Vector2d offset = run.front().p.head<2>() - places.front();
  double span = 0, logged_span = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    span = std::max(span, (places[i] - places.front()).norm());
    logged_span = std::max(logged_span, (run[i].p - run.front().p).head<2>().norm());
  }
  if (std::abs(25.4 * logged_span - span) < 0.01 * span)
    fail(name, "is in inches", "set the controller to report mm (grbl: $13=0), and probe again");
  for (std::size_t i = 0; i < run.size(); ++i) {
    const Eigen::Vector2d xy = run[i].p.head<2>() - offset;
    if ((xy - places[i]).norm() > kSamePlace_mm)
      fail(name + ":" + std::to_string(run[i].line),
           "was probed at " + word_of_place(xy) + ", where the probing file goes to " + word_of_place(places[i]),
           "give the log and the probing file of one and the same run");
    run[i].p.head<2>() = places[i];
  }
  return run;
}

// The distinct values among coordinates, ascending, one for each column or row.
std::vector<double> lines_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::vector<double> out;
  for (const double v : values)
    if (out.empty() || v - out.back() > kSamePlace_mm) out.push_back(v);
  return out;
}

// The grid's points. `run` excludes touches before zero was set; its last point repeats the first.
HeightMap map_of(const std::vector<Point>& run, const std::string& name) {
  std::vector<double> x, y;
  for (const Point& p : run) x.push_back(p.p.x()), y.push_back(p.p.y());
  const std::vector<double> columns = lines_of(x), rows = lines_of(y);
  if (columns.size() < 2 || rows.size() < 2)
    fail(name, "has its points in one line", "probe the whole carve area (burin probe write)");
  HeightMap map;
  map.columns = static_cast<int>(columns.size());
  map.rows = static_cast<int>(rows.size());
  map.first_mm = {columns.front(), rows.front()};
  map.step_mm = {(columns.back() - columns.front()) / (map.columns - 1), (rows.back() - rows.front()) / (map.rows - 1)};
  map.z_mm.assign(columns.size() * rows.size(), 0);
  map.probed.assign(map.z_mm.size(), false);
  map.zero_mm = run.front().p.head<2>();
  const double zero = run.front().p.z();
  map.drift_mm = run.back().p.z() - zero;
  for (std::size_t i = 0; i + 1 < run.size(); ++i) {
    const Eigen::Vector2d g = (run[i].p.head<2>() - map.first_mm).cwiseQuotient(map.step_mm);
    const auto c = std::lround(g.x()), r = std::lround(g.y());
    const auto at = static_cast<std::size_t>(r * map.columns + c);
    if ((map.at(at) - run[i].p.head<2>()).norm() > kSamePlace_mm)
      fail(name, "has points that lie on no regular grid", "give the file that burin probe write made, unchanged");
    map.z_mm[at] = run[i].p.z() - zero;
    map.probed[at] = true;
  }
  return map;
}

}  // namespace

ProbePlan probe_plan(const Board& board, double spacing_mm) {
  const Eigen::Vector2d size = board.carve_max_mm - board.carve_min_mm;
  if (!(spacing_mm > 0)) fail("probe", "a spacing of " + shortest(spacing_mm) + " mm", "give a distance in mm above 0");
  constexpr double kMostPoints = 10000;
  const auto count = [&](double side) { return std::max(3.0, std::round(side / spacing_mm) + 1); };
  if (!(count(size.x()) * count(size.y()) <= kMostPoints))
    fail("probe",
         "a spacing of " + shortest(spacing_mm) + " mm makes " + coarse(count(size.x()) * count(size.y())) + " points",
         "probe at a greater distance, for at most " + shortest(kMostPoints) + "; a sheet bends slowly");
  const auto columns = static_cast<long>(count(size.x())), rows = static_cast<long>(count(size.y()));
  const CarvingLimits limits = carving_limits(board, {}, board.material.depth_um, CarvingLimits().affine);
  ProbePlan plan;
  plan.workpiece = workpiece_of(board, nullptr);
  for (long r = 0; r < rows; ++r)
    for (long k = 0; k < columns; ++k) {
      const long c = r % 2 == 0 ? k : columns - 1 - k;
      const Eigen::Vector2d f(static_cast<double>(c) / static_cast<double>(columns - 1),
                              static_cast<double>(r) / static_cast<double>(rows - 1));
      const Eigen::Vector2d p = board.carve_min_mm + f.cwiseProduct(size);
      if (std::all_of(limits.keep_out.begin(), limits.keep_out.end(),
                      [&](const KeepOut& place) { return distance_mm(p, place) > kClear_mm; }))
        plan.points_mm.push_back(p);
    }
  if (plan.points_mm.size() < 4)
    fail("probe",
         "only " + std::to_string(plan.points_mm.size()) + " points of the grid are clear of tags and keep-outs",
         "give a smaller --spacing");
  plan.points_mm.push_back(plan.points_mm.front());
  return plan;
}

std::string probe_gcode(const ProbePlan& plan, const MachineProfile& machine) {
  if (machine.dialect == GcodeDialect::marlin)
    fail("machine \"" + machine.name + "\"", "has heights to 0.01 mm only, about a groove's depth",
         "use a spring-loaded tool or a drag bit (\"depth_by\": \"spring\"), which need no height map");
  if (machine.depth_by == DepthBy::servo)
    fail("machine \"" + machine.name + "\"", "presses by a servo, whose depth does not come from Z",
         "leave the height map away");
  const auto z = [&](double mm) { return fixed(mm, machine.decimals); };
  const auto go = [&](const Eigen::Vector2d& p) {
    return "G0 X" + fixed(p.x(), machine.decimals) + " Y" + fixed(p.y(), machine.decimals) + "\n";
  };
  const double feed = 60 * std::sqrt(2 * machine.acceleration_z_mm_s2 * kStop_mm);
  const std::string slow = " F" + fixed(std::clamp(std::floor(feed), 1.0, kTouchFeed_mm_min), 0) + "\n";
  const std::string touch = "G38.2 Z" + z(-kSearch_mm) + slow;
  const double lift_mm = std::max(machine.safe_z_mm, kTravel_mm);
  const double first_mm = std::max(first_z_mm(plan.workpiece, {}, machine), lift_mm);
  const auto lift = [&](double mm) { return "G0 Z" + z(mm) + "\n"; };

  std::string text;
  for (const std::string& comment :
       {"Burin probing for " + comment_word(machine.name) + ", mm",
        std::to_string(plan.points_mm.size() - 1) + " points of the face",
        std::string("tool and sheet close the contact of the probe, try it by hand"),
        std::string("before: work zero at the lower left corner, Z zero by eye"),
        "first way along X and Y: " + fixed(first_mm, 1) + " mm above zero, over sheet and clamps",
        std::string("this file sets Z zero at the first point, leave it so")})
    text += comment_lines(machine, comment);
  if (machine.laser) text += "M5 S0\n";
  text += "G21 G90 G17 G94 G54\n" + lift(first_mm) + go(plan.points_mm.front());
  // A fast touch finds the face, then a slow one measures its height.
  text += "G38.2 Z" + z(-kSearch_mm) + " F" + fixed(kTouchFeed_mm_min, 0) + "\nG10 L20 P1 Z0\nG0 Z" + z(0.3) + "\n" +
          touch + "G10 L20 P1 Z0\n" + lift(lift_mm);
  const bool logs = machine.dialect == GcodeDialect::linuxcnc;
  if (logs) text += "(PROBEOPEN burin-probe.txt)\n";
  for (std::size_t k = 0; k < plan.points_mm.size(); ++k) {
    const Eigen::Vector2d& p = plan.points_mm[k];
    const bool last = k + 1 == plan.points_mm.size();
    const double next_mm = last ? first_mm : travel_z_mm(plan.workpiece, {}, machine, p, plan.points_mm[k + 1]);
    text.append(go(p)).append(touch).append(lift(std::max(lift_mm, next_mm)));
  }
  if (logs) text += "(PROBECLOSE)\n";
  if (machine.laser) text += "M5 S0\n";
  return text + "M2\n";
}

ProbedHeights read_probe_log(std::string_view log, const std::filesystem::path& log_file, std::string_view gcode,
                             const std::filesystem::path& probe_file) {
  const std::string name = log_file.string();
  const bool grbl = log.find("[PRB:") != std::string_view::npos;
  const std::vector<Point> all = grbl ? grbl_points(log, name) : linuxcnc_points(log, name);
  if (all.empty()) fail(name, "holds no probed point", "give the log that was kept while the probing file ran");
  std::vector<Point> run = last_run(all, probed_places(gcode, probe_file.string(), !grbl), name);
  // Touches before zero was set: twice the first point.
  if (grbl) run.erase(run.begin(), run.begin() + 2);
  ProbedHeights out;
  out.map = map_of(run, name);
  out.map.log = log_file;
  fail_unless_plausible(out.map, name);
  const double drift = std::abs(out.map.drift_mm);
  if (drift > kMostDrift_mm)
    fail(name, "the first point lies " + um(drift) + " elsewhere at the end than at the beginning",
         "check that sheet, tool and probe hold still and that no step is lost; then probe again");
  if (drift > kDrift_mm)
    out.findings.push_back({FindingCode::probe_drift, Finding::Severity::warning, log_file,
                            "the first point lies " + um(drift) + " elsewhere at the end than at the beginning",
                            "depths are no better known than that"});
  fill_in(out.map);
  return out;
}

}  // namespace burin
