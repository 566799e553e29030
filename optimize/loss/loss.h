// burin/optimize/loss/loss.h - error of a picture against its target, and its gradient by each pixel.
//
//   E = perceptual * || g * D ||^2  +  l2 * || D ||^2  +  gram * E_gram          D = mask * (picture - target)
//
// Pictures are gamma-encoded with white at 1, and have one channel. Sums run over pixels (not means). g is the 3x3
// Gaussian (1 2 1)/4 in each direction (paper, 3.4). It is blind at the pixel grid's highest frequency, which the other
// two terms see.
//
// E_gram replaces the paper's Gram matrices of VGG-19 features, whose weights we cannot ship. It uses a fixed bank: the
// eight Frei-Chen masks (IEEE Trans. Computers C-26, 1977). They are orthonormal 3x3 filters for edges and lines in
// steps of 45 degrees. Each of three scales has half the size of its predecessor. Tiles of kGramTilePx pixels replace
// the whole picture, because a picture is no single texture:
//   E_gram = kGramUnit * sum over scales s, tiles of  4^s n || G(picture) - G(target) ||_F^2,  G = (1/n) sum of f f^T
// with f the eight responses at one of the tile's n pixels. Like the paper's term, it rewards the right amount and
// direction of local contrast, independent of its position. Isolated bright scratches (outliers) violate this. It does
// not recognize objects, unlike VGG's deeper layers. burin/optimize/loss/gram_term.h computes it.
//
// All gradients are exact (tests: finite differences). The same bits result for any number of threads. Source:
// docs/model.md 6.1 to 6.4.
#pragma once

#include <memory>

#include "burin/base/image.h"

namespace burin {

/// Weights of the loss' terms: docs/model.md 6.
struct LossWeights {
  double perceptual = 1;  ///< the paper's lambda_p
  double l2 = 0;          ///< plain squared differences
  double gram = 0.01;     ///< the paper's lambda_g, in units of kGramUnit (gram_term.h)
};
/// The weights times `factor`.
inline LossWeights times(double factor, const LossWeights& weights) {
  return {factor * weights.perceptual, factor * weights.l2, factor * weights.gram};
}

/// The terms before weighting, and their weighted sum.
struct LossValue {
  double perceptual = 0, l2 = 0, gram = 0;
  double total = 0;
};

/// The loss against one target. It holds the target's moments and the work buffers: evaluate() allocates nothing if
/// dE_dpicture has the picture's size.
class PictureLoss {
 public:
  /// `target` has one channel. `mask` is empty (no pixels) or of the target's size, from 0 (ignored) to 1. Throws Error
  /// if sizes or channels differ.
  PictureLoss(Image target, Image mask, const LossWeights& weights);
  ~PictureLoss();
  PictureLoss(PictureLoss&&) noexcept;
  PictureLoss& operator=(PictureLoss&&) noexcept;

  /// The target of the comparison.
  const Image& target() const;

  /// Loss of a picture of the target's size; dE_dpicture is resized and overwritten. Terms of weight 0 are not computed
  /// and are 0 in the result.
  LossValue evaluate(const Image& picture, Image& dE_dpicture);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Converts radiance to a picture: (max(0, exposure * radiance) + kGammaOffset)^(1 / 2.2). The offset keeps the slope
/// finite in black. Targets pass through with_gamma_offset(), so equal light has equal values.
inline constexpr double kGammaOffset = 1e-3;
void picture_from_radiance(const Image& radiance, double exposure, Image& picture);

/// Chain rule of picture_from_radiance: dE/dradiance from dE/dpicture (of the radiance's size, overwritten). Returns dE
/// / d log(exposure).
double radiance_gradient(const Image& radiance, double exposure, const Image& picture, const Image& dE_dpicture,
                         Image& dE_dradiance);

/// Converts a gamma-encoded picture (0..1) to the values of picture_from_radiance: (value^2.2 + kGammaOffset)^(1 /
/// 2.2).
Image with_gamma_offset(const Image& encoded);

/// The picture as shown: (max(0, exposure * radiance))^(1 / 2.2), clipped at white.
Image shown_picture(const Image& radiance, double exposure);

}  // namespace burin
