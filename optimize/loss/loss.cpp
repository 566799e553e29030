#include "burin/optimize/loss/loss.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/machine_clones.h"
#include "burin/optimize/loss/bands.h"
#include "burin/optimize/loss/gram_term.h"
#include "burin/optimize/loss/lane_sum.h"

namespace burin {
namespace {

/// Pieces of a row whose column sums stay in the first cache.
constexpr int kPiece = 512;

/// out = g * in for one row of pixels, zeros outside; g = (1 2 1)/4 in both directions is its own adjoint. `row(k, x)`
/// is the pixel x of the row above (k = 0), here (1), below (2).
template <typename Row, typename Use>
BURIN_INLINED void blur_row(int width, const Row& row, const Use& use) {
  alignas(64) float column[kPiece + 2];
  for (int x0 = 0; x0 < width; x0 += kPiece) {
    const int n = std::min(kPiece, width - x0);
    const int first = x0 > 0 ? 0 : 1, end = x0 + n < width ? n + 2 : n + 1;
    column[0] = column[n + 1] = 0;
    for (int i = first; i < end; ++i) {
      const int x = x0 + i - 1;
      column[i] = 0.25F * (row(0, x) + 2 * row(1, x) + row(2, x));
    }
    for (int i = 0; i < n; ++i) use(x0 + i, 0.25F * (column[i] + 2 * column[i + 1] + column[i + 2]));
  }
}

struct RowInput {
  const float *picture, *target, *mask;

  template <bool kMasked>
  BURIN_INLINED float difference(int x) const {
    return kMasked ? mask[x] * (picture[x] - target[x]) : picture[x] - target[x];
  }
};

template <bool kMasked>
BURIN_INLINED float blurred_difference(const RowInput (&rows)[3], int width, float* out) {
  blur_row(
      width, [&](int k, int x) { return rows[k].difference<kMasked>(x); }, [&](int x, float v) { out[x] = v; });
  LaneSum sum;
  sum.add(width, [&](int x) { return out[x] * out[x]; });
  return sum.total();
}

/// out = g * mask * (picture - target); returns the sum of its squares.
BURIN_MACHINE_CLONES float blurred_difference_row(const RowInput (&rows)[3], int width, float* out) {
  return rows[1].mask != nullptr ? blurred_difference<true>(rows, width, out)
                                 : blurred_difference<false>(rows, width, out);
}

template <bool kMasked>
BURIN_INLINED float gradient(const RowInput& row, const float* const (&blurred)[3], int width, float perceptual,
                             float l2, float* out) {
  if (perceptual != 0)
    blur_row(
        width, [&](int k, int x) { return blurred[k][x]; }, [&](int x, float v) { out[x] = perceptual * v; });
  else
    std::fill(out, out + width, 0.0F);
  if (l2 == 0) return 0;
  for (int x = 0; x < width; ++x) out[x] += l2 * row.difference<kMasked>(x);
  LaneSum sum;
  sum.add(width, [&](int x) { return row.difference<kMasked>(x) * row.difference<kMasked>(x); });
  return sum.total();
}

/// out = perceptual * g * blurred + l2 * difference; returns the sum of the squared differences if l2 is not 0.
BURIN_MACHINE_CLONES float gradient_row(const RowInput& row, const float* const (&blurred)[3], int width,
                                        float perceptual, float l2, float* out) {
  return row.mask != nullptr ? gradient<true>(row, blurred, width, perceptual, l2, out)
                             : gradient<false>(row, blurred, width, perceptual, l2, out);
}

}  // namespace

struct PictureLoss::State {
  Image target, mask;
  LossWeights weights;
  Image blurred;             ///< g * difference
  Image seen;                ///< with a mask: input of the Gram term
  std::vector<float> zeros;  ///< a row beyond the edge
  std::optional<GramTerm> gram;

  RowInput row(const Image& picture, int y) const {
    if (y < 0 || y >= target.height) return {zeros.data(), zeros.data(), mask.data.empty() ? nullptr : zeros.data()};
    const std::size_t i = static_cast<std::size_t>(y) * target.width;
    return {&picture.data[i], &target.data[i], mask.data.empty() ? nullptr : &mask.data[i]};
  }
  const float* blurred_row(int y) const {
    if (y < 0 || y >= target.height || blurred.data.empty()) return zeros.data();
    return &blurred.data[static_cast<std::size_t>(y) * target.width];
  }
};

PictureLoss::PictureLoss(Image target, Image mask, const LossWeights& weights) : state_(std::make_unique<State>()) {
  const std::string size = std::to_string(target.width) + " x " + std::to_string(target.height);
  if (target.channels != 1 || target.width < 1 || target.height < 1)
    fail("loss", "the target is " + size + " with " + std::to_string(target.channels) + " channels",
         "give one channel and at least one pixel");
  if (!mask.data.empty() && (mask.width != target.width || mask.height != target.height || mask.channels != 1))
    fail("loss",
         "the mask is " + std::to_string(mask.width) + " x " + std::to_string(mask.height) + ", the target " + size,
         "give a mask of one channel and the target's size");
  State& s = *state_;
  s.target = std::move(target);
  s.mask = std::move(mask);
  s.weights = weights;
  s.zeros.assign(s.target.width, 0.0F);
  if (weights.perceptual != 0) s.blurred = Image(s.target.width, s.target.height, 1);
  if (weights.gram != 0) {
    s.gram.emplace(s.target);
    if (!s.mask.data.empty()) s.seen = s.target;
  }
}

PictureLoss::~PictureLoss() = default;
PictureLoss::PictureLoss(PictureLoss&&) noexcept = default;
PictureLoss& PictureLoss::operator=(PictureLoss&&) noexcept = default;

const Image& PictureLoss::target() const { return state_->target; }

LossValue PictureLoss::evaluate(const Image& picture, Image& dE_dpicture) {
  State& s = *state_;
  const int w = s.target.width, h = s.target.height;
  if (picture.width != w || picture.height != h || picture.channels != 1)
    fail("loss",
         "the picture is " + std::to_string(picture.width) + " x " + std::to_string(picture.height) + ", the target " +
             std::to_string(w) + " x " + std::to_string(h),
         "render it on the target's grid");
  if (dE_dpicture.data.size() != picture.data.size() || dE_dpicture.width != w) dE_dpicture = Image(w, h, 1);
  const bool masked = !s.mask.data.empty();
  LossValue value;

  if (s.weights.perceptual != 0)
    value.perceptual = sum_over_bands(h, [&](int first, int end) {
      double sum = 0;
      for (int y = first; y < end; ++y) {
        const RowInput rows[3] = {s.row(picture, y - 1), s.row(picture, y), s.row(picture, y + 1)};
        sum += blurred_difference_row(rows, w, &s.blurred.data[static_cast<std::size_t>(y) * w]);
      }
      return sum;
    });

  const auto perceptual = static_cast<float>(2 * s.weights.perceptual), l2 = static_cast<float>(2 * s.weights.l2);
  value.l2 = sum_over_bands(h, [&](int first, int end) {
    double sum = 0;
    for (int y = first; y < end; ++y) {
      const float* blurred[3] = {s.blurred_row(y - 1), s.blurred_row(y), s.blurred_row(y + 1)};
      sum += gradient_row(s.row(picture, y), blurred, w, perceptual, l2,
                          &dE_dpicture.data[static_cast<std::size_t>(y) * w]);
    }
    return sum;
  });

  if (s.gram) {
    if (masked) {
      // The Gram matrices see the target itself in masked pixels.
      for (std::size_t i = 0; i < s.seen.data.size(); ++i)
        s.seen.data[i] = s.target.data[i] + s.mask.data[i] * (picture.data[i] - s.target.data[i]);
    }
    value.gram = s.gram->add(masked ? s.seen : picture, s.weights.gram, dE_dpicture);
  }
  if (masked)
    for (std::size_t i = 0; i < dE_dpicture.data.size(); ++i) dE_dpicture.data[i] *= s.mask.data[i];

  value.total = s.weights.perceptual * value.perceptual + s.weights.l2 * value.l2 + s.weights.gram * value.gram;
  return value;
}

}  // namespace burin
