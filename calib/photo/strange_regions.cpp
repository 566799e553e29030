#include "burin/calib/photo/strange_regions.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "burin/base/cell_grid.h"
#include "burin/base/files/decimals.h"

namespace burin {
namespace {

// Counts by square of the board.
struct BoardSquares {
  CellGrid grid;
  std::vector<int> seen, strange;  // photos

  explicit BoardSquares(const Board& board)
      : grid(cell_grid(board.size_mm, kStrangeSquareMm)), seen(grid.cells(), 0), strange(seen) {}
  std::size_t at(const Eigen::Vector2d& p_mm) const { return grid.cell(grid.column(p_mm.x()), grid.row(p_mm.y())); }
  // Calls visit(index) for a square and its neighbors.
  template <typename Visit>
  void each_around(int column, int row, const Visit& visit) const {
    for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(grid.columns - 1, column + 1); ++c) visit(grid.cell(c, r));
  }
};

}  // namespace

std::vector<StrangeRegion> strange_regions(const Problem& data, const State& state) {
  constexpr double kBeyond = 4;  // expected errors
  BoardSquares squares(*data.model.board);
  const Carved carved = carved_at(data.model, state.of(0));
  for (const PhotoData& photo : data.photos) {
    const Image value = predict(data.model, photo, state.of(photo.photo.light), carved);
    std::vector<int> pixels(squares.seen.size(), 0), off(pixels);
    for (std::size_t i = 0; i < photo.weight.size(); ++i) {
      if (!(photo.weight[i] > 0)) continue;
      const std::size_t square = squares.at(footprint_middle_mm(*photo.scene.grid, i));
      ++pixels[square];
      off[square] += std::abs(value.data[i] - photo.photo.value.data[i]) * photo.weight[i] > kBeyond;
    }
    for (std::size_t s = 0; s < pixels.size(); ++s) {
      squares.seen[s] += pixels[s] > 0;
      squares.strange[s] += pixels[s] > 0 && 2 * off[s] >= pixels[s];
    }
  }

  const auto is_strange = [&](std::size_t s) {
    return squares.strange[s] >= 2 && 2 * squares.strange[s] >= squares.seen[s];
  };
  std::vector<StrangeRegion> regions;
  std::vector<bool> taken(squares.seen.size(), false);
  std::size_t strange = 0, seen = 0;
  for (std::size_t start = 0; start < taken.size(); ++start) {
    seen += squares.seen[start] > 0;
    strange += is_strange(start);
    if (taken[start] || !is_strange(start)) continue;
    StrangeRegion region;
    std::vector<std::size_t> next{start};
    taken[start] = true;
    while (!next.empty()) {
      const std::size_t s = next.back();
      next.pop_back();
      const int column = static_cast<int>(s) % squares.grid.columns, row = static_cast<int>(s) / squares.grid.columns;
      region.squares.emplace_back(column, row);
      region.strange_in = std::max(region.strange_in, static_cast<std::size_t>(squares.strange[s]));
      region.seen_in = std::max(region.seen_in, static_cast<std::size_t>(squares.seen[s]));
      squares.each_around(column, row, [&](std::size_t other) {
        if (taken[other] || !is_strange(other)) return;
        taken[other] = true;
        next.push_back(other);
      });
    }
    constexpr std::size_t kFewest = 4;
    if (region.squares.size() < kFewest) continue;
    Eigen::Vector2i low = region.squares.front(), high = low;
    for (const Eigen::Vector2i& square : region.squares) {
      low = low.cwiseMin(square);
      high = high.cwiseMax(square);
    }
    region.min_mm = squares.grid.cell_mm * low.cast<double>();
    region.max_mm =
        (squares.grid.cell_mm * (high.cast<double>() + Eigen::Vector2d::Ones())).cwiseMin(data.model.board->size_mm);
    regions.push_back(std::move(region));
  }
  if (3 * strange >= seen) return {};
  std::stable_sort(regions.begin(), regions.end(),
                   [](const StrangeRegion& a, const StrangeRegion& b) { return a.squares.size() > b.squares.size(); });
  return regions;
}

void leave_out(const std::vector<StrangeRegion>& regions, const Problem& data, std::vector<LightView>& views) {
  const BoardSquares squares(*data.model.board);
  std::vector<bool> out(squares.seen.size(), false);
  for (const StrangeRegion& region : regions)
    for (const Eigen::Vector2i& square : region.squares)
      squares.each_around(square.x(), square.y(), [&](std::size_t near) { out[near] = true; });
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    const PhotoData& photo = data.photos[k];
    LightView& view = views[k];
    const PixelWindow &binned = photo.photo.window, &whole = view.window;
    for (int y = 0; y < binned.height; ++y)
      for (int x = 0; x < binned.width; ++x) {
        const Eigen::Vector2d p =
            footprint_middle_mm(*photo.scene.grid, static_cast<std::size_t>(y) * binned.width + x);
        if (!std::isfinite(p.x()) || !out[squares.at(p)]) continue;
        for (int v = 0; v < photo.bin; ++v)
          for (int u = 0; u < photo.bin; ++u) {
            const int px = (x + binned.x0) * photo.bin + u - whole.x0, py = (y + binned.y0) * photo.bin + v - whole.y0;
            if (px >= 0 && py >= 0 && px < whole.width && py < whole.height)
              view.valid[static_cast<std::size_t>(py) * whole.width + px] = 0;
          }
      }
  }
}

Finding told(const StrangeRegion& region) {
  const Eigen::Vector2d size = region.max_mm - region.min_mm, middle = 0.5 * (region.min_mm + region.max_mm);
  return make_warning(FindingCode::region_omitted,
                      "a region of " + fixed(size.x(), 0) + " x " + fixed(size.y(), 0) + " mm at (" +
                          fixed(middle.x(), 0) + ", " + fixed(middle.y(), 0) + ") mm does not look like the board in " +
                          std::to_string(region.strange_in) + " of " + std::to_string(region.seen_in) +
                          " photos: a sticker, or fingerprints? It is left out of the fit",
                      "clean the board there and photograph it again if the grooves under it matter");
}

}  // namespace burin
