// Proves: `burin design` of a picture in color as a person meets it: previews in color, figures a channel in what is
// printed, in the report's file and on its page; what is found of the lamps is said before the work begins; what cannot
// be shown is refused in words.
#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "burin/base/image.h"
#include "burin/pictures/picture.h"
#include "tests/places.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// The sample's bench with three lamps of different colors, and one view of it in color.
class ColorCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::copy(fs::path(places::source()) / "samples" / "small-bench", folder_ / "bench", fs::copy_options::recursive);
    edit("bench.json", [](Json& b) {
      const Json lamp = b["lights"][0];
      b["lights"] = Json::array();
      for (const auto& [id, x_mm, color] :
           {std::tuple{"red", -300, std::array{1.0, 0.1, 0.0}}, std::tuple{"green", 60, std::array{0.1, 1.0, 0.1}},
            std::tuple{"blue", 420, std::array{0.0, 0.1, 1.0}}}) {
        Json one = lamp;
        one["id"] = id;
        one["position_mm"] = {x_mm, -313, 444.5};
        one["intensity"] = color;
        b["lights"].push_back(one);
      }
    });
    edit("design.json", [](Json& d) {
      d["views"] = Json::array({{{"view", "d1"},
                                 {"lights", {"red", "green", "blue"}},
                                 {"target", "targets/still-life.png"},
                                 {"color", true}}});
    });
    fs::copy(fs::path(places::source()) / "tests" / "data" / "targets" / "coffee.png",
             folder_ / "bench" / "targets" / "still-life.png", fs::copy_options::overwrite_existing);
  }
  void edit(const std::string& file, const std::function<void(Json&)>& change) const {
    Json json = Json::parse(file_text(folder_ / "bench" / file));
    change(json);
    std::ofstream(folder_ / "bench" / file) << json;
  }
  Outcome design() const {
    return run_burin(folder_, {"design", "bench/design.json", "--out", "out", "--count", "500", "--pixels", "64",
                               "--iterations", "4", "--live"});
  }
  TemporaryFolder folder_;
};

TEST_F(ColorCommand, WritesPicturesAndFiguresOfAllChannels) {
  const Outcome run = design();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("in color: red "), HasSubstr("luminance ")));
  EXPECT_THAT(run.err, AllOf(HasSubstr("d1 under green"), HasSubstr("degrees apart (at best 60.0)")));
  for (const char* picture : {"preview-d1.png", "target-d1.png", "achievable-d1.png", "contact-sheet.png"})
    EXPECT_EQ(read_picture(folder_ / "out" / picture).channels, 3) << picture;
  const Json report = Json::parse(file_text(folder_ / "out" / "design-report.json"));
  const Json& color = report["views"][0]["color"];
  for (const char* channel : {"red", "green", "blue", "luminance"})
    EXPECT_GT(color["psnr_db"][channel].get<double>(), 5) << channel;
  EXPECT_EQ(color["white_gain"].size(), 3U);
  const Outcome page = run_burin(folder_, {"report", "out"});
  ASSERT_EQ(page.exit_code, 0) << page.err;
  EXPECT_THAT(file_text(folder_ / "out" / "report.html"), HasSubstr("View in color"));
}

TEST_F(ColorCommand, RefusesColorsThatNoLampHas) {
  edit("design.json", [](Json& d) { d["views"][0]["lights"] = {"red"}; });
  edit("bench.json", [](Json& b) { b["lights"][0]["intensity"] = {1, 0.1, 0}; });
  const Outcome run = design();
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, AllOf(HasSubstr("view d1"), HasSubstr("has any blue"), HasSubstr("; ")));
  EXPECT_FALSE(fs::exists(folder_ / "out" / "scratches.csv"));
}

TEST_F(ColorCommand, APlanPhotographsEachLampAndSaysWhereTheyWouldStandBetter) {
  edit("bench.json", [](Json& b) {
    for (std::size_t k = 0; k < 3; ++k) b["lights"][k]["position_mm"][0] = 20 + 40 * k;
  });
  const Outcome run = run_burin(folder_, {"plan", "bench/board.json", "--bench", "bench/bench.json", "--design",
                                          "bench/design.json", "--shots", "3", "--out", "plan"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, AllOf(HasSubstr("degrees apart (at best 60.0)"), HasSubstr("green at [")));
  std::vector<std::string> lamps;
  const Json plan = Json::parse(file_text(folder_ / "plan" / "plan.json"));
  for (const Json& shot : plan["shots"])
    if (shot.contains("designed")) lamps.push_back(shot["light"]["id"].get<std::string>());
  EXPECT_THAT(lamps, ::testing::UnorderedElementsAre("red", "green", "blue"));
}

// A measured round whose photos are taken under one lamp each: the page adds them up, and looks at them as designed.
TEST_F(ColorCommand, TheProjectsPageAddsUpThePhotosUnderEachLamp) {
  ASSERT_EQ(design().exit_code, 0);
  const fs::path project = folder_ / "bench", round = project / "round-01";
  fs::create_directories(round / "photos");
  fs::copy(folder_ / "out" / "scratches.csv", round / "scratches.csv");
  Json wanted = Json::parse(file_text(project / "design.json")), bench = Json::parse(file_text(project / "bench.json"));
  for (const char* name : {"board", "bench"}) wanted[name] = "../" + wanted[name].get<std::string>();
  wanted["views"][0]["target"] = "../" + wanted["views"][0]["target"].get<std::string>();
  std::ofstream(round / "design.json") << wanted;
  if (bench.contains("camera") && bench["camera"].is_string())
    bench["camera"] = "../" + bench["camera"].get<std::string>();
  std::ofstream(round / "bench.json") << bench;
  // In floating point: what clips in 8 bits is not what is proved here.
  const auto render = [&](const std::string& light) {
    const Outcome run = run_burin(
        folder_, {"render", "bench/board.json", "--bench", "bench/bench.json", "--view", "d1", "--lamp", light,
                  "--scratches", "out/scratches.csv", "--out", "bench/round-01/photos/" + light + ".exr"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
  };
  Json session{{"format", "burin/session"}, {"version", 1}, {"board", "../board.json"}, {"photos", Json::array()}};
  for (const char* light : {"red", "green", "blue"}) {
    render(light);
    session["photos"].push_back({{"file", "photos/" + std::string(light) + ".exr"},
                                 {"view", "d1"},
                                 {"light", light},
                                 {"exposure_s", 0.01},
                                 {"iso", 100},
                                 {"f_number", 8},
                                 {"encoding", "linear"}});
  }
  std::ofstream(round / "session.json") << session;
  const Outcome page = run_burin(folder_, {"report", "bench"});
  ASSERT_EQ(page.exit_code, 0) << page.err;
  const std::string html = file_text(folder_ / "bench" / "report.html");
  const auto decibels_after = [&](const std::string& words) {
    const std::size_t at = html.find(words);
    EXPECT_NE(at, std::string::npos) << words;
    return at == std::string::npos ? 0 : std::stod(html.substr(at + words.size()));
  };
  const double promised = decibels_after("View d1, round 1: promised by the believed bench, "),
               photographed = decibels_after("View d1, round 1: photographed as d1, ");
  std::printf("promised %.1f dB, photographed %.1f dB\n", promised, photographed);
  EXPECT_GT(promised, 5);
  EXPECT_NEAR(photographed, promised, 0.5);
  // A photo under one of them alone shows something else: nothing is said of it.
  session["photos"].erase(2);
  std::ofstream(round / "session.json") << session;
  const Outcome less = run_burin(folder_, {"report", "bench"});
  ASSERT_EQ(less.exit_code, 0) << less.err;
  EXPECT_THAT(file_text(folder_ / "bench" / "report.html"),
              AllOf(Not(HasSubstr("round 1: photographed")), HasSubstr("under each of its lamps alone")));
}

}  // namespace
}  // namespace burin
