#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/print/print_pages.h"

namespace burin {

ChessboardPage chessboard_page(const PrintSetup& setup) {
  ChessboardPage out;
  // Upright on the page: rows of corners are horizontal. The white border is half a square wide.
  const int across = out.rows + 1, upright = out.columns + 1;
  const Eigen::Vector2d room = free_area(setup, kUsualHead_mm).size();
  out.square_mm = std::floor(std::min(room.x() / (across + 1), room.y() / (upright + 1)));
  out.page = new_page(
      setup, fmt::format("Chessboard for a lens of your own: {} x {} inner corners", out.columns, out.rows),
      {fmt::format("Glue it on something stiff and flat, photograph it in all parts of the picture, tilted too; then: "
                   "burin lens PHOTOS_DIR --chessboard {}x{} --square {:g} --out camera.cameramodel",
                   out.columns, out.rows, out.square_mm)});
  const Eigen::Vector2d size = out.square_mm * Eigen::Vector2d(across, upright);
  const Eigen::Vector2d low = (out.page.free.low + out.page.free.high - size) / 2;
  Shape black{{}, true, Tint::black, {}};
  for (int row = 0; row < upright; ++row)
    for (int column = row % 2; column < across; column += 2) {
      const Eigen::Vector2d a = low + out.square_mm * Eigen::Vector2d(column, row),
                            b = a + out.square_mm * Eigen::Vector2d(1, 1);
      black.outlines.push_back({a, {b.x(), a.y()}, b, {a.x(), b.y()}});
    }
  out.page.drawing.elements.emplace_back(std::move(black));
  return out;
}

}  // namespace burin
