// burin/optimize/design/glint_lines.h - grooves that cut each other's rims away (Crossings::deepest), as lines in one
// view.
//
// Seen from one place under one lamp, a groove glints along one line: there its wall has the slope of the half vector.
// Another groove takes this light if its surface is lower, on a stretch of the line at each crossing. Losses of the
// other wall do not show (docs/model.md 6.11). A groove that is bright in a view therefore leaves whole pieces, a few
// per crossing. All remains of all grooves would take steps of their width (burin/scene/crossings.h): five per
// crossing, in all views. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "burin/optimize/design/glint.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/line_cuts.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Position of a groove's light across it, as a function of the half vector's tilt across it. All grooves are equal
/// except for their depth.
class BrightPlaces {
 public:
  /// Means over the lobe: signed and absolute distance from the middle, and the growth of another groove's reach over
  /// this place per um of its extra depth.
  struct Place {
    double aside_mm = 0, reach_mm = 0, reach_by_depth = 0;
  };

  BrightPlaces(const GrooveProfile& profile, double width_um, double depth_um, double alpha);
  /// `lean_rad` is at least 0.
  Place at(double lean_rad) const;
  /// The largest distance from the middle.
  double most_mm() const { return most_mm_; }

 private:
  static constexpr std::size_t kPlaces = 128;
  double most_mm_ = 0, step_rad_ = 0;
  std::array<Place, kPlaces> places_;
};

/// The bright places of a bench's grooves.
BrightPlaces bright_places(const Scratches& grooves, const Bench& bench, const Board& board);

/// A groove's middle line, and the offset of its glint to the right.
struct GlintLine {
  Eigen::Vector2d a{0, 0}, u{1, 0};
  double length = 0, depth_um = 0;
  BrightPlaces::Place bright;

  Eigen::Vector2d across() const { return {u.y(), -u.x()}; }
  /// Vector from the first end to the last.
  Eigen::Vector2d way() const { return length * u; }
  /// The glinting point, `t` mm from the first end.
  Eigen::Vector2d at(double t) const { return a + t * u + bright.aside_mm * across(); }
};

/// The line of a groove from `a` to `b` in a view.
GlintLine glint_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double depth_um, const GlintView& glint,
                     const BrightPlaces& places);

/// A stretch of a line, removed by another groove.
struct GlintCut : LineStretch {
  std::uint32_t cutter = 0;
};

/// The stretch of i's line removed by groove j.
GlintCut cut_of(const GlintLine& i, const GlintLine& j, std::uint32_t cutter);

/// All grooves of a design, for repeated queries of their remaining pieces.
class GlintCuts {
 public:
  /// `grooves` are the whole carved grooves. Bench and board must outlive this object; the grooves need not.
  GlintCuts(const Scratches& grooves, const Bench& bench, const Board& board);

  /// The remaining pieces of these rows' lines, as whole grooves; `glints[k]` is the view of rows[k]. The pieces' ends
  /// move with the grooves that cut them (pull_back()).
  Carved left_of(std::span<const std::size_t> rows, std::span<const GlintView* const> glints) const;

 private:
  struct Seeker;
  void find_cuts(const GlintLine& line, std::size_t row, Seeker& seeker) const;
  void add_left(std::size_t row, const GlintView& glint, Seeker& seeker, Carved& out) const;

  Scratches grooves_;
  BrightPlaces places_;
  std::vector<GlintLine> lines_;
  double deepest_um_ = 0;
  CellsOfLines cells_;
  std::vector<std::size_t> first_;  // index in listed_ of each cell's lines
  std::vector<std::uint32_t> listed_;
  std::vector<double> x_mm_, y_mm_, ux_, uy_, length_mm_;  // of the listed lines: a cell's are consecutive, for SIMD
};

/// The carved grooves of a design.
struct LyingGrooves {
  /// Each groove whole or, with Crossings::last, as later ones leave it.
  Carved whole;
  std::optional<GlintCuts> cuts{};   ///< if they cut each other's rims away
  std::optional<Carved> in_steps{};  ///< the same in steps, for views that do not use lines

  // NOLINTNEXTLINE(google-explicit-constructor): grooves that nothing cuts
  LyingGrooves(Carved grooves) : whole(std::move(grooves)) {}
};

}  // namespace burin
