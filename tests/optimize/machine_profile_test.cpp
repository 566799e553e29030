// Proves: profiles are found, read with what differs, and refused with a clear sentence; the time of a move has the
// limits that mechanics gives it.
#include "burin/optimize/machine_profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "burin/base/error.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(MachineProfile, BuiltInOnesAreFoundAndOthersNamed) {
  for (const char* name : {"grbl", "grbl-spring", "linuxcnc", "marlin", "laser-z"})
    EXPECT_EQ(machine_profile(name).name, name);
  EXPECT_THAT([] { machine_profile("shapeoko"); },
              ThrowsMessage<Error>(
                  AllOf(HasSubstr("\"shapeoko\""), HasSubstr("grbl, grbl-spring, linuxcnc, marlin or laser-z"))));
}

TEST(MachineProfile, APersonsFileSaysWhatDiffers) {
  const TemporaryFolder folder;
  const auto file = folder.write("router.json", R"({"format": "burin/machine", "version": 1, "based_on": "marlin",
      "carve_feed_mm_min": 900, "dwell_s": 0.05, "decimals": 3, "travel_mm": [[0, 0], [400, 300]], "end": ["M84"]})");
  const MachineProfile machine = machine_profile(file.string());
  EXPECT_EQ(machine.name, "router");
  EXPECT_EQ(machine.dialect, GcodeDialect::marlin);
  EXPECT_EQ(machine.carve_feed_mm_min, 900);
  EXPECT_EQ(machine.rapid_mm_min, machine_profile("marlin").rapid_mm_min);
  EXPECT_EQ(machine.dwell_s, 0.05);
  EXPECT_EQ(machine.travel->max_mm, Eigen::Vector2d(400, 300));
  EXPECT_EQ(machine.end, std::vector<std::string>{"M84"});
  EXPECT_EQ(machine.start, machine_profile("marlin").start);
}

TEST(MachineProfile, WrongValuesAreNamed) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& field, const std::string& message) {
    const auto file = folder.write("m.json", R"({"format": "burin/machine", "version": 1, )" + field + "}");
    EXPECT_THAT([&] { read_machine_profile(file); },
                ThrowsMessage<Error>(AllOf(HasSubstr("m.json"), HasSubstr(message))))
        << field;
  };
  expect(R"("carve_feed_mm_min": 0)", "carve_feed_mm_min: is 0");
  expect(R"("acceleration_mm_s2": -1)", "greater than 0");
  expect(R"("feed_mm_min": 100)", "feed_mm_min: unknown key; did you mean \"carve_feed_mm_min\"?");
  expect(R"("based_on": "mach3")", "grbl, grbl-spring, linuxcnc, marlin or laser-z");
  expect(R"("decimals": 9)", "2 to 6");
  expect(R"("max_lines": 5)", "at least 100");
  expect(R"("dwell_s": -0.1)", "dwell_s: is negative");
  expect(R"("travel_mm": [[10, 0], [0, 10]])", "lower-left");
  expect(R"("start": "G21")", "array of lines");
  expect(R"("start": ["G21\nG90"])", "one line of text");
}

// Machines that home to their far corner count down from there; what they reach is kept from work zero.
TEST(MachineProfile, TravelMayBeAsTheMachineCounts) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& fields) {
    return read_machine_profile(folder.write("m.json", R"({"format": "burin/machine", "version": 1, )" + fields + "}"));
  };
  const auto own = R"("travel_mm": [[-400, -300], [0, 0]], "work_zero_mm": [-380, -270])";
  EXPECT_EQ(read(own).travel->min_mm, Eigen::Vector2d(-20, -30));
  EXPECT_EQ(read(own).travel->max_mm, Eigen::Vector2d(380, 270));
  const auto refuse = [&](const std::string& fields, const std::string& message) {
    EXPECT_THAT([&] { read(fields); }, ThrowsMessage<Error>(AllOf(HasSubstr("m.json"), HasSubstr(message)))) << fields;
  };
  refuse(R"("travel_mm": [[-400, -300], [0, 0]])", "add work_zero_mm");
  refuse(R"("travel_mm": [[-400, 0], [0, 300]])", "add work_zero_mm");
  refuse(R"("travel_mm": [[-400, -300], [0, 0]], "work_zero_mm": [10, 10])", "correct work_zero_mm");
  refuse(R"("work_zero_mm": [10, 10])", "of no use without travel_mm");
  refuse(R"("travel_mm": [[0, 0], [400, 300]], "work_zero_mm": [10])", "work_zero_mm");
}

TEST(MachineProfile, TomlSaysTheSameAsJson) {
  const TemporaryFolder folder;
  const MachineProfile json = read_machine_profile(
      folder.write("router.json", R"({"format": "burin/machine", "version": 1, "name": "r", "based_on": "marlin",
      "carve_feed_mm_min": 900, "dwell_s": 0.05, "decimals": 3, "travel_mm": [[-10, 0], [400, 300]], "force": 350,
      "limits": {"step_mm": 0.0125, "longest_mm": 40, "max_grooves": 3},
      "per_scratch": ["G0 X{x0} Y{y0}", "G1 Z{z_carve}"], "end": ["M84"]})"));
  const MachineProfile toml = read_machine_profile(folder.write("router.toml", R"(# a person's own machine
format = "burin/machine"
version = 1
name = "r"
based_on = "marlin"
carve_feed_mm_min = 9e2
dwell_s = 0.05
decimals = 3
travel_mm = [[-10, 0], [400, 300]]
force = 350
per_scratch = [
  "G0 X{x0} Y{y0}",  # to the start
  'G1 Z{z_carve}',
]
end = ["M84"]

[limits]
step_mm = 0.0125
longest_mm = 40
max_grooves = 3
)"));
  EXPECT_EQ(toml.name, json.name);
  EXPECT_EQ(toml.dialect, json.dialect);
  EXPECT_EQ(toml.carve_feed_mm_min, json.carve_feed_mm_min);
  EXPECT_EQ(toml.rapid_mm_min, json.rapid_mm_min);
  EXPECT_EQ(toml.dwell_s, json.dwell_s);
  EXPECT_EQ(toml.decimals, json.decimals);
  EXPECT_EQ(toml.travel->min_mm, json.travel->min_mm);
  EXPECT_EQ(toml.travel->max_mm, json.travel->max_mm);
  EXPECT_EQ(toml.force, json.force);
  EXPECT_EQ(toml.limits.step_mm, json.limits.step_mm);
  EXPECT_EQ(toml.limits.longest_mm, json.limits.longest_mm);
  EXPECT_EQ(toml.limits.max_grooves, json.limits.max_grooves);
  EXPECT_EQ(toml.start, json.start);
  EXPECT_EQ(toml.per_scratch, json.per_scratch);
  EXPECT_EQ(toml.end, json.end);
}

TEST(MachineProfile, WrongTomlIsNamedByItsLine) {
  const TemporaryFolder folder;
  // Two lines come before what is added.
  const auto expect = [&](const std::string& lines, const std::string& message) {
    const auto file = folder.write("m.toml", "format = \"burin/machine\"\nversion = 1\n" + lines);
    EXPECT_THAT([&] { read_machine_profile(file); }, ThrowsMessage<Error>(HasSubstr(message))) << lines;
  };
  expect("carve_feed_mm_min = 0", "m.toml:3: carve_feed_mm_min: is 0; write a number greater than 0");
  expect("\nfeed_mm_min = 100", "m.toml:4: feed_mm_min: unknown key; did you mean \"carve_feed_mm_min\"?");
  expect("name = \"a\"\n[limits]\nmax_overlap = 1.5", "m.toml:5: limits.max_overlap: is no share of a groove");
  expect("limits = { step_mm = -1 }", "m.toml:3: limits.step_mm: is -1.0");
  expect("limits = 3", "m.toml:3: limits: is 3; write an object");
  expect("dwell_s = nan", "m.toml:3: dwell_s: is not finite");
  expect("travel_mm = [[10, 0], [0, 10]]", "m.toml:3: travel_mm: is [[10.0,0.0],[0.0,10.0]]; write the lower-left");
  expect("start = [\"G21\", 3]", "m.toml:3: start: has an entry that is not one line of text");
  expect("name = 2024-05-01", "m.toml:3:8: name: is a date or a time; write a number");
  expect("decimals = ", "m.toml:3:12: is not TOML: ");
  expect("dwell_s = \xC3\xA9", "m.toml:3:11: is not TOML: ");
  expect(
      "gr\xC3\xB6\xC3\x9F"
      "e = 3",
      "m.toml:3:3: is not TOML: a letter that is not ASCII stands outside of quotes");
  expect("name = \"\xC3\xB6\xC3\x9F\" x", "m.toml:3:13: is not TOML: ");
  expect("name = 'a' @",
         "m.toml:3:12: is not TOML: Error while parsing key-value pair: expected a comment or whitespace, saw '@'");
  expect("dwell_s = 0.1\ndwell_s = 0.2", "m.toml:4:11: is not TOML: ");
  const auto other = folder.write("bench.toml", "version = 1\nformat = \"burin/bench\"\n");
  EXPECT_THAT([&] { read_machine_profile(other); },
              ThrowsMessage<Error>(AllOf(HasSubstr("bench.toml:2: format: is \"burin/bench\""),
                                         HasSubstr("\"burin/machine\" is needed"))));
  EXPECT_THAT([&] { read_machine_profile(folder.write("old.toml", "format = \"burin/machine\"")); },
              ThrowsMessage<Error>(HasSubstr("old.toml: version: is missing")));
}

TEST(MachineProfile, LettersOfAllScriptsAndAtSignsStayInToml) {
  const TemporaryFolder folder;
  const auto name = [&](const std::string& toml) {
    return read_machine_profile(
               folder.write("m.toml", "format = \"burin/machine\"\nversion = 1 # Fr\xC3\xA4se @ home\nname = " + toml))
        .name;
  };
  EXPECT_EQ(name("\"Fr\xC3\xA4se \xE5\x88\xBB\""), "Fr\xC3\xA4se \xE5\x88\xBB");
  EXPECT_EQ(name("'mill@home, @@ @e9 @'"), "mill@home, @@ @e9 @");
  EXPECT_EQ(name("\"\\u00e4 \\u0040 x@\""), "\xC3\xA4 @ x@");
  EXPECT_THAT([&] { name("\"\xC3\""); }, ThrowsMessage<Error>(HasSubstr("name: holds a control character")));
}

TEST(MachineProfile, MovesTakeTheTimeOfATrapezoid) {
  const double feed = 1200, acceleration = 200;  // 20 mm/s, reached after 1 mm
  EXPECT_EQ(move_time_s(0, feed, acceleration), 0);
  EXPECT_NEAR(move_time_s(2, feed, acceleration), 0.2, 1e-12);               // ramps only: 0.1 s up, 0.1 s down
  EXPECT_NEAR(move_time_s(22, feed, acceleration), 0.2 + 20.0 / 20, 1e-12);  // and a second at full speed
  EXPECT_NEAR(move_time_s(0.5, feed, acceleration), 2 * std::sqrt(0.5 / 200), 1e-12);
  EXPECT_NEAR(move_time_s(100, feed, 1e12), 5, 1e-6);  // without inertia: length over speed
  for (double length = 0.1; length < 5; length *= 1.1)
    EXPECT_LT(move_time_s(length, feed, acceleration), move_time_s(1.1 * length, feed, acceleration));
}

}  // namespace
}  // namespace burin
