// Proves: `burin coupon` measures a machine that does not do what its table says. A coupon is written, carved in
// thought and photographed by the point sampler, which shares no formula with what reads the photos; depth and
// roughness of each preload and speed, how well fans repeat, wear and the direction of travel come out within their own
// sigmas and into the machine's file. Photos that cannot tell are told so: too far inside the grooves' reach,
// overexposed, in the face's mirror light, of another coupon.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "burin/optimize/machine_profile.h"
#include "tests/tools/coupon_bench.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// A coupon in the folder's "coupon", photographed into "bench". Few ways to carve: the test's time goes there.
std::vector<CarvedCell> photographed(const TemporaryFolder& folder, const CouponTruth& truth,
                                     const std::vector<std::string>& more = {}) {
  std::vector<std::string> write{"coupon", "write",  "--machine",  "grbl-spring", "--number",
                                 "7",      "--date", "2026-11-22", "--out",       "coupon"};
  write.insert(write.end(), more.begin(), more.end());
  const Outcome written = run_burin(folder, write);
  EXPECT_EQ(written.exit_code, 0) << written.err;
  EXPECT_THAT(written.out, HasSubstr("then: burin coupon read coupon --photos PHOTOS_DIR --machine grbl-spring"));
  const std::vector<CarvedCell> cells = write_coupon_truth(folder.path(), "truth", folder / "coupon", truth);
  const Outcome photos = run_burin(folder, {"simulate", "truth.json", "--out", "bench"});
  EXPECT_EQ(photos.exit_code, 0) << photos.err;
  return cells;
}

TEST(CouponCommand, MeasuresAMachineWithinItsSigmas) {
  const TemporaryFolder folder;
  const CouponTruth truth;
  const std::vector<CarvedCell> cells = photographed(folder, truth);
  const Outcome read = run_burin(folder, {"coupon", "read", "coupon", "--photos", "bench/photos", "--machine",
                                          "grbl-spring", "--out", "mine.json"});
  ASSERT_EQ(read.exit_code, 0) << read.err;
  EXPECT_THAT(read.out, AllOf(HasSubstr("Wrote mine.json: a depth table of"),
                              HasSubstr("next: burin loop PROJECT_DIR --machine mine.json")));
  EXPECT_THAT(read.err, Not(HasSubstr("eight to twelve places")));
  std::cout << read.out;  // the table of docs/results/calibration.md
  const MachineProfile machine = machine_profile((folder / "mine.json").string());
  ASSERT_TRUE(machine.measured.has_value());
  const MachineMeasured& m = *machine.measured;
  ASSERT_EQ(m.cells.size(), cells.size());
  int told = 0, within = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto judge = [&](const std::optional<MeasuredNumber>& number, double is, const char* what) {
      if (!number) return;
      const double z = (number->value - is) / number->sigma;
      ++told;
      within += std::abs(z) < 2;
      EXPECT_LT(std::abs(z), 4) << what << " of cell " << c << ": " << number->value << " +- " << number->sigma
                                << ", is " << is;
      // And worth having: where it is told at all, to a tenth.
      EXPECT_LT(number->sigma, 0.1 * is) << what << " of cell " << c;
    };
    judge(m.cells[c].depth_um, cells[c].depth_um, "depth");
    judge(m.cells[c].alpha, cells[c].alpha, "alpha");
    EXPECT_TRUE(m.cells[c].alpha.has_value());
  }
  EXPECT_GE(told, 28) << read.out;  // of 32; the deepest may lie beyond what three photos see
  EXPECT_GE(within, 0.85 * told) << read.out;
  ASSERT_TRUE(m.repeat_depth && m.wear_depth && m.travel_depth);
  EXPECT_NEAR(m.repeat_depth->value, truth.repeat, 3 * m.repeat_depth->sigma);
  EXPECT_LT(m.repeat_depth->value, 0.05);
  EXPECT_NEAR(m.wear_depth->value, truth.wear, 3 * m.wear_depth->sigma);
  EXPECT_LT(m.wear_depth->sigma, 0.05);
  EXPECT_NEAR(m.travel_depth->value, truth.travel, 3 * m.travel_depth->sigma + 0.002);
  EXPECT_LT(m.travel_depth->sigma, 0.006);
  EXPECT_NEAR(m.travel_towards_deg, truth.travel_towards_deg, 20);
  EXPECT_THAT(read.out, HasSubstr("deeper going towards"));
  // The table's rows are the usual speed's, and say what the built-in table did not: a fifth deeper.
  EXPECT_FALSE(machine.depth_table.assumed);
  EXPECT_NEAR(depth_of_plunge_mm(machine, 1.05), 1e-3 * cells[2].depth_um, 1e-3 * 0.1 * cells[2].depth_um);

  // Another coupon's folder: refused by the tags, and nothing is written.
  ASSERT_EQ(run_burin(folder, {"coupon", "write", "--number", "8", "--out", "other"}).exit_code, 0);
  const Outcome mixed = run_burin(folder, {"coupon", "read", "other", "--photos", "bench/session.json", "--machine",
                                           "grbl-spring", "--out", "other.json"});
  EXPECT_EQ(mixed.exit_code, 1);
  EXPECT_THAT(mixed.err, HasSubstr("shows coupon 7, and other is coupon 8"));
  EXPECT_FALSE(std::filesystem::exists(folder / "other.json"));
  // And a machine that did not carve it.
  EXPECT_THAT(run_burin(folder, {"coupon", "read", "coupon", "--photos", "bench/session.json", "--machine", "grbl",
                                 "--out", "other.json"})
                  .err,
              HasSubstr("give the machine that carved it"));
}

// Each cell's line of the table that is printed.
std::vector<std::string> lines_of_cells(const std::string& out) {
  std::vector<std::string> lines;
  std::istringstream stream(out);
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("  ") && line.find(" 0.") != std::string::npos && line.find("alpha") == std::string::npos)
      lines.push_back(line);
  return lines;
}

TEST(CouponCommand, SaysWhichPhotosCannotTell) {
  const std::vector<std::string> few{"--preloads", "0.6", "1.0", "--feeds", "600"};
  {  // Depths beyond what the photos were meant for: nothing is made up, and the photo that is missing is named.
    const TemporaryFolder folder;
    CouponTruth truth;
    truth.deeper = 2.6;
    truth.pixels = 420;
    photographed(folder, truth, few);
    const Outcome read = run_burin(folder, {"coupon", "read", "coupon", "--photos", "bench/session.json", "--machine",
                                            "grbl-spring", "--out", "mine.json"});
    EXPECT_EQ(read.exit_code, 0) << read.err;
    EXPECT_THAT(read.out, HasSubstr("not determined"));
    EXPECT_THAT(read.err, AllOf(HasSubstr("look inside the grooves' reach"), HasSubstr("add a photo from")));
    EXPECT_THAT(read.err, HasSubstr("no depth table"));
  }
  {  // One long exposure: glints are clipped.
    const TemporaryFolder folder;
    CouponTruth truth;
    truth.exposures_s = {0.007};
    truth.pixels = 420;
    photographed(folder, truth, few);
    const Outcome read = run_burin(folder, {"coupon", "read", "coupon", "--photos", "bench/session.json"});
    EXPECT_THAT(read.err, HasSubstr("overexposed")) << read.out;
    EXPECT_THAT(read.err, HasSubstr("shorter exposures"));
  }
  {  // Cameras near where the face mirrors the lamp, too alike to tell their lens, which is given.
    const TemporaryFolder folder;
    CouponTruth truth;
    truth.mirror = true;
    truth.pixels = 420;
    photographed(folder, truth, few);
    const Outcome read = run_burin(
        folder, {"coupon", "read", "coupon", "--photos", "bench/session.json", "--camera", "truth.cameramodel"});
    EXPECT_EQ(read.exit_code, 0) << read.err;
    EXPECT_THAT(read.err, HasSubstr("mirror image of the lamp"));
    for (const std::string& line : lines_of_cells(read.out)) EXPECT_THAT(line, HasSubstr("not determined"));
  }
}

TEST(CouponCommand, WritesNothingByHalves) {
  const TemporaryFolder folder;
  const Outcome bad = run_burin(folder, {"coupon", "write", "--machine", "grbl", "--preloads", "1", "--out", "coupon"});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "coupon"));
  const Outcome first = run_burin(folder, {"coupon", "write", "--number", "2", "--out", "my coupon"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.err, Not(HasSubstr("carve a coupon"))) << "that is being done";
  const Outcome again = run_burin(folder, {"coupon", "write", "--number", "3", "--out", "my coupon"});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("is there already"));
  const Outcome none = run_burin(folder, {"coupon", "read", "my coupon", "--photos", "nowhere"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("nowhere"));
  EXPECT_EQ(run_burin(folder, {"coupon", "read", "my coupon", "--photos", "x", "--out", "m.json"}).exit_code, 2);
}

}  // namespace
}  // namespace burin
