// `burin lens` as a person meets it: published calibrations reproduced from the photos and corners behind them, photos
// that do not serve named, what is written. The solve itself: tests/calib/lens_solver_test.
#include <gmock/gmock.h>

#include <filesystem>

#include "burin/base/image.h"
#include "burin/pictures/picture.h"
#include "burin/scene/lens.h"
#include "tests/places.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

double number_after(const std::string& text, const std::string& mark) {
  const auto at = text.find(mark);
  return at == std::string::npos ? -1 : std::stod(text.substr(at + mark.size()));
}

// OpenCV's left01.jpg to left14.jpg: left_intrinsics.yml has f 535.91573 and 0.392591 px RMS a point.
struct LensCommand : ::testing::Test {
  TemporaryFolder folder;
  void SetUp() override {
    const fs::path source = fs::path(places::data()) / "photos/opencv_samples";
    fs::create_directories(folder / "photos");
    for (const auto& entry : fs::directory_iterator(source))
      if (entry.path().filename().string().rfind("left", 0) == 0 && entry.path().extension() == ".jpg")
        fs::copy_file(entry.path(), folder / "photos" / entry.path().filename());
  }
  Outcome run(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"lens",     "photos", "--chessboard", "9x6",
                                       "--square", "25",     "--out",        "mine/camera.cameramodel"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_burin(folder, arguments);
  }
};

TEST_F(LensCommand, ReproducesOpenCvsCalibration) {
  write_picture(Image(640, 480, 1, 0.5F), folder / "photos/wall.png");
  const Outcome lens = run({"--lens-model", "LENSMODEL_OPENCV5"});
  ASSERT_EQ(lens.exit_code, 0) << lens.err;
  EXPECT_THAT(lens.err, AllOf(HasSubstr("wall.png"), HasSubstr("no chessboard with 9 x 6 inner corners")));
  EXPECT_THAT(lens.out, AllOf(HasSubstr("left01.jpg"), HasSubstr("left14.jpg"), HasSubstr("in 13 photos"),
                              HasSubstr("next: burin calibrate")));
  EXPECT_NEAR(number_after(lens.out, "focal lengths "), 535.91573, 0.1);
  EXPECT_NEAR(number_after(lens.out, "corners  "), 0.392591, 0.0005);
  const Lens read = read_cameramodel(folder / "mine/camera.cameramodel");
  EXPECT_EQ(read.model, "LENSMODEL_OPENCV5");
  EXPECT_EQ(read.width, 640);
  EXPECT_NEAR(read.intrinsics[0], number_after(lens.out, "focal lengths "), 5e-4);
  // What is written is what was solved, to the last digit: a second run gives the same file.
  const std::string written = file_text(folder / "mine/camera.cameramodel");
  ASSERT_EQ(run({"--lens-model", "LENSMODEL_OPENCV5"}).exit_code, 0);
  EXPECT_EQ(file_text(folder / "mine/camera.cameramodel"), written);
  EXPECT_THAT(written, ::testing::ContainsRegex("535\\.[0-9]{12}"));
  // The picture shows corners: most of it is paper, some of it is not.
  const Image picture = read_picture(folder / "mine/camera.coverage.png");
  EXPECT_EQ(picture.width, 800);
  int marked = 0;
  for (int i = 0; i < picture.width * picture.height; ++i) marked += picture.data[3 * i + 1] < 0.5F;
  EXPECT_GT(marked, 13 * 54 * 4);
  EXPECT_LT(marked, 13 * 54 * 9 + 1);
}

TEST_F(LensCommand, WindowsThatFitTheSquaresMeasureBetter) {
  const Outcome lens = run({"--corner-window", "0"});
  ASSERT_EQ(lens.exit_code, 0) << lens.err;
  EXPECT_LT(number_after(lens.out, "corners  "), 0.3);
}

TEST_F(LensCommand, RefusesWhatDoesNotServe) {
  const Outcome other = run_burin(
      folder, {"lens", "photos", "--chessboard", "5x4", "--square", "25", "--out", "mine/camera.cameramodel"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("left01.jpg"));
  EXPECT_FALSE(fs::exists(folder / "mine"));
  EXPECT_EQ(run_burin(folder, {"lens", "photos", "--chessboard", "9by6", "--square", "25", "--out", "x"}).exit_code, 2);
  folder.write("corners.vnl", "# filename x y\na.jpg 1 2\n");
  EXPECT_EQ(run_burin(folder, {"lens", "corners.vnl", "--chessboard", "9x6", "--square", "25", "--out", "x"}).exit_code,
            2);
  const Outcome torn = run_burin(folder, {"lens", "corners.vnl", "--chessboard", "9x6", "--square", "25",
                                          "--image-size", "640x480", "--out", "x"});
  EXPECT_EQ(torn.exit_code, 1);
  EXPECT_THAT(torn.err, HasSubstr("corners.vnl"));
}

// mrcal's published 186 views: f 2073.873, 2077.452, 0.5513 px RMS an axis, the board's bow solved for.
TEST(LensCommandOfCorners, ReproducesMrcalsCalibration) {
  const fs::path model = fs::path(places::data()) / "photos/mrcal_docs/opencv8-0.cameramodel";
  if (std::system("/usr/bin/python3 -c 'import mrcal' 2>/dev/null") != 0) GTEST_SKIP() << "python3-mrcal is missing";
  const TemporaryFolder folder;
  ASSERT_EQ(run_shell(folder, "/usr/bin/python3 " + quoted(places::source() + "/tests/calib/mrcal_corners.py") + " " +
                                  quoted(model.string()) + " --vnl > " + quoted((folder / "corners.vnl").string()))
                .exit_code,
            0);
  const Outcome lens =
      run_burin(folder, {"lens", "corners.vnl", "--chessboard", "10x10", "--square", "77", "--image-size", "6016x4016",
                         "--lens-model", "LENSMODEL_OPENCV8", "--bow", "--out", "wide.cameramodel"});
  ASSERT_EQ(lens.exit_code, 0) << lens.err;
  EXPECT_NEAR(number_after(lens.out, "focal lengths "), 2073.873, 0.21);
  EXPECT_NEAR(number_after(lens.out, "px RMS a point, "), 0.5513, 0.0055);
  EXPECT_THAT(lens.out, HasSubstr("in 186 photos"));
  EXPECT_EQ(read_cameramodel(folder / "wide.cameramodel").intrinsics.size(), 12U);
}

}  // namespace
}  // namespace burin
