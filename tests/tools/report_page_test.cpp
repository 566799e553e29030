// Proves, in a real browser, that reports can be read and used: nothing is wider than a phone, every picture says what
// it shows, no number has an exponent, numbers are folded, the wipe follows keys, mouse and finger, all pictures of a
// place zoom together, light and dark have contrast, and nothing breaks the page's own policy. On a project whose first
// board was photographed (by the simulated camera) and whose second is designed. What reports say is proved in
// html_test and rerun_test; how right it is, in the rooms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/parameter_name.h"
#include "tests/tools/chromium.h"
#include "tests/tools/loop_bench.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// The truth as it is measured: poses and lamp right, with sigmas; the depth left open.
Bench measured_bench(const Json& truth, const fs::path& nominal) {
  Bench bench = read_bench(nominal);
  bench.camera.clear();
  bench.lens.intrinsics = truth["camera"]["intrinsics"].get<std::vector<double>>();
  bench.lens.width = truth["camera"]["imagersize"][0];
  bench.lens.height = truth["camera"]["imagersize"][1];
  bench.views.clear();
  for (const Json& view : truth["views"]) {
    View& seen = bench.views.emplace_back();
    seen.name = view["view"];
    Eigen::Matrix4d pose;
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) pose(r, c) = view["T_camera_board"][r][c].get<double>();
    seen.T_camera_board.matrix() = pose;
    seen.center_sigma_mm = Eigen::Vector3d(0.1, 0.1, 0.3);
    seen.tags = 16;
    seen.reprojection_rms_px = 0.03;
  }
  for (int i = 0; i < 3; ++i) bench.lights[0].position_mm[i] = truth["lights"][0]["position_mm"][i];
  bench.lights[0].position_sigma_mm = Eigen::Vector3d(0.2, 0.3, 0.4);
  bench.material.alpha = 0.06;
  bench.material_sigma.alpha = 0.00004;
  bench.machine_affine_sigma = Affine2::Constant(1e-5);
  Verdict known{Source::measured, Degree::determined, 0.07, Unit::percent, {}, {}}, open;
  known.causes = {{Cause::Kind::above_noise, {562.4}, ""}};
  open.next_photo = NextPhoto{NextPhoto::Kind::at_place, "camera 620 mm above the board's middle", 4.25, {}};
  bench.verdict[parameter::kAlpha] = known;
  bench.verdict[parameter::kDepth] = open;
  return bench;
}

// One project for all tests of this file: it takes a few seconds to make.
class ReportPage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!folder_) make_project();
    ASSERT_TRUE(told_);
    ASSERT_EQ(told_->exit_code, 0) << told_->err;
    page_ = *folder_ / "my bench" / "report.html";
  }
  static void TearDownTestSuite() {
    folder_.reset();
    told_.reset();
  }

  static void make_project() {
    folder_ = std::make_unique<TemporaryFolder>();
    const TemporaryFolder& folder = *folder_;
    make_tiny_project(folder, {"d0", "d1", "c0", "c2", "c3"}, 1.0 / 3);
    fs::rename(folder / "project", folder / "my bench");
    const fs::path project = folder / "my bench", round = project / "round-01";
    ASSERT_EQ(run_burin(folder, {"design", "my bench/design.json", "--count", "400", "--pixels", "64", "--iterations",
                                 "4", "--out", "my bench/round-01/design"})
                  .exit_code,
              0);
    Json truth = read_json_file(folder / "truth.json");
    truth["session"] = true;
    std::ofstream(folder / "truth.json") << truth;
    fs::copy_file(round / "design" / "scratches.csv", round / "scratches.csv");
    const Outcome photos = run_burin(folder, {"simulate", "truth.json", "--scratches",
                                              "my bench/round-01/design/scratches.csv", "--out", "my bench/round-01"});
    ASSERT_EQ(photos.exit_code, 0) << photos.err;
    Json design = read_json_file(project / "design.json");
    for (const char* key : {"board", "bench"}) design[key] = "../" + design[key].get<std::string>();
    for (Json& view : design["views"]) view["target"] = "../" + view["target"].get<std::string>();
    std::ofstream(round / "design.json") << design;
    const Board board = read_board(project / "board.json");
    write_bench(measured_bench(truth, project / "bench.json"), board.tool_width_um, round / "bench.json");
    fs::create_directories(project / "round-02");
    design["bench"] = "../round-01/bench.json";
    std::ofstream(project / "round-02" / "design.json") << design;
    fs::copy_file(round / "scratches.csv", project / "round-02" / "scratches.csv");
    told_ = std::make_unique<Outcome>(run_burin(folder, {"report", "my bench"}));
  }
  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline std::unique_ptr<Outcome> told_;
  fs::path page_;
};

constexpr const char* kWiderThanTheWindow =
    "document.documentElement.scrollWidth - document.documentElement.clientWidth";
constexpr const char* kUnfold = "document.querySelectorAll('details').forEach(d => d.open = true), 0";

// What must hold of every page, in both widths, folded and unfolded, light and dark.
void expect_readable(Chromium& browser, const fs::path& page) {
  for (const int width : {1280, 390})
    for (const bool dark : {false, true}) {
      browser.open(page, width, 900, "", width == 390, dark);
      const std::string where = page.string() + " at " + std::to_string(width) + (dark ? " px, dark" : " px, light");
      EXPECT_LE(browser.evaluate(kWiderThanTheWindow).get<int>(), 0) << where;
      EXPECT_EQ(browser.evaluate("document.querySelectorAll('details.fold[open]').length"), 0) << where;
      EXPECT_GT(browser.evaluate("document.images.length").get<int>(), 0) << where;
      EXPECT_EQ(browser.evaluate("[...document.images].filter(i => !i.alt.trim() || !i.naturalWidth).length"), 0)
          << where;
      browser.evaluate(kUnfold);
      EXPECT_LE(browser.evaluate(kWiderThanTheWindow).get<int>(), 0) << where << ", unfolded";
      // WCAG 2.1, 1.4.3: text of this size needs a contrast of 4.5. Relative luminance as it is defined there.
      const auto contrast = browser.evaluate(R"js((() => {
        const channels = (color) => color.match(/[\d.]+/g).slice(0, 3).map(Number);
        const light = (color) => channels(color).map(v => v / 255)
            .map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
            .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
        const ground = light(getComputedStyle(document.body).backgroundColor);
        return [...document.querySelectorAll('main p, main td, main summary span, main .good, main span.warning, main span.error, main h2')].map(e => {
          const ink = light(getComputedStyle(e).color);
          return (Math.max(ink, ground) + 0.05) / (Math.min(ink, ground) + 0.05);
        }).reduce((a, b) => Math.min(a, b), 21); })())js");
      EXPECT_GE(contrast.get<double>(), 4.5) << where;
      EXPECT_THAT(browser.complaints(), IsEmpty()) << where;
      EXPECT_THAT(browser.requests(), IsEmpty()) << where;
    }
  EXPECT_THAT(browser.evaluate("document.body.innerText").get<std::string>(),
              AllOf(Not(ContainsRegex("[0-9]e[+-]?[0-9]")), Not(HasSubstr("nan")), Not(HasSubstr("inf "))));
}

TEST_F(ReportPage, SaysFirstWhatCameOutAndWhatToDo) {
  EXPECT_THAT(
      told_->out,
      AllOf(ContainsRegex("^The board shows its 2 pictures at [0-9.]+ dB on average .*; promised were [0-9.]+ dB; "
                          "designed for the bench as measured, the next one promises [0-9.]+ dB, "
                          "[0-9.]+ dB (better|worse) than this one shows[.]\n"),
            HasSubstr("the photo that would help most: camera 620 mm above"), HasSubstr(" MB); ")));
  const std::string text = file_text(page_);
  EXPECT_THAT(text, AllOf(HasSubstr("burin loop 'my bench'"), HasSubstr("562 times what the camera"),
                          HasSubstr("Round 2, promised"), HasSubstr("Round after round")));
}

TEST_F(ReportPage, CanBeReadOnADeskAndOnAPhoneByDayAndByNight) {
  if (!Chromium::is_installed()) GTEST_SKIP() << Chromium::kMissing;
  Chromium browser(*folder_);
  expect_readable(browser, page_);
  // The pages of a round (a session and a design) and of a design alone share the look.
  for (const char* folder : {"my bench/round-01", "my bench/round-01/design"}) {
    const Outcome run = run_burin(*folder_, {"report", folder});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    expect_readable(browser, *folder_ / folder / "report.html");
  }
  EXPECT_THAT(
      file_text(*folder_ / "my bench" / "round-01" / "report.html"),
      HasSubstr("<b>Next:</b> the next board, designed for the bench as it is: <code>burin loop 'my bench'</code>"));
  // So does the page before metal moves.
  ASSERT_EQ(
      run_burin(*folder_, {"toolpath", "my bench/round-01/scratches.csv", "--board", "my bench/board.json", "--bench",
                           "my bench/bench.json", "--machine", "grbl-spring", "--out", "my bench/round-01/board.gcode"})
          .exit_code,
      0);
  ASSERT_EQ(run_burin(*folder_, {"check", "carve", "my bench/round-01", "--machine", "grbl-spring"}).exit_code, 0);
  expect_readable(browser, *folder_ / "my bench" / "round-01" / "carve-check.html");
  // The bench in space says in words what it shows.
  browser.open(page_, 390, 800, "", true);
  EXPECT_THAT(
      browser.evaluate("document.querySelector('.bench-scene canvas').getAttribute('aria-label')").get<std::string>(),
      HasSubstr("The bench as measured in space: 5 cameras, 1 lamp and the board, with ellipsoids"));
  // What the dark page's paper and ink are, not only that they differ.
  browser.open(page_, 390, 800, "", true, true);
  const std::string paper = "getComputedStyle(document.body).backgroundColor";
  const auto dark = browser.evaluate(paper);
  browser.open(page_, 390, 800, "", true, false);
  EXPECT_EQ(dark, "rgb(20, 23, 26)");
  EXPECT_EQ(browser.evaluate(paper), "rgb(251, 251, 249)");
  // On a phone a row is a card, and its cells name their column.
  browser.evaluate(kUnfold);
  EXPECT_EQ(browser.evaluate("getComputedStyle(document.querySelector('tr td')).display"), "block");
  EXPECT_THAT(browser.evaluate("getComputedStyle(document.querySelectorAll('tbody td')[1], '::before').content")
                  .get<std::string>(),
              ContainsRegex("^\"Round 1: promised of a photo .[0-9]+ px.: \"$"));
}

TEST_F(ReportPage, WipesByKeysMouseAndFinger) {
  if (!Chromium::is_installed()) GTEST_SKIP() << Chromium::kMissing;
  Chromium browser(*folder_);
  browser.open(page_, 1280, 900);
  const auto share = [&] {
    return std::stod(browser.evaluate("document.querySelector('.wipe').value").get<std::string>());
  };
  const std::string clip = "getComputedStyle(document.querySelector('.layer.right')).clipPath";
  EXPECT_EQ(browser.evaluate("document.querySelector('.wipe').getAttribute('aria-label')"),
            "View d0: wipe between Target and Round 1, photographed");
  EXPECT_EQ(share(), 50);
  EXPECT_EQ(browser.evaluate(clip), "inset(0px 0px 0px 50%)");
  browser.evaluate("document.querySelector('.wipe').focus(), 0");
  browser.press("ArrowLeft");
  EXPECT_EQ(share(), 49);
  browser.press("End");
  EXPECT_EQ(browser.evaluate(clip), "inset(0px 0px 0px 100%)");
  browser.evaluate("document.querySelector('.stage').focus(), 0");
  browser.press("ArrowLeft");
  EXPECT_EQ(share(), 96);

  const Json box = browser.evaluate(
      "(r => [r.left, r.top, r.width, r.height])(document.querySelector('.stage').getBoundingClientRect())");
  const double x = box[0], y = box[1].get<double>() + 0.3 * box[3].get<double>(), width = box[2];
  browser.drag(x + 0.5 * width, y, x + 0.25 * width, y);
  EXPECT_NEAR(share(), 25, 1);
  // Another pair of pictures.
  browser.evaluate(
      "(s => { s.value = '1'; s.dispatchEvent(new Event('change')); })(document.querySelector('select.left'))");
  EXPECT_EQ(browser.evaluate("document.querySelector('.name.left').textContent"), "Round 1, promised");
  EXPECT_THAT(browser.evaluate("document.querySelector('.layer.left img').alt").get<std::string>(),
              HasSubstr("round 1: promised"));
  EXPECT_THAT(browser.complaints(), IsEmpty());

  browser.open(page_, 390, 800, "", true);
  const Json phone = browser.evaluate(
      "(r => [r.left, r.top, r.width, r.height])(document.querySelector('.stage').getBoundingClientRect())");
  const double px = phone[0], py = phone[1].get<double>() + 0.3 * phone[3].get<double>(), across = phone[2];
  browser.drag(px + 0.5 * across, py, px + 0.8 * across, py, true);
  EXPECT_NEAR(share(), 80, 2);
}

TEST_F(ReportPage, ZoomsAllPicturesOfAPlaceInLockstep) {
  if (!Chromium::is_installed()) GTEST_SKIP() << Chromium::kMissing;
  Chromium browser(*folder_);
  browser.open(page_, 1280, 900);
  const std::string transforms =
      "[...new Set([...document.querySelectorAll('.compare img')].map(i => i.style.transform))].join('|')";
  EXPECT_EQ(browser.evaluate(transforms), "");
  browser.evaluate("document.querySelector('.stage').focus(), 0");
  browser.press("+");
  browser.press("+");
  const std::string zoomed = browser.evaluate(transforms);
  EXPECT_THAT(zoomed, AllOf(HasSubstr("scale(2.56"), Not(HasSubstr("|")))) << "all views, target, promise and photo";
  EXPECT_EQ(browser.evaluate("getComputedStyle(document.querySelector('.compare img')).imageRendering"), "pixelated");
  browser.press("ArrowRight");  // the picture's right part comes into view, the wipe stays
  const std::string moved = browser.evaluate(transforms);
  EXPECT_NE(moved, zoomed);
  EXPECT_THAT(moved, Not(HasSubstr("|")));
  EXPECT_EQ(browser.evaluate("document.querySelector('.wipe').value"), "50");
  for (int i = 0; i < 40; ++i) browser.press("ArrowRight");
  // Not beyond the picture: its right edge is the window's.
  EXPECT_NEAR(browser
                  .evaluate("(s => s.querySelector('.layer.left img').getBoundingClientRect().right - "
                            "s.getBoundingClientRect().right)(document.querySelector('.stage'))")
                  .get<double>(),
              0, 0.5);
  browser.press("0");
  EXPECT_EQ(browser.evaluate(transforms), "none");
}

TEST_F(ReportPage, IsWholeOnPaperAndWithoutScripts) {
  if (!Chromium::is_installed()) GTEST_SKIP() << Chromium::kMissing;
  Chromium browser(*folder_);
  browser.open(page_, 1280, 900);
  browser.command("Emulation.setEmulatedMedia", {{"media", "print"}});
  browser.evaluate("dispatchEvent(new Event('beforeprint')), 0");
  EXPECT_EQ(browser.evaluate("getComputedStyle(document.querySelector('.stage')).display"), "none");
  EXPECT_EQ(browser.evaluate("document.querySelectorAll('details:not([open])').length"), 0);
  EXPECT_THAT(browser.evaluate("document.body.innerText").get<std::string>(), HasSubstr("Scale along x"));
  browser.evaluate("dispatchEvent(new Event('afterprint')), 0");
  EXPECT_EQ(browser.evaluate("document.querySelectorAll('details.fold[open]').length"), 0);

  browser.command("Emulation.setScriptExecutionDisabled", {{"value", true}});
  browser.open(page_, 390, 800, "", true);
  EXPECT_EQ(browser.evaluate("document.querySelectorAll('.stage').length"), 0);
  EXPECT_EQ(browser.evaluate("document.querySelectorAll('.compare')[0].querySelectorAll('img').length"), 4)
      << "target, promised, photographed, promised next";
  EXPECT_GT(browser.evaluate("document.querySelector('.compare img').getBoundingClientRect().width").get<double>(),
            200);
  EXPECT_LE(browser.evaluate(kWiderThanTheWindow).get<int>(), 0);
}

}  // namespace
}  // namespace burin
