// tools/sheet/sheet.h - printed sheet for the set-up of a bench. It gives the places of lamps and eyes, on a table and
// on a wall, with their tolerances, and a checklist of the photos in order. tools/sheet/bench_drawing.h draws it once
// for both outputs: PDF pages and a self-contained HTML page.
#pragma once

#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/calib/plan.h"
#include "tools/drawing/drawing.h"
#include "tools/plan_words.h"
#include "tools/sheet/bench_drawing.h"
#include "tools/wanted_bench.h"

namespace burin {

/// Contents of the sheet before layout.
struct Sheet {
  std::string name;  ///< of the project
  Board board;
  std::vector<SheetPlace> places;  ///< lamps, then eyes in the design's order
  int measured_rounds = 0;         ///< 0: nominal bench
  double hang_height_mm = 1500;    ///< of the board's center above the floor; usual_hang_height_mm()
  PlanFocus focus;
  Plan plan;
};

/// Returns lamps and eyes of the design. Each lamp has the smallest tolerance of the views that it lights.
std::vector<SheetPlace> sheet_places(const WantedBench& wanted);

/// Eye height of a standing adult above the floor.
inline constexpr double kStandingEye_mm = 1600;
/// Returns the height of the board's center above the floor, to 10 mm. At this height, the middle of the eyes' heights
/// is kStandingEye_mm: with a lamp above the board, eyes are below its center. The board's lower edge stays above the
/// floor.
double usual_hang_height_mm(const Board& board, const std::vector<SheetPlace>& places);

/// One place in words, for one placement of the board.
struct PlaceInWords {
  std::string name;  ///< "1 left"
  /// from the board's edges; height (above the face, the floor); from table or wall
  std::string across, upright, away;
  std::string tolerance;  ///< "12, 14, 90 mm": sideways, up or down, in depth
};
inline constexpr const char* kToleranceHead = "holds within: sideways, up, in depth";
std::vector<PlaceInWords> on_table(const Sheet& sheet);
std::vector<PlaceInWords> on_wall(const Sheet& sheet);

/// The photos of the plan, in words.
struct PhotoInWords {
  std::string name, place, lamp, exposures;
};
std::vector<PhotoInWords> photos_in_words(const Sheet& sheet);

/// Introductory sentences for table and wall.
std::string introduction(const Sheet& sheet);
/// Reports the eyes' heights on the wall, as a note, or as a warning if no person stands at that height. Also reports
/// places below the floor.
std::vector<Finding> findings(const Sheet& sheet);

/// Returns the words with a capital first letter.
std::string begun_as_sentence(std::string words);

/// Returns upright pages of the given paper.
std::vector<Drawing> sheet_pages(const Sheet& sheet, const Eigen::Vector2d& paper_mm);
std::string sheet_html(const Sheet& sheet);

}  // namespace burin
