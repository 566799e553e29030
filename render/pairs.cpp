#include "render/pairs.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "render/error.h"
#include "render/groove.h"

namespace burin {
namespace {

/// Blocks are split until their affine map is right within this. Each pixel is widened by it, so it is also the share
/// of pairs found in vain.
constexpr double kBlockError_px = 0.03;
/// Larger blocks are not worth measuring at all of their corners before they are split.
constexpr int kLargestAffineBlock = 4096;
/// Rounding of the drawing itself, relative to the coordinates that appear in it.
constexpr double kRounding = 1e-11;

using Polygon = std::array<Eigen::Vector3d, 6>;

/// Four rows side by side (the vector extension of GCC and Clang, at the width that every machine has).
constexpr int kRows = 4;
using Rows = float __attribute__((vector_size(kRows * sizeof(float))));
constexpr Rows kRowNumbers = {0, 1, 2, 3};
constexpr Rows kZeroRows = {};  // plus a number: that number in every row

/// max(least, ceil(v)) and min(most, floor(v)) for least, most >= 0; where floor(v) is negative, -1. Without a rounding
/// instruction the library's functions would cost more than all the rest of a row.
int ceil_from(int least, double v) {
  if (!(v > least)) return least;
  const int i = static_cast<int>(std::min(v, 2e9));
  return i < v ? i + 1 : i;
}
int floor_to(int most, double v) {
  if (v >= most) return most;
  return v >= 0 ? static_cast<int>(v) : -1;
}

/// The part of a convex polygon (homogeneous) where w >= w_min.
int clip_w(const Polygon& in, int n, double w_min, Polygon& out) {
  int m = 0;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d &a = in[i], &b = in[(i + 1) % n];
    const bool a_in = a.z() >= w_min, b_in = b.z() >= w_min;
    if (a_in) out[m++] = a;
    if (a_in != b_in) {
      const double s = (w_min - a.z()) / (b.z() - a.z());
      out[m++] = a + s * (b - a);
    }
  }
  return m;
}

/// Do a strip and a box share a point? Separating axes of both. May say yes when they are within rounding.
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

}  // namespace

PixelIndex::PixelIndex(const FootprintGrid& grid) : width_(grid.width()), height_(grid.height()) {
  valid_.resize(static_cast<std::size_t>(width_) * height_);
  for (int r = 0; r < height_; ++r) {
    for (int c = 0; c < width_; ++c) {
      const double area = std::abs(signed_area_mm2(footprint_corners_mm(grid, c, r)));
      valid_[static_cast<std::size_t>(r) * width_ + c] = std::isfinite(area) && area > 0 ? 1 : 0;
    }
  }
  Block root;
  root.x1 = width_;
  root.y1 = height_;
  blocks_.push_back(root);
  build(grid, 0);
}

/// Box, map and error of a block; false if it must be split.
bool PixelIndex::measure(const FootprintGrid& grid, Block& b) const {
  const int stride = grid.width() + 1;
  const bool one_pixel = b.x1 - b.x0 == 1 && b.y1 - b.y0 == 1;
  // A corner counts if a pixel of this block that has a footprint uses it.
  const auto used = [&](int c, int r) {
    for (int y = std::max(r - 1, b.y0); y <= std::min(r, b.y1 - 1); ++y)
      for (int x = std::max(c - 1, b.x0); x <= std::min(c, b.x1 - 1); ++x)
        if (valid_[static_cast<std::size_t>(y) * width_ + x]) return true;
    return false;
  };
  const auto corner = [&](int c, int r) {
    const std::size_t i = static_cast<std::size_t>(r) * stride + c;
    return Eigen::Vector2d(grid.corner_x_mm[i], grid.corner_y_mm[i]);
  };

  b.projective = b.child == -1 && b.x1 - b.x0 == width_ && b.y1 - b.y0 == height_ && grid.board_from_pixel.has_value();
  if (b.projective) {
    Eigen::Matrix3d lattice_from_pixel = Eigen::Matrix3d::Identity();
    lattice_from_pixel(0, 2) = lattice_from_pixel(1, 2) = 0.5;
    b.pixel_from_board = lattice_from_pixel * grid.board_from_pixel->inverse();
    b.pixel_from_board /= b.pixel_from_board.row(2).cwiseAbs().maxCoeff();
  } else {
    // Least squares of the lattice on the board's coordinates, from up to 5 x 5 corners, seen from their middle.
    std::array<std::array<double, 4>, 25> samples{};
    int n = 0;
    Eigen::Vector2d mean(0, 0), lattice_mean(0, 0);
    for (int j = 0; j < 5; ++j) {
      for (int i = 0; i < 5; ++i) {
        if (one_pixel && (i % 4 != 0 || j % 4 != 0)) continue;
        const int c = b.x0 + (b.x1 - b.x0) * i / 4, r = b.y0 + (b.y1 - b.y0) * j / 4;
        if (!used(c, r)) continue;
        const Eigen::Vector2d p = corner(c, r);
        samples[n++] = {p.x(), p.y(), static_cast<double>(c), static_cast<double>(r)};
        mean += p;
        lattice_mean += Eigen::Vector2d(c, r);
      }
    }
    if (n < 4) return false;
    mean /= n;
    lattice_mean /= n;
    Eigen::Matrix2d pp = Eigen::Matrix2d::Zero(), lp = Eigen::Matrix2d::Zero();
    for (int k = 0; k < n; ++k) {
      const Eigen::Vector2d p(samples[k][0] - mean.x(), samples[k][1] - mean.y());
      const Eigen::Vector2d l(samples[k][2] - lattice_mean.x(), samples[k][3] - lattice_mean.y());
      pp += p * p.transpose();
      lp += l * p.transpose();
    }
    if (!(pp.determinant() > 1e-12 * pp.trace() * pp.trace())) return false;
    const Eigen::Matrix2d A = lp * pp.inverse();
    b.pixel_from_board.setZero();
    b.pixel_from_board.topLeftCorner<2, 2>() = A;
    b.pixel_from_board.topRightCorner<2, 1>() = lattice_mean - A * mean;
    b.pixel_from_board(2, 2) = 1;
    double worst = 0;
    for (int k = 0; k < n; ++k) {
      const Eigen::Vector2d l =
          b.pixel_from_board.topLeftCorner<2, 2>() * Eigen::Vector2d(samples[k][0], samples[k][1]) +
          b.pixel_from_board.topRightCorner<2, 1>();
      worst = std::max({worst, std::abs(l.x() - samples[k][2]), std::abs(l.y() - samples[k][3])});
    }
    if (!one_pixel && !(worst <= kBlockError_px)) return false;
  }

  // Now at every corner: what was only sampled above must hold for all.
  b.error_px = 0;
  b.w_min = std::numeric_limits<double>::infinity();
  double largest = 0;
  for (int r = b.y0; r <= b.y1; ++r) {
    for (int c = b.x0; c <= b.x1; ++c) {
      if (!b.all_valid && !used(c, r)) continue;
      const Eigen::Vector3d q = b.pixel_from_board * corner(c, r).homogeneous();
      if (!(q.z() > 0)) return false;
      b.w_min = std::min(b.w_min, q.z());
      b.error_px = std::max({b.error_px, std::abs(q.x() / q.z() - c), std::abs(q.y() / q.z() - r)});
      largest = std::max({largest, std::abs(corner(c, r).x()), std::abs(corner(c, r).y())});
    }
  }
  if (!std::isfinite(b.error_px)) return false;
  if (!one_pixel && !(b.error_px <= kBlockError_px)) return false;
  const double scale = b.pixel_from_board.topRows<2>().cwiseAbs().maxCoeff() * (largest + 1) / b.w_min;
  b.error_px += kRounding * (scale + width_ + height_);
  return true;
}

void PixelIndex::build(const FootprintGrid& grid, int index) {
  Block b = blocks_[index];
  b.low.setConstant(std::numeric_limits<double>::infinity());
  b.high = -b.low;
  b.all_valid = true;
  bool any = false;
  for (int r = b.y0; r < b.y1; ++r) {
    for (int c = b.x0; c < b.x1; ++c) {
      if (!valid_[static_cast<std::size_t>(r) * width_ + c]) {
        b.all_valid = false;
        continue;
      }
      any = true;
      for (const Eigen::Vector2d& q : footprint_corners_mm(grid, c, r)) {
        b.low = b.low.cwiseMin(q);
        b.high = b.high.cwiseMax(q);
      }
    }
  }
  const int w = b.x1 - b.x0, h = b.y1 - b.y0;
  const bool leaf = any && std::max(w, h) <= kLargestAffineBlock && measure(grid, b);
  if (!any || leaf) {
    blocks_[index] = b;
    return;
  }
  if (w == 1 && h == 1) {
    b.by_box = true;
    blocks_[index] = b;
    return;
  }
  b.child = static_cast<int>(blocks_.size());
  const int xm = w > 1 ? b.x0 + (w + 1) / 2 : b.x1, ym = h > 1 ? b.y0 + (h + 1) / 2 : b.y1;
  for (const auto& [y0, y1] : {std::pair{b.y0, ym}, std::pair{ym, b.y1}}) {
    for (const auto& [x0, x1] : {std::pair{b.x0, xm}, std::pair{xm, b.x1}}) {
      if (x0 == x1 || y0 == y1) continue;
      Block child;
      child.x0 = x0;
      child.x1 = x1;
      child.y0 = y0;
      child.y1 = y1;
      blocks_.push_back(child);
      ++b.child_count;
    }
  }
  blocks_[index] = b;
  for (int k = 0; k < b.child_count; ++k) build(grid, b.child + k);
}

void PixelIndex::emit(const Block& b, int row, int begin, int end, std::vector<PixelSpan>& spans) const {
  if (b.all_valid) {
    spans.push_back({row, begin, end});
    return;
  }
  const std::uint8_t* valid = &valid_[static_cast<std::size_t>(row) * width_];
  while (begin < end) {
    while (begin < end && !valid[begin]) ++begin;
    int stop = begin;
    while (stop < end && valid[stop]) ++stop;
    if (stop > begin) spans.push_back({row, begin, stop});
    begin = stop;
  }
}

void PixelIndex::draw(const Block& b, const Strip& strip, std::vector<PixelSpan>& spans) const {
  if (b.by_box) {
    spans.push_back({b.y0, b.x0, b.x0 + 1});
    return;
  }
  const Eigen::Vector2d d = strip.p1_mm - strip.p0_mm;
  const Eigen::Vector2d across = Eigen::Vector2d(d.y(), -d.x()) * (strip.half_width_mm / d.norm());
  const Eigen::Matrix3d& H = b.pixel_from_board;
  Polygon q;
  q[0] = H * (strip.p0_mm - across).homogeneous();
  q[1] = H * (strip.p0_mm + across).homogeneous();
  q[2] = H * (strip.p1_mm + across).homogeneous();
  q[3] = H * (strip.p1_mm - across).homogeneous();
  int n = 4;
  if (b.projective) {
    // Behind the horizon of the map there is no footprint: cut that part of the strip off before dividing.
    Polygon clipped;
    n = clip_w(q, n, b.w_min * (1 - 1e-9), clipped);
    q = clipped;
    for (int i = 0; i < n; ++i) q[i] /= q[i].z();
  }
  if (n < 2) return;

  double y_low = q[0].y(), y_high = q[0].y(), x_low = q[0].x(), x_high = q[0].x();
  for (int i = 1; i < n; ++i) {
    y_low = std::min(y_low, q[i].y());
    y_high = std::max(y_high, q[i].y());
    x_low = std::min(x_low, q[i].x());
    x_high = std::max(x_high, q[i].x());
  }
  if (!(x_high >= b.x0 - b.error_px && x_low <= b.x1 + b.error_px && y_high >= b.y0 - b.error_px &&
        y_low <= b.y1 + b.error_px))
    return;

  // Rows are drawn four at a time, in float from a place near the strip. What float rounds is made up for by widening:
  // of the columns by 4e-7 of the coordinates' size, of the rows by ten times that, which also swallows whole every
  // edge too flat for its slope to be trusted.
  const double x_from = std::floor(std::max<double>(x_low, b.x0)), y_from = std::floor(std::max<double>(y_low, b.y0));
  const double size = std::max({x_high - x_from, x_from - x_low, y_high - y_from, y_from - y_low}) + 1;
  const double e = b.error_px + 4e-7 * size, e_row = b.error_px + 4e-6 * size;
  struct Edge {
    float x0, y0, x1, y1, slope;
  };
  std::array<Edge, 6> edges;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d *p0 = &q[i], *p1 = &q[i + 1 < n ? i + 1 : 0];
    if (p0->y() > p1->y()) std::swap(p0, p1);
    const double dy = p1->y() - p0->y();
    edges[i] = {static_cast<float>(p0->x() - x_from), static_cast<float>(p0->y() - y_from),
                static_cast<float>(p1->x() - x_from), static_cast<float>(p1->y() - y_from),
                dy > 3e-6 * size ? static_cast<float>((p1->x() - p0->x()) / dy) : 0.0F};
  }
  const int row0 = ceil_from(b.y0, y_low - 1 - e_row), row1 = floor_to(b.y1 - 1, y_high + e_row);
  constexpr float kFar = std::numeric_limits<float>::infinity();
  for (int first = row0; first <= row1; first += kRows) {
    // Within the slab of a row the polygon is convex, so the columns it touches are those between its extremes there:
    // the ends of what the slab leaves of each edge.
    const Rows far = kZeroRows + kFar;
    Rows low = far, high = -far;
    const Rows top = static_cast<float>(first - y_from - e_row) + kRowNumbers;
    const Rows bottom = top + static_cast<float>(1 + 2 * e_row);
    for (int i = 0; i < n; ++i) {
      const Edge& edge = edges[i];
      const Rows x0 = kZeroRows + edge.x0, y0 = kZeroRows + edge.y0, x1 = kZeroRows + edge.x1, y1 = kZeroRows + edge.y1;
      const Rows x_top = top <= y0 ? x0 : x0 + edge.slope * (top - y0);
      const Rows x_bottom = bottom >= y1 ? x1 : x0 + edge.slope * (bottom - y0);
      const auto there = (top <= y1) & (bottom >= y0);
      const Rows x_low = x_top < x_bottom ? x_top : x_bottom, x_high = x_top < x_bottom ? x_bottom : x_top;
      const Rows at_low = there ? x_low : far, at_high = there ? x_high : -far;
      low = low < at_low ? low : at_low;
      high = high > at_high ? high : at_high;
    }
    const int rows = std::min(kRows, row1 - first + 1);
    for (int k = 0; k < rows; ++k) {
      if (!(low[k] <= high[k])) continue;
      const int begin = ceil_from(b.x0, x_from + low[k] - 1 - e), end = floor_to(b.x1 - 1, x_from + high[k] + e) + 1;
      if (begin < end) emit(b, first + k, begin, end, spans);
    }
  }
}

void PixelIndex::find(const Strip& strip, std::vector<PixelSpan>& spans) const {
  if (strip.p0_mm == strip.p1_mm) return;
  std::array<int, 256> stack;
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Block& b = blocks_[stack[--depth]];
    if (!(b.low.x() <= b.high.x()) || !touches_box(strip, b.low, b.high)) continue;
    if (b.child < 0) {
      draw(b, strip, spans);
      continue;
    }
    for (int k = b.child_count - 1; k >= 0; --k) stack[depth++] = b.child + k;
  }
}

PixelPairs find_pairs(const PixelIndex& index, int width, int height, const std::vector<Strip>& strips) {
  // Spans in chunks of scratches side by side, then one pass in scratch order: the result depends on no thread.
  constexpr std::size_t kChunk = 512;
  const std::size_t chunks = (strips.size() + kChunk - 1) / kChunk;
  struct Found {
    std::vector<PixelSpan> spans;
    std::vector<std::size_t> end;  // of each scratch's spans
  };
  std::vector<Found> found(chunks);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t k) {
    for (std::size_t s = k * kChunk; s < std::min(strips.size(), (k + 1) * kChunk); ++s) {
      index.find(strips[s], found[k].spans);
      found[k].end.push_back(found[k].spans.size());
    }
  });

  PixelPairs pairs;
  pairs.begin.assign(static_cast<std::size_t>(width) * height + 1, 0);
  for (const Found& f : found)
    for (const PixelSpan& span : f.spans)
      for (int c = span.begin; c < span.end; ++c) ++pairs.begin[static_cast<std::size_t>(span.row) * width + c + 1];
  for (std::size_t i = 1; i < pairs.begin.size(); ++i) pairs.begin[i] += pairs.begin[i - 1];
  pairs.scratch.resize(pairs.begin.back());
  std::vector<std::size_t> next(pairs.begin.begin(), pairs.begin.end() - 1);
  for (std::size_t k = 0; k < chunks; ++k) {
    std::size_t at = 0;
    for (std::size_t s = 0; s < found[k].end.size(); ++s) {
      for (; at < found[k].end[s]; ++at) {
        const PixelSpan& span = found[k].spans[at];
        for (int c = span.begin; c < span.end; ++c)
          pairs.scratch[next[static_cast<std::size_t>(span.row) * width + c]++] =
              static_cast<std::uint32_t>(k * kChunk + s);
      }
    }
  }
  return pairs;
}

void check_scratches(const Scratches& scratches) {
  const std::size_t n = scratches.size();
  const auto check = [n](const std::vector<double>& values, const char* name, bool positive) {
    if (values.size() != n)
      fail("scratches",
           std::string(name) + " has " + std::to_string(values.size()) + " entries for " + std::to_string(n) +
               " scratches",
           "give one a scratch");
    for (std::size_t i = 0; i < n; ++i) {
      if (std::isfinite(values[i]) && (!positive || values[i] > 0)) continue;
      fail("scratches", std::string(name) + " of scratch " + std::to_string(i) + " is " + std::to_string(values[i]),
           positive ? "it must be a number above 0" : "it must be a number");
    }
  };
  check(scratches.x0_mm, "x0_mm", false);
  check(scratches.y0_mm, "y0_mm", false);
  check(scratches.x1_mm, "x1_mm", false);
  check(scratches.y1_mm, "y1_mm", false);
  if (!scratches.width_um.empty()) check(scratches.width_um, "width_um", true);
  if (!scratches.depth_um.empty()) check(scratches.depth_um, "depth_um", true);
  if (!scratches.alpha.empty()) check(scratches.alpha, "alpha", true);
}

std::vector<Strip> strips_of(const Scratches& scratches, double shared_width_um, double shared_depth_um) {
  std::vector<Strip> strips(scratches.size());
  for (std::size_t s = 0; s < strips.size(); ++s) {
    const double width_um = scratches.width_um.empty() ? shared_width_um : scratches.width_um[s];
    const double depth_um = scratches.depth_um.empty() ? shared_depth_um : scratches.depth_um[s];
    strips[s] = {{scratches.x0_mm[s], scratches.y0_mm[s]},
                 {scratches.x1_mm[s], scratches.y1_mm[s]},
                 1e-3 * half_width_um(width_um, depth_um)};
  }
  return strips;
}

}  // namespace burin
