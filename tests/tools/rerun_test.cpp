// Proves: the sentence about a rerun says what the numbers say; both boards are looked at with all that the bench as it
// is knows of its grooves and machine. Oracle: scratches that carry by themselves what the bench's field says of them.
#include "tools/report/rerun.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/image.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/groove_field.h"
#include "burin/scene/scratches.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string told(const std::vector<Finding>& findings) {
  std::string out;
  for (const Finding& f : findings) out += sentence(f) + "\n";
  return out;
}

TEST(Rerun, SaysWhereItPaysAndWhyElsewhereNot) {
  const std::vector<RerunView> good{{"d0", 24, 16, 24.5, 24}, {"d1", 22, 17, 22, 21.1}};
  EXPECT_EQ(rerun_sentence(good),
            "Designing again for the measured bench gains 6.1 dB on average (d0 +8.0 dB, d1 +4.1 dB).");
  EXPECT_THAT(rerun_findings(good), IsEmpty());
  // Nothing was lost to begin with.
  const std::vector<RerunView> little{{"d0", 24, 16, 24.5, 24}, {"d1", 20, 21.1, 21.5, 21.4}};
  EXPECT_THAT(rerun_sentence(little), HasSubstr("gains 4.1 dB on average"));
  EXPECT_EQ(told(rerun_findings(little)),
            "view d1 had little to regain: the first design promised it 20.0 dB, seen were 21.1 dB\n");
  // Much was lost, and the bench as it is does not give it back; or the measured bench is still wrong.
  const std::vector<RerunView> dark{{"d1", 24, 16, 18, {}}}, wrong{{"d1", 24, 16, 23, 19}},
      worse{{"d1", 24, 16, 15, {}}};
  EXPECT_THAT(told(rerun_findings(dark)), HasSubstr("view d1: the believed bench cost it 8.0 dB (promised 24.0, seen "
                                                    "16.0), and the second design regains 2.0 dB of them"));
  EXPECT_THAT(told(rerun_findings(wrong)),
              HasSubstr("view d1 still loses 4.0 dB to what the measured bench does not know"));
  EXPECT_THAT(rerun_sentence(worse), HasSubstr("loses 1.0 dB on average"));
  EXPECT_THAT(told(rerun_findings(worse)), HasSubstr("regains none of them"));
}

// Two designs for the sample's bench, made by hand; the first never changes.
class RerunOfTwoBoards : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path sample = places::source() + "/samples/small-bench";
    std::filesystem::copy(sample, folder_ / "bench", std::filesystem::copy_options::recursive);
    board_ = read_board(folder_ / "bench" / "board.json");
    under_ = read_bench(folder_ / "bench" / "bench.json");
    std::mt19937 random(7);
    std::uniform_real_distribution<double> at(30, 90), by(-4, 4);
    for (int i = 0; i < 400; ++i) {
      const double x = at(random), y = at(random);
      scratches_.x0_mm.push_back(x), scratches_.x1_mm.push_back(x + by(random));
      scratches_.y0_mm.push_back(y), scratches_.y1_mm.push_back(y + by(random));
    }
    write_design("first", scratches_);
  }

  // As burin design leaves it, made for grooves 11 um deep.
  void write_design(const std::string& name, const Scratches& scratches,
                    const std::string& machine = R"({"affine": [[1, 0, 0], [0, 1, 0]]})") const {
    folder_.write(name + "/design-report.json", R"({"format": "burin/design-report", "version": 1,
      "views": [{"view": "d0", "light": "lamp", "target": "target.png", "psnr_db": 20}],
      "bench": {"depth_um": 11, "alpha": 0.04, "machine": )" +
                                                    machine + "}}");
    Image target(64, 64, 1);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) target.at(x, y) = static_cast<float>(x) / 63;
    write_picture(target, folder_ / name / "target.png");
    write_scratches(scratches, folder_ / name / "scratches.csv");
  }

  // What the page shows of the second board under a bench: its picture, encoded.
  std::string seen(const Bench& under) const {
    write_bench(under, board_.tool_width_um, folder_ / "bench" / "under.json");
    const Section section = rerun_section(
        {folder_ / "first", folder_ / "second", folder_ / "bench" / "under.json", folder_ / "bench" / "board.json"},
        {});
    const std::size_t begin = section.pictures.rfind("<img");
    return section.pictures.substr(begin, section.pictures.find('>', begin) - begin);
  }

  TemporaryFolder folder_;
  Board board_;
  Bench under_;
  Scratches scratches_;
};

TEST_F(RerunOfTwoBoards, AreSeenWithTheFieldsOfTheBenchAsItIs) {
  under_.material.depth_um = 15;
  write_design("second", scratches_);
  const std::string plain = seen(under_);
  ASSERT_EQ(seen(under_), plain);  // nothing else changes the picture
  Bench with_field = under_;
  with_field.depth_field.terms = {1.6, 0.2, 0, 0, 0, 0};
  EXPECT_NE(seen(with_field), plain);
  Bench rougher = under_;
  rougher.alpha_field.terms = {0.5, 0, 0, 0, 0, 0};
  EXPECT_NE(seen(rougher), plain);
  Bench worn = under_;
  worn.depth_field.terms = {0, 0, 0, 0, 0, 0.5};
  EXPECT_NE(seen(worn), plain);
}

TEST_F(RerunOfTwoBoards, AreSeenThroughTheMachineAndTheCrossingsOfTheBenchAsItIs) {
  write_design("second", scratches_);
  const std::string plain = seen(under_);
  Bench moved = under_;
  moved.machine_affine.col(2) << 0.3, 0;
  EXPECT_NE(seen(moved), plain);
  Bench last = under_;
  last.crossings = Crossings::last;
  EXPECT_NE(seen(last), plain);
}

// What a design's bench knew of the machine, its tool path has compensated: then the board is as it was designed.
TEST_F(RerunOfTwoBoards, TheSecondCompensatesWhatItsBenchKnewOfTheMachine) {
  write_design("second", scratches_);
  const std::string plain = seen(under_);
  Bench loose = under_;
  loose.machine_errors.backlash_mm << 0.3, 0.2;
  EXPECT_NE(seen(loose), plain);
  write_design("second", scratches_, R"({"affine": [[1, 0, 0], [0, 1, 0]], "backlash_mm": [0.3, 0.2]})");
  EXPECT_EQ(seen(loose), plain);
}

// Lamps of three colors instead of the one, and a target in color: red from left to right, blue the other way.
class RerunInColor : public RerunOfTwoBoards {
 protected:
  void SetUp() override {
    RerunOfTwoBoards::SetUp();
    Light lamp = under_.lights.front();
    under_.lights.clear();
    for (int c = 0; c < 3; ++c) {
      lamp.id = kNames[static_cast<std::size_t>(c)];
      lamp.position_mm.x() += 30;
      lamp.intensity = Eigen::Vector3d::Unit(c);
      under_.lights.push_back(lamp);
    }
    write_color("first", "[1, 1, 1]");
  }
  void write_color(const std::string& name, const std::string& white_gain, int channels = 3) const {
    write_design(name, scratches_);
    folder_.write(name + "/design-report.json", R"({"format": "burin/design-report", "version": 1,
      "views": [{"view": "d0", "light": "red + green + blue", "target": "target.png", "psnr_db": 20,
                 "color": {"white_gain": )" + white_gain +
                                                    R"(}}],
      "bench": {"depth_um": 11, "alpha": 0.04, "machine_affine": [[1, 0, 0], [0, 1, 0]]}})");
    Image target(64, 64, channels, 0.3F);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        target.at(x, y, 0) = static_cast<float>(x) / 63;
        target.at(x, y, channels - 1) = static_cast<float>(63 - x) / 63;
      }
    write_picture(target, folder_ / name / "target.png");
  }
  static constexpr std::array<const char*, 3> kNames{"red", "green", "blue"};
};

TEST_F(RerunInColor, BothBoardsAreSeenInTheirColorsByTheWhiteOfTheSecond) {
  write_color("second", "[1, 1, 1]");
  const std::string plain = seen(under_);
  write_color("first", "[3, 1, 1]");  // what was white on the bench as it was believed to be says nothing of this one
  EXPECT_EQ(seen(under_), plain);
  write_color("second", "[2, 0.5, 0.5]");
  EXPECT_NE(seen(under_), plain);
  write_color("second", "[1, 1, 1]");
  std::swap(under_.lights[0].intensity, under_.lights[2].intensity);  // as bright, in other colors
  EXPECT_NE(seen(under_), plain);
}

TEST_F(RerunInColor, RefusesDesignsOfWhichOneIsInGray) {
  const auto refused = [&](const std::string& what) {
    EXPECT_THAT([&] { seen(under_); }, ::testing::ThrowsMessage<Error>(HasSubstr(what)));
  };
  write_color("second", "[1, 1, 1]", 1);
  refused("has 1 channels");
  write_color("second", "[1, 1, 1]");
  folder_.write("first/design-report.json", R"({"format": "burin/design-report", "version": 1,
      "views": [{"view": "d0", "light": "red + green + blue", "target": "target.png", "psnr_db": 20}],
      "bench": {"depth_um": 11, "alpha": 0.04, "machine_affine": [[1, 0, 0], [0, 1, 0]]}})");
  refused("in gray, and the design after it in color");
}

}  // namespace
}  // namespace burin
