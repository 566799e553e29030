// burin/render/surroundings/groove_light.h - a groove's light in a pixel, from its light across as a curve.
// docs/model.md 10.8 to 10.10.
//
// Units are half the groove's width, with t across it and Y along it. Let a light R(t) depend on the position across
// alone. By Green's theorem (as in model.md 4.2) its integral over pixel and groove is one along the pixel's edges.
// Every piece of an edge needs the integrals of R and t R between two positions. R is a cubic between nodes, so these
// are exact.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace burin {

/// R over t from -half_count * step to half_count * step, with its running integrals.
struct LightCurve {
  struct Node {
    double light, slope, sum, sum_of_sums;  ///< R, dR/dt, integral of R, integral of `sum`
  };
  double step = 1;
  int half_count = 0;
  std::vector<Node> nodes;  ///< 2 half_count + 1

  struct At {
    double light, sum, sum_of_sums;
  };
  At at(double t) const;  ///< clamped to the curve's ends
};
/// Makes a curve from values at the nodes.
void make_curve(const std::vector<double>& light, double step, LightCurve& curve);

/// The region common to a pixel and a groove: pieces of the pixel's edges, cut at the groove's ends.
struct GroovePieces {
  struct Piece {
    double t1, y1, t2, y2;  ///< y within the groove's length
    enum class Kind { inside, at_start, at_end } kind;
  };
  std::array<Piece, 24> piece;
  int count = 0;
  double way = 1;                            ///< 1: the pixel's corners run counter-clockwise in (t, Y); -1
  double left_extent = 0, right_extent = 0;  ///< length of the pixel along the groove at its rims
};
/// `corners`: (t, Y) in the scratch's frame. The groove is |t| <= rim, 0 <= Y <= length.
GroovePieces groove_pieces(const std::array<Eigen::Vector2d, 4>& corners, double rim, double length);

/// The integral of R over the common region, and its derivatives, all in units of half the groove's width.
struct PieceSums {
  double value = 0;
  double by_shift_t = 0, by_shift_y = 0;  ///< the pixel moves across and along
  double by_turn = 0;                     ///< the pixel turns about the scratch's first end, counter-clockwise
  double by_length = 0, by_rim = 0;
  double by_growth = 0;  ///< the pixel grows about the first end: by the logarithm
};
double piece_value(const GroovePieces& pieces, const LightCurve& curve);
PieceSums piece_sums(const GroovePieces& pieces, const LightCurve& curve, double rim);

/// piece_value() and piece_sums() for R = 1: areas.
double piece_area(const GroovePieces& pieces);
PieceSums piece_area_sums(const GroovePieces& pieces);

}  // namespace burin
