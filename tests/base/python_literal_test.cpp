// Proves: what Python writes as a literal is read with its values, and what is no literal is refused with its line, cut
// short at every byte included.
#include "burin/base/files/python_literal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "burin/base/error.h"

namespace burin {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Json read(const std::string& text) { return PythonLiteral(text, "x.cameramodel").value(); }

constexpr const char* kAll =
    "# a comment {\n{ 'text': \"it's\", \"bytes\": b'P)h>@6\\'#', 'list': [ 1, -2.5e-3, +4., ],\n"
    "  'tuple': (7,), 'nested': {'a': [[1, 2], []]}, # more\r\n  'none': None, 'yes': True, }\n";

TEST(PythonLiteral, ValuesAreRead) {
  const Json json = read(kAll);
  EXPECT_EQ(json["text"], "it's");
  EXPECT_EQ(json["bytes"], "P)h>@6\\'#");
  EXPECT_EQ(json["list"], Json({1.0, -2.5e-3, 4.0}));
  EXPECT_EQ(json["tuple"], Json::array({7.0}));
  EXPECT_EQ(json["nested"]["a"][0][1], 2.0);
  EXPECT_TRUE(json["none"].is_null());
  EXPECT_EQ(json["yes"], true);
}

TEST(PythonLiteral, CutShortAnywhereIsRefused) {
  const std::string all(kAll);
  const std::size_t whole = all.rfind('}');
  for (std::size_t length = 0; length <= whole; ++length) EXPECT_THROW(read(all.substr(0, length)), Error) << length;
  EXPECT_NO_THROW(read(all.substr(0, whole + 1)));
}

TEST(PythonLiteral, FaultsAreNamedWithTheirLine) {
  const auto expect = [](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { read(text); }, ThrowsMessage<Error>(HasSubstr(message))) << text;
  };
  expect("{\n'a': 1,\n'b': nan}", "x.cameramodel:3: \"nan\" is no finite number");
  expect("{\n'a' 1}", "x.cameramodel:2: a colon is missing after 'a'");
  expect("{'a': [1 2]}", "a comma or ] is missing");
  expect("{'a': 1 'b': 2}", "a comma or } is missing");
  expect("{'a': 'open\n}", "text in quotes does not end");
  expect("{1: 2}", "a name in quotes is missing");
  expect("{} {}", "something after its end");
  expect("", "ends too early");
  expect(std::string(100000, '['), "brackets within brackets");
  expect("{'a': @}", "\"@\" is no finite number");
}

}  // namespace
}  // namespace burin
