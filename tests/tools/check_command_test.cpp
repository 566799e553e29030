// burin check ndf, as a person runs it: a line of value and error and a line of gradient for each row, a summary, and
// an exit code that says whether all rows are within their tolerance. That the values are right is
// footprint_integral_test's.
#include <gmock/gmock.h>

#include <string>

#include "tests/tools/program.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// alpha 1: D is 1 / pi, so the value is the footprint's area, 0.02 x 0.03 mm, over pi.
std::string table(const std::string& value) {
  return "id,kind,hx,hy,hz,alpha,width_um,depth_um,L_mm,x0_mm,y0_mm,x1_mm,y1_mm,x2_mm,y2_mm,x3_mm,y3_mm,Dhat_mm2\n"
         "first,rough,0,0,1,1,400,18.4,10,-0.01,1,0.01,1,0.01,1.03,-0.01,1.03,1.9098593171027440292e-4\n"
         "second,rough,0,0,2,1,400,18.4,10,0.01,1,-0.01,1,-0.01,1.03,0.01,1.03," +
         value + "\n";
}

TEST(CheckNdf, RightRowsAreOk) {
  const TemporaryFolder folder;
  folder.write("cases.csv", table("1.9098593171027440292e-4"));
  const Outcome run = run_burin(folder, {"check", "ndf", "cases.csv"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("first"), HasSubstr("second"), HasSubstr("dDhat_dx0="),
                             HasSubstr("2 rows, 2 within tolerance")));
  const Outcome brief = run_burin(folder, {"check", "ndf", "cases.csv", "--brief"});
  EXPECT_EQ(brief.exit_code, 0);
  EXPECT_EQ(brief.out.find("dDhat_dx0="), std::string::npos);
}

TEST(CheckNdf, AWrongRowIsSaid) {
  const TemporaryFolder folder;
  folder.write("cases.csv", table("1.90986e-4"));
  const Outcome run = run_burin(folder, {"check", "ndf", "cases.csv"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, AllOf(HasSubstr("VALUE"), HasSubstr("2 rows, 1 within tolerance")));
  EXPECT_THAT(run.err, AllOf(HasSubstr("cases.csv"), HasSubstr("1 of 2 rows")));
}

TEST(CheckNdf, ABrokenTableIsNamed) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_burin(folder, {"check", "ndf", "none.csv"}).exit_code, 1);
  folder.write("cases.csv", table("nan"));
  const Outcome run = run_burin(folder, {"check", "ndf", "cases.csv"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("cases.csv:3: Dhat_mm2"));
  EXPECT_EQ(run.out, "");
}

}  // namespace
}  // namespace burin
