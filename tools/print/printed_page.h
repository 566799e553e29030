// tools/print/printed_page.h - sheets of paper as a printer makes them: their sizes, what a ruler measured on them, and
// the frame of every page, with a 100 mm ruler across and one upright.
//
// Everything is laid out in mm as they are to come out of the printer. A printer whose 100 mm ruler comes out 97.5 mm
// long makes everything 0.975 times as large, so its PDF is drawn 100 / 97.5 times as large. Frame: of a Drawing.
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

/// Those that can be printed on, small ones first: a4, letter, a3, tabloid.
std::vector<Paper> papers();
/// Throws Error for a name that is none of these.
Paper find_paper(const std::string& name);

/// The paper that printers hold here, when nobody names one.
struct UsualPaper {
  std::string name;  ///< "a4" or "letter"
  std::string why;   ///< the setting that says so: "LC_PAPER=en_US.UTF-8"; empty where none is set
};

/// By the region of LC_ALL, LC_PAPER or LANG, the first that is set: letter where Unicode's CLDR has it as the region's
/// usual paper (supplemental data, paperSize), else A4. No locale need be installed for it.
UsualPaper usual_paper();

/// How all pages of one file are printed.
struct PrintSetup {
  Paper paper;
  /// What a ruler said of this printer's 100 mm, mm.
  double across_mm = 100, upright_mm = 100;
  std::string name;  ///< of the project, for the pages' heads
};

/// Throws Error for measured lengths that no printer makes of 100 mm (below 80, above 125) and those that are no
/// number.
void require_good(const PrintSetup& setup);

/// Whether sizes are put right for a printer that errs.
bool is_compensated(const PrintSetup& setup);

/// The paper in mm as they come out of the printer.
Eigen::Vector2d printed_size_mm(const PrintSetup& setup);
/// What the PDF makes of these (PdfPaper::stretch).
Eigen::Vector2d stretch(const PrintSetup& setup);

/// What is free on a page for its contents, whichever way the printer shifts or crops a page that it makes larger.
struct FreeArea {
  Eigen::Vector2d low, high;
  Eigen::Vector2d size() const { return high - low; }
};
/// `head_mm`: how high the page's head is.
FreeArea free_area(const PrintSetup& setup, double head_mm);

/// A ruler's first and last mark.
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

/// `title` is what this page is, `lines` what to do with it: a line each, cut to the page's width.
PrintedPage new_page(const PrintSetup& setup, const std::string& title, const std::vector<std::string>& lines,
                     double head_mm = kUsualHead_mm);

}  // namespace burin
