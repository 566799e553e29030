#include "burin/render/crossings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
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

// How wide a groove is left where others cut it: this many steps from nothing to its whole width.
constexpr int kSteps = 3;

// A groove's cross-section.
struct Section {
  double width_um, depth_um, half_width_um;
};

// How far from the middle of one groove, um, another is hidden by it; and what that moves as the hidden one, or the
// one that hides it, becomes a um deeper.
struct Reach {
  double um = 0, by_depth = 0, by_cutter_depth = 0;
};

// Of groove i at a share of its half-width: up to where the walls of both are equally low (docs/model.md 7.10).
Reach reach_at(const GrooveProfile& profile, const Section& i, const Section& j, double share) {
  const double inner_um = depth_at_half_width_um(profile, i.width_um, share * i.half_width_um),
               below_um = inner_um + j.depth_um - i.depth_um;
  if (!(below_um > 0)) return {};
  const double slope = half_width_slope(profile, j.width_um, below_um),
               inner_by_depth = share * half_width_slope(profile, i.width_um, i.depth_um) /
                                half_width_slope(profile, i.width_um, inner_um);
  return {half_width_um(profile, j.width_um, below_um), slope * (inner_by_depth - 1), slope};
}

// Within that, groove i is left to `level` steps: the mean over the step beyond, by Gauss and Legendre's two points.
Reach reach_of_step(const GrooveProfile& profile, const Section& i, const Section& j, int level) {
  constexpr double kNode = 0.21132486540518708;
  const Reach a = reach_at(profile, i, j, (level + kNode) / kSteps),
              b = reach_at(profile, i, j, (level + 1 - kNode) / kSteps);
  return {(a.um + b.um) / 2, (a.by_depth + b.by_depth) / 2, (a.by_cutter_depth + b.by_cutter_depth) / 2};
}

// Where along a groove less of it begins or ends to be left.
struct Change {
  double at_mm;
  bool ends;
  int level;  // steps that are left between the two
  PieceEnd::Boundary boundary;
  std::size_t cutter;
  Reach reach;
};

}  // namespace

VisiblePieces visible_pieces(const Scratches& carved, double tool_width_um, double depth_um,
                             const GrooveProfile& profile, Crossings rule) {
  VisiblePieces out;
  if (carved.size() == 0) return out;
  const bool deepest = rule == Crossings::deepest;
  std::vector<Section> sections(carved.size());
  std::vector<double> half_width_mm(carved.size());
  for (std::size_t i = 0; i < carved.size(); ++i) {
    sections[i] = {carved.width_um.empty() ? tool_width_um : carved.width_um[i],
                   carved.depth_um.empty() ? depth_um : carved.depth_um[i], 0};
    sections[i].half_width_um = half_width_um(profile, sections[i].width_um, sections[i].depth_um);
    half_width_mm[i] = 1e-3 * sections[i].half_width_um;
  }
  constexpr double kCellMm = 2;
  CellIndex index(carved, half_width_mm, kCellMm);

  std::vector<std::size_t> near;
  std::vector<Change> changes;
  for (std::size_t i = 0; i < carved.size(); ++i) {
    near.clear();
    index.for_cells(carved, i, half_width_mm[i], [&](const std::vector<std::size_t>& cell) {
      near.insert(near.end(), deepest ? cell.begin() : std::upper_bound(cell.begin(), cell.end(), i), cell.end());
    });
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    changes.clear();
    const auto cover = [&](std::size_t j, int level, const Reach& reach) {
      const Stretch stretch = covered_stretch(carved, i, j, 1e-3 * reach.um);
      if (!(stretch.from_mm < stretch.to_mm)) return false;
      changes.push_back({stretch.from_mm, false, level, stretch.from_boundary, j, reach});
      changes.push_back({stretch.to_mm, true, level, stretch.to_boundary, j, reach});
      return true;
    };
    for (const std::size_t j : near) {
      if (j == i) continue;
      if (!deepest) {
        cover(j, 0,
              {sections[j].half_width_um, 0, half_width_slope(profile, sections[j].width_um, sections[j].depth_um)});
        continue;
      }
      // Most that are near do not meet: their walls are not looked at.
      const Stretch whole = covered_stretch(carved, i, j, half_width_mm[j]);
      if (!(whole.from_mm < whole.to_mm)) continue;
      for (int level = kSteps - 1; level >= 0; --level)
        if (!cover(j, level, reach_of_step(profile, sections[i], sections[j], level))) break;
    }
    // What begins comes before what ends there, so that nothing is left between the two.
    std::sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) {
      return std::tuple(a.at_mm, a.ends, a.level, a.cutter) < std::tuple(b.at_mm, b.ends, b.level, b.cutter);
    });

    const double dx = carved.x1_mm[i] - carved.x0_mm[i], dy = carved.y1_mm[i] - carved.y0_mm[i];
    const double length = std::hypot(dx, dy);
    double from = 0;
    PieceEnd begin;
    const auto piece_until = [&](double to, int level, const PieceEnd& end) {
      constexpr double kShortestMm = 1e-4;
      if (level == 0 || to - from < kShortestMm) return;
      out.pieces.x0_mm.push_back(carved.x0_mm[i] + dx * from / length);
      out.pieces.y0_mm.push_back(carved.y0_mm[i] + dy * from / length);
      out.pieces.x1_mm.push_back(carved.x0_mm[i] + dx * to / length);
      out.pieces.y1_mm.push_back(carved.y0_mm[i] + dy * to / length);
      if (!carved.width_um.empty()) out.pieces.width_um.push_back(carved.width_um[i]);
      if (!carved.alpha.empty()) out.pieces.alpha.push_back(carved.alpha[i]);
      if (deepest) {
        const double share = static_cast<double>(level) / kSteps;
        const Section& section = sections[i];
        out.pieces.depth_um.push_back(
            level == kSteps ? section.depth_um
                            : depth_at_half_width_um(profile, section.width_um, share * section.half_width_um));
        out.pieces.rimless.push_back(level == kSteps ? 0 : 1);
        out.share.push_back(share);
      } else if (!carved.depth_um.empty()) {
        out.pieces.depth_um.push_back(carved.depth_um[i]);
      }
      out.source.push_back(static_cast<std::uint32_t>(i));
      out.begin.push_back(begin);
      out.end.push_back(end);
    };
    std::array<int, kSteps> covers{};  // how many stretches leave so many steps
    const auto left = [&] {
      int level = 0;
      while (level < kSteps && covers[level] == 0) ++level;
      return level;
    };
    int level = kSteps;
    for (const Change& change : changes) {
      covers[change.level] += change.ends ? -1 : 1;
      const int now = left();
      if (now == level) continue;
      const PieceEnd here{change.at_mm / length, change.boundary,       static_cast<std::uint32_t>(change.cutter),
                          change.reach.um,       change.reach.by_depth, change.reach.by_cutter_depth};
      piece_until(change.at_mm, level, here);
      from = change.at_mm;
      begin = here;
      level = now;
    }
    piece_until(length, level, {.at = 1});
  }
  return out;
}

}  // namespace burin
