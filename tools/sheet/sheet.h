// tools/sheet/sheet.h - one thing to take to the wall: where lamps hang and eyes stand for the views of a design, on a
// table and on a wall, with what each place tolerates; and the photos to take, in order, to be ticked off. Drawn once
// (tools/sheet/bench_drawing.h), written as PDF pages and as one HTML page that needs nothing else.
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

/// All that the sheet says, before it is laid out.
struct Sheet {
  std::string name;  ///< of the project
  Board board;
  std::vector<SheetPlace> places;  ///< lamps, then eyes in the design's order
  int measured_rounds = 0;         ///< 0: the bench is as it was believed
  double hang_height_mm = 1500;    ///< of the board's middle above the floor; usual_hang_height_mm()
  PlanFocus focus;
  Plan plan;
};

/// Lamps and eyes of the design, each lamp with the least tolerance of the views that it lights.
std::vector<SheetPlace> sheet_places(const WantedBench& wanted);

/// How high a standing adult's eyes are above the floor.
inline constexpr double kStandingEye_mm = 1600;
/// The height of the board's middle above the floor, to 10 mm, at which the middle of its eyes' heights is
/// kStandingEye_mm: for a lamp above the board, eyes are below its middle. Its lower edge stays above the floor.
double usual_hang_height_mm(const Board& board, const std::vector<SheetPlace>& places);

/// One place, in words for one of the two ways that a board lies.
struct PlaceInWords {
  std::string name;                   ///< "1 left"
  std::string across, upright, away;  ///< from the board's edges; height (of the face, the floor); from table or wall
  std::string tolerance;              ///< "12, 14, 90 mm": sideways, up or down, in depth
};
inline constexpr const char* kToleranceHead = "holds within: sideways, up, in depth";
std::vector<PlaceInWords> on_table(const Sheet& sheet);
std::vector<PlaceInWords> on_wall(const Sheet& sheet);

/// The photos of the plan, in words.
struct PhotoInWords {
  std::string name, place, lamp, exposures;
};
std::vector<PhotoInWords> photos_in_words(const Sheet& sheet);

/// Sentences that table and wall begin with.
std::string introduction(const Sheet& sheet);
/// What else the wall's drawing needs: how high its eyes are (a note, or a warning where nobody stands so), and what
/// stands in the way of following it: a place below the floor.
std::vector<Finding> findings(const Sheet& sheet);

/// The same words with the capital letter that a sentence of its own begins with.
std::string begun_as_sentence(std::string words);

/// Pages of that paper, upright.
std::vector<Drawing> sheet_pages(const Sheet& sheet, const Eigen::Vector2d& paper_mm);
std::string sheet_html(const Sheet& sheet);

}  // namespace burin
