// Proves: a number that board.json and bench.json both know is one number. A nominal bench may leave it out and then
// has the board's; it may not say another; what photos measured stands, as long as the board is the one that was
// measured; what they did not tell is still the board's. Oracle: the files, written here. And: a camera that cannot see
// a board and a light that cannot reach it are named, others are not.
#include "burin/scene/bench_of_board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "burin/base/error.h"
#include "burin/scene/far_light.h"
#include "burin/scene/lens.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;
using Json = nlohmann::ordered_json;

class BenchOfBoard : public ::testing::Test {
 protected:
  BenchOfBoard() {
    const std::filesystem::path sample = places::source() + "/samples/small-bench";
    std::filesystem::copy_file(sample / "camera.cameramodel", folder_ / "camera.cameramodel");
    board_ = Json::parse(file_text(sample / "board.json"));
    bench_ = Json::parse(file_text(sample / "bench.json"));
    board_["material"] = {{"alpha", 0.05}, {"depth_um", 18}, {"base_alpha", 0.2}};
    bench_["version"] = 2;
    bench_.erase("material");
  }
  Bench read() const {
    const auto board_file = folder_.write("board.json", board_.dump()),
               bench_file = folder_.write("bench.json", bench_.dump());
    return read_bench_of(read_board(board_file), board_file, bench_file);
  }
  void measured(const std::string& name, const char* degree, const char* source = "measured") {
    bench_["verdict"][name] = {{"source", source}, {"degree", degree}};
  }

  TemporaryFolder folder_;
  Json board_, bench_;
};

// The journey: designed for a default, carved with the board's 18 um.
TEST_F(BenchOfBoard, NominalBenchWithoutMaterialHasTheBoards) {
  const Bench bench = read();
  EXPECT_EQ(bench.material.depth_um, 18);
  EXPECT_EQ(bench.material.alpha, 0.05);
  EXPECT_EQ(bench.material.base_alpha, 0.2);
  EXPECT_THAT(bench.findings, IsEmpty());
  bench_["material"] = {{"depth_um", 18}};  // the same is no contradiction, and the rest is the board's
  EXPECT_EQ(read().material.alpha, 0.05);
  board_.erase("material");  // neither says the others: said aloud
  bench_["material"] = {{"depth_um", 10}};
  EXPECT_THAT(read().findings, SizeIs(2));
}

TEST_F(BenchOfBoard, NominalBenchThatSaysAnotherNumberIsRefused) {
  for (const auto& [key, value, before] :
       {std::tuple{"depth_um", 14.0, "18"}, {"alpha", 0.06, "0.05"}, {"base_alpha", 0.15, "0.2"}}) {
    bench_["material"] = {{key, value}};
    EXPECT_THAT([&] { read(); }, ThrowsMessage<Error>(AllOf(HasSubstr("bench.json: material." + std::string(key)),
                                                            HasSubstr("board.json says " + std::string(before)))));
  }
  bench_["material"] = {{"f0", {0.5, 0.92, 0.92}}};
  EXPECT_THAT([&] { read(); }, ThrowsMessage<Error>(HasSubstr("f0[0] is 0.5")));
  board_.erase("material");
  bench_["material"] = {{"depth_um", 14}};
  EXPECT_THAT([&] { read(); }, ThrowsMessage<Error>(HasSubstr("lacks it, which means 10")));
}

TEST_F(BenchOfBoard, WhatPhotosMeasuredStandsForTheBoardThatWasMeasured) {
  bench_["material"] = {{"depth_um", 19.5}, {"alpha", 0.061}, {"base_alpha", 0.3}};
  bench_["material"]["told"] = {{"depth_um", 18}, {"alpha", 0.05}, {"width_um", 400}};
  for (const char* name : {"depth_um", "alpha", "base_alpha"}) measured(name, "determined");
  EXPECT_EQ(read().material.depth_um, 19.5);
  EXPECT_EQ(read().material.base_alpha, 0.3);
  // A board.json that was changed since.
  board_["material"]["depth_um"] = 25;
  EXPECT_THAT([&] { read(); }, ThrowsMessage<Error>(AllOf(HasSubstr("board.json: material.depth_um is 25"),
                                                          HasSubstr("bench.json was measured on a board with 18"))));
  board_["material"]["depth_um"] = 18;
  board_["tool"]["width_um"] = 200;
  EXPECT_THAT([&] { read(); }, ThrowsMessage<Error>(HasSubstr("tool.width_um is 200")));
}

TEST_F(BenchOfBoard, WhatPhotosDidNotTellIsStillTheBoards) {
  bench_["material"] = {{"depth_um", 22.85}, {"alpha", 0.061}};
  bench_["material"]["told"] = {{"depth_um", 18}, {"alpha", 0.05}, {"width_um", 400}};
  measured("alpha", "weakly");
  for (const char* source : {"measured", "assumed"}) {
    measured("depth_um", "not_determined", source);
    const Bench bench = read();
    EXPECT_EQ(bench.material.depth_um, 18) << source;
    EXPECT_EQ(bench.material.alpha, 0.061);
    ASSERT_THAT(bench.findings, SizeIs(1));
    EXPECT_THAT(sentence(bench.findings[0]), HasSubstr("did not determine material.depth_um"));
  }
  board_["material"]["depth_um"] = 25;  // believed otherwise now: it is followed
  EXPECT_EQ(read().material.depth_um, 25);
}

TEST_F(BenchOfBoard, ADepthThatPhotosRefuteIsNotTheBoardsAgain) {
  bench_["material"] = {{"depth_um", 22.85}, {"alpha", 0.061}};
  bench_["material"]["told"] = {{"depth_um", 18}, {"alpha", 0.05}, {"width_um", 400}};
  measured("alpha", "determined");
  measured("depth_um", "not_determined");
  bench_["verdict"]["depth_um"]["causes"] = {{{"cause", "believed_refuted"}, {"believed_um", 18}}};
  EXPECT_EQ(read().material.depth_um, 22.85);
  board_["material"]["depth_um"] = 25;  // believed otherwise now, say by a microscope: it is followed
  EXPECT_EQ(read().material.depth_um, 25);
}

TEST_F(BenchOfBoard, WhatABoardWasToldIsWrittenAndReadAgain) {
  bench_["material"] = {{"told", {{"depth_um", 18}, {"alpha", 0.05}, {"width_um", 400}}}};
  const Bench bench = read();
  write_bench(bench, 400, folder_ / "again.json");
  const Bench again = read_bench(folder_ / "again.json");
  EXPECT_EQ(again.told.depth_um, 18);
  EXPECT_EQ(again.told.alpha, 0.05);
  EXPECT_EQ(again.told.tool_width_um, 400);
}

Board board_200() {
  Board board;
  board.size_mm = board.carve_max_mm = {200, 100};
  return board;
}

// The camera at a place of the board frame, its axes turned so that it looks along `forward`.
View view_from(const Eigen::Vector3d& center_mm, const Eigen::Vector3d& forward) {
  View view;
  view.name = "v00";
  const Eigen::Vector3d z = forward.normalized(), x = z.unitOrthogonal(), y = z.cross(x);
  Eigen::Matrix3d R;
  R << x.transpose(), y.transpose(), z.transpose();
  view.T_camera_board.linear() = R;
  view.T_camera_board.translation() = -R * center_mm;
  return view;
}

TEST(Facing, CamerasThatSeeNothingAreNamed) {
  const Board board = board_200();
  EXPECT_NO_THROW(fail_unless_sees(view_from({100, -300, 400}, {0, 350, -400}), board));
  EXPECT_THAT(
      [&] {
        fail_unless_sees(view_from({100, 50, -400}, {0, 0, 1}), board);
      },
      ThrowsMessage<Error>(HasSubstr("view v00: its camera lies in or behind the board's face")));
  EXPECT_THROW(fail_unless_sees(view_from({500, 50, 0}, {-1, 0, 0}), board), Error);
  EXPECT_THAT(
      [&] {
        fail_unless_sees(view_from({100, -300, 400}, {0, -350, 400}), board);
      },
      ThrowsMessage<Error>(HasSubstr("looks away from the board")));
}

TEST(Facing, LightsThatReachNothingAreNamed) {
  const Board board = board_200();
  Light lamp;
  lamp.position_mm = {100, 500, 600};
  EXPECT_NO_THROW(fail_unless_lights(lamp, board));
  Light below = lamp, dark = lamp;
  below.position_mm.z() = 0;
  dark.intensity.setZero();
  EXPECT_THAT([&] { fail_unless_lights(below, board); }, ThrowsMessage<Error>(HasSubstr("cannot reach")));
  EXPECT_THAT([&] { fail_unless_lights(dark, board); }, ThrowsMessage<Error>(HasSubstr("an intensity of 0")));
  below.also = {dark};
  EXPECT_THROW(fail_unless_lights(below, board), Error);
  below.also = {dark, lamp};
  EXPECT_NO_THROW(fail_unless_lights(below, board));
  Light sun = lamp;
  sun.position_mm.z() = -1;
  sun.far = std::make_shared<FarLight>();
  EXPECT_NO_THROW(fail_unless_lights(sun, board)) << "a far light is judged by its directions";
}

TEST(Facing, ABoardBesideThePictureIsFound) {
  Bench bench;
  bench.lens = nominal_lens(50, 600, 400);
  const Board board = board_200();
  EXPECT_TRUE(is_in_picture(bench, view_from({100, 50, 600}, {0, 0, -1}), board));
  EXPECT_FALSE(is_in_picture(bench, view_from({100, 50, 600}, {1, 0, -0.2}), board));
}

}  // namespace
}  // namespace burin
