// Proves: the check before metal moves finds what would spoil a board in the files themselves. One good job, and one
// change at a time that a person or a program could make to it; each is an error that says which.
#include "burin/optimize/toolpath/carve_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/toolpath.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class CarveChecked : public ::testing::Test {
 protected:
  CarveChecked() {
    board_.size_mm = {200, 100};
    board_.carve_min_mm = {20, 20};
    board_.carve_max_mm = {180, 80};
    board_.material.depth_um = 14;
    board_.flatness_um = 1;
    board_.tags.list = {{3, {10, 10}, 8, 0}};
    board_.keep_out = {{"hole", {}, {100, 50}, 5, 0}};
    bench_.material = board_.material;
    // Straight above the middle; the lamp 30 degrees aside.
    View view;
    view.name = "v";
    view.T_camera_board.matrix() << 1, 0, 0, -100, 0, -1, 0, 50, 0, 0, -1, 500, 0, 0, 0, 1;
    bench_.views = {view};
    Light lamp;
    lamp.position_mm = {100 + 500 * std::tan(std::acos(-1) / 6), 50, 500};
    bench_.lights = {lamp};
    spec_.views = {{"v", "lamp", {}, 1}};
    std::mt19937 random(5);
    std::uniform_real_distribution<double> x(22, 178), y(22, 42), step(-2, 2);
    for (int i = 0; i < 100; ++i) {
      scratches_.x0_mm.push_back(x(random)), scratches_.y0_mm.push_back(y(random));
      scratches_.x1_mm.push_back(scratches_.x0_mm[i] + step(random));
      scratches_.y1_mm.push_back(scratches_.y0_mm[i] + step(random));
    }
  }

  CarveCheckInput written(const std::string& machine = "grbl", const ToolpathOptions& options = {}) {
    const auto file = folder_ / "board.gcode";
    ToolpathOptions with_frame = options;
    with_frame.frame = true;
    const ToolpathReport report =
        write_toolpath(scratches_, board_, &bench_, machine_profile(machine), with_frame, file);
    CarveCheckInput input{report.files, machine_profile(machine), board_};
    input.bench = bench_;
    input.scratches = scratches_;
    input.design = spec_;
    return input;
  }

  // The file with one text in it replaced by another.
  void change(const std::string& from, const std::string& to) {
    std::string text = file_text(folder_ / "board.gcode");
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    folder_.write("board.gcode", text.replace(at, from.size(), to));
  }

  // Lines of the first scratch.
  std::string first_scratch() const {
    const std::string text = file_text(folder_ / "board.gcode");
    const auto begin = text.find("G0 X"), end = text.find("G0 X", begin + 1);
    return text.substr(begin, end - begin);
  }

  static std::string errors(const CarveCheck& check) {
    std::string lines;
    for (const Finding& f : check.findings)
      if (f.severity == Finding::Severity::error) lines += sentence(f) + "\n";
    return lines;
  }

  TemporaryFolder folder_;
  Board board_;
  Bench bench_;
  DesignSpec spec_;
  Scratches scratches_;
};

TEST_F(CarveChecked, AGoodJobHasNoError) {
  bench_.machine_affine << 1.001, 0, 0.2, 0, 0.999, -0.1;
  const CarveCheck check = check_carve(written());
  EXPECT_EQ(errors(check), "");
  EXPECT_TRUE(check.faulty.empty());
  ASSERT_EQ(check.files.size(), 2u);
  EXPECT_EQ(check.files[0].scratches, 100u);
  EXPECT_EQ(check.files[1].scratches, 0u);  // the frame
  EXPECT_NEAR(check.least_depth_um, 14, 0.1);
  EXPECT_NEAR(check.tool_min_mm.z(), -0.014, 1e-9);
  EXPECT_EQ(check.views.at(0).scratches, 100u);
  EXPECT_EQ(check.views.at(0).dark, 0);
  // Where they will lie, not where the machine is told.
  double worst = 1;
  for (std::size_t i = 0; i < 100; ++i) worst = std::min(worst, std::abs(check.carved.x0_mm[i] - scratches_.x0_mm[0]));
  for (std::size_t i = 0; i < 100; ++i) worst = std::min(worst, std::abs(check.carved.x1_mm[i] - scratches_.x0_mm[0]));
  EXPECT_LT(worst, 1e-3);
  for (const char* machine : {"grbl-spring", "linuxcnc", "marlin", "laser-z"})
    EXPECT_EQ(errors(check_carve(written(machine))), "") << machine;
}

// Nobody measured what crossings leave, and many grooves cross: a word of it. Not of few, nor where it is known.
TEST_F(CarveChecked, ACrowdedBoardThatCountsOnLightOfGroovesThatCross) {
  const auto told = [](const CarveCheck& check) {
    return std::any_of(check.findings.begin(), check.findings.end(),
                       [](const Finding& f) { return f.what.find("where two cross") != std::string::npos; });
  };
  EXPECT_FALSE(told(check_carve(written())));
  std::mt19937 random(6);
  std::uniform_real_distribution<double> x(22, 178), y(22, 42);
  for (int i = 0; i < 700; ++i) {
    scratches_.x0_mm.push_back(x(random)), scratches_.y0_mm.push_back(y(random));
    scratches_.x1_mm.push_back(x(random)), scratches_.y1_mm.push_back(y(random));
  }
  EXPECT_TRUE(told(check_carve(written())));
  bench_.crossings = Crossings::deepest;
  EXPECT_FALSE(told(check_carve(written())));
}

// The shortest way takes half of the scratches backwards, which backlash meets from the other side.
TEST_F(CarveChecked, BacklashIsUndoneEitherWay) {
  bench_.machine_errors.backlash_mm << 0.05, 0.08;
  bench_.machine_errors.screw_sin_mm << 0.01, 0.02;
  ToolpathOptions short_way;
  short_way.keep_order = false;
  const CarveCheckInput input = written("grbl", short_way);
  EXPECT_EQ(errors(check_carve(input)), "");
  // Without backlash the files are others.
  CarveCheckInput even = input;
  even.bench->machine_errors.backlash_mm.setZero();
  EXPECT_THAT(errors(check_carve(even)), HasSubstr("scratches lost"));
}

TEST_F(CarveChecked, OverATag) {
  const CarveCheckInput input = written();
  change(first_scratch(), "G0 X12 Y12\nG1 Z-0.014 F300\nG1 X15 Y13 F1200\nG0 Z1\n");
  const CarveCheck check = check_carve(input);
  EXPECT_THAT(errors(check), AllOf(HasSubstr("1 scratch would be carved over tag 3"), HasSubstr("(12.00, 12.00)"),
                                   HasSubstr("never asked for"), HasSubstr("leave the carve area")));
  EXPECT_EQ(check.faulty.size(), 1u);
  // Also where the table asks for it: the tag is one that the design did not know.
  CarveCheckInput other = written();
  other.board.tags.list.push_back({8, {scratches_.x0_mm[4], scratches_.y0_mm[4]}, 4, 0});
  other.board.carve_min_mm = {0, 0};
  EXPECT_THAT(errors(check_carve(other)), HasSubstr("over tag 8"));
}

TEST_F(CarveChecked, OverAKeepOutOnlyWithAGroovesWidth) {
  // 5 mm of hole, half a groove of 52 um: 5.06 mm off is free, 5.04 is not.
  scratches_.x0_mm = {90}, scratches_.x1_mm = {110}, scratches_.y0_mm = {50}, scratches_.y1_mm = {50};
  const auto at = [&](double off) {
    scratches_.y0_mm = {50 + off}, scratches_.y1_mm = {50 + off};
    return errors(check_carve(written()));
  };
  EXPECT_EQ(at(5.06), "");
  CarveCheckInput input = written();
  change("Y55.0600", "Y55.0400");
  change("Y55.0600", "Y55.0400");
  EXPECT_THAT(errors(check_carve(input)), HasSubstr("over hole"));
}

TEST_F(CarveChecked, OffTheSheet) {
  const CarveCheckInput input = written();
  change(first_scratch(), "G0 X198 Y50\nG1 Z-0.014 F300\nG1 X201 Y50 F1200\nG0 Z1\n");
  EXPECT_THAT(errors(check_carve(input)), HasSubstr("1 scratch would run off the sheet"));
  // A map that the file does not know of: carved 25 mm lower than told.
  CarveCheckInput moved = written();
  moved.scratches.reset();
  moved.bench->machine_affine(1, 2) = -45;
  EXPECT_THAT(errors(check_carve(moved)), HasSubstr("run off the sheet"));
}

TEST_F(CarveChecked, DepthUnderTheBow) {
  board_.flatness_um.reset();
  const CarveCheckInput flat = written();
  CarveCheckInput bowed = flat;
  bowed.bench->bow_mm = {0.03, 0, 0.02};
  EXPECT_EQ(errors(check_carve(flat)), "");
  EXPECT_THAT(check_carve(flat).findings,
              Contains(Field(&Finding::what, HasSubstr("the sheet's flatness is unknown"))));
  EXPECT_THAT(errors(check_carve(bowed)),
              AllOf(HasSubstr("a fixed Z is to carve 14 um deep"), HasSubstr("burin probe")));
  bowed = written("grbl-spring");
  bowed.bench->bow_mm = {0.03, 0, 0.02};
  EXPECT_EQ(errors(check_carve(bowed)), "");
}

TEST_F(CarveChecked, BeyondTheCutOff) {
  board_.material.depth_um = bench_.material.depth_um = 2;
  board_.flatness_um = 0.1;
  const CarveCheck check = check_carve(written());
  EXPECT_THAT(errors(check), AllOf(HasSubstr("view v: "), HasSubstr("beyond the cut-off"),
                                   HasSubstr("um deep with this cutter (now 2.0 um): --depth ")));
  EXPECT_GT(check.views.at(0).dark, 0.5);
}

TEST_F(CarveChecked, OtherScratchesThanDesigned) {
  const CarveCheckInput input = written();
  const std::string good = file_text(folder_ / "board.gcode");
  change(first_scratch(), "");
  EXPECT_THAT(errors(check_carve(input)), HasSubstr("1 scratch lost"));
  folder_.write("board.gcode", good);
  change("Z-0.0140", "Z-0.0240");
  EXPECT_THAT(errors(check_carve(input)), HasSubstr("never asked for"));  // too deep
  folder_.write("board.gcode", good);
  EXPECT_EQ(errors(check_carve(input)), "");
  CarveCheckInput half = input;
  half.files.insert(half.files.begin(), half.files[0]);
  EXPECT_THAT(errors(check_carve(half)), HasSubstr("carved twice"));
}

TEST_F(CarveChecked, FilesThatCannotBeFollowed) {
  CarveCheckInput input = written();
  change("G1 X", "G2 X");
  EXPECT_THAT(errors(check_carve(input)), HasSubstr("has an arc"));
  input.files = {folder_ / "none.gcode"};
  EXPECT_THAT(errors(check_carve(input)), HasSubstr("none.gcode"));
  input.files.clear();
  EXPECT_THAT([&] { check_carve(input); }, ThrowsMessage<Error>(HasSubstr("no G-code")));
  input = written();
  input.files.erase(input.files.begin());
  EXPECT_THAT(errors(check_carve(input)), HasSubstr("carve nothing"));
}

TEST_F(CarveChecked, WhatWasMendedIsCompared) {
  MachineProfile machine = machine_profile("grbl");
  machine.limits.shortest_mm = 1;
  const Mended mended = mend(scratches_, toolpath_limits(board_, &bench_, machine));
  ToolpathOptions options;
  const ToolpathReport report =
      write_toolpath(mended.scratches, board_, &bench_, machine, options, folder_ / "board.gcode");
  CarveCheckInput input{report.files, machine, board_};
  input.bench = bench_;
  input.scratches = scratches_;
  const CarveCheck check = check_carve(input);
  EXPECT_EQ(errors(check), "");
  EXPECT_THAT(sentence(check.findings.at(0)), HasSubstr("as the machine's limits let them"));
  change(first_scratch(), "");
  EXPECT_NE(errors(check_carve(input)), "");
}

TEST_F(CarveChecked, TheFrameGoesRoundTheseScratches) {
  CarveCheckInput input = written();
  const auto says = [&](const char* words) {
    for (const Finding& f : check_carve(input).findings)
      if (f.what.find(words) != std::string::npos) return true;
    return false;
  };
  EXPECT_FALSE(says("frame"));
  EXPECT_FALSE(says("goes round"));
  std::string text = file_text(folder_ / "board-frame.gcode");
  for (std::size_t at = 0; (at = text.find("G1 X1")) != std::string::npos;) text.replace(at, 5, "G1 X");
  folder_.write("board-frame.gcode", text);  // a hundred mm short
  EXPECT_TRUE(says("goes round another job"));
  input.files.pop_back();
  EXPECT_TRUE(says("no frame"));
}

TEST_F(CarveChecked, WhatTheMachineCannotReach) {
  CarveCheckInput input = written();
  input.machine.travel = MachineBounds{{0, 0}, {150, 100}};
  EXPECT_THAT(errors(check_carve(input)), HasSubstr("out of the machine's travel"));
  input = written();
  input.board.tags.z_mm = 1.5;
  EXPECT_THAT(errors(check_carve(input)),
              AllOf(HasSubstr("travels 1.00 mm above the face"), HasSubstr("1.50 mm thick")));
  input.board.tags.z_mm = 0.5;
  EXPECT_EQ(errors(check_carve(input)), "");
}

TEST_F(CarveChecked, AHeightMapIsPartOfWhatIsReplayed) {
  HeightMap map;
  map.columns = 3, map.rows = 3;
  map.first_mm = {20, 20};
  map.step_mm = {80, 30};
  map.zero_mm = {20, 20};
  map.z_mm = {0, 0.05, 0.07, 0.02, 0.06, 0.08, 0.01, 0.03, 0.05};
  map.probed.assign(9, true);
  ToolpathOptions options;
  options.heights = map;
  board_.flatness_um = 80;
  CarveCheckInput input = written("grbl", options);
  input.heights = map;
  EXPECT_EQ(errors(check_carve(input)), "");
  input.heights.reset();  // forgotten
  EXPECT_NE(errors(check_carve(input)), "");
  input.heights = map;
  input.heights->z_mm[4] += 0.01;  // another sheet
  EXPECT_NE(errors(check_carve(input)), "");
}

}  // namespace
}  // namespace burin
