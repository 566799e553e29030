// Proves: whatever a path names, it is refused in a sentence before a byte is read and without waiting - folders,
// FIFOs, devices, links in a circle, names too long or with a zero byte, files above the limit - by every reader of
// text.
#include "burin/base/files/input_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <functional>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/base/image.h"
#include "burin/base/limits.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/board_mesh.h"
#include "burin/scene/lens.h"
#include "burin/scene/scratches.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const std::vector<std::function<void(const fs::path&)>>& readers() {
  static const std::vector<std::function<void(const fs::path&)>> list{
      [](const fs::path& f) { read_text(f); },        [](const fs::path& f) { read_board(f); },
      [](const fs::path& f) { read_bench(f); },       [](const fs::path& f) { read_scratches(f); },
      [](const fs::path& f) { read_cameramodel(f); }, [](const fs::path& f) { read_obj(f); },
      [](const fs::path& f) { read_picture(f); }};
  return list;
}

void expect_all_refuse(const fs::path& file, const std::string& words) {
  for (std::size_t i = 0; i < readers().size(); ++i)
    EXPECT_THAT([&] { readers()[i](file); }, ThrowsMessage<Error>(HasSubstr(words))) << "reader " << i;
}

TEST(InputFile, AFileIsReadWhole) {
  const TemporaryFolder folder;
  const std::string text("a\0b\n", 4);
  EXPECT_EQ(read_bytes(folder.write("a", text), 4, "a file"), text);
  EXPECT_EQ(read_head(folder / "a", 2), text.substr(0, 2));
  EXPECT_EQ(read_head(folder / "a", 100), text);
  fs::create_symlink("a", folder / "link");
  EXPECT_EQ(require_plain_file(folder / "link", 4, "a file"), 4U);
}

// A FIFO that nobody writes to would wait for ever; /dev/zero would fill the memory.
TEST(InputFile, WhatIsNoPlainFileIsRefusedAtOnce) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  expect_all_refuse(folder / "fifo", "is a FIFO");
  expect_all_refuse("/dev/zero", "is a device");
  expect_all_refuse(folder.path(), "is a folder");
  expect_all_refuse(folder / "none", "does not exist");
}

TEST(InputFile, EverydayErrorsHaveTheirOwnSentence) {
  const TemporaryFolder folder;
  fs::create_symlink("b", folder / "a");
  fs::create_symlink("a", folder / "b");
  expect_all_refuse(folder / "a", "leads in a circle");
  expect_all_refuse(folder / std::string(300, 'x'), "longer than the file system allows");
  expect_all_refuse(folder.write("file", "x") / "y", "is a file, not a folder");
  expect_all_refuse(folder / std::string("file\0more", 9), "zero byte");
  if (geteuid() == 0) return;  // root may read everything
  fs::permissions(folder / "file", fs::perms::none);
  expect_all_refuse(folder / "file", "may not be read");
}

// A file of 200 GB that takes no room on the disk: nothing of it is read.
TEST(InputFile, AboveTheLimitNothingIsRead) {
  const TemporaryFolder folder;
  folder.write("huge", "");
  std::error_code error;
  fs::resize_file(folder / "huge", 200 * limit::kGiB, error);
  if (error) GTEST_SKIP() << "this disk has no sparse files";
  expect_all_refuse(folder / "huge", "more than the");
  EXPECT_THAT([&] { read_bytes(folder / "huge", 64'000'000, "a JSON file"); },
              ThrowsMessage<Error>(HasSubstr("has 214,748 MB, more than the 64 MB that Burin reads of a JSON file")));
}

TEST(InputFile, NumbersForPeople) {
  EXPECT_EQ(with_commas(0), "0");
  EXPECT_EQ(with_commas(999), "999");
  EXPECT_EQ(with_commas(1'000), "1,000");
  EXPECT_EQ(with_commas(1'234'567), "1,234,567");
  EXPECT_EQ(bytes_text(9'999'999), "9,999,999 bytes");
  EXPECT_EQ(bytes_text(64'000'000), "64 MB");
}

}  // namespace
}  // namespace burin
