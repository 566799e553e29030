// burin/optimize/design/stroke_tiles.h - tiles of a picture for a parallel search. Work in one tile reads and changes
// nothing outside of it, so the result is independent of threads and their timing. Frame: pixels of the picture, y
// down.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace burin {

/// Pixels x0 <= x < x1, y0 <= y < y1.
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};

/// Square tiles over a picture; the first ones begin `shift` before its corner.
struct Tiling {
  int side = 1, shift_x = 0, shift_y = 0;  ///< shifts from 0 to side - 1
  int width = 0, height = 0;               ///< of the picture

  std::size_t columns() const { return static_cast<std::size_t>((width - 1 + shift_x) / side) + 1; }
  std::size_t rows() const { return static_cast<std::size_t>((height - 1 + shift_y) / side) + 1; }
  std::size_t size() const { return columns() * rows(); }
  /// The tile of a pixel of the picture.
  std::size_t tile_of(int x, int y) const {
    return static_cast<std::size_t>((y + shift_y) / side) * columns() + static_cast<std::size_t>((x + shift_x) / side);
  }
  /// Pixels of a tile inside the picture.
  PixelBox box(std::size_t tile) const {
    const int left = static_cast<int>(tile % columns()) * side - shift_x;
    const int top = static_cast<int>(tile / columns()) * side - shift_y;
    return {std::max(0, left), std::max(0, top), std::min(width, left + side), std::min(height, top + side)};
  }
};

/// Divides `count` among parts by their weights; the shares add up to it (systematic sampling from `start`, 0..1). All
/// shares are 0 if all weights are 0.
inline std::vector<std::size_t> shared_out(std::size_t count, const std::vector<double>& weights, double start) {
  double total = 0;
  for (const double w : weights) total += w;
  std::vector<std::size_t> shares(weights.size(), 0);
  if (!(total > 0)) return shares;
  double sum = 0;
  std::size_t given = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    const double upto = i + 1 == weights.size()
                            ? static_cast<double>(count)
                            : std::min(static_cast<double>(count), sum / total * static_cast<double>(count) + start);
    const auto whole = std::max(given, static_cast<std::size_t>(upto));
    shares[i] = whole - given;
    given = whole;
  }
  return shares;
}

}  // namespace burin
