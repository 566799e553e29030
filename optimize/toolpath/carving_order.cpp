#include "burin/optimize/toolpath/carving_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <random>
#include <utility>

namespace burin {
namespace {

using End = std::int32_t;  // end e of scratch s is 2 s + e; its other end is End ^ 1

/// The ends of all scratches on a grid of cells with about two each.
class EndGrid {
 public:
  explicit EndGrid(const std::vector<Eigen::Vector2d>& ends) : ends_(ends) {
    Eigen::Vector2d high = ends.front();
    low_ = high;
    for (const Eigen::Vector2d& p : ends) low_ = low_.cwiseMin(p), high = high.cwiseMax(p);
    const Eigen::Vector2d size = (high - low_).cwiseMax(1e-6);
    cell_mm_ = std::max(std::sqrt(size.x() * size.y() * 2 / static_cast<double>(ends.size())), size.maxCoeff() / 4000);
    columns_ = static_cast<int>(size.x() / cell_mm_) + 1;
    rows_ = static_cast<int>(size.y() / cell_mm_) + 1;
    cells_.resize(static_cast<std::size_t>(columns_) * rows_);
    for (std::size_t i = 0; i < ends.size(); ++i) cells_[cell_of(ends[i])].push_back(static_cast<End>(i));
  }

  void remove(End end) {
    std::vector<End>& cell = cells_[cell_of(ends_[end])];
    cell.erase(std::find(cell.begin(), cell.end(), end));
  }

  /// The `count` ends nearest to p among those accepted by `wanted`, nearest first; equally near ones by number.
  template <typename Wanted>
  void nearest(const Eigen::Vector2d& p, std::size_t count, Wanted wanted,
               std::vector<std::pair<double, End>>& found) const {
    found.clear();
    const auto [column, row] = place(p);
    const int last_ring = std::max({column, columns_ - 1 - column, row, rows_ - 1 - row});
    for (int ring = 0; ring <= last_ring; ++ring) {
      // Cells of this ring are at least ring - 1 whole cells away (p may lie outside of the grid: then farther).
      const double nearest_possible_mm = (ring - 1) * cell_mm_;
      if (found.size() == count && found.back().first <= nearest_possible_mm) break;
      for_ring(column, row, ring, [&](const std::vector<End>& cell) {
        for (const End end : cell) {
          if (!wanted(end)) continue;
          const std::pair<double, End> candidate{(ends_[end] - p).norm(), end};
          if (found.size() == count && candidate >= found.back()) continue;
          found.insert(std::upper_bound(found.begin(), found.end(), candidate), candidate);
          if (found.size() > count) found.pop_back();
        }
      });
    }
  }

 private:
  std::pair<int, int> place(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d cell = (p - low_) / cell_mm_;
    return {std::clamp(static_cast<int>(std::floor(cell.x())), 0, columns_ - 1),
            std::clamp(static_cast<int>(std::floor(cell.y())), 0, rows_ - 1)};
  }

  std::size_t cell_of(const Eigen::Vector2d& p) const {
    const auto [column, row] = place(p);
    return static_cast<std::size_t>(row) * columns_ + column;
  }

  template <typename Visit>
  void for_ring(int column, int row, int ring, Visit visit) const {
    for (int r = std::max(0, row - ring); r <= std::min(rows_ - 1, row + ring); ++r) {
      const bool whole_row = std::abs(r - row) == ring;
      const int step = whole_row || ring == 0 ? 1 : 2 * ring;
      for (int c = column - ring; c <= column + ring; c += step)
        if (c >= 0 && c < columns_) visit(cells_[static_cast<std::size_t>(r) * columns_ + c]);
    }
  }

  const std::vector<Eigen::Vector2d>& ends_;
  Eigen::Vector2d low_;
  double cell_mm_ = 1;
  int columns_ = 1, rows_ = 1;
  std::vector<std::vector<End>> cells_;
};

/// A closed tour of n scratches and the start. The start's end 1 is the tool's first position, its end 0 the end of the
/// tour. Stored as an array of entering ends; a 2-opt move reverses a run of it.
class Tour {
 public:
  Tour(const Scratches& scratches, const CarvingOrderOptions& options) : return_to_start_(options.return_to_start) {
    const std::size_t n = scratches.size();
    ends_.reserve(2 * n + 2);
    for (std::size_t i = 0; i < n; ++i) {
      ends_.emplace_back(scratches.x0_mm[i], scratches.y0_mm[i]);
      ends_.emplace_back(scratches.x1_mm[i], scratches.y1_mm[i]);
    }
    finish_ = static_cast<End>(2 * n);
    ends_.push_back(options.start_mm);
    ends_.push_back(options.start_mm);
    position_.resize(n + 1);
  }

  const std::vector<Eigen::Vector2d>& ends() const { return ends_; }
  End start() const { return finish_ + 1; }
  End finish() const { return finish_; }
  int size() const { return static_cast<int>(order_.size()); }

  void set_order(std::vector<End> entering) {
    order_ = std::move(entering);
    for (int i = 0; i < size(); ++i) position_[order_[i] >> 1] = i;
  }

  const std::vector<End>& order() const { return order_; }

  double distance(End a, End b) const {
    if (!return_to_start_ && (a == finish_ || b == finish_)) return 0;  // the tour may end anywhere
    return (ends_[a] - ends_[b]).norm();
  }

  bool is_entering(End end) const { return order_[position_[end >> 1]] == end; }

  /// The end before or after this one in the air.
  End partner(End end) const {
    const int i = position_[end >> 1];
    return order_[i] == end ? order_[i == 0 ? size() - 1 : i - 1] ^ 1 : order_[i + 1 == size() ? 0 : i + 1];
  }

  /// Cyclic distance of two ends in the order: about the cost of a move that joins them.
  int steps_between(End a, End b) const {
    const int steps = std::abs(position_[a >> 1] - position_[b >> 1]);
    return std::min(steps, size() - steps);
  }

  /// Ways a-b and c-d in the air become a-c and b-d. a and c must both be entering or both be leaving.
  void two_opt(End a, End b, End c, End d) {
    if (is_entering(a))
      reverse(position_[a >> 1], position_[d >> 1]);
    else
      reverse(position_[b >> 1], position_[c >> 1]);
  }

 private:
  /// Reverses positions first..last, cyclic, or the complement: the same closed tour with fewer steps.
  void reverse(int first, int last) {
    const int n = size();
    int length = last - first + 1;
    if (length <= 0) length += n;
    if (2 * length > n) {
      std::swap(first, last);
      if (++first == n) first = 0;
      if (--last < 0) last = n - 1;
      length = n - length;
    }
    for (int k = 0; k < length / 2; ++k) {
      const End a = order_[first] ^ 1, b = order_[last] ^ 1;
      order_[first] = b, position_[b >> 1] = first;
      order_[last] = a, position_[a >> 1] = last;
      if (++first == n) first = 0;
      if (--last < 0) last = n - 1;
    }
    if (length % 2 != 0) order_[first] ^= 1;
  }

  bool return_to_start_;
  End finish_ = 0;
  std::vector<Eigen::Vector2d> ends_;
  std::vector<End> order_;
  std::vector<int> position_;
};

/// Greedy tour: from the start always to the nearest remaining end.
std::vector<End> greedy_order(const Tour& tour, const Progress& progress) {
  const std::size_t n = tour.ends().size() / 2 - 1;
  std::vector<Eigen::Vector2d> ends(tour.ends().begin(), tour.ends().end() - 2);
  EndGrid grid(ends);
  std::vector<End> order{tour.finish()};
  order.reserve(n + 1);
  Eigen::Vector2d at = tour.ends()[tour.start()];
  std::vector<std::pair<double, End>> found;
  for (std::size_t i = 0; i < n; ++i) {
    if (progress && i % 4096 == 0)
      progress("ordering scratches", 0.1 * static_cast<double>(i) / static_cast<double>(n));
    grid.nearest(
        at, 1, [](End) { return true; }, found);
    const End entering = found.front().second;
    grid.remove(entering);
    grid.remove(entering ^ 1);
    order.push_back(entering);
    at = ends[entering ^ 1];
  }
  return order;
}

/// 2-opt and Or-opt until neither shortens the tour.
class Improvement {
 public:
  Improvement(Tour& tour, int neighbors, const std::function<bool()>& stop) : tour_(tour), k_(neighbors), stop_(stop) {
    const std::size_t count = tour.ends().size() - 2;
    const std::vector<Eigen::Vector2d> ends(tour.ends().begin(), tour.ends().end() - 2);
    const EndGrid grid(ends);
    neighbors_.assign((count + 2) * k_, -1);
    std::vector<std::pair<double, End>> found;
    const auto look_up = [&](End end) {
      grid.nearest(
          tour.ends()[end], static_cast<std::size_t>(k_), [&](End other) { return other >> 1 != end >> 1; }, found);
      for (std::size_t k = 0; k < found.size(); ++k)
        neighbors_[static_cast<std::size_t>(end) * k_ + k] = found[k].second;
    };
    for (std::size_t i = 0; i < count; ++i) look_up(static_cast<End>(i));
    look_up(tour.start());
    waiting_.assign(count + 2, false);
  }

  void run(const Progress& progress) {
    for (const End entering : tour_.order()) enqueue(entering), enqueue(entering ^ 1);
    work_off_queue(progress);
  }

  /// Swaps two short neighboring runs at random, improves around them, and reverts everything unless the tour became
  /// shorter. This escapes local optima.
  void kick(std::size_t kicks, const Progress& progress) {
    const int n = tour_.size();
    if (n < 8) return;
    std::mt19937_64 random(1);  // fixed: the same scratches give the same order
    const auto below = [&random](int limit) { return static_cast<int>(random() % static_cast<std::uint64_t>(limit)); };
    const int longest = std::min(50, n / 3 - 1);
    // Reversing longer runs, and reverting, would cost more than it finds
    most_steps_ = std::max(1000, 50'000'000 / n);
    for (std::size_t k = 0; k < kicks; ++k) {
      if (k % 256 == 0 && stop_ && stop_()) return;
      if (progress && k % 16384 == 0)
        progress("ordering scratches", 0.2 + 0.8 * static_cast<double>(k) / static_cast<double>(kicks));
      const int first = below(n), first_run = 1 + below(longest), second_run = 1 + below(longest);
      const auto at = [&](int i) { return tour_.order()[i % n]; };
      const End u = at(first), w = at(first + first_run - 1) ^ 1, after = at(first + first_run);
      const End c = at(first + first_run + second_run - 1) ^ 1;
      const End before = tour_.partner(u), pc = tour_.partner(c);
      done_.clear();
      gain_mm_ = tour_.distance(before, u) + tour_.distance(w, after) + tour_.distance(c, pc) -
                 tour_.distance(before, after) - tour_.distance(c, u) - tour_.distance(w, pc);
      move_run(u, w, before, after, c, pc, true);
      for (const End end : {u, w, before, after, c, pc}) enqueue(end);
      work_off_queue({});
      if (gain_mm_ >= 0) continue;
      for (auto move = done_.rbegin(); move != done_.rend(); ++move)
        tour_.two_opt((*move)[0], (*move)[2], (*move)[1], (*move)[3]);
    }
  }

 private:
  void work_off_queue(const Progress& progress) {
    for (std::size_t done = 0; !queue_.empty(); ++done) {
      if (done % 1024 == 1023 && stop_ && stop_()) return;
      if (progress && done % 16384 == 0)
        progress("ordering scratches",
                 0.1 + 0.1 * static_cast<double>(done) / static_cast<double>(done + queue_.size()));
      const End end = queue_.front();
      queue_.pop_front();
      waiting_[end] = false;
      while (two_opt_at(end) || or_opt_at(end)) {
      }
    }
  }

  static constexpr double kLeastGain_mm = 1e-7;  // below it rounding could make moves go in circles
  static constexpr int kLongestRun = 3;

  void enqueue(End end) {
    if (waiting_[end]) return;
    waiting_[end] = true;
    queue_.push_back(end);
  }

  bool two_opt_at(End a) {
    const End b = tour_.partner(a);
    const double ab = tour_.distance(a, b);
    for (int k = 0; k < k_; ++k) {
      const End c = neighbors_[static_cast<std::size_t>(a) * k_ + k];
      if (c < 0) break;
      const double ac = tour_.distance(a, c);
      if (ac >= ab) break;  // one of the two new ways must be shorter than the old one at its end; b has its own turn
      if (tour_.is_entering(a) != tour_.is_entering(c)) continue;
      const End d = tour_.partner(c);
      if (c == b || d == a) continue;
      if (tour_.steps_between(a, c) > most_steps_) continue;
      const double gain = ab + tour_.distance(c, d) - ac - tour_.distance(b, d);
      if (gain < kLeastGain_mm) continue;
      gain_mm_ += gain;
      two_opt(a, b, c, d);
      for (const End end : {a, b, c, d}) enqueue(end);
      return true;
    }
    return false;
  }

  /// Removes the run of one to three scratches that begins at end u, and inserts it between one of u's neighbors c and
  /// c's partner.
  bool or_opt_at(End u) {
    const End before = tour_.partner(u);
    const bool u_entering = tour_.is_entering(u);
    End w = u ^ 1;  // the run's other end
    for (int length = 1; length <= kLongestRun && length + 2 <= tour_.size(); ++length) {
      const End after = tour_.partner(w);
      const double taken_out = tour_.distance(before, u) + tour_.distance(w, after) - tour_.distance(before, after);
      for (int k = 0; k < k_ && taken_out > 0; ++k) {
        const End c = neighbors_[static_cast<std::size_t>(u) * k_ + k];
        if (c < 0) break;
        const double uc = tour_.distance(u, c);
        const End pc = tour_.partner(c);
        if (tour_.steps_between(u, c) > most_steps_) continue;
        if (in_run(u, w, c, length) || in_run(u, w, pc, length)) continue;
        const double gain = taken_out + tour_.distance(c, pc) - uc - tour_.distance(w, pc);
        if (gain < kLeastGain_mm) continue;
        gain_mm_ += gain;
        move_run(u, w, before, after, c, pc, u_entering);
        for (const End end : {u, w, before, after, c, pc}) enqueue(end);
        return true;
      }
      w = after ^ 1;
      if (after >> 1 == before >> 1) break;
    }
    return false;
  }

  /// True if an end belongs to one of the `length` scratches from u's to w's.
  bool in_run(End u, End w, End end, int length) const {
    End at = u;
    for (int i = 0; i < length; ++i) {
      if (at >> 1 == end >> 1) return true;
      if (at >> 1 == w >> 1) break;
      at = tour_.partner(at ^ 1);
    }
    return false;
  }

  /// before-u..w-after and c-pc become before-after and c-u..w-pc: two or three moves of 2-opt.
  void move_run(End u, End w, End before, End after, End c, End pc, bool u_entering) {
    if (u_entering != tour_.is_entering(c)) {
      two_opt(before, u, c, pc);
      two_opt(before, c, after, w);
      two_opt(c, w, u, pc);
    } else {
      two_opt(before, u, pc, c);
      two_opt(before, pc, after, w);
    }
  }

  void two_opt(End a, End b, End c, End d) {
    tour_.two_opt(a, b, c, d);
    done_.push_back({a, b, c, d});
  }

  Tour& tour_;
  int k_;
  const std::function<bool()>& stop_;
  std::vector<End> neighbors_;
  std::vector<bool> waiting_;
  std::deque<End> queue_;
  int most_steps_ = std::numeric_limits<int>::max();
  std::vector<std::array<End, 4>> done_;  // moves since the last kick, for a revert
  double gain_mm_ = 0;                    // their sum
};

}  // namespace

std::vector<CarvingStep> carving_order(const Scratches& scratches, const CarvingOrderOptions& options,
                                       const Progress& progress) {
  if (scratches.size() == 0) return {};
  Tour tour(scratches, options);
  tour.set_order(greedy_order(tour, progress));
  Improvement improvement(tour, options.neighbors, options.stop);
  improvement.run(progress);
  improvement.kick(static_cast<std::size_t>(std::max(0, options.kicks_per_scratch)) * scratches.size(), progress);

  // Reads the closed tour from the start, in the direction that leaves it at its end 1.
  std::vector<CarvingStep> steps;
  steps.reserve(scratches.size());
  End leaving = tour.start();
  for (std::size_t i = 0; i < scratches.size(); ++i) {
    const End entering = tour.partner(leaving);
    steps.push_back({static_cast<std::uint32_t>(entering >> 1), (entering & 1) != 0});
    leaving = entering ^ 1;
  }
  return steps;
}

bool order_matters(const Bench& bench) {
  return bench.crossings == Crossings::last || bench.depth_field.wear() != 0 || bench.alpha_field.wear() != 0;
}

std::vector<CarvingStep> file_order(const Scratches& scratches) {
  std::vector<CarvingStep> steps(scratches.size());
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i].scratch = static_cast<std::uint32_t>(i);
  return steps;
}

double travel_mm(const Scratches& scratches, const std::vector<CarvingStep>& order,
                 const CarvingOrderOptions& options) {
  Eigen::Vector2d at = options.start_mm;
  double sum = 0;
  for (const CarvingStep& step : order) {
    const std::size_t i = step.scratch;
    Eigen::Vector2d from(scratches.x0_mm[i], scratches.y0_mm[i]), to(scratches.x1_mm[i], scratches.y1_mm[i]);
    if (step.reversed) std::swap(from, to);
    sum += (from - at).norm();
    at = to;
  }
  return options.return_to_start ? sum + (options.start_mm - at).norm() : sum;
}

Scratches in_carving_order(const Scratches& scratches, const std::vector<CarvingStep>& order) {
  std::vector<std::size_t> rows;
  rows.reserve(order.size());
  for (const CarvingStep& step : order) rows.push_back(step.scratch);
  Scratches out = selected(scratches, rows);
  for (std::size_t k = 0; k < order.size(); ++k)
    if (order[k].reversed) {
      std::swap(out.x0_mm[k], out.x1_mm[k]);
      std::swap(out.y0_mm[k], out.y1_mm[k]);
    }
  return out;
}

}  // namespace burin
