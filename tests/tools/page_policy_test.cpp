// Proves: there is no page without a content security policy: whatever source begins an HTML page puts the policy first
// into its head. (content_policy_test and html_test: what the policy says, and that a browser keeps to it.)
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>

#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

TEST(PagePolicy, EveryPageHasOne) {
  int pages = 0;
  for (const char* room : {"base", "pictures", "scene", "render", "capture", "simulate", "calib", "optimize", "tools"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(places::source()) / room)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".h" && extension != ".html") continue;
      std::string text = file_text(entry.path());
      std::transform(text.begin(), text.end(), text.begin(),
                     [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
      for (std::size_t at = text.find("<!doctype html>"); at != std::string::npos;
           at = text.find("<!doctype html>", at + 1)) {
        ++pages;
        const std::size_t charset = text.find("<meta charset=", at);
        ASSERT_NE(charset, std::string::npos) << entry.path();
        const std::string behind = text.substr(charset, 200);
        EXPECT_TRUE(behind.find("policy") != std::string::npos || behind.find("{}") != std::string::npos)
            << entry.path() << ": nothing stands where the policy belongs";
        EXPECT_TRUE(text.find("content_policy(") != std::string::npos || behind.find("{{policy}}") != std::string::npos)
            << entry.path();
      }
    }
  EXPECT_GE(pages, 3);
}

}  // namespace
}  // namespace burin
