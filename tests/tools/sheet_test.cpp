// Proves: the sheet puts lamps and eyes where the bench has them, to scale, in every projection; what they tolerate is
// drawn as the outline of the ellipsoid that it is; labels cover no other label, however views lie; its words say mm
// that a ruler finds, on a table and on a wall; PDF and page hold all of them and the photos in their order, the page
// without anything from elsewhere and as narrow as a phone.
// Oracle: places set out here; the ellipse by points of the ellipsoid; a real browser.
#include "tools/sheet/sheet.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <random>
#include <tuple>

#include "tests/places.h"
#include "tests/tools/chromium.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr Projection kAll[] = {Projection::table_above, Projection::table_front, Projection::wall_front,
                               Projection::wall_above, Projection::wall_side};

Board board_of(double width, double height) {
  Board board;
  board.size_mm = board.carve_max_mm = {width, height};
  return board;
}

PlaceTolerance tolerance_of(double sideways, double up, double depth) {
  return {{sideways, sideways}, {up, up}, {depth, depth}};
}

SheetPlace eye(int number, const Eigen::Vector3d& at, const std::string& name = "") {
  return {std::to_string(number), name.empty() ? "v" + std::to_string(number) : name, false, at,
          tolerance_of(20, 25, 120)};
}

struct Set {
  std::string name;
  Board board;
  std::vector<SheetPlace> places;
};

std::vector<Set> sets() {
  std::vector<Set> out;
  const SheetPlace lamp{"L", "lamp", true, {100, 900, 1100}, tolerance_of(10, 12, 60)};
  out.push_back(
      {"three",
       board_of(200, 150),
       {lamp, eye(1, {-500, 75, 1000}, "left"), eye(2, {100, 75, 1200}, "middle"), eye(3, {700, 75, 1000}, "right")}});
  Set near{"five_within_a_hand", board_of(200, 150), {lamp}};
  for (int i = 0; i < 5; ++i) near.places.push_back(eye(i + 1, {90 + 12.0 * i, 80 + 3.0 * i, 1200}));
  out.push_back(near);
  Set far{"seven_far_apart_two_lamps", board_of(120, 120), {lamp, lamp}};
  far.places[0].label = "L1";
  far.places[1] = {"L2", "ceiling lamp of the hall", true, {-3000, 200, 6000}, tolerance_of(40, 40, 300)};
  for (int i = 0; i < 7; ++i)
    far.places.push_back(eye(i + 1, {-6000.0 + 2000 * i, -50.0 * i, i == 3 ? 300.0 : 9000.0}, i == 3 ? "close" : ""));
  out.push_back(far);
  Set long_board{"long_board", board_of(900, 60), {lamp, eye(1, {450, 30, 400}), eye(2, {-300, 30, 500})}};
  out.push_back(long_board);
  // Seen from the side, two dots are one.
  out.push_back({"left_and_right_alike",
                 board_of(200, 150),
                 {{"L", "lamp", true, {100, 718, 766}, tolerance_of(18, 18, 143)},
                  eye(1, {-462, -243, 763}, "astronaut"),
                  eye(2, {100, 5, 998}, "coffee"),
                  eye(3, {662, -243, 763}, "chelsea")}});
  return out;
}

Eigen::Vector2d seen(Projection projection, const Eigen::Vector3d& p) {
  switch (projection) {
    case Projection::table_above:
    case Projection::wall_front:
      return {p.x(), p.y()};
    case Projection::table_front:
      return {p.x(), p.z()};
    case Projection::wall_above:
      return {p.x(), -p.z()};
    case Projection::wall_side:
      return {p.z(), p.y()};
  }
  return {0, 0};
}

struct LabelBox {
  std::string text;
  Eigen::Vector2d low, high;
};

// Of the bold words: the places' labels.
std::vector<LabelBox> labels_of(const Drawing& drawing) {
  std::vector<LabelBox> out;
  for (const auto& element : drawing.elements)
    if (const auto* words = std::get_if<Words>(&element); words && words->bold) {
      const Eigen::Vector2d half(words_width_mm(words->text, words->size_mm, true) / 2, words->size_mm * 0.5);
      out.push_back({words->text, words->at_mm - half, words->at_mm + half});
    }
  return out;
}

// Of the lines from a dot to a label that stands further off.
std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> leaders_of(const Drawing& drawing) {
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> out;
  for (const auto& element : drawing.elements)
    if (const auto* shape = std::get_if<Shape>(&element); shape && !shape->closed && shape->pen.tint == Tint::faint)
      out.emplace_back(shape->outlines[0].front(), shape->outlines[0].back());
  return out;
}

TEST(BenchDrawing, IsToScaleAndItsLabelsCoverNothing) {
  for (const Set& set : sets())
    for (const Projection projection : kAll)
      for (const auto& [width, most_height, text] :
           {std::tuple{180.0, 110.0, 3.2}, {100.0, 110.0, 3.6}, {88.3, 80.0, 3.2}, {88.3, 85.0, 3.6}}) {
        SCOPED_TRACE(set.name + " " + std::to_string(static_cast<int>(projection)));
        const BenchDrawing drawn = bench_drawing(set.board, set.places, projection, width, most_height, text, 1500);
        ASSERT_EQ(drawn.places.size(), set.places.size());
        EXPECT_LE(drawn.drawing.size_mm.y(), most_height + 4 * text);
        for (std::size_t i = 0; i < set.places.size(); ++i) {
          const Eigen::Vector2d on_paper = drawn.places[i] - drawn.places[0],
                                real = seen(projection, set.places[i].at_mm - set.places[0].at_mm);
          EXPECT_NEAR(on_paper.x(), drawn.scale * real.x(), 1e-9);
          EXPECT_NEAR(on_paper.y(), -drawn.scale * real.y(), 1e-9);  // up on paper is up
          EXPECT_TRUE((drawn.places[i].array() > 0).all() &&
                      (drawn.places[i].array() < drawn.drawing.size_mm.array()).all());
        }
        const std::vector<LabelBox> labels = labels_of(drawn.drawing);
        ASSERT_EQ(labels.size(), set.places.size());
        for (std::size_t i = 0; i < labels.size(); ++i) {
          EXPECT_TRUE((labels[i].low.array() >= 0).all() && labels[i].high.x() <= width) << labels[i].text;
          for (std::size_t k = 0; k < i; ++k)
            EXPECT_TRUE((labels[i].low.array() >= labels[k].high.array()).any() ||
                        (labels[k].low.array() >= labels[i].high.array()).any())
                << labels[i].text << " on " << labels[k].text;
        }
        if (set.name == "seven_far_apart_two_lamps") continue;  // on a strip: there is no way around nine labels
        for (const auto& [from, to] : leaders_of(drawn.drawing))
          for (const LabelBox& label : labels)
            for (double part = 0; part < 0.99; part += 0.02) {  // its end touches its own label
              const Eigen::Vector2d p = from + part * (to - from);
              ASSERT_FALSE((p.array() > label.low.array() + 0.3).all() && (p.array() < label.high.array() - 0.3).all())
                  << "a line crosses " << label.text;
            }
      }
}

TEST(BenchDrawing, DrawsToleranceAsTheOutlineOfItsEllipsoid) {
  const Board board = board_of(200, 100);
  const SheetPlace place{"1", "a", false, {700, 300, 900}, tolerance_of(30, 50, 200)};
  const Eigen::Vector3d depth = (place.at_mm - Eigen::Vector3d(100, 50, 0)).normalized(),
                        sideways = Eigen::Vector3d::UnitZ().cross(depth).normalized(), up = depth.cross(sideways);
  std::mt19937_64 random(3);
  std::normal_distribution<double> gauss;
  for (const Projection projection : kAll) {
    const auto outline = tolerance_outline(board, place, projection);
    // How far it reaches in some directions, against many points of the ellipsoid.
    for (const double angle : {0.0, 0.6, 1.3, 2.2}) {
      const Eigen::Vector2d u(std::cos(angle), std::sin(angle));
      double drawn = 0, sampled = 0;
      for (const Eigen::Vector2d& p : outline) drawn = std::max(drawn, p.dot(u));
      for (int i = 0; i < 20'000; ++i) {
        const Eigen::Vector3d s = Eigen::Vector3d(gauss(random), gauss(random), gauss(random)).normalized();
        sampled =
            std::max(sampled, seen(projection, 30 * s.x() * sideways + 50 * s.y() * up + 200 * s.z() * depth).dot(u));
      }
      EXPECT_NEAR(drawn / sampled, 1, 0.02);  // 48 corners, 20,000 samples
    }
  }
}

// A standing person sees the pictures: the lamp is above the board, so the eyes are below its middle.
TEST(SheetWords, EyesAreAStandingAdults) {
  Sheet sheet;
  sheet.board = board_of(200, 150);
  sheet.places = {{"L", "lamp", true, {100, 718, 766}, tolerance_of(18, 18, 143)},
                  eye(1, {-462, -243, 763}),
                  eye(2, {100, 5, 998}),
                  eye(3, {662, -243, 763})};
  sheet.hang_height_mm = usual_hang_height_mm(sheet.board, sheet.places);
  EXPECT_EQ(sheet.hang_height_mm, 1790);  // 1600 + 75 - (5 - 243) / 2 = 1794, to 10 mm
  std::vector<Finding> said = findings(sheet);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].severity, Finding::Severity::note);
  EXPECT_THAT(sentence(said[0]), AllOf(HasSubstr("eyes between 1.47 and 1.72 m above the floor"),
                                       HasSubstr("knees bend from one place to the next")));
  sheet.hang_height_mm = 1500;
  said = findings(sheet);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].severity, Finding::Severity::warning);
  EXPECT_THAT(sentence(said[0]), AllOf(HasSubstr("eyes between 1.18 and 1.43 m"), HasSubstr("(--hang-height 1790)")));
  // Eyes far above a board: its lower edge is on the floor at the lowest.
  EXPECT_EQ(usual_hang_height_mm(sheet.board, {eye(1, {100, 5000, 900})}), 80);
}

// The sample, and one whose names are made to break pages.
class SheetCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ / "my <board>");
    for (const char* file : {"board.json", "bench.json", "camera.cameramodel", "design.json"})
      std::filesystem::copy_file(places::source() + "/samples/small-bench/" + file, folder_ / "my <board>" / file);
    std::filesystem::copy(places::source() + "/samples/small-bench/targets", folder_ / "my <board>" / "targets");
    for (const char* file : {"bench.json", "design.json"}) {
      std::string text = file_text(folder_ / "my <board>" / file);
      for (std::size_t at = 0; (at = text.find("\"d1\"", at)) != std::string::npos;)
        text.replace(at, 4, "\"<b>&middle\"");
      folder_.write(std::string("my <board>/") + file, text);
    }
  }

  const TemporaryFolder folder_;
};

TEST_F(SheetCommand, SaysWhereLampAndEyesGoOnTableAndWall) {
  const Outcome run = run_burin(folder_, {"sheet", "my <board>", "--shots", "2", "--hang-height", "1600"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("sheet.pdf and my <board>/sheet.html: 4 places and 5 photos"),
                             HasSubstr("burin loop 'my <board>'")));
  const std::string html = file_text(folder_ / "my <board>" / "sheet.html");
  // d0 of the sample's bench: 189 mm beyond the right edge, 87 mm beyond the upper edge of 120, 408 mm above.
  EXPECT_THAT(html, AllOf(HasSubstr("189 mm beyond the right edge"), HasSubstr("87 mm beyond the upper edge"),
                          HasSubstr("408 mm above the face"), HasSubstr("408 mm in front of the face")));
  // On the wall: 1600 + (120 + 87 - 60).
  EXPECT_THAT(html, AllOf(HasSubstr("eye 1747 mm above the floor"), HasSubstr("&lt;b&gt;&amp;middle"),
                          Not(HasSubstr("<b>&middle")), HasSubstr("<h1>my &lt;board&gt;</h1>"), HasSubstr("5</label>"),
                          HasSubstr("Focus once at 500 mm"), Not(HasSubstr("style=\""))));
  EXPECT_EQ(html.find("http://"), html.find("http://www.w3.org/2000/svg"));
  // Again, the same bytes.
  const std::string pdf = file_text(folder_ / "my <board>" / "sheet.pdf");
  ASSERT_EQ(run_burin(folder_, {"sheet", "my <board>", "--shots", "2", "--hang-height", "1600", "--out", "a.pdf",
                                "--out", "a.html"})
                .exit_code,
            0);
  EXPECT_EQ(file_text(folder_ / "a.pdf"), pdf);
  EXPECT_EQ(file_text(folder_ / "a.html"), html);
}

TEST_F(SheetCommand, APdfHasTheSameWords) {
  if (std::system("command -v pdftotext >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "needs pdftotext: tools/install-packages poppler-utils";
  ASSERT_EQ(
      run_burin(folder_, {"sheet", "my <board>", "--shots", "9", "--out", "s.pdf", "--paper", "letter"}).exit_code, 0);
  const Outcome text = run_shell(folder_, "cd " + quoted(folder_.path().string()) + " && pdftotext -layout s.pdf -");
  ASSERT_EQ(text.exit_code, 0) << text.err;
  for (const char* words : {"on a table", "on a wall", "photos, in this order", "1: view \"d0\"", "189 mm beyond the",
                            "1677 mm above", "12", "Focus once at 500 mm", "Eyes between 1.53 and 1.6"})
    EXPECT_THAT(text.out, HasSubstr(words));
}

TEST_F(SheetCommand, ThePageIsReadOnAPhone) {
  if (!Chromium::is_installed()) GTEST_SKIP() << Chromium::kMissing;
  ASSERT_EQ(run_burin(folder_, {"sheet", "my <board>", "--shots", "2", "--out", "s.html"}).exit_code, 0);
  Chromium browser(folder_);
  for (const int width : {390, 1280})
    for (const bool dark : {false, true}) {
      browser.open(folder_ / "s.html", width, 900, "", width < 500, dark);
      EXPECT_LE(browser.evaluate("document.documentElement.scrollWidth").get<int>(), width);
      // A cell's head beside it is no higher than the cell, or it would run over what is below.
      EXPECT_EQ(browser.evaluate("[...document.querySelectorAll('tbody td')].filter(td => "
                                 "parseFloat(getComputedStyle(td, '::before').height) > "
                                 "td.getBoundingClientRect().height + 0.5).length"),
                0);
      EXPECT_TRUE(width > 500 || browser.evaluate("Math.max(...[...document.querySelectorAll('tbody td')].map(td => "
                                                  "parseFloat(getComputedStyle(td, '::before').height)))")
                                         .get<double>() > 30)
          << "no head of two lines was looked at";
      // Words of the drawings, in pixels.
      EXPECT_GE(browser
                    .evaluate("Math.min(...[...document.querySelectorAll('svg text')].map(t => "
                              "t.getBoundingClientRect().height))")
                    .get<double>(),
                10);
      EXPECT_EQ(browser.evaluate("document.querySelectorAll('input[type=checkbox]').length"), 5);
      EXPECT_THAT(browser.complaints(), IsEmpty());
      EXPECT_THAT(browser.requests(), IsEmpty());
    }
}

TEST_F(SheetCommand, RefusesWhatIsNoProjectAndNoPage) {
  EXPECT_EQ(run_burin(folder_, {"sheet", "none"}).exit_code, 1);
  const Outcome wrong = run_burin(folder_, {"sheet", "my <board>", "--out", "sheet.txt"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err, HasSubstr(".html"));
  EXPECT_EQ(run_burin(folder_, {"sheet", "my <board>", "--hang-height", "0"}).exit_code, 2);
  const Outcome low = run_burin(folder_, {"sheet", "my <board>", "--shots", "1", "--hang-height", "100"});
  EXPECT_EQ(low.exit_code, 0) << low.err;
  EXPECT_THAT(low.err, HasSubstr("below the floor"));  // the lamp, 313 mm beyond the lower edge
}

}  // namespace
}  // namespace burin
