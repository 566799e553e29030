// Proves: whatever way a machine reaches its depths (Z, a spring, a drag bit, a servo, a laser's axis), the file it
// gets makes the depth that was asked for, by a reading of the file that shares nothing with what wrote or replays it;
// an uneven face that was probed is followed within a tenth of the depth; what would spoil the board is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <sstream>

#include "burin/base/error.h"
#include "burin/optimize/toolpath.h"
#include "burin/optimize/toolpath/sheet.h"
#include "burin/optimize/toolpath/toolpath_check.h"
#include "burin/scene/parameter_name.h"
#include "tests/optimize/carving_bench.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

Scratches scratches_in_the_middle(std::size_t count) { return random_scratches(count, 7, {35, 35}, {165, 65}, 22); }

MachineProfile profile(const TemporaryFolder& folder, const std::string& fields) {
  return read_machine_profile(folder.write("m.json", R"({"format": "burin/machine", "version": 1, )" + fields + "}"));
}

constexpr const char* kServo =
    R"("depth_by": "servo", "dwell_s": 0.2, "servo_up": 300, "depth_table": [[5, 500], [10, 600], [20, 900]])";

// A sheet that is tilted by 0.2 mm and bowed by 0.15.
double sheet(const Eigen::Vector2d& p) {
  const double X = p.x() / 100 - 1, Y = p.y() / 50 - 1;
  return 0.1 * X + 0.05 * Y + 0.15 * X * X - 0.04 * X * Y;
}

HeightMap probed_sheet() {
  HeightMap map;
  map.columns = 13, map.rows = 7;
  map.first_mm = {10, 10};
  map.step_mm = {15, 80.0 / 6};
  map.zero_mm = {10, 10};
  map.z_mm.resize(91), map.probed.assign(91, true);
  for (std::size_t i = 0; i < 91; ++i) map.z_mm[i] = sheet(map.at(i)) - sheet({10, 10});
  return map;
}

// Calls `look` at places all along what the file carves, with the tool's Z and the servo's S.
void walk(const std::string& gcode, const std::function<void(const Eigen::Vector3d&, double s)>& look) {
  Eigen::Vector3d at(0, 0, 9);
  double servo = 0;
  std::istringstream lines(gcode);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("M3 S")) servo = std::stod(line.substr(4));
    if (!line.starts_with("G0") && !line.starts_with("G1")) continue;
    Eigen::Vector3d to = at;
    for (int axis = 0; axis < 3; ++axis)
      if (const auto found = line.find("XYZ"[axis]); found != std::string::npos)
        to[axis] = std::stod(line.substr(found + 1));
    if (line.starts_with("G1") && (to - at).head<2>().norm() > 0)
      for (int k = 0; k <= 50; ++k) look(at + k * (to - at) / 50, servo);
    at = to;
  }
}

TEST(DepthBy, EveryBuiltInMakesTheDepth) {
  const TemporaryFolder folder;
  const Scratches s = scratches_in_the_middle(60);
  const std::vector<std::pair<std::string, double>> machines{
      {"grbl", -0.014}, {"grbl-spring", -0.8}, {"linuxcnc", -0.014}, {"marlin", -0.014}, {"laser-z", -0.014}};
  EXPECT_EQ(built_in_machines(), "grbl, grbl-spring, linuxcnc, marlin or laser-z");
  for (const auto& [name, z] : machines) {
    const MachineProfile machine = machine_profile(name);
    EXPECT_EQ(machine.name, name);
    const ToolpathReport report = write_toolpath(s, board_200x100(), nullptr, machine, {}, folder / (name + ".gcode"));
    const std::string text = file_text(report.files.at(0));
    std::size_t looks = 0;
    const double z_wanted = z;
    walk(text, [&](const Eigen::Vector3d& p, double) {
      EXPECT_NEAR(p.z(), z_wanted, 1e-4);
      ++looks;
    });
    EXPECT_EQ(looks, 60u * 51u) << name;
    for (const ReplayedScratch& r : replay_gcode(text, machine, name).scratches) EXPECT_NEAR(r.depth_mm, 0.014, 1e-4);
  }
}

TEST(DepthBy, TablesOfASpringADragBitAndAServoAreInterpolated) {
  const TemporaryFolder folder;
  Scratches s = scratches_in_the_middle(3);
  s.depth_um = {5, 7.5, 16};
  const auto written = [&](const MachineProfile& machine) {
    ToolpathOptions keep;
    keep.keep_order = true;
    return file_text(write_toolpath(s, board_200x100(), nullptr, machine, keep, folder / "board.gcode").files.at(0));
  };
  for (const char* by : {"spring", "drag"}) {
    const MachineProfile machine =
        profile(folder, R"("depth_table": [[5, 0.25], [10, 0.5], [20, 1.5]], "depth_by": ")" + std::string(by) + "\"");
    std::vector<double> z;
    walk(written(machine), [&](const Eigen::Vector3d& p, double) { z.push_back(p.z()); });
    ASSERT_EQ(z.size(), 153u);
    EXPECT_NEAR(z[0], -0.25, 1e-4);
    EXPECT_NEAR(z[51], -0.375, 1e-4);
    EXPECT_NEAR(z[102], -1.1, 1e-4);
    const Replay replay = replay_gcode(written(machine), machine, "x");
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(1e3 * replay.scratches.at(i).depth_mm, s.depth_um[i], 0.01);
  }
  const MachineProfile servo = profile(folder, kServo);
  std::vector<double> command;
  const std::string text = written(servo);
  walk(text, [&](const Eigen::Vector3d& p, double at) {
    EXPECT_EQ(p.z(), servo.safe_z_mm);  // Z stays
    command.push_back(at);
  });
  ASSERT_EQ(command.size(), 153u);
  EXPECT_NEAR(command[0], 500, 0.01);
  EXPECT_NEAR(command[51], 550, 0.01);
  EXPECT_NEAR(command[102], 780, 0.01);
  const Replay replay = replay_gcode(text, servo, "x");
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(1e3 * replay.scratches.at(i).depth_mm, s.depth_um[i], 0.01);
  EXPECT_EQ(replay.min_mm.z(), servo.safe_z_mm);
  const Toolpath path = plan_toolpath(s, board_200x100(), nullptr, servo);
  EXPECT_NEAR(gcode_parts(path, servo)[0].duration_s, path.duration_s, 3);  // the first lift and its way
  s.depth_um = {5, 7.5, 20.4};
  EXPECT_THAT([&] { written(servo); },
              ThrowsMessage<Error>(AllOf(HasSubstr("\"m\""), HasSubstr("20.4 um"), HasSubstr("from 5 to 20 um"))));
}

TEST(DepthBy, ProfilesAreReadAndRefused) {
  const TemporaryFolder folder;
  EXPECT_EQ(profile(folder, R"("based_on": "grbl")").depth_by, DepthBy::fixed_z);  // files of before
  EXPECT_EQ(profile(folder, R"("based_on": "grbl-spring")").depth_by, DepthBy::spring);
  EXPECT_TRUE(profile(folder, R"("based_on": "grbl-spring")").depth_table.assumed);
  const auto own = profile(folder, R"("based_on": "grbl-spring", "depth_table": [[1, 0.1], [2, 0.3]])");
  EXPECT_FALSE(own.depth_table.assumed);
  EXPECT_EQ(profile(folder, R"("based_on": "grbl-spring", "depth_by": "fixed-z")").depth_by, DepthBy::fixed_z);
  EXPECT_TRUE(profile(folder, R"("based_on": "laser-z")").laser);
  EXPECT_EQ(profile(folder, kServo).servo_up, 300);
  const auto refuse = [&](const std::string& fields, const std::string& message) {
    EXPECT_THAT([&] { profile(folder, fields); }, ThrowsMessage<Error>(AllOf(HasSubstr("m.json"), HasSubstr(message))))
        << fields;
  };
  refuse(R"("depth_by": "laser")", "write fixed-z, spring, drag or servo");
  refuse(R"("depth_by": "spring")", "depth_table: is missing, and a depth by spring needs it");
  refuse(R"("depth_table": [[1, 1], [2, 2]])", "is for heads that are pressed");
  const auto table = [&](const std::string& rows, const std::string& message) {
    refuse(R"("depth_by": "spring", "depth_table": )" + rows, message);
  };
  table("[[5, 0.2]]", "at least two rows");
  table("[[5, 0.2], [5, 0.3]]", "depths that do not rise");
  table("[[5, 0.2], [6, 0.2]]", "preload that does not rise");
  table("[[5, -0.2], [6, 0.2]]", "preload that does not rise");
  table("[[0, 0.1], [6, 0.2]]", "a depth of 0 um");
  table("[[5, 0.1], [6, \"soft\"]]", "has a row");
  refuse(R"("depth_by": "servo", "dwell_s": 0.2, "depth_table": [[5, 500], [10, 600], [20, 550]])", "turn back");
  refuse(R"("depth_by": "servo", "depth_table": [[5, 500], [10, 600]])", "dwell_s: is missing: a servo needs time");
  refuse(R"("depth_by": "servo", "dwell_s": 0.2, "servo_up": 520, "depth_table": [[5, 500], [10, 600]])",
         "servo_up: is 520");
  refuse(R"("depth_by": "servo", "dwell_s": 0.2, "based_on": "grbl-spring")", "preloads are no S values");
}

TEST(DepthBy, FaultsOfServosAndBeamsAreNamed) {
  const TemporaryFolder folder;
  const MachineProfile servo = profile(folder, kServo), laser = machine_profile("laser-z");
  const auto expect = [&](const MachineProfile& machine, const std::string& text, const char* message) {
    EXPECT_THAT([&] { replay_gcode(text, machine, "f"); }, ThrowsMessage<Error>(HasSubstr(message))) << text;
  };
  const std::string head = "M3 S300\nG21 G90\nG0 Z1\n";
  expect(servo, "G21 G90\nG0 Z1\n", "before the head was lifted");
  expect(servo, "G28\n", "before the head was lifted");
  expect(servo, head + "M3 S600\nG1 X1 Y1 F600\n", "from a place that is not in the file");
  expect(servo, head + "M3 S300\nG0 X1 Y1\nM3 S600\nG0 X5\nM3 S300\n", "G0 through the metal");
  expect(servo, head + "M3 S300\nG0 X1 Y1\nM3 S600\nG1 X5 F600\n", "head pressed down");
  expect(servo, head + "M3 S400\n", "neither lifts it nor is a depth");
  const MachineProfile output = profile(folder, std::string(kServo) + R"(, "based_on": "linuxcnc", "per_scratch":
          ["G0 X{x0} Y{y0}", "M67 E1 Q{servo}", "G1 X{x1} Y{y1} F{feed}", "M67 E1 Q{servo_up}"])");
  const std::string lifted = "M67 E1 Q300\nG21 G90 G61\nG0 Z1\n";
  const Replay replay =
      replay_gcode(lifted + "G0 X1 Y1\nM67 E1 Q550\nG1 X5 F600\nM68 E1 Q300\nM5\nG1 X9 Y9\n", output, "f");
  ASSERT_EQ(replay.scratches.size(), 1u);
  EXPECT_NEAR(replay.scratches[0].depth_mm, 0.0075, 1e-9);
  EXPECT_EQ(replay.scratches[0].line, 6u);
  // Other outputs than the head's.
  for (const char* line : {"M67 E0 Q550", "M62 P0", "M64 P1", "M3 S300", "M7", "M8"})
    expect(output, lifted + line + "\n", "another output than the one that moves the head");
  expect(servo, head + "M8\n", "another output");
  expect(laser, "M5 S0\n" + head.substr(8) + "M3\n", "turns the laser on");
  expect(laser, "M4 S10\n", "turns the laser on");
  expect(laser, "M5\nG21 G90\nG0 Z1\nG0 X1 Y1 S5\n", "turns the laser on");
  EXPECT_NO_THROW(replay_gcode("M5 S0\nG21 G90\nG0 Z1\nG4 P0.1\n", laser, "f"));
  expect(machine_profile("grbl-spring"), head + "G0 X1 Y1\nG1 Z-2.5 F99\nG1 X3\nG0 Z1\n", "presses harder");
}

// What the beam or a head hangs on is told by the file itself, whatever the profile's blocks leave out or put in.
TEST(DepthBy, ALasersFileTurnsTheBeamOffAndKnowsNoOtherOutputs) {
  const TemporaryFolder folder;
  const auto written = [&](const std::string& fields, bool frame = false) {
    ToolpathOptions options;
    options.frame = frame;
    const MachineProfile machine = profile(folder, fields);
    return file_text(
        write_toolpath(scratches_in_the_middle(3), board_200x100(), nullptr, machine, options, folder / "b.gcode")
            .files.back());
  };
  const auto first_of = [](const std::string& text, const std::vector<std::string>& words) {
    std::size_t first = std::string::npos;
    for (const std::string& word : words) first = std::min(first, text.find("\n" + word));
    return first;
  };
  const std::vector<std::string> moves{"G0", "G1", "G28", "$H"};
  for (const char* start : {R"(["G21 G90", "G0 Z{z_safe}"])", R"(["G28", "G21 G90", "G0 Z{z_safe}"])",
                            R"(["M0", "G21 G90", "G0 Z{z_safe}"])"})
    for (const bool frame : {false, true}) {
      const std::string text =
          written(R"("based_on": "laser-z", "end": ["M2"], "start": )" + std::string(start), frame);
      EXPECT_LT(text.find("\nM5 S0\n"), first_of(text, moves)) << text;
      EXPECT_GT(text.rfind("\nM5 S0\n"), text.rfind("\nG0 ")) << text;
    }
  const std::string marlin = written(R"("based_on": "marlin", "laser": true)");
  EXPECT_LT(marlin.find("\nM5\n"), first_of(marlin, moves));
  EXPECT_LT(marlin.find("\nM107\n"), first_of(marlin, moves));
  // A beam by another output, in any block.
  const auto refuse = [&](const std::string& fields, const char* why) {
    EXPECT_THAT([&] { written(fields); }, ThrowsMessage<Error>(HasSubstr(why))) << fields;
  };
  const std::string modes = R"("G21", "G90", "G0 Z{z_safe} F900")";
  for (const char* code : {"M106 S255", "M280 P0 S30", "M7", "M8", "M300 S440 P10"})
    refuse(R"("based_on": "marlin", "laser": true, "start": [")" + std::string(code) + "\", " + modes + "]",
           "perhaps the beam's");
  for (const char* code : {"M3 S1", "M4"})
    refuse(R"("based_on": "marlin", "laser": true, "start": [")" + std::string(code) + "\", " + modes + "]",
           "turns the laser on");
  for (const char* dialect : {"linuxcnc", "laser-z"})
    for (const char* code : {"M62 P0", "M63 P0", "M64 P0", "M65 P0", "M67 E0 Q1", "M67 E0 Q0", "M68 E0 Q1", "M8"})
      for (const char* block : {"start", "end"})
        EXPECT_THROW(written(R"("laser": true, "based_on": ")" + std::string(dialect) + "\", \"" + block +
                             R"(": ["G21 G90", "G0 Z1", ")" + code + R"("])"),
                     Error)
            << code;
  refuse(R"("based_on": "laser-z", "other_m_codes": [42])", "has M42, which may switch an output");
  refuse(R"("based_on": "laser-z", "other_m_codes": [107, 106])", "has M106");
  EXPECT_EQ(profile(folder, R"("based_on": "laser-z", "other_m_codes": [107, 211])").other_m_codes.size(), 2u);
}

TEST(DepthBy, AServosFileLiftsTheHeadItselfAndPressesByNothingElse) {
  const TemporaryFolder folder;
  const auto written = [&](const std::string& fields) {
    const MachineProfile machine = profile(folder, fields);
    return file_text(
        write_toolpath(scratches_in_the_middle(3), board_200x100(), nullptr, machine, {}, folder / "b.gcode")
            .files.back());
  };
  const auto refuse = [&](const std::string& fields, const char* why) {
    EXPECT_THAT([&] { written(fields); }, ThrowsMessage<Error>(HasSubstr(why))) << fields;
  };
  const std::string marlin =
      R"("based_on": "marlin", "depth_by": "servo", "servo_up": 0, "dwell_s": 0.2, "depth_table": [[5, 100], [20, 900]])";
  EXPECT_LT(written(marlin).find("\nM3 S0\nG4 P200\n"), written(marlin).find("\nG0"));
  const std::string m280 =
      written(marlin + R"(, "per_scratch": ["G0 X{x0} Y{y0} F{rapid}", "M280 P0 S{servo}", "G4 S{dwell_s}",
          "G1 X{x1} Y{y1} F{feed}", "M280 P0 S{servo_up}", "G4 S{dwell_s}"])");
  EXPECT_LT(m280.find("\nM280 P0 S0\n"), m280.find("\nG0"));
  refuse(marlin + R"(, "end": ["M280 P1 S0"])", "another output than the one that moves the head");
  refuse(marlin + R"(, "other_m_codes": [42])", "perhaps its head");

  // A head that goes up by a higher S: no S at all presses it.
  const std::string turned =
      R"("depth_by": "servo", "dwell_s": 0.2, "servo_up": 1000, "depth_table": [[5, 900], [20, 100]])";
  const std::string text = written(turned);
  EXPECT_LT(text.find("\nM3 S1000\n"), text.find("\nG0"));
  EXPECT_EQ(text.find("\nM2"), std::string::npos);
  EXPECT_EQ(text.find("\nM5"), std::string::npos);
  refuse(turned + R"(, "end": ["M5", "G0 X0 Y0", "M2"])", "S0 presses the head");
  refuse(turned + R"(, "end": ["M2"])", "S0 presses the head");
  refuse(turned + R"(, "end": ["M30"])", "S0 presses the head");
  EXPECT_NO_THROW(written(std::string(kServo) + R"(, "end": ["M5", "G0 X0 Y0", "M2"])"));
  // No S is negative, and the deepest row is the farthest from the lifting S.
  refuse(R"("depth_by": "servo", "dwell_s": 0.2, "servo_up": -5, "depth_table": [[5, 100], [20, 900]])",
         "servo_up: is -5.0; write an S from 0");
  refuse(R"("depth_by": "servo", "dwell_s": 0.2, "servo_up": 9, "depth_table": [[5, -100], [20, -900]])",
         "has the S -100.0");
  refuse(R"("depth_by": "servo", "dwell_s": 0.2, "depth_table": [[5, 900], [20, 100]])",
         "servo_up: is 0.0, beyond the deepest row");
}

TEST(DepthBy, AProbedFaceIsFollowedWithinATenthOfTheDepth) {
  const TemporaryFolder folder;
  Scratches s = scratches_in_the_middle(200);
  ToolpathOptions options;
  options.heights = probed_sheet();
  for (const char* name : {"grbl", "linuxcnc", "marlin", "laser-z", "grbl-spring"}) {
    const MachineProfile machine = machine_profile(name);
    const ToolpathReport report = write_toolpath(s, board_200x100(), nullptr, machine, options, folder / "board.gcode");
    EXPECT_TRUE(report.face.followed());
    const std::string text = file_text(report.files.at(0));
    const double wanted = by_preload(machine.depth_by) ? 0.8 : 0.014;
    double worst = 0, lowest = 1, highest = -1;
    walk(text, [&](const Eigen::Vector3d& p, double) {
      const double face = sheet(p.head<2>()) - sheet({10, 10});
      worst = std::max(worst, std::abs(face - p.z() - wanted));
      lowest = std::min(lowest, p.z()), highest = std::max(highest, p.z());
    });
    // The map itself is straight within its cells of 15 mm: a bow of 0.15 mm bends by 0.8 um there.
    EXPECT_LT(worst, 0.0014 + 0.0009) << name;
    EXPECT_GT(highest - lowest, 0.1) << "nothing was followed";
    // The replay finds each scratch whole, at its depth.
    const Face face{options.heights, {}, CarvingLimits().affine, {10, 10}};
    const Replay replay = replay_gcode(text, machine, name, &face);
    ASSERT_EQ(replay.scratches.size(), 200u);
    const Toolpath path = plan_toolpath(s, board_200x100(), nullptr, machine, options);
    EXPECT_TRUE(check_toolpath(replay.scratches, path.scratches, 1e-3, kFollowShare).good());
    EXPECT_NEAR(replay.max_mm.z(), path.first_z_mm, 1e-3);
    EXPECT_THAT(text, AllOf(HasSubstr("Z zero: the face at X10.000 Y10.000"), HasSubstr("G1 Z")));
    EXPECT_LT(report.files.size(), 2u);
  }
}

TEST(DepthBy, AFileThatDoesNotFollowIsFound) {
  const Scratches s = scratches_in_the_middle(40);
  const MachineProfile machine = machine_profile("grbl");
  ToolpathOptions options;
  options.heights = probed_sheet();
  const Toolpath path = plan_toolpath(s, board_200x100(), nullptr, machine, options);
  const std::string text = gcode_parts(path, machine)[0].text;
  EXPECT_THAT([&] { replay_gcode(text, machine, "f"); }, ThrowsMessage<Error>(HasSubstr("f:")));  // as if it were even
  // The same sheet, clamped anew: 20 um higher on the right.
  Face other = path.face;
  for (std::size_t i = 0; i < other.map->z_mm.size(); ++i) other.map->z_mm[i] += 2e-4 * (other.map->at(i).x() - 10);
  std::string found;
  try {
    const Replay replay = replay_gcode(text, machine, "f", &other);
    EXPECT_FALSE(check_toolpath(replay.scratches, path.scratches, 2e-4, kFollowShare).good());
  } catch (const Error& error) {
    found = error.what();
    EXPECT_THAT(found, HasSubstr("f:"));
  }
  // And one that is cut in two files by lines keeps to both limits.
  MachineProfile few = machine;
  few.max_lines = 120;
  for (const GcodePart& part : gcode_parts(path, few))
    EXPECT_LE(std::count(part.text.begin(), part.text.end(), '\n'), 120);
  // Scratches beyond what was probed are refused.
  options.heights->first_mm.x() += 100;
  EXPECT_THAT([&] { plan_toolpath(s, board_200x100(), nullptr, machine, options); },
              ThrowsMessage<Error>(HasSubstr("mm beyond the height map")));
}

TEST(DepthBy, WhatIsLeftAfterAnInterruptionFollowsToo) {
  const TemporaryFolder folder;
  const Scratches s = scratches_in_the_middle(40);
  const MachineProfile machine = machine_profile("grbl");
  ToolpathOptions options;
  options.heights = probed_sheet();
  const ToolpathReport whole = write_toolpath(s, board_200x100(), nullptr, machine, options, folder / "board.gcode");
  const Face face{options.heights, {}, CarvingLimits().affine, {10, 10}};
  const Replay all = replay_gcode(file_text(whole.files[0]), machine, "all", &face);
  ASSERT_EQ(all.scratches.size(), 40u);
  options.after = Interruption{whole.files[0], all.scratches[17].line};
  const ToolpathReport rest = write_toolpath(s, board_200x100(), nullptr, machine, options, folder / "rest.gcode");
  EXPECT_EQ(rest.done_before, 17u);
  const Replay left = replay_gcode(file_text(rest.files[0]), machine, "rest", &face);
  ASSERT_EQ(left.scratches.size(), 23u);
  for (std::size_t i = 0; i < 23; ++i) EXPECT_EQ(left.scratches[i].to_mm, all.scratches[17 + i].to_mm);
}

TEST(DepthBy, AMeasuredBowIsFollowedOnlyWhenAskedFor) {
  const TemporaryFolder folder;
  const Scratches s = scratches_in_the_middle(60);
  const Board board = board_200x100();
  Bench bench;
  bench.material = board.material;
  bench.bow_mm = {0.05, 0.01, -0.03};
  bench.machine_affine << 1.002, 0, 0.4, 0.001, 0.999, -0.2;
  const MachineProfile machine = machine_profile("grbl");
  const auto write = [&](const ToolpathOptions& options) {
    return write_toolpath(s, board, &bench, machine, options, folder / "board.gcode");
  };
  EXPECT_THAT([&] { write({}); },
              ThrowsMessage<Error>(AllOf(HasSubstr("the bow that photos measured"), HasSubstr("14 um deep"),
                                         HasSubstr("burin probe write"), HasSubstr("grbl-spring"))));
  EXPECT_EQ(folder.file_count(), 0u);
  ToolpathOptions options;
  options.follow_bow = true;
  const ToolpathReport report = write(options);
  const Surface bow{board.size_mm, bench.bow_mm};
  double worst = 0;
  walk(file_text(report.files.at(0)), [&](const Eigen::Vector3d& p, double) {
    const double x = 1.002 * p.x() + 0.4, y = 0.001 * p.x() + 0.999 * p.y() - 0.2;  // where it carves
    const double face = height_mm(bow, x, y) - height_mm(bow, 1.002 * 10 + 0.4, 0.01 + 9.99 - 0.2);
    worst = std::max(worst, std::abs(face - p.z() - 0.014));
  });
  EXPECT_LT(worst, 0.0014);
  EXPECT_THAT(sentence(report.findings.at(0)), HasSubstr("right only for that sheet"));
  bench.bow_mm.setZero();
  EXPECT_THAT([&] { write(options); }, ThrowsMessage<Error>(HasSubstr("no measured bow")));
}

TEST(DepthBy, UnevenSheetsAreJudgedByHowTheDepthComesAbout) {
  const Scratches s = scratches_in_the_middle(5);
  Board board = board_200x100();
  const auto findings = [&](const char* name) {
    const MachineProfile machine = machine_profile(name);
    return sheet_findings(plan_toolpath(s, board, nullptr, machine), board, nullptr, machine);
  };
  const auto worst = [&](const char* name) {
    int worst = -1;
    for (const Finding& f : findings(name)) worst = std::max(worst, static_cast<int>(f.severity));
    return worst;
  };
  EXPECT_EQ(worst("grbl"), static_cast<int>(Finding::Severity::warning));  // nobody knows
  EXPECT_THAT(findings("grbl").at(0).what, HasSubstr("the sheet's flatness is unknown"));
  board.flatness_um = 1;
  EXPECT_EQ(worst("grbl"), -1);
  board.flatness_um = 4;
  EXPECT_EQ(worst("grbl"), static_cast<int>(Finding::Severity::warning));
  board.flatness_um = 30;
  for (const char* name : {"grbl", "linuxcnc", "marlin", "laser-z"})
    EXPECT_EQ(worst(name), static_cast<int>(Finding::Severity::error)) << name;
  EXPECT_THAT(findings("grbl").at(0).what, HasSubstr("board.json's flatness_um"));
  // `burin loop` has no --heights.
  EXPECT_THAT(findings("grbl").at(0).remedy, HasSubstr("in a loop: put it into the round's folder as heights.json"));
  // A spring of 15 um a mm makes 0.45 um of it. That its table is a guess is said all the same.
  const std::vector<Finding> spring = findings("grbl-spring");
  ASSERT_EQ(spring.size(), 2u);
  EXPECT_THAT(spring[0].what, HasSubstr("its table is a guess"));
  EXPECT_EQ(spring[1].severity, Finding::Severity::note);
  EXPECT_THAT(spring[1].what, HasSubstr("0.45 um of depth"));
  EXPECT_NEAR(depth_error_mm(machine_profile("grbl-spring"), 0.014, 0.03), 0.00045, 1e-9);
  EXPECT_EQ(depth_error_mm(machine_profile("grbl-spring"), 0.014, 1), 0.014);  // it leaves the metal
  Bench bench;
  bench.material = board.material;
  bench.material.depth_um = 19;
  bench.material_sigma.depth_um = 0.1;
  const MachineProfile machine = machine_profile("grbl-spring");
  const auto measured = sheet_findings(plan_toolpath(s, board, &bench, machine), board, &bench, machine);
  EXPECT_EQ(measured.at(0).severity, Finding::Severity::note);
  EXPECT_THAT(measured[0].what,
              HasSubstr("of 14 um as the guessed table of grbl-spring has them, photos measured 19 um"));
  board.flatness_um = 900;
  EXPECT_EQ(findings("grbl-spring")[1].severity, Finding::Severity::error);
}

}  // namespace
}  // namespace burin
