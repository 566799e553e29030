// Proves: a coupon can be carved and tells what it should. Its grooves lie in the carve area, off the tags, and touch
// no other even if they come out 1.3 times as deep; every way to carve is there, the middle one first and last, both
// directions of travel in each direction of the fan; the file for the machine has each scratch's own command and speed,
// by a reading that shares nothing with what wrote it; machines' rules hold; what makes no sense is refused. What was
// measured comes into the machine's file and out of it as it was.
#include "burin/optimize/toolpath/coupon.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "burin/base/error.h"
#include "burin/optimize/machine_measured.h"
#include "burin/optimize/toolpath.h"
#include "burin/optimize/toolpath/carving_limits.h"
#include "burin/optimize/toolpath/label.h"
#include "burin/optimize/write_measured_machine.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using Eigen::Vector2d;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

CouponOptions dated(int number = 3) {
  CouponOptions options;
  options.number = number;
  options.date = "2026-11-22";
  return options;
}

Vector2d first_end(const Scratches& s, std::size_t i) { return {s.x0_mm[i], s.y0_mm[i]}; }
Vector2d last_end(const Scratches& s, std::size_t i) { return {s.x1_mm[i], s.y1_mm[i]}; }

// The rules of a machine that lets no groove touch another, at depths 1.3 times those believed.
LimitsCheck judged(const CouponPlan& plan) {
  Scratches deeper = plan.scratches;
  for (double& depth : deeper.depth_um) depth *= 1.3;
  MachineLimits limits;
  limits.max_grooves = 1;
  return check_limits(deeper, carving_limits(plan.board, limits, 10, CarvingLimits().affine), 1e-9);
}

TEST(Coupon, GroovesLieApartAndOffTheTags) {
  std::vector<CouponOptions> trials{dated()};
  trials.push_back(dated(120));
  trials.back().commands = {0.3, 0.9};
  trials.push_back(dated());
  trials.back().tool_width_um = 2000;  // wide grooves need wider spacings
  trials.push_back(dated());
  trials.back().commands = {0.2, 0.6, 1.0, 1.4};
  trials.back().feeds_mm_min = {100, 200, 300, 400};
  trials.push_back(dated());
  trials.back().spacings_mm = {0.4, 0.5, 0.3};
  for (const CouponOptions& options : trials) {
    const CouponPlan plan = make_coupon(machine_profile("grbl-spring"), options);
    const LimitsCheck check = judged(plan);
    EXPECT_TRUE(check.good()) << check.first;
    ASSERT_EQ(plan.feed_mm_min.size(), plan.scratches.size());
    for (const CouponFan& fan : plan.coupon.fans)
      for (const CouponFan& other : plan.coupon.fans)
        if (&fan != &other) {
          EXPECT_GT((fan.center_mm - other.center_mm).norm(), fan.radius_mm + other.radius_mm);
        }
  }
}

TEST(Coupon, HoldsEveryWayToCarveInAllDirections) {
  const MachineProfile machine = machine_profile("grbl-spring");
  const CouponPlan plan = make_coupon(machine, dated());
  const Coupon& coupon = plan.coupon;
  EXPECT_EQ(coupon.cells.size(), 16U);  // 5 preloads, 3 speeds, and one closer
  std::map<std::size_t, std::set<bool>> ways;
  std::map<std::size_t, int> fans;
  std::size_t row = coupon.fans.front().first_row;
  EXPECT_GT(row, 20U);  // the date
  for (const CouponFan& fan : coupon.fans) {
    ways[fan.cell].insert(fan.outward);
    ++fans[fan.cell];
    EXPECT_EQ(fan.first_row, row);
    row += fan.rows;
    const CouponCell& cell = coupon.cells[fan.cell];
    std::vector<double> angles;
    for (std::size_t i = fan.first_row; i < row; ++i) {
      EXPECT_EQ(plan.scratches.depth_um[i], cell.depth_um);
      EXPECT_EQ(plan.feed_mm_min[i], cell.feed_mm_min);
      const Vector2d way = last_end(plan.scratches, i) - first_end(plan.scratches, i);
      const Vector2d from_center = first_end(plan.scratches, i) - fan.center_mm;
      EXPECT_EQ(way.dot(from_center) > 0, fan.outward);
      angles.push_back(std::atan2(way.y(), way.x()));
    }
    // No direction, of travel even, is further from a scratch's than half a step of a fan of 24.
    std::sort(angles.begin(), angles.end());
    for (std::size_t i = 1; i < angles.size(); ++i)
      EXPECT_LT(angles[i] - angles[i - 1], 2 * std::numbers::pi / 24 + 1e-9);
  }
  EXPECT_EQ(row, plan.scratches.size());
  EXPECT_EQ(fans.size(), coupon.cells.size());
  EXPECT_EQ(coupon.fans.front().cell, 2U);
  EXPECT_EQ(coupon.fans.back().cell, 2U);
  for (std::size_t cell = 0; cell < 5; ++cell) {
    EXPECT_GE(fans[cell], 2);
    EXPECT_EQ(ways[cell].size(), 2U);
  }
  // Places say nothing of preloads: over the coupon's left and right half the mean commands are much the same.
  double left = 0, right = 0;
  int lefts = 0, rights = 0;
  for (const CouponFan& fan : coupon.fans)
    (fan.center_mm.x() < 29 ? left : right) += coupon.cells[fan.cell].command,
        ++(fan.center_mm.x() < 29 ? lefts : rights);
  EXPECT_NEAR(left / lefts, right / rights, 0.5);
}

TEST(Coupon, HasTagsOfItsOwnAndPhotosThatReachItsDepths) {
  const CouponPlan three = make_coupon(machine_profile("grbl-spring"), dated(3));
  std::set<int> ids;
  for (const int number : {1, 2, 3, 119, 120})
    for (const Tag& tag : make_coupon(machine_profile("grbl-spring"), dated(number)).board.tags.list) {
      EXPECT_TRUE(ids.insert(tag.id).second) << tag.id;
      EXPECT_NO_THROW(tag_paper(tag, three.board.tags.family));
      EXPECT_LT(tag.id, 2115);  // as many tags as the family has
    }
  ASSERT_EQ(three.coupon.shots.size(), 3U);
  std::vector<double> leans;
  for (const CouponShot& shot : three.coupon.shots) {
    const Eigen::Vector3d middle(30, 30, 0);
    const Eigen::Vector3d h =
        ((three.coupon.lamp_mm - middle).normalized() + (shot.eye_mm - middle).normalized()).normalized();
    leans.push_back(std::acos(h.z()) * 180 / std::numbers::pi);
    EXPECT_NEAR(leans.back(), shot.lean_deg, 0.6);  // places are whole millimeters
    EXPECT_GT(shot.eye_mm.z(), 100);
  }
  // Walls of 4 and 26 um are as steep as 16 and 41 degrees at the most.
  EXPECT_LT(leans.front(), 24);
  EXPECT_GT(leans.back(), 36);
}

// What a file tells the machine for each stroke: how deep Z goes, S, and the speed along it.
struct Stroke {
  double z = 0, s = 0, feed = 0;
};
std::vector<Stroke> strokes_of(const std::string& gcode) {
  std::vector<Stroke> out;
  Stroke now;
  std::istringstream lines(gcode);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    bool moves = false, cuts = false;
    for (std::string word; words >> word;) {
      const double value = word.size() > 1 ? std::atof(word.c_str() + 1) : 0;
      if (word == "G1") cuts = true;
      if (word[0] == 'X' || word[0] == 'Y') moves = true;
      if (word[0] == 'Z') now.z = value;
      if (word[0] == 'S') now.s = value;
      if (word[0] == 'F') now.feed = value;
    }
    if (cuts && moves) out.push_back(now);
  }
  return out;
}

std::vector<Stroke> strokes_for(const CouponPlan& plan) {
  const TemporaryFolder folder;
  ToolpathOptions options;
  options.keep_order = true;
  options.feed_mm_min = plan.feed_mm_min;
  const ToolpathReport report =
      write_toolpath(plan.scratches, coupon_on_machine(plan), nullptr, plan.machine, options, folder / "coupon.gcode");
  EXPECT_EQ(report.files.size(), 1U);
  return strokes_of(file_text(folder / "coupon.gcode"));
}

TEST(Coupon, TellsTheMachineEachCommandAndSpeed) {
  const TemporaryFolder folder;
  const MachineProfile servo = read_machine_profile(
      folder.write("servo.json",
                   R"({"format": "burin/machine", "version": 1, "depth_by": "servo", "dwell_s": 0.2, "servo_up": 900,
          "depth_table": [[5, 700], [10, 600], [20, 300]]})"));
  CouponOptions beyond = dated();
  beyond.commands = {0.1, 0.5, 2.2};  // softer and harder than the table knows
  CouponOptions depths = dated();
  depths.depths_um = {6, 9, 14};
  CouponOptions falling = dated();
  falling.commands = {750, 500, 250};
  for (const auto& [machine, options] : {std::pair(machine_profile("grbl-spring"), beyond),
                                         std::pair(machine_profile("grbl"), depths), std::pair(servo, falling)}) {
    const CouponPlan plan = make_coupon(machine, options);
    const std::vector<Stroke> strokes = strokes_for(plan);
    ASSERT_EQ(strokes.size(), plan.scratches.size());
    for (const CouponFan& fan : plan.coupon.fans)
      for (std::size_t i = fan.first_row; i < fan.first_row + fan.rows; ++i) {
        const CouponCell& cell = plan.coupon.cells[fan.cell];
        const double told = machine.depth_by == DepthBy::servo ? strokes[i].s : -strokes[i].z;
        EXPECT_NEAR(told, cell.command, machine.depth_by == DepthBy::servo ? 0.006 : 6e-4);
        EXPECT_EQ(strokes[i].feed, cell.feed_mm_min);
      }
  }
}

TEST(Coupon, ObeysTheMachine) {
  MachineProfile machine = machine_profile("grbl-spring");
  machine.limits = {0.0125, 1.2, 2.0, 0.05, 0.3, 3};
  CouponPlan plan = make_coupon(machine, dated());
  EXPECT_EQ(strokes_for(plan).size(), plan.scratches.size());  // plan_toolpath judges the limits
  machine.limits.shortest_mm = 8;
  EXPECT_THAT([&] { make_coupon(machine, dated()); },
              ThrowsMessage<Error>(AllOf(HasSubstr("no room for scratches of 8"), HasSubstr("fewer preloads"))));
  machine.limits = {};
  machine.travel = MachineBounds{{0, 0}, {40, 40}};
  plan = make_coupon(machine, dated());
  EXPECT_THAT([&] { strokes_for(plan); }, ThrowsMessage<Error>(HasSubstr("leaves the travel")));
}

TEST(Coupon, RefusesWhatMakesNoSense) {
  const MachineProfile spring = machine_profile("grbl-spring"), fixed = machine_profile("grbl");
  const auto refuses = [&](const MachineProfile& machine, CouponOptions options, const std::string& what) {
    EXPECT_THAT([&] { make_coupon(machine, options); }, ThrowsMessage<Error>(HasSubstr(what)));
  };
  CouponOptions options = dated();
  options.commands = {1, 0.5};
  refuses(spring, options, "out of order");
  refuses(fixed, options, "which goes to a fixed Z");
  options.commands = {0.5, -1};
  refuses(spring, options, "give numbers above 0");
  options = dated();
  options.depths_um = {5, 80};
  refuses(spring, options, "no command for a depth of 80 um");
  options.depths_um = {5, 1e300};
  refuses(fixed, options, "deeper than any tip cuts");
  options = dated();
  options.feeds_mm_min = {-5};
  refuses(spring, options, "speeds");
  options = dated();
  for (int i = 1; i < 20; ++i) options.feeds_mm_min.push_back(50 * i);
  refuses(spring, options, "kinds of fans");
  options = dated(121);
  refuses(spring, options, "number coupons from 1 to 120");
  options = dated();
  options.date = "today";
  refuses(spring, options, "no strokes for \"t\"");
  const TemporaryFolder folder;
  Board board;
  board.size_mm = {200, 150};
  board.carve_min_mm = {80, 20};
  board.carve_max_mm = {180, 130};
  EXPECT_TRUE(check_place(board, {0, 0}).empty());
  EXPECT_EQ(check_place(board, {50, 0}).size(), 1U);
  EXPECT_THAT([&] { check_place(board, {150, 0}); }, ThrowsMessage<Error>(HasSubstr("off the board")));
  board.keep_out.push_back({"hole", {}, {30, 30}, 4});
  EXPECT_THAT(
      [&] {
        check_place(board, {0, 0});
      },
      ThrowsMessage<Error>(AllOf(HasSubstr("covers hole"), HasSubstr("on scrap of the same metal"))));
}

TEST(Coupon, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  const Coupon coupon = make_coupon(machine_profile("grbl-spring"), dated()).coupon;
  write_coupon(coupon, folder / "coupon.json");
  const Coupon again = read_coupon(folder / "coupon.json");
  write_coupon(again, folder / "again.json");
  EXPECT_EQ(file_text(folder / "coupon.json"), file_text(folder / "again.json"));
  EXPECT_EQ(again.fans.size(), coupon.fans.size());
  EXPECT_EQ(again.fans.back().center_mm, coupon.fans.back().center_mm);
  folder.write("broken.json", R"({"format": "burin/coupon", "version": 1, "number": 300})");
  EXPECT_THAT([&] { read_coupon(folder / "broken.json"); }, ThrowsMessage<Error>(HasSubstr("number")));
}

TEST(Coupon, LabelsAreLegible) {
  // Seven strokes: an 8 has all, a 1 two on its right, a hyphen one in the middle.
  const LabelSize size{2, 0.1};
  EXPECT_EQ(label_strokes("8", {0, 0}, size).size(), 7U);
  const Scratches one = label_strokes("1", {5, 5}, size);
  ASSERT_EQ(one.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(one.x0_mm[i], 5 + 0.55 * 2, 1e-9);
    EXPECT_NEAR(one.x1_mm[i], 5 + 0.55 * 2, 1e-9);
  }
  const Scratches hyphen = label_strokes("-", {0, 0}, size);
  ASSERT_EQ(hyphen.size(), 1U);
  EXPECT_NEAR(hyphen.y0_mm[0], 1, 1e-9);
  EXPECT_EQ(label_strokes("2026-11-22 3", {0, 0}, size).size(), 5U + 6 + 5 + 6 + 1 + 2 + 2 + 1 + 5 + 5 + 0 + 5);
}

MachineMeasured some_measured() {
  MachineMeasured m;
  m.coupon = 3;
  m.date = "2026-11-22";
  m.tool_width_um = 400;
  m.usual_feed_mm_min = 1200;
  m.usual_spacing_mm = 0.27;
  const double depths[] = {5.8, 14.2, 21.1};
  for (int i = 0; i < 3; ++i)
    m.cells.push_back({0.2 + 0.4 * i, 1200, 0.27, 2, MeasuredNumber{depths[i], 0.2}, MeasuredNumber{0.045, 0.001}});
  m.cells.push_back({0.6, 300, 0.27, 1, MeasuredNumber{15, 0.3}, std::nullopt});
  m.cells.push_back({1.4, 1200, 0.27, 1, std::nullopt, MeasuredNumber{0.046, 0.001}});
  m.repeat_depth = MeasuredNumber{0.016, 0.005};
  m.wear_over_mm = 3000;
  m.wear_depth = MeasuredNumber{-0.04, 0.02};
  m.travel_depth = MeasuredNumber{0.03, 0.002};
  m.travel_towards_deg = 40;
  return m;
}

TEST(MachineMeasured, ComesIntoTheMachinesFile) {
  const TemporaryFolder folder;
  const MachineMeasured measured = some_measured();
  EXPECT_FALSE(write_measured_machine("grbl-spring", measured, folder / "mine.json").has_value());
  const MachineProfile machine = machine_profile((folder / "mine.json").string());
  EXPECT_FALSE(machine.depth_table.assumed);
  ASSERT_EQ(machine.depth_table.rows.size(), 3U);  // those at the usual speed whose depth is known
  EXPECT_EQ(machine.depth_table.rows[1].depth_um, 14.2);
  EXPECT_NEAR(machine.depth_table.rows[1].command, 0.6, 1e-12);
  EXPECT_NEAR(machine.depth_table.rows[1].sigma_um, 0.2, 1e-12);
  EXPECT_NEAR(plunge_mm(machine, 0.0142), 0.6, 1e-12);
  ASSERT_TRUE(machine.measured.has_value());
  EXPECT_EQ(machine.measured->cells.size(), 5U);
  EXPECT_FALSE(machine.measured->cells[3].alpha.has_value());
  EXPECT_EQ(machine.measured->wear_depth->value, -0.04);
  EXPECT_EQ(machine.measured->travel_towards_deg, 40);

  // In place: the former file stays beside it, however often.
  const std::string before = file_text(folder / "mine.json");
  MachineMeasured later = measured;
  later.coupon = 4;
  const std::string name = (folder / "mine.json").string();
  const auto former = write_measured_machine(name, later, name);
  ASSERT_TRUE(former.has_value());
  EXPECT_EQ(file_text(*former), before);
  EXPECT_EQ(machine_profile(name).measured->coupon, 4);
  const auto second = write_measured_machine(name, later, name);
  EXPECT_NE(*second, *former);
  EXPECT_EQ(file_text(*former), before);
  EXPECT_THAT([&] { write_measured_machine("grbl", measured, name); },
              ThrowsMessage<Error>(HasSubstr("is there already")));
  EXPECT_THAT([&] { write_measured_machine(name, measured, folder / "m.toml"); },
              ThrowsMessage<Error>(HasSubstr("is no .json file")));
}

TEST(MachineMeasured, KeepsAPersonsKeysAndReadsToml) {
  const TemporaryFolder folder;
  const auto toml = folder.write("shop.toml",
                                 "format = \"burin/machine\"\nversion = 1\nbased_on = \"grbl-spring\"\n"
                                 "carve_feed_mm_min = 700\n[limits]\nstep_mm = 0.0125\n");
  write_measured_machine(toml.string(), some_measured(), folder / "shop.json");
  const MachineProfile machine = machine_profile((folder / "shop.json").string());
  EXPECT_EQ(machine.carve_feed_mm_min, 700);
  EXPECT_EQ(machine.limits.step_mm, 0.0125);
  EXPECT_EQ(machine.depth_table.rows.size(), 3U);
  // A fixed Z has no table; what was measured is kept all the same.
  write_measured_machine("grbl", some_measured(), folder / "fixed.json");
  EXPECT_TRUE(machine_profile((folder / "fixed.json").string()).depth_table.rows.empty());
  EXPECT_TRUE(machine_profile((folder / "fixed.json").string()).measured.has_value());
}

TEST(MachineMeasured, TableRisesOrIsNone) {
  MachineMeasured m = some_measured();
  m.cells[1].depth_um = MeasuredNumber{21.2, 0.3};  // a little deeper than the next, within two sigmas
  DepthTable table = measured_table(m);
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_NEAR(table.rows[1].depth_um, (21.2 / 0.09 + 21.1 / 0.04) / (1 / 0.09 + 1 / 0.04), 1e-9);
  EXPECT_NEAR(table.rows[1].command, 0.8, 1e-9);
  m.cells[1].depth_um = MeasuredNumber{30, 0.3};  // beyond chance
  EXPECT_TRUE(measured_table(m).rows.empty());
  m = some_measured();
  m.cells[1].depth_um.reset();
  m.cells[2].depth_um.reset();
  EXPECT_TRUE(measured_table(m).rows.empty());
}

}  // namespace
}  // namespace burin
