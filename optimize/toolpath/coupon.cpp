#include "burin/optimize/toolpath/coupon.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/optimize/toolpath/label.h"
#include "burin/scene/groove.h"
#include "burin/scene/keep_out.h"
#include "burin/scene/physical_bounds.h"

namespace burin {
namespace {

using Eigen::Vector2d;

constexpr double kSize_mm = 60, kTag_mm = 5, kTagCenter_mm = 5, kCarve_mm = 10;  // paper reaches to 9.5 mm
constexpr double kSpacing_mm = 0.27, kCloser_mm = 0.2;
constexpr double kDeeper = 1.3;          // grooves may be deeper than the prior by this factor without contact
constexpr double kBeyondTable = 2;       // times the table's last preload
constexpr int kMostAcross = 6;           // fans in a row
constexpr double kFanGap_mm = 0.25;      // between fans
constexpr double kShortestSpoke_mm = 1;  // shorter ones hardly show in a photo
constexpr double kFewestSpokes = 24, kMostSpokes = 180;

const char* const kWhere = "coupon";

// Prior depth of a command, um: by the table, extrapolated beyond its rows.
double believed_depth_um(const MachineProfile& machine, double command) {
  if (machine.depth_by == DepthBy::fixed_z) return 1e3 * command;
  const std::vector<DepthStep>& rows = machine.depth_table.rows;
  const auto line = [&](const DepthStep& a, const DepthStep& b) {
    return a.depth_um + (b.depth_um - a.depth_um) * (command - a.command) / (b.command - a.command);
  };
  const double inside = depth_for_command(machine.depth_table, command, by_preload(machine.depth_by));
  if (std::isfinite(inside)) return inside;
  const bool rising = rows.back().command > rows.front().command;
  const bool harder = rising ? command > rows.back().command : command < rows.back().command;
  return harder ? line(rows[rows.size() - 2], rows.back()) : line(rows[0], rows[1]);
}

void check_rising(const std::vector<double>& values, const std::string& name, bool falling = false) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || values[i] < 0 || (values[i] == 0 && !falling))
      fail(kWhere, "has " + name + " of " + significant(values[i], 4), "give numbers above 0");
    if (i > 0 && (falling ? values[i] >= values[i - 1] : values[i] <= values[i - 1]))
      fail(kWhere, "has " + name + " out of order, at " + significant(values[i], 4),
           "give each once, the one that carves least first");
  }
}

bool falls(const MachineProfile& machine) {
  const std::vector<DepthStep>& rows = machine.depth_table.rows;
  return machine.depth_by == DepthBy::servo && rows.back().command < rows.front().command;
}

// The ladder: as given, or five steps over the range of the machine's table (or about the prior depth).
std::vector<double> commands_of(const MachineProfile& machine, const CouponOptions& options) {
  const bool fixed = machine.depth_by == DepthBy::fixed_z;
  if (!options.commands.empty() && fixed)
    fail(kWhere, "is to try preloads on " + machine.name + ", which goes to a fixed Z",
         "give --depths in um, or a machine that presses (\"depth_by\": spring, drag or servo)");
  if (!options.commands.empty() && !options.depths_um.empty())
    fail(kWhere, "is to try both preloads and depths", "give one of them");
  std::vector<double> commands = options.commands;
  check_rising(options.depths_um, "depths");
  if (!options.depths_um.empty() && options.depths_um.back() > bound::kDepth_um)
    fail(kWhere, "has a depth of " + significant(options.depths_um.back(), 4) + " um, deeper than any tip cuts",
         "write micrometers, at most " + shortest(bound::kDepth_um));
  for (const double depth_um : options.depths_um)
    commands.push_back(
        fixed ? 1e-3 * depth_um
              : command_for_depth(machine.depth_table, depth_um, "machine profile \"" + machine.name + "\""));
  if (commands.empty() && fixed)
    for (const double factor : {0.4, 0.7, 1.0, 1.4, 1.9}) commands.push_back(1e-3 * factor * options.material.depth_um);
  if (commands.empty()) {
    const double first = machine.depth_table.rows.front().command, last = machine.depth_table.rows.back().command;
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) commands.push_back(first + share * (last - first));
  }
  check_rising(commands, fixed ? "depths" : "commands", falls(machine));
  if (by_preload(machine.depth_by)) {
    // The coupon measures depths beyond the table; far beyond it is the spring's stop.
    const double hardest_mm = std::min(kBeyondTable * machine.depth_table.rows.back().command, bound::kPreload_mm);
    if (commands.back() > hardest_mm)
      fail(kWhere,
           "has a preload of " + significant(commands.back(), 4) + " mm, and the table of " + machine.name +
               " ends at " + significant(machine.depth_table.rows.back().command, 4) + " mm",
           "try " + significant(hardest_mm, 3) + " mm at most, and more once the machine's table holds that");
  }
  for (const double command : commands)
    if (!(believed_depth_um(machine, command) > 0.05))
      fail(kWhere,
           "has a command of " + significant(command, 4) + ", which makes no groove by the table of " + machine.name,
           "leave it out");
  return commands;
}

// The machine with its table extended to all commands of the ladder.
MachineProfile with_commands(MachineProfile machine, const std::vector<double>& commands) {
  if (machine.depth_by == DepthBy::fixed_z) return machine;
  const MachineProfile known = machine;
  std::vector<DepthStep>& rows = machine.depth_table.rows;
  for (const double command : commands) {
    const double depth_um = believed_depth_um(known, command);
    if (std::none_of(rows.begin(), rows.end(), [&](const DepthStep& row) {
          return row.command == command || std::abs(row.depth_um - depth_um) < 1e-9;
        }))
      rows.push_back({depth_um, command});
  }
  std::sort(rows.begin(), rows.end(), [](const DepthStep& a, const DepthStep& b) { return a.depth_um < b.depth_um; });
  return machine;
}

// Mean speed along a scratch.
double reached_mm_min(const MachineProfile& machine, double length_mm, double feed_mm_min) {
  return 60 * length_mm / move_time_s(length_mm, feed_mm_min, machine.acceleration_mm_s2);
}

// A fan's spokes, all of one spacing.
struct Spokes {
  double inner_mm = 0, outer_mm = 0;
  std::size_t count = 0;
};

// The inner ends are `clear_mm` apart.
Spokes spokes_of(double outer_mm, double spacing_mm, double clear_mm) {
  Spokes spokes{0.3 * outer_mm, outer_mm, 0};
  for (int pass = 0; pass < 20; ++pass) {
    const double middle_mm = 0.5 * (spokes.inner_mm + outer_mm);
    const double count = std::clamp(2 * std::numbers::pi * middle_mm / spacing_mm, kFewestSpokes, kMostSpokes);
    spokes.count = 2 * static_cast<std::size_t>(std::lround(count / 2));
    const double needed_mm = clear_mm / (2 * std::sin(std::numbers::pi / static_cast<double>(spokes.count)));
    if (needed_mm <= spokes.inner_mm) break;
    spokes.inner_mm = needed_mm;
  }
  return spokes;
}

std::vector<CouponCell> cells_of(const MachineProfile& machine, const CouponOptions& options,
                                 const std::vector<double>& commands) {
  std::vector<double> feeds = options.feeds_mm_min;
  const double usual = machine.carve_feed_mm_min;
  if (feeds.empty()) feeds = {0.25 * usual, 0.5 * usual};
  std::sort(feeds.begin(), feeds.end());
  check_rising(feeds, "speeds");
  std::erase(feeds, usual);
  feeds.insert(feeds.begin(), usual);
  std::vector<double> spacings = options.spacings_mm;
  if (spacings.empty()) spacings = {kSpacing_mm, kCloser_mm};
  for (const double spacing : spacings)
    if (!(spacing > 0.02 && spacing < 2))
      fail(kWhere, "has a spacing of " + significant(spacing, 4) + " mm", "give 0.02 to 2 mm");
  std::vector<CouponCell> cells;
  for (const double feed : feeds)
    for (const double command : commands)
      cells.push_back({command, believed_depth_um(machine, command), feed, 0, spacings.front()});
  for (std::size_t i = 1; i < spacings.size(); ++i) {
    CouponCell cell = cells[commands.size() / 2];
    cell.spacing_mm = spacings[i];
    cells.push_back(cell);
  }
  return cells;
}

void shuffle(std::vector<std::size_t>& list, std::mt19937_64& random) {
  for (std::size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[random() % i]);
}

// The cell of each fan, in carving order. Cells at the usual speed come early and their repeats late, so the difference
// shows wear. All others come between, where wear matters least. Each of the three groups is shuffled. The middle
// command comes first and last.
std::vector<std::size_t> order_of(std::size_t cells, std::size_t usual, std::size_t fans, std::mt19937_64& random) {
  const std::size_t middle = usual / 2;
  std::vector<std::size_t> early(usual), between(cells - usual), late;
  std::iota(early.begin(), early.end(), std::size_t{0});
  std::iota(between.begin(), between.end(), usual);
  for (std::size_t k = 0; cells + k + 2 < fans; ++k) (k < usual ? late : between).push_back((middle + 1 + k) % usual);
  std::vector<std::size_t> order{middle};
  for (std::vector<std::size_t>* part : {&early, &between, &late}) {
    shuffle(*part, random);
    order.insert(order.end(), part->begin(), part->end());
  }
  order.push_back(middle);
  return order;
}

void append_scratch(CouponPlan& plan, const Vector2d& from, const Vector2d& to, const CouponCell& cell) {
  Scratches& s = plan.scratches;
  s.x0_mm.push_back(from.x()), s.y0_mm.push_back(from.y());
  s.x1_mm.push_back(to.x()), s.y1_mm.push_back(to.y());
  s.depth_um.push_back(cell.depth_um);
  plan.feed_mm_min.push_back(cell.feed_mm_min);
}

Board coupon_board(const CouponOptions& options, double depth_um) {
  Board board;
  board.size_mm.setConstant(kSize_mm);
  board.carve_min_mm.setConstant(kCarve_mm);
  board.carve_max_mm.setConstant(kSize_mm - kCarve_mm);
  board.tool_width_um = options.tool_width_um;
  board.material = options.material;
  board.material.depth_um = depth_um;
  board.tags.sigma_mm = 0.15;
  const double step = (kSize_mm - 2 * kTagCenter_mm) / 3;
  const auto put = [&](double x, double y) {
    const int id = first_coupon_tag(options.number) + static_cast<int>(board.tags.list.size());
    board.tags.list.push_back({id, {x, y}, kTag_mm, 0});
  };
  const double near = kTagCenter_mm, far = kSize_mm - kTagCenter_mm;
  for (int i = 0; i < 3; ++i) put(near + i * step, near);
  for (int i = 0; i < 3; ++i) put(far, near + i * step);
  for (int i = 0; i < 3; ++i) put(far - i * step, far);
  for (int i = 0; i < 3; ++i) put(near, far - i * step);
  return board;
}

// Places lamp and viewpoints. Half vectors tilt by the cutoff angles of the ladder's grooves, and bracket each even if
// the prior is a third off. Their azimuths are 60 degrees apart. The lamp is low, so that the viewpoint with the
// largest tilt looks past it.
void place_shots(double shallowest_um, double deepest_um, Coupon& coupon, double tool_width_um) {
  constexpr double kLampTilt = std::numbers::pi / 3, kLamp_mm = 600, kEye_mm = 300;
  // error of the prior depth; least tilt, off the mirror reflection; largest tilt, with the viewpoint off the lamp
  constexpr double kOff = 0.3, kLeastLean = 0.15, kMostLean = 0.84;
  const double low = 2 * std::atan(groove_rim(tool_width_um, (1 - kOff) * shallowest_um)),
               high = 2 * std::atan(groove_rim(tool_width_um, (1 + kOff) * deepest_um));
  const Eigen::Vector3d middle(kSize_mm / 2, kSize_mm / 2, 0);
  const Eigen::Vector3d wi(0, -std::sin(kLampTilt), std::cos(kLampTilt));
  coupon.lamp_mm = (middle + kLamp_mm * wi).array().round();
  const auto put = [&](double share, double azimuth_deg) {
    const double azimuth = azimuth_deg * std::numbers::pi / 180;
    const double lean = std::clamp(low + share * (high - low), kLeastLean, kMostLean);
    const Eigen::Vector3d h(std::sin(lean) * std::cos(azimuth), std::sin(lean) * std::sin(azimuth), std::cos(lean));
    const Eigen::Vector3d wo = 2 * wi.dot(h) * h - wi;
    coupon.shots.push_back(
        {std::round(10 * lean * 180 / std::numbers::pi) / 10, (middle + kEye_mm * wo).array().round()});
  };
  put(0.08, -30);
  put(0.45, -150);
  put(0.87, -90);
}

// Fans per row, and length of their spokes.
struct Grid {
  int across = 0;
  double pitch_mm = 0;
  Vector2d first_mm{0, 0};
  std::vector<Spokes> spokes;  // of each cell
};

// The shortest visible and permitted scratch.
double shortest_mm(const MachineProfile& machine) {
  return std::max(kShortestSpoke_mm, machine.limits.shortest_mm + 2 * machine.limits.step_mm);
}

double groove_width_mm(const CouponCell& cell, double tool_width_um) {
  return 2e-3 * half_width_um(tool_width_um, kDeeper * cell.depth_um);
}

// A cell's spokes in fans of this radius; nothing if its grooves would touch or be too short.
std::optional<Spokes> fitting_spokes(const CouponCell& cell, double outer_mm, const MachineProfile& machine,
                                     double tool_width_um) {
  const double clear_mm = std::max(groove_width_mm(cell, tool_width_um), machine.limits.distance_mm) + 0.02;
  Spokes spokes = spokes_of(outer_mm, cell.spacing_mm, clear_mm);
  if (machine.limits.longest_mm > 0)
    spokes.inner_mm = std::max(spokes.inner_mm, outer_mm - machine.limits.longest_mm + 2 * machine.limits.step_mm);
  if (spokes.outer_mm - spokes.inner_mm < shortest_mm(machine)) return std::nullopt;
  return spokes;
}

// Widens default spacings to the need of the grooves; removes a second one unless it is still closer.
void widen_spacings(double outer_mm, const MachineProfile& machine, double tool_width_um,
                    std::vector<CouponCell>& cells) {
  constexpr double kStep = 1.05, kMost_mm = 1.5, kCloserBy = 0.9;
  double usual = cells.front().spacing_mm, closer = cells.back().spacing_mm;
  const auto all_fit = [&] {
    return std::all_of(cells.begin(), cells.end() - 1, [&](CouponCell cell) {
      cell.spacing_mm = usual;
      return fitting_spokes(cell, outer_mm, machine, tool_width_um).has_value();
    });
  };
  while (!all_fit() && usual < kMost_mm) usual *= kStep;
  CouponCell last = cells.back();
  for (last.spacing_mm = closer; last.spacing_mm < kCloserBy * usual; last.spacing_mm *= kStep)
    if (fitting_spokes(last, outer_mm, machine, tool_width_um)) break;
  const auto rounded = [](double mm) { return std::round(100 * mm) / 100 + 0.01; };
  if (usual > cells.front().spacing_mm)
    for (CouponCell& cell : cells) cell.spacing_mm = rounded(usual);
  if (last.spacing_mm < kCloserBy * usual)
    cells.back().spacing_mm = last.spacing_mm > closer ? rounded(last.spacing_mm) : closer;
  else
    cells.pop_back();
}

Grid grid_for(std::vector<CouponCell>& cells, std::size_t usual, bool free_spacings, double label_mm,
              const MachineProfile& machine, double tool_width_um) {
  Grid grid;
  const std::size_t wanted = cells.size() + usual + 2;
  while (grid.across < kMostAcross && static_cast<std::size_t>(grid.across) * grid.across < wanted) ++grid.across;
  if (static_cast<std::size_t>(grid.across) * grid.across < cells.size() + 2)
    fail(kWhere,
         "is to hold " + std::to_string(cells.size()) + " kinds of fans, and " +
             std::to_string(kMostAcross * kMostAcross - 2) + " are the most beside the repeats",
         "try fewer preloads, speeds or spacings; the rest goes on another coupon");
  const double room_mm = kSize_mm - 2 * kCarve_mm;
  grid.pitch_mm = (room_mm - label_mm) / grid.across;
  grid.first_mm = {kCarve_mm + 0.5 * (room_mm - (grid.across - 1) * grid.pitch_mm),
                   kCarve_mm + label_mm + 0.5 * grid.pitch_mm};
  const double gap_mm = std::max(kFanGap_mm, machine.limits.distance_mm + 0.05);
  const double outer_mm = 0.5 * (grid.pitch_mm - gap_mm);
  if (free_spacings) widen_spacings(outer_mm, machine, tool_width_um, cells);
  for (const CouponCell& cell : cells) {
    const std::optional<Spokes> spokes = fitting_spokes(cell, outer_mm, machine, tool_width_um);
    if (!spokes)
      fail(kWhere,
           "has no room for scratches of " + significant(shortest_mm(machine), 3) + " mm " +
               significant(cell.spacing_mm, 2) + " mm apart in a fan of " + significant(2 * outer_mm, 3) +
               " mm, with grooves " + significant(groove_width_mm(cell, tool_width_um), 2) + " mm wide",
           "try a wider spacing, shallower grooves, or fewer preloads and speeds, which leave larger fans");
    grid.spokes.push_back(*spokes);
  }
  return grid;
}

void add_fans(const Grid& grid, std::size_t usual, CouponPlan& plan) {
  Coupon& coupon = plan.coupon;
  std::mt19937_64 random(static_cast<std::uint64_t>(coupon.number));
  const auto places = static_cast<std::size_t>(grid.across) * grid.across;
  std::vector<std::size_t> place(places);
  std::iota(place.begin(), place.end(), std::size_t{0});
  shuffle(place, random);
  const std::vector<std::size_t> order = order_of(coupon.cells.size(), usual, places, random);
  std::vector<bool> outward(coupon.cells.size());
  for (std::size_t i = 0; i < outward.size(); ++i) outward[i] = i % 2 == 0;
  for (std::size_t k = 0; k < places; ++k) {
    const CouponCell& cell = coupon.cells[order[k]];
    const Spokes& spokes = grid.spokes[order[k]];
    const std::size_t column = place[k] % grid.across, row = place[k] / grid.across;
    CouponFan fan{order[k],
                  grid.first_mm + grid.pitch_mm * Vector2d(static_cast<double>(column), static_cast<double>(row)),
                  spokes.outer_mm,
                  outward[order[k]],
                  plan.scratches.size(),
                  spokes.count};
    outward[order[k]] = !outward[order[k]];
    const double step = 2 * std::numbers::pi / static_cast<double>(spokes.count);
    const double turn = step * static_cast<double>(random() % 64) / 64;
    for (std::size_t i = 0; i < spokes.count; ++i) {
      const double angle = turn + step * static_cast<double>(i);
      const Vector2d along(std::cos(angle), std::sin(angle));
      const Vector2d inner = fan.center_mm + spokes.inner_mm * along, outer = fan.center_mm + spokes.outer_mm * along;
      append_scratch(plan, fan.outward ? inner : outer, fan.outward ? outer : inner, cell);
    }
    coupon.fans.push_back(fan);
  }
}

}  // namespace

CouponPlan make_coupon(const MachineProfile& machine, const CouponOptions& options) {
  if (options.number < 1 || options.number > kMostCoupons)
    fail(kWhere, "is number " + std::to_string(options.number),
         "number coupons from 1 to " + std::to_string(kMostCoupons));
  if (!(options.tool_width_um > 0 && options.tool_width_um <= bound::kToolWidth_um))
    fail(kWhere, "is for a tool of wt " + significant(options.tool_width_um, 4) + " um",
         "give four times the tip's radius, at most " + shortest(bound::kToolWidth_um) + " um (--tool-width)");
  CouponPlan plan;
  const std::vector<double> commands = commands_of(machine, options);
  plan.machine = with_commands(machine, commands);
  Coupon& coupon = plan.coupon;
  coupon.number = options.number;
  coupon.date = options.date;
  coupon.machine = machine.name;
  coupon.depth_by = depth_by_name(machine.depth_by);
  coupon.usual_feed_mm_min = machine.carve_feed_mm_min;
  coupon.at_mm = options.at_mm;
  coupon.cells = cells_of(plan.machine, options, commands);
  plan.board = coupon_board(options, coupon.cells[commands.size() / 2].depth_um);

  LabelSize label;
  const double stroke_mm = machine.limits.shortest_mm + 2 * machine.limits.step_mm;
  label.gap_mm = std::max({label.gap_mm, machine.limits.distance_mm,
                           0.6 * groove_width_mm(coupon.cells[commands.size() / 2], options.tool_width_um) + 0.02});
  if (shortest_label_stroke_mm(label) < 0.4) label.height_mm = 2 * (0.4 + 2 * label.gap_mm);
  if (stroke_mm > shortest_label_stroke_mm(label)) label.height_mm = 2 * (stroke_mm + 2 * label.gap_mm);
  const std::string text = options.date + (options.date.empty() ? "" : " ") + std::to_string(options.number);
  const double text_mm = static_cast<double>(text.size()) * label_advance_mm(label);
  const bool labeled = text_mm < kSize_mm - 2 * kCarve_mm - 1;
  if (!labeled)
    plan.findings.push_back(make_warning(FindingCode::label_omitted,
                                         "date and number are not carved: scratches of " + significant(stroke_mm, 3) +
                                             " mm make letters too large for the coupon",
                                         "write them on it by hand"));
  const double label_mm = labeled ? label.height_mm + 0.6 : 0;
  const Grid grid =
      grid_for(coupon.cells, commands.size(), options.spacings_mm.empty(), label_mm, machine, options.tool_width_um);
  for (std::size_t i = 0; i < coupon.cells.size(); ++i)
    coupon.cells[i].reached_mm_min =
        reached_mm_min(machine, grid.spokes[i].outer_mm - grid.spokes[i].inner_mm, coupon.cells[i].feed_mm_min);
  if (labeled) {
    const Scratches strokes = label_strokes(text, {kCarve_mm + 0.5, kCarve_mm + 0.3}, label);
    for (std::size_t i = 0; i < strokes.size(); ++i)
      append_scratch(plan, {strokes.x0_mm[i], strokes.y0_mm[i]}, {strokes.x1_mm[i], strokes.y1_mm[i]},
                     coupon.cells[commands.size() / 2]);
  }
  add_fans(grid, commands.size(), plan);
  const auto [low, high] = std::minmax_element(coupon.cells.begin(), coupon.cells.end(),
                                               [](const auto& a, const auto& b) { return a.depth_um < b.depth_um; });
  place_shots(low->depth_um, high->depth_um, coupon, options.tool_width_um);
  for (const CouponCell& cell : coupon.cells)
    if (cell.command == commands.front() && cell.spacing_mm == coupon.cells.front().spacing_mm &&
        cell.reached_mm_min < 0.75 * cell.feed_mm_min)
      plan.findings.push_back(make_warning(FindingCode::feed_unreached,
                                           "scratches this short do not reach " + significant(cell.feed_mm_min, 4) +
                                               " mm/min: they average " + significant(cell.reached_mm_min, 3) +
                                               " at the machine's acceleration",
                                           "compare with scratches of your boards, which are as short or reach it"));
  return plan;
}

std::vector<Finding> check_place(const Board& board, const Vector2d& at_mm) {
  const Vector2d end_mm = at_mm.array() + kSize_mm;
  const auto place = [](const Vector2d& p) { return "(" + shortest(p.x()) + ", " + shortest(p.y()) + ")"; };
  if ((at_mm.array() < 0).any() || (end_mm.array() > board.size_mm.array()).any())
    fail(kWhere,
         "reaches from " + place(at_mm) + " to " + place(end_mm) + " mm, off the board of " +
             shortest(board.size_mm.x()) + " x " + shortest(board.size_mm.y()) + " mm",
         "put its lower-left corner elsewhere (--at), or carve it on scrap (without --on)");
  std::vector<KeepOut> taken = board.keep_out;
  for (const Tag& tag : board.tags.list) taken.push_back(tag_paper(tag, board.tags.family));
  constexpr int kLooks = 120;  // every half millimeter
  for (int i = 0; i <= kLooks; ++i)
    for (int j = 0; j <= kLooks; ++j) {
      const Vector2d p = at_mm + kSize_mm / kLooks * Vector2d(i, j);
      for (const KeepOut& other : taken)
        if (distance_mm(p, other) == 0)
          fail(kWhere, "covers " + (other.name.empty() ? "a keep-out" : other.name) + " at " + place(p) + " mm",
               "carve it on scrap of the same metal, which is simplest (without --on), or put its lower-left corner "
               "where 60 x 60 mm are free of tags (--at)");
    }
  if ((end_mm.array() <= board.carve_min_mm.array()).any() || (at_mm.array() >= board.carve_max_mm.array()).any())
    return {};
  return {make_warning(FindingCode::coupon_place, "the coupon lies in the board's carve area",
                       "keep designs off it: \"keep_out\": [{ \"name\": \"coupon\", \"rect_mm\": [[" +
                           shortest(at_mm.x()) + ", " + shortest(at_mm.y()) + "], [" + shortest(end_mm.x()) + ", " +
                           shortest(end_mm.y()) + "]], \"height_mm\": 0 }] in its board.json")};
}

Board coupon_on_machine(const CouponPlan& plan, const Board* on) {
  Board board = plan.board;
  const Vector2d& at = plan.coupon.at_mm;
  board.size_mm += at;
  board.carve_min_mm += at;
  board.carve_max_mm += at;
  for (Tag& tag : board.tags.list) tag.center_mm += at;
  if (on == nullptr) return board;
  board.size_mm = on->size_mm;
  board.flatness_um = on->flatness_um;
  board.keep_out = on->keep_out;
  for (const Tag& tag : on->tags.list) {
    board.keep_out.push_back(tag_paper(tag, on->tags.family));
    board.keep_out.back().height_mm = on->tags.z_mm;
  }
  return board;
}

}  // namespace burin
