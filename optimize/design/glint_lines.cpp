#include "burin/optimize/design/glint_lines.h"

#include <tbb/parallel_for.h>

#include <limits>
#include <numbers>
#include <numeric>

#include "burin/base/machine_clones.h"
#include "burin/optimize/toolpath/ends.h"
#include "burin/scene/groove_profile.h"

namespace burin {
namespace {

double depth_of(const Scratches& s, std::size_t i, double shared_um) {
  return s.depth_um.empty() ? shared_um : s.depth_um[i];
}

// Where a line begins and ends, and the farthest reach of grooves over it.
struct SoughtLine {
  double x0_mm, y0_mm, x1_mm, y1_mm, reach_mm;
};

// Lower bounds of the distances between a line and the strips of grooves, mm: a positive one rules a cut out.
BURIN_MACHINE_CLONES void distances_mm(std::size_t n, const double* __restrict x, const double* __restrict y,
                                       const double* __restrict ux, const double* __restrict uy,
                                       const double* __restrict length, const SoughtLine line,
                                       double* __restrict apart) {
  for (std::size_t k = 0; k < n; ++k) {
    const double dx0 = line.x0_mm - x[k], dy0 = line.y0_mm - y[k], dx1 = line.x1_mm - x[k], dy1 = line.y1_mm - y[k];
    const double across0 = dx0 * uy[k] - dy0 * ux[k], across1 = dx1 * uy[k] - dy1 * ux[k];
    const double along0 = dx0 * ux[k] + dy0 * uy[k], along1 = dx1 * ux[k] + dy1 * uy[k];
    const double aside = std::max(std::min(across0, across1), -std::max(across0, across1)) - line.reach_mm;
    const double beyond = std::max(std::min(along0, along1) - length[k], -std::max(along0, along1));
    apart[k] = std::max(aside, beyond);
  }
}

}  // namespace

BrightPlaces::BrightPlaces(const GrooveProfile& profile, double width_um, double depth_um, double alpha) {
  constexpr int kWalls = 200;
  const double rim_um = half_width_um(profile, width_um, depth_um);
  most_mm_ = 1e-3 * rim_um;
  step_rad_ = std::numbers::pi / 2 / (kPlaces - 1);
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const double lean = step_rad_ * static_cast<double>(k);
    double all = 0, aside = 0, reach = 0;
    for (int wall = -kWalls; wall < kWalls; ++wall) {
      const double x = rim_um * (wall + 0.5) / kWalls;
      // Light by x, of a wall whose slope changes with x: the lobe's density by tilt (docs/model.md 3.4).
      const double off = (wall_lean(profile, width_um, x) - lean) / alpha,
                   density = 1 / ((1 + off * off) * (1 + off * off));
      all += density;
      aside += density * x;
      reach += density * std::abs(x);
    }
    const double mean = reach / all;
    places_[k] = {1e-3 * aside / all, 1e-3 * mean,
                  1e-3 * half_width_slope(profile, width_um, depth_at_half_width_um(profile, width_um, mean))};
  }
}

BrightPlaces::Place BrightPlaces::at(double lean_rad) const {
  const double place = std::clamp(lean_rad / step_rad_, 0.0, static_cast<double>(kPlaces - 1));
  const std::size_t k = std::min(static_cast<std::size_t>(place), kPlaces - 2);
  const double part = place - static_cast<double>(k);
  const Place &low = places_[k], &high = places_[k + 1];
  const auto between = [part](double a, double b) { return a + part * (b - a); };
  return {between(low.aside_mm, high.aside_mm), between(low.reach_mm, high.reach_mm),
          between(low.reach_by_depth, high.reach_by_depth)};
}

BrightPlaces bright_places(const Scratches& grooves, const Bench& bench, const Board& board) {
  const auto shared = [](const std::vector<double>& own, double all) {
    return own.empty() ? all : std::accumulate(own.begin(), own.end(), 0.0) / static_cast<double>(own.size());
  };
  return {bench.material.profile, shared(grooves.width_um, board.tool_width_um),
          shared(grooves.depth_um, bench.material.depth_um), shared(grooves.alpha, bench.material.alpha)};
}

GlintLine glint_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double depth_um, const GlintView& glint,
                     const BrightPlaces& places) {
  GlintLine out;
  out.a = a;
  out.length = (b - a).norm();
  out.u = (b - a) / out.length;
  out.depth_um = depth_um;
  const Eigen::Vector2d middle = (a + b) / 2;
  const Eigen::Vector3d h = half_vector_at(glint, {middle.x(), middle.y(), 0});
  const double leans = h.head<2>().dot(out.across());
  out.bright = places.at(std::atan2(std::abs(leans), h.z()));
  if (leans > 0) out.bright.aside_mm *= -1;  // a wall's normal tilts to the groove's middle
  return out;
}

GlintCut cut_of(const GlintLine& i, const GlintLine& j, std::uint32_t cutter) {
  const double reach = i.bright.reach_mm + i.bright.reach_by_depth * (j.depth_um - i.depth_um);
  const GrooveMet met = groove_met(i.at(0), i.u, j.a, j.u, j.length);
  const double across_end = met.across + i.length * met.across_slope;
  // Most nearby grooves do not meet.
  if (!(reach > 0) || std::min(met.across, across_end) > reach || std::max(met.across, across_end) < -reach) return {};
  return {covered_stretch(met, i.length, reach), cutter};
}

GlintCuts::GlintCuts(const Scratches& grooves, const Bench& bench, const Board& board)
    : grooves_(grooves), places_(bright_places(grooves, bench, board)) {
  constexpr double kLargestMm = 2, kMostCells = 4e6;
  Eigen::Vector2d low(1e300, 1e300), high(-1e300, -1e300);
  for (std::size_t i = 0; i < grooves.size(); ++i) {
    const Ends e = ends_of(grooves, i);
    GlintLine line;
    line.a = e.a;
    line.length = e.length();
    line.u = (e.b - e.a) / line.length;
    line.depth_um = depth_of(grooves, i, bench.material.depth_um);
    deepest_um_ = std::max(deepest_um_, line.depth_um);
    lines_.push_back(line);
    low = low.cwiseMin(e.a).cwiseMin(e.b);
    high = high.cwiseMax(e.a).cwiseMax(e.b);
  }
  const double margin = 2 * places_.most_mm(), area = (high - low).prod(),
               apart = std::sqrt(area / static_cast<double>(std::max<std::size_t>(1, lines_.size())));
  cells_ = {low, high, std::max({std::min(kLargestMm, apart), 2 * margin, std::sqrt(area / kMostCells), 1e-3})};
  first_.assign(cells_.size() + 1, 0);
  for (const GlintLine& line : lines_)
    cells_.each(line.a, line.way(), margin, [&](std::size_t cell) { ++first_[cell + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  listed_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < lines_.size(); ++i)
    cells_.each(lines_[i].a, lines_[i].way(), margin,
                [&](std::size_t cell) { listed_[next[cell]++] = static_cast<std::uint32_t>(i); });
  for (std::vector<double>* column : {&x_mm_, &y_mm_, &ux_, &uy_, &length_mm_}) column->reserve(listed_.size());
  for (const std::uint32_t i : listed_) {
    x_mm_.push_back(lines_[i].a.x());
    y_mm_.push_back(lines_[i].a.y());
    ux_.push_back(lines_[i].u.x());
    uy_.push_back(lines_[i].u.y());
    length_mm_.push_back(lines_[i].length);
  }
}

// Memory of one thread's search, and the cuts that it found.
struct GlintCuts::Seeker {
  std::vector<std::uint32_t> seen_by;  // of each groove: the last row that met it
  std::vector<double> apart_mm;
  std::vector<GlintCut> cuts;
};

// The cuts of a row's line, in any order. Most grooves near a line do not meet it, so they are sorted out first.
void GlintCuts::find_cuts(const GlintLine& line, std::size_t row, Seeker& seeker) const {
  constexpr double kRoundingMm = 1e-9;
  const Eigen::Vector2d first = line.at(0), last = line.at(line.length);
  const double reach_mm = line.bright.reach_mm + line.bright.reach_by_depth * (deepest_um_ - line.depth_um);
  seeker.cuts.clear();
  cells_.each(line.a, line.way(), 0, [&](std::size_t cell) {
    const std::size_t from = first_[cell], n = first_[cell + 1] - from;
    if (seeker.apart_mm.size() < n) seeker.apart_mm.resize(2 * n);
    distances_mm(n, &x_mm_[from], &y_mm_[from], &ux_[from], &uy_[from], &length_mm_[from],
                 {first.x(), first.y(), last.x(), last.y(), reach_mm}, seeker.apart_mm.data());
    for (std::size_t k = 0; k < n; ++k) {
      if (seeker.apart_mm[k] > kRoundingMm) continue;
      const std::uint32_t j = listed_[from + k];
      if (j == row || seeker.seen_by[j] == row) continue;
      seeker.seen_by[j] = static_cast<std::uint32_t>(row);
      const GlintCut cut = cut_of(line, lines_[j], j);
      if (cut.from < cut.to) seeker.cuts.push_back(cut);
    }
  });
}

void GlintCuts::add_left(std::size_t row, const GlintView& glint, Seeker& seeker, Carved& out) const {
  constexpr double kShortestMm = 1e-4;
  const Ends e = ends_of(grooves_, row);
  const GlintLine line = glint_line(e.a, e.b, lines_[row].depth_um, glint, places_);
  find_cuts(line, row, seeker);
  std::sort(seeker.cuts.begin(), seeker.cuts.end(), [](const GlintCut& a, const GlintCut& b) {
    return a.from != b.from ? a.from < b.from : a.cutter < b.cutter;
  });
  const auto end_at = [&](const GlintCut& cut, bool begins) {
    const double slope = line.bright.reach_by_depth, by_um = 1e3;
    return PieceEnd{(begins ? cut.from : cut.to) / line.length,
                    begins ? cut.from_boundary : cut.to_boundary,
                    cut.cutter,
                    by_um * (line.bright.reach_mm + slope * (lines_[cut.cutter].depth_um - line.depth_um)),
                    -by_um * slope,
                    by_um * slope};
  };
  double from = 0;
  PieceEnd begin;
  const auto add_piece = [&](double to, const PieceEnd& end) {
    if (to - from < kShortestMm) return;
    out.scratches.x0_mm.push_back(line.a.x() + from * line.u.x());
    out.scratches.y0_mm.push_back(line.a.y() + from * line.u.y());
    out.scratches.x1_mm.push_back(line.a.x() + to * line.u.x());
    out.scratches.y1_mm.push_back(line.a.y() + to * line.u.y());
    for (const auto column : {&Scratches::width_um, &Scratches::depth_um, &Scratches::alpha})
      if (!(grooves_.*column).empty()) (out.scratches.*column).push_back((grooves_.*column)[row]);
    out.source.push_back(static_cast<std::uint32_t>(row));
    out.begin.push_back(begin);
    out.end.push_back(end);
  };
  for (const GlintCut& cut : seeker.cuts) {
    if (cut.to <= from) continue;
    if (cut.from > from) add_piece(cut.from, end_at(cut, true));
    from = cut.to;
    begin = end_at(cut, false);
  }
  if (from < line.length) add_piece(line.length, {.at = 1});
}

Carved GlintCuts::left_of(std::span<const std::size_t> rows, std::span<const GlintView* const> glints) const {
  constexpr std::size_t kAtOnce = 256;
  std::vector<Carved> parts((rows.size() + kAtOnce - 1) / kAtOnce);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    Seeker seeker{std::vector<std::uint32_t>(lines_.size(), std::numeric_limits<std::uint32_t>::max()), {}, {}};
    for (std::size_t k = part * kAtOnce; k < std::min(rows.size(), (part + 1) * kAtOnce); ++k)
      add_left(rows[k], *glints[k], seeker, parts[part]);
  });
  std::vector<std::size_t> first(parts.size() + 1, 0);
  for (std::size_t part = 0; part < parts.size(); ++part) first[part + 1] = first[part] + parts[part].source.size();
  Carved out;
  const auto columns = [](Carved& of, const auto& visit) {
    Scratches& s = of.scratches;
    visit(s.x0_mm, s.y0_mm, s.x1_mm, s.y1_mm, s.width_um, s.depth_um, s.alpha, of.source, of.begin, of.end);
  };
  columns(out, [&](auto&... column) { (column.resize(first.back()), ...); });
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    const auto at = static_cast<std::ptrdiff_t>(first[part]);
    columns(out, [&](auto&... to) {
      columns(parts[part], [&](auto&... from) { (std::copy(from.begin(), from.end(), to.begin() + at), ...); });
    });
  });
  for (const auto column : {&Scratches::width_um, &Scratches::depth_um, &Scratches::alpha})
    if ((grooves_.*column).empty()) (out.scratches.*column).clear();
  return out;
}

}  // namespace burin
