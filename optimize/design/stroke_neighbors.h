// burin/optimize/design/stroke_neighbors.h - strokes of a tile with an end near a point. Frame: pixels.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "burin/optimize/design/stroke_tiles.h"

namespace burin {

/// Ends of strokes by cells of a grid. A moved end stays in its first cell, but distances use its new position.
class StrokeNeighbors {
 public:
  static constexpr float kNear = 5;                 ///< pixels
  static constexpr std::uint32_t kMostInCell = 64;  ///< ends examined per cell, in any crowd

  /// `ends` has two entries per stroke: stroke i has 2 i and 2 i + 1.
  StrokeNeighbors(const PixelBox& box, std::vector<Eigen::Vector2f> ends) : ends_(std::move(ends)) {
    corner_ = {static_cast<float>(box.x0), static_cast<float>(box.y0)};
    columns_ = static_cast<int>(static_cast<float>(box.x1 - box.x0) / kNear) + 1;
    rows_ = static_cast<int>(static_cast<float>(box.y1 - box.y0) / kNear) + 1;
    begin_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
    for (const Eigen::Vector2f& e : ends_) ++begin_[cell_of(e) + 1];
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    in_cell_.resize(ends_.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t e = 0; e < ends_.size(); ++e) in_cell_[next[cell_of(ends_[e])]++] = static_cast<std::uint32_t>(e);
  }

  const Eigen::Vector2f& end(std::size_t e) const { return ends_[e]; }
  void move(std::size_t stroke, const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
    ends_[2 * stroke] = a;
    ends_[2 * stroke + 1] = b;
  }

  /// The other stroke with an end closest to this end; the stroke itself if none is near.
  std::size_t nearest(std::size_t end) const {
    const Eigen::Vector2f at = ends_[end];
    std::size_t nearest = end / 2;
    float least = kNear * kNear;
    const int x = column(at), y = row(at);
    for (int j = std::max(0, y - 1); j <= std::min(rows_ - 1, y + 1); ++j)
      for (int i = std::max(0, x - 1); i <= std::min(columns_ - 1, x + 1); ++i) {
        const std::size_t c = static_cast<std::size_t>(j) * columns_ + i;
        const std::uint32_t end_of_cell = std::min(begin_[c + 1], begin_[c] + kMostInCell);
        for (std::uint32_t k = begin_[c]; k < end_of_cell; ++k) {
          const std::size_t other = in_cell_[k];
          const float d = (ends_[other] - at).squaredNorm();
          if (other / 2 == end / 2 || !(d < least)) continue;
          least = d;
          nearest = other / 2;
        }
      }
    return nearest;
  }

 private:
  int column(const Eigen::Vector2f& p) const {
    return std::clamp(static_cast<int>((p.x() - corner_.x()) / kNear), 0, columns_ - 1);
  }
  int row(const Eigen::Vector2f& p) const {
    return std::clamp(static_cast<int>((p.y() - corner_.y()) / kNear), 0, rows_ - 1);
  }
  std::size_t cell_of(const Eigen::Vector2f& p) const {
    return static_cast<std::size_t>(row(p)) * columns_ + static_cast<std::size_t>(column(p));
  }

  std::vector<Eigen::Vector2f> ends_;
  Eigen::Vector2f corner_;
  int columns_, rows_;
  std::vector<std::uint32_t> begin_, in_cell_;
};

}  // namespace burin
