// Proves: the probing file touches the face on a grid, clear of tags and holes, and what two kinds of controllers log
// of it comes back as the heights that the sheet has; logs that cannot be trusted are refused with words. The
// controllers are played by a few lines that share nothing with the reader: they follow the file and touch a known
// face.
#include "burin/optimize/toolpath/probe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <sstream>

#include "burin/base/error.h"
#include "burin/optimize/toolpath/probe_check.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using FaceZ = std::function<double(double x, double y)>;

// Bowed by 60 um, tilted by 80 um, lying 0.4 mm below where a person set zero by eye.
double sheet(double x, double y) {
  const double X = x / 50 - 1, Y = y / 40 - 1;
  return -0.4 + 0.06 * X * X - 0.02 * X * Y + 0.04 * Y + 0.04 * X;
}

Board board() {
  Board b;
  b.size_mm = {100, 80};
  b.carve_min_mm = {10, 10};
  b.carve_max_mm = {90, 70};
  b.tags.list = {{0, {15, 15}, 10, 0}};
  b.keep_out = {{"hole", {}, {50, 40}, 6, 0}};
  return b;
}

struct Touch {
  double x = 0, y = 0, z = 0;
};

// What a controller does with the file: machine coordinates are work ones less `offset`, Z zero moves at G10.
struct Controller {
  std::vector<Touch> touched_machine, logged_work;
  double lowest_travel_mm = 1e9;

  Controller(const std::string& gcode, const FaceZ& face, bool rounded = true) {
    constexpr std::array<double, 2> kOffset{-213.4, -120.25};
    double x = 0, y = 0, z = 50, zero = 0;  // z of the tool, in the frame of `face`
    bool log = false;
    std::istringstream lines(gcode);
    for (std::string line; std::getline(lines, line);) {
      double a = 0, b = 0;
      if (std::sscanf(line.c_str(), "G0 X%lf Y%lf", &a, &b) == 2) {
        x = a, y = b;
        lowest_travel_mm = std::min(lowest_travel_mm, z - face(x, y));
      } else if (std::sscanf(line.c_str(), "G0 Z%lf", &a) == 1) {
        z = zero + a;
      } else if (std::sscanf(line.c_str(), "G38.2 Z%lf F%lf", &a, &b) == 2) {
        EXPECT_LT(zero + a, face(x, y)) << "looks for the face above it";
        z = face(x, y);
        const double machine_z = z - 17.5;
        touched_machine.push_back(
            {x + kOffset[0], y + kOffset[1], rounded ? std::round(1e3 * machine_z) / 1e3 : machine_z});
        if (log) logged_work.push_back({x, y, z - zero});
      } else if (line == "G10 L20 P1 Z0") {
        zero = z;
      } else if (line == "(PROBEOPEN burin-probe.txt)") {
        log = true;
      } else if (line == "(PROBECLOSE)") {
        log = false;
      } else {
        EXPECT_TRUE(line.starts_with("(") || line.starts_with("G21") || line == "M2" || line == "M5 S0") << line;
      }
    }
  }

  std::string grbl_log(std::size_t without_last = 0) const {
    std::string text = "Grbl 1.1h ['$' for help]\nok\n[PRB:0.000,0.000,-3.000:1]\nok\n";
    for (std::size_t i = 0; i + without_last < touched_machine.size(); ++i) {
      const Touch& t = touched_machine[i];
      char line[100];
      std::snprintf(line, sizeof line, "<Idle|WPos:0,0,0>\r\n[PRB:%.3f,%.3f,%.3f:1]\r\nok\r\n", t.x, t.y, t.z);
      text += line;
    }
    return text;
  }

  std::string linuxcnc_log() const {
    std::string text;
    for (const Touch& t : logged_work) {
      char line[200];
      std::snprintf(line, sizeof line, "%f %f %f 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000\n", t.x, t.y,
                    t.z);
      text += line;
    }
    return text;
  }
};

std::string gcode_for(const char* machine) { return probe_gcode(probe_plan(board(), 12), machine_profile(machine)); }

void expect_sheet(const HeightMap& map, double tolerance_mm) {
  const double zero = sheet(map.zero_mm.x(), map.zero_mm.y());
  for (double x = 10; x <= 90; x += 4)
    for (double y = 10; y <= 70; y += 4)
      // The grid's cells are straight: a bow of 60 um bends by 1 um within one.
      EXPECT_NEAR(height_mm(map, {x, y}), sheet(x, y) - zero, tolerance_mm + 0.0015) << x << " " << y;
}

TEST(Probe, GrblsAnswersAreTheSheet) {
  const std::string gcode = gcode_for("grbl");
  const Controller controller(gcode, sheet);
  EXPECT_GT(controller.lowest_travel_mm, 0.2);
  const ProbedHeights probed = read_probe_log(controller.grbl_log(), "serial.log", gcode, "probe.gcode");
  EXPECT_TRUE(probed.findings.empty());
  expect_sheet(probed.map, 1.1e-3);  // grbl tells micrometers
  EXPECT_EQ(probed.map.drift_mm, 0);
  EXPECT_THAT(gcode, HasSubstr("G10 L20 P1 Z0"));
}

TEST(Probe, FilesAreReadAsTheMachineWouldBeforeTheyAreKept) {
  const ProbePlan plan = probe_plan(board(), 12);
  for (const char* name : {"grbl", "linuxcnc"}) {
    const MachineProfile machine = machine_profile(name);
    const std::string good = gcode_for(name);
    EXPECT_NO_THROW(fail_unless_probes(good, plan, machine, "probe.gcode")) << name;
    const auto refused = [&](const std::string& what, const std::string& by, std::size_t from, const char* why) {
      std::string bad = good;
      const std::size_t at = bad.find(what, from);
      ASSERT_NE(at, std::string::npos) << what;
      bad.replace(at, what.size(), by);
      EXPECT_THAT([&] { fail_unless_probes(bad, plan, machine, "probe.gcode"); },
                  testing::ThrowsMessage<Error>(HasSubstr(why)))
          << name << ": " << what;
    };
    const std::size_t grid = good.rfind("G10 ");
    const std::size_t lifts = good.find("G0 Z", good.find("G38.2", grid));
    const std::string lift = good.substr(lifts, good.find('\n', lifts) - lifts + 1);
    refused(lift, "", good.find("G38.2", grid), "without being lifted");
    refused(lift, "G0 Z-1\n", good.find("G38.2", grid), "goes down without probing");
    refused("G38.2", "G1", grid, "");
    refused("G21 ", "", 0, "before millimeters");
    refused("G21 ", "G20 ", 0, "needs not");
    refused("M2", "G28\nM2", 0, "needs not");
    refused("M2", "", 0, "does not touch each planned point");
    refused("G0 X", "G10 L20 P1 Z0\nG0 X", grid + 20, "sets Z zero elsewhere");
    refused("M2\n", "M2\nG0 X0\n", 0, "behind the end");
    EXPECT_THROW(fail_unless_probes(std::string_view(good).substr(0, good.size() / 2), plan, machine, "probe.gcode"),
                 Error);
    MachineProfile small = machine;
    small.travel = MachineBounds{{0, 0}, {30, 30}};
    EXPECT_THAT([&] { fail_unless_probes(good, plan, small, "probe.gcode"); },
                testing::ThrowsMessage<Error>(HasSubstr("travel_mm")));
  }
}

TEST(Probe, LinuxCncsFileIsTheSheet) {
  const std::string gcode = gcode_for("linuxcnc");
  const Controller controller(gcode, sheet);
  const ProbedHeights probed = read_probe_log(controller.linuxcnc_log(), "burin-probe.txt", gcode, "probe.gcode");
  expect_sheet(probed.map, 2e-6);
  EXPECT_LT((probed.map.zero_mm - probe_plan(board(), 12).points_mm.front()).norm(), 1e-4);
}

TEST(Probe, KeepsClearOfTagsAndHoles) {
  const ProbePlan plan = probe_plan(board(), 5);
  const KeepOut paper = tag_paper(board().tags.list[0], board().tags.family);
  for (const Eigen::Vector2d& p : plan.points_mm) {
    EXPECT_GT((p - Eigen::Vector2d(50, 40)).norm(), 7) << p.transpose();
    EXPECT_FALSE((p.array() <= paper.polygon_mm[2].array() + 1).all()) << p.transpose();
  }
  EXPECT_EQ(plan.points_mm.front(), plan.points_mm.back());
  EXPECT_GT(plan.points_mm.size(), 150u);
}

TEST(Probe, WhatWasNotProbedIsFilledIn) {
  const std::string gcode = gcode_for("grbl");
  const HeightMap map = read_probe_log(Controller(gcode, sheet).grbl_log(), "l", gcode, "p").map;
  const double zero = sheet(map.zero_mm.x(), map.zero_mm.y());
  std::size_t filled = 0;
  for (std::size_t i = 0; i < map.z_mm.size(); ++i) {
    const Eigen::Vector2d p = map.at(i);
    if (map.probed[i]) continue;
    ++filled;
    EXPECT_NEAR(map.z_mm[i], sheet(p.x(), p.y()) - zero, 2e-3);
  }
  EXPECT_GT(filled, 1u);
}

TEST(Probe, HeightsAreKeptInAFile) {
  const TemporaryFolder folder;
  const std::string gcode = gcode_for("grbl");
  HeightMap map = read_probe_log(Controller(gcode, sheet).grbl_log(), folder / "serial.log", gcode, "p").map;
  write_heights(map, folder / "heights.json");
  const HeightMap again = read_heights(folder / "heights.json");
  EXPECT_EQ(again.zero_mm, map.zero_mm);
  EXPECT_EQ(again.probed, map.probed);
  EXPECT_EQ(again.log, folder / "serial.log");
  for (std::size_t i = 0; i < map.z_mm.size(); ++i) EXPECT_NEAR(again.z_mm[i], map.z_mm[i], 2e-4);
  const auto refuse = [&](const std::string& json, const char* message) {
    EXPECT_THAT([&] { read_heights(folder.write("h.json", json)); }, ThrowsMessage<Error>(HasSubstr(message)));
  };
  const std::string head = R"({"format": "burin/heights", "version": 1, "zero_mm": [0, 0], "first_mm": [0, 0], )";
  refuse(head + R"("step_mm": [0, 5], "z_mm": [[0, 0], [0, 0]]})", "step_mm: is");
  refuse(head + R"("step_mm": [5, 5], "z_mm": [[0, 0], [0]]})", "rows of several lengths");
  refuse(head + R"("step_mm": [5, 5], "z_mm": [[0, null], [0, null]]})", "fewer than four heights");
  refuse(head + R"("step_mm": [5, 5], "z_mm": [[0, "1"], [0, 0]]})", "has \"1\" for a height");
}

TEST(Probe, LogsThatCannotBeTrustedAreRefused) {
  const std::string gcode = gcode_for("grbl");
  const Controller good(gcode, sheet);
  const auto refuse = [&](const std::string& log, const auto& message) {
    EXPECT_THAT([&] { read_probe_log(log, "serial.log", gcode, "probe.gcode"); }, ThrowsMessage<Error>(message));
  };
  refuse("", HasSubstr("serial.log: holds no probed point"));
  refuse("ok\nok\n", HasSubstr("serial.log:1: is neither an answer of grbl"));
  refuse(good.grbl_log(1), HasSubstr("was probed at"));  // cut off: the stray one before fits nowhere
  refuse(good.grbl_log(5), HasSubstr("holds 43 probed points of 47"));
  Controller few = good;
  few.touched_machine.resize(20);
  refuse(few.grbl_log(), AllOf(HasSubstr("holds 21 probed points of"), HasSubstr("run to its end")));
  std::string failed = good.grbl_log();
  failed.replace(failed.rfind(":1]"), 3, ":0]");
  refuse(failed, HasSubstr("found no contact"));
  refuse(good.grbl_log() + "[PRB:1.0,2.0", HasSubstr("broken answer"));
  Controller other = good;
  other.touched_machine[30].x += 0.2;
  refuse(other.grbl_log(), HasSubstr("where the probing file goes to"));
  Controller inches = good;
  for (Touch& t : inches.touched_machine) t = {t.x / 25.4, t.y / 25.4, t.z / 25.4};
  refuse(inches.grbl_log(), AllOf(HasSubstr("is in inches"), HasSubstr("$13=0")));
  Controller chip = good;
  chip.touched_machine[25].z += 0.05;
  refuse(chip.grbl_log(), AllOf(HasSubstr("above the smooth face"), HasSubstr("chip or dust")));
  Controller moved = good;
  moved.touched_machine.back().z += 0.03;
  refuse(moved.grbl_log(), HasSubstr("elsewhere at the end"));
  const Controller tilted(gcode, [](double x, double y) { return sheet(x, y) + 0.025 * (x - 10); });
  refuse(tilted.grbl_log(), AllOf(HasSubstr("tilts by"), HasSubstr("clamp the sheet")));
  EXPECT_THAT([&] { read_probe_log(good.grbl_log(), "serial.log", "G21 G90\n", "board.gcode"); },
              ThrowsMessage<Error>(HasSubstr("board.gcode: is no probing file")));
  // A little drift is said, not refused.
  Controller drifted = good;
  drifted.touched_machine.back().z += 0.008;
  EXPECT_EQ(read_probe_log(drifted.grbl_log(), "serial.log", gcode, "probe.gcode").findings.size(), 1u);
}

TEST(Probe, MachinesThatCannotProbeAreToldWhatToDo) {
  const ProbePlan plan = probe_plan(board(), 12);
  EXPECT_THAT([&] { probe_gcode(plan, machine_profile("marlin")); }, ThrowsMessage<Error>(HasSubstr("0.01 mm only")));
  Board small = board();
  small.keep_out = {{"all", {}, {50, 40}, 200}};
  EXPECT_THAT([&] { probe_plan(small, 12); }, ThrowsMessage<Error>(HasSubstr("clear of tags")));
  EXPECT_THAT([&] { probe_plan(board(), -1); }, ThrowsMessage<Error>(HasSubstr("-1 mm")));
  EXPECT_THAT([&] { probe_plan(board(), 0.1); }, ThrowsMessage<Error>(HasSubstr("greater distance")));
}

}  // namespace
}  // namespace burin
