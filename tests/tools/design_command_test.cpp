// Proves: `burin design` as a person meets it. It writes what it says; Ctrl-C and --time keep what there is and say how
// to go on; the limits of board and machine hold in the file that it writes; what is carved stays; pictures of any kind
// are read or refused in one sentence. How good designs are is measured elsewhere.
#include <gmock/gmock.h>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/carving_limits.h"
#include "burin/scene/board.h"
#include "burin/scene/scratches.h"
#include "tests/places.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Json read(const fs::path& file) { return Json::parse(file_text(file)); }

// A copy of the sample's bench, and a small design for it.
class DesignCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::copy(fs::path(places::source()) / "samples" / "small-bench", folder_ / "bench", fs::copy_options::recursive);
  }

  Outcome design(const std::vector<std::string>& more, const std::string& out = "out",
                 const std::string& scratches = "400") const {
    std::vector<std::string> line{"design", "bench/design.json", "--out", out, "--scratches", scratches, "--pixels",
                                  "64",     "--iterations",      "4"};
    line.insert(line.end(), more.begin(), more.end());
    return run_burin(folder_, line);
  }
  Json edit(const std::string& file, const std::function<void(Json&)>& change) const {
    Json json = read(folder_ / "bench" / file);
    change(json);
    std::ofstream(folder_ / "bench" / file) << json;
    return json;
  }
  void expect_refusal(const Outcome& run, const std::string& about, const std::string& what) const {
    EXPECT_EQ(run.exit_code, 1) << run.out << run.err;
    EXPECT_THAT(run.err, AllOf(HasSubstr("burin: "), HasSubstr(about), HasSubstr(what), HasSubstr("; "),
                               Not(HasSubstr("fault in Burin"))));
    EXPECT_FALSE(fs::exists(folder_ / "none" / "scratches.csv"));
  }
  CarvingLimits limits(const std::string& machine) const {
    const Board board = read_board(folder_ / "bench" / "board.json");
    return carving_limits(board, machine_profile((folder_ / machine).string()).limits, board.material.depth_um,
                          CarvingLimits().affine);
  }

  TemporaryFolder folder_;
};

TEST_F(DesignCommand, WritesWhatItSays) {
  const Outcome run = design({"--live"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json report = read(folder_ / "out" / "design-report.json");
  EXPECT_EQ(read_scratches(folder_ / "out" / "scratches.csv").size(), report["scratches"].get<std::size_t>());
  for (const Json& view : report["views"]) {
    EXPECT_THAT(run.out, HasSubstr(view["view"].get<std::string>()));
    for (const char* picture : {"preview", "start", "target", "achievable"})
      EXPECT_TRUE(fs::exists(folder_ / "out" / view[picture].get<std::string>()));
  }
  EXPECT_TRUE(fs::exists(folder_ / "out" / "live.png"));
  EXPECT_THAT(run.out, HasSubstr("burin toolpath out/scratches.csv"));
  const Outcome next =
      run_burin(folder_, {"toolpath", "out/scratches.csv", "--board", "bench/board.json", "--out", "board.gcode"});
  EXPECT_EQ(next.exit_code, 0) << next.err;
}

// One figure, of the pixels that eyes tell apart, whatever the design looked at: in the table, in the report's file and
// on its page, with the word that follows from it.
TEST_F(DesignCommand, OneFigureWithItsPixelsEverywhere) {
  const Outcome coarse = design({}, "coarse"),
                fine = run_burin(folder_, {"design", "bench/design.json", "--out", "fine", "--count", "600", "--pixels",
                                           "100", "--iterations", "2"});
  ASSERT_EQ(coarse.exit_code, 0) << coarse.err;
  ASSERT_EQ(fine.exit_code, 0) << fine.err;
  const Json report = read(folder_ / "coarse" / "design-report.json");
  const int px = report["eye"]["px"];
  EXPECT_EQ(read(folder_ / "fine" / "design-report.json")["eye"]["px"], px);
  for (const Outcome& run : {coarse, fine}) EXPECT_THAT(run.out, HasSubstr(fmt::format("\n            ({} px)", px)));
  double mean_db = 0;
  for (const Json& view : report["views"]) {
    const double db = view["eye_psnr_db"];
    EXPECT_NE(db, view["psnr_db"].get<double>());
    mean_db += db / static_cast<double>(report["views"].size());
    EXPECT_THAT(coarse.out, HasSubstr(fmt::format("{:<10}  {:7.2f}", view["view"].get<std::string>(), db)));
  }
  EXPECT_THAT(coarse.out, HasSubstr("mean of the views, of 64 px: "));
  const Outcome page = run_burin(folder_, {"report", "coarse"});
  ASSERT_EQ(page.exit_code, 0) << page.err;
  EXPECT_THAT(page.out, HasSubstr(fmt::format("{:.1f} dB ({} px) on average", mean_db, px)));
}

TEST_F(DesignCommand, HelpBeginsWithTheOptionsThatMatter) {
  const std::string help = run_burin(folder_, {"design", "--help-all"}).out;
  const auto at = [&](const char* words) { return help.find(words); };
  ASSERT_NE(at("Options that are seldom needed"), std::string::npos);
  EXPECT_LT(at("Options that are seldom needed"), at("--start-sweeps"));
  for (const char* option : {"--out", "--count", "--time", "--pixels", "--carve-time", "--machine"})
    EXPECT_LT(at((std::string("  ") + option + " ").c_str()), at("Options that are seldom needed")) << option;
}

TEST_F(DesignCommand, CtrlCKeepsWhatThereIsAndItGoesOn) {
  // So many iterations that it would never end; the interrupt comes once the live preview shows that it runs.
  const Outcome run = run_shell(
      folder_, "cd " + quoted(folder_.path().string()) + " && { " + quoted(places::program()) +
                   " design bench/design.json --out out --count 400 --pixels 64 --iterations 1000000 --live & pid=$!; "
                   "for i in $(seq 600); do [ -e out/live.png ] && break; sleep 0.1; done; sleep 0.3; "
                   "kill -INT $pid; wait $pid; echo exit code $?; }");
  EXPECT_THAT(run.out, HasSubstr("exit code 130")) << run.err;
  EXPECT_THAT(run.err, HasSubstr("note: stopping with what there is so far; press Ctrl-C again to end at once"));
  EXPECT_THAT(run.err, HasSubstr("burin: stopped by Ctrl-C (SIGINT) before it was done; the files so far are kept"));
  EXPECT_THAT(run.out, HasSubstr("Go on with: burin design bench/design.json --out out --from out/scratches.csv"));
  const Json stopped = read(folder_ / "out" / "design-report.json");
  EXPECT_TRUE(stopped["stopped_early"].get<bool>());
  EXPECT_LT(stopped["history"].size(), 1000000U);

  const Outcome on = design({"--from", "out/scratches.csv"}, "on");
  ASSERT_EQ(on.exit_code, 0) << on.err;
  const Json gone_on = read(folder_ / "on" / "design-report.json");
  EXPECT_EQ(gone_on["started_with"], stopped["scratches"]);
  for (std::size_t k = 0; k < stopped["views"].size(); ++k)
    EXPECT_NEAR(gone_on["views"][k]["start_psnr_db"].get<double>(), stopped["views"][k]["psnr_db"].get<double>(), 0.01);
}

// Hours of work end on a disk without room for the pictures: the scratches stay, and the rest is made of them later.
TEST_F(DesignCommand, WhereTheRestFindsNoRoomTheScratchesAreKept) {
  const std::string line =
      quoted(places::program()) + " design bench/design.json --count 300 --pixels 96 --iterations 2 --out ";
  const Outcome whole = run_shell(folder_, "cd " + quoted(folder_.path().string()) + " && " + line + "whole");
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  ASSERT_GT(fs::file_size(folder_ / "whole/contact-sheet.png"), 30U * 1024);
  // Files of at most 30 KiB stand for a full disk (blocks of 512 bytes).
  const Outcome full =
      run_shell(folder_, "cd " + quoted(folder_.path().string()) + " && ulimit -f 60 && " + line + "out");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_THAT(full.err, AllOf(HasSubstr("out/contact-sheet.png: could not be written whole"),
                              HasSubstr("The scratches alone found room"),
                              HasSubstr("--from out/scratches-kept.csv --iterations 0 --drop-error 0")));
  EXPECT_EQ(file_text(folder_ / "out/scratches-kept.csv"), file_text(folder_ / "whole/scratches.csv"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "out"), fs::directory_iterator()), 1);
  const Outcome later = run_burin(folder_, {"design", "bench/design.json", "--out", "out", "--from",
                                            "out/scratches-kept.csv", "--iterations", "0", "--drop-error", "0"});
  EXPECT_EQ(later.exit_code, 0) << later.err;
  EXPECT_EQ(file_text(folder_ / "out/scratches.csv"), file_text(folder_ / "whole/scratches.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "out/scratches-kept.csv"));
}

TEST_F(DesignCommand, TimeEndsTheStartToo) {
  // A start that alone would take longer by far.
  const auto began = std::chrono::steady_clock::now();
  const Outcome run = run_burin(folder_, {"design", "bench/design.json", "--out", "out", "--count", "1500000",
                                          "--pixels", "512", "--iterations", "1000000", "--time", "2s"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("the start was ended early"));
  EXPECT_THAT(run.out, HasSubstr("Stopped early. Go on with"));
  // Generous: other work runs beside the tests.
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), 90);
}

TEST_F(DesignCommand, LimitsHoldInTheFile) {
  folder_.write("m.json", R"({"format": "burin/machine", "version": 1, "limits": {"step_mm": 0.0125, "shortest_mm": 0.8,
      "longest_mm": 12, "min_distance_mm": 0.03, "max_overlap": 0.2, "max_grooves": 2}})");
  edit("board.json", [](Json& board) {
    board["keep_out"] = Json::parse(R"([{"name": "hole", "center_mm": [60, 60], "radius_mm": 6, "height_mm": 0},
                                        {"name": "clamp", "rect_mm": [[20, 50], [30, 70]], "height_mm": 0}])");
    board["tags"]["list"].push_back({{"id", 60}, {"center_mm", {85, 85}}, {"size_mm", 8}, {"rotation_deg", 20}});
  });
  const Outcome run = design({"--machine", "m.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("% of the carve area lie under keep-outs or tags"));
  const Scratches scratches = read_scratches(folder_ / "out" / "scratches.csv");
  EXPECT_GT(scratches.size(), 50U);
  const LimitsCheck check = check_limits(scratches, limits("m.json"));
  EXPECT_TRUE(check.good()) << check.first;

  const std::vector<std::string> toolpath{"toolpath",         "out/scratches.csv", "--board",
                                          "bench/board.json", "--machine",         "m.json"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> line = toolpath;
    line.insert(line.end(), more.begin(), more.end());
    return run_burin(folder_, line);
  };
  EXPECT_EQ(with({"--out", "board.gcode"}).exit_code, 0);
  // A design that knew of no limits is refused by the tool path, or mended.
  ASSERT_EQ(design({"--board", "bench/plain.json"}).exit_code, 1);
  fs::copy_file(fs::path(places::source()) / "samples" / "small-bench" / "board.json",
                folder_ / "bench" / "plain.json");
  ASSERT_EQ(design({"--board", "bench/plain.json"}).exit_code, 0);
  const Outcome refused = with({"--out", "free.gcode"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("scratch in row"), HasSubstr("faults in all")));
  EXPECT_FALSE(fs::exists(folder_ / "free.gcode"));
  const Outcome mended = with({"--out", "free.gcode", "--mend"});
  EXPECT_EQ(mended.exit_code, 0) << mended.err;
  EXPECT_THAT(mended.err, HasSubstr("are left out"));
  EXPECT_EQ(with({"--replay", "free.gcode", "--mend"}).exit_code, 0);
}

TEST_F(DesignCommand, WhatIsCarvedStaysAndOnlyTheRestIsSentToTheMachine) {
  edit("bench.json", [](Json& bench) { bench["machine"]["affine"] = {{1.001, 0, 0.2}, {0, 0.999, -0.1}}; });
  ASSERT_EQ(design({}, "first", "150").exit_code, 0);
  const Scratches first = read_scratches(folder_ / "first" / "scratches.csv");
  const Outcome run = design({"--carved", "first/scratches.csv"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr(std::to_string(first.size()) + " carved already"));
  const Scratches all = read_scratches(folder_ / "out" / "scratches.csv");
  std::size_t carved = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all.is_carved(i)) continue;
    EXPECT_NEAR(all.x0_mm[i], 1.001 * first.x0_mm[carved] + 0.2, 2e-5);
    EXPECT_NEAR(all.y1_mm[i], 0.999 * first.y1_mm[carved] - 0.1, 2e-5);
    ++carved;
  }
  EXPECT_EQ(carved, first.size());
  EXPECT_GT(all.size(), carved);
  EXPECT_LE(all.size(), 400U);
  const Outcome sent = run_burin(folder_, {"toolpath", "out/scratches.csv", "--board", "bench/board.json", "--bench",
                                           "bench/bench.json", "--out", "rest.gcode"});
  ASSERT_EQ(sent.exit_code, 0) << sent.err;
  EXPECT_THAT(sent.out, AllOf(HasSubstr(std::to_string(carved) + " scratches carved already"),
                              HasSubstr("Wrote " + std::to_string(all.size() - carved) + " scratches")));
  // Going on keeps what is carved.
  ASSERT_EQ(design({"--from", "out/scratches.csv"}, "on").exit_code, 0);
  EXPECT_EQ(read(folder_ / "on" / "design-report.json")["carved"], carved);
  expect_refusal(design({"--carved", "first/scratches.csv"}, "none", "20"), "20 scratches asked for", "carved already");
}

// A picture that is green where it is not transparent.
void write_clear(const fs::path& file, int width, int height, const std::function<bool(int x, int y)>& is_there) {
  std::vector<std::uint8_t> rgba;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      rgba.insert(rgba.end(), {20, 90, 20, static_cast<std::uint8_t>(is_there(x, y) ? 255 : 0)});
  const auto out = OIIO::ImageOutput::create(file.string());
  ASSERT_TRUE(out && out->open(file.string(), OIIO::ImageSpec(width, height, 4, OIIO::TypeDesc::UINT8)));
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, rgba.data()) && out->close());
}

TEST_F(DesignCommand, PicturesOfAnyKind) {
  // 16 bits, another aspect, and with transparency: a bright square on nothing.
  std::string deep = "P5 40 90 65535\n";
  for (int i = 0; i < 40 * 90; ++i) deep += {static_cast<char>(i / 20), static_cast<char>(i % 256)};
  folder_.write("bench/targets/deep.pgm", deep);
  write_clear(folder_ / "bench/targets/clear.png", 64, 32,
              [](int x, int y) { return x > 20 && x < 50 && y > 8 && y < 24; });
  edit("design.json", [](Json& d) {
    d["views"][0]["target"] = "targets/deep.pgm";
    d["views"][1]["target"] = "targets/clear.png";
    d["views"][1]["fit"] = "contain";
    d["views"][1]["mask"] = "targets/deep.pgm";
    d["views"][1]["levels"] = {0.1, 0.9};
    d["views"][1]["rotation_deg"] = "viewer";
  });
  const Outcome run = design({});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST_F(DesignCommand, PicturesThatCannotWork) {
  const fs::path boat = folder_ / "bench" / "targets" / "boat.png";
  const std::string whole = file_text(boat);
  folder_.write("bench/targets/boat.png", whole.substr(0, whole.size() / 2));
  expect_refusal(design({}, "none"), "boat.png", "cut short");
  folder_.write("bench/targets/boat.png", "");
  expect_refusal(design({}, "none"), "boat.png", "is empty");
  folder_.write("bench/targets/boat.png", whole);
  write_clear(folder_ / "bench/targets/clear.png", 2, 2, [](int, int) { return false; });
  edit("design.json", [](Json& d) { d["views"][0]["target"] = "targets/clear.png"; });
  expect_refusal(design({}, "none"), "clear.png", "one tone");
  edit("design.json", [](Json& d) { d["views"][0]["target"] = "targets/none.png"; });
  expect_refusal(design({}, "none"), "none.png", "does not exist");
  edit("design.json", [](Json& d) {
    d["views"][0]["target"] = "targets/boat.png", d["views"][0]["levels"] = {0.9, 0.1};
  });
  expect_refusal(design({}, "none"), "levels", "black below a white");
}

TEST_F(DesignCommand, ViewsThatCannotBeToldApartAreNamedWithHowMuch) {
  const Json bench = edit("bench.json", [](Json& b) {
    Json twin = b["views"][0];
    twin["view"] = "twin";
    b["views"].push_back(twin);
  });
  edit("design.json", [](Json& d) {
    Json twin = d["views"][1];
    twin["view"] = "twin";
    d["views"].push_back(twin);
  });
  const std::string first = bench["views"][0]["view"];
  const Outcome run = design({});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("views " + first + " and twin: collide: their scratches run only 0.0 degrees apart"));
  EXPECT_THAT(run.err, HasSubstr("shows 100 % of its light in the other"));
}

TEST_F(DesignCommand, ABenchOnWhichNoGrooveCanGlint) {
  for (const char* file : {"bench.json", "board.json"}) edit(file, [](Json& b) { b["material"]["depth_um"] = 0.2; });
  expect_refusal(design({}, "none"), "no groove can glint there", "um deep with this cutter");
}

TEST_F(DesignCommand, WrongCommandLines) {
  EXPECT_EQ(design({"--time", "soon"}).exit_code, 2);
  EXPECT_EQ(design({"--start", "anywhere"}).exit_code, 2);
  EXPECT_EQ(run_burin(folder_, {"design", "bench/design.json"}).exit_code, 2);
  expect_refusal(design({"--machine", "toaster"}, "none"), "toaster", "linuxcnc, marlin or laser-z");
}

}  // namespace
}  // namespace burin
