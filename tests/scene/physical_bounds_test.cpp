// Proves: numbers that nature does not allow are refused where they are read, with file, field and remedy.
#include "burin/scene/physical_bounds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/base/error.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/scratches.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(PhysicalBounds, OfABoard) {
  const TemporaryFolder folder;
  const auto reads = [&](const std::string& fields) {
    return read_board(
        folder.write("board.json", R"({"format": "burin/board", "version": 1, "size_mm": [120, 120])" + fields + "}"));
  };
  EXPECT_EQ(reads(R"(, "material": {"depth_um": 1000}, "tool": {"width_um": 4000})").material.depth_um, 1000);
  EXPECT_THAT([&] { reads(R"(, "material": {"depth_um": 1e-9})"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("material.depth_um"), HasSubstr("too shallow"))));
  EXPECT_THAT([&] { reads(R"(, "material": {"depth_um": 1e300})"); },
              ThrowsMessage<Error>(HasSubstr("material.depth_um")));
  for (const char* depth : {"1001", "50000", "1e6"})
    EXPECT_THAT([&] { reads(R"(, "material": {"depth_um": )" + std::string(depth) + "}"); },
                ThrowsMessage<Error>(AllOf(HasSubstr("material.depth_um"), HasSubstr("to 1000"))))
        << depth;
  EXPECT_THAT([&] { reads(R"(, "tool": {"width_um": 1e300})"); }, ThrowsMessage<Error>(HasSubstr("tool.width_um")));
  EXPECT_THAT([&] { reads(R"(, "tags": {"z_mm": -1})"); }, ThrowsMessage<Error>(HasSubstr("tags.z_mm")));
  const std::string clamp = R"(, "keep_out": [{"name": "clamp", "rect_mm": [[0, 0], [9, 9]])";
  EXPECT_EQ(reads(clamp + R"(, "height_mm": 12.5}])").keep_out[0].height_mm, 12.5);
  EXPECT_EQ(reads(clamp + "}]").keep_out[0].height_mm, std::nullopt);
  for (const char* height : {"-1", "1e300", "101"})
    EXPECT_THAT([&] { reads(clamp + R"(, "height_mm": )" + height + "}]"); },
                ThrowsMessage<Error>(HasSubstr("height_mm")))
        << height;
  const Board board = reads(clamp + R"(, "height_mm": 12.5}])");
  write_board(board, folder / "again.json");
  EXPECT_EQ(read_board(folder / "again.json").keep_out[0].height_mm, 12.5);
}

TEST(PhysicalBounds, OfABench) {
  const TemporaryFolder folder;
  const auto reads = [&](const std::string& machine, const std::string& board = "{}") {
    return read_bench(folder.write(
        "bench.json", R"({"format": "burin/bench", "version": 2, "camera": {"focal_35mm": 50, "pixels": [900, 700]},
                          "views": [], "lights": [], "machine": )" +
                          machine + R"(, "board": )" + board + "}"));
  };
  EXPECT_NO_THROW(reads(R"({"affine": [[1.02, 0.01, 3], [0, 0.99, -2]], "backlash_mm": [0.3, 0]})"));
  for (const char* affine :
       {"[[0.001, 0, 0], [0, 0.001, 0]]", "[[1, 0, 1e5], [0, 1, 0]]", "[[1, 0, 500], [0, 1, -500]]",
        "[[-1, 0, 0], [0, 1, 0]]", "[[0, 1, 0], [1, 0, 0]]", "[[1, 0, 1e300], [0, 1, 0]]"})
    EXPECT_THAT([&] { reads(R"({"affine": )" + std::string(affine) + "}"); },
                ThrowsMessage<Error>(HasSubstr("machine.affine")))
        << affine;
  for (const char* backlash : {"[1000, 0]", "[-5, 0]", "[0, 1e300]", "[0, 1.01]"})
    EXPECT_THAT([&] { reads(R"({"backlash_mm": )" + std::string(backlash) + "}"); },
                ThrowsMessage<Error>(HasSubstr("machine.backlash_mm")))
        << backlash;
  EXPECT_THAT([&] { reads(R"({"screw_mm": [50, 0], "screw_period_mm": [1e9, 5], "screw_phase_deg": [0, 0]})"); },
              ThrowsMessage<Error>(HasSubstr("screw_")));
  EXPECT_THAT([&] { reads("{}", R"({"bow_mm": [500, 0, 0]})"); }, ThrowsMessage<Error>(HasSubstr("board.bow_mm")));
  EXPECT_NO_THROW(fail_unless_bow_fits({0.5, -0.2, 0.1}, {120, 120}, "x"));
  EXPECT_THAT([&] { fail_unless_bow_fits({50, 0, 0}, {120, 120}, "x"); }, ThrowsMessage<Error>(HasSubstr("bow of 50")));
}

TEST(PhysicalBounds, OfScratches) {
  const TemporaryFolder folder;
  const auto refuses = [&](const std::string& row, const std::string& column) {
    EXPECT_THAT(
        [&] { read_scratches(folder.write("s.csv", "x0_mm,y0_mm,x1_mm,y1_mm,width_um,depth_um\n" + row + "\n")); },
        ThrowsMessage<Error>(AllOf(HasSubstr("s.csv:2"), HasSubstr(column))))
        << row;
  };
  refuses("30,30,35,33,400,20000", "depth_um");
  refuses("30,30,35,33,400,1e300", "depth_um");
  refuses("30,30,35,33,400,1e-9", "depth_um");
  refuses("30,30,35,33,40000,11", "width_um");
  refuses("1e300,30,35,33,400,11", "x0_mm");
  refuses("30,30,35,-1e9,400,11", "y1_mm");
}

}  // namespace
}  // namespace burin
