#include "burin/scene/crossings.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/limits.h"
#include "burin/scene/groove.h"
#include "burin/scene/line_cuts.h"

namespace burin {
namespace {

// Grooves as strips: start, direction, length, and extent to either side.
struct Strips {
  std::vector<double> x_mm, y_mm, ux, uy, length_mm, half_width_mm;

  Strips(const Scratches& s, std::vector<double> half_widths_mm)
      : x_mm(s.x0_mm), y_mm(s.y0_mm), half_width_mm(std::move(half_widths_mm)) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double dx = s.x1_mm[i] - s.x0_mm[i], dy = s.y1_mm[i] - s.y0_mm[i], length = std::hypot(dx, dy);
      ux.push_back(dx / length);
      uy.push_back(dy / length);
      length_mm.push_back(length);
    }
  }
  std::size_t size() const { return x_mm.size(); }
  Eigen::Vector2d first_mm(std::size_t i) const { return {x_mm[i], y_mm[i]}; }
  Eigen::Vector2d along(std::size_t i) const { return {ux[i], uy[i]}; }
  // Scratch j in the coordinates of the middle line of scratch i.
  GrooveMet met(std::size_t i, std::size_t j) const {
    return groove_met(first_mm(i), along(i), first_mm(j), along(j), length_mm[j]);
  }
};

// A grid of square cells over the board. Each cell lists the scratches whose strip touches it, to find candidates for
// intersections with a center line.
class CellIndex {
 public:
  explicit CellIndex(const Strips& strips) {
    constexpr double kFar = 1e300;
    Eigen::Vector2d low(kFar, kFar), high(-kFar, -kFar);
    double reach = 0;
    for (std::size_t i = 0; i < strips.size(); ++i) {
      const Eigen::Vector2d first = strips.first_mm(i), last = first + strips.length_mm[i] * strips.along(i);
      reach = std::max(reach, strips.half_width_mm[i]);
      low = low.cwiseMin(first).cwiseMin(last);
      high = high.cwiseMax(first).cwiseMax(last);
    }
    // About one cell per scratch, but no cell narrower than a strip, and only a few cells per strip.
    constexpr double kMostCells = 16e6, kLargestMm = 2, kCellsAStrip = 16;
    const double mean_mm =
        std::accumulate(strips.length_mm.begin(), strips.length_mm.end(), 0.0) / static_cast<double>(strips.size());
    const double area = (high - low).cwiseMax(0).prod();
    const double cell_mm = std::min(kLargestMm, std::sqrt(area / static_cast<double>(strips.size())));
    cells_ = {low, high, std::max({cell_mm, 2 * reach, std::sqrt(area / kMostCells), mean_mm / kCellsAStrip, 1e-3})};
    first_.assign(cells_.size() + 1, 0);
    for (std::size_t i = 0; i < strips.size(); ++i)
      for_cells(strips, i, strips.half_width_mm[i], [&](std::size_t cell) { ++first_[cell + 1]; });
    for (const std::size_t in_cell : first_) near_ += static_cast<double>(in_cell) * static_cast<double>(in_cell);
    if (is_crowded()) return;
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    listed_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < strips.size(); ++i)
      for_cells(strips, i, strips.half_width_mm[i],
                [&](std::size_t cell) { listed_[next[cell]++] = static_cast<std::uint32_t>(i); });
  }

  /// True if too many scratches are near each other for a search; the index is then empty.
  bool is_crowded() const { return near_ > static_cast<double>(limit::kNear); }

  /// Finds scratches within a margin of scratch i's center line, with index `least` or higher, in order.
  void find_near(const Strips& strips, std::size_t i, double margin_mm, std::size_t least,
                 std::vector<std::uint32_t>& near) const {
    near.clear();
    for_cells(strips, i, margin_mm, [&](std::size_t cell) {
      const auto begin = listed_.begin() + static_cast<std::ptrdiff_t>(first_[cell]),
                 end = listed_.begin() + static_cast<std::ptrdiff_t>(first_[cell + 1]);
      near.insert(near.end(), std::lower_bound(begin, end, least), end);
    });
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
  }

 private:
  // Visits the cells within the margin of scratch i's center line.
  template <typename F>
  void for_cells(const Strips& s, std::size_t i, double margin_mm, const F& f) const {
    cells_.each(s.first_mm(i), s.length_mm[i] * s.along(i), margin_mm, f);
  }

  CellsOfLines cells_;
  double near_ = 0;
  std::vector<std::size_t> first_;  // of a cell's list in listed_
  std::vector<std::uint32_t> listed_;
};

using Boundary = PieceEnd::Boundary;

// Levels of the remaining part of a cut groove. 0: nothing. `steps`: its whole width without burrs. `steps` + 1: all of
// it.
constexpr int kMostLevels = kMostCrossingSteps + 1;

// A groove's cross-section.
struct Section {
  double width_um, depth_um, half_width_um, rim_by_depth;

  bool operator==(const Section&) const = default;
};

// Distance from the middle of one groove, um, within which it hides another; and its change per um of additional depth
// of the hidden groove, and of the hiding one.
struct Reach {
  double um = 0, by_depth = 0, by_cutter_depth = 0;
};

// Sample points of groove i's wall depth: two Gauss-Legendre points in each step of its half-width.
struct Walls {
  struct Node {
    double inner_um, by_depth;  // depth there, and its change per um of additional depth of the groove
  };
  std::array<std::array<Node, 2>, kMostCrossingSteps> nodes;  // of each step
};

Walls walls_of(const GrooveProfile& profile, const Section& i, int steps) {
  constexpr double kNode = 0.21132486540518708;
  Walls out;
  for (int level = 0; level < steps; ++level)
    for (int node = 0; node < 2; ++node) {
      const double share = (level + (node == 0 ? kNode : 1 - kNode)) / steps,
                   inner_um = depth_at_half_width_um(profile, i.width_um, share * i.half_width_um);
      out.nodes[level][node] = {inner_um, share * i.rim_by_depth / half_width_slope(profile, i.width_um, inner_um)};
    }
  return out;
}

// At most `level` steps of groove i remain within this distance of the middle of j. It is the mean over the next step
// of the distance at which the walls of both are equally low (docs/model.md 7.10).
Reach reach_of_step(const GrooveProfile& profile, const Section& i, const Walls& walls, const Section& j, int level) {
  Reach out;
  for (const Walls::Node& node : walls.nodes[level]) {
    const double below_um = node.inner_um + j.depth_um - i.depth_um;
    if (!(below_um > 0)) continue;
    const double slope = half_width_slope(profile, j.width_um, below_um);
    out.um += half_width_um(profile, j.width_um, below_um) / 2;
    out.by_depth += slope * (node.by_depth - 1) / 2;
    out.by_cutter_depth += slope / 2;
  }
  return out;
}

using Reaches = std::array<Reach, kMostCrossingSteps>;  // by level

// A position along a groove at which a reduction begins or ends.
struct Change {
  double at_mm;
  bool ends;
  int level;  // remaining steps between the two
  PieceEnd::Boundary boundary;
  std::uint32_t cutter;
  Reach reach;
};

// Cached results for one cross-section next to another: many consecutive grooves share one.
struct SectionsMet {
  int steps = kCrossingSteps;
  const Section* section = nullptr;
  Walls walls;
  const Section* reached = nullptr;  // the section of `reaches`
  Reaches reaches;

  void meet(const GrooveProfile& profile, const Section& i) {
    if (section != nullptr && *section == i) return;
    section = &i;
    walls = walls_of(profile, i, steps);
    reached = nullptr;
  }
  void reach(const GrooveProfile& profile, const Section& j) {
    if (reached != nullptr && *reached == j) return;
    reached = &j;
    for (int level = 0; level < steps; ++level) reaches[level] = reach_of_step(profile, *section, walls, j, level);
  }
};

// Cuts grooves one by one; one thread cuts one part of the list.
struct Cutting {
  const Scratches& carved;
  const GrooveProfile& profile;
  bool deepest, burrs;
  int steps;
  std::vector<Section> sections;
  Strips strips;
  CellIndex index{strips};

  // Intervals of groove i that other grooves cover, in order along it.
  void find_changes(std::size_t i, SectionsMet& met, std::vector<std::uint32_t>& near,
                    std::vector<Change>& changes) const {
    index.find_near(strips, i, 0, deepest || burrs ? 0 : i + 1, near);
    changes.clear();
    const auto cover = [&](std::uint32_t j, int level, const Reach& reach) {
      const LineStretch stretch = covered_stretch(strips.met(i, j), strips.length_mm[i], 1e-3 * reach.um);
      if (stretch.is_empty()) return false;
      changes.push_back({stretch.from, false, level, stretch.from_boundary, j, reach});
      changes.push_back({stretch.to, true, level, stretch.to_boundary, j, reach});
      return true;
    };
    if (deepest) met.meet(profile, sections[i]);
    for (const std::uint32_t j : near) {
      if (j == i) continue;
      const auto rims = [&] { return Reach{sections[j].half_width_um, 0, sections[j].rim_by_depth}; };
      if (!deepest) {
        cover(j, j > i ? 0 : steps, rims());
        continue;
      }
      // Most candidates do not meet the groove, and need no wall computation.
      if (covered_stretch(strips.met(i, j), strips.length_mm[i], strips.half_width_mm[j]).is_empty()) continue;
      met.reach(profile, sections[j]);
      if (burrs) cover(j, steps, rims());
      for (int level = steps - 1; level >= 0; --level)
        if (!cover(j, level, met.reaches[level])) break;
    }
    // Beginnings precede ends at the same position, so that nothing remains between the two.
    std::sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) {
      return std::tuple(a.at_mm, a.ends, a.level, a.cutter) < std::tuple(b.at_mm, b.ends, b.level, b.cutter);
    });
  }

  // Adds a piece of groove i with `level` remaining steps; skips a piece too short to be visible.
  void add_piece(std::size_t i, int level, double from_mm, double to_mm, const PieceEnd& begin, const PieceEnd& end,
                 VisiblePieces& out) const {
    constexpr double kShortestMm = 1e-4;
    if (level == 0 || to_mm - from_mm < kShortestMm) return;
    out.pieces.x0_mm.push_back(strips.x_mm[i] + strips.ux[i] * from_mm);
    out.pieces.y0_mm.push_back(strips.y_mm[i] + strips.uy[i] * from_mm);
    out.pieces.x1_mm.push_back(strips.x_mm[i] + strips.ux[i] * to_mm);
    out.pieces.y1_mm.push_back(strips.y_mm[i] + strips.uy[i] * to_mm);
    if (!carved.width_um.empty()) out.pieces.width_um.push_back(carved.width_um[i]);
    if (!carved.alpha.empty()) out.pieces.alpha.push_back(carved.alpha[i]);
    const double share = static_cast<double>(level) / steps;
    if (deepest) {
      const Section& section = sections[i];
      out.pieces.depth_um.push_back(
          level >= steps ? section.depth_um
                         : depth_at_half_width_um(profile, section.width_um, share * section.half_width_um));
    } else if (!carved.depth_um.empty()) {
      out.pieces.depth_um.push_back(carved.depth_um[i]);
    }
    if (deepest || burrs) out.pieces.left.push_back(level < steps ? share : level < steps + 1 ? kAllButBurrs : 1);
    out.source.push_back(static_cast<std::uint32_t>(i));
    out.begin.push_back(begin);
    out.end.push_back(end);
  }

  void add_pieces(std::size_t i, const std::vector<Change>& changes, VisiblePieces& out) const {
    const double length = strips.length_mm[i];
    double from = 0;
    PieceEnd begin;
    const int whole = steps + 1;
    std::array<int, kMostLevels> covers{};  // number of active intervals per level
    const auto left = [&] {
      int level = 0;
      while (level < whole && covers[level] == 0) ++level;
      return level;
    };
    int level = whole;
    for (const Change& change : changes) {
      covers[change.level] += change.ends ? -1 : 1;
      const int now = left();
      if (now == level) continue;
      const PieceEnd here{change.at_mm / length, change.boundary,       change.cutter,
                          change.reach.um,       change.reach.by_depth, change.reach.by_cutter_depth};
      add_piece(i, level, from, change.at_mm, begin, here, out);
      from = change.at_mm;
      begin = here;
      level = now;
    }
    add_piece(i, level, from, length, begin, {.at = 1}, out);
  }
};

// Concatenates a column of all parts; empty if all are empty.
template <typename ColumnOf>
void join_column(std::vector<VisiblePieces>& parts, const std::vector<std::size_t>& first, VisiblePieces& out,
                 const ColumnOf& column_of) {
  bool any = false;
  for (VisiblePieces& part : parts) any = any || !column_of(part)->empty();
  if (!any) return;
  auto& to = *column_of(out);
  to.resize(first.back());
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t k) {
    const auto from = std::exchange(*column_of(parts[k]), {});  // frees its memory at once
    std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(first[k]));
  });
}

VisiblePieces joined(std::vector<VisiblePieces> parts) {
  std::vector<std::size_t> first{0};
  for (const VisiblePieces& part : parts) first.push_back(first.back() + part.source.size());
  VisiblePieces out;
  for (const auto column : {&Scratches::x0_mm, &Scratches::y0_mm, &Scratches::x1_mm, &Scratches::y1_mm,
                            &Scratches::width_um, &Scratches::depth_um, &Scratches::alpha, &Scratches::left})
    join_column(parts, first, out, [column](VisiblePieces& p) { return &(p.pieces.*column); });
  join_column(parts, first, out, [](VisiblePieces& p) { return &p.source; });
  join_column(parts, first, out, [](VisiblePieces& p) { return &p.begin; });
  join_column(parts, first, out, [](VisiblePieces& p) { return &p.end; });
  return out;
}

}  // namespace

std::string_view in_words(Crossings crossings) {
  switch (crossings) {
    case Crossings::add:
      return "their light adds";
    case Crossings::last:
      return "the one carved last is seen";
    case Crossings::deepest:
      return "the lower surface is seen";
  }
  return {};
}

namespace {

struct Pieces {
  std::vector<VisiblePieces> parts;  // of all scratches, in carving order
  bool too_many = false;             // then there are no parts
  bool too_near = false;             // too many scratches are near each other; nothing was computed
};

std::vector<Section> sections_of(const Scratches& carved, double tool_width_um, double depth_um,
                                 const GrooveProfile& profile) {
  std::vector<Section> sections(carved.size());
  for (std::size_t i = 0; i < carved.size(); ++i) {
    sections[i] = {carved.width_um.empty() ? tool_width_um : carved.width_um[i],
                   carved.depth_um.empty() ? depth_um : carved.depth_um[i], 0, 0};
    if (i > 0 && sections[i].width_um == sections[i - 1].width_um && sections[i].depth_um == sections[i - 1].depth_um) {
      sections[i] = sections[i - 1];
    } else {
      sections[i].half_width_um = half_width_um(profile, sections[i].width_um, sections[i].depth_um);
      sections[i].rim_by_depth = half_width_slope(profile, sections[i].width_um, sections[i].depth_um);
    }
  }
  return sections;
}

Pieces pieces_in_parts(const Scratches& carved, double tool_width_um, double depth_um, const GrooveProfile& profile,
                       Crossings rule, int steps, std::size_t most) {
  std::vector<Section> sections = sections_of(carved, tool_width_um, depth_um, profile);
  std::vector<double> half_width_mm(carved.size());
  for (std::size_t i = 0; i < carved.size(); ++i) half_width_mm[i] = 1e-3 * sections[i].half_width_um;
  const Cutting cutting{carved,
                        profile,
                        rule == Crossings::deepest,
                        profile.has_burrs(),
                        steps,
                        std::move(sections),
                        Strips(carved, std::move(half_width_mm))};
  if (cutting.index.is_crowded()) return {{}, true, true};
  constexpr std::size_t kAtOnce = 512;  // pieces come in carving order, independent of threads
  std::vector<VisiblePieces> parts((carved.size() + kAtOnce - 1) / kAtOnce);
  std::atomic<std::size_t> made{0};
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    std::vector<std::uint32_t> near;
    std::vector<Change> changes;
    SectionsMet met;
    met.steps = steps;
    for (std::size_t i = part * kAtOnce; i < std::min(carved.size(), (part + 1) * kAtOnce) && made <= most; ++i) {
      const std::size_t before = parts[part].source.size();
      cutting.find_changes(i, met, near, changes);
      cutting.add_pieces(i, changes, parts[part]);
      made += parts[part].source.size() - before;
    }
  });
  if (made > most) return {{}, true, false};
  return {std::move(parts), false, false};
}

}  // namespace

int crossing_steps_for(double covered) {
  constexpr double kOff = 0.045;
  return static_cast<int>(std::clamp(std::ceil(covered / (2 * kOff)), static_cast<double>(kCrossingSteps),
                                     static_cast<double>(kMostCrossingSteps)));
}

VisiblePieces visible_pieces(const Scratches& carved, double tool_width_um, double depth_um,
                             const GrooveProfile& profile, Crossings rule, int steps) {
  if (carved.size() == 0) return {};
  const std::size_t most = carved.size() + limit::kCuts;
  Pieces made =
      pieces_in_parts(carved, tool_width_um, depth_um, profile, rule, std::clamp(steps, 1, kMostCrossingSteps), most);
  if (made.too_many)
    fail("crossings of " + std::to_string(carved.size()) + " scratches",
         made.too_near ? "are too many: they lie more than " + std::to_string(limit::kNear) + " times near one another"
                       : "cut grooves into more than " + std::to_string(most) + " pieces",
         "let their light add there (\"crossings\": \"add\" in bench.json's material, burin refine --crossings add), "
         "or carve "
         "fewer or shorter scratches");
  return joined(std::move(made.parts));
}

bool are_more_pieces(const Scratches& carved, double tool_width_um, double depth_um, const GrooveProfile& profile,
                     Crossings rule, std::size_t most) {
  return rule != Crossings::add && carved.size() > 0 &&
         pieces_in_parts(carved, tool_width_um, depth_um, profile, rule, kCrossingSteps, most).too_many;
}

double expected_pieces(double length_mm, double area_mm2) {
  constexpr double kPiecesACrossing = 2;  // of each of the two
  return kPiecesACrossing * 2 / std::numbers::pi * length_mm * length_mm / std::max(area_mm2, 1e-9);
}

double expected_pieces(const Scratches& scratches, double area_mm2) {
  double length_mm = 0;
  for (std::size_t i = 0; i < scratches.size(); ++i)
    length_mm += std::hypot(scratches.x1_mm[i] - scratches.x0_mm[i], scratches.y1_mm[i] - scratches.y0_mm[i]);
  return static_cast<double>(scratches.size()) + expected_pieces(length_mm, area_mm2);
}

namespace {

// Each lane of a groove is visible outside this distance from another groove's middle, mm. It is the mean over the lane
// of the distance at which the walls of both are equally low (docs/model.md 7.10).
struct LaneReaches {
  std::vector<double> middle_um;                // of each lane
  std::vector<std::array<double, 2>> inner_um;  // depths of grooves as wide as each of the lane's two nodes
  std::vector<double> reach_mm;                 // relative to the section of the last call
  const Section* section = nullptr;
  const Section* other = nullptr;

  void meet(const GrooveProfile& profile, std::span<const Lane> lanes, const Section& of) {
    if (section != nullptr && *section == of) return;
    constexpr double kNode = 0.21132486540518708;  // two Gauss-Legendre points
    section = &of;
    other = nullptr;
    middle_um.resize(lanes.size());
    inner_um.resize(lanes.size());
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      middle_um[l] = lane_place(lanes[l], of.half_width_um, profile.burr_width_um).middle_um;
      for (int node = 0; node < 2; ++node) {
        const double share = lanes[l].from + (node == 0 ? kNode : 1 - kNode) * (lanes[l].to - lanes[l].from);
        inner_um[l][node] = lanes[l].part == Lane::Part::groove
                                ? depth_at_half_width_um(profile, of.width_um, std::abs(share) * of.half_width_um)
                                : of.depth_um;
      }
    }
  }
  void reach(const GrooveProfile& profile, const Section& of, bool by_depth) {
    if (other != nullptr && *other == of) return;
    other = &of;
    reach_mm.assign(inner_um.size(), 1e-3 * of.half_width_um);
    if (!by_depth) return;
    for (std::size_t l = 0; l < inner_um.size(); ++l) {
      reach_mm[l] = 0;
      for (const double inner : inner_um[l])
        if (const double below = inner + of.depth_um - section->depth_um; below > 0)
          reach_mm[l] += 0.5e-3 * half_width_um(profile, of.width_um, below);
    }
  }
};

// Another groove in the coordinates of one groove's middle line.
struct OtherGroove {
  GrooveMet met;
  std::size_t reaches;  // index of its first reach: one per lane
  std::uint32_t row;

  // In the coordinates of a parallel line this far to the right.
  GrooveMet beside(double aside_mm) const {
    GrooveMet out = met;
    out.across += aside_mm * met.along_slope;
    out.along -= aside_mm * met.across_slope;
    return out;
  }
};

struct CoveredSpan {
  double from, to;
  double from_moves = 0, to_moves = 0;  // outwards, with the cutter's rims, mm per unit of the depth's logarithm
};

struct LaneLayer {
  const GrooveProfile& profile;
  bool deepest, burrs;
  std::span<const Lane> lanes;
  std::span<const std::uint32_t> order;
  std::vector<Section> sections;
  std::vector<double> margin_mm;
  Strips strips;
  CellIndex index{strips};

  struct Work {
    LaneReaches reaches;
    std::vector<std::uint32_t> near;
    std::vector<OtherGroove> others;
    std::vector<double> reach_mm;
    std::vector<CoveredSpan> covered;
  };

  // True if the rims of other grooves bound the visible part of a lane, and not equally low walls.
  bool rims_cut_lane(std::size_t lane) const { return !deepest || lanes[lane].part != Lane::Part::groove; }

  // Finds the other grooves that may remove parts of groove i, and the reach of each.
  void find_met(std::size_t i, Work& w) const {
    index.find_near(strips, i, margin_mm[i], 0, w.near);
    w.others.clear();
    w.reach_mm.clear();
    w.reaches.meet(profile, lanes, sections[i]);
    const double length = strips.length_mm[i];
    for (const std::uint32_t j : w.near) {
      if (j == i || (!deepest && !burrs && order[j] < order[i])) continue;
      const GrooveMet met = strips.met(i, j);
      // Both ends are on one side of it, beyond both widths, or all before or behind it: they do not meet.
      const double wide = strips.half_width_mm[j] + margin_mm[i], across_end = met.across + length * met.across_slope,
                   along_end = met.along + length * met.along_slope;
      if (std::min(met.across, across_end) > wide || std::max(met.across, across_end) < -wide ||
          std::min(met.along, along_end) > met.length_mm + margin_mm[i] ||
          std::max(met.along, along_end) < -margin_mm[i])
        continue;
      w.others.push_back({met, w.reach_mm.size(), j});
      w.reaches.reach(profile, sections[j], deepest);
      for (std::size_t l = 0; l < lanes.size(); ++l) {
        const bool is_burr = lanes[l].part != Lane::Part::groove;
        const bool takes = is_burr || deepest || order[j] > order[i];
        w.reach_mm.push_back(!takes ? 0 : is_burr ? 1e-3 * sections[j].half_width_um : w.reaches.reach_mm[l]);
      }
    }
  }

  // Intervals of a lane that other grooves cover, in order along it. The lane's middle is at x, to the right.
  void find_covered(std::size_t i, std::size_t lane, Work& w) const {
    const double aside_mm = 1e-3 * w.reaches.middle_um[lane];
    w.covered.clear();
    for (const OtherGroove& other : w.others) {
      const double reach = w.reach_mm[other.reaches + lane];
      if (!(reach > 0)) continue;
      const LineStretch stretch = covered_stretch(other.beside(aside_mm), strips.length_mm[i], reach);
      if (stretch.is_empty()) continue;
      const Section& section = sections[other.row];
      const auto moves = [&](Boundary at) {
        const bool is_rim = rims_cut_lane(lane) && (at == Boundary::side_minus || at == Boundary::side_plus);
        return is_rim ? 1e-3 * section.depth_um * section.rim_by_depth / std::abs(other.met.across_slope) : 0;
      };
      w.covered.push_back({stretch.from, stretch.to, moves(stretch.from_boundary), moves(stretch.to_boundary)});
    }
    std::sort(w.covered.begin(), w.covered.end(), [](const CoveredSpan& a, const CoveredSpan& b) {
      return a.from < b.from || (a.from == b.from && a.to < b.to);
    });
  }

  // Adds the visible fractions to the groove's empty cells.
  void lay(std::size_t i, std::size_t cells, Work& w, float* share, float* by_depth) const {
    find_met(i, w);
    const double cell_mm = strips.length_mm[i] / static_cast<double>(cells);
    const auto cell_at = [&](double at_mm) {
      return std::min(static_cast<std::size_t>(std::max(0.0, at_mm / cell_mm)), cells - 1);
    };
    for (std::size_t lane = 0; lane < lanes.size(); ++lane) {
      find_covered(i, lane, w);
      const auto add = [&](double from, double to) {
        if (!(from < to)) return;
        for (std::size_t cell = cell_at(from), last = cell_at(to); cell <= last; ++cell) {
          const double begin = std::max(from, static_cast<double>(cell) * cell_mm),
                       end = std::min(to, static_cast<double>(cell + 1) * cell_mm);
          share[cell * lanes.size() + lane] += static_cast<float>((end - begin) / cell_mm);
        }
      };
      const auto shorten = [&](double at, double by_mm) {
        if (by_depth != nullptr && by_mm != 0)
          by_depth[cell_at(at) * lanes.size() + lane] -= static_cast<float>(by_mm / cell_mm);
      };
      double free_from = 0, moves = 0;
      for (const CoveredSpan& span : w.covered) {
        if (span.from > free_from) {
          add(free_from, span.from);
          shorten(free_from, moves);
          shorten(span.from, span.from_moves);
        }
        if (span.to <= free_from) continue;
        free_from = span.to;
        moves = span.to_moves;
      }
      add(free_from, strips.length_mm[i]);
      if (free_from < strips.length_mm[i]) shorten(free_from, moves);
    }
  }
};

}  // namespace

std::vector<Lane> lanes_across(const GrooveProfile& profile, int count) {
  std::vector<Lane> out;
  for (int k = 0; k < count; ++k) out.push_back({Lane::Part::groove, 2.0 * k / count - 1, 2.0 * (k + 1) / count - 1});
  constexpr int kOfBurr = 2;
  const auto burr = [&](double height_um, Lane::Part part) {
    for (int k = 0; k < kOfBurr && height_um > 0; ++k)
      out.push_back({part, static_cast<double>(k) / kOfBurr, static_cast<double>(k + 1) / kOfBurr});
  };
  burr(profile.burr_left_um, Lane::Part::left_burr);
  burr(profile.burr_right_um, Lane::Part::right_burr);
  return out;
}

LanePlace lane_place(const Lane& lane, double half_width_um, double burr_width_um) {
  const double middle = 0.5 * (lane.from + lane.to), width = lane.to - lane.from;
  if (lane.part == Lane::Part::groove) return {middle * half_width_um, width * half_width_um};
  const double aside = half_width_um + middle * burr_width_um;
  return {lane.part == Lane::Part::right_burr ? aside : -aside, width * burr_width_um};
}

VisibleLanes visible_lanes(const Scratches& grooves, std::span<const std::uint32_t> order, double tool_width_um,
                           double depth_um, const GrooveProfile& profile, Crossings rule, int count, double cell_mm) {
  VisibleLanes out;
  out.lanes = lanes_across(profile, count);
  out.first.assign(1, 0);
  if (grooves.size() == 0) return out;
  std::vector<Section> sections = sections_of(grooves, tool_width_um, depth_um, profile);
  std::vector<double> half_width_mm, margin_mm;
  for (const Section& section : sections) {
    half_width_mm.push_back(1e-3 * section.half_width_um);
    margin_mm.push_back(1e-3 * (section.half_width_um + (profile.has_burrs() ? profile.burr_width_um : 0)));
  }
  const LaneLayer layer{
      profile, rule == Crossings::deepest, profile.has_burrs(),  out.lanes,
      order,   std::move(sections),        std::move(margin_mm), Strips(grooves, std::move(half_width_mm))};
  if (layer.index.is_crowded())
    fail("crossings of " + std::to_string(grooves.size()) + " scratches",
         "are too many: they lie more than " + std::to_string(limit::kNear) + " times near one another",
         "carve fewer or shorter scratches");
  for (const double length_mm : layer.strips.length_mm)
    out.first.push_back(out.first.back() +
                        std::max<std::size_t>(1, static_cast<std::size_t>(length_mm / cell_mm + 0.5)));
  const std::size_t numbers = out.first.back() * out.lanes.size();
  out.share.assign(numbers, 0);
  if (!layer.deepest || layer.burrs) out.share_by_depth.assign(numbers, 0);
  constexpr std::size_t kAtOnce = 64;
  tbb::parallel_for(std::size_t{0}, (grooves.size() + kAtOnce - 1) / kAtOnce, [&](std::size_t part) {
    LaneLayer::Work work;
    for (std::size_t i = part * kAtOnce; i < std::min(grooves.size(), (part + 1) * kAtOnce); ++i) {
      const std::size_t at = out.first[i] * out.lanes.size();
      layer.lay(i, out.first[i + 1] - out.first[i], work, &out.share[at],
                out.share_by_depth.empty() ? nullptr : &out.share_by_depth[at]);
    }
  });
  return out;
}

}  // namespace burin
