#include "burin/optimize/toolpath/carving_limits.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/limits.h"
#include "burin/optimize/toolpath/ends.h"
#include "burin/optimize/toolpath/groove_pairs.h"
#include "burin/scene/groove.h"
#include "burin/scene/keep_out.h"

namespace burin {
namespace {

// scratches.csv keeps five decimals; a division by this gives the value as read back
constexpr double kFilePerMm = 1e5;
constexpr double kSlack_mm = 1e-9;        // of lengths and distances, for rounding in double
constexpr double kInside_mm = 2e-5;       // distance of a repaired end from a rule's edge
constexpr int kHairs = 4;                 // largest lateral move for the least distance, in steps of 0.6 times it
constexpr double kSmallestGroove = 1e-9;  // mm2, below which two grooves only touch

std::string length_text(double mm) { return general(mm, 5) + " mm"; }

std::string point_text(const Eigen::Vector2d& p_mm) {
  return "(" + fixed(p_mm.x(), 3) + ", " + fixed(p_mm.y(), 3) + ") mm";
}

double half_width_mm(const Scratches& s, std::size_t i, const CarvingLimits& limits) {
  const double depth = s.depth_um.empty() ? limits.depth_um : s.depth_um[i];
  const double width = s.width_um.empty() ? limits.width_um : s.width_um[i];
  return width > 0 ? 1e-3 * half_width_um(width, depth) : 0;
}

Groove groove_of(const Scratches& s, std::size_t i, const CarvingLimits& limits) {
  const Ends e = ends_of(s, i);
  return {e.a, e.b, half_width_mm(s, i, limits)};
}

bool in_area(const Eigen::Vector2d& p, const CarvingLimits& limits, double tolerance_mm) {
  return (p.array() >= limits.min_mm.array() - tolerance_mm).all() &&
         (p.array() <= limits.max_mm.array() + tolerance_mm).all();
}

bool off_keep_outs(const Ends& e, double clearance_mm, const CarvingLimits& limits) {
  if (limits.keep_out.empty()) return true;
  const std::vector<LinePart> free = free_parts(e.a, e.b, limits.keep_out, clearance_mm - kSlack_mm);
  return free.size() == 1 && free[0].first == 0 && free[0].second == 1;
}

bool on_step(const Eigen::Vector2d& p, const CarvingLimits& limits, const Eigen::Matrix2d& A_inverse) {
  const Eigen::Vector2d told = A_inverse * (p - limits.affine.col(2)) / limits.machine.step_mm;
  return ((told.array() - told.array().round()).abs() * limits.machine.step_mm <= kOnStep_mm).all();
}

// The first broken rule of one scratch alone (except steps and width).
std::optional<Rule> broken_alone(const Ends& e, double half_width, const CarvingLimits& limits,
                                 double edge_tolerance_mm) {
  if (!in_area(e.a, limits, edge_tolerance_mm) || !in_area(e.b, limits, edge_tolerance_mm)) return Rule::area;
  if (e.length() < limits.machine.shortest_mm - kSlack_mm) return Rule::shortest;
  if (limits.machine.longest_mm > 0 && e.length() > limits.machine.longest_mm + kSlack_mm) return Rule::longest;
  if (!off_keep_outs(e, half_width, limits)) return Rule::keep_out;
  return std::nullopt;
}

GrooveIndex index_for(const Scratches& scratches, const CarvingLimits& limits) {
  double total = 0;
  for (std::size_t i = 0; i < scratches.size(); ++i) total += ends_of(scratches, i).length();
  const double mean = total / static_cast<double>(std::max<std::size_t>(1, scratches.size()));
  return {limits.min_mm, limits.max_mm, std::max(0.25 * mean, 0.1)};
}

// Selects the parts of a groove covered by others that may share a place with `others` or more. A common place lies in
// all of their projections on the groove's line.
std::vector<std::vector<Eigen::Vector2d>> crowded(const Groove& groove,
                                                  const std::vector<std::vector<Eigen::Vector2d>>& parts, int others) {
  std::vector<std::pair<double, double>> shadows;
  const Eigen::Vector2d u = (groove.b_mm - groove.a_mm).normalized();
  for (const auto& part : parts) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Eigen::Vector2d& p : part) {
      low = std::min(low, u.dot(p));
      high = std::max(high, u.dot(p));
    }
    shadows.emplace_back(low, high);
  }
  std::vector<bool> wanted(parts.size(), false);
  // Projections share a place at the begin of one of them. The ones over it are those begun until there minus those
  // ended.
  std::vector<double> begins, ends, shared;
  for (const auto& [begin, end] : shadows) {
    begins.push_back(begin);
    ends.push_back(end);
  }
  std::sort(begins.begin(), begins.end());
  std::sort(ends.begin(), ends.end());
  for (const double at : begins)
    if ((std::upper_bound(begins.begin(), begins.end(), at) - begins.begin()) -
            (std::lower_bound(ends.begin(), ends.end(), at) - ends.begin()) >=
        others)
      shared.push_back(at);
  for (std::size_t k = 0; k < shadows.size(); ++k) {
    const auto first = std::lower_bound(shared.begin(), shared.end(), shadows[k].first);
    wanted[k] = first != shared.end() && *first <= shadows[k].second;
  }
  std::vector<std::vector<Eigen::Vector2d>> out;
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (wanted[k]) out.push_back(parts[k]);
  return out;
}

// A groove's relations to the others.
struct Meeting {
  double nearest_mm = std::numeric_limits<double>::infinity();  // of grooves that do not cross it
  std::size_t nearest = 0;
  double share = 0;                                     // of its area, covered by others
  std::vector<std::pair<std::uint32_t, double>> takes;  // area that it covers of each other one
  int grooves = 1;                                      // over one place of it
};

Meeting meet(std::size_t self, const std::vector<Groove>& grooves, const GrooveIndex& index, double widest_mm,
             const MachineLimits& rules) {
  Meeting m;
  const Groove& g = grooves[self];
  std::vector<std::vector<Eigen::Vector2d>> parts;
  for (const std::uint32_t j : index.near(g, std::max(rules.distance_mm, g.half_width_mm + widest_mm))) {
    if (j == self) continue;
    if (rules.distance_mm > 0) {
      const double d = line_distance_mm(g, grooves[j]);
      if (d > 0 && d < m.nearest_mm) {
        m.nearest_mm = d;
        m.nearest = j;
      }
    }
    if (rules.max_overlap <= 0 && rules.max_grooves <= 0) continue;
    std::vector<Eigen::Vector2d> part = common_part(g, grooves[j]);
    const double area = area_mm2(part);
    if (area < kSmallestGroove) continue;
    m.share += area / g.area_mm2();
    m.takes.emplace_back(j, area);
    parts.push_back(std::move(part));
  }
  if (rules.max_grooves > 0 && static_cast<int>(parts.size()) >= rules.max_grooves)
    m.grooves = 1 + most_at_a_place(crowded(g, parts, rules.max_grooves), rules.max_grooves - 1);
  return m;
}

std::vector<Groove> grooves_of(const Scratches& scratches, const CarvingLimits& limits) {
  std::vector<Groove> grooves;
  for (std::size_t i = 0; i < scratches.size(); ++i) grooves.push_back(groove_of(scratches, i, limits));
  return grooves;
}

double widest_of(const std::vector<Groove>& grooves) {
  double widest = 0;
  for (const Groove& g : grooves) widest = std::max(widest, g.half_width_mm);
  return widest;
}

// Candidate ends near those of a scratch, the nearest first: moved sideways, lengthened or shortened slightly, then cut
// at one end.
std::vector<Ends> nearby(const Ends& e, double distance_mm) {
  const double length = e.length();
  const Eigen::Vector2d u = (e.b - e.a) / length, across(-u.y(), u.x());
  std::vector<Ends> list;
  if (distance_mm > 0)
    for (int k = 1; k <= kHairs; ++k) {
      const Eigen::Vector2d along = 0.6 * k * distance_mm * u, aside = 0.6 * k * distance_mm * across;
      for (const int side : {1, -1}) list.push_back({e.a + side * aside, e.b + side * aside});
      for (const int way : {1, -1}) {
        if (length < 2 * along.norm()) continue;
        list.push_back({e.a + way * along, e.b});
        list.push_back({e.a, e.b + way * along});
        list.push_back({e.a + way * along, e.b + way * along});
      }
    }
  for (const double part : {0.1, 0.2, 0.35, 0.5}) {
    list.push_back({e.a + part * (e.b - e.a), e.b});
    list.push_back({e.a, e.b - part * (e.b - e.a)});
  }
  return list;
}

// Points of the machine's grid (or of the file's decimals) around a place, the nearest first, as the file has them.
std::vector<Eigen::Vector2d> grid_points(const Eigen::Vector2d& p, const CarvingLimits& limits,
                                         const Eigen::Matrix2d& A_inverse) {
  const bool steps = limits.machine.step_mm > 0;
  const double step = steps ? limits.machine.step_mm : 1 / kFilePerMm;
  const Eigen::Vector2d told = steps ? Eigen::Vector2d(A_inverse * (p - limits.affine.col(2))) : p;
  std::vector<Eigen::Vector2d> points;
  for (const double x : {std::floor(told.x() / step), std::ceil(told.x() / step)})
    for (const double y : {std::floor(told.y() / step), std::ceil(told.y() / step)}) {
      Eigen::Vector2d q(x * step, y * step);
      if (steps) q = limits.affine.leftCols<2>() * q + limits.affine.col(2);
      points.emplace_back(std::round(q.x() * kFilePerMm) / kFilePerMm, std::round(q.y() * kFilePerMm) / kFilePerMm);
    }
  std::sort(points.begin(), points.end(), [&](const Eigen::Vector2d& q, const Eigen::Vector2d& r) {
    return (q - p).squaredNorm() < (r - p).squaredNorm();
  });
  return points;
}

// Moves both ends to grid points under the rules for one scratch; returns the rule that prevents it otherwise.
std::optional<Rule> put_on_grid(Ends& ends, double half_width, const CarvingLimits& limits,
                                const Eigen::Matrix2d& A_inverse) {
  std::optional<Rule> broken;
  const std::vector<Eigen::Vector2d> starts = grid_points(ends.a, limits, A_inverse),
                                     stops = grid_points(ends.b, limits, A_inverse);
  for (std::size_t sum = 0; sum <= starts.size() + stops.size() - 2; ++sum)
    for (std::size_t i = 0; i <= std::min(sum, starts.size() - 1); ++i) {
      if (sum - i >= stops.size()) continue;
      const Ends candidate{starts[i], stops[sum - i]};
      const std::optional<Rule> rule =
          candidate.length() > 0 ? broken_alone(candidate, half_width, limits, 0) : Rule::shortest;
      if (!rule) {
        ends = candidate;
        return std::nullopt;
      }
      if (!broken) broken = rule;
    }
  return broken;
}

// Keeps scratches in their order. Each is moved to a nearby place, cut or dropped if it breaks a pair rule with kept or
// carved ones.
class PairKeeper {
 public:
  PairKeeper(Scratches& moved, const std::vector<std::size_t>& carved, const CarvingLimits& limits)
      : moved_(moved),
        limits_(limits),
        grooves_(grooves_of(moved, limits)),
        widest_(widest_of(grooves_)),
        index_(index_for(moved, limits)),
        lost_(grooves_.size(), 0.0) {
    for (const std::size_t i : carved) index_.insert(static_cast<std::uint32_t>(i), grooves_[i]);
  }

  /// Nothing if the scratch is kept; else the rule it broke at its original place.
  std::optional<Rule> keep(std::size_t i) {
    Meeting met;
    const std::optional<Rule> broken = broken_by(i, met);
    if (broken && !find_lawful_place(i, met)) return broken;
    for (const auto& [other, area] : met.takes) {
      lost_[other] += area;
      lost_[i] += area;
    }
    index_.insert(static_cast<std::uint32_t>(i), grooves_[i]);
    return std::nullopt;
  }

 private:
  // The first pair rule that a scratch breaks among kept ones, and its relations to them.
  std::optional<Rule> broken_by(std::size_t i, Meeting& met) const {
    const MachineLimits& m = limits_.machine;
    met = meet(i, grooves_, index_, widest_, m);
    const auto spoils = [&](const auto& take) {
      return !moved_.is_carved(take.first) &&
             lost_[take.first] + take.second > m.max_overlap * grooves_[take.first].area_mm2();
    };
    if (m.distance_mm > 0 && met.nearest_mm < m.distance_mm) return Rule::distance;
    if (m.max_overlap > 0 && (met.share > m.max_overlap || std::any_of(met.takes.begin(), met.takes.end(), spoils)))
      return Rule::overlap;
    if (m.max_grooves > 0 && met.grooves > m.max_grooves) return Rule::grooves;
    return std::nullopt;
  }

  bool find_lawful_place(std::size_t i, Meeting& met) {
    const Ends came = ends_of(moved_, i);
    for (const Ends& near : nearby(came, std::max(limits_.machine.distance_mm, limits_.machine.step_mm))) {
      Ends ends = near;
      if (broken_alone(ends, grooves_[i].half_width_mm, limits_, 0) ||
          put_on_grid(ends, grooves_[i].half_width_mm, limits_, A_inverse_))
        continue;
      set_ends(moved_, i, ends);
      grooves_[i] = groove_of(moved_, i, limits_);
      if (!broken_by(i, met)) return true;
    }
    return false;
  }

  Scratches& moved_;
  const CarvingLimits& limits_;
  Eigen::Matrix2d A_inverse_ = limits_.affine.leftCols<2>().inverse();
  std::vector<Groove> grooves_;
  double widest_;
  GrooveIndex index_;
  std::vector<double> lost_;  // area of each covered by others
};

std::string keep_out_named(const Ends& e, double half_width, const CarvingLimits& limits) {
  for (const KeepOut& place : limits.keep_out) {
    const std::vector<LinePart> free = free_parts(e.a, e.b, {&place, 1}, half_width - kSlack_mm);
    if (free.size() == 1 && free[0].first == 0 && free[0].second == 1) continue;
    if (!place.name.empty()) return "\"" + place.name + "\"";
    const Eigen::Vector2d at = place.polygon_mm.empty() ? place.center_mm : place.polygon_mm.front();
    return "the one at " + point_text(at);
  }
  return "a keep-out";
}

// Checks scratches and records the broken rules.
struct Judge {
  const Scratches& scratches;
  const CarvingLimits& limits;
  double edge_tolerance_mm;
  LimitsCheck check{};
  std::size_t first_row = scratches.size();
  Eigen::Matrix2d A_inverse = limits.affine.leftCols<2>().inverse();

  // `what` makes the sentence: only the first fault needs one.
  template <typename What>
  void broken(Rule rule, std::size_t row, const What& what, const std::string& remedy) {
    ++check.broken[static_cast<std::size_t>(rule)];
    if (row >= first_row) return;
    first_row = row;
    check.first = "scratch in row " + std::to_string(row + 1) + " " + what();
    check.remedy = remedy;
  }

  std::string what_is_wrong(Rule rule, const Ends& e, double half_width) const {
    const MachineLimits& m = limits.machine;
    if (rule == Rule::area)
      return "leaves the board's carve area at " + point_text(in_area(e.a, limits, edge_tolerance_mm) ? e.b : e.a);
    if (rule == Rule::keep_out)
      return "crosses a place that is kept free, " + keep_out_named(e, half_width, limits) + " (its groove is " +
             length_text(2 * half_width) + " wide)";
    return "is " + length_text(e.length()) + " long; the machine carves " +
           (rule == Rule::shortest ? "no less than " + length_text(m.shortest_mm)
                                   : "no more than " + length_text(m.longest_mm));
  }

  // The rules that concern one scratch.
  void alone(std::size_t i) {
    const Ends e = ends_of(scratches, i);
    const double half_width = half_width_mm(scratches, i, limits), step_mm = limits.machine.step_mm;
    if (!e.a.allFinite() || !e.b.allFinite())
      fail("scratch in row " + std::to_string(i + 1), "has an end that is not a number", "remove it");
    if (const std::optional<Rule> rule = broken_alone(e, half_width, limits, edge_tolerance_mm))
      broken(
          *rule, i, [&] { return what_is_wrong(*rule, e, half_width); },
          *rule == Rule::area ? "move it, or correct carve_mm in board.json (now " + point_text(limits.min_mm) +
                                    " to " + point_text(limits.max_mm) + ")"
          : *rule == Rule::keep_out ? "move it, or correct keep_out and tags in board.json"
                                    : "design for this machine, or correct its limits");
    if (step_mm > 0 && (!on_step(e.a, limits, A_inverse) || !on_step(e.b, limits, A_inverse)))
      broken(
          Rule::step, i,
          [&] {
            return "does not lie on the machine's steps of " + length_text(step_mm) + ": " + point_text(e.a) + " to " +
                   point_text(e.b);
          },
          "design for this machine, or correct its step_mm");
    if (limits.width_um > 0 && !scratches.width_um.empty() &&
        std::abs(scratches.width_um[i] - limits.width_um) > 1e-6 * limits.width_um)
      broken(
          Rule::width, i,
          [&] {
            return "is " + fixed(scratches.width_um[i], 6) + " um wide, the board's tool " + fixed(limits.width_um, 6);
          },
          "carve it with another tool (tool.width_um in board.json), or take its width away");
  }

  // The pair rules.
  void pairs() {
    const MachineLimits& m = limits.machine;
    const std::vector<Groove> grooves = grooves_of(scratches, limits);
    GrooveIndex index = index_for(scratches, limits);
    for (std::size_t i = 0; i < grooves.size(); ++i) index.insert(static_cast<std::uint32_t>(i), grooves[i]);
    const double widest = widest_of(grooves);
    const std::string remedy =
        "design for this machine, let `burin toolpath --mend` drop what is too much, or correct "
        "the machine's limits";
    for (std::size_t i = 0; i < grooves.size(); ++i) {
      if (scratches.is_carved(i) || !(grooves[i].area_mm2() > 0)) continue;
      const Meeting met = meet(i, grooves, index, widest, m);
      if (m.distance_mm > 0 && met.nearest_mm < m.distance_mm - kSlack_mm)
        broken(
            Rule::distance, i,
            [&] {
              return "runs " + length_text(met.nearest_mm) + " next to the one in row " +
                     std::to_string(met.nearest + 1) + "; the machine needs " + length_text(m.distance_mm);
            },
            remedy);
      if (m.max_overlap > 0 && met.share > m.max_overlap * (1 + 1e-9))
        broken(
            Rule::overlap, i,
            [&] {
              return "loses " + std::to_string(std::lround(1000 * met.share) / 10.0).substr(0, 5) +
                     " % of its groove to others; " + std::to_string(100 * m.max_overlap).substr(0, 5) +
                     " % are allowed";
            },
            remedy);
      if (m.max_grooves > 0 && met.grooves > m.max_grooves)
        broken(
            Rule::grooves, i,
            [&] {
              return "has a place where more than " + std::to_string(m.max_grooves) + " groove" +
                     (m.max_grooves == 1 ? " lies" : "s lie");
            },
            remedy);
    }
  }
};

// True if any groove in the area could touch the place: none is wider than the tool.
bool reaches_into(const KeepOut& place, const CarvingLimits& limits) {
  Eigen::Vector2d low = place.center_mm, high = low;
  if (!place.polygon_mm.empty()) low = high = place.polygon_mm.front();
  for (const Eigen::Vector2d& p : place.polygon_mm) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double reach = place.radius_mm + 0.5e-3 * limits.width_um;
  return (low.array() - reach < limits.max_mm.array()).all() && (high.array() + reach > limits.min_mm.array()).all();
}

}  // namespace

CarvingLimits carving_limits(const Board& board, const MachineLimits& machine, double depth_um,
                             const Eigen::Matrix<double, 2, 3>& affine) {
  CarvingLimits limits{board.carve_min_mm, board.carve_max_mm, {}, machine, board.tool_width_um, depth_um, affine};
  std::vector<KeepOut> places = board.keep_out;
  for (const Tag& tag : board.tags.list) places.push_back(tag_paper(tag, board.tags.family));
  for (KeepOut& place : places)
    if (reaches_into(place, limits)) limits.keep_out.push_back(std::move(place));
  return limits;
}

bool has_pair_rules(const MachineLimits& machine) {
  return machine.distance_mm > 0 || machine.max_overlap > 0 || machine.max_grooves > 0;
}

const char* rule_name(Rule rule) {
  switch (rule) {
    case Rule::area:
      return "carve area";
    case Rule::keep_out:
      return "keep-outs and tags";
    case Rule::shortest:
      return "shortest length";
    case Rule::longest:
      return "longest length";
    case Rule::step:
      return "machine steps";
    case Rule::distance:
      return "distance";
    case Rule::overlap:
      return "overlap";
    case Rule::grooves:
      return "grooves over one place";
    case Rule::width:
      return "the tool's width";
  }
  return "";
}

bool LimitsCheck::good() const {
  return std::all_of(broken.begin(), broken.end(), [](std::size_t n) { return n == 0; });
}

LimitsCheck check_limits(const Scratches& scratches, const CarvingLimits& limits, double edge_tolerance_mm) {
  Judge judge{scratches, limits, edge_tolerance_mm};
  for (std::size_t i = 0; i < scratches.size(); ++i)
    if (!scratches.is_carved(i)) judge.alone(i);
  if (has_pair_rules(limits.machine) && scratches.size() > 0) judge.pairs();
  return judge.check;
}

void fail_if_crowded(const Scratches& scratches, const CarvingLimits& limits) {
  if (!has_pair_rules(limits.machine) || scratches.size() == 0) return;
  const std::vector<Groove> grooves = grooves_of(scratches, limits);
  GrooveIndex index = index_for(scratches, limits);
  for (std::size_t i = 0; i < grooves.size(); ++i) index.insert(static_cast<std::uint32_t>(i), grooves[i]);
  const double widest = widest_of(grooves);
  std::size_t near = 0;
  for (const Groove& groove : grooves)
    if ((near += index.near_at_most(groove, std::max(limits.machine.distance_mm, groove.half_width_mm + widest))) >
        limit::kNear)
      fail(std::to_string(grooves.size()) + " scratches",
           "lie more than " + std::to_string(limit::kNear) +
               " times near one another, too often to judge their distance and overlap",
           "carve fewer or shorter ones, or take distance_mm, max_overlap and max_grooves out of the machine's limits");
}

void fail_unless_good(const LimitsCheck& check, const std::string& name) {
  if (check.good()) return;
  const std::size_t all = std::accumulate(check.broken.begin(), check.broken.end(), std::size_t{0});
  std::string count;
  if (all > 1) count = " (" + std::to_string(all) + " faults in all: " + dropped_text(check.broken) + ")";
  fail(name, check.first + count, check.remedy);
}

bool confine(Scratches& scratches, std::size_t index, const CarvingLimits& limits, const Eigen::Vector2d& a_before_mm,
             const Eigen::Vector2d& b_before_mm) {
  const double half_width = half_width_mm(scratches, index, limits);
  const MachineLimits& m = limits.machine;
  Ends e = ends_of(scratches, index);
  e.a = e.a.cwiseMax(limits.min_mm).cwiseMin(limits.max_mm);
  e.b = e.b.cwiseMax(limits.min_mm).cwiseMin(limits.max_mm);
  if (!limits.keep_out.empty()) {
    // The longest free part, slightly shortened: rounding in a file then cannot cross an edge.
    const std::vector<LinePart> free = free_parts(e.a, e.b, limits.keep_out, half_width + kInside_mm);
    const auto longest = std::max_element(free.begin(), free.end(), [](const LinePart& p, const LinePart& q) {
      return p.second - p.first < q.second - q.first;
    });
    if (longest != free.end() && (longest->first > 0 || longest->second < 1)) {
      const Eigen::Vector2d along = e.b - e.a;
      const double hair = kInside_mm / std::max(along.norm(), kInside_mm);
      const double from = longest->first > 0 ? longest->first + hair : 0;
      const double to = longest->second < 1 ? longest->second - hair : 1;
      if (to > from) e = {e.a + from * along, e.a + to * along};
    }
  }
  const double length = e.length(), most = m.longest_mm > 0 ? m.longest_mm : length;
  if (length < m.shortest_mm || length > most) {
    const Eigen::Vector2d before = b_before_mm - a_before_mm;
    const Eigen::Vector2d u = length > 1e-9              ? Eigen::Vector2d((e.b - e.a) / length)
                              : before.squaredNorm() > 0 ? Eigen::Vector2d(before.normalized())
                                                         : Eigen::Vector2d(1, 0);
    // Inside the limit by the possible rounding to the machine's steps.
    const double hair = kInside_mm + 0.75 * m.step_mm;
    const double half = length < m.shortest_mm ? 0.5 * m.shortest_mm + hair : std::max(0.5 * most - hair, 0.25 * most);
    const Eigen::Vector2d reach = half * u.cwiseAbs();
    const Eigen::Vector2d low = limits.min_mm + reach, high = (limits.max_mm - reach).cwiseMax(low);
    const Eigen::Vector2d middle = ((e.a + e.b) / 2).cwiseMax(low).cwiseMin(high);
    e = {middle - half * u, middle + half * u};
    e.a = e.a.cwiseMax(limits.min_mm).cwiseMin(limits.max_mm);  // the sum's rounding
    e.b = e.b.cwiseMax(limits.min_mm).cwiseMin(limits.max_mm);
  }
  if (!broken_alone(e, half_width, limits, 0)) {
    set_ends(scratches, index, e);
    return true;
  }
  const Ends before{a_before_mm, b_before_mm};
  if (!(before.length() > 0) || broken_alone(before, half_width, limits, 0)) return false;
  set_ends(scratches, index, before);
  return true;
}

Mended mend(const Scratches& scratches, const CarvingLimits& limits, std::span<const double> worth) {
  Mended out;
  const Eigen::Matrix2d A_inverse = limits.affine.leftCols<2>().inverse();
  Scratches moved = scratches;
  std::vector<std::size_t> order, carved;
  out.broken.resize(scratches.size());
  const auto drop = [&](std::size_t i, Rule rule) {
    ++out.dropped[static_cast<std::size_t>(rule)];
    out.broken[i] = rule;
  };
  for (std::size_t i = 0; i < scratches.size(); ++i) {
    if (scratches.is_carved(i)) {
      carved.push_back(i);
      continue;
    }
    const Ends came = ends_of(moved, i);
    if (!moved.width_um.empty() && limits.width_um > 0) moved.width_um[i] = limits.width_um;
    const double half_width = half_width_mm(moved, i, limits);
    if (!confine(moved, i, limits, came.a, came.b)) {
      drop(i, broken_alone(came, half_width, limits, 0).value_or(Rule::shortest));
      continue;
    }
    Ends ends = ends_of(moved, i);
    if (const std::optional<Rule> rule = put_on_grid(ends, half_width, limits, A_inverse)) {
      drop(i, *rule);
      continue;
    }
    set_ends(moved, i, ends);
    order.push_back(i);
  }
  if (!worth.empty())
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return worth[a] > worth[b]; });
  if (has_pair_rules(limits.machine)) {
    PairKeeper keeper(moved, carved, limits);
    for (const std::size_t i : order)
      if (const std::optional<Rule> rule = keeper.keep(i))
        drop(i, *rule);
      else
        out.rows.push_back(i);
  } else {
    out.rows = std::move(order);
  }
  out.rows.insert(out.rows.end(), carved.begin(), carved.end());
  std::sort(out.rows.begin(), out.rows.end());
  out.scratches = selected(moved, out.rows);
  for (std::size_t k = 0; k < out.rows.size(); ++k) {
    const Ends was = ends_of(scratches, out.rows[k]), is = ends_of(out.scratches, k);
    out.moved_mm = std::max({out.moved_mm, (was.a - is.a).norm(), (was.b - is.b).norm()});
  }
  return out;
}

std::string dropped_text(const std::array<std::size_t, kRules>& dropped) {
  std::string text;
  for (std::size_t r = 0; r < kRules; ++r)
    if (dropped[r] > 0)
      text += (text.empty() ? "" : ", ") + std::to_string(dropped[r]) + " for " + rule_name(static_cast<Rule>(r));
  return text;
}

}  // namespace burin
