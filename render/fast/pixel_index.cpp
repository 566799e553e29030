#include "burin/render/fast/pixel_index.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace burin {
namespace {

/// Limit of a block's map error; larger blocks are split. Each pixel is widened by it, so it is also the fraction of
/// useless pairs.
constexpr double kBlockError_px = 0.02;
/// Limit of the error of a map of the whole grid.
constexpr double kGridError_px = 4 * kTile;
/// Rounding of double computations, relative to the coordinates in them.
constexpr double kRounding = 1e-11;

/// True if a strip and a box share a point, by separating axes of both. May be true within rounding.
bool touches_box(const Strip& strip, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  const Eigen::Vector2d d = strip.p1_mm - strip.p0_mm;
  const double length = d.norm();
  if (!(length > 0)) return false;
  const Eigen::Vector2d y = d / length, x(y.y(), -y.x());
  const Eigen::Vector2d middle = 0.5 * (strip.p0_mm + strip.p1_mm);
  const Eigen::Vector2d box_middle = 0.5 * (low + high), box_half = 0.5 * (high - low);
  const Eigen::Vector2d between = box_middle - middle;
  const double slack = kRounding * (middle.cwiseAbs().sum() + box_middle.cwiseAbs().sum() + length);
  const double half_length = 0.5 * length + slack, half_width = strip.half_width_mm + slack;
  return std::abs(between.x()) <= box_half.x() + half_length * std::abs(y.x()) + half_width * std::abs(x.x()) &&
         std::abs(between.y()) <= box_half.y() + half_length * std::abs(y.y()) + half_width * std::abs(x.y()) &&
         std::abs(between.dot(x)) <= half_width + box_half.dot(x.cwiseAbs()) &&
         std::abs(between.dot(y)) <= half_length + box_half.dot(y.cwiseAbs());
}

struct Correspondence {
  Eigen::Vector2d board_mm, lattice;
};

/// Corner (c, r), if a pixel with a footprint uses it (of the block x0 .. x1 - 1, y0 .. y1 - 1).
struct UsedCorners {
  const FootprintGrid& grid;
  const std::vector<std::uint8_t>& valid;
  int x0, y0, x1, y1;

  bool used(int c, int r) const {
    for (int y = std::max(r - 1, y0); y <= std::min(r, y1 - 1); ++y)
      for (int x = std::max(c - 1, x0); x <= std::min(c, x1 - 1); ++x)
        if (valid[static_cast<std::size_t>(y) * grid.width() + x] != 0) return true;
    return false;
  }
  Eigen::Vector2d at(int c, int r) const {
    const std::size_t i = static_cast<std::size_t>(r) * (grid.width() + 1) + c;
    return {grid.corner_x_mm[i], grid.corner_y_mm[i]};
  }
  /// Up to n x n corners, spread over the block.
  std::vector<Correspondence> sample(int n) const {
    std::vector<Correspondence> found;
    int last_r = -1;
    for (int j = 0; j < n; ++j) {
      const int r = y0 + (y1 - y0) * j / (n - 1);
      if (r == last_r) continue;
      last_r = r;
      int last_c = -1;
      for (int i = 0; i < n; ++i) {
        const int c = x0 + (x1 - x0) * i / (n - 1);
        if (c != last_c && used(c, r)) found.push_back({at(c, r), Eigen::Vector2d(c, r)});
        last_c = c;
      }
    }
    return found;
  }
};

/// The least-squares affine map from `from` to `to`, or nothing if the points are collinear.
std::optional<Eigen::Matrix3d> fit_affine(const std::vector<Eigen::Vector2d>& from,
                                          const std::vector<Eigen::Vector2d>& to) {
  if (from.size() < 4) return std::nullopt;
  Eigen::Vector2d mean(0, 0), to_mean(0, 0);
  for (std::size_t i = 0; i < from.size(); ++i) {
    mean += from[i];
    to_mean += to[i];
  }
  mean /= static_cast<double>(from.size());
  to_mean /= static_cast<double>(from.size());
  Eigen::Matrix2d pp = Eigen::Matrix2d::Zero(), lp = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    pp += (from[i] - mean) * (from[i] - mean).transpose();
    lp += (to[i] - to_mean) * (from[i] - mean).transpose();
  }
  if (!(pp.determinant() > 1e-12 * pp.trace() * pp.trace())) return std::nullopt;
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  A.topLeftCorner<2, 2>() = lp * pp.inverse();
  A.topRightCorner<2, 1>() = to_mean - A.topLeftCorner<2, 2>() * mean;
  return A;
}

/// The homography from board to lattice by the direct linear transform (Hartley and Zisserman, section 4.1), on
/// normalized coordinates.
std::optional<Eigen::Matrix3d> fit_homography(const std::vector<Correspondence>& points) {
  if (points.size() < 9) return std::nullopt;
  const auto normalizer = [&](const auto& of) {
    Eigen::Vector2d mean(0, 0);
    for (const Correspondence& p : points) mean += of(p);
    mean /= static_cast<double>(points.size());
    double size = 0;
    for (const Correspondence& p : points) size += (of(p) - mean).norm();
    const double scale = static_cast<double>(points.size()) / std::max(size, 1e-300);
    Eigen::Matrix3d N = Eigen::Matrix3d::Identity() * scale;
    N.topRightCorner<2, 1>() = -scale * mean;
    N(2, 2) = 1;
    return N;
  };
  const Eigen::Matrix3d B = normalizer([](const Correspondence& p) { return p.board_mm; });
  const Eigen::Matrix3d L = normalizer([](const Correspondence& p) { return p.lattice; });
  Eigen::Matrix<double, 9, 9> AtA = Eigen::Matrix<double, 9, 9>::Zero();
  for (const Correspondence& p : points) {
    const Eigen::Vector3d b = B * p.board_mm.homogeneous(), l = L * p.lattice.homogeneous();
    Eigen::Matrix<double, 9, 1> row;
    row << b, Eigen::Vector3d::Zero(), -l.x() * b;
    AtA += row * row.transpose();
    row << Eigen::Vector3d::Zero(), b, -l.y() * b;
    AtA += row * row.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(AtA);
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
  Eigen::Matrix3d H;
  H << h.segment<3>(0).transpose(), h.segment<3>(3).transpose(), h.segment<3>(6).transpose();
  H = L.inverse() * H * B;
  if (!H.allFinite() || !(std::abs(H.determinant()) > 0)) return std::nullopt;
  if ((H * points[0].board_mm.homogeneous()).z() < 0) H = -H;
  return H;
}

}  // namespace

PixelIndex::PixelIndex(const FootprintGrid& grid) : width_(grid.width()), height_(grid.height()) {
  valid_.resize(static_cast<std::size_t>(width_) * height_);
  for (int r = 0; r < height_; ++r) {
    for (int c = 0; c < width_; ++c) {
      const double area = std::abs(signed_area_mm2(footprint_corners_mm(grid, c, r)));
      valid_[static_cast<std::size_t>(r) * width_ + c] = std::isfinite(area) && area > 0 ? 1 : 0;
    }
  }
  map_whole_grid(grid);

  tiles_x_ = (width_ + kTile - 1) / kTile;
  tiles_y_ = (height_ + kTile - 1) / kTile;
  tiles_.resize(static_cast<std::size_t>(tiles_x_) * tiles_y_);
  valid_rows_.resize(tiles_.size(), {});
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    GridTile& tile = tiles_[t];
    const int left = static_cast<int>(t % tiles_x_) * kTile, top = static_cast<int>(t / tiles_x_) * kTile;
    const int right = std::min(left + kTile, width_), bottom = std::min(top + kTile, height_);
    Eigen::Vector2d low(1e300, 1e300), high = -low;
    tile.all_valid = true;
    for (int r = top; r < bottom; ++r) {
      for (int c = left; c < right; ++c) {
        if (valid_[static_cast<std::size_t>(r) * width_ + c] == 0) {
          tile.all_valid = false;
          continue;
        }
        valid_rows_[t][r - top] |= 1U << (c - left);
        for (const Eigen::Vector2d& q : footprint_corners_mm(grid, c, r)) {
          low = low.cwiseMin(q);
          high = high.cwiseMax(q);
        }
      }
    }
    tile.block_begin = tile.block_end = static_cast<std::uint32_t>(blocks_.size());
    if (!(low.x() <= high.x())) continue;
    tile.origin_mm = 0.5 * (low + high);
    add_blocks(grid, left, top, right, bottom, tile.origin_mm, left, top);
    tile.block_end = static_cast<std::uint32_t>(blocks_.size());
  }
}

/// The grid's own homography, or the best fit to its corners.
void PixelIndex::map_whole_grid(const FootprintGrid& grid) {
  const UsedCorners corners{grid, valid_, 0, 0, width_, height_};
  if (grid.board_from_pixel.has_value()) {
    Eigen::Matrix3d lattice_from_pixel = Eigen::Matrix3d::Identity();
    lattice_from_pixel(0, 2) = lattice_from_pixel(1, 2) = 0.5;
    map_.lattice_from_board = lattice_from_pixel * grid.board_from_pixel->inverse();
    const std::vector<Correspondence> some = corners.sample(3);
    if (!some.empty() && (map_.lattice_from_board * some[0].board_mm.homogeneous()).z() < 0)
      map_.lattice_from_board = -map_.lattice_from_board;
  } else {
    const auto fit = fit_homography(corners.sample(33));
    if (!fit.has_value()) return;
    map_.lattice_from_board = *fit;
  }
  map_.affine = map_.lattice_from_board.row(2).head<2>().isZero(0);
  map_.lattice_from_board /=
      map_.affine ? map_.lattice_from_board(2, 2) : map_.lattice_from_board.row(2).cwiseAbs().maxCoeff();
  map_.error_px = 0;
  map_.w_min = std::numeric_limits<double>::infinity();
  double largest = 1;
  for (int r = 0; r <= height_; ++r) {
    for (int c = 0; c <= width_; ++c) {
      if (!corners.used(c, r)) continue;
      const Eigen::Vector2d p = corners.at(c, r);
      const Eigen::Vector3d q = map_.lattice_from_board * p.homogeneous();
      if (!(q.z() > 0)) return;
      map_.w_min = std::min(map_.w_min, q.z());
      map_.error_px = std::max(map_.error_px, (q.hnormalized() - Eigen::Vector2d(c, r)).cwiseAbs().maxCoeff());
      largest = std::max(largest, p.cwiseAbs().maxCoeff());
    }
  }
  map_.error_px +=
      kRounding *
      (map_.lattice_from_board.topRows<2>().cwiseAbs().maxCoeff() * (largest + 1) / map_.w_min + width_ + height_);
  map_.error_px = 1.01 * map_.error_px + 1e-3;  // footprints have straight edges, and float rounds
  map_.exists = std::isfinite(map_.w_min) && map_.error_px <= kGridError_px;
}

/// Adds blocks of a tile for pixels x0 .. x1 - 1, y0 .. y1 - 1: one if a map is accurate enough, else its quarters.
void PixelIndex::add_blocks(const FootprintGrid& grid, int x0, int y0, int x1, int y1, const Eigen::Vector2d& origin_mm,
                            int left, int top) {
  const UsedCorners corners{grid, valid_, x0, y0, x1, y1};
  TileBlock block{x0 - left, y0 - top, x1 - left, y1 - top, {}, {}, {}, 0, false};
  Eigen::Vector2d low(1e300, 1e300), high = -low;
  for (int r = y0; r <= y1; ++r) {
    for (int c = x0; c <= x1; ++c) {
      if (!corners.used(c, r)) continue;
      low = low.cwiseMin(corners.at(c, r) - origin_mm);
      high = high.cwiseMax(corners.at(c, r) - origin_mm);
    }
  }
  if (!(low.x() <= high.x())) return;
  // Round to float, outwards.
  for (int i = 0; i < 2; ++i) {
    block.low_mm[i] = std::nextafter(static_cast<float>(low[i]), -INFINITY);
    block.high_mm[i] = std::nextafter(static_cast<float>(high[i]), INFINITY);
  }

  // The grid's map, if it exists, with an affine correction.
  Eigen::Matrix3d to_tile = Eigen::Matrix3d::Identity();
  to_tile.topRightCorner<2, 1>() = origin_mm;
  const Eigen::Matrix3d rough =
      map_.exists ? Eigen::Matrix3d(map_.lattice_from_board * to_tile) : Eigen::Matrix3d::Identity();
  std::vector<Eigen::Vector2d> from, to;
  for (const Correspondence& p : corners.sample(5)) {
    from.emplace_back((rough * (p.board_mm - origin_mm).homogeneous()).hnormalized());
    to.emplace_back(p.lattice - Eigen::Vector2d(left, top));
  }
  const auto affine = fit_affine(from, to);
  bool good = affine.has_value();
  if (good) {
    Eigen::Matrix3d M = *affine * rough;
    M /= M(2, 2);
    good = M.allFinite();
    Eigen::Matrix3d rounded;
    for (int i = 0; i < 9; ++i) {
      block.lattice_from_mm[i] = static_cast<float>(M(i / 3, i % 3));
      rounded(i / 3, i % 3) = block.lattice_from_mm[i];
    }
    double error = 0;
    for (int r = y0; r <= y1 && good; ++r) {
      for (int c = x0; c <= x1 && good; ++c) {
        if (!corners.used(c, r)) continue;
        const Eigen::Vector3d q = rounded * (corners.at(c, r) - origin_mm).homogeneous();
        good = q.z() > 0.1;
        error = std::max(error, (q.hnormalized() - Eigen::Vector2d(c - left, r - top)).cwiseAbs().maxCoeff());
      }
    }
    const bool one_pixel = x1 - x0 == 1 && y1 - y0 == 1;
    good = good && std::isfinite(error) && (error <= kBlockError_px || (one_pixel && error < 1));
    block.error_px = static_cast<float>(error * 1.001);
  }
  if (good) {
    blocks_.push_back(block);
    return;
  }
  if (x1 - x0 == 1 && y1 - y0 == 1) {
    block.by_box = true;
    blocks_.push_back(block);
    return;
  }
  const int xm = x1 - x0 > 1 ? (x0 + x1 + 1) / 2 : x1, ym = y1 - y0 > 1 ? (y0 + y1 + 1) / 2 : y1;
  for (const auto& [ya, yb] : {std::pair{y0, ym}, std::pair{ym, y1}})
    for (const auto& [xa, xb] : {std::pair{x0, xm}, std::pair{xm, x1}})
      if (xa < xb && ya < yb) add_blocks(grid, xa, ya, xb, yb, origin_mm, left, top);
}

void PixelIndex::find_tiles(const Eigen::Vector2d& p0_mm, const Eigen::Vector2d& p1_mm,
                            const Eigen::Vector2d& across_mm, std::vector<std::uint32_t>& tiles) const {
  if (p0_mm == p1_mm) return;
  const Eigen::Matrix3d& H = map_.lattice_from_board;
  const Eigen::Vector3d q0 = H.leftCols<2>() * p0_mm + H.col(2), q1 = H.leftCols<2>() * p1_mm + H.col(2);
  const Eigen::Vector3d side = H.leftCols<2>() * across_mm;
  if (!map_.exists || std::min(q0.z(), q1.z()) - std::abs(side.z()) < 0.5 * map_.w_min) {
    const Strip strip{p0_mm, p1_mm, across_mm.norm()};
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
      for (const TileBlock& b : blocks(tiles_[t])) {
        const Eigen::Vector2d low(b.low_mm[0], b.low_mm[1]), high(b.high_mm[0], b.high_mm[1]);
        if (!touches_box(strip, low + tiles_[t].origin_mm, high + tiles_[t].origin_mm)) continue;
        tiles.push_back(static_cast<std::uint32_t>(t));
        break;
      }
    }
    return;
  }
  // The strip is between the ends of its middle line, widened by the distance of its corners from them.
  Eigen::Vector2d m0 = q0.head<2>(), m1 = q1.head<2>(), pad = side.head<2>().cwiseAbs();
  if (!map_.affine) {
    m0 = q0.hnormalized();
    m1 = q1.hnormalized();
    for (const auto& [q, m] : {std::pair{q0, m0}, std::pair{q1, m1}})
      for (const double sign : {-1.0, 1.0}) pad = pad.cwiseMax(((q + sign * side).hnormalized() - m).cwiseAbs());
  }
  pad.array() += map_.error_px;
  const double x0 = m0.x(), y0 = m0.y(), x1 = m1.x(), y1 = m1.y();
  const double y_low = std::min(y0, y1) - pad.y(), y_high = std::max(y0, y1) + pad.y();
  const double x_low = std::min(x0, x1) - pad.x(), x_high = std::max(x0, x1) + pad.x();
  if (!(x_high >= 0 && y_high >= 0 && x_low <= width_ && y_low <= height_)) return;
  // Clamped first, so that a cast rounds down.
  const auto tile_of = [](double v, int tile_count) {
    return static_cast<int>(std::clamp(v * (1.0 / kTile), 0.0, tile_count - 0.5));
  };
  const int row0 = tile_of(y_low, tiles_y_), row1 = tile_of(y_high, tiles_y_);
  const double slope = std::abs(y1 - y0) > 1e-9 ? (x1 - x0) / (y1 - y0) : 0;
  for (int row = row0; row <= row1; ++row) {
    double from = x_low, to = x_high;
    if (row0 != row1) {
      // The part of the middle line within this row of tiles, widened.
      const double top = std::clamp(row * kTile - pad.y(), std::min(y0, y1), std::max(y0, y1));
      const double bottom = std::clamp((row + 1) * kTile + pad.y(), std::min(y0, y1), std::max(y0, y1));
      if (slope != 0) {
        const double a = x0 + slope * (top - y0), b = x0 + slope * (bottom - y0);
        from = std::max(from, std::min(a, b) - pad.x());
        to = std::min(to, std::max(a, b) + pad.x());
      }
    }
    if (!(to >= 0 && from <= width_)) continue;
    const int column0 = tile_of(from, tiles_x_), column1 = tile_of(to, tiles_x_);
    for (int column = column0; column <= column1; ++column) {
      const auto t = static_cast<std::uint32_t>(row * tiles_x_ + column);
      if (tiles_[t].block_begin != tiles_[t].block_end) tiles.push_back(t);
    }
  }
}

}  // namespace burin
