// burin/optimize/design/glint_lines.h - grooves that cut each other's rims away (Crossings::deepest), as one place sees
// them.
//
// Seen from one place, under one lamp, a groove glints along a line: where its wall has the lean that the half vector
// asks for. There another groove takes its light where that one's surface is lower, which is a stretch of the line at
// each crossing; and what its other wall loses is not missed (docs/model.md 6.11). So of a groove that is bright in a
// view whole pieces are left, a few for each crossing, where all that is left of all grooves takes steps of their width
// (burin/scene/crossings.h), five for each, in all views.
// Frame: board, mm.
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

/// Where across a groove its light comes from, by how far the half vector leans across it; of grooves that are all
/// alike but for their depth.
class BrightPlaces {
 public:
  /// Mean over the lobe of the distance from the middle, to one side and whichever side; and how much further another
  /// groove reaches over such a place that is a um deeper.
  struct Place {
    double aside_mm = 0, reach_mm = 0, reach_by_depth = 0;
  };

  BrightPlaces(const GrooveProfile& profile, double width_um, double depth_um, double alpha);
  /// `lean_rad` from 0 on.
  Place at(double lean_rad) const;
  /// The farthest that one can be from the middle.
  double most_mm() const { return most_mm_; }

 private:
  static constexpr std::size_t kPlaces = 128;
  double most_mm_ = 0, step_rad_ = 0;
  std::array<Place, kPlaces> places_;
};

/// Those of a bench's grooves.
BrightPlaces bright_places(const Scratches& grooves, const Bench& bench, const Board& board);

/// A groove's middle line, and where beside it, to its right, it glints.
struct GlintLine {
  Eigen::Vector2d a{0, 0}, u{1, 0};
  double length = 0, depth_um = 0;
  BrightPlaces::Place bright;

  Eigen::Vector2d across() const { return {u.y(), -u.x()}; }
  /// From its first end to its last.
  Eigen::Vector2d way() const { return length * u; }
  /// The glinting place, `t` mm from the first end.
  Eigen::Vector2d at(double t) const { return a + t * u + bright.aside_mm * across(); }
};

/// The line of a groove from `a` to `b` as a view sees it.
GlintLine glint_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double depth_um, const GlintView& glint,
                     const BrightPlaces& places);

/// A stretch of a line that another groove takes.
struct GlintCut : LineStretch {
  std::uint32_t cutter = 0;
};

/// What groove j takes of i's line.
GlintCut cut_of(const GlintLine& i, const GlintLine& j, std::uint32_t cutter);

/// All grooves of a design, to be asked again and again for what is left of some of them.
class GlintCuts {
 public:
  /// `grooves`: as they lie in the metal, whole; bench and board must outlive it, the grooves need not.
  GlintCuts(const Scratches& grooves, const Bench& bench, const Board& board);

  /// What others leave of the lines of these rows, as whole grooves: `glints[k]` is what sees rows[k]. Pieces' ends
  /// move with the grooves that cut them (pull_back()).
  Carved left_of(std::span<const std::size_t> rows, std::span<const GlintView* const> glints) const;

 private:
  void add_left(std::size_t row, const GlintView& glint, std::vector<std::uint32_t>& near, std::vector<GlintCut>& cuts,
                Carved& out) const;

  Scratches grooves_;
  BrightPlaces places_;
  std::vector<GlintLine> lines_;
  CellsOfLines cells_;
  std::vector<std::size_t> first_;  // of each cell's lines in listed_
  std::vector<std::uint32_t> listed_;
};

/// A design's grooves in the metal.
struct LyingGrooves {
  /// Each whole, or (Crossings::last) as later ones leave it.
  Carved whole;
  std::optional<GlintCuts> cuts{};   ///< where they cut each other's rims away
  std::optional<Carved> in_steps{};  ///< the same, for views that do not see them as lines

  // NOLINTNEXTLINE(google-explicit-constructor): grooves that nothing cuts
  LyingGrooves(Carved grooves) : whole(std::move(grooves)) {}
};

}  // namespace burin
