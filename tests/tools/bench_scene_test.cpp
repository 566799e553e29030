// Proves: the bench in three dimensions, in a page under the strict policy, draws what it is given, turns by finger and
// key, says by what factor ellipsoids are enlarged, and lists the places in words; odd names and benches without
// numbers do no harm.
#include "tools/view/bench_scene.h"

#include <gmock/gmock.h>

#include "tests/tools/chromium.h"
#include "tools/content_policy.h"

namespace burin {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Board small_board() {
  Board board;
  board.size_mm = {200, 150};
  board.carve_min_mm = {20, 20};
  board.carve_max_mm = {180, 130};
  board.tags.list = {{0, {10, 10}, 16, 0}, {1, {190, 140}, 16, 30}};
  return board;
}

Bench small_bench() {
  Bench bench;
  bench.lens = {"LENSMODEL_PINHOLE", {1000, 1000, 450, 350}, 900, 700};
  for (int i = 0; i < 3; ++i) {
    View view;
    view.name = i == 1 ? "</script><b>odd" : "d" + std::to_string(i);
    const Eigen::Vector3d eye(100 + 300 * (i - 1), -150, 500), z = (Eigen::Vector3d(100, 75, 0) - eye).normalized();
    const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitY()).normalized(), y = z.cross(x);
    Eigen::Matrix3d R;
    R << x.transpose(), y.transpose(), z.transpose();
    view.T_camera_board.linear() = R;
    view.T_camera_board.translation() = -R * eye;
    view.center_sigma_mm = Eigen::Vector3d(0.5, 0.2, 1.5);
    bench.views.push_back(view);
  }
  Light lamp;
  lamp.position_mm = {100, -300, 450};
  lamp.position_sigma_mm = Eigen::Vector3d(0.3, 0.3, 0.6);
  lamp.falloff_exponent = 2;
  bench.lights.push_back(lamp);
  return bench;
}

std::string page_of(const std::string& scene) {
  const std::string script = bench_scene_script(), style = bench_scene_style();
  return "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\">" + content_policy({{script}}, {{style}}) +
         "<meta name=\"viewport\" content=\"width=device-width\"><style>" + style + "</style></head><body>" + scene +
         "<script>" + script + "</script></body></html>";
}

constexpr const char* kPicture =
    "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => "
    "done(document.querySelector('canvas').toDataURL()))))";

TEST(BenchScene, IsDrawnTurnedAndTold) {
  if (!Chromium::is_installed()) GTEST_SKIP() << Chromium::kMissing;
  const TemporaryFolder folder;
  PlaceTolerance eye;
  eye.sideways = eye.up = {20, 25};
  eye.depth = {60, 60};
  const auto page = folder.write(
      "page.html", page_of(bench_scene_html(small_board(), small_bench(), {{"d0", "lamp", eye, {}}}, "Three cameras")));
  Chromium browser(folder);
  browser.open(page, 390, 800, "", true);
  const std::string first = browser.evaluate(kPicture);
  EXPECT_GT(first.size(), 5000U);  // a canvas with nothing on it: some 2000
  browser.drag(150, 100, 250, 120, true);
  const std::string turned = browser.evaluate(kPicture);
  EXPECT_NE(turned, first);
  browser.press("ArrowLeft");
  EXPECT_NE(browser.evaluate(kPicture), turned);
  EXPECT_THAT(browser.evaluate("document.querySelector('.bench-scene-words').textContent").get<std::string>(),
              ::testing::AllOf(HasSubstr("drawn 20 times"), HasSubstr("Rings")));
  EXPECT_THAT(browser.evaluate("document.body.textContent").get<std::string>(),
              HasSubstr("camera </script><b>odd: x 100"));
  EXPECT_LE(browser.evaluate("document.documentElement.scrollWidth").get<int>(), 390);
  EXPECT_THAT(browser.complaints(), IsEmpty());
}

TEST(BenchScene, ABenchWithoutUncertaintiesOrViewsIsDrawnToo) {
  if (!Chromium::is_installed()) GTEST_SKIP() << Chromium::kMissing;
  const TemporaryFolder folder;
  Bench bench = small_bench();
  bench.views.clear();
  bench.lights.front().position_sigma_mm.reset();
  Chromium browser(folder);
  browser.open(folder.write("page.html", page_of(bench_scene_html(small_board(), bench, {}, "A lamp"))), 1280, 800);
  EXPECT_GT(browser.evaluate(kPicture).get<std::string>().size(), 5000U);
  EXPECT_EQ(browser.evaluate("document.querySelector('.bench-scene-words').textContent"), "");
  EXPECT_THAT(browser.complaints(), IsEmpty());
}

}  // namespace
}  // namespace burin
