// Proves, in a real browser: the page of `burin view` shows what `burin render` shows (35 dB and more, on the board's
// own pixels), for a small design, and for a bench with all that a bench can have; it is one file that loads nothing
// else, runs under a policy that names its scripts, obeys keys, fingers and a tilted phone, fits 390 pixels, and says
// what to do where nothing can be shown.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <string>

#include "burin/base/image.h"
#include "burin/pictures/picture.h"
#include "burin/scene/scratches.h"
#include "tests/places.h"
#include "tests/tools/chromium.h"
#include "tests/tools/loop_bench.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Json = nlohmann::ordered_json;

// Over the pixels that either picture has something in: the black around the board would flatter.
double psnr_on_board(const Image& a, const Image& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.channels, 3);
  EXPECT_EQ(b.channels, 3);
  if (a.data.size() != b.data.size()) return 0;
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.data.size(); i += 3) {
    bool any = false;
    double squares = 0;
    for (std::size_t c = i; c < i + 3; ++c) {
      any = any || a.data[c] > 0 || b.data[c] > 0;
      squares += (a.data[c] - b.data[c]) * (a.data[c] - b.data[c]);
    }
    if (!any) continue;
    sum += squares;
    count += 3;
  }
  EXPECT_GT(count, a.data.size() / 10);
  return -10 * std::log10(sum / static_cast<double>(count) + 1e-12);
}

// A project of the sample's, smaller: 600 scratches for two pictures, photos of 450 x 350 pixels, designed in a second.
class ViewPage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!Chromium::is_installed()) GTEST_SKIP() << Chromium::kMissing;
    make_tiny_project(folder_, {"v00"}, 0.5);
    project_ = folder_ / "project";
    take_small_camera();
  }
  void take_small_camera() const {
    std::ofstream(project_ / "camera.cameramodel") << "{ 'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [ 1150, 1150, "
                                                      "224.5, 174.5 ], 'extrinsics': [ 0, 0, 0, 0, 0, "
                                                      "0 ], 'imagersize': [ 450, 350 ] }\n";
  }
  void design() const {
    const Outcome run = run_burin(
        folder_, {"design", "project/design.json", "--out", "project/design", "--pixels", "64", "--iterations", "10"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  fs::path view(const std::vector<std::string>& arguments) const {
    std::vector<std::string> line{"view"};
    line.insert(line.end(), arguments.begin(), arguments.end());
    line.insert(line.end(), {"--out", "view.html"});
    const Outcome run = run_burin(folder_, line);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("Wrote view.html"));
    return folder_ / "view.html";
  }
  Image rendered(const std::string& view, const std::string& scratches) const {
    const Outcome run = run_burin(folder_, {"render", "project/board.json", "--bench", "project/bench.json", "--view",
                                            view, "--scratches", scratches, "--out", "render.png"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return read_picture(folder_ / "render.png");
  }
  Image shown(Chromium& browser, const fs::path& page, const std::string& fragment) const {
    browser.open(page, 800, 600, "picture&look=photo&" + fragment);
    std::ofstream(folder_ / "shown.png", std::ios::binary)
        << Chromium::from_base64(browser.evaluate("burinView.picture()").get<std::string>());
    EXPECT_THAT(browser.complaints(), IsEmpty());
    return read_picture(folder_ / "shown.png");
  }

  TemporaryFolder folder_;
  fs::path project_;
};

TEST_F(ViewPage, AgreesWithRenderAtEachDesignedView) {
  design();
  const fs::path page = view({"project"});
  EXPECT_LT(fs::file_size(page), 500'000U);
  Chromium browser(folder_);
  for (const std::string name : {"d0", "d1"}) {
    const double psnr =
        psnr_on_board(shown(browser, page, "view=" + name), rendered(name, "project/design/scratches.csv"));
    std::printf("view %s: %.1f dB\n", name.c_str(), psnr);
    EXPECT_GT(psnr, 35) << name;
  }
  // Lesser machines: sums of half floats are as good; 8 bits keep the picture.
  const Image exact = rendered("d0", "project/design/scratches.csv");
  EXPECT_GT(psnr_on_board(shown(browser, page, "view=d0&sums=16"), exact), 35);
}

// Grooves in all directions with widths, depths and roughnesses of their own, on a bowed board under a colored spot and
// room light, through a lens that bends much.
TEST_F(ViewPage, AgreesWithRenderOnABenchThatHasEverything) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::string rows = "x0_mm,y0_mm,x1_mm,y1_mm,width_um,depth_um,alpha\n";
  for (int i = 0; i < 3000; ++i) {
    const double a = uniform(random) * 2 * std::numbers::pi, x = 25 + 70 * uniform(random),
                 y = 25 + 70 * uniform(random);
    const double half = 0.1 + 5 * uniform(random) * uniform(random);
    rows += std::to_string(x - half * std::cos(a)) + "," + std::to_string(y - half * std::sin(a)) + "," +
            std::to_string(x + half * std::cos(a)) + "," + std::to_string(y + half * std::sin(a)) + "," +
            std::to_string(300 + 200 * uniform(random)) + "," + std::to_string(8 + 10 * uniform(random)) + "," +
            std::to_string(0.03 + 0.1 * uniform(random)) + "\n";
  }
  folder_.write("all.csv", rows);
  Json bench = read_json_file(project_ / "bench.json");
  bench["lights"][0]["intensity"] = {1.0, 0.8, 0.5};
  bench["lights"][0]["axis"] = {0, 0.55, -0.8};
  bench["lights"][0]["falloff_exponent"] = 3;
  bench["ambient"] = {2e-8, 3e-8, 6e-8};
  bench["board"]["bow_mm"] = {0.8, 0.3, -0.5};
  std::ofstream(project_ / "bench.json") << bench;
  std::ofstream(project_ / "camera.cameramodel")
      << "{ 'lensmodel': 'LENSMODEL_OPENCV8', 'intrinsics': [ 1150, 1140, 220, 180, -0.6, 0.3, 0.01, -0.02, 0.1, 0.05, "
         "0.02, "
         "0.01 ], 'extrinsics': [ 0, 0, 0, 0, 0, 0 ], 'imagersize': [ 450, 350 ] }\n";
  const fs::path page =
      view({"--board", "project/board.json", "--bench", "project/bench.json", "--scratches", "all.csv"});
  Chromium browser(folder_);
  for (const std::string name : {"d0", "d1", "d2"}) {
    const double psnr = psnr_on_board(shown(browser, page, "view=" + name), rendered(name, "all.csv"));
    std::printf("view %s: %.1f dB\n", name.c_str(), psnr);
    EXPECT_GT(psnr, 35) << name;
  }
}

// Three lamps at once: their light adds up, in gray and in color; surroundings count once.
TEST_F(ViewPage, AddsUpTheLightOfLampsThatShineAtOnce) {
  Json bench = read_json_file(project_ / "bench.json"), wanted = read_json_file(project_ / "design.json");
  const Json lamp = bench["lights"][0];
  bench["lights"] = Json::array();
  for (const char* id : {"red", "green", "blue"}) {
    const int c = static_cast<int>(bench["lights"].size());
    Json one = lamp;
    one["id"] = id;
    one["position_mm"][0] = lamp["position_mm"][0].get<double>() + 12 * (c - 1);
    for (int k = 0; k < 3; ++k) one["intensity"][k] = lamp["intensity"][0].get<double>() * (k == c ? 1 : 0.2);
    bench["lights"].push_back(one);
  }
  wanted["views"][0].erase("light");
  wanted["views"][0]["lights"] = {"red", "green", "blue"};
  wanted["views"][0]["color"] = true;
  wanted["views"][0]["white"] = {1, 1, 1};  // as `burin render` shows it
  wanted["views"][1].erase("light");
  wanted["views"][1]["lights"] = {"green", "blue"};
  std::ofstream(project_ / "bench.json") << bench;
  std::ofstream(project_ / "design.json") << wanted;
  design();
  const fs::path page = view({"project"});
  Chromium browser(folder_);
  for (const auto& [name, light] : {std::pair{"d0", "red + green + blue"}, std::pair{"d1", "green + blue"}}) {
    const Outcome run =
        run_burin(folder_, {"render", "project/board.json", "--bench", "project/bench.json", "--view", name, "--lamp",
                            light, "--scratches", "project/design/scratches.csv", "--out", "render.png"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const Image whole = read_picture(folder_ / "render.png");
    for (const std::string sums : {"", "&sums=16", "&sums=8"}) {
      const double psnr = psnr_on_board(shown(browser, page, std::string("view=") + name + sums), whole);
      std::printf("view %s%s: %.1f dB\n", name, sums.c_str(), psnr);
      if (sums != "&sums=8") {
        EXPECT_GT(psnr, 35) << name << sums;
      }
    }
  }
  // The whole page, with what moves: no complaint.
  browser.open(page, 1280, 900, "view=d0");
  browser.press("l");
  browser.press("ArrowUp");
  browser.press(" ");
  browser.evaluate("new Promise(done => setTimeout(done, 300))");
  EXPECT_THAT(browser.complaints(), IsEmpty());
}

// A round that was measured: the lamp is not where it was believed, and the machine carves beside its place.
TEST_F(ViewPage, ShowsTheBoardBeforeAndAfterItWasMeasured) {
  design();
  const fs::path round = project_ / "round-01";
  fs::create_directories(round);
  Json wanted = read_json_file(project_ / "design.json"), bench = read_json_file(project_ / "bench.json");
  for (const char* name : {"board", "bench"}) wanted[name] = "../" + wanted[name].get<std::string>();
  for (Json& view : wanted["views"]) view["target"] = "../" + view["target"].get<std::string>();
  bench["camera"] = "../camera.cameramodel";
  bench["lights"][0]["position_mm"][0] = bench["lights"][0]["position_mm"][0].get<double>() + 12;
  bench["machine"]["affine"] = {{1, 0, 1.5}, {0, 1, -1}};
  std::ofstream(round / "design.json") << wanted;
  std::ofstream(round / "bench.json") << bench;
  fs::copy(project_ / "design" / "scratches.csv", round / "scratches.csv");
  fs::copy(project_ / "design" / "scratches.csv", round / "sent.csv");
  const fs::path page = view({"project"});
  const Outcome run =
      run_burin(folder_, {"render", "project/board.json", "--bench", "project/round-01/bench.json", "--view", "d1",
                          "--as-carved", "--scratches", "project/round-01/sent.csv", "--out", "render.png"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  Chromium browser(folder_);
  const Image carved = read_picture(folder_ / "render.png");
  EXPECT_GT(psnr_on_board(shown(browser, page, "board=1&view=d1"), carved), 35);
  EXPECT_LT(psnr_on_board(shown(browser, page, "board=0&view=d1"), carved), 30);

  browser.open(page, 1280, 900);
  EXPECT_EQ(browser.evaluate("[...document.querySelectorAll('#boards button')].map(b => b.textContent).join()"),
            "Before,As carved");
  browser.press("b");
  EXPECT_EQ(browser.evaluate("burinView.state.board"), 1);
  EXPECT_THAT(browser.evaluate("document.getElementById('sentence').textContent").get<std::string>(),
              HasSubstr("as it was carved"));
  EXPECT_EQ(browser.evaluate("[...document.querySelectorAll('.gallery')].map(g => g.hidden).join()"), "true,false");
  EXPECT_THAT(browser.complaints(), IsEmpty());
}

TEST_F(ViewPage, ObeysKeysFingersAndATiltedPhone) {
  design();
  const fs::path page = view({"project"});
  Chromium browser(folder_);
  browser.open(page, 390, 800, "", true);
  const auto picture = [&] {  // its digest, so that a failure can be read
    return std::hash<std::string>()(browser.evaluate("burinView.picture()").get<std::string>());
  };
  const auto status = [&] {
    return browser
        .evaluate(
            "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => "
            "done(document.getElementById('status').textContent))))")
        .get<std::string>();
  };
  EXPECT_LE(browser.evaluate("document.documentElement.scrollWidth").get<int>(), 390);
  EXPECT_EQ(status(), "You stand at d0.");
  const std::size_t first = picture();
  browser.press("ArrowLeft", 8);  // with Shift: five degrees
  EXPECT_THAT(status(), AllOf(HasSubstr("from d0"), HasSubstr("beyond")));
  const std::size_t aside = picture();
  EXPECT_NE(aside, first);
  browser.press("2");
  EXPECT_EQ(status(), "You stand at d1.");
  browser.press("1");
  EXPECT_EQ(picture(), first);  // the same place, the same picture
  browser.press("l");
  browser.press("ArrowUp");
  EXPECT_EQ(status(), "You stand at d0.");  // the lamp moved, not the eye
  EXPECT_NE(picture(), first);
  browser.press("Home");
  browser.press("l");
  EXPECT_EQ(picture(), first);
  browser.drag(100, 250, 160, 250, true);
  EXPECT_THAT(status(), HasSubstr("\u00b0 from d"));
  browser.press("Home");
  browser.press(" ");  // walks by itself, and stops where it is
  EXPECT_EQ(browser.evaluate("document.getElementById('walk').getAttribute('aria-pressed')"), "true");
  EXPECT_THAT(
      browser.evaluate("new Promise(done => { const look = () => burinView.state.picture === 1 ? done('there') : "
                       "setTimeout(look, 100); look(); })"),
      "there");
  browser.press(" ");
  EXPECT_EQ(browser.evaluate("burinView.state.walk"), nullptr);
  browser.press("Home");
  browser.press("t");
  EXPECT_EQ(browser.evaluate("document.getElementById('target').hidden"), true);

  browser.evaluate("document.getElementById('tilt').click()");
  browser.evaluate(
      "new Promise(done => { const look = () => burinView.state.tilt ? done() : setTimeout(look, 20); look(); })");
  const auto hold = [&](double beta) {
    browser.evaluate("dispatchEvent(new DeviceOrientationEvent('deviceorientation', { alpha: 0, beta: " +
                     std::to_string(beta) + ", gamma: 0 }))");
  };
  hold(30);
  EXPECT_EQ(picture(), first);  // as it was held first
  hold(36);
  EXPECT_NE(picture(), first);
  EXPECT_THAT(status(), HasSubstr("5.2\u00b0 from d0"));  // 6 about x, for an eye 60 degrees from x: 6 sin 60
  EXPECT_THAT(browser.complaints(), IsEmpty());
}

TEST_F(ViewPage, IsOneFileUnderAStrictPolicyAndSaysItWithoutWebGL) {
  design();
  const fs::path page = view({"project"});
  const std::string text = file_text(page);
  EXPECT_THAT(text, AllOf(HasSubstr("default-src 'none'; img-src data:; script-src 'sha256-"),
                          Not(HasSubstr("unsafe-")), Not(HasSubstr(" style=\"")), Not(HasSubstr("{{"))));
  Chromium browser(folder_);
  browser.open(page, 1280, 900, "", false, true);
  EXPECT_THAT(browser.complaints(), IsEmpty());
  EXPECT_THAT(browser.requests(), IsEmpty());
  EXPECT_EQ(browser.evaluate("document.getElementById('stage').hidden"), false);
  EXPECT_EQ(browser.evaluate("[...document.images].filter(i => !i.hasAttribute('alt')).length"), 0);
  EXPECT_EQ(browser.evaluate("[...document.querySelectorAll('button')].filter(b => !b.textContent.trim()).length"), 0);

  browser.open(page, 1280, 900,
               "picture&size=0xyz&view=%&eye=1,2&exposure=-3&board=99&look=upside");  // an address of nonsense
  EXPECT_EQ(browser.evaluate("burinView.state.look"), "seen");
  EXPECT_THAT(browser.complaints(), IsEmpty());

  browser.command("Page.addScriptToEvaluateOnNewDocument",
                  {{"source", "HTMLCanvasElement.prototype.getContext = () => null;"}});
  browser.open(page, 390, 800, "", true);
  EXPECT_THAT(browser.evaluate("document.getElementById('without').innerText").get<std::string>(),
              HasSubstr("no WebGL2"));
  EXPECT_EQ(browser.evaluate("document.getElementById('stage').hidden"), true);
  EXPECT_EQ(browser.evaluate("document.querySelectorAll('img.seen').length"), 2);
  EXPECT_THAT(browser.complaints(), IsEmpty());
}

// What `burin new` leaves is no design: few scratches, and a picture of them.
TEST_F(ViewPage, CallsAPreviewAPreview) {
  design();
  fs::rename(project_ / "design" / "scratches.csv", project_ / "scratches.csv");
  Json json = Json::parse(file_text(project_ / "board.json"));
  json["scratches"] = "scratches.csv";
  std::ofstream(project_ / "board.json") << json.dump();
  EXPECT_THAT(file_text(view({"project"})), AllOf(HasSubstr("\"As designed\""), Not(HasSubstr("quick preview"))));
  std::ofstream(project_ / "preview.png") << "a picture";
  EXPECT_THAT(file_text(view({"project"})),
              AllOf(HasSubstr("\"Preview\""), HasSubstr("A quick preview, "),
                    HasSubstr(" of 600 scratches; burin loop project designs the whole board."),
                    Not(HasSubstr("\"As designed\""))));
}

TEST_F(ViewPage, CountsGroovesAndNotTheirPieces) {
  Json bench = Json::parse(file_text(project_ / "bench.json"));
  bench["material"]["crossings"] = "deepest";
  std::ofstream(project_ / "bench.json") << bench.dump();
  design();
  const std::size_t grooves = read_scratches(project_ / "design" / "scratches.csv").size();
  const Outcome run = run_burin(folder_, {"view", "project", "--out", "view.html"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("view.html: " + std::to_string(grooves) + " grooves, 2 places"));
}

TEST_F(ViewPage, SaysWhatToDoWhereThereIsNothingToShow) {
  const auto refused = [&](const std::vector<std::string>& line, const std::string& what) {
    const Outcome run = run_burin(folder_, line);
    EXPECT_EQ(run.exit_code, 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(what));
    EXPECT_FALSE(fs::exists(folder_ / "out.html"));
  };
  refused({"view", "project", "--out", "out.html"},
          "nothing is designed here yet; run burin design project/design.json");
  refused({"view", "nowhere", "--out", "out.html"}, "name a project folder");
  refused({"view", "--board", "project/board.json", "--bench", "project/bench.json", "--out", "out.html"},
          "scratches.csv: does not exist");
  EXPECT_EQ(run_burin(folder_, {"view"}).exit_code, 2);
  EXPECT_EQ(run_burin(folder_, {"view", "project", "--board", "project/board.json"}).exit_code, 2);
  design();
  refused({"view", "project", "--out", "no/such/folder/out.html"}, "no/such/folder");
}

}  // namespace
}  // namespace burin
