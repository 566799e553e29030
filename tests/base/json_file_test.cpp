// Proves: strict reading names file, field and remedy for every kind of wrong value; writing is atomic and exact.
// Does not prove what each file format holds: board_test.cpp and bench_test.cpp do.
#include "burin/base/files/json_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "burin/base/error.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

constexpr const char* kHead = R"({"format": "burin/thing", "version": 1)";

Json parsed(const TemporaryFolder& folder, const std::string& rest) {
  return read_json(folder.write("thing.json", kHead + rest), "burin/thing", 1);
}

TEST(JsonFile, BrokenJsonIsNamedWithLineAndColumn) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { parsed(folder, ",\n\"a\": [1, 2,]\n}"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("thing.json"), HasSubstr("line 2"), HasSubstr("trailing commas"))));
  EXPECT_THAT([&] { parsed(folder, ",\n\"a\": NaN}"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("line 2"), HasSubstr("no NaN"))));
  EXPECT_THAT([&] { parsed(folder, ",\"a\": 1e999}"); }, ThrowsMessage<Error>(HasSubstr("1e999")));
  const Json large = parsed(folder, ",\"a\": -1e300, \"b\": [1, 1e19], \"c\": [[1e300]], \"d\": 1e18}");
  JsonObject object(large, "thing.json");
  EXPECT_THAT([&] { object.number("a"); },
              ThrowsMessage<Error>(HasSubstr("a: is beyond anything that can be measured")));
  EXPECT_THAT([&] { object.numbers("b", 2); }, ThrowsMessage<Error>(HasSubstr("b[1]: is beyond")));
  EXPECT_THAT([&] { object.matrix("c", 1, 1); }, ThrowsMessage<Error>(HasSubstr("c[0][0]: is beyond")));
  EXPECT_EQ(object.number("d"), 1e18);
  EXPECT_THAT([&] { parsed(folder, ",\"a\": {\"b\": 1, \"b\": 2}}"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("b: the key appears twice"))));
  EXPECT_THROW(read_json(folder.write("empty.json", ""), "burin/thing", 1), Error);
  EXPECT_THROW(read_json(folder.write("list.json", "[1, 2]"), "burin/thing", 1), Error);
}

TEST(JsonFile, MissingFileFolderAndWrongFormatAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { read_json(folder / "none.json", "burin/thing", 1); },
              ThrowsMessage<Error>(AllOf(HasSubstr("none.json"), HasSubstr("does not exist"))));
  EXPECT_THAT([&] { read_json(folder.path(), "burin/thing", 1); }, ThrowsMessage<Error>(HasSubstr("is a folder")));
  const auto file = folder.write("thing.json", kHead + std::string("}"));
  EXPECT_THAT([&] { read_json(file, "burin/board", 1); },
              ThrowsMessage<Error>(AllOf(HasSubstr("burin/thing"), HasSubstr("\"burin/board\" is needed"))));
  EXPECT_THAT([&] { read_json(file, "burin/thing", 2); },
              ThrowsMessage<Error>(AllOf(HasSubstr("version"), HasSubstr("is 1"), HasSubstr("version 2"))));
}

TEST(JsonFile, UnknownKeysAreErrorsWithTheNearMatch) {
  const TemporaryFolder folder;
  const Json json = parsed(folder, R"(, "inner": {"size_mm": 3, "sizee_mm": 4, "far": 1}})");
  JsonObject object(json, "thing.json");
  JsonObject inner = object.object("inner");
  EXPECT_EQ(inner.positive("size_mm"), 3);
  EXPECT_THAT([&] { inner.finish(); },
              ThrowsMessage<Error>(AllOf(HasSubstr("thing.json: inner.sizee_mm: unknown key"),
                                         HasSubstr("did you mean \"size_mm\"?"), HasSubstr("known here: size_mm"))));
  inner.number("sizee_mm", 0);
  EXPECT_THAT([&] { inner.finish(); },
              ThrowsMessage<Error>(AllOf(HasSubstr("inner.far"), Not(HasSubstr("did you mean")))));
  inner.number("far", 0);
  EXPECT_NO_THROW(inner.finish());
  EXPECT_NO_THROW(object.finish());  // "format" and "version" are known in a whole file
}

TEST(JsonFile, WrongValuesNameTheField) {
  const TemporaryFolder folder;
  const Json json = parsed(folder, R"(, "text": "abc", "half": 1.5, "minus": -2, "pair": [1, 2], "mixed": [1, "x", 3],
      "ragged": [[1, 2], [3]], "nothing": null, "list": [{"a": 1}, 7], "big": 1e12, "Size_mm": 3})");
  JsonObject object(json, "thing.json");
  EXPECT_THAT([&] { object.number("text"); },
              ThrowsMessage<Error>(HasSubstr("thing.json: text: is \"abc\"; write a number")));
  EXPECT_THAT([&] { object.number("nothing"); }, ThrowsMessage<Error>(HasSubstr("nothing: is null")));
  EXPECT_THAT([&] { object.integer("half"); }, ThrowsMessage<Error>(AllOf(HasSubstr("half"), HasSubstr("1.5"))));
  EXPECT_THAT([&] { object.integer("big"); }, ThrowsMessage<Error>(HasSubstr("big")));
  EXPECT_THAT([&] { object.positive("minus"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("minus: is -2"), HasSubstr("greater than 0"))));
  EXPECT_THAT([&] { object.vec3("pair"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("array of 2"), HasSubstr("3 numbers"))));
  EXPECT_THAT([&] { object.vec3("mixed"); }, ThrowsMessage<Error>(HasSubstr("mixed[1]: is \"x\"")));
  EXPECT_THAT([&] { object.matrix("ragged", 2, 2); }, ThrowsMessage<Error>(HasSubstr("ragged[1]")));
  EXPECT_THAT([&] { object.objects("list"); }, ThrowsMessage<Error>(HasSubstr("list[1]: is 7")));
  EXPECT_THAT([&] { object.boolean("half"); }, ThrowsMessage<Error>(HasSubstr("true or false")));
  EXPECT_THAT([&] { object.text("half"); }, ThrowsMessage<Error>(HasSubstr("double quotes")));
  EXPECT_THAT([&] { object.positive("size_mm"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("size_mm: is missing"), HasSubstr("\"Size_mm\" meant"))));
  EXPECT_EQ(object.number("absent", 4.5), 4.5);
}

TEST(JsonFile, WritesEveryDigitOfADouble) {
  const TemporaryFolder folder;
  Json json{{"format", "burin/thing"}, {"version", 1}};
  const std::vector<double> values{0.1, 1.0 / 3, 1e-300, -2.5e17, std::nextafter(1.0, 2.0), 0};
  json["values"] = values;
  json["matrix"] = to_json(Eigen::Matrix2d{{1.0 / 7, 2}, {3, 4}});
  write_json(json, folder / "out.json");
  const Json back = read_json(folder / "out.json", "burin/thing", 1);
  JsonObject object(back, "out.json");
  EXPECT_EQ(object.numbers("values", -1), values);
  EXPECT_EQ(object.matrix("matrix", 2, 2)(0, 0), 1.0 / 7);
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(JsonFile, NothingHalfWrittenStays) {
  const TemporaryFolder folder;
  folder.write("out.json", "old");
  EXPECT_THROW(write_json(Json{{"a", std::numeric_limits<double>::quiet_NaN()}}, folder / "out.json"), Error);
  EXPECT_THROW(write_atomically(folder / "out.json",
                                [](const auto& temporary) {
                                  std::ofstream(temporary) << "half";
                                  throw Error("stopped");
                                }),
               Error);
  EXPECT_EQ(file_text(folder / "out.json"), "old");
  EXPECT_EQ(folder.file_count(), 1u);
  EXPECT_THAT([&] { write_text("x", folder / "no/such/folder/out.json"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("out.json"), HasSubstr("no folder"))));
  EXPECT_THAT([&] { write_text("x", folder.path()); }, ThrowsMessage<Error>(HasSubstr("is a folder")));
  EXPECT_THAT([&] { write_text("x", "/proc/burin.json"); }, ThrowsMessage<Error>(HasSubstr("/proc/burin.json")));
}

TEST(JsonFile, OutputFolders) {
  const TemporaryFolder folder;
  make_output_folder(folder / "a/b/c");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a/b/c"));
  make_output_folder(folder / "a/b/c");  // again is fine
  folder.write("file", "x");
  EXPECT_THAT([&] { make_output_folder(folder / "file"); }, ThrowsMessage<Error>(HasSubstr("is a file")));
  EXPECT_THAT([&] { make_output_folder("/proc/burin"); }, ThrowsMessage<Error>(HasSubstr("/proc/burin")));
}

TEST(JsonFile, PathsAreRelativeToTheFileThatHoldsThem) {
  EXPECT_EQ(resolve_path("rigs/a/board.json", "scratches.csv"), "rigs/a/scratches.csv");
  EXPECT_EQ(resolve_path("rigs/a/board.json", "../b/x.csv"), "rigs/b/x.csv");
  EXPECT_EQ(resolve_path("board.json", "x.csv"), "x.csv");
  EXPECT_EQ(resolve_path("rigs/board.json", "/data/x.csv"), "/data/x.csv");
  EXPECT_EQ(path_beside("rigs/a/board.json", "rigs/a/scratches.csv"), "scratches.csv");
  EXPECT_EQ(path_beside("rigs/a/board.json", "rigs/b/x.csv"), "../b/x.csv");
}

}  // namespace
}  // namespace burin
