// tools/print/print_pages.h - what a person prints for a board: its tags to be cut out, a template that says where each
// of them goes, in tiles, and a chessboard for `burin lens`. All at true scale.
//
// Sizes are board.json's: `size_mm` is the side of the square whose corners AprilTag reports, and what is cut out is
// the tag's whole paper (tag_paper(): 1.8 times as wide for tagStandard41h12). Frame of pages: of a Drawing (mm as they
// come out of the printer, x right, y down); of the board: board.json's (x right, y up).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "burin/scene/board.h"
#include "tools/print/printed_page.h"

namespace burin {

/// Where a tag to be cut out is on its page; always upright.
struct PrintedTag {
  std::size_t page = 0;
  int id = 0;
  Eigen::Vector2d center_mm{0, 0};
  double size_mm = 0;  ///< as board.json's
};

/// The tags' pages. Throws Error for a board without tags, and for a tag whose paper does not fit the page, naming the
/// paper that would do.
struct TagPages {
  std::vector<PrintedPage> pages;
  std::vector<PrintedTag> tags;
};
TagPages tag_pages(const Board& board, const PrintSetup& setup);

/// What one page of the template shows of the board.
struct Tile {
  std::size_t page = 0;
  std::string name;                 ///< "B2": row, column
  Eigen::Vector2d low_mm, high_mm;  ///< of the board that it shows; neighbors overlap
  bool turned = false;              ///< the board's right is up on the page
  Eigen::Vector2d at_mm;            ///< where low_mm lies on the page

  Eigen::Vector2d on_page(const Eigen::Vector2d& board_mm) const {
    const Eigen::Vector2d d = board_mm - low_mm;
    return turned ? Eigen::Vector2d(at_mm.x() - d.y(), at_mm.y() - d.x())
                  : Eigen::Vector2d(at_mm.x() + d.x(), at_mm.y() - d.y());
  }
};

/// A cross that both tiles of a seam show at the same place of the board.
struct RegistrationMark {
  std::size_t page = 0;
  Eigen::Vector2d board_mm;
};

struct TemplatePages {
  std::vector<PrintedPage> pages;
  std::vector<Tile> tiles;
  std::vector<RegistrationMark> marks;
};
/// Throws Error for a board that would take more than 400 pages.
TemplatePages template_pages(const Board& board, const PrintSetup& setup);

/// A chessboard as `burin lens` wants it: 9 x 6 inner corners, squares of whole mm, as large as the page allows.
struct ChessboardPage {
  PrintedPage page;
  int columns = 9, rows = 6;  ///< inner corners
  double square_mm = 0;
};
ChessboardPage chessboard_page(const PrintSetup& setup);

/// A tag's black cells as one shape, in the upright tag's own frame: x right, y up, origin at its center, mm.
std::vector<std::vector<Eigen::Vector2d>> black_cells(const std::string& family, int id, double size_mm);

/// The side of a tag's paper, mm.
double paper_side_mm(const Tag& tag, const std::string& family);

}  // namespace burin
