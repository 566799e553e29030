// Proves: tables are read by their columns' names whatever stands around them, numbers without a locale, and each fault
// is named with its line. What the columns mean is proved by those who read them (scratches_test, ndf_cases_test).
#include "burin/base/files/table.h"

#include <gmock/gmock.h>

#include <clocale>

#include "burin/base/error.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Optional;
using ::testing::ThrowsMessage;

class Table : public ::testing::Test {
 protected:
  TableReader table(const std::string& text, TableStyle style, const std::vector<std::string>& required) {
    folder_.write("table", text);
    return {folder_ / "table", style, required, "write a header"};
  }
  TemporaryFolder folder_;
};

TEST(NumberIn, FiniteNumbersAndNothingElse) {
  EXPECT_THAT(number_in("1.5"), Optional(1.5));
  EXPECT_THAT(number_in("+2e-3"), Optional(2e-3));
  EXPECT_THAT(number_in("-7"), Optional(-7.0));
  EXPECT_THAT(number_in("1e-400"), Optional(0.0));
  for (const char* text : {"", "+", "nan", "inf", "1e999", "1,5", "1.5mm", " 1", "one"})
    EXPECT_EQ(number_in(text), std::nullopt) << text;
}

TEST(NumberIn, NoLocaleChangesThePoint) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"})
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  EXPECT_THAT(number_in("1.5"), Optional(1.5));
  std::setlocale(LC_ALL, before.c_str());
}

TEST_F(Table, CsvByColumnNames) {
  TableReader t = table("\xEF\xBB\xBF\r\n b , a\r\n1, 2\r\n\r\n3,4", TableStyle::csv, {"a"});
  EXPECT_THAT(t.columns(), ElementsAre("b", "a"));
  ASSERT_TRUE(t.next());
  EXPECT_EQ(t.number(*t.find("a")), 2);
  ASSERT_TRUE(t.next());
  EXPECT_EQ(t.number(*t.find("a")), 4);
  EXPECT_THAT(t.where(), HasSubstr("table:5"));
  EXPECT_FALSE(t.next());
  EXPECT_EQ(t.find("c"), std::nullopt);
}

TEST_F(Table, CsvFaultsAreNamed) {
  const auto read = [&](const std::string& text) {
    return [this, text] {
      TableReader t = table(text, TableStyle::csv, {"a", "b"});
      while (t.next()) t.positive(*t.find("b"));
    };
  };
  EXPECT_THAT(read("a\n1\n"), ThrowsMessage<Error>(AllOf(HasSubstr("table:1"), HasSubstr("column b is missing"))));
  EXPECT_THAT(read("a,b,a\n"), ThrowsMessage<Error>(HasSubstr("column a appears twice")));
  EXPECT_THAT(read("a,b\n1,2\n1\n"), ThrowsMessage<Error>(AllOf(HasSubstr("table:3"), HasSubstr("1 values"))));
  EXPECT_THAT(read("a,b\n1,2,3\n"), ThrowsMessage<Error>(HasSubstr("more than 2")));
  EXPECT_THAT(read("a,b\n1,x\n"), ThrowsMessage<Error>(AllOf(HasSubstr("table:2"), HasSubstr("b is \"x\""))));
  EXPECT_THAT(read("a,b\n1,0\n"), ThrowsMessage<Error>(HasSubstr("greater than 0")));
  EXPECT_NO_THROW(read("")());
}

// What spreadsheets write where commas are decimal ones, and elsewhere.
TEST_F(Table, CsvOfSpreadsheets) {
  for (const char* text : {"a;b\n1,5;-2,25\n", "sep=;\r\na;b\r\n1,5;-2,25\r\n", "\xEF\xBB\xBFsep=;\na;b\n1,5;-2,25\n",
                           "a\tb\n1,5\t-2,25\n", "sep=\t\na\tb\n1,5\t-2,25\n", "\"a\";\"b\"\n\"1,5\";\"-2,25\"\n",
                           "\"a\",\"b\"\n\"1,5\",\"-2,25\"\n", "\"a\",b\n 1.5 , \"-2.25\" \n", "a;b\n1.5;-2.25\n",
                           "sep=,\na,b\n1.5,-2.25\n", "\"sep=;\"\na;b\n1,5;-2,25\n", "a,b,,\n1.5,-2.25,,\n",
                           "a,b\n1.5,-2.25,,,\n,,,,\n", "a;b;;\r\n1,5;-2,25;;\r\n;;;\r\n;;;\r\n"}) {
    TableReader t = table(text, TableStyle::csv, {"a", "b"});
    EXPECT_THAT(t.columns(), ElementsAre("a", "b")) << text;
    ASSERT_TRUE(t.next()) << text;
    EXPECT_EQ(t.number(0), 1.5) << text;
    EXPECT_EQ(t.number(1), -2.25) << text;
    EXPECT_FALSE(t.next()) << text;
  }
}

TEST_F(Table, LinesEndAsOnAnySystem) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {  // the last one: old Macs, and Excel's "CSV (Macintosh)"
    TableReader lines = table("a,b" + end + "1,2" + end + end + "3,4" + end, TableStyle::csv, {"a"});
    ASSERT_TRUE(lines.next());
    EXPECT_EQ(lines.number(1), 2);
    ASSERT_TRUE(lines.next());
    EXPECT_EQ(lines.number(0), 3);
    EXPECT_THAT(lines.where(), HasSubstr(":4")) << "an empty line counts";
    EXPECT_FALSE(lines.next());
  }
}

TEST_F(Table, CsvThatCouldBeReadInTwoWaysIsRefused) {
  const auto refuse = [&](const std::string& text, const std::string& where, const std::string& why) {
    EXPECT_THAT(([&] {
                  TableReader t = table(text, TableStyle::csv, {"a", "b"});
                  while (t.next()) t.number(0), t.number(1);
                }),
                ThrowsMessage<Error>(AllOf(HasSubstr(where), HasSubstr(why))))
        << text;
  };
  refuse("a;b\n1,5;2\n1.234;2\n", "table:3: a is \"1.234\"", "decimals stand behind a comma");
  refuse("a;b\n1.5;2\n1;2,5\n", "table:3: b is \"2,5\"", "decimals stand behind a point");
  refuse("a;b\n1.234,5;2\n", "table:2: a is \"1.234,5\"", "decimal point");
  refuse("a;b\n1,234,5;2\n", "table:2: a is \"1,234,5\"", "decimal point");
  refuse("a,b\n\"1,234\",2\n", "table:2: a is \"1,234\"", "between thousands");
  refuse("a,b\n1,5,2,5\n", "table:2", "separate values by semicolons");
  refuse("a,,b\n1,2,3\n", "table:1", "column 2 has no name");
  refuse("a,b\n1,2,,3\n", "table:2", "more than 2 values");
  refuse("a,b\n\"1,2\n", "table:2", "value 1 has no closing quote");
  refuse("a,b\n\"1\"5,2\n", "table:2", "goes on behind its quotes");
  refuse("sep=|\na|b\n1|2\n", "table:1", "separates by \"|\"");
  refuse("a;b\n1,5 mm;2\n", "table:2: a is \"1,5 mm\"", "finite number");
  refuse(std::string("\xFF\xFE\x61\0", 4), "table", "UTF-16");
  refuse("PK\x03\x04rest", "table", "is a spreadsheet");
}

TEST_F(Table, VnlogTakesTheFirstLegendThatNamesWhatIsNeeded) {
  TableReader t = table("## made by hand\n# a remark\n# view x\nv0 1.5\n# another\nv1 -\n\n#! no\nv2\n",
                        TableStyle::vnlog, {"view", "x"});
  ASSERT_TRUE(t.next());
  EXPECT_EQ(t.text(0), "v0");
  EXPECT_EQ(t.number(1), 1.5);
  ASSERT_TRUE(t.next());
  EXPECT_FALSE(t.has(1));
  ASSERT_TRUE(t.next());
  EXPECT_THAT([&] { t.number(1); }, ThrowsMessage<Error>(AllOf(HasSubstr("table:9"), HasSubstr("x is missing"))));
  EXPECT_FALSE(t.next());
}

TEST_F(Table, VnlogWithoutALegendIsRefused) {
  TableReader t = table("v0 1\n", TableStyle::vnlog, {"view", "x"});
  EXPECT_THAT([&] { t.next(); }, ThrowsMessage<Error>(AllOf(HasSubstr("view, x"), HasSubstr("write a header"))));
}

}  // namespace
}  // namespace burin
