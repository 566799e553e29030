#include "optimize/loss.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "render/error.h"

namespace burin {
namespace {

constexpr float kInverseGamma = 1.0F / 2.2F;
constexpr int kBandRows = 16;  // rows a task works on; also the unit of the fixed-order sums

// Calls body(first_row, end_row, band) for fixed bands of rows, in parallel.
template <typename Body>
void for_bands(int rows, const Body& body) {
  const int bands = (rows + kBandRows - 1) / kBandRows;
  tbb::parallel_for(0, bands, [&](int band) { body(band * kBandRows, std::min(rows, (band + 1) * kBandRows), band); });
}

double sum_in_order(const std::vector<double>& parts) {
  double sum = 0;
  for (const double part : parts) sum += part;
  return sum;
}

int band_count(int rows) { return (rows + kBandRows - 1) / kBandRows; }

// out = g * in with zeros outside; g = (1 2 1)/4 in both directions, its own adjoint.
void blur_rows(const Image& in, Image& out, int first, int end) {
  const int w = in.width;
  std::vector<float> column(static_cast<std::size_t>(w) + 2, 0.0F);
  const std::vector<float> zeros(w, 0.0F);
  for (int y = first; y < end; ++y) {
    const float* above = y > 0 ? &in.data[static_cast<std::size_t>(y - 1) * w] : zeros.data();
    const float* here = &in.data[static_cast<std::size_t>(y) * w];
    const float* below = y + 1 < in.height ? &in.data[static_cast<std::size_t>(y + 1) * w] : zeros.data();
    float* c = column.data() + 1;
    for (int x = 0; x < w; ++x) c[x] = 0.25F * (above[x] + 2 * here[x] + below[x]);
    float* o = &out.data[static_cast<std::size_t>(y) * w];
    for (int x = 0; x < w; ++x) o[x] = 0.25F * (c[x - 1] + 2 * c[x] + c[x + 1]);
  }
}

double row_squares(const Image& image, int first, int end) {
  double sum = 0;
  for (int y = first; y < end; ++y) {
    // A few independent sums: faster, and in a fixed order.
    std::array<float, 16> lanes{};
    const float* row = &image.data[static_cast<std::size_t>(y) * image.width];
    int x = 0;
    for (; x + 16 <= image.width; x += 16)
      for (int k = 0; k < 16; ++k) lanes[k] += row[x + k] * row[x + k];
    for (; x < image.width; ++x) lanes[0] += row[x] * row[x];
    for (const float lane : lanes) sum += lane;
  }
  return sum;
}

// ---- The Gram term -------------------------------------------------------------------------------------------------

using Patch9 = Eigen::Matrix<float, 9, 9>;
using Gram = Eigen::Matrix<float, 8, 8>;
using Patches = Eigen::Matrix<float, 9, Eigen::Dynamic, Eigen::RowMajor>;

// The Frei-Chen masks but the mean, one a row; columns are the 3x3 neighbours, row by row.
Eigen::Matrix<float, 8, 9> frei_chen() {
  const float r = std::sqrt(2.0F), e = 1 / (2 * r), h = 0.5F, s = 1 / 6.0F;
  Eigen::Matrix<float, 8, 9> M;
  M.row(0) << e, e * r, e, 0, 0, 0, -e, -e * r, -e;
  M.row(1) << e, 0, -e, e * r, 0, -e * r, e, 0, -e;
  M.row(2) << 0, -e, e * r, e, 0, -e, -e * r, e, 0;
  M.row(3) << e * r, -e, 0, -e, 0, e, 0, e, -e * r;
  M.row(4) << 0, h, 0, -h, 0, -h, 0, h, 0;
  M.row(5) << -h, 0, h, 0, 0, 0, h, 0, -h;
  M.row(6) << s, -2 * s, s, -2 * s, 4 * s, -2 * s, s, -2 * s, s;
  M.row(7) << -2 * s, s, -2 * s, s, 4 * s, s, -2 * s, s, -2 * s;
  return M;
}

// The patch centres of one tile: x0 <= x < x1, y0 <= y < y1, a pixel off the image's edge.
struct Tile {
  int x0, y0, x1, y1;
  int count() const { return (x1 - x0) * (y1 - y0); }
};

// Tiles of an image, grouped in four colours: tiles of one colour share no pixel, not even through their borders.
std::array<std::vector<Tile>, 4> gram_tiles(int width, int height) {
  std::array<std::vector<Tile>, 4> tiles;
  for (int ty = 0; ty * kGramTilePx < height; ++ty)
    for (int tx = 0; tx * kGramTilePx < width; ++tx) {
      const Tile t{std::max(1, tx * kGramTilePx), std::max(1, ty * kGramTilePx),
                   std::min(width - 1, (tx + 1) * kGramTilePx), std::min(height - 1, (ty + 1) * kGramTilePx)};
      if (t.x1 > t.x0 && t.y1 > t.y0) tiles[(ty % 2) * 2 + tx % 2].push_back(t);
    }
  return tiles;
}

// All 3x3 neighbourhoods of a tile, one a column.
void gather_patches(const Image& image, const Tile& t, Patches& patches) {
  const int n = t.x1 - t.x0;
  patches.resize(9, t.count());
  for (int k = 0; k < 9; ++k)
    for (int y = t.y0; y < t.y1; ++y) {
      const float* from = &image.data[static_cast<std::size_t>(y + k / 3 - 1) * image.width + t.x0 + k % 3 - 1];
      std::copy_n(from, n, &patches(k, static_cast<Eigen::Index>(y - t.y0) * n));
    }
}

void scatter_patches(const Patches& patches, const Tile& t, Image& sum) {
  const int n = t.x1 - t.x0;
  for (int k = 0; k < 9; ++k)
    for (int y = t.y0; y < t.y1; ++y) {
      float* to = &sum.data[static_cast<std::size_t>(y + k / 3 - 1) * sum.width + t.x0 + k % 3 - 1];
      const float* from = &patches(k, static_cast<Eigen::Index>(y - t.y0) * n);
      for (int x = 0; x < n; ++x) to[x] += from[x];
    }
}

// Means of 2x2 pixels; an odd last row or column is left out.
void halve(const Image& in, Image& out) {
  for_bands(out.height, [&](int first, int end, int) {
    for (int y = first; y < end; ++y) {
      const float* a = &in.data[static_cast<std::size_t>(2) * y * in.width];
      const float* b = a + in.width;
      float* o = &out.data[static_cast<std::size_t>(y) * out.width];
      for (int x = 0; x < out.width; ++x) o[x] = 0.25F * (a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1]);
    }
  });
}

void add_halve_adjoint(const Image& d_half, Image& d_full) {
  for_bands(d_half.height, [&](int first, int end, int) {
    for (int y = first; y < end; ++y) {
      const float* h = &d_half.data[static_cast<std::size_t>(y) * d_half.width];
      float* a = &d_full.data[static_cast<std::size_t>(2) * y * d_full.width];
      float* b = a + d_full.width;
      for (int x = 0; x < d_half.width; ++x) {
        const float q = 0.25F * h[x];
        a[2 * x] += q;
        a[2 * x + 1] += q;
        b[2 * x] += q;
        b[2 * x + 1] += q;
      }
    }
  });
}

}  // namespace

struct PictureLoss::State {
  struct Scale {
    Image picture, gradient;
    std::array<std::vector<Tile>, 4> tiles;
    std::array<std::vector<Gram>, 4> target;  // G of the target, by colour and tile
    std::array<std::vector<double>, 4> parts;
  };

  Image target, mask;
  LossWeights weights;
  Image difference, blurred;
  std::vector<double> parts;
  Eigen::Matrix<float, 8, 9> bank = frei_chen();
  std::vector<Scale> scales;

  void fill_scales(const Image& full) {
    scales[0].picture.data = full.data;
    for (std::size_t s = 1; s < scales.size(); ++s) halve(scales[s - 1].picture, scales[s].picture);
  }

  Gram gram_of(const Patches& patches) const {
    // Through the 9x9 moments of the raw patches: cheaper than filtering every pixel.
    const Patch9 moments = patches * patches.transpose();
    return bank * moments * bank.transpose() / static_cast<float>(patches.cols());
  }

  void prepare_gram() {
    int w = target.width, h = target.height;
    for (int s = 0; s < kGramScales && w >= 3 && h >= 3; ++s, w /= 2, h /= 2) {
      Scale scale;
      scale.picture = Image(w, h, 1);
      scale.gradient = Image(w, h, 1);
      scale.tiles = gram_tiles(w, h);
      scales.push_back(std::move(scale));
    }
    if (scales.empty()) return;
    fill_scales(target);
    Patches patches;
    for (Scale& scale : scales)
      for (int colour = 0; colour < 4; ++colour) {
        for (const Tile& tile : scale.tiles[colour]) {
          gather_patches(scale.picture, tile, patches);
          scale.target[colour].push_back(gram_of(patches));
        }
        scale.parts[colour].resize(scale.tiles[colour].size());
      }
  }

  // Adds weight * dE_gram/dpicture to `gradient`; returns E_gram.
  double add_gram(const Image& picture, double weight, Image& gradient) {
    if (scales.empty()) return 0;
    fill_scales(picture);
    double sum = 0;
    double area = kGramUnit;  // kGramUnit 4^s
    for (Scale& scale : scales) {
      std::fill(scale.gradient.data.begin(), scale.gradient.data.end(), 0.0F);
      for (int colour = 0; colour < 4; ++colour) {
        const auto& tiles = scale.tiles[colour];
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tiles.size(), 4), [&](const auto& range) {
          Patches patches, d_patches;
          for (std::size_t i = range.begin(); i < range.end(); ++i) {
            gather_patches(scale.picture, tiles[i], patches);
            const Gram excess = gram_of(patches) - scale.target[colour][i];
            scale.parts[colour][i] = area * tiles[i].count() * static_cast<double>(excess.squaredNorm());
            // f = bank p, so dE/dp = bank^T (4 excess) bank p.
            const Patch9 A = static_cast<float>(4 * area * weight) * (bank.transpose() * excess * bank);
            d_patches.noalias() = A * patches;
            scatter_patches(d_patches, tiles[i], scale.gradient);
          }
        });
        sum += sum_in_order(scale.parts[colour]);
      }
      area *= 4;
    }
    for (std::size_t s = scales.size(); s-- > 1;) add_halve_adjoint(scales[s].gradient, scales[s - 1].gradient);
    for_bands(picture.height, [&](int first, int end, int) {
      const std::size_t w = picture.width;
      for (std::size_t i = first * w; i < end * w; ++i) gradient.data[i] += scales[0].gradient.data[i];
    });
    return sum;
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
  state_->target = std::move(target);
  state_->mask = std::move(mask);
  state_->weights = weights;
  state_->difference = Image(state_->target.width, state_->target.height, 1);
  state_->blurred = state_->difference;
  state_->parts.resize(band_count(state_->target.height));
  if (weights.gram != 0) state_->prepare_gram();
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

  for_bands(h, [&](int first, int end, int band) {
    const std::size_t from = static_cast<std::size_t>(first) * w, to = static_cast<std::size_t>(end) * w;
    for (std::size_t i = from; i < to; ++i) s.difference.data[i] = picture.data[i] - s.target.data[i];
    if (masked)
      for (std::size_t i = from; i < to; ++i) s.difference.data[i] *= s.mask.data[i];
    if (s.weights.l2 != 0) s.parts[band] = row_squares(s.difference, first, end);
  });
  if (s.weights.l2 != 0) value.l2 = sum_in_order(s.parts);

  if (s.weights.perceptual != 0) {
    for_bands(h, [&](int first, int end, int band) {
      blur_rows(s.difference, s.blurred, first, end);
      s.parts[band] = row_squares(s.blurred, first, end);
    });
    value.perceptual = sum_in_order(s.parts);
  }

  const float p2 = static_cast<float>(2 * s.weights.perceptual), l2 = static_cast<float>(2 * s.weights.l2);
  for_bands(h, [&](int first, int end, int) {
    const std::size_t from = static_cast<std::size_t>(first) * w, to = static_cast<std::size_t>(end) * w;
    if (p2 != 0) {
      blur_rows(s.blurred, dE_dpicture, first, end);
      for (std::size_t i = from; i < to; ++i)
        dE_dpicture.data[i] = p2 * dE_dpicture.data[i] + l2 * s.difference.data[i];
    } else {
      for (std::size_t i = from; i < to; ++i) dE_dpicture.data[i] = l2 * s.difference.data[i];
    }
  });

  if (s.weights.gram != 0) {
    if (masked) {
      // The Gram matrices see the target itself where the picture does not matter.
      Image& seen = s.blurred;
      for (std::size_t i = 0; i < seen.data.size(); ++i) seen.data[i] = s.target.data[i] + s.difference.data[i];
      value.gram = s.add_gram(seen, s.weights.gram, dE_dpicture);
    } else {
      value.gram = s.add_gram(picture, s.weights.gram, dE_dpicture);
    }
  }
  if (masked)
    for (std::size_t i = 0; i < dE_dpicture.data.size(); ++i) dE_dpicture.data[i] *= s.mask.data[i];

  value.total = s.weights.perceptual * value.perceptual + s.weights.l2 * value.l2 + s.weights.gram * value.gram;
  return value;
}

Image blurred(const Image& image) {
  Image out(image.width, image.height, 1);
  for_bands(image.height, [&](int first, int end, int) { blur_rows(image, out, first, end); });
  return out;
}

void picture_from_radiance(const Image& radiance, double exposure, Image& picture) {
  if (picture.data.size() != radiance.data.size() || picture.width != radiance.width)
    picture = Image(radiance.width, radiance.height, radiance.channels);
  const auto e = static_cast<float>(exposure);
  const auto c = static_cast<float>(kGammaOffset);
  for_bands(radiance.height, [&](int first, int end, int) {
    const std::size_t n = static_cast<std::size_t>(radiance.width) * radiance.channels;
    for (std::size_t i = first * n; i < end * n; ++i)
      picture.data[i] = std::pow(std::max(0.0F, e * radiance.data[i]) + c, kInverseGamma);
  });
}

double radiance_gradient(const Image& radiance, double exposure, const Image& picture, const Image& dE_dpicture,
                         Image& dE_dradiance) {
  if (dE_dradiance.data.size() != radiance.data.size() || dE_dradiance.width != radiance.width)
    dE_dradiance = Image(radiance.width, radiance.height, radiance.channels);
  const auto e = static_cast<float>(exposure);
  const auto c = static_cast<float>(kGammaOffset);
  std::vector<double> parts(band_count(radiance.height));
  for_bands(radiance.height, [&](int first, int end, int band) {
    const std::size_t n = static_cast<std::size_t>(radiance.width) * radiance.channels;
    double sum = 0;
    for (std::size_t i = first * n; i < end * n; ++i) {
      const float light = e * radiance.data[i];
      const float slope = light > 0 ? kInverseGamma * picture.data[i] / (light + c) : 0.0F;
      dE_dradiance.data[i] = dE_dpicture.data[i] * slope * e;
      sum += static_cast<double>(dE_dradiance.data[i]) * radiance.data[i];
    }
    parts[band] = sum;
  });
  return sum_in_order(parts);
}

Image with_gamma_offset(const Image& encoded) {
  Image out = encoded;
  for (float& v : out.data)
    v = std::pow(std::pow(std::max(0.0F, v), 2.2F) + static_cast<float>(kGammaOffset), kInverseGamma);
  return out;
}

Image shown_picture(const Image& radiance, double exposure) {
  Image out = radiance;
  const auto e = static_cast<float>(exposure);
  for (float& v : out.data) v = std::min(1.0F, std::pow(std::max(0.0F, e * v), kInverseGamma));
  return out;
}

}  // namespace burin
