// Proves: the replay reads G-code as a controller does, finds each fault that would spoil a board, and names the line.
#include "burin/optimize/carving/toolpath_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/render/error.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Replay replay(const std::string& text, const char* machine = "grbl") {
  return replay_gcode(text, machine_profile(machine), "file.nc");
}

constexpr const char* kHead = "G21 G90\nG0 Z1\n";

TEST(Replay, WordsInAnyCaseAndSpacingAreRead) {
  const Replay r = replay(
      "%\n(a comment G91)\nN10 g21g90 ; another\nG0Z1\nG00 X10 Y 20.5\ng1 z-.01 f 300\nX+13Y24.5F600\nG0 Z1 *71\nM117 "
      "Hello (world)\n");
  ASSERT_EQ(r.scratches.size(), 1u);
  EXPECT_EQ(r.scratches[0].from_mm, Eigen::Vector2d(10, 20.5));
  EXPECT_EQ(r.scratches[0].to_mm, Eigen::Vector2d(13, 24.5));
  EXPECT_EQ(r.scratches[0].depth_mm, 0.01);
  EXPECT_EQ(r.scratches[0].line, 7u);
  EXPECT_EQ(r.carve_mm, 5);
  EXPECT_EQ(r.lines, 9u);
}

TEST(Replay, InchesAreInches) {
  const Replay r = replay("G20 G90\nG0 Z1\nG0 X1 Y1\nG1 Z-0.001 F10\nG1 X2 F10\nG0 Z1\n");
  EXPECT_NEAR(r.scratches.at(0).to_mm.x(), 50.8, 1e-12);
  EXPECT_NEAR(r.scratches[0].depth_mm, 0.0254, 1e-12);
}

TEST(Replay, TimeIsTheSumOfTrapezoids) {
  MachineProfile m = machine_profile("grbl");
  const Replay r =
      replay_gcode("G21 G90\nG0 Z1\nG0 X0 Y0\nG0 X100\nG1 Z-0.01 F300\nG4 P0.5\nG1 X110 F1200\nG0 Z1\n", m, "x");
  const double expected =
      move_time_s(100, m.rapid_mm_min, m.acceleration_mm_s2) + move_time_s(1.01, 300, m.acceleration_z_mm_s2) + 0.5 +
      move_time_s(10, 1200, m.acceleration_mm_s2) + move_time_s(1.01, m.rapid_z_mm_min, m.acceleration_z_mm_s2);
  EXPECT_NEAR(r.duration_s, expected, 1e-9);
  EXPECT_EQ(r.travel_mm, 100);
  m.dialect = GcodeDialect::marlin;
  EXPECT_NEAR(replay_gcode("G21 G90\nG4 P500\nG4 S2\n", m, "x").duration_s, 2.5, 1e-12);
}

TEST(Replay, FaultsAreNamedWithTheirLine) {
  const auto expect = [](const std::string& text, const auto& message) {
    EXPECT_THAT([&] { replay(text); }, ThrowsMessage<Error>(message)) << text;
  };
  const std::string head = kHead;
  expect("G0 X1 Y1\n", AllOf(HasSubstr("file.nc:1"), HasSubstr("before units")));
  expect("G21\nG0 X1 Y1\n", HasSubstr("file.nc:2"));
  expect("G21 G90\nG0 X1 Y1\n", HasSubstr("before the tool was lifted"));
  expect(head + "G2 X1 Y1 I1\n", AllOf(HasSubstr("file.nc:3"), HasSubstr("arc")));
  expect(head + "G91\n", HasSubstr("relative"));
  expect(head + "G92 X0\n", HasSubstr("G92"));
  expect(head + "G38.2 Z-5\n", HasSubstr("unknown code G38"));
  expect(head + "G0 X1 Y1\nG1 Z-1 F9\nG0 X5\nG0 Z1\n",
         AllOf(HasSubstr("file.nc:5"), HasSubstr("G0 through the metal")));
  expect(head + "G0 X1 Y1\nG1 X2 Y1 Z-1 F9\n", HasSubstr("at a slant"));
  expect(head + "G0 X1 Y1\nG1 Z-1 F9\nX3 Z-2\n", HasSubstr("changes depth"));
  expect(head + "G0 X1 Y1\nG1 Z-1\n", HasSubstr("without a feed"));
  expect(head + "G0 X1 Y1\nG1 Z-1 F9\n", HasSubstr("ends with the tool in the metal"));
  expect(head + "G0 X1 X2\n", HasSubstr("X stands twice"));
  expect(head + "G0 Xabc\n", HasSubstr("no number after X"));
  expect(head + "G4\n", HasSubstr("without a time"));
  expect(head + "(open\n", HasSubstr("not closed"));
  expect(head + "#1=5\n", HasSubstr("cannot read \"#\""));
  expect("G21 G90\nG0 Z1\nG28 Z0\nG0 X1\n", HasSubstr("before the tool was lifted"));  // home: who knows where that is
}

std::vector<PlannedScratch> planned() {
  std::vector<PlannedScratch> p;
  for (int i = 0; i < 20; ++i)
    p.push_back({static_cast<std::uint32_t>(i), {1.5 * i, 0.1 * i * i}, {1.5 * i + 3, 0.1 * i * i + 1 + i % 3}, 0.01});
  return p;
}

std::vector<ReplayedScratch> carved() {
  std::vector<ReplayedScratch> c;
  for (const PlannedScratch& p : planned()) c.push_back({p.from_mm, p.to_mm, p.depth_mm, 10 + c.size()});
  return c;
}

TEST(ToolpathCheck, GoodInAnyOrderAndFromEitherEnd) {
  auto c = carved();
  std::swap(c[3], c[11]);
  std::swap(c[5].from_mm, c[5].to_mm);
  c[6].from_mm.x() += 0.9e-3;
  const ToolpathCheck check = check_toolpath(c, planned(), 1e-3);
  EXPECT_TRUE(check.good());
  EXPECT_NO_THROW(fail_unless_good(check, "file.nc"));
}

TEST(ToolpathCheck, LostDoubledForeignAndWrongDepth) {
  auto c = carved();
  c.erase(c.begin() + 7);
  c.push_back(c[2]);
  c[4].to_mm.y() += 0.01;
  c[9].depth_mm = 0.1;
  const ToolpathCheck check = check_toolpath(c, planned(), 1e-3);
  EXPECT_EQ(check.lost, 3u);
  EXPECT_EQ(check.doubled, 1u);
  EXPECT_EQ(check.foreign, 2u);
  EXPECT_EQ(check.first_lost, 4u);
  EXPECT_EQ(check.first_foreign_line, 14u);
  EXPECT_THAT([&] { fail_unless_good(check, "file.nc"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("file.nc"), HasSubstr("3 scratches lost (the first in row 5)"),
                                         HasSubstr("1 carved twice"), HasSubstr("2 that were never asked for"))));
}

TEST(ToolpathCheck, TwoPlannedInOnePlaceAreNotOneDoubled) {
  auto p = planned();
  p.push_back(p[3]);
  auto c = carved();
  EXPECT_EQ(check_toolpath(c, p, 1e-3).lost, 1u);
  c.push_back(c[3]);
  EXPECT_TRUE(check_toolpath(c, p, 1e-3).good());
}

TEST(ToolpathCheck, MirroredFilesAreCalledThat) {
  for (const int axis : {0, 1}) {
    auto c = carved();
    for (auto& s : c) s.from_mm[axis] = 100 - s.from_mm[axis], s.to_mm[axis] = 100 - s.to_mm[axis];
    const ToolpathCheck check = check_toolpath(c, planned(), 1e-3);
    EXPECT_EQ(check.mirrored, 20u);
    EXPECT_THAT([&] { fail_unless_good(check, "file.nc"); }, ThrowsMessage<Error>(HasSubstr("is mirrored")));
  }
}

}  // namespace
}  // namespace burin
