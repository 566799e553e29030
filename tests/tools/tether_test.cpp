// Proves: `burin capture --tether` sets exposure times from what photos show until paper and glints are held, writes
// down a session, and leaves the camera as it was, whatever happens; a camera that is held, missing, not at M or pulled
// out is an error that says what to do. Oracle: a camera made of libgphoto2's own functions, defined here
// (tests/tools/fake_gphoto2.h), that exposes a drawn scene: nothing passes without their being called.
#include "tools/tether/tethered_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

#include "burin/base/error.h"
#include "burin/capture/exif.h"
#include "burin/capture/session.h"
#include "tests/temporary_folder.h"
#include "tools/command_line.h"

#ifdef BURIN_GPHOTO2
#include <fmt/format.h>
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
    camera.settings["imageformat"] = {"Large Fine JPEG", {"Large Fine JPEG", "RAW + Large Fine JPEG", "RAW"}};
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
  void expect_as_before() const { expect_as_before_at("1/4"); }
  void expect_as_before_at(const std::string& shutter) const {
    EXPECT_EQ(camera.settings["shutterspeed"].value, shutter);
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

TEST_F(Tether, NamesTheTimeThatWasTakenForAnother) {
  camera.settings["shutterspeed"].value = "1/60";
  camera.takes["1/500"] = "1/400";
  testing::internal::CaptureStderr();
  capture();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("the camera took 1/400 s instead of 1/500 s"));
  EXPECT_THAT(times(), testing::Contains(testing::DoubleNear(1.0 / 400, 1e-6)));
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
  camera.second_prefix = "IMG_";
  camera.second_ending = ".DNG";
  folder.write("photos/IMG_0001.JPG", "of another day");
  TetheredCamera tethered;
  EXPECT_EQ(tethered.model(), "Altair M12");
  EXPECT_THAT(tethered.shutters_s(), SizeIs(15)) << "Bulb is no time";
  EXPECT_DOUBLE_EQ(tethered.set_shutter(0.0155), 1.0 / 60);
  const TakenPhoto taken = tethered.take(folder / "photos");
  ASSERT_THAT(taken.files, ElementsAre(folder / "photos/IMG_0001-2.JPG", folder / "photos/IMG_0001.DNG"));
  EXPECT_THAT(taken.late, testing::IsEmpty());
  EXPECT_EQ(file_text(folder / "photos/IMG_0001.JPG"), "of another day");
  EXPECT_NEAR(read_exif(taken.files[1]).exposure_s.value_or(0), 1.0 / 60, 1e-5);
  EXPECT_THROW(tethered.take(folder / "no such folder"), Error);
}

// The raw file comes long after the JPEG, as from a slow card; nobody said that there would be one. Each is of its own
// photo, and the bracket is judged and written by raw files.
TEST_F(Tether, WaitsForTheRawFileOfEachPhoto) {
  camera.settings.erase("imageformat");
  camera.second_prefix = "IMG_";
  camera.second_ending = ".DNG";
  camera.second_after_ms = 700;
  camera.settings["shutterspeed"].value = "1/30";
  capture({"--brackets", "0,-3"});
  EXPECT_THAT(times(), ElementsAre(testing::DoubleNear(1.0 / 60, 1e-5), testing::DoubleNear(1.0 / 500, 1e-5)));
  for (const Photo& photo : read_session(folder / "out/session.json").photos) {
    EXPECT_EQ(photo.file.extension(), ".DNG");
    EXPECT_NEAR(*read_exif(std::filesystem::path(photo.file).replace_extension(".JPG")).exposure_s, photo.exposure_s,
                1e-5);
  }
}

// It comes only once the camera was released again. Its name says whose it is, or its EXIF.
TEST_F(Tether, AFileThatComesWithTheNextPhotoIsPutToItsOwn) {
  for (const char* prefix : {"IMG_", "RAW_"}) {
    camera.card.clear();
    camera.taken = 0;
    camera.second_prefix = prefix;
    camera.second_ending = ".DNG";
    camera.second_after_photos = 1;
    const std::filesystem::path photos = folder / (std::string("photos-") + prefix);
    std::filesystem::create_directory(photos);
    TetheredCamera tethered;
    tethered.set_shutter(1.0 / 30);
    const TakenPhoto first = tethered.take(photos);
    EXPECT_THAT(first.files, ElementsAre(photos / "IMG_0001.JPG"));
    tethered.set_shutter(1.0 / 250);
    const auto until =
        std::chrono::steady_clock::now() + std::chrono::seconds(1);  // its own would come with a third one
    const TakenPhoto second = tethered.take(photos, [&] { return std::chrono::steady_clock::now() > until; });
    EXPECT_THAT(second.files, ElementsAre(photos / "IMG_0002.JPG")) << prefix;
    ASSERT_THAT(second.late, SizeIs(1)) << prefix;
    EXPECT_EQ(second.late[0].file, photos / (std::string(prefix) + "0001.DNG"));
    EXPECT_THAT(second.late[0].beside, ElementsAre(photos / "IMG_0001.JPG"));
  }
}

// What a try left is dropped whole, however late it comes: here the settings promise JPEG alone.
TEST_F(Tether, LateFilesOfTriesAreDropped) {
  camera.second_prefix = "IMG_";
  camera.second_ending = ".DNG";
  camera.second_after_ms = 400;
  capture({"--brackets", "0"});
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "out/photos"))
    names.push_back(entry.path().filename().string());
  const std::string last = fmt::format("IMG_{:04}", camera.taken);
  EXPECT_THAT(names, testing::UnorderedElementsAre(last + ".JPG", last + ".DNG"));
}

// The paper is clipped in part at 1/30 s and has 19 % at 1/125 s: nearest to 60 % by calculation is 1/30 s again.
TEST_F(Tether, WholeStopsAreAllTriedBetweenDarkAndBright) {
  camera.like.paper = 0.4;
  camera.scene = drawn(camera.like);
  for (int y = 0; y < camera.scene.height; ++y)
    for (int x = 0; x < camera.scene.width; ++x)
      camera.scene.at(x, y) *= 0.4F + 1.2F * static_cast<float>(y) / static_cast<float>(camera.scene.height);
  camera.settings["shutterspeed"].value = "1/30";
  capture({"--brackets", "0"});
  EXPECT_THAT(times(), ElementsAre(testing::DoubleNear(1.0 / 60, 1e-6)));
  EXPECT_THAT(camera.calls, IsSupersetOf({"capture 1/30", "capture 1/125", "capture 1/60"}));
}

TEST_F(Tether, SaysTrulyWhyNoTimeIsRight) {
  const auto said = [&](const std::vector<std::string>& dial) {
    camera.settings["shutterspeed"] = {dial[0], dial};
    camera.taken = 0;
    testing::internal::CaptureStderr();
    EXPECT_THROW(capture(), Error);  // there is no photo
    expect_as_before_at(dial[0]);
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_THAT(said({"1/4", "1/1000"}), HasSubstr("1/1000 s is too dark and 1/4 s too bright, and the camera's dial has "
                                                 "no time between"));
  EXPECT_THAT(said({"1/2", "1/4"}), HasSubstr("no time that is short enough"));
  EXPECT_THAT(said({"1/2000", "1/4000"}), HasSubstr("no time that is long enough"));
  camera.light = {8, 0.1, 0.1, 0.1, 0.1};
  EXPECT_THAT(said({"1/60", "1/30", "1/125", "1/250"}),
              HasSubstr("1/125 s is too dark and 1/60 s too bright, more than such times differ: the light changed"));
  camera.light.clear();
  for (const Tag& tag : camera.like.board.tags.list) camera.like.left_out.push_back(tag.id);
  camera.like.glint = 1;
  camera.scene = drawn(camera.like);
  EXPECT_THAT(said({"1/60", "1/30", "1/125"}), HasSubstr("shows no tag of the board's (family tag36h11)"));
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
