// Proves: what is above a limit (burin/base/limits.h) is refused before memory is taken for it, in a sentence that
// names the limit; what is at it is taken.
#include "burin/base/limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/table.h"
#include "burin/scene/board.h"
#include "burin/scene/board_mesh.h"
#include "burin/scene/lens.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string board_of(std::size_t tags) {
  std::string list;
  for (std::size_t i = 0; i < tags; ++i)
    list += std::string(i == 0 ? "" : ",") + "{\"id\": " + std::to_string(i) + ", \"center_mm\": [" +
            std::to_string(10 + 20 * (i % 50)) + ", " + std::to_string(10 + 20 * (i / 50)) + "], \"size_mm\": 9}";
  return R"({"format": "burin/board", "version": 1, "size_mm": [1000, 1000], "tags": {"family": "tagStandard52h13",
             "list": [)" +
         list + "]}}";
}

TEST(Limits, TagsOfABoard) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_board(folder.write("b.json", board_of(limit::kTags))).tags.list.size(), limit::kTags);
  EXPECT_THAT([&] { read_board(folder.write("c.json", board_of(limit::kTags + 1))); },
              ThrowsMessage<Error>(AllOf(HasSubstr("has 2,001 tags"), HasSubstr("2,000"), HasSubstr("limits.md"))));
}

TEST(Limits, SizeOfABoard) {
  const TemporaryFolder folder;
  const auto board = [&](const std::string& width) {
    return read_board(
        folder.write("b.json", R"({"format": "burin/board", "version": 1, "size_mm": [)" + width + ", 100]}"));
  };
  EXPECT_EQ(board("100000").size_mm.x(), 100'000);
  EXPECT_THAT([&] { board("100001"); }, ThrowsMessage<Error>(HasSubstr("at most 100,000")));
}

TEST(Limits, PixelsOfACamera) {
  const TemporaryFolder folder;
  const auto lens = [&](const std::string& size) {
    return read_cameramodel(folder.write(
        "c.cameramodel",
        "{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [1000, 1000, 1, 1], 'imagersize': " + size + "}"));
  };
  EXPECT_EQ(lens("[11000, 10000]").width, 11000);
  EXPECT_THAT([&] { lens("[1000000, 1000000]"); }, ThrowsMessage<Error>(HasSubstr("more than 100,000 on a side")));
  EXPECT_THAT([&] { lens("[11001, 10000]"); }, ThrowsMessage<Error>(HasSubstr("more than the 110,000,000")));
}

TEST(Limits, BracketsWithinBrackets) {
  const TemporaryFolder folder;
  const auto nested = [&](int depth) {
    const auto n = static_cast<std::size_t>(depth);
    return read_json(folder.write("n.json", R"({"format": "burin/thing", "version": 1, "a": )" + std::string(n, '[') +
                                                std::string(n, ']') + "}"),
                     "burin/thing", 1);
  };
  EXPECT_NO_THROW(nested(limit::kNesting - 1));
  EXPECT_THAT([&] { nested(limit::kNesting + 1); }, ThrowsMessage<Error>(HasSubstr("deeper than 100")));
  EXPECT_THAT([&] { nested(200'000); }, ThrowsMessage<Error>(HasSubstr("deeper than 100")));
}

// One line of commas would take sixteen bytes for each of its bytes.
TEST(Limits, ColumnsOfATable) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { TableReader(folder.write("t.csv", std::string(2000, ',')), TableStyle::csv, {}, "name them"); },
              ThrowsMessage<Error>(HasSubstr("more than 1,000 columns")));
  std::string ones;  // empty columns at a row's end are a spreadsheet's
  for (int i = 0; i < 50'000; ++i) ones += "1,";
  TableReader rows(folder.write("u.csv", "a,b\n" + ones + "\n"), TableStyle::csv, {}, "");
  EXPECT_THAT([&] { rows.next(); }, ThrowsMessage<Error>(HasSubstr("has more than 2 values")));
}

TEST(Limits, CornersOfAFace) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { read_obj(folder.write("m.obj", "v 0 0 0\nf" + std::string(limit::kMeshLineBytes, ' ') + "1\n")); },
              ThrowsMessage<Error>(AllOf(HasSubstr("m.obj:2"), HasSubstr("too long"))));
}

}  // namespace
}  // namespace burin
