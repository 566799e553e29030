// Proves: text that a terminal would obey comes neither out of a project's files nor into an error, and all other
// writing in the world does.
#include "burin/base/files/printable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/base/error.h"
#include "burin/base/finding.h"
#include "burin/scene/board.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Printable, WritingIsKept) {
  for (const char* text : {"", "left eye", "Grüße", "左目", "العين", "👁", "a\\b\"c'"}) {
    EXPECT_TRUE(is_printable(text)) << text;
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, WhatATerminalObeysIsShownAsNumbers) {
  EXPECT_EQ(printable("a\x1b[2Jb"), "a\\x1b[2Jb");
  EXPECT_EQ(printable("a\nb\tc\x7f"), "a\\x0ab\\x09c\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xc2\x9b"), "\\xc2\\x9b") << "U+009B begins an escape sequence as well";
  EXPECT_EQ(printable("photo\xe2\x80\xaegnp.exe"), "photo\\xe2\\x80\\xaegnp.exe") << "right to left";
  // No UTF-8: a stray byte, one cut short, an overlong slash, a surrogate, beyond U+10FFFF.
  for (const char* bytes : {"\xff", "\xc3", "\xe2\x82", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80"}) {
    EXPECT_FALSE(is_printable(bytes));
    EXPECT_THAT(printable(bytes), HasSubstr("\\x"));
  }
}

TEST(Printable, ErrorsAndFindingsAre) {
  EXPECT_THAT([] { fail("a\x1b[31m.json", "is\x07 bad", "mend it"); },
              ThrowsMessage<Error>("a\\x1b[31m.json: is\\x07 bad; mend it"));
  EXPECT_EQ(sentence({FindingCode::picture, Finding::Severity::note, "\x1b.png", "x", ""}), "\\x1b.png: x");
}

// Escaped in JSON they are plain ASCII in the file.
TEST(Printable, FilesWithSuchTextAreRefused) {
  const TemporaryFolder folder;
  const auto board = [&](const std::string& name) {
    return read_board(folder.write("b.json", R"({"format": "burin/board", "version": 1, "size_mm": [100, 100],
      "keep_out": [{"name": ")" + name + R"(", "center_mm": [50, 50], "radius_mm": 6}]})"));
  };
  EXPECT_EQ(board("Bohrloch \\u00e4").keep_out[0].name, "Bohrloch ä");
  for (const char* name : {"\\u001b[2J", "two\\nlines", "\\u0000", "\\u202e", "\\u009b"})
    EXPECT_THAT([&] { board(name); }, ThrowsMessage<Error>(HasSubstr("control character"))) << name;
}

}  // namespace
}  // namespace burin
