// `burin capture` and `burin simulate` as a person meets them: what they write, what they say, their exit codes.
// That the photos and the brackets are right is proved by tests/capture.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// A board of one tag, four scratches, a camera of 200 x 150 pixels in two places.
nlohmann::json truth() {
  auto json = nlohmann::json::parse(R"({
    "format": "burin/rig-truth", "version": 1, "seed": 3, "samples": 16, "samples_plain": 16,
    "board": { "size_mm": [60, 50], "carve_mm": [[30, 10], [50, 40]],
               "tags": { "family": "tag36h11", "z_mm": 0, "quiet_mm": 1,
                         "list": [ { "id": 3, "center_mm": [15, 25], "size_mm": 16 } ] },
               "tool": { "width_um": 400 } },
    "material": { "alpha": 0.08, "depth_um": 14, "base_alpha": 0.2, "f0": [0.9, 0.9, 0.9] },
    "scratches": { "random": { "count": 4, "length_mm": [5, 9], "seed": 1 } },
    "camera": { "lensmodel": "LENSMODEL_PINHOLE", "imagersize": [200, 150], "intrinsics": [900, 900, 99.5, 74.5] },
    "sensor": { "channels": 1, "bits": 12, "encoding": "linear", "gain": 6000, "full_well_e": 20000,
                "read_noise_e": 5 },
    "lights": [ { "id": "lamp", "position_mm": [250, 40, 500], "intensity": [100000, 100000, 100000] } ],
    "views": []
  })");
  for (int v = 0; v < 2; ++v)
    json["views"].push_back(
        {{"view", "place" + std::to_string(v)},
         {"T_camera_board", {{1, 0, 0, -30 + 9 * v}, {0, -1, 0, 25}, {0, 0, -1, 400}, {0, 0, 0, 1}}},
         {"photos",
          {{{"file", "photos/IMG_" + std::to_string(v) + ".png"},
            {"exposure_s", 0.01},
            {"f_number", 8},
            {"datetime", "2024:05:01 12:0" + std::to_string(v) + ":00"}}}}});
  return json;
}

TEST(CaptureCommand, TakesWhatSimulateWrote) {
  const TemporaryFolder folder;
  folder.write("truth.json", truth().dump());
  const Outcome simulate = run_burin(folder, {"simulate", "truth.json", "--out", "bench"});
  EXPECT_EQ(simulate.exit_code, 0) << simulate.err;
  EXPECT_THAT(simulate.out, HasSubstr("next: burin calibrate bench/session.json"));
  const Outcome capture =
      run_burin(folder, {"capture", "bench/photos", "--board", "bench/board.json", "--out", "again"});
  EXPECT_EQ(capture.exit_code, 0) << capture.err;
  EXPECT_THAT(capture.out, HasSubstr("again/session.json: 2 photos of 2 views"));
  EXPECT_THAT(capture.err, HasSubstr("warning: there are photos from 2 places only"));
  EXPECT_TRUE(std::filesystem::exists(folder / "again/session.json"));
}

TEST(CaptureCommand, LampTakesItsNameFromTheBenchOfTheDesign) {
  const TemporaryFolder folder;
  folder.write("truth.json", truth().dump());
  ASSERT_EQ(run_burin(folder, {"simulate", "truth.json", "--out", "bench"}).exit_code, 0);
  const std::filesystem::path sample = places::source() + "/samples/small-bench";
  std::filesystem::copy_file(sample / "camera.cameramodel", folder / "camera.cameramodel");
  auto nominal = nlohmann::json::parse(file_text(sample / "bench.json"));
  nominal["lights"][0]["id"] = "ceiling";
  folder.write("nominal.json", nominal.dump());
  const std::vector<std::string> capture{"capture", "bench/photos", "--board", "bench/board.json",
                                         "--out",   "again",        "--bench", "nominal.json"};
  const auto lamp = [&] {
    return nlohmann::json::parse(file_text(folder / "again/session.json"))["photos"][1]["light"].get<std::string>();
  };
  ASSERT_EQ(run_burin(folder, capture).exit_code, 0);
  EXPECT_EQ(lamp(), "ceiling");
  // Which of two lamps was on, a person has to say.
  nominal["lights"].push_back(nominal["lights"][0]);
  nominal["lights"][1]["id"] = "window";
  folder.write("nominal.json", nominal.dump());
  const Outcome asked = run_burin(folder, capture);
  EXPECT_EQ(asked.exit_code, 1);
  EXPECT_THAT(asked.err, AllOf(HasSubstr("IMG_0.png: and 1 more lie in no lamp's folder"),
                               HasSubstr("bench/photos/ceiling and bench/photos/window"), HasSubstr("--lamp")));
  std::vector<std::string> said = capture;
  said.insert(said.end(), {"--lamp", "window"});
  ASSERT_EQ(run_burin(folder, said).exit_code, 0);
  EXPECT_EQ(lamp(), "window");
  // A name that the bench does not have is a slip, unless it is said to be new.
  std::vector<std::string> slip = capture;
  slip.insert(slip.end(), {"--lamp", "windwo"});
  const Outcome refused = run_burin(folder, slip);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("--lamp windwo"), HasSubstr("known are ceiling, window"), HasSubstr("--new-lamp")));
  EXPECT_EQ(lamp(), "window") << "nothing was written";
  slip.emplace_back("--new-lamp");
  ASSERT_EQ(run_burin(folder, slip).exit_code, 0);
  EXPECT_EQ(lamp(), "windwo");
  // Or by its folder; what is said counts for the others.
  for (const char* name : {"ceiling", "window"}) std::filesystem::create_directories(folder / "bench/photos" / name);
  std::filesystem::rename(folder / "bench/photos/IMG_1.png", folder / "bench/photos/ceiling/IMG_1.png");
  ASSERT_EQ(run_burin(folder, said).exit_code, 0);
  EXPECT_EQ(lamp(), "ceiling");
  std::filesystem::rename(folder / "bench/photos/IMG_0.png", folder / "bench/photos/window/IMG_0.png");
  ASSERT_EQ(run_burin(folder, capture).exit_code, 0);
  EXPECT_EQ(lamp(), "ceiling");
  // The sun beside the only lamp is no other one.
  nominal["lights"].erase(1);
  nominal["lights"].push_back({{"id", "sun"}, {"sun", {{"direction", {0, 0.5, 0.8}}, {"irradiance", {1, 1, 1}}}}});
  folder.write("nominal.json", nominal.dump());
  std::filesystem::rename(folder / "bench/photos/window/IMG_0.png", folder / "bench/photos/IMG_0.png");
  ASSERT_EQ(run_burin(folder, capture).exit_code, 0);
  EXPECT_EQ(lamp(), "ceiling");
}

// The photos of the round before, in a project's new round: known by their bytes, before anything is made of them.
TEST(CaptureCommand, PhotosOfAnotherRoundAreRefused) {
  const TemporaryFolder folder;
  folder.write("truth.json", truth().dump());
  ASSERT_EQ(run_burin(folder, {"simulate", "truth.json", "--out", "bench"}).exit_code, 0);
  const auto copy = [&](const std::string& from, const std::string& to) {
    std::filesystem::create_directories((folder / to).parent_path());
    std::filesystem::copy_file(folder / from, folder / to);
  };
  copy("bench/photos/IMG_0.png", "p/round-01/photos/IMG_0.png");
  copy("bench/photos/IMG_1.png", "p/round-02/photos/IMG_1.png");
  const auto capture = [&] {
    return run_burin(folder, {"capture", "p/round-02/photos", "--board", "bench/board.json", "--out", "p/round-02"});
  };
  EXPECT_EQ(capture().exit_code, 0);
  std::filesystem::remove(folder / "p/round-02/session.json");
  copy("bench/photos/IMG_0.png", "p/round-02/photos/IMG_9.png");
  const Outcome refused = capture();
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("p/round-02/photos/IMG_9.png: is, byte for byte, round-01/photos/IMG_0.png"),
                                 HasSubstr("another board")));
  EXPECT_FALSE(std::filesystem::exists(folder / "p/round-02/session.json"));
}

TEST(CaptureCommand, PhotosThatDoNotServeAreNamedAndNothingIsWritten) {
  const TemporaryFolder folder;
  folder.write("truth.json", truth().dump());
  ASSERT_EQ(run_burin(folder, {"simulate", "truth.json", "--out", "bench"}).exit_code, 0);
  folder.write("bench/photos/IMG_1.png", "no picture");
  const Outcome run = run_burin(folder, {"capture", "bench/photos", "--board", "bench/board.json", "--out", "again"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, AllOf(HasSubstr("error: "), HasSubstr("IMG_1.png"), HasSubstr("1 error found")));
  EXPECT_EQ(run.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder / "again"));
}

TEST(CaptureCommand, FoldersAndBoardsThatAreMissing) {
  const TemporaryFolder folder;
  folder.write("board.json", R"({"format": "burin/board", "version": 1, "size_mm": [60, 50]})");
  const Outcome no_folder = run_burin(folder, {"capture", "none", "--board", "board.json", "--out", "s"});
  EXPECT_EQ(no_folder.exit_code, 1);
  EXPECT_THAT(no_folder.err, AllOf(HasSubstr("none"), HasSubstr("no such folder")));
  const Outcome no_board = run_burin(folder, {"capture", ".", "--board", "none.json", "--out", "s"});
  EXPECT_EQ(no_board.exit_code, 1);
  EXPECT_THAT(no_board.err, HasSubstr("none.json"));
}

TEST(SimulateCommand, ChoosesViewsAndScratches) {
  const TemporaryFolder folder;
  folder.write("truth.json", truth().dump());
  folder.write("design.csv", "x0_mm,y0_mm,x1_mm,y1_mm\n35,20,45,30\n");
  const Outcome run = run_burin(folder, {"simulate", "truth.json", "--out", "bench", "--scratches", "design.csv",
                                         "--views", "place1", "--samples", "4"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "bench/photos/IMG_0.png"));
  EXPECT_TRUE(std::filesystem::exists(folder / "bench/photos/IMG_1.png"));
  EXPECT_THAT(file_text(folder / "bench/scratches.csv"), HasSubstr("35"));
  const Outcome wrong = run_burin(folder, {"simulate", "truth.json", "--out", "bench", "--views", "place7"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("place7"), HasSubstr("place0, place1")));
}

TEST(SimulateCommand, AnUnwritableFolderIsNamed) {
  const TemporaryFolder folder;
  folder.write("truth.json", truth().dump());
  folder.write("file", "");
  const Outcome run = run_burin(folder, {"simulate", "truth.json", "--out", "file/bench"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("file/bench"));
}

}  // namespace
}  // namespace burin
