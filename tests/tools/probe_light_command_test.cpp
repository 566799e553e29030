// `burin probe light` as a person meets it: photos with EXIF in a folder become room.exr with its mask and a picture to
// look at, which a bench can name; what goes wrong is said in a sentence, and nothing is written. That directions and
// light are right is proved by tests/calib/light_probe_test.cpp.
#include <gmock/gmock.h>

#include "burin/base/files/json_file.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench.h"
#include "burin/scene/far_light.h"
#include "tests/calib/mirror_ball_photos.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Brackets of JPEGs from these places in FOLDER/ball, with board.json and camera.cameramodel.
void write_photos(const TemporaryFolder& folder, BallScene scene, const std::vector<std::pair<double, double>>& places,
                  const std::vector<double>& exposure_s) {
  write_board(scene.board, folder / "board.json");
  write_cameramodel(scene.lens, folder / "camera.cameramodel");
  BallExposures how;
  how.as_jpeg = true;
  how.gain = 0.35;
  how.exposure_s = exposure_s;
  Session session;
  for (const auto& [azimuth, elevation] : places) {
    photograph(traced(scene, looking_from(scene, azimuth, elevation, 560)), "IMG_" + std::to_string(how.minute), how,
               folder / "ball", session);
    how.minute += 5;
  }
}

BallScene small_room() {
  BallScene scene;
  scene.lens = {"LENSMODEL_OPENCV4", {1130, 1131, 301, 231, -0.11, 0.08, 0.0006, -0.0004}, 600, 466};
  scene.across = 3;
  scene.across_lamp = 12;
  scene.room.lamps[0].half_angle_deg = 1.5;
  scene.room.lamps[0].radiance = {400, 390, 350};
  return scene;
}

TEST(ProbeLightCommand, PhotosBecomeSurroundings) {
  const TemporaryFolder folder;
  write_photos(folder, small_room(), {{250, 55}, {10, 40}}, {1, 1.0 / 8, 1.0 / 64, 1.0 / 512});
  const Outcome run = run_burin(folder, {"probe", "light", "ball", "--board", "board.json", "--camera",
                                         "camera.cameramodel", "--out", "room.exr"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("stands on the face"), HasSubstr("% of the directions above the face seen"),
                             HasSubstr("azimuth 40."), HasSubstr("elevation 6"), HasSubstr("burin design")));
  EXPECT_TRUE(std::filesystem::exists(folder / "room-seen.png"));
  EXPECT_TRUE(std::filesystem::exists(folder / "room-look.png"));
  const auto panorama = make_panorama(read_picture(folder / "room.exr"), {}, "room.exr");
  EXPECT_EQ(panorama->radiance.width, 2 * panorama->radiance.height);
  // Relative to one another, the light from two sides is the room's.
  const Room room = small_room().room;
  const Eigen::Vector3d a = irradiance(*panorama, direction_of(60, 60)),
                        b = irradiance(*panorama, direction_of(240, 60));
  const double truth = room.irradiance(direction_of(60, 60)).sum() / room.irradiance(direction_of(240, 60)).sum();
  EXPECT_NEAR(a.sum() / b.sum() / truth, 1, 0.06);  // JPEG, small photos, two places
}

TEST(ProbeLightCommand, WithoutBracketsNothingIsWritten) {
  const TemporaryFolder folder;
  write_photos(folder, small_room(), {{250, 55}}, {1});
  const std::size_t files = folder.file_count();
  const Outcome run = run_burin(folder, {"probe", "light", "ball", "--board", "board.json", "--camera",
                                         "camera.cameramodel", "--out", "room.exr"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, AllOf(HasSubstr("IMG_0-0.jpg"), HasSubstr("clipped"), HasSubstr("bracket")));
  EXPECT_EQ(folder.file_count(), files);
}

TEST(ProbeLightCommand, OneWordForEachMishap) {
  const TemporaryFolder folder;
  write_board(probe_board(), folder / "board.json");
  EXPECT_THAT(run_burin(folder, {"probe", "light", "ball", "--board", "board.json", "--out", "room.exr"}).err,
              HasSubstr("there is no such file or folder"));
  EXPECT_THAT(run_burin(folder, {"probe", "light", "ball", "--board", "board.json", "--out", "room.jpg"}).err,
              HasSubstr("room.exr"));
  EXPECT_EQ(run_burin(folder, {"probe", "light", "ball", "--board", "board.json", "--out", "room.exr", "--reflectance",
                               "0.5", "0.6"})
                .exit_code,
            2);
}

}  // namespace
}  // namespace burin
