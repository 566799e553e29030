// Proves: under content_policy() a browser runs the scripts and styles that a page was written with, and nothing else.
#include "tools/content_policy.h"

#include <gmock/gmock.h>

#include "tests/tools/chromium.h"

namespace burin {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ContentPolicy, HashIsThatOfTheStandardsExample) {
  // W3C, Content Security Policy Level 3, 2.3.1's form; the digest of "abc" is in FIPS 180-2, appendix B.1.
  EXPECT_EQ(content_hash_source("abc"), "'sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0='");
}

TEST(ContentPolicy, ABrowserRunsWhatThePageWasWrittenWithAndNothingElse) {
  if (!Chromium::is_installed()) GTEST_SKIP() << Chromium::kMissing;
  const TemporaryFolder folder;
  const std::string ours = "\"use strict\";\nlet keys = '';\naddEventListener('keydown', e => { keys += e.key; });\n";
  const std::string style = "p { color: rgb(1, 2, 3); }";
  const auto page = [&](const std::string& more) {
    return "<!doctype html><html><head>" + content_policy({{ours}}, {{style}}) + "<style>" + style +
           "</style></head><body><p>x</p><script>" + ours + "</script>" + more + "</body></html>";
  };
  Chromium browser(folder);
  browser.open(folder.write("good #1.html", page("")), 390, 700, "", true, true);
  browser.press("ArrowLeft");
  browser.press("a");
  EXPECT_EQ(browser.evaluate("keys"), "ArrowLefta");
  EXPECT_EQ(browser.evaluate("getComputedStyle(document.querySelector('p')).color"), "rgb(1, 2, 3)");
  EXPECT_EQ(browser.evaluate("matchMedia('(prefers-color-scheme: dark)').matches"), true);
  EXPECT_THAT(browser.complaints(), IsEmpty());

  browser.open(folder.write("bad.html", page("<script>keys = 'foreign';</script>"
                                             "<img src=\"http://127.0.0.1:9/x.png\">")),
               1280, 700);
  EXPECT_EQ(browser.evaluate("keys"), "");
  EXPECT_THAT(browser.complaints(), ElementsAre(HasSubstr("script-src"), HasSubstr("img-src")));
}

}  // namespace
}  // namespace burin
