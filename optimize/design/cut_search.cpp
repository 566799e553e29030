#include "burin/optimize/design/cut_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "burin/optimize/design/glint_lines.h"
#include "burin/optimize/design/stroke_sweep.h"
#include "burin/optimize/design/stroke_tries.h"
#include "burin/optimize/toolpath/ends.h"

namespace burin {
namespace {

using Eigen::Vector2d;

// One tile of a sweep: the grooves in it, and the cuts between them.
class CutTile {
 public:
  CutTile(std::vector<StrokeField>& fields, const StrokeRules& rules, const Metal& metal, const BrightPlaces& places,
          const PixelBox& box, const Scratches& before, const std::vector<std::size_t>& view, std::uint64_t seed,
          Scratches& scratches)
      : fields_(fields),
        rules_(rules),
        metal_(metal),
        places_(places),
        box_(box),
        scratches_(scratches),
        before_(fields.size()) {
    const Vector2d low = fields.front().board({static_cast<double>(box.x0), static_cast<double>(box.y1)}),
                   high = fields.front().board({static_cast<double>(box.x1), static_cast<double>(box.y0)});
    margin_ = 2 * places.most_mm();
    const Vector2d least = low.array() - margin_, most = high.array() + margin_;
    grid_ = {least, most, std::max(2 * margin_, kCellPx * fields.front().pitch_mm())};
    cells_.resize(grid_.size());
    local_.assign(before.size(), kNone);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Ends e = ends_of(before, i);
      if ((e.a.cwiseMax(e.b) - least).minCoeff() < 0 || (most - e.a.cwiseMin(e.b)).minCoeff() < 0) continue;
      local_[i] = static_cast<std::uint32_t>(lines_.size());
      lines_.push_back(line(i, e, view[i]));
      views_.push_back(view[i]);
    }
    cuts_.resize(lines_.size());
    cut_by_.resize(lines_.size());
    seen_.assign(lines_.size(), 0);
    for (std::uint32_t k = 0; k < lines_.size(); ++k) list(k);
    for (std::uint32_t k = 0; k < lines_.size(); ++k) meet(k, k + 1);
    for (std::size_t v = 0; v < fields.size(); ++v) triers_.emplace_back(fields[v], rules, box, seed_of(seed, v, 0, 0));
  }

  void run(std::vector<std::size_t>& mine, std::vector<char>& changed, Stopping& stop) {
    constexpr std::size_t kSurveyEvery = 1000, kAskEvery = 8;
    SplitMix64& random = triers_.front().random();
    for (std::size_t k = mine.size(); k > 1; --k) std::swap(mine[k - 1], mine[random() % k]);
    for (std::size_t k = 0; k < mine.size(); ++k) {
      if (k % kAskEvery == 0 && stop()) break;
      if (k % kSurveyEvery == 0)
        for (StrokeTrier& trier : triers_) trier.survey();
      if (better(mine[k])) changed[mine[k]] = 1;
    }
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static constexpr double kCellPx = 4, kLeast = 1e-9;

  GlintLine line(std::size_t row, const Ends& e, std::size_t view) const {
    const Vector2d middle = (e.a + e.b) / 2;
    const Bench& bench = metal_.bench;
    double depth_um = scratches_.depth_um.empty() ? bench.material.depth_um : scratches_.depth_um[row];
    if (!bench.depth_field.is_constant() && !scratches_.is_carved(row))
      depth_um = at_place(bench.depth_field, depth_um, metal_.board.size_mm, middle);
    return glint_line(e.a, e.b, depth_um, fields_[view].glint(), places_);
  }

  void list(std::uint32_t k) {
    grid_.each(lines_[k].a, lines_[k].way(), margin_, [&](std::size_t cell) { cells_[cell].push_back(k); });
  }
  void unlist(std::uint32_t k) {
    grid_.each(lines_[k].a, lines_[k].way(), margin_, [&](std::size_t cell) {
      auto& listed = cells_[cell];
      const auto at = std::find(listed.begin(), listed.end(), k);
      if (at == listed.end()) return;
      *at = listed.back();
      listed.pop_back();
    });
  }

  // Adds the cuts between line k and nearby lines with an index of at least `least`.
  void meet(std::uint32_t k, std::uint32_t least) {
    near_.clear();
    ++visit_;
    grid_.each(lines_[k].a, lines_[k].way(), 0, [&](std::size_t cell) {
      for (const std::uint32_t j : cells_[cell]) {
        if (j == k || j < least || seen_[j] == visit_) continue;
        seen_[j] = visit_;
        near_.push_back(j);
      }
    });
    for (const std::uint32_t j : near_) {
      const GlintCut mine = cut_of(lines_[k], lines_[j], j), theirs = cut_of(lines_[j], lines_[k], k);
      if (mine.from < mine.to) add_cut(k, mine);
      if (theirs.from < theirs.to) add_cut(j, theirs);
    }
  }
  void add_cut(std::uint32_t line, const GlintCut& cut) {
    cuts_[line].push_back(cut);
    cut_by_[cut.cutter].push_back(line);
  }
  // Removes the cuts by line k in other lines; visit(line, cut).
  template <typename Visit>
  void forget_cuts_by(std::uint32_t k, const Visit& visit) {
    for (const std::uint32_t j : std::exchange(cut_by_[k], {})) {
      std::vector<GlintCut>& cuts = cuts_[j];
      const auto at = std::find_if(cuts.begin(), cuts.end(), [k](const GlintCut& c) { return c.cutter == k; });
      if (at == cuts.end()) continue;  // its line was removed in the meantime
      const GlintCut cut = *at;
      *at = cuts.back();
      cuts.pop_back();
      visit(j, cut);
    }
  }

  // Adds the light of the remaining pieces of line k between `from` and `to`, times `times`. Cuts by `but` do not
  // count.
  double light(std::uint32_t k, double from, double to, std::uint32_t but, float times) {
    inside_.clear();
    for (const GlintCut& cut : cuts_[k])
      if (cut.cutter != but && cut.to > from && cut.from < to) inside_.emplace_back(cut.from, cut.to);
    std::sort(inside_.begin(), inside_.end());
    const GlintLine& l = lines_[k];
    const std::size_t view = views_[k];
    double fell = 0, at = from;
    const auto piece = [&](double p, double q) {
      constexpr double kShortest = 1e-4;
      if (!(q - p > kShortest)) return;
      changes_.emplace_back(view, before_[view].pixels.size());
      fell += fields_[view].add_uncut(l.at(p), l.at(q), times, box_, before_[view]);
    };
    for (const auto& [p, q] : inside_) {
      piece(at, p);
      at = std::max(at, q);
    }
    piece(at, to);
    return fell;
  }

  // Removes line k: its cuts in other lines end, and their light returns.
  double take_out(std::uint32_t k) {
    double fell = light(k, 0, lines_[k].length, kNone, -1);
    theirs_.clear();
    forget_cuts_by(k, [&](std::uint32_t j, const GlintCut& cut) {
      theirs_.emplace_back(j, cut);
      fell += light(j, cut.from, cut.to, kNone, 1);
    });
    unlist(k);
    own_ = std::exchange(cuts_[k], {});
    return fell;
  }

  double put_in(std::uint32_t k, const GlintLine& line) {
    lines_[k] = line;
    meet(k, 0);
    list(k);
    double fell = light(k, 0, line.length, kNone, 1);
    for (const std::uint32_t j : cut_by_[k]) {
      const GlintCut cut = cuts_[j].back();
      fell += light(j, cut.from, cut.to, k, -1);
    }
    return fell;
  }

  // Restores line k after its removal, and perhaps after its insertion elsewhere. Pixels are restored separately.
  void put_back(std::uint32_t k, const GlintLine& line, bool was_put_in) {
    forget_cuts_by(k, [](std::uint32_t, const GlintCut&) {});
    if (was_put_in) unlist(k);
    lines_[k] = line;
    cuts_[k] = own_;
    for (const auto& [j, cut] : theirs_) add_cut(j, cut);
    list(k);
  }

  bool better(std::size_t row) {
    const std::uint32_t k = local_[row];
    const GlintLine old = lines_[k];
    const std::size_t view = views_[k];
    const Ends e = ends_of(scratches_, row);
    for (StrokePixelsBefore& before : before_) before.clear();
    changes_.clear();
    double fell = take_out(k);
    StrokeTrier& trier = triers_[view];
    Stroke now{e.a, e.b, 0, view};
    now = trier.best_instead(now, rules_.candidates);
    const bool found = now.a_mm != e.a || now.b_mm != e.b;
    if (found) fell += put_in(k, line(row, {now.a_mm, now.b_mm}, view));
    if (found && fell > kLeast) {
      set_ends(scratches_, row, {now.a_mm, now.b_mm});
      return true;
    }
    put_back(k, old, found);
    for (auto change = changes_.rbegin(); change != changes_.rend(); ++change)
      fields_[change->first].put_back(before_[change->first], change->second);
    return false;
  }

  std::vector<StrokeField>& fields_;
  const StrokeRules& rules_;
  const Metal& metal_;
  const BrightPlaces& places_;
  PixelBox box_;
  Scratches& scratches_;
  double margin_ = 0;
  CellsOfLines grid_;
  std::vector<std::vector<std::uint32_t>> cells_;
  std::vector<std::uint32_t> local_;  // index in this tile of each scratch
  std::vector<GlintLine> lines_;
  std::vector<std::size_t> views_;                  // for which each line is made
  std::vector<std::vector<GlintCut>> cuts_;         // for each line
  std::vector<std::vector<std::uint32_t>> cut_by_;  // for each line: the lines cut by it, now or earlier
  std::vector<std::uint32_t> seen_, near_;
  std::vector<GlintCut> own_;  // cuts in and by the last removed line
  std::vector<std::pair<std::uint32_t, GlintCut>> theirs_;
  std::uint32_t visit_ = 0;
  std::vector<std::pair<double, double>> inside_;
  std::vector<StrokePixelsBefore> before_;  // for each field
  // Field with changed pixels, and its number of earlier changes.
  std::vector<std::pair<std::size_t, std::size_t>> changes_;
  std::vector<StrokeTrier> triers_;
};

}  // namespace

std::vector<std::size_t> improve_cut(std::vector<StrokeField>& fields, const StrokeRules& rules, const Metal& metal,
                                     Scratches& scratches, const std::vector<std::size_t>& view, std::size_t movable,
                                     std::uint64_t seed, const std::function<bool()>& stop) {
  const BrightPlaces places = bright_places(scratches, metal.bench, metal.board);
  std::vector<char> changed(movable, 0);
  std::vector<std::size_t> mine(movable);
  for (std::size_t i = 0; i < movable; ++i) mine[i] = i;
  Stopping stopping(stop);
  const std::vector<Tiling> tilings = tilings_of_sweep(fields.front(), seed_of(seed, 0, 0, 0));
  // Strokes too long for these tiles come up in another sweep with other tiles.
  constexpr std::size_t kTilings = 2;
  for (std::size_t step = 0; step < std::min(kTilings, tilings.size()) && !mine.empty(); ++step) {
    const Tiling& tiling = tilings[step];
    std::vector<std::vector<std::size_t>> in_tile(tiling.size());
    std::vector<std::size_t> left;
    for (const std::size_t i : mine) {
      const std::size_t tile = tile_of(fields.front(), tiling, ends_of(scratches, i));
      (tile < tiling.size() ? in_tile[tile] : left).push_back(i);
    }
    const Scratches before = scratches;
    tbb::parallel_for(std::size_t{0}, tiling.size(), [&](std::size_t tile) {
      if (in_tile[tile].empty()) return;
      CutTile(fields, rules, metal, places, tiling.box(tile), before, view, seed_of(seed, 0, step + 1, tile), scratches)
          .run(in_tile[tile], changed, stopping);
    });
    mine = std::move(left);
  }
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < changed.size(); ++i)
    if (changed[i]) moved.push_back(i);
  return moved;
}

}  // namespace burin
