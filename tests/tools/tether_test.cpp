// Proves: `burin capture --tether` sets exposure times from what photos show until paper and glints are held, writes
// down a session, and leaves the camera as it was, whatever happens; a camera that is held, missing, not at M or pulled
// out is an error that says what to do. Oracle: a camera made of libgphoto2's own functions, defined here
// (tests/tools/fake_gphoto2.h), that exposes a drawn scene: nothing passes without their being called.
#include "tools/tether/tethered_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "burin/capture/session.h"
#include "burin/render/error.h"
#include "tests/temporary_folder.h"
#include "tools/command_line.h"

#ifdef BURIN_GPHOTO2
#include <gphoto2/gphoto2.h>

#include "tests/tools/fake_gphoto2.h"
#endif

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

TEST(Dial, TimesAsCamerasWriteThem) {
  EXPECT_DOUBLE_EQ(seconds_of_dial("1/60"), 1.0 / 60);
  EXPECT_DOUBLE_EQ(seconds_of_dial("1/2.5"), 0.4);
  EXPECT_DOUBLE_EQ(seconds_of_dial("0.0166s"), 0.0166);
  EXPECT_DOUBLE_EQ(seconds_of_dial("0\"4"), 0.4);
  EXPECT_DOUBLE_EQ(seconds_of_dial("30\""), 30);
  EXPECT_DOUBLE_EQ(seconds_of_dial(" 1.3 s"), 1.3);
  EXPECT_DOUBLE_EQ(seconds_of_dial("300/10"), 30);
  for (const char* none : {"Bulb", "bulb", "Auto", "Time", "", "1/0", "-1", "s"})
    EXPECT_EQ(seconds_of_dial(none), 0) << none;
}

#ifdef BURIN_GPHOTO2

struct Tether : testing::Test {
  TemporaryFolder folder;
  FakeCamera& camera = fake_camera();

  Tether() {
    camera = FakeCamera();
    camera.settings["shutterspeed"] = {"1/4",
                                       {"Bulb", "2", "1", "1/2", "1/4", "1/8", "1/15", "1/30", "1/60", "1/125", "1/250",
                                        "1/500", "1/1000", "1/2000", "1/4000", "1/8000"}};
    camera.settings["iso"] = {"Auto", {"Auto", "50", "100", "200"}};
    camera.settings["capturetarget"] = {"Internal RAM", {"Internal RAM", "Memory card"}};
    camera.like.glint = 30;  // at 1/60 s eighteen times white: five stops to 0.56
    camera.scene = drawn(camera.like);
    write_board(camera.like.board, folder / "board.json");
  }

  void capture(std::vector<std::string> more = {}) {
    std::vector<std::string> words{"capture",
                                   "--tether",
                                   "--once",
                                   "--board",
                                   (folder / "board.json").string(),
                                   "--out",
                                   (folder / "out").string()};
    words.insert(words.end(), more.begin(), more.end());
    run_command(words);
  }
  std::vector<double> times() const {
    std::vector<double> out;
    for (const Photo& photo : read_session(folder / "out/session.json").photos) out.push_back(photo.exposure_s);
    return out;
  }
  void expect_as_before() const {
    EXPECT_EQ(camera.settings["shutterspeed"].value, "1/4");
    EXPECT_EQ(camera.settings["iso"].value, "Auto");
    EXPECT_EQ(camera.settings["capturetarget"].value, "Internal RAM");
    EXPECT_EQ(camera.calls.back(), "exit");
  }
};

// It begins at 1/4 s, where the paper is fifteen times white, and finds 1/60 s; -3 stops still clip, -6 do not.
TEST_F(Tether, SetsBracketsByWhatPhotosShow) {
  capture();
  EXPECT_THAT(times(), ElementsAre(testing::DoubleNear(1.0 / 60, 1e-6), testing::DoubleNear(1.0 / 500, 1e-6),
                                   testing::DoubleNear(1.0 / 4000, 1e-7)));
  EXPECT_THAT(camera.calls, IsSupersetOf({"set iso 100", "set capturetarget Memory card", "set shutterspeed 1/60",
                                          "capture 1/60", "capture 1/500", "capture 1/4000"}));
  expect_as_before();
}

TEST_F(Tether, TriesThatShowNothingStayOnTheCard) {
  capture();
  int captured = 0;
  for (const std::string& call : camera.calls) captured += call.starts_with("capture");
  EXPECT_GT(captured, 3);
  std::size_t kept = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder / "out/photos")) ++kept;
  EXPECT_EQ(kept, 3U);
}

TEST_F(Tether, BracketsAsSaid) {
  camera.settings["shutterspeed"].value = "1/8000";  // now it begins in the dark
  capture({"--brackets", "0,-2,-4"});
  EXPECT_THAT(times(), ElementsAre(testing::DoubleNear(1.0 / 60, 1e-6), testing::DoubleNear(1.0 / 250, 1e-6),
                                   testing::DoubleNear(1.0 / 1000, 1e-6)));
  EXPECT_EQ(camera.settings["shutterspeed"].value, "1/8000");
}

TEST_F(Tether, LightThatNoTimeOfTheDialSuitsIsSaid) {
  for (float& v : camera.scene.data) v *= 4000;
  EXPECT_THROW(capture(), Error);  // no photo was of use, so there is no session
  EXPECT_FALSE(std::filesystem::exists(folder / "out/session.json"));
  expect_as_before();
}

TEST_F(Tether, PulledOutMidwayKeepsWhatThereIs) {
  camera.settings["shutterspeed"].value = "1/60";
  EXPECT_THAT(
      [&] {
        camera.photos_left = 2;
        capture();
      },
      ThrowsMessage<Error>(AllOf(HasSubstr("it took no photo (Could not write to the USB port)"),
                                 HasSubstr("check cable and battery"))));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/photos/IMG_0001.JPG"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/photos/IMG_0002.JPG"));
}

TEST_F(Tether, HeldByTheDesktop) {
  camera.init_code = GP_ERROR_IO_USB_CLAIM;
  EXPECT_THAT([&] { capture(); },
              ThrowsMessage<Error>(AllOf(HasSubstr("another program holds it"), HasSubstr("gio mount -s gphoto2"))));
}

TEST_F(Tether, NoCameraOrSeveral) {
  camera.cameras.clear();
  EXPECT_THAT([&] { capture(); }, ThrowsMessage<Error>(HasSubstr("plug it in, switch it on")));
  camera.cameras = {{"Altair M12", "usb:001,004"}, {"Altair M9", "usb:001,007"}};
  EXPECT_THAT([&] { capture(); },
              ThrowsMessage<Error>(AllOf(HasSubstr("usb:001,007 is a Altair M9"), HasSubstr("--port"))));
  EXPECT_THAT([&] { capture({"--port", "usb:009,001"}); }, ThrowsMessage<Error>(HasSubstr("no camera at that port")));
  capture({"--port", "usb:001,007"});
  EXPECT_THAT(camera.calls, testing::Contains("port usb:001,007"));
}

TEST_F(Tether, NotAtM) {
  camera.settings["shutterspeed"].readonly = true;
  EXPECT_THAT([&] { capture(); }, ThrowsMessage<Error>(HasSubstr("turn its dial to M")));
  camera.settings.erase("shutterspeed");
  EXPECT_THAT([&] { capture(); }, ThrowsMessage<Error>(HasSubstr("turn its dial to M")));
  EXPECT_EQ(camera.settings["iso"].value, "Auto");
}

TEST_F(Tether, AllFilesOfAPhotoAndNoneOverwritten) {
  camera.second_file = "IMG_0001.CR2";
  folder.write("photos/IMG_0001.JPG", "of another day");
  TetheredCamera tethered;
  EXPECT_EQ(tethered.model(), "Altair M12");
  EXPECT_THAT(tethered.shutters_s(), SizeIs(15)) << "Bulb is no time";
  EXPECT_DOUBLE_EQ(tethered.set_shutter(0.0155), 1.0 / 60);
  const auto files = tethered.take(folder / "photos");
  EXPECT_THAT(files, ElementsAre(folder / "photos/IMG_0001-2.JPG", folder / "photos/IMG_0001.CR2"));
  EXPECT_EQ(file_text(folder / "photos/IMG_0001.JPG"), "of another day");
  EXPECT_EQ(file_text(folder / "photos/IMG_0001.CR2"), "raw values");
  EXPECT_THROW(tethered.take(folder / "no such folder"), Error);
}

// Enter takes a bracket, q ends: two places, each whole.
TEST_F(Tether, TakesABracketAtEachEnter) {
  folder.write("keys", "\n\nq\n");
  const int before = ::dup(STDIN_FILENO);
  ASSERT_NE(std::freopen((folder / "keys").c_str(), "r", stdin), nullptr);
  run_command({"capture", "--tether", "--board", (folder / "board.json").string(), "--out", (folder / "out").string()});
  ::dup2(before, STDIN_FILENO);
  ::close(before);
  EXPECT_THAT(times(), SizeIs(6));
  expect_as_before();
}

#endif

}  // namespace
}  // namespace burin
