// What tables of known footprint integrals promise: read in any order of columns, broken ones refused with file, line
// and column, and rows that are wrong said to be wrong.
#include "burin/render/footprint/ndf_cases.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "burin/base/error.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class NdfCases : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) { return folder_.write("cases.csv", text); }

  std::string message(const std::string& text) {
    try {
      read_ndf_cases(write(text));
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  }

  TemporaryFolder folder_;
};

const std::string kCasesHeader =
    "hx,hy,hz,alpha,width_um,depth_um,L_mm,x0_mm,y0_mm,x1_mm,y1_mm,x2_mm,y2_mm,x3_mm,y3_mm,Dhat_mm2";
// alpha 1: D = 1/pi, so Dhat is the area over pi, known without any code: 0.02 x 0.03 mm inside a groove of w = 0.0599
// mm.
const std::string kRow = "0,0,1,1,400,18.4,10,-0.01,1,0.01,1,0.01,1.03,-0.01,1.03,0.00019098593171027440292";

// Proves that a minimal table is read and its row, known by hand, passes.
TEST_F(NdfCases, MinimalTable) {
  const auto cases = read_ndf_cases(write(kCasesHeader + "\n" + kRow + "\n"));
  ASSERT_EQ(cases.size(), 1u);
  EXPECT_EQ(cases[0].id, "0");
  EXPECT_EQ(cases[0].groove.depth_um, 18.4);
  EXPECT_EQ(cases[0].corners_mm[2].y(), 1.03);
  EXPECT_FALSE(cases[0].area_mm2 || cases[0].Dhat_gradient || cases[0].area_gradient);
  const auto r = compare(cases[0]);
  EXPECT_TRUE(r.ok()) << ndf_line(r);
  EXPECT_LT(r.relative_error, 1e-14);
  EXPECT_THAT(ndf_summary({r}), HasSubstr("1 rows, 1 within tolerance"));
}

// Proves that order of columns, unknown columns, Windows line ends, spaces, a byte order mark and empty lines do not
// matter.
TEST_F(NdfCases, OtherOrderAndExtraColumns) {
  std::string header =
      "\xEF\xBB\xBF"
      "kind,note,Dhat_mm2, " +
      kCasesHeader.substr(0, kCasesHeader.rfind(','));
  std::string row = "mine,whatever,1.9098593171027440292e-4," + kRow.substr(0, kRow.rfind(','));
  const auto cases = read_ndf_cases(write(header + "\r\n" + row + "\r\n\r\n" + row + "\r\n"));
  ASSERT_EQ(cases.size(), 2u);
  EXPECT_EQ(cases[1].id, "1");
  EXPECT_EQ(cases[1].kind, "mine");
  EXPECT_TRUE(compare(cases[1]).ok());
}

// Proves that a wrong value, area or derivative is found, and named.
TEST_F(NdfCases, WrongRowsAreNamed) {
  const auto text = [](const char* Dhat, const char* area, const char* depth) {
    return kCasesHeader +
           ",area_mm2,darea_dwidth_um,darea_ddepth_um,darea_dL_mm,darea_dx0,darea_dy0,darea_dx1,darea_dy1,darea_dx2,"
           "darea_dy2,darea_dx3,darea_dy3\n" +
           kRow.substr(0, kRow.rfind(',') + 1) + Dhat + "," + area + ",0," + depth +
           ",0,-0.015,-0.01,0.015,-0.01,0.015,0.01,-0.015,0.01\n";
  };
  const auto verdict = [&](const std::string& table) { return compare(read_ndf_cases(write(table))[0]); };
  const char *Dhat = "0.00019098593171027440292", *area = "0.0006";
  EXPECT_TRUE(verdict(text(Dhat, area, "0")).ok()) << ndf_line(verdict(text(Dhat, area, "0")));
  EXPECT_FALSE(verdict(text("0.000190985934", area, "0")).value_ok);
  EXPECT_FALSE(verdict(text(Dhat, "0.000600001", "0")).area_ok);
  const auto r = verdict(text(Dhat, area, "1e-9"));
  EXPECT_FALSE(r.gradient_ok);
  EXPECT_EQ(r.worst_derivative, "darea_ddepth_um");
  EXPECT_NEAR(*r.area_gradient_error, 1e-9 / 0.015, 1e-12);
  EXPECT_THAT(ndf_line(r), HasSubstr("GRADIENT(darea_ddepth_um)"));
}

// Proves each error names file, line and column, and what to do.
TEST_F(NdfCases, BrokenTables) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string row = kRow;
    row.replace(row.find(from), from.size(), to);
    return kCasesHeader + "\n" + row + "\n";
  };
  EXPECT_THAT(message(with("18.4", "deep")), AllOf(HasSubstr("cases.csv:2: depth_um"), HasSubstr("\"deep\"")));
  EXPECT_THAT(message(with("18.4", "nan")), AllOf(HasSubstr(":2: depth_um"), HasSubstr("finite")));
  EXPECT_THAT(message(with("18.4", "1e999")), AllOf(HasSubstr(":2: depth_um"), HasSubstr("finite")));
  EXPECT_THAT(message(with("18.4", "")), HasSubstr(":2: depth_um"));
  EXPECT_THAT(message(with("18.4", "-3")), AllOf(HasSubstr(":2: depth_um"), HasSubstr("greater than 0")));
  EXPECT_THAT(message(with("0,0,1,1,", "0,0,1,1.5,")), AllOf(HasSubstr(":2: alpha"), HasSubstr("at most 1")));
  EXPECT_THAT(message(with("0,0,1,1,", "0,0,0,1,")), HasSubstr("no length"));
  EXPECT_THAT(message(with("18.4,", "")), AllOf(HasSubstr(":2"), HasSubstr("15 values"), HasSubstr("16 columns")));
  EXPECT_THAT(message("hx,hy\n1,2\n"), AllOf(HasSubstr(":1"), HasSubstr("column hz"), HasSubstr("missing")));
  EXPECT_THAT(message("hx,hx\n1,2\n"), HasSubstr("twice"));
  EXPECT_THAT(message(kCasesHeader + "\n"), HasSubstr("no rows"));
  EXPECT_THAT(message(""), HasSubstr("no rows"));
  EXPECT_THROW(read_ndf_cases("/nowhere/cases.csv"), Error);
  EXPECT_THROW(read_ndf_cases(folder_.path()), Error);
}

}  // namespace
}  // namespace burin
