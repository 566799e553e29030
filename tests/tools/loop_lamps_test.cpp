// Proves: a design for several lamps turns in the loop. What the loop prints says, before anyone goes to photograph,
// that each photo is under one lamp alone and which folder it goes into; photos that lie elsewhere are asked for in
// words; those in their folders are measured lamp by lamp, in color, and the next board is designed for the lamps as
// they are, under their names, twice. Oracle: the truth that the simulated camera used.
#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "tests/places.h"
#include "tests/tools/loop_bench.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::array<const char*, 3> kLamps{"red", "green", "blue"};

// Three lamps where the sample has one; a view in color under all, one in gray under two of them.
class LoopOfSeveralLamps : public ::testing::Test {
 protected:
  void SetUp() override {
    make_tiny_project(folder_, {"d0", "d1", "c0", "c2"}, 0.5);
    const fs::path project = folder_ / "project";
    Json bench = read_json_file(project / "bench.json"), design = read_json_file(project / "design.json"),
         truth = read_json_file(folder_ / "truth.json");
    const Json believed = bench["lights"][0], lamp = truth["lights"][0];
    bench["lights"] = truth["lights"] = Json::array();
    const std::array<double, 3> along_mm{-300, 60, 420};
    for (std::size_t c = 0; c < 3; ++c) {
      Json one = believed, real = lamp;
      one["id"] = real["id"] = kLamps[c];
      one["position_mm"] = {along_mm[c], -313, 444.5};
      real["position_mm"] = {along_mm[c] + 4, -318, 449};
      for (std::size_t k = 0; k < 3; ++k) {
        one["intensity"][k] = k == c ? 1 : 0;
        real["intensity"][k] = lamp["intensity"][k].get<double>() * (k == c ? 1 : 0.1);
      }
      bench["lights"].push_back(one);
      truth["lights"].push_back(real);
    }
    design["scratches"] = 250;
    design["views"][1].erase("light");
    design["views"][1]["lights"] = kLamps;
    design["views"][1]["color"] = true;
    design["views"][0].erase("light");
    design["views"][0]["lights"] = {"red", "green"};
    truth["sensor"]["channels"] = 3;
    for (std::size_t v = 0; v < truth["views"].size(); ++v) {
      Json& view = truth["views"][v];
      const Json photos = view["photos"];
      view["photos"] = Json::array();
      for (std::size_t c = 0; c < 3; ++c) {
        Json photo = photos[0];
        photo["light"] = kLamps[c];
        photo["file"] = "photos/IMG_" + std::to_string(100 + 10 * v + 2 * c) + ".png";
        const std::string second = std::to_string(20 * c);
        photo["datetime"] = "2025:05:17 10:0" + std::to_string(v) + (second.size() == 1 ? ":0" : ":") + second;
        view["photos"].push_back(photo);
      }
    }
    std::ofstream(project / "bench.json") << bench;
    std::ofstream(project / "design.json") << design;
    std::ofstream(folder_ / "truth.json") << truth;
  }

  // What the workshop photographs of a round's board, all in one folder, as a card is copied.
  void photograph(const fs::path& round) const {
    ASSERT_EQ(run_burin(folder_,
                        {"simulate", "truth.json", "--scratches", (round / "sent.csv").string(), "--out", "workshop"})
                  .exit_code,
              0);
  }
  void put_into_folders(const fs::path& from, const fs::path& round) const {
    const Json truth = read_json_file(folder_ / "truth.json");
    for (const Json& view : truth["views"])
      for (const Json& photo : view["photos"]) {
        const fs::path file = fs::path(photo["file"].get<std::string>()).filename();
        fs::rename(from / file, round / "photos" / photo["light"].get<std::string>() / file);
      }
  }
  Outcome loop(std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"loop",
                                   "project",
                                   "--allow-undetermined",
                                   "depth_um",
                                   "--allow-undetermined",
                                   "alpha",
                                   "--allow-undetermined",
                                   "machine.affine"};
    words.insert(words.end(), more.begin(), more.end());
    return run_burin(folder_, words);
  }

  TemporaryFolder folder_;
};

TEST_F(LoopOfSeveralLamps, TurnsTwiceByPhotosInFoldersOfTheirLamps) {
  const fs::path project = folder_ / "project", round = project / "round-01";
  const Outcome first = run_burin(folder_, {"loop", "project", "--iterations", "20", "--pixels", "128"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, AllOf(HasSubstr("photographed under each of these lamps alone"),
                               HasSubstr("photograph each place under one lamp after the other, each alone"),
                               HasSubstr("project/round-01/photos/red, project/round-01/photos/green and "
                                         "project/round-01/photos/blue, each into that of the lamp")));
  for (const char* lamp : kLamps) EXPECT_TRUE(fs::is_directory(round / "photos" / lamp)) << lamp;
  EXPECT_THAT(run_burin(folder_, {"status", "project"}).out, HasSubstr("round-01/photos/red"));

  // All into one folder: nobody knows which lamp was on, and it says so before it reads a photo.
  photograph(round);
  for (const auto& entry : fs::directory_iterator(folder_ / "workshop" / "photos"))
    fs::copy_file(entry.path(), round / "photos" / entry.path().filename());
  const Outcome unsorted = loop();
  EXPECT_EQ(unsorted.exit_code, 1);
  EXPECT_THAT(unsorted.err, AllOf(HasSubstr("IMG_100.png: and 11 more lie in no lamp's folder"),
                                  HasSubstr("project/round-01/photos/green")));
  EXPECT_FALSE(fs::exists(round / "session.json"));

  // Into their folders: each lamp is measured.
  put_into_folders(round / "photos", round);
  const Outcome turned = loop();
  ASSERT_EQ(turned.exit_code, 0) << turned.out << turned.err;
  EXPECT_THAT(turned.out, HasSubstr("12 photos of 4 views under 3 lamps"));
  EXPECT_THAT(turned.out, HasSubstr("The loop has turned 1 time"));
  const Json truth = read_json_file(folder_ / "truth.json"), bench = read_json_file(round / "bench.json");
  ASSERT_EQ(bench["lights"].size(), 3U);
  for (const Json& light : bench["lights"]) {
    Json real;
    for (const Json& one : truth["lights"])
      if (one["id"] == light["id"]) real = one;
    ASSERT_FALSE(real.is_null()) << light["id"];
    for (int i = 0; i < 3; ++i)
      EXPECT_LT(std::abs(light["position_mm"][i].get<double>() - real["position_mm"][i].get<double>()),
                3 * light["position_sigma_mm"][i].get<double>() + 0.5)
          << light["id"] << ", mm, axis " << i;
    for (int k = 0; k < 3; ++k)  // in shares of its own light
      EXPECT_NEAR(light["intensity"][k].get<double>() / real["intensity"][k].get<double>() *
                      real["intensity"].front().get<double>() / light["intensity"].front().get<double>(),
                  1, 0.05)
          << light["id"] << ", channel " << k;
  }
  // Photos added to a lamp's folder are new to it.
  const fs::path photo = round / "photos" / "red" / "IMG_100.png";
  fs::copy_file(photo, round / "photos" / "red" / "IMG_099.png");
  EXPECT_THAT(run_burin(folder_, {"status", "project"}).out, HasSubstr("IMG_099.png"));
  fs::remove(round / "photos" / "red" / "IMG_099.png");

  // Once more around, for the lamps as they are.
  const fs::path second = project / "round-02";
  ASSERT_TRUE(fs::is_directory(second / "photos" / "blue"));
  const Json named = read_json_file(second / "bench-before.json");
  std::vector<std::string> ids;
  for (const Json& light : named["lights"]) ids.push_back(light["id"]);
  EXPECT_THAT(ids, ::testing::UnorderedElementsAre("red", "green", "blue"));
  fs::remove_all(folder_ / "workshop");
  photograph(second);
  put_into_folders(folder_ / "workshop" / "photos", second);
  const Outcome again = loop();
  ASSERT_EQ(again.exit_code, 0) << again.out << again.err;
  EXPECT_THAT(again.out, HasSubstr("The loop has turned 2 times"));
  EXPECT_TRUE(fs::exists(project / "round-03" / "board.gcode"));
  EXPECT_THAT(file_text(project / "report.html"), HasSubstr("Round 2, photographed"));
}

}  // namespace
}  // namespace burin
