// Proves: a page begins with one sentence, then what to do, pictures, warnings and notes; every picture says in words
// what it shows; numbers are written as people write them; a table's cells name their column where it is a card.
#include "tools/report/html.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "burin/base/image.h"
#include "tools/report/chart.h"
#include "tools/report/pictures.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(Html, PicturesSayWhatTheyShow) {
  const Image gray(4, 3, 1, 0.5F);
  EXPECT_THAT(figure({gray, "View <d0> & “lamp”: predicted", "<b>Predicted</b>"}),
              HasSubstr("alt=\"View &lt;d0&gt; &amp; “lamp”: predicted\""));
  EXPECT_THROW(figure({gray, "", "<b>Predicted</b>"}), std::logic_error);
}

// Errors stand above the pictures, warnings and notes below them.
TEST(Html, PageBeginsWithTheOutcome) {
  Page all{"Title", "Outcome."};
  all.next = "do it";
  all.pictures = "<h2>Pictures</h2>";
  all.findings = {{FindingCode::picture, Finding::Severity::warning, {}, "look at <this>", "do that"},
                  {FindingCode::gcode_unsafe, Finding::Severity::error, "dir/a.gcode", "it digs", ""}};
  all.body = "<h2>Body</h2>";
  const std::string text = page(all);
  std::size_t before = 0;
  for (const char* part :
       {"Content-Security-Policy", "<p class=\"outcome\">Outcome.</p>", "<b>Next:</b> do it",
        "<span class=\"kind\">Error · a.gcode</span><p>It digs.", "<h2>Pictures</h2>", "<h2>Warnings and notes",
        "<span class=\"kind\">Warning</span><p>Look at &lt;this&gt;.</p><p class=\"remedy\">Do that.",
        "<h2>Body</h2>"}) {
    const std::size_t at = text.find(part);
    ASSERT_NE(at, std::string::npos) << part;
    EXPECT_GT(at, before) << part;
    before = at;
  }
  EXPECT_THAT(page({"Title", "Outcome."}), AllOf(Not(HasSubstr("<h2>Warnings and notes")), Not(HasSubstr("<b>Next:"))));
}

TEST(Html, ManyFindingsAreFoldedButNoError) {
  const Finding note{FindingCode::picture, Finding::Severity::note, {}, "a note", ""},
      error{FindingCode::picture, Finding::Severity::error, {}, "an error", ""};
  EXPECT_THAT(cards({7, note}), Not(HasSubstr("<details")));  // folding one saves nothing
  EXPECT_THAT(cards({9, note}), HasSubstr("<b>3 more</b>"));
  EXPECT_THAT(cards({9, error}), Not(HasSubstr("<details")));
  EXPECT_EQ(cards({}), "");
}

TEST(Html, PlainTextIsWhatAReaderSees) {
  EXPECT_EQ(plain_text("<span class=\"error\">a &lt; b</span> &amp;quot;"), "a < b &quot;");
}

TEST(Html, NumbersHaveNoExponent) {
  EXPECT_EQ(number(562.37), "562.4");
  EXPECT_EQ(number(123456.7), "123457");
  EXPECT_EQ(number(0.00001234), "0.00001234");
  EXPECT_EQ(number(std::numeric_limits<double>::quiet_NaN()), "unknown");
  EXPECT_EQ(with_sigma(0.0602341, 0.00042), "0.06023 ± 0.00042");
  EXPECT_EQ(with_sigma(123456.7, 562.4), "123457 ± 562");
  EXPECT_EQ(decibels(23.84), "23.8 dB");
  EXPECT_EQ(decibels(INFINITY), "no difference");
  EXPECT_EQ(grouped(29798, "scratch"), "29,798 scratches");
  EXPECT_EQ(grouped(1, "view"), "1 view");
  EXPECT_EQ(grouped(-1234567), "-1,234,567");
  EXPECT_EQ(grouped(-123), "-123");
}

TEST(Html, CellsNameTheirColumn) {
  EXPECT_THAT(table({{"View", "<i>Why</i>"}, {{"d0", "so"}}}),
              AllOf(HasSubstr("<td data-label=\"View\">d0</td>"), HasSubstr("<td data-label=\"Why\">so</td>")));
}

TEST(Chart, IsSaidInWordsAndLeavesOutWhatIsNot) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Curve> curves{{"seen", {23.8, none, 31.2}}};
  const std::string drawn =
      chart(curves, {"round", "dB", "from 23.8 to 31.2 dB", {"round 1", "round 2", "round 3"}, true});
  EXPECT_THAT(drawn, AllOf(HasSubstr("aria-label=\"from 23.8 to 31.2 dB\""), HasSubstr("round 2</text>"),
                           Not(HasSubstr("nan"))));
  std::size_t marks = 0;
  for (std::size_t at = 0; (at = drawn.find("<circle", at)) != std::string::npos; ++at) ++marks;
  EXPECT_EQ(marks, 2u);
  EXPECT_THAT(chart(std::vector<Curve>{{"none", {none}}}, {"", "", ""}), IsEmpty());
  // Losses span decades: lines at round numbers, none with an exponent.
  EXPECT_THAT(chart(std::vector<Curve>{{"loss", {3e7, 2e3, 41}}}, {"iteration", "loss", "x"}),
              AllOf(HasSubstr(">100<"), HasSubstr(">10000000<"), Not(HasSubstr("e+"))));
}

}  // namespace
}  // namespace burin
