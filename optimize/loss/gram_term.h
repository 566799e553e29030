// burin/optimize/loss/gram_term.h - the Gram term of burin/optimize/loss/loss.h: difference of local contrast between a
// picture and its target.
//
// The eight Frei-Chen masks are an orthonormal basis of the 3x3 patches without mean. A Frobenius norm is equal in any
// such basis, so the code applies no filter. With M the 9x9 moments of a tile's patches and P the projection that
// removes a patch's mean, ||G(picture) - G(target)||_F = ||P (M(picture) - M(target)) P||_F / n. The derivative by a
// patch p is proportional to P (M - M_target) P p. docs/model.md 6.4.
#pragma once

#include <array>
#include <vector>

#include "burin/base/image.h"

namespace burin {

inline constexpr int kGramScales = 3;   ///< full size, half, quarter
inline constexpr int kGramTilePx = 32;  ///< side of a tile on every scale
/// Scales the term: with weight 0.01, white noise of 0.13 costs as much here as in E_p.
inline constexpr double kGramUnit = 100;

class GramTerm {
 public:
  /// The target has one channel.
  explicit GramTerm(const Image& target);

  /// E_gram of a picture of the target's size. Adds weight * dE_gram/dpicture to `gradient`. The same bits result for
  /// any number of threads.
  double add(const Image& picture, double weight, Image& gradient);

 private:
  /// The patch centers of one tile: x0 <= x < x1, y0 <= y < y1, at least one pixel away from the image's edge.
  struct Tile {
    int x0, y0, x1, y1;
    std::array<float, 81> target;  ///< P M P / n of the target
    double part = 0;               ///< of E_gram
  };
  struct Scale {
    Image picture, gradient;  ///< empty on the first scale, which uses the caller's
    std::vector<std::vector<Tile>> rows;
  };

  void shrink(const Image& picture);

  std::vector<Scale> scales_;
};

}  // namespace burin
