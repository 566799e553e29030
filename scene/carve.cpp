#include "burin/scene/carve.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "burin/base/error.h"
#include "burin/scene/groove_profile.h"
#include "burin/scene/machine_errors.h"

namespace burin {
namespace {

using Eigen::Vector2d;
using Boundary = PieceEnd::Boundary;

Vector2d first_end(const Scratches& s, std::size_t i) { return {s.x0_mm[i], s.y0_mm[i]}; }
Vector2d last_end(const Scratches& s, std::size_t i) { return {s.x1_mm[i], s.y1_mm[i]}; }

double or_shared(const std::vector<double>& own, std::size_t i, double shared) { return own.empty() ? shared : own[i]; }

// Carved end of a commanded one, and commanded end for a desired one. The direction follows the commanded or desired
// line, because lines hardly rotate.
Vector2d carved_end(const Bench& bench, const Vector2d& told, const Vector2d& way) {
  const Vector2d p = bench.machine_errors.none() ? told : displaced(bench.machine_errors, told, way);
  return bench.machine_affine * p.homogeneous();
}

template <typename Move>
void move_new_rows(Scratches& s, const Move& move) {
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (s.is_carved(i)) continue;
    const Vector2d way = last_end(s, i) - first_end(s, i);
    const Vector2d p0 = move(first_end(s, i), way), p1 = move(last_end(s, i), way);
    s.x0_mm[i] = p0.x(), s.y0_mm[i] = p0.y(), s.x1_mm[i] = p1.x(), s.y1_mm[i] = p1.y();
  }
}

// Normalized carving order of each row: from 0, the first, to 1, the last of the rows still to be carved.
std::vector<double> ages_of(const Scratches& s) {
  std::vector<double> age(s.size(), 0.5);
  std::size_t to_carve = 0;
  for (std::size_t i = 0; i < s.size(); ++i) to_carve += s.is_carved(i) ? 0 : 1;
  if (to_carve < 2) return age;
  std::size_t next = 0;
  for (std::size_t i = 0; i < s.size(); ++i)
    if (!s.is_carved(i)) age[i] = static_cast<double>(next++) / static_cast<double>(to_carve - 1);
  return age;
}

// Coordinates of a row in the field: u and v of the middle of its groove.
Vector2d uv_of(const Scratches& placed, std::size_t i, const Vector2d& board_size_mm) {
  return (0.5 * (first_end(placed, i) + last_end(placed, i))).cwiseQuotient(board_size_mm);
}

void apply_field(const GrooveField& field, double shared, double most, const Vector2d& board_size_mm,
                 const std::vector<double>& age, const Scratches& placed, std::vector<double>& values) {
  if (field.is_constant()) return;
  if (values.empty()) values.assign(placed.size(), shared);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (placed.is_carved(i)) continue;
    const Vector2d uv = uv_of(placed, i, board_size_mm);
    values[i] =
        std::min(most, values[i] * field_over_board(field.terms, uv.x(), uv.y()) * field_at_age(field.terms, age[i]));
  }
}

// Straight pieces of grooves in carving order: piece k is the part of row `source[k]` from begin[k] to end[k].
struct GrooveParts {
  Scratches pieces;
  std::vector<std::uint32_t> source;
  std::vector<double> begin, end;

  void add(std::size_t row, double from, double to, const Vector2d& p0, const Vector2d& p1) {
    source.push_back(static_cast<std::uint32_t>(row));
    begin.push_back(from);
    end.push_back(to);
    pieces.x0_mm.push_back(p0.x());
    pieces.y0_mm.push_back(p0.y());
    pieces.x1_mm.push_back(p1.x());
    pieces.y1_mm.push_back(p1.y());
  }
  // Copies each row's own parameters to its pieces.
  void follow(const Scratches& rows) {
    for (const auto column : {&Scratches::width_um, &Scratches::depth_um, &Scratches::alpha, &Scratches::carved})
      if (!(rows.*column).empty())
        for (const std::uint32_t row : source) (pieces.*column).push_back((rows.*column)[row]);
  }
};

// Splits grooves bent by uneven screws.
GrooveParts bent_grooves(const Scratches& placed, const Scratches& told, const Bench& bench) {
  GrooveParts out;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Vector2d t0 = first_end(told, i), t1 = last_end(told, i);
    const int n = placed.is_carved(i) ? 1 : pieces_for(bench.machine_errors, t0, t1);
    Vector2d from = first_end(placed, i);
    for (int k = 1; k <= n; ++k) {
      const double at = static_cast<double>(k) / n;
      const Vector2d to = k == n ? last_end(placed, i) : carved_end(bench, t0 + at * (t1 - t0), t1 - t0);
      out.add(i, static_cast<double>(k - 1) / n, at, from, to);
      from = to;
    }
  }
  out.follow(placed);
  return out;
}

// Parts of each row in any of the boxes, in the order along it.
GrooveParts parts_within(const Scratches& rows, std::span<const Eigen::AlignedBox2d> boxes) {
  struct Stretch {
    double from, to;
  };
  GrooveParts out;
  std::vector<Stretch> inside;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Vector2d p0 = first_end(rows, i), along = last_end(rows, i) - p0;
    inside.clear();
    for (const Eigen::AlignedBox2d& box : boxes) {
      Stretch stretch{0, 1};
      for (int axis = 0; axis < 2; ++axis) {
        const double low = box.min()[axis] - p0[axis], high = box.max()[axis] - p0[axis];
        if (along[axis] == 0) {
          if (low > 0 || high < 0) stretch.to = -1;
          continue;
        }
        const auto [enters, leaves] = std::minmax({low / along[axis], high / along[axis]});
        stretch = {std::max(stretch.from, enters), std::min(stretch.to, leaves)};
      }
      if (stretch.from < stretch.to) inside.push_back(stretch);
    }
    std::sort(inside.begin(), inside.end(), [](const Stretch& a, const Stretch& b) { return a.from < b.from; });
    for (std::size_t k = 0; k < inside.size();) {
      Stretch whole = inside[k];
      for (++k; k < inside.size() && inside[k].from <= whole.to; ++k) whole.to = std::max(whole.to, inside[k].to);
      out.add(i, whole.from, whole.to, p0 + whole.from * along, p0 + whole.to * along);
    }
  }
  out.follow(rows);
  return out;
}

// Replaces the carved parts as sources by their rows. For parts of parts, the last split comes first.
void name_sources(const GrooveParts& parts, Carved& carved) {
  if (carved.source.empty()) {
    carved.source = parts.source;
    if (carved.lanes != nullptr) return;  // no code needs the start of a lane's groove on its row
    for (std::size_t k = 0; k < parts.source.size(); ++k) {
      carved.begin.push_back({parts.begin[k], Boundary::own_end, 0});
      carved.end.push_back({parts.end[k], Boundary::own_end, 0});
    }
    return;
  }
  for (std::size_t k = 0; k < carved.size(); ++k) {
    const std::uint32_t piece = carved.source[k];
    if (carved.lanes != nullptr) {
      carved.source[k] = parts.source[piece];
      continue;
    }
    for (PieceEnd* end : {&carved.begin[k], &carved.end[k]}) {
      end->at = parts.begin[piece] + end->at * (parts.end[piece] - parts.begin[piece]);
      end->cutter = parts.source[end->cutter];
    }
    carved.source[k] = parts.source[piece];
  }
}

Carved crossed(Scratches placed, const Bench& bench, const Board& board, const CutInto& cut);

constexpr double kMostDepth_um = 1e9, kMostAlpha = 1;

// Applies depths, roughnesses and crossings to scratches at their places in the metal. `told` is the commanded
// trajectory, if uneven screws bend the grooves.
Carved grooves_at(Scratches placed, const Bench& bench, const Board& board, const Scratches* told = nullptr,
                  std::span<const Eigen::AlignedBox2d> looked_at = {}, const CutInto& cut = {}) {
  if (!bench.depth_field.is_constant() || !bench.alpha_field.is_constant()) {
    const std::vector<double> age = ages_of(placed);
    apply_field(bench.depth_field, bench.material.depth_um, kMostDepth_um, board.size_mm, age, placed, placed.depth_um);
    apply_field(bench.alpha_field, bench.material.alpha, kMostAlpha, board.size_mm, age, placed, placed.alpha);
  }
  GrooveParts bent, within;
  if (told != nullptr) {
    bent = bent_grooves(placed, *told, bench);
    placed = std::move(bent.pieces);
  }
  if (!looked_at.empty()) {
    within = parts_within(placed, looked_at);
    placed = std::move(within.pieces);
  }
  Carved out = crossed(std::move(placed), bench, board, cut);
  if (!looked_at.empty()) name_sources(within, out);
  if (told != nullptr) name_sources(bent, out);
  return out;
}

Carved crossed(Scratches placed, const Bench& bench, const Board& board, const CutInto& cut) {
  Carved out;
  if (bench.crossings == Crossings::add) {
    out.scratches = std::move(placed);
    out.scratches.carved.clear();
    return out;
  }
  // Grooves in the metal precede all others.
  std::vector<std::size_t> order(placed.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_partition(order.begin(), order.end(), [&](std::size_t i) { return placed.is_carved(i); });
  if (cut.lanes > 0) {
    std::vector<std::uint32_t> rank(placed.size());
    for (std::size_t k = 0; k < order.size(); ++k) rank[order[k]] = static_cast<std::uint32_t>(k);
    out.lanes = std::make_shared<const VisibleLanes>(visible_lanes(placed, rank, board.tool_width_um,
                                                                   bench.material.depth_um, bench.material.profile,
                                                                   bench.crossings, cut.lanes, cut.cell_mm));
    out.scratches = std::move(placed);
    out.scratches.carved.clear();
    return out;
  }
  VisiblePieces pieces = visible_pieces(selected(placed, order), board.tool_width_um, bench.material.depth_um,
                                        bench.material.profile, bench.crossings, cut.steps);
  for (std::uint32_t& row : pieces.source) row = static_cast<std::uint32_t>(order[row]);
  for (std::vector<PieceEnd>* ends : {&pieces.begin, &pieces.end})
    for (PieceEnd& end : *ends) end.cutter = static_cast<std::uint32_t>(order[end.cutter]);
  out.scratches = std::move(pieces.pieces);
  out.source = std::move(pieces.source);
  out.begin = std::move(pieces.begin);
  out.end = std::move(pieces.end);
  return out;
}

// A gradient by ends, as points.
class EndGradients {
 public:
  explicit EndGradients(ScratchGradients& g) : g_(g) {}
  void add_first(std::size_t i, const Vector2d& by) { g_.x0_mm[i] += by.x(), g_.y0_mm[i] += by.y(); }
  void add_last(std::size_t i, const Vector2d& by) { g_.x1_mm[i] += by.x(), g_.y1_mm[i] += by.y(); }
  void add_depth(std::size_t i, double by) { g_.depth_um[i] += by; }
  void add_width(std::size_t i, double by) { g_.width_um[i] += by; }

 private:
  ScratchGradients& g_;
};

// dE/d(q) for one end q of a piece of row i, back to the ends of row i and of the row j that cuts it there. With q = p0
// + t (p1 - p0) on the line n . (q - a0) = c, where n and c belong to j, the implicit function theorem gives
//   dt = - [ n . ((1 - t) dp0 + t dp1) + dn . (q - a0) - n . da0 - dc ] / (n . (p1 - p0)).
void pull_back_end(const PieceEnd& end, std::size_t i, const Vector2d& by_q, const Scratches& placed,
                   const Bench& bench, const Board& board, EndGradients& out) {
  const Vector2d p0 = first_end(placed, i), p1 = last_end(placed, i);
  if (end.boundary == Boundary::own_end) {
    out.add_first(i, (1 - end.at) * by_q);
    out.add_last(i, end.at * by_q);
    return;
  }
  const std::size_t j = end.cutter;
  const Vector2d a0 = first_end(placed, j), along = last_end(placed, j) - a0;
  const double length = along.norm();
  const Vector2d u = along / length, across(u.y(), -u.x());
  const bool is_side = end.boundary == Boundary::side_minus || end.boundary == Boundary::side_plus;
  const Vector2d n = is_side ? across : u;
  const double lambda = -by_q.dot(p1 - p0) / n.dot(p1 - p0);
  const Vector2d by = by_q + lambda * n;
  out.add_first(i, (1 - end.at) * by);
  out.add_last(i, end.at * by);
  const Vector2d q = p0 + end.at * (p1 - p0);
  if (is_side) {
    const double share = u.dot(q - a0) / length;
    out.add_first(j, -lambda * (1 - share) * across);
    out.add_last(j, -lambda * share * across);
    // The line has an offset to the left or right, which depends on both grooves' depths. The offset scales with both
    // widths and depths together.
    const double sign = 1e-3 * (end.boundary == Boundary::side_plus ? -lambda : lambda);
    const auto depth = [&](std::size_t row) { return or_shared(placed.depth_um, row, bench.material.depth_um); };
    out.add_depth(i, sign * end.reach_by_depth);
    out.add_depth(j, sign * end.reach_by_cutter_depth);
    out.add_width(j, sign * (end.reach_um - end.reach_by_depth * depth(i) - end.reach_by_cutter_depth * depth(j)) /
                         or_shared(placed.width_um, j, board.tool_width_um));
  } else {
    const double lean = across.dot(q - a0) / length;
    out.add_first(j, lambda * (-lean * across - (end.boundary == Boundary::first_end ? u : Vector2d(0, 0))));
    out.add_last(j, lambda * (lean * across - (end.boundary == Boundary::last_end ? u : Vector2d(0, 0))));
  }
}

// dd'/dd of a groove with depth d' whose half-width is reduced to a fraction. Pieces are many and such grooves few, and
// the pieces of one groove are consecutive, so the last result is kept.
class NarrowedSlope {
 public:
  double operator()(const GrooveProfile& profile, double width_um, double depth_um, double share, double piece_um) {
    const std::array<double, 4> groove{width_um, depth_um, share, piece_um};
    for (const Known& known : known_)
      if (known.groove == groove) return known.slope;
    Known& made = known_[next_++ % known_.size()];
    made = {groove,
            share * half_width_slope(profile, width_um, depth_um) / half_width_slope(profile, width_um, piece_um)};
    return made.slope;
  }

 private:
  struct Known {
    std::array<double, 4> groove{};
    double slope = 0;
  };
  std::array<Known, 4> known_{};
  std::size_t next_ = 0;
};

// Depth and width of piece k back to its row. A fraction s of the half-width w(d) remains: the piece has the depth d'
// with w(d') = s w(d), and dimensional scaling gives d' = wt dd'/dwt + d dd'/dd.
void pull_back_depth(const Carved& carved, std::size_t k, const Scratches& placed, const Bench& bench,
                     const Board& board, const ScratchGradients& by, NarrowedSlope& slope, EndGradients& out) {
  const std::size_t i = carved.source[k];
  if (!carved.scratches.is_narrowed(k) || carved.scratches.left[k] >= kAllButBurrs) {
    out.add_depth(i, by.depth_um[k]);
    out.add_width(i, by.width_um[k]);
    return;
  }
  const GrooveProfile& profile = bench.material.profile;
  const double wt = or_shared(placed.width_um, i, board.tool_width_um),
               d = or_shared(placed.depth_um, i, bench.material.depth_um), piece_um = carved.scratches.depth_um[k];
  const double by_depth = slope(profile, wt, d, carved.scratches.left[k], piece_um);
  out.add_depth(i, by.depth_um[k] * by_depth);
  out.add_width(i, by.width_um[k] + by.depth_um[k] * (piece_um - d * by_depth) / wt);
}

// Backward pass of depth, alpha and ends of some pieces to their rows.
void pull_back_some(const Carved& carved, std::size_t from, std::size_t to, const Scratches& placed, const Bench& bench,
                    const Board& board, const ScratchGradients& by, ScratchGradients& out) {
  EndGradients ends(out);
  NarrowedSlope slope;
  for (std::size_t k = from; k < to; ++k) {
    const std::size_t i = carved.source[k];
    pull_back_end(carved.begin[k], i, {by.x0_mm[k], by.y0_mm[k]}, placed, bench, board, ends);
    pull_back_end(carved.end[k], i, {by.x1_mm[k], by.y1_mm[k]}, placed, bench, board, ends);
    pull_back_depth(carved, k, placed, bench, board, by, slope, ends);
    out.alpha[i] += by.alpha[k];
  }
}

// Backward pass of all pieces. The number of parts depends on the pieces per row, not on the threads, so the result has
// the same bits for any number of threads.
void pull_back_pieces(const Carved& carved, const Scratches& placed, const Bench& bench, const Board& board,
                      const ScratchGradients& by, ScratchGradients& out) {
  constexpr std::size_t kMostParts = 16;
  const std::size_t pieces = carved.size(), rows = placed.size(),
                    parts = std::clamp<std::size_t>(pieces / std::max<std::size_t>(4 * rows, 1), 1, kMostParts);
  std::vector<ScratchGradients> of_part(parts);
  tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
    of_part[part].resize(rows);
    pull_back_some(carved, part * pieces / parts, (part + 1) * pieces / parts, placed, bench, board, by, of_part[part]);
  });
  for (const auto column :
       {&ScratchGradients::x0_mm, &ScratchGradients::y0_mm, &ScratchGradients::x1_mm, &ScratchGradients::y1_mm,
        &ScratchGradients::width_um, &ScratchGradients::depth_um, &ScratchGradients::alpha})
    for (const ScratchGradients& part : of_part)
      for (std::size_t i = 0; i < rows; ++i) (out.*column)[i] += (part.*column)[i];
}

// Turns dE/d(value of each row after its field) into dE/d(value before), and adds the effect on the row's ends.
void pull_back_field(const GrooveField& field, double shared, double most, const Vector2d& board_size_mm,
                     const std::vector<double>& age, const Scratches& placed, const std::vector<double>& own,
                     std::vector<double>& by_value, EndGradients& out) {
  if (field.is_constant()) return;
  const auto& t = field.terms;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (placed.is_carved(i) || by_value[i] == 0) continue;
    const Vector2d uv = uv_of(placed, i, board_size_mm);
    const double over_board = field_over_board(t, uv.x(), uv.y()), at_age = field_at_age(t, age[i]);
    const double value = or_shared(own, i, shared);
    if (value * over_board * at_age >= most) {
      by_value[i] = 0;
      continue;
    }
    const double by_factor = by_value[i] * value * at_age;
    by_value[i] *= over_board * at_age;
    const double U = uv.x() - 0.5, V = uv.y() - 0.5;
    const Vector2d slope(t[0] + 2 * t[2] * U + t[3] * V, t[1] + t[3] * U + 2 * t[4] * V);
    const Vector2d by_end = 0.5 * by_factor * slope.cwiseQuotient(board_size_mm);
    out.add_first(i, by_end);
    out.add_last(i, by_end);
  }
}

}  // namespace

Sent compensated(const Designed& designed, const Bench& bench, const Board& board) {
  const Eigen::Matrix2d A = bench.machine_affine.leftCols<2>();
  if (!(std::abs(A.determinant()) > 1e-9))
    fail("machine.affine", "cannot be inverted", "measure the machine's map again (burin refine)");
  Affine2 inverse;
  inverse << A.inverse(), -A.inverse() * bench.machine_affine.col(2);
  Sent sent(designed.scratches);
  move_new_rows(sent.scratches, [&](const Vector2d& p, const Vector2d& way) -> Vector2d {
    const Vector2d even = inverse * p.homogeneous();
    return bench.machine_errors.none() ? even : told_for(bench.machine_errors, even, A.inverse() * way);
  });
  for (std::size_t i = 0; i < sent.size(); ++i) {
    if (sent.scratches.is_carved(i)) continue;
    if (!sent.scratches.depth_um.empty())
      sent.scratches.depth_um[i] *= board.material.depth_um / bench.material.depth_um;
    if (!sent.scratches.alpha.empty())
      sent.scratches.alpha[i] =
          std::min(kMostAlpha, sent.scratches.alpha[i] * board.material.alpha / bench.material.alpha);
  }
  return sent;
}

Carved carve(const Sent& sent, const Bench& bench, const Board& board, std::span<const Eigen::AlignedBox2d> looked_at,
             const CutInto& cut) {
  Scratches placed = sent.scratches;
  move_new_rows(placed, [&](const Vector2d& p, const Vector2d& way) { return carved_end(bench, p, way); });
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (placed.is_carved(i)) continue;
    if (!placed.depth_um.empty()) placed.depth_um[i] *= bench.material.depth_um / board.material.depth_um;
    if (!placed.alpha.empty())
      placed.alpha[i] = std::min(kMostAlpha, placed.alpha[i] * bench.material.alpha / board.material.alpha);
  }
  return grooves_at(std::move(placed), bench, board, bench.machine_errors.uneven() ? &sent.scratches : nullptr,
                    looked_at, cut);
}

Carved carve(const Designed& designed, const Bench& bench, const Board& board) {
  return grooves_at(designed.scratches, bench, board);
}

Carved in_metal(Scratches grooves) {
  Carved out;
  out.scratches = std::move(grooves);
  out.scratches.carved.clear();
  return out;
}

ScratchGradients pull_back(const Carved& carved, const Designed& designed, const Bench& bench, const Board& board,
                           ScratchGradients by_carved) {
  if (by_carved.x0_mm.size() != carved.size())
    fail("pull_back", "the gradient is for another number of grooves",
         "give the gradient of the grooves that carve() made of this design");
  ScratchGradients out;
  const bool fields = !bench.depth_field.is_constant() || !bench.alpha_field.is_constant();
  const std::vector<double> age = fields ? ages_of(designed.scratches) : std::vector<double>{};
  if (carved.source.empty()) {
    out = std::move(by_carved);
  } else {
    out.resize(designed.size());
    out.shared_base_alpha = by_carved.shared_base_alpha;
    // Sides of grooves follow their depth in the metal.
    Scratches placed = designed.scratches;
    if (!bench.depth_field.is_constant())
      apply_field(bench.depth_field, bench.material.depth_um, kMostDepth_um, board.size_mm, age, placed,
                  placed.depth_um);
    pull_back_pieces(carved, placed, bench, board, by_carved, out);
  }
  if (fields) {
    EndGradients ends(out);
    pull_back_field(bench.depth_field, bench.material.depth_um, kMostDepth_um, board.size_mm, age, designed.scratches,
                    designed.scratches.depth_um, out.depth_um, ends);
    pull_back_field(bench.alpha_field, bench.material.alpha, kMostAlpha, board.size_mm, age, designed.scratches,
                    designed.scratches.alpha, out.alpha, ends);
  } else if (carved.source.empty()) {
    return out;
  }
  const auto sum = [](const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); };
  out.shared_width_um = sum(out.width_um);
  out.shared_depth_um = sum(out.depth_um);
  out.shared_alpha = sum(out.alpha);
  return out;
}

}  // namespace burin
