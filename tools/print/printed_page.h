// tools/print/printed_page.h - printed sheets of paper: their sizes, the printer's measured scale, and the frame of
// every page with a horizontal and a vertical 100 mm ruler.
//
// The layout is in printed mm. If a printer's 100 mm ruler measures 97.5 mm, the printer scales by 0.975, and the PDF
// is drawn 100 / 97.5 times as large. Frame: of a Drawing.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/drawing/drawing.h"

namespace burin {

struct Paper {
  std::string name;
  Eigen::Vector2d size_mm{0, 0};  ///< upright
};

/// Returns the supported papers, small ones first: a4, letter, a3, tabloid.
std::vector<Paper> papers();
/// Throws Error for any other name.
Paper find_paper(const std::string& name);

/// Default paper of the system's region.
struct UsualPaper {
  std::string name;  ///< "a4" or "letter"
  std::string why;   ///< the deciding setting: "LC_PAPER=en_US.UTF-8"; empty without one
};

/// Uses the region of the first one set of LC_ALL, LC_PAPER and LANG. Returns letter if Unicode's CLDR has it as the
/// region's usual paper (supplemental data, paperSize), else A4. The locale need not be installed.
UsualPaper usual_paper();

/// Print settings of all pages of one file.
struct PrintSetup {
  Paper paper;
  /// Measured lengths of this printer's 100 mm rulers, mm.
  double across_mm = 100, upright_mm = 100;
  std::string name;  ///< of the project, for the pages' heads
};

/// Throws Error for impossible lengths of 100 mm (below 80, above 125, not a number).
void require_good(const PrintSetup& setup);

/// Returns true if the sizes compensate for the printer's scale.
bool is_compensated(const PrintSetup& setup);

/// Returns the paper's size in printed mm.
Eigen::Vector2d printed_size_mm(const PrintSetup& setup);
/// Returns the PDF's scale for these (PdfPaper::stretch).
Eigen::Vector2d stretch(const PrintSetup& setup);

/// Area of a page for its contents. It stays on the paper even if the printer shifts or crops an enlarged page.
struct FreeArea {
  Eigen::Vector2d low, high;
  Eigen::Vector2d size() const { return high - low; }
};
/// `head_mm`: height of the page's head.
FreeArea free_area(const PrintSetup& setup, double head_mm);

/// First and last mark of a ruler.
struct Ruler {
  Eigen::Vector2d zero, hundred;
};

/// A page with head, foot and rulers.
struct PrintedPage {
  Drawing drawing;
  FreeArea free;
  Ruler across, upright;
};

inline constexpr double kUsualHead_mm = 24;

/// `title` names the page and `lines` are instructions, one line each, cut to the page's width.
PrintedPage new_page(const PrintSetup& setup, const std::string& title, const std::vector<std::string>& lines,
                     double head_mm = kUsualHead_mm);

}  // namespace burin
