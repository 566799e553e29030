// Proves: a page begins with one sentence and then points; every picture says in words what it shows.
#include "tools/report/html.h"

#include <gmock/gmock.h>

#include "burin/render/image.h"

namespace burin {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Html, PicturesHaveTheirCaptionAsAltText) {
  const Image gray(4, 3, 1, 0.5F);
  const std::string html = figure(gray, "<b>Predicted</b> from &lt;d0&gt; &amp; “lamp”.");
  EXPECT_THAT(html, HasSubstr("alt=\"Predicted from &lt;d0&gt; &amp; “lamp”.\""));
  EXPECT_THAT(html, Not(HasSubstr("alt=\"\"")));
}

TEST(Html, PageBeginsWithTheOutcomeThenPoints) {
  const std::vector<std::string> points{"First.", "Second &amp; last."};
  const std::string text = page("Title", "Outcome.", points, "<h2>Body</h2>");
  const std::size_t outcome = text.find("<p class=\"outcome\">Outcome.</p>"), first = text.find("<li>First.</li>"),
                    body = text.find("<h2>Body</h2>");
  ASSERT_NE(body, std::string::npos);
  EXPECT_LT(outcome, first);
  EXPECT_LT(first, body);
  EXPECT_THAT(page("Title", "Outcome.", {}, ""), Not(HasSubstr("<ul class=\"points\">")));
}

TEST(Html, PlainTextIsWhatAReaderSees) {
  EXPECT_EQ(plain_text("<span class=\"bad\">a &lt; b</span> &amp;quot;"), "a < b &quot;");
}

}  // namespace
}  // namespace burin
