// Proves: board.json is read with its defaults and written back whole; each value out of range is named.
#include "burin/scene/board.h"
#include "tests/places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/base/error.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string board_text(const std::string& fields) {
  return R"({"format": "burin/board", "version": 1)" + (fields.empty() ? "" : ", " + fields) + "}";
}

Board board_of_fields(const std::string& fields) {
  const TemporaryFolder folder;
  return read_board(folder.write("board.json", board_text(fields)));
}

TEST(Board, LeftOutSectionsTakeTheDefaults) {
  const Board board = board_of_fields(R"("size_mm": [200, 100])");
  const TagSet tags;
  EXPECT_EQ(board.carve_min_mm, Eigen::Vector2d(0, 0));
  EXPECT_EQ(board.carve_max_mm, Eigen::Vector2d(200, 100));
  EXPECT_EQ(board.tags.sigma_mm, tags.sigma_mm);
  EXPECT_EQ(board.tags.family, tags.family);
  EXPECT_TRUE(board.scratches.empty());
  EXPECT_EQ(board.tool_width_um, Board().tool_width_um);
  EXPECT_EQ(board.material.f0, Material().f0);
}

TEST(Board, RoundTrip) {
  const TemporaryFolder folder;
  Board board;
  board.size_mm = {300, 200};
  board.carve_min_mm = {30, 31.5};
  board.carve_max_mm = {270, 1.0 / 3 + 150};
  board.tags = {"tag36h11", 0.05, 0.3, 0.8, 0.05, {{3, {15, 15}, 16, 0}, {7, {100.25, 12}, 14.5, -90}}};
  board.scratches = folder / "deep/scratches.csv";
  board.tool_width_um = 512;
  board.material = {0.06, 14.25, 0.2, {0.9, 0.8, 0.7}};
  board.mesh = folder / "board.obj";
  write_board(board, folder / "board.json");
  EXPECT_THAT(file_text(folder / "board.json"), HasSubstr("\"deep/scratches.csv\""));
  const Board back = read_board(folder / "board.json");
  EXPECT_EQ(back.size_mm, board.size_mm);
  EXPECT_EQ(back.carve_min_mm, board.carve_min_mm);
  EXPECT_EQ(back.carve_max_mm, board.carve_max_mm);
  EXPECT_EQ(back.tags.family, "tag36h11");
  EXPECT_EQ(back.tags.z_mm, 0.05);
  EXPECT_EQ(back.tags.sigma_mm, 0.3);
  EXPECT_EQ(back.tags.white_albedo, 0.8);
  EXPECT_EQ(back.tags.black_albedo, 0.05);
  ASSERT_EQ(back.tags.list.size(), 2u);
  EXPECT_EQ(back.tags.list[1].id, 7);
  EXPECT_EQ(back.tags.list[1].center_mm, Eigen::Vector2d(100.25, 12));
  EXPECT_EQ(back.tags.list[1].rotation_deg, -90);
  EXPECT_EQ(back.scratches, board.scratches);
  EXPECT_EQ(back.mesh, board.mesh);
  EXPECT_EQ(back.tool_width_um, 512);
  EXPECT_EQ(back.material.alpha, 0.06);
  EXPECT_EQ(back.material.depth_um, 14.25);
  EXPECT_EQ(back.material.base_alpha, 0.2);
  EXPECT_EQ(back.material.f0, board.material.f0);
}

TEST(Board, ValuesOutOfRangeAreNamed) {
  const auto expect = [](const std::string& fields, const std::string& field, const std::string& what) {
    EXPECT_THAT([&] { board_of_fields(fields); },
                ThrowsMessage<Error>(AllOf(HasSubstr("board.json: " + field), HasSubstr(what))))
        << fields;
  };
  const std::string size = R"("size_mm": [200, 100])";
  expect("", "size_mm", "is missing");
  expect(R"("size_mm": [200, -100])", "size_mm", "-100");
  expect(R"("size_mm": [200, 100, 3])", "size_mm", "2 numbers");
  expect(size + R"(, "carve_mm": [[10, 10], [210, 90]])", "carve_mm", "within the board");
  expect(size + R"(, "carve_mm": [[90, 10], [20, 90]])", "carve_mm", "lower-left");
  expect(size + R"(, "material": {"alpha": 0})", "material.alpha", "above 0 and up to 1");
  expect(size + R"(, "material": {"alpha": 1.2})", "material.alpha", "1.2");
  expect(size + R"(, "material": {"base_alpha": -1})", "material.base_alpha", "roughness");
  expect(size + R"(, "material": {"depth_um": 0})", "material.depth_um", "greater than 0");
  expect(size + R"(, "material": {"f0": [0.9, 2, 0.9]})", "material.f0", "0 to 1");
  expect(size + R"(, "material": {"dept_um": 4})", "material.dept_um", "did you mean \"depth_um\"?");
  expect(size + R"(, "tool": {"width_um": -4})", "tool.width_um", "-4");
  expect(size + R"(, "tool": {"width": 4})", "tool.width", "did you mean \"width_um\"?");
  expect(size + R"(, "tags": {"sigma_mm": 0})", "tags.sigma_mm", "greater than 0");
  expect(size + R"(, "tags": {"white_albedo": 1.5})", "tags.white_albedo", "0 to 1");
  expect(size + R"(, "tags": {"list": [{"id": 1, "center_mm": [5, 5], "size_mm": 0}]})", "tags.list[0].size_mm",
         "greater than 0");
  expect(size + R"(, "tags": {"list": [{"id": 1, "center_mm": [5, 500], "size_mm": 9}]})", "tags.list[0].center_mm",
         "outside");
  expect(size + R"(, "tags": {"list": [{"id": 1, "center_mm": [5, 5], "size_mm": 9},
                                       {"id": 1, "center_mm": [50, 5], "size_mm": 9}]})",
         "tags.list[1].id", "twice");
  expect(size + R"(, "scratch": "s.csv")", "scratch", "did you mean \"scratches\"?");
}

// Oracle: the families' layouts. A tagStandard41h12 of 16 mm is 28.8 mm of paper, printed to its edge; a tag36h11 is
// 20 mm of paper, whose white border of 2 mm two tags may share.
TEST(Board, TagsThatOverlapAreNamed) {
  const auto two = [](const std::string& family, double apart_mm, double turned_deg) {
    return R"("size_mm": [200, 100], "tags": {"family": ")" + family +
           R"(", "list": [{"id": 1, "center_mm": [40, 50], "size_mm": 16},
                {"id": 5, "center_mm": [)" +
           std::to_string(40 + apart_mm) + R"(, 50], "size_mm": 16, "rotation_deg": )" + std::to_string(turned_deg) +
           "}]}";
  };
  EXPECT_EQ(board_of_fields(two("tagStandard41h12", 28.9, 0)).tags.list.size(), 2U);
  EXPECT_THAT([&] { board_of_fields(two("tagStandard41h12", 28.7, 0)); },
              ThrowsMessage<Error>(AllOf(HasSubstr("board.json: tags.list[1]: tag 5 overlaps tag 1"),
                                         HasSubstr("28.8 mm wide"), HasSubstr("1/1.8 of the paper's"))));
  EXPECT_NO_THROW(board_of_fields(two("tag36h11", 18.1, 0)));
  EXPECT_THAT([&] { board_of_fields(two("tag36h11", 17.9, 0)); }, ThrowsMessage<Error>(HasSubstr("overlaps")));
  // A corner reaches further than a side: 14.4 + 14.4 sqrt(2) = 34.8.
  EXPECT_NO_THROW(board_of_fields(two("tagStandard41h12", 34.9, 45)));
  EXPECT_THAT([&] { board_of_fields(two("tagStandard41h12", 34.6, 45)); }, ThrowsMessage<Error>(HasSubstr("overlaps")));
}

TEST(Board, TagCornersStandInAprilTagsOrderAndTurnCounterClockwise) {
  const auto upright = tag_corners_mm({0, {10, 20}, 4, 0});
  EXPECT_TRUE(upright[0].isApprox(Eigen::Vector2d(8, 18)));
  EXPECT_TRUE(upright[1].isApprox(Eigen::Vector2d(12, 18)));
  EXPECT_TRUE(upright[2].isApprox(Eigen::Vector2d(12, 22)));
  EXPECT_TRUE(upright[3].isApprox(Eigen::Vector2d(8, 22)));
  const auto turned = tag_corners_mm({0, {10, 20}, 4, 90});  // its lower left now lies at the lower right
  EXPECT_TRUE(turned[0].isApprox(Eigen::Vector2d(12, 18)));
  EXPECT_TRUE(turned[1].isApprox(Eigen::Vector2d(12, 22)));
}

TEST(Board, TheRigsBoardsAreRead) {
  const std::filesystem::path rigs = std::filesystem::path(places::data()) / "rigs";
  for (const char* name : {"b-small", "bench-loop"}) {
    const Board board = read_board(rigs / name / "board.json");
    EXPECT_EQ(board.tags.list.size(), 20u) << name;
    EXPECT_EQ(board.scratches, (rigs / name / "scratches.csv").lexically_normal());
  }
}

TEST(Board, KeepOutsGoRoundAndAreJudged) {
  const Board board = board_of_fields(R"("size_mm": [100, 100], "keep_out": [
      {"name": "hole", "center_mm": [30, 40], "radius_mm": 5}, {"rect_mm": [[0, 0], [10, 20]]},
      {"polygon_mm": [[50, 50], [60, 50], [55, 60]]}])");
  const TemporaryFolder folder;
  write_board(board, folder / "board.json");
  const Board back = read_board(folder / "board.json");
  ASSERT_EQ(back.keep_out.size(), 3u);
  EXPECT_EQ(back.keep_out[0].name, "hole");
  EXPECT_EQ(back.keep_out[0].radius_mm, 5);
  EXPECT_TRUE(back.keep_out[0].polygon_mm.empty());
  EXPECT_EQ(back.keep_out[1].polygon_mm[2], Eigen::Vector2d(10, 20));
  EXPECT_EQ(back.keep_out[2].polygon_mm.size(), 3u);
  const auto expect = [](const std::string& place, const std::string& what) {
    EXPECT_THAT([&] { board_of_fields(R"("size_mm": [100, 100], "keep_out": [{)" + place + "}]"); },
                ThrowsMessage<Error>(AllOf(HasSubstr("keep_out"), HasSubstr(what))));
  };
  expect(R"("name": "nothing")", "write center_mm and radius_mm, or rect_mm, or polygon_mm");
  expect(R"("center_mm": [1, 1])", "radius_mm");
  expect(R"("center_mm": [1, 1], "radius_mm": 1, "rect_mm": [[0, 0], [1, 1]])", "no more than one");
  expect(R"("rect_mm": [[5, 0], [1, 1]])", "lower-left");
  expect(R"("polygon_mm": [[0, 0], [1, 1]])", "at least three points");
  expect(R"("polygon_mm": [[0, 0], [1, 1], [2, 2]])", "no area");
  expect(R"("polygon_mm": [[0, 0], [10, 10], [10, 0], [0, 11]])", "crosses itself");
  expect(R"("center_mm": [1, 1], "radius_mm": 1, "depth": 3)", "depth");
}

}  // namespace
}  // namespace burin
