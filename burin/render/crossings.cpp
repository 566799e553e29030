#include "burin/render/crossings.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "burin/render/groove.h"

namespace burin {
namespace {

// A grid of square cells over the board, each listing the scratches whose strip touches it: finds those near a scratch.
class CellIndex {
 public:
  CellIndex(const Scratches& s, const std::vector<double>& half_width_mm, double cell_mm) : cell_mm_(cell_mm) {
    double x1 = -1e300, y1 = -1e300, reach = 0;
    x0_ = y0_ = 1e300;
    for (const double w : half_width_mm) reach = std::max(reach, w);
    for (std::size_t i = 0; i < s.size(); ++i) {
      x0_ = std::min({x0_, s.x0_mm[i], s.x1_mm[i]});
      y0_ = std::min({y0_, s.y0_mm[i], s.y1_mm[i]});
      x1 = std::max({x1, s.x0_mm[i], s.x1_mm[i]});
      y1 = std::max({y1, s.y0_mm[i], s.y1_mm[i]});
    }
    constexpr double kMostCells = 16e6;  // coarser ones find the same, and more that is then passed over
    cell_mm_ = std::max(cell_mm_, std::sqrt(std::max(0.0, x1 - x0_) * std::max(0.0, y1 - y0_) / kMostCells));
    columns_ = static_cast<int>((x1 - x0_) / cell_mm_) + 1;
    rows_ = static_cast<int>((y1 - y0_) / cell_mm_) + 1;
    cells_.resize(static_cast<std::size_t>(columns_) * rows_);
    for (std::size_t i = 0; i < s.size(); ++i)
      for_cells(s, i, half_width_mm[i] + reach, [&](std::vector<std::size_t>& cell) { cell.push_back(i); });
  }

  template <typename F>
  void for_cells(const Scratches& s, std::size_t i, double margin_mm, F&& f) {
    // Steps along the scratch that are shorter than a cell, with a margin: every cell that the strip touches is met.
    const double dx = s.x1_mm[i] - s.x0_mm[i], dy = s.y1_mm[i] - s.y0_mm[i];
    const int steps = static_cast<int>(std::ceil(std::hypot(dx, dy) / cell_mm_)) + 1;
    std::vector<std::size_t> seen;
    for (int k = 0; k <= steps; ++k) {
      const double x = s.x0_mm[i] + dx * k / steps, y = s.y0_mm[i] + dy * k / steps, m = margin_mm + 0.5 * cell_mm_;
      for (int row = index(y - m - y0_, rows_); row <= index(y + m - y0_, rows_); ++row)
        for (int column = index(x - m - x0_, columns_); column <= index(x + m - x0_, columns_); ++column)
          seen.push_back(static_cast<std::size_t>(row) * columns_ + column);
    }
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    for (const std::size_t c : seen) f(cells_[c]);
  }

 private:
  int index(double offset_mm, int count) const {
    return std::clamp(static_cast<int>(std::floor(offset_mm / cell_mm_)), 0, count - 1);
  }

  double cell_mm_, x0_ = 0, y0_ = 0;
  int columns_ = 0, rows_ = 0;
  std::vector<std::vector<std::size_t>> cells_;
};

using Boundary = PieceEnd::Boundary;

// The stretch of scratch i's center line, in mm from its first end, that lies on scratch j. Empty if from >= to.
struct Stretch {
  double from_mm, to_mm;
  Boundary from_boundary = Boundary::own_end, to_boundary = Boundary::own_end;
  std::size_t cutter;
};
Stretch covered_stretch(const Scratches& s, std::size_t i, std::size_t j, double half_width_j_mm) {
  const double ix = s.x1_mm[i] - s.x0_mm[i], iy = s.y1_mm[i] - s.y0_mm[i], length_i = std::hypot(ix, iy);
  const double jx = s.x1_mm[j] - s.x0_mm[j], jy = s.y1_mm[j] - s.y0_mm[j], length_j = std::hypot(jx, jy);
  const double ux = jx / length_j, uy = jy / length_j;
  const double ox = s.x0_mm[i] - s.x0_mm[j], oy = s.y0_mm[i] - s.y0_mm[j];
  // Along j and across it, as functions a + b t of the distance t along i.
  const double along_a = ox * ux + oy * uy, along_b = (ix * ux + iy * uy) / length_i;
  const double across_a = ox * uy - oy * ux, across_b = (ix * uy - iy * ux) / length_i;
  Stretch out{.from_mm = 0, .to_mm = length_i, .cutter = j};
  const auto clip = [&](double a, double b, double from, double to, Boundary at_from, Boundary at_to) {
    if (std::abs(b) < 1e-12) {
      if (a < from || a > to) out.to_mm = out.from_mm;
      return;
    }
    double enters = (from - a) / b, leaves = (to - a) / b;
    if (enters > leaves) {
      std::swap(enters, leaves);
      std::swap(at_from, at_to);
    }
    if (enters > out.from_mm) out.from_mm = enters, out.from_boundary = at_from;
    if (leaves < out.to_mm) out.to_mm = leaves, out.to_boundary = at_to;
  };
  clip(along_a, along_b, 0, length_j, Boundary::first_end, Boundary::last_end);
  clip(across_a, across_b, -half_width_j_mm, half_width_j_mm, Boundary::side_minus, Boundary::side_plus);
  return out;
}

}  // namespace

VisiblePieces visible_pieces(const Scratches& carved, double tool_width_um, double depth_um,
                             const GrooveProfile& profile) {
  VisiblePieces out;
  if (carved.size() == 0) return out;
  std::vector<double> half_width_mm(carved.size());
  for (std::size_t i = 0; i < carved.size(); ++i)
    half_width_mm[i] = 1e-3 * half_width_um(profile, carved.width_um.empty() ? tool_width_um : carved.width_um[i],
                                            carved.depth_um.empty() ? depth_um : carved.depth_um[i]);
  constexpr double kCellMm = 2;
  CellIndex index(carved, half_width_mm, kCellMm);

  std::vector<std::size_t> near;
  std::vector<Stretch> gone;
  for (std::size_t i = 0; i < carved.size(); ++i) {
    near.clear();
    index.for_cells(carved, i, half_width_mm[i], [&](const std::vector<std::size_t>& cell) {
      near.insert(near.end(), std::upper_bound(cell.begin(), cell.end(), i), cell.end());
    });
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    gone.clear();
    for (const std::size_t j : near) {
      const Stretch stretch = covered_stretch(carved, i, j, half_width_mm[j]);
      if (stretch.from_mm < stretch.to_mm) gone.push_back(stretch);
    }
    std::sort(gone.begin(), gone.end(), [](const Stretch& a, const Stretch& b) {
      return std::pair(a.from_mm, a.to_mm) < std::pair(b.from_mm, b.to_mm);
    });

    const double dx = carved.x1_mm[i] - carved.x0_mm[i], dy = carved.y1_mm[i] - carved.y0_mm[i];
    const double length = std::hypot(dx, dy);
    // From where on nothing later covers it, and what ended the last cover.
    double from = 0;
    PieceEnd begin;
    const auto keep_until = [&](double to, Boundary boundary, std::size_t cutter) {
      constexpr double kShortestMm = 1e-4;
      if (to - from < kShortestMm) return;
      out.pieces.x0_mm.push_back(carved.x0_mm[i] + dx * from / length);
      out.pieces.y0_mm.push_back(carved.y0_mm[i] + dy * from / length);
      out.pieces.x1_mm.push_back(carved.x0_mm[i] + dx * to / length);
      out.pieces.y1_mm.push_back(carved.y0_mm[i] + dy * to / length);
      if (!carved.width_um.empty()) out.pieces.width_um.push_back(carved.width_um[i]);
      if (!carved.depth_um.empty()) out.pieces.depth_um.push_back(carved.depth_um[i]);
      if (!carved.alpha.empty()) out.pieces.alpha.push_back(carved.alpha[i]);
      out.source.push_back(static_cast<std::uint32_t>(i));
      out.begin.push_back(begin);
      out.end.push_back({to / length, boundary, static_cast<std::uint32_t>(cutter)});
    };
    for (const Stretch& stretch : gone) {
      keep_until(stretch.from_mm, stretch.from_boundary, stretch.cutter);
      if (stretch.to_mm <= from) continue;
      from = stretch.to_mm;
      begin = {from / length, stretch.to_boundary, static_cast<std::uint32_t>(stretch.cutter)};
    }
    keep_until(length, Boundary::own_end, 0);
  }
  return out;
}

}  // namespace burin
