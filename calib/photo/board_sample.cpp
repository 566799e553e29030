#include "burin/calib/photo/board_sample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

#include "burin/scene/crossings.h"

namespace burin {
namespace {

double from_middle_mm(const Eigen::Vector2d& middle_mm, const Eigen::Vector2d& place_mm) {
  return (place_mm - middle_mm).cwiseAbs().maxCoeff();
}

// A piece of a groove, about a millimeter long.
struct Piece {
  Eigen::Vector2d middle_mm;
  double length_mm;
};

std::vector<Piece> pieces_of(const Scratches& s) {
  std::vector<Piece> out;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Eigen::Vector2d from(s.x0_mm[i], s.y0_mm[i]), along = Eigen::Vector2d(s.x1_mm[i], s.y1_mm[i]) - from;
    const int count = 1 + static_cast<int>(along.norm());
    for (int k = 0; k < count; ++k) out.push_back({from + (k + 0.5) / count * along, along.norm() / count});
  }
  return out;
}

// Carved pieces in one part of the board.
struct Cell {
  std::vector<Piece> pieces;
  Eigen::Vector2d middle_mm() const {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double length_mm = 0;
    for (const Piece& piece : pieces) {
      sum += piece.length_mm * piece.middle_mm;
      length_mm += piece.length_mm;
    }
    return sum / length_mm;
  }
};

bool any_holds(const std::vector<Eigen::AlignedBox2d>& boxes, const Eigen::Vector2d& place_mm) {
  return std::any_of(boxes.begin(), boxes.end(),
                     [&](const Eigen::AlignedBox2d& box) { return box.contains(place_mm); });
}

}  // namespace

bool BoardSample::holds(const Eigen::Vector2d& place_mm) const { return is_whole() || any_holds(squares, place_mm); }

BoardSample sample_of(const Scratches& scratches, const Board& board, double most_pieces) {
  constexpr int kAcross = 4;
  constexpr double kSmaller = 0.95, kLeastHalfMm = 3;
  const Eigen::Vector2d size_mm = board.carve_max_mm - board.carve_min_mm;
  if (expected_pieces(scratches, size_mm.prod()) <= most_pieces) return {};
  // The first few of these are far from one another.
  constexpr std::array<std::size_t, 16> kSpread{0, 10, 2, 8, 5, 15, 7, 13, 1, 11, 3, 9, 4, 14, 6, 12};
  std::array<Cell, kSpread.size()> cells;
  for (const Piece& piece : pieces_of(scratches)) {
    const Eigen::Vector2d share = (piece.middle_mm - board.carve_min_mm).cwiseQuotient(size_mm);
    const auto at = [&](int axis) -> std::size_t {
      return std::clamp(static_cast<int>(kAcross * share[axis]), 0, kAcross - 1);
    };
    cells[at(1) * kAcross + at(0)].pieces.push_back(piece);
  }
  struct Place {
    const Cell* cell;
    Eigen::Vector2d middle_mm;
  };
  std::vector<Place> places;
  for (const std::size_t c : kSpread)
    if (!cells[c].pieces.empty()) places.push_back({&cells[c], cells[c].middle_mm()});
  const auto pieces_at = [](const Place& place, double half_mm) {
    double length_mm = 0;
    for (const Piece& piece : place.cell->pieces)
      if (from_middle_mm(place.middle_mm, piece.middle_mm) <= half_mm) length_mm += piece.length_mm;
    return expected_pieces(length_mm, 4 * half_mm * half_mm);
  };
  const auto pieces_within = [&](double half_mm) {
    return std::accumulate(places.begin(), places.end(), 0.0,
                           [&](double sum, const Place& place) { return sum + pieces_at(place, half_mm); });
  };
  double half_mm = 0.5 * size_mm.maxCoeff() / kAcross;
  while (half_mm > kLeastHalfMm && pieces_within(half_mm) > most_pieces)
    half_mm = std::max(kLeastHalfMm, kSmaller * half_mm);
  BoardSample out;
  for (const Place& place : places) {
    const double pieces = pieces_at(place, half_mm);
    if (!out.squares.empty() && out.pieces + pieces > most_pieces) break;
    out.pieces += pieces;
    out.squares.emplace_back((place.middle_mm.array() - half_mm).matrix(),
                             (place.middle_mm.array() + half_mm).matrix());
  }
  return out;
}

double share_of(const BoardSample& sample, const Board& board) {
  constexpr int kPlaces = 200;  // either way; squares may overlap
  const Eigen::Vector2d size_mm = board.carve_max_mm - board.carve_min_mm;
  int held = 0;
  for (int j = 0; j < kPlaces; ++j)
    for (int i = 0; i < kPlaces; ++i) {
      const Eigen::Vector2d share((i + 0.5) / kPlaces, (j + 0.5) / kPlaces);
      held += sample.holds(board.carve_min_mm + share.cwiseProduct(size_mm)) ? 1 : 0;
    }
  return static_cast<double>(held) / (kPlaces * kPlaces);
}

FootprintGrid footprints_of(const BoardSample& sample, FootprintGrid grid) {
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < grid.corner_x_mm.size(); ++i)
    if (!any_holds(sample.surroundings, {grid.corner_x_mm[i], grid.corner_y_mm[i]}))
      grid.corner_x_mm[i] = grid.corner_y_mm[i] = kNowhere;
  for (std::size_t i = 0; i < grid.center_mm.size(); ++i)
    if (!footprint_middle_mm(grid, i).allFinite()) grid.center_mm[i].setConstant(kNowhere);
  return grid;
}

}  // namespace burin
