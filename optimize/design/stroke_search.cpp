#include "burin/optimize/design/stroke_search.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <queue>
#include <set>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/scattered.h"
#include "burin/optimize/design/random.h"
#include "burin/optimize/design/shown_light.h"
#include "burin/optimize/design/stroke_field.h"
#include "burin/optimize/design/stroke_neighbors.h"
#include "burin/optimize/design/stroke_sweep.h"
#include "burin/optimize/design/stroke_tiles.h"
#include "burin/optimize/design/stroke_tries.h"
#include "burin/optimize/toolpath/ends.h"

namespace burin {
namespace {

// Strokes between two calls of `stop`: a fraction of a millisecond.
constexpr std::size_t kAskEvery = 16;

}  // namespace

std::uint64_t seed_of(std::uint64_t seed, std::size_t view, std::size_t step, std::size_t tile) {
  std::uint64_t z = seed;
  for (const std::uint64_t part : {view, step, tile}) z = scattered(z + 0x9E3779B97F4A7C15ULL * (part + 1));
  return z;
}

namespace {

// Smallest side of the tiles, pixels. It is several strokes long, so most strokes fit into one, and small enough for
// the cache.
int tile_side(const StrokeField& field) {
  constexpr double kOfLongest = 0.6;
  constexpr unsigned kLeast = 64, kMost = 256;
  const auto wanted = static_cast<unsigned>(std::clamp(kOfLongest * field.longest_px(), 1.0, 1.0 * kMost));
  return static_cast<int>(std::clamp(std::bit_ceil(wanted), kLeast, kMost));
}

// Tiles with this side at a random offset.
Tiling tiling_of(const StrokeField& field, int side, SplitMix64& random) {
  const PixelBox whole = field.whole();
  Tiling tiling{side, 0, 0, whole.x1, whole.y1};
  if (side >= std::max(whole.x1, whole.y1)) return tiling;
  tiling.shift_x = static_cast<int>(random() % static_cast<unsigned>(side));
  tiling.shift_y = static_cast<int>(random() % static_cast<unsigned>(side));
  return tiling;
}

}  // namespace

std::vector<Tiling> tilings_of_sweep(const StrokeField& field, std::uint64_t seed) {
  const PixelBox whole = field.whole();
  const int size = std::max(whole.x1, whole.y1), most = kMostWindowPixels / std::max(1, whole.x1);
  SplitMix64 random(seed);
  std::vector<Tiling> tilings;
  int side = std::min(tile_side(field), std::max(1, most));
  tilings.push_back(tiling_of(field, side, random));
  if (side >= size) return tilings;
  Tiling again = tilings.front();
  again.shift_x = (again.shift_x + side / 2) % side;
  again.shift_y = (again.shift_y + side / 2) % side;
  tilings.push_back(again);
  while (side < std::min(size, most)) {
    side = std::min(2 * side, std::min(size, most));
    tilings.push_back(tiling_of(field, side, random));
  }
  return tilings;
}

std::size_t tile_of(const StrokeField& field, const Tiling& tiling, const Ends& e) {
  const Eigen::Vector2d a = field.pixel(e.a), b = field.pixel(e.b);
  const auto in = [&](const Eigen::Vector2d& p) {
    return p.x() >= 0 && p.y() >= 0 && p.x() < tiling.width && p.y() < tiling.height;
  };
  if (!in(a) || !in(b)) return tiling.size();
  const std::size_t tile = tiling.tile_of(static_cast<int>(a.x()), static_cast<int>(a.y()));
  return tile == tiling.tile_of(static_cast<int>(b.x()), static_cast<int>(b.y())) ? tile : tiling.size();
}

namespace {

// One view's part of a sweep.
class ViewSweep {
 public:
  ViewSweep(StrokeField& field, const StrokeRules& rules, Scratches& scratches, std::vector<char>& changed)
      : field_(field), rules_(rules), scratches_(scratches), changed_(changed) {}

  void run(std::vector<std::size_t> mine, std::uint64_t seed, std::size_t view, Stopping& stop) {
    const std::vector<Tiling> tilings = tilings_of_sweep(field_, seed_of(seed, view, 0, 0));
    for (std::size_t step = 0; step < tilings.size() && !mine.empty(); ++step) {
      const Tiling& tiling = tilings[step];
      std::vector<std::vector<std::size_t>> in_tile(tiling.size());
      std::vector<std::size_t> left;
      for (const std::size_t i : mine) {
        const std::size_t tile = tile_of(field_, tiling, ends_of(scratches_, i));
        (tile < tiling.size() ? in_tile[tile] : left).push_back(i);
      }
      tbb::parallel_for(std::size_t{0}, tiling.size(), [&](std::size_t tile) {
        if (!in_tile[tile].empty()) in_box(tiling.box(tile), in_tile[tile], seed_of(seed, view, step + 1, tile), stop);
      });
      mine = std::move(left);
    }
  }

 private:
  void in_box(const PixelBox& box, std::vector<std::size_t>& mine, std::uint64_t seed, Stopping& stop) {
    constexpr std::size_t kSurveyEvery = 1000;
    StrokeTrier trier(field_, rules_, box, seed);
    for (std::size_t k = mine.size(); k > 1; --k) std::swap(mine[k - 1], mine[trier.random()() % k]);
    std::vector<Eigen::Vector2f> ends;
    for (const std::size_t i : mine) {
      const Ends e = ends_of(scratches_, i);
      ends.push_back(field_.pixel(e.a).cast<float>());
      ends.push_back(field_.pixel(e.b).cast<float>());
    }
    StrokeNeighbors neighbors(box, std::move(ends));
    std::vector<char> tried(mine.size(), 0);
    for (std::size_t k = 0; k < mine.size(); ++k) {
      if (k % (kAskEvery / 2) == 0 && stop()) break;  // two at a time
      if (k % kSurveyEvery == 0) trier.survey();
      if (tried[k]) continue;
      const std::size_t other = neighbors.nearest(2 * k + (trier.random()() & 1U));
      tried[k] = tried[other] = 1;
      const std::array<std::size_t, 2> pair{k, other};
      std::array<Stroke, 2> now{stroke(mine[k]), stroke(mine[other])};
      if (!(other == k ? better(now[0], trier) : better(now, trier))) continue;
      for (std::size_t n = 0; n < (other == k ? 1U : 2U); ++n) {
        if (same(now[n], stroke(mine[pair[n]]))) continue;
        changed_[mine[pair[n]]] = 1;
        set_ends(scratches_, mine[pair[n]], {now[n].a_mm, now[n].b_mm});
        neighbors.move(pair[n], field_.pixel(now[n].a_mm).cast<float>(), field_.pixel(now[n].b_mm).cast<float>());
      }
    }
  }

  Stroke stroke(std::size_t i) const {
    const Ends e = ends_of(scratches_, i);
    return {e.a, e.b, 0, 0};
  }

  // Replaces a stroke by the best of several candidates; false: it stays.
  bool better(Stroke& stroke, StrokeTrier& trier) {
    trier.before().clear();
    // The increase of the error without the stroke is its marginal contribution, which a better stroke has to beat.
    stroke.gain = -field_.add(stroke.a_mm, stroke.b_mm, -1, trier.box(), &trier.before());
    const Stroke best = trier.best_instead(stroke, rules_.candidates);
    if (same(best, stroke)) {
      field_.put_back(trier.before());
      return false;
    }
    field_.add(best.a_mm, best.b_mm, 1, trier.box());
    stroke = best;
    return true;
  }

  // Replaces two touching strokes: if one ends at the start of the other, neither can move alone.
  bool better(std::array<Stroke, 2>& pair, StrokeTrier& trier) {
    trier.before().clear();
    double fell = 0;
    for (const std::size_t n : {1U, 0U}) {
      const double f = field_.add(pair[n].a_mm, pair[n].b_mm, -1, trier.box(), &trier.before());
      pair[n].gain = -f;
      fell += f;
    }
    const Stroke first = trier.best_instead(pair[0], rules_.candidates);
    fell += field_.add(first.a_mm, first.b_mm, 1, trier.box(), &trier.before());
    const bool stays = same(first, pair[0]);
    if (!stays) pair[1].gain = field_.fall(pair[1].a_mm, pair[1].b_mm, 1);
    const Stroke second = trier.best_instead(pair[1], rules_.candidates);
    if (!(stays && same(second, pair[1]))) {
      fell += field_.add(second.a_mm, second.b_mm, 1, trier.box(), &trier.before());
      if (fell > 1e-9) {
        pair = {first, second};
        return true;
      }
    }
    field_.put_back(trier.before());
    return false;
  }

  static bool same(const Stroke& a, const Stroke& b) { return a.a_mm == b.a_mm && a.b_mm == b.b_mm; }

  StrokeField& field_;
  const StrokeRules& rules_;
  Scratches& scratches_;
  std::vector<char>& changed_;
};

// Places up to `count` strokes in one view, distributed over tiles by missing light; returns them tile by tile.
std::vector<Stroke> place_in_view(StrokeField& field, const StrokeRules& rules, std::size_t view, std::size_t count,
                                  std::uint64_t seed, Stopping& stop) {
  constexpr int kTries = 20;  // failures of all candidates, after which a tile is full
  SplitMix64 random(seed);
  const int most = std::max(1, kMostWindowPixels / std::max(1, field.whole().x1));
  const Tiling tiling = tiling_of(field, std::min(tile_side(field), most), random);
  std::vector<double> missing(tiling.size());
  tbb::parallel_for(std::size_t{0}, tiling.size(),
                    [&](std::size_t tile) { missing[tile] = field.missing_in(tiling.box(tile)); });
  const std::vector<std::size_t> wanted = shared_out(count, missing, uniform(random));
  std::vector<std::vector<Stroke>> placed(tiling.size());
  tbb::parallel_for(std::size_t{0}, tiling.size(), [&](std::size_t tile) {
    if (wanted[tile] == 0) return;
    StrokeTrier trier(field, rules, tiling.box(tile), seed_of(seed, view, 1, tile));
    trier.survey();
    for (int failures = 0; placed[tile].size() < wanted[tile] && failures < kTries && trier.misses_anything();) {
      if (placed[tile].size() % kAskEvery == 0 && stop()) break;
      Stroke best = trier.best_anywhere(rules.candidates);
      best.gain = best.gain > 0 ? field.add(best.a_mm, best.b_mm, 1, trier.box()) : 0;
      best.view = view;
      if (best.gain > 0)
        placed[tile].push_back(best);
      else
        ++failures;
    }
  });
  std::vector<Stroke> all;
  for (const auto& strokes : placed) all.insert(all.end(), strokes.begin(), strokes.end());
  return all;
}

}  // namespace

Image measure_units(ViewRenderer& renderer, const GlintView& glint, const Eigen::Vector2d& min_mm,
                    const Eigen::Vector2d& max_mm, const std::function<Carved(const Scratches&)>& carve) {
  constexpr int kLattice = 33;
  const int width = renderer.width(), height = renderer.height();
  const double length = 3 * std::max((max_mm.x() - min_mm.x()) / width, (max_mm.y() - min_mm.y()) / height);
  const double margin = 0.5 * length / (max_mm - min_mm).minCoeff();
  Scratches tests;
  for (int j = 0; j < kLattice; ++j)
    for (int i = 0; i < kLattice; ++i) {
      const auto at = [&](int k) { return margin + (1 - 2 * margin) * k / (kLattice - 1.0); };
      const Eigen::Vector2d p(min_mm.x() + at(i) * (max_mm.x() - min_mm.x()),
                              max_mm.y() - at(j) * (max_mm.y() - min_mm.y()));
      const double direction = lean_at(glint, {p.x(), p.y(), 0}).scratch_direction();
      const Eigen::Vector2d half = length / 2 * Eigen::Vector2d(std::cos(direction), std::sin(direction));
      tests.x0_mm.push_back(p.x() - half.x());
      tests.y0_mm.push_back(p.y() - half.y());
      tests.x1_mm.push_back(p.x() + half.x());
      tests.y1_mm.push_back(p.y() + half.y());
    }
  Image radiance;
  renderer.forward_with_jacobian(carve(tests), radiance);
  std::vector<double> light(tests.size(), 0.0);
  renderer.add_contributions(light);
  Image lattice(kLattice, kLattice, 1), unit(width, height, 1);
  for (std::size_t k = 0; k < light.size(); ++k) lattice.data[k] = static_cast<float>(std::max(0.0, light[k]) / length);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = std::clamp((x + 0.5) / width, 0.0, 1.0) * (kLattice - 1);
      const double v = std::clamp((y + 0.5) / height, 0.0, 1.0) * (kLattice - 1);
      const int i = std::min(kLattice - 2, static_cast<int>(u)), j = std::min(kLattice - 2, static_cast<int>(v));
      const auto fu = static_cast<float>(u - i), fv = static_cast<float>(v - j);
      unit.at(x, y) = (1 - fv) * ((1 - fu) * lattice.at(i, j) + fu * lattice.at(i + 1, j)) +
                      fv * ((1 - fu) * lattice.at(i, j + 1) + fu * lattice.at(i + 1, j + 1));
    }
  return unit;
}

namespace {

void share_pictures(std::vector<StrokeField>& fields) {
  for (std::size_t a = 0; a < fields.size(); ++a)
    for (std::size_t b = a + 1; b < fields.size(); ++b) fields[a].share_pictures_with(fields[b]);
}

}  // namespace

std::vector<StrokeField> stroke_fields(const std::vector<StrokeView>& views, const StrokeRules& rules) {
  std::vector<StrokeField> fields;
  fields.reserve(views.size());
  for (const StrokeView& view : views) fields.emplace_back(view, rules);
  share_pictures(fields);
  return fields;
}

std::vector<StrokeField> stroke_fields(std::vector<StrokeView>&& views, const StrokeRules& rules) {
  std::vector<StrokeField> fields;
  fields.reserve(views.size());
  for (StrokeView& view : views) {
    fields.emplace_back(view, rules);
    view = {};
  }
  share_pictures(fields);
  return fields;
}

std::vector<std::vector<std::size_t>> field_groups(const std::vector<StrokeField>& fields) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t v = 0; v < fields.size(); ++v) {
    std::vector<std::size_t> mine;  // with all connected groups
    const auto tied = [&](const std::vector<std::size_t>& group) {
      return std::any_of(group.begin(), group.end(),
                         [&](std::size_t w) { return fields[v].shares_pictures_with(fields[w]); });
    };
    std::vector<std::vector<std::size_t>> others;
    for (std::vector<std::size_t>& group : groups)
      if (tied(group))
        mine.insert(mine.end(), group.begin(), group.end());
      else
        others.push_back(std::move(group));
    mine.push_back(v);
    others.push_back(std::move(mine));
    groups = std::move(others);
  }
  return groups;
}

std::vector<std::size_t> views_of(const std::vector<StrokeField>& fields, const Scratches& scratches) {
  std::vector<std::size_t> view(scratches.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scratches.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Ends e = ends_of(scratches, i);
      const Eigen::Vector2d m = (e.a + e.b) / 2, u = (e.b - e.a).normalized();
      double least = 0;
      for (std::size_t v = 0; v < fields.size(); ++v) {
        const double q = std::abs(fields[v].lobe_place(m, u));
        if (v > 0 && q >= least) continue;
        least = q;
        view[i] = v;
      }
    }
  });
  return view;
}

std::vector<Stroke> place_in(std::vector<StrokeField>& fields, const StrokeRules& rules, std::size_t count,
                             std::uint64_t seed, const std::function<bool()>& stop) {
  if (fields.empty()) fail("stroke search", "there are no views", "give at least one");
  const std::size_t n = fields.size();
  // Enough rounds for a competition between views, and for new tilings.
  const std::size_t rounds = std::clamp<std::size_t>(count / (100 * n), 8, 40);
  std::vector<double> marginal(n, 1.0);  // gain of a stroke in the last round
  std::vector<Stroke> all;
  Stopping stopping(stop);
  const std::vector<std::vector<std::size_t>> groups = field_groups(fields);
  for (std::size_t round = 0; round < 2 * rounds && all.size() < count && !stopping(); ++round) {
    const std::size_t more = std::max<std::size_t>(1, rounds - std::min(round, rounds));
    const std::vector<std::size_t> wanted = shared_out((count - all.size() + more - 1) / more, marginal, 0.5);
    std::vector<std::vector<Stroke>> placed(n);
    tbb::parallel_for(std::size_t{0}, groups.size(), [&](std::size_t g) {
      for (const std::size_t v : groups[g]) {
        if (wanted[v] == 0) continue;
        placed[v] = place_in_view(fields[v], rules, v, wanted[v], seed_of(seed, v, round, 0), stopping);
        double gained = 0;
        for (const Stroke& s : placed[v]) gained += s.gain;
        // A view with few successful strokes is nearly full.
        marginal[v] = gained / static_cast<double>(wanted[v]);
      }
    });
    for (const auto& strokes : placed) all.insert(all.end(), strokes.begin(), strokes.end());
  }
  return all;
}

std::vector<std::size_t> improve_in(std::vector<StrokeField>& fields, const StrokeRules& rules, Scratches& scratches,
                                    const std::vector<std::size_t>& view, std::size_t movable, std::uint64_t seed,
                                    const std::function<bool()>& stop) {
  std::vector<char> changed(movable, 0);
  std::vector<std::vector<std::size_t>> mine(fields.size());
  for (std::size_t i = 0; i < movable; ++i) mine[view[i]].push_back(i);
  Stopping stopping(stop);
  const std::vector<std::vector<std::size_t>> groups = field_groups(fields);
  tbb::parallel_for(std::size_t{0}, groups.size(), [&](std::size_t g) {
    for (const std::size_t v : groups[g])
      ViewSweep(fields[v], rules, scratches, changed).run(std::move(mine[v]), seed, v, stopping);
  });
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < changed.size(); ++i)
    if (changed[i]) moved.push_back(i);
  return moved;
}

std::vector<double> worth_in(const std::vector<StrokeField>& fields, const Scratches& scratches,
                             const std::vector<std::size_t>& view) {
  std::vector<double> worth(scratches.size(), 0.0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scratches.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Ends e = ends_of(scratches, i);
      worth[i] = -fields[view[i]].fall(e.a, e.b, -1);
    }
  });
  return worth;
}

std::vector<Stroke> place_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, std::size_t count,
                                  std::uint64_t seed, const std::function<bool()>& stop) {
  std::vector<StrokeField> fields = stroke_fields(views, rules);
  std::vector<Stroke> strokes = place_in(fields, rules, count, seed, stop);
  for (std::size_t v = 0; v < views.size(); ++v) fields[v].write_light(views[v]);
  return strokes;
}

std::vector<std::size_t> improve_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, Scratches& scratches,
                                         std::size_t movable, std::uint64_t seed, const std::function<bool()>& stop) {
  std::vector<StrokeField> fields = stroke_fields(views, rules);
  const std::vector<std::size_t> view = views_of(fields, scratches);
  std::vector<std::size_t> moved = improve_in(fields, rules, scratches, view, movable, seed, stop);
  for (std::size_t v = 0; v < views.size(); ++v) fields[v].write_light(views[v]);
  return moved;
}

namespace {

// Error of the pictures whose numbers are not in `counted`; the function adds them.
double squared_error(const StrokeView& view, std::set<int>& counted) {
  double sum = 0;
  const auto add = [&](const Image& light, const Image& target, const Image& mask, double weight, int picture) {
    if (picture >= 0 && !counted.insert(picture).second) return;
    sum += weight * tbb::parallel_deterministic_reduce(
                        tbb::blocked_range<std::size_t>(0, light.data.size(), 16384), 0.0,
                        [&](const auto& range, double part) {
                          for (std::size_t i = range.begin(); i < range.end(); ++i) {
                            const double m = mask.data.empty() ? 1 : mask.data[i];
                            const double d = m * (shown_light(light.data[i]) - target.data[i]);
                            part += d * d;
                          }
                          return part;
                        },
                        std::plus<>());
  };
  add(view.light, view.target, view.mask, view.weight, view.picture);
  for (const StrokeAside& aside : view.asides)
    add(aside.light, aside.target.data.empty() ? view.target : aside.target, aside.mask ? *aside.mask : view.mask,
        aside.weight, aside.picture);
  return sum;
}

}  // namespace

double squared_error(const StrokeView& view) {
  std::set<int> counted;
  return squared_error(view, counted);
}

double squared_error(const std::vector<StrokeView>& views) {
  double sum = 0;
  std::set<int> counted;
  for (const StrokeView& v : views) sum += squared_error(v, counted);
  return sum;
}

std::vector<double> worth_of(std::vector<StrokeView> views, const StrokeRules& rules, const Scratches& scratches) {
  const std::vector<StrokeField> fields = stroke_fields(std::move(views), rules);
  return worth_in(fields, scratches, views_of(fields, scratches));
}

std::vector<std::size_t> spare_order(std::vector<StrokeView> views, const StrokeRules& rules,
                                     const Scratches& scratches, std::size_t movable, const std::vector<double>& cost,
                                     const std::function<bool(std::size_t, double)>& spare) {
  std::vector<StrokeField> fields = stroke_fields(std::move(views), rules);
  const std::vector<std::size_t> view = views_of(fields, scratches);
  const std::vector<double> first = worth_in(fields, scratches, view);
  const auto price = [&](std::size_t i, double w) { return cost.empty() ? w : w / cost[i]; };
  // Marginal contributions mostly grow when neighbors disappear, so an old value is updated before it counts (lazy
  // greedy).
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::size_t i = 0; i < movable; ++i) queue.emplace(price(i, first[i]), i);
  std::vector<std::size_t> order;
  while (!queue.empty()) {
    const auto [old, i] = queue.top();
    queue.pop();
    const Ends e = ends_of(scratches, i);
    const double now = -fields[view[i]].fall(e.a, e.b, -1), priced = price(i, now);
    if (!queue.empty() && priced > queue.top().first) {
      queue.emplace(priced, i);
      continue;
    }
    if (!spare(i, now)) break;
    fields[view[i]].add(e.a, e.b, -1, fields[view[i]].whole());
    order.push_back(i);
  }
  return order;
}

namespace {

void change_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                    const std::vector<std::size_t>& which, float times) {
  std::vector<StrokeField> fields = stroke_fields(views, rules);
  const std::vector<std::size_t> view = views_of(fields, scratches);
  for (const std::size_t i : which) {
    const Ends e = ends_of(scratches, i);
    fields[view[i]].add(e.a, e.b, times, fields[view[i]].whole());
  }
  for (std::size_t v = 0; v < views.size(); ++v) fields[v].write_light(views[v]);
}

}  // namespace

void lift_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                  const std::vector<std::size_t>& which) {
  change_strokes(views, rules, scratches, which, -1);
}

void add_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                 const std::vector<std::size_t>& which) {
  change_strokes(views, rules, scratches, which, 1);
}

}  // namespace burin
