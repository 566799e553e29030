// tools/print/print_pages.h - pages to print for a board, at true scale: tags to cut out, a tiled template with their
// places, and a chessboard for `burin lens`.
//
// Sizes are those of board.json. `size_mm` is the side of the square whose corners AprilTag reports. The paper to cut
// out is larger (tag_paper(): 1.8 times as wide for tagStandard41h12). Frame of pages: of a Drawing (printed mm, x
// right, y down). Frame of the board: that of board.json (x right, y up).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "burin/scene/board.h"
#include "tools/print/printed_page.h"

namespace burin {

/// Place of a tag on its page; always upright.
struct PrintedTag {
  std::size_t page = 0;
  int id = 0;
  Eigen::Vector2d center_mm{0, 0};
  double size_mm = 0;  ///< as in board.json
};

/// Pages of the tags. Throws Error for a board without tags. If a tag's paper does not fit the page, throws Error with
/// a suitable paper.
struct TagPages {
  std::vector<PrintedPage> pages;
  std::vector<PrintedTag> tags;
};
TagPages tag_pages(const Board& board, const PrintSetup& setup);

/// Part of the board on one page of the template.
struct Tile {
  std::size_t page = 0;
  std::string name;                 ///< "B2": row, column
  Eigen::Vector2d low_mm, high_mm;  ///< of this part of the board; neighbors overlap
  bool turned = false;              ///< the board's right is up on the page
  Eigen::Vector2d at_mm;            ///< place of low_mm on the page

  Eigen::Vector2d on_page(const Eigen::Vector2d& board_mm) const {
    const Eigen::Vector2d d = board_mm - low_mm;
    return turned ? Eigen::Vector2d(at_mm.x() - d.y(), at_mm.y() - d.x())
                  : Eigen::Vector2d(at_mm.x() + d.x(), at_mm.y() - d.y());
  }
};

/// A cross at the same place of the board on both tiles of a seam.
struct RegistrationMark {
  std::size_t page = 0;
  Eigen::Vector2d board_mm;
};

struct TemplatePages {
  std::vector<PrintedPage> pages;
  std::vector<Tile> tiles;
  std::vector<RegistrationMark> marks;
};
/// Throws Error for a board with more than 400 pages.
TemplatePages template_pages(const Board& board, const PrintSetup& setup);

/// Chessboard for `burin lens`: 9 x 6 inner corners, squares of whole mm, as large as the page allows.
struct ChessboardPage {
  PrintedPage page;
  int columns = 9, rows = 6;  ///< inner corners
  double square_mm = 0;
};
ChessboardPage chessboard_page(const PrintSetup& setup);

/// Returns a tag's black cells as one shape, in the upright tag's own frame: x right, y up, origin at its center, mm.
std::vector<std::vector<Eigen::Vector2d>> black_cells(const std::string& family, int id, double size_mm);

/// Returns the side of a tag's paper, mm.
double paper_side_mm(const Tag& tag, const std::string& family);

}  // namespace burin
