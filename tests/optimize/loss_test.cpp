// Proves that every term of the picture loss is what loss.h says, against a plain twin in double that filters each
// pixel with each mask; that the terms and the gamma curve have the gradient they claim, against finite differences;
// that each term sees what it should (E_p blind to a checkerboard, Gram not; Gram blind to where a texture sits inside
// its tile); that masked pixels count for nothing; that threads change no bit.
#include "burin/optimize/loss/loss.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "burin/base/error.h"
#include "burin/optimize/loss/adam.h"
#include "burin/optimize/loss/gram_term.h"
#include "tests/allocations.h"

namespace burin {
namespace {

Image noise(int width, int height, unsigned seed, float low = 0, float high = 1) {
  std::mt19937 random(seed);
  Image image(width, height, 1);
  for (float& v : image.data) v = low + (high - low) * static_cast<float>(random() & 0xffffff) / 0x1000000;
  return image;
}

// Directional derivative by differences along `direction`, next to the gradient's claim.
void expect_gradient(const LossWeights& weights, const Image& mask) {
  const int w = 70, h = 45;  // neither a multiple of tiles nor even on every scale
  PictureLoss loss(noise(w, h, 1), mask, weights);
  const Image picture = noise(w, h, 2);
  Image gradient, scratch;
  loss.evaluate(picture, gradient);
  for (unsigned seed = 10; seed < 16; ++seed) {
    const Image direction = noise(w, h, seed, -1, 1);
    double claimed = 0;
    for (std::size_t i = 0; i < direction.data.size(); ++i)
      claimed += static_cast<double>(gradient.data[i]) * direction.data[i];
    // E is a polynomial of degree <= 4, for which the five-point difference is exact whatever the step: so a large one,
    // against float rounding.
    const auto at = [&](float step) {
      Image moved = picture;
      for (std::size_t i = 0; i < moved.data.size(); ++i) moved.data[i] += step * direction.data[i];
      return loss.evaluate(moved, scratch).total;
    };
    const float step = 0.1F;
    const double slope =
        (8 * (at(step) - at(-step)) - (at(2 * step) - at(-2 * step))) / (12 * static_cast<double>(step));
    double norm = 0;
    for (const float g : gradient.data) norm += static_cast<double>(g) * g;
    EXPECT_NEAR(slope, claimed, 1e-3 * std::sqrt(norm)) << "seed " << seed;
  }
}

TEST(Loss, GradientOfThePerceptualTerm) { expect_gradient({1, 0, 0}, {}); }
TEST(Loss, GradientOfL2) { expect_gradient({0, 1, 0}, {}); }
TEST(Loss, GradientOfTheGramTerm) { expect_gradient({0, 0, 0.01}, {}); }
TEST(Loss, GradientOfAllTermsMasked) { expect_gradient({0.7, 0.2, 0.01}, noise(70, 45, 3)); }

// The loss as loss.h writes it, pixel by pixel in double, and its gradient by the chain rule backwards.
struct Twin {
  int w, h;
  LossValue value;
  std::vector<double> gradient;
};

using Plane = std::vector<double>;

Plane blurred_twin(const Plane& in, int w, int h) {
  Plane out(in.size(), 0.0);
  const std::array<double, 3> g{0.25, 0.5, 0.25};
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          if (x + i >= 0 && x + i < w && y + j >= 0 && y + j < h)
            out[y * w + x] += g[i + 1] * g[j + 1] * in[(y + j) * w + x + i];
  return out;
}

// The eight masks of Frei and Chen, by row.
std::array<std::array<double, 9>, 8> frei_chen() {
  const double r = std::sqrt(2.0);
  std::array<std::array<double, 9>, 8> masks{{{1, r, 1, 0, 0, 0, -1, -r, -1},
                                              {1, 0, -1, r, 0, -r, 1, 0, -1},
                                              {0, -1, r, 1, 0, -1, -r, 1, 0},
                                              {r, -1, 0, -1, 0, 1, 0, 1, -r},
                                              {0, 1, 0, -1, 0, -1, 0, 1, 0},
                                              {-1, 0, 1, 0, 0, 0, 1, 0, -1},
                                              {1, -2, 1, -2, 4, -2, 1, -2, 1},
                                              {-2, 1, -2, 1, 4, 1, -2, 1, -2}}};
  for (auto& mask : masks) {
    double square = 0;
    for (const double m : mask) square += m * m;
    for (double& m : mask) m /= std::sqrt(square);
  }
  return masks;
}

double gram_twin(const Plane& picture, const Plane& target, int w, int h, double unit, int scale, Plane& gradient) {
  if (scale == kGramScales || w < 3 || h < 3) return 0;
  const auto masks = frei_chen();
  const auto respond = [&](const Plane& p, int x, int y) {
    std::array<double, 8> f{};
    for (int k = 0; k < 8; ++k)
      for (int i = 0; i < 9; ++i) f[k] += masks[k][i] * p[(y + i / 3 - 1) * w + x + i % 3 - 1];
    return f;
  };
  double sum = 0;
  for (int ty = 0; ty < h; ty += kGramTilePx)
    for (int tx = 0; tx < w; tx += kGramTilePx) {
      const int x0 = std::max(1, tx), x1 = std::min(w - 1, tx + kGramTilePx);
      const int y0 = std::max(1, ty), y1 = std::min(h - 1, ty + kGramTilePx);
      if (x1 <= x0 || y1 <= y0) continue;
      const double n = (x1 - x0) * (y1 - y0);
      std::array<std::array<double, 8>, 8> excess{};
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
          const auto f = respond(picture, x, y), t = respond(target, x, y);
          for (int a = 0; a < 8; ++a)
            for (int b = 0; b < 8; ++b) excess[a][b] += (f[a] * f[b] - t[a] * t[b]) / n;
        }
      for (const auto& row : excess)
        for (const double e : row) sum += unit * n * e * e;
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
          const auto f = respond(picture, x, y);
          for (int a = 0; a < 8; ++a)
            for (int b = 0; b < 8; ++b)
              for (int i = 0; i < 9; ++i)
                gradient[(y + i / 3 - 1) * w + x + i % 3 - 1] += 4 * unit * excess[a][b] * f[b] * masks[a][i];
        }
    }
  const int hw = w / 2, hh = h / 2;
  const auto halved = [&](const Plane& p) {
    Plane out(static_cast<std::size_t>(hw) * hh);
    for (int y = 0; y < hh; ++y)
      for (int x = 0; x < hw; ++x)
        out[y * hw + x] = 0.25 * (p[2 * y * w + 2 * x] + p[2 * y * w + 2 * x + 1] + p[(2 * y + 1) * w + 2 * x] +
                                  p[(2 * y + 1) * w + 2 * x + 1]);
    return out;
  };
  Plane half_gradient(static_cast<std::size_t>(hw) * hh, 0.0);
  sum += gram_twin(halved(picture), halved(target), hw, hh, 4 * unit, scale + 1, half_gradient);
  for (int y = 0; y < 2 * hh; ++y)
    for (int x = 0; x < 2 * hw; ++x) gradient[y * w + x] += 0.25 * half_gradient[y / 2 * hw + x / 2];
  return sum;
}

Twin twin_of(const Image& picture, const Image& target, const Image& mask, const LossWeights& weights) {
  const int w = target.width, h = target.height;
  Twin twin{w, h, {}, {}};
  Plane difference(target.data.size()), m(target.data.size(), 1.0), seen(target.data.size());
  for (std::size_t i = 0; i < difference.size(); ++i) {
    if (!mask.data.empty()) m[i] = mask.data[i];
    difference[i] = m[i] * (static_cast<double>(picture.data[i]) - target.data[i]);
    seen[i] = target.data[i] + difference[i];
  }
  const Plane b = blurred_twin(difference, w, h), bb = blurred_twin(b, w, h);
  Plane gram(difference.size(), 0.0);
  const Plane t(target.data.begin(), target.data.end());
  twin.value.gram = gram_twin(seen, t, w, h, kGramUnit, 0, gram);
  twin.gradient.resize(difference.size());
  for (std::size_t i = 0; i < difference.size(); ++i) {
    twin.value.perceptual += b[i] * b[i];
    twin.value.l2 += difference[i] * difference[i];
    twin.gradient[i] =
        m[i] * (2 * weights.perceptual * bb[i] + 2 * weights.l2 * difference[i] + weights.gram * gram[i]);
  }
  return twin;
}

TEST(Loss, IsItsTwinInDouble) {
  // Sizes around tiles, packets, the pieces of long rows, and too small for some or all of the scales.
  for (const auto& [w, h] : {std::pair{70, 45}, {64, 64}, {33, 97}, {1100, 40}, {129, 33}, {3, 3}, {2, 5}, {1, 1}})
    for (const bool masked : {false, true})
      for (const LossWeights& weights :
           {LossWeights{1, 0, 0}, LossWeights{0, 1, 0}, LossWeights{0, 0, 0.01}, LossWeights{0.7, 0.2, 0.01}}) {
        const std::string what = std::to_string(w) + " x " + std::to_string(h) + (masked ? ", masked" : "");
        const Image target = noise(w, h, 1), picture = noise(w, h, 2, 0.1F, 0.9F);
        const Image mask = masked ? noise(w, h, 3) : Image{};
        PictureLoss loss(target, mask, weights);
        Image gradient;
        const LossValue value = loss.evaluate(picture, gradient);
        const Twin twin = twin_of(picture, target, mask, weights);
        const auto expect_term = [&](double got, double weight, double expected, double rounding) {
          EXPECT_NEAR(got, weight != 0 ? expected : 0, rounding * expected) << what;
        };
        expect_term(value.perceptual, weights.perceptual, twin.value.perceptual, 1e-6);
        expect_term(value.l2, weights.l2, twin.value.l2, 1e-6);
        expect_term(value.gram, weights.gram, twin.value.gram, 1e-5);
        double error = 0, size = 0;
        for (std::size_t i = 0; i < twin.gradient.size(); ++i) {
          error += std::pow(gradient.data[i] - twin.gradient[i], 2);
          size += std::pow(twin.gradient[i], 2);
        }
        EXPECT_LE(std::sqrt(error), 2e-6 * std::sqrt(size)) << what;
      }
}

TEST(Loss, SameBitsForAnyNumberOfThreads) {
  const Image target = noise(200, 170, 1), picture = noise(200, 170, 2), mask = noise(200, 170, 3);
  for (const bool masked : {false, true}) {
    std::vector<Image> gradients, pictures, back;
    std::vector<double> values;
    for (const int threads : {1, 2, 5}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      PictureLoss loss(target, masked ? mask : Image{}, {1, 0.3, 0.01});
      Image gradient, encoded, d_radiance;
      values.push_back(loss.evaluate(picture, gradient).total);
      picture_from_radiance(picture, 1.7, encoded);
      values.push_back(radiance_gradient(picture, 1.7, encoded, gradient, d_radiance));
      EXPECT_EQ(values[values.size() - 2], values[0]) << threads;
      EXPECT_EQ(values.back(), values[1]) << threads;
      gradients.push_back(gradient);
      pictures.push_back(encoded);
      back.push_back(d_radiance);
      EXPECT_EQ(gradients.back().data, gradients[0].data) << threads;
      EXPECT_EQ(pictures.back().data, pictures[0].data) << threads;
      EXPECT_EQ(back.back().data, back[0].data) << threads;
    }
  }
}

TEST(Loss, GammaCurveToTheLastBits) {
  // Eight decades of light, and none.
  Image radiance(4001, 3, 1), picture;
  for (std::size_t i = 0; i < radiance.data.size(); ++i)
    radiance.data[i] = static_cast<float>(std::pow(10.0, -5 + 8.0 * static_cast<double>(i) / radiance.data.size()));
  radiance.data[7] = 0;
  radiance.data[8] = -3;
  picture_from_radiance(radiance, 1, picture);
  for (std::size_t i = 0; i < radiance.data.size(); ++i) {
    const double light = std::max(0.0F, radiance.data[i]) + static_cast<float>(kGammaOffset);
    EXPECT_NEAR(picture.data[i], std::pow(light, 1 / 2.2), 2.5e-7 * std::pow(light, 1 / 2.2)) << radiance.data[i];
  }
}

TEST(Loss, GradientOfSinglePixelsIncludingCornersAndTileEdges) {
  PictureLoss loss(noise(70, 45, 1), {}, {1, 0.5, 0.01});
  Image picture = noise(70, 45, 2);
  Image gradient, scratch;
  loss.evaluate(picture, gradient);
  for (const auto& [x, y] : {std::pair{0, 0}, {69, 44}, {31, 31}, {32, 32}, {31, 32}, {64, 10}, {69, 0}, {1, 1}}) {
    const float before = picture.at(x, y);
    picture.at(x, y) = before + 0.05F;
    const double up = loss.evaluate(picture, scratch).total;
    picture.at(x, y) = before - 0.05F;
    const double down = loss.evaluate(picture, scratch).total;
    picture.at(x, y) = before;
    EXPECT_NEAR((up - down) / 0.1, gradient.at(x, y), 5e-3) << x << ", " << y;
  }
}

TEST(Loss, IsZeroAtTheTargetAndItsGradientToo) {
  const Image target = noise(64, 64, 5);
  PictureLoss loss(target, {}, {1, 1, 1});
  Image gradient;
  const LossValue value = loss.evaluate(target, gradient);
  EXPECT_NEAR(value.total, 0, 1e-6);
  EXPECT_THAT(gradient.data, testing::Each(testing::FloatNear(0, 1e-3F)));
}

TEST(Loss, PerceptualTermIsBlindToACheckerboardAndGramIsNot) {
  Image flat(64, 64, 1, 0.5F), checker = flat;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) checker.at(x, y) += (x + y) % 2 == 0 ? 0.1F : -0.1F;
  PictureLoss loss(flat, {}, {1, 1, 1});
  Image gradient;
  const LossValue value = loss.evaluate(checker, gradient);
  EXPECT_NEAR(value.l2, 64 * 64 * 0.01, 1e-2);
  EXPECT_LT(value.perceptual, 0.02 * value.l2);  // only the border row and column remain
  // A patch's power is 9 * 0.01, of which its mean (+-0.1 / 9 a pixel) takes 0.01 / 9; one direction holds the rest.
  const double power = 0.09 - 0.01 / 9;
  EXPECT_NEAR(value.gram, kGramUnit * 62 * 62 * power * power, 1.0);
}

TEST(Loss, MaskedPixelsDoNotMatter) {
  const Image target = noise(64, 64, 1);
  Image mask(64, 64, 1, 1.0F);
  for (int y = 20; y < 40; ++y)
    for (int x = 20; x < 40; ++x) mask.at(x, y) = 0;
  PictureLoss loss(target, mask, {1, 1, 0.01});
  Image picture = target;
  for (int y = 20; y < 40; ++y)
    for (int x = 20; x < 40; ++x) picture.at(x, y) = 0;
  Image gradient;
  EXPECT_NEAR(loss.evaluate(picture, gradient).total, 0, 1e-6);
}

TEST(Loss, GammaGradient) {
  Image radiance = noise(20, 10, 4);
  radiance.data[3] = 0;
  radiance.data[4] = -1e-9F;
  const double exposure = 1.7, step = 1e-4;
  Image picture, up, down, d_radiance;
  picture_from_radiance(radiance, exposure, picture);
  const Image d_picture = noise(20, 10, 6, -1, 1);
  const double d_log = radiance_gradient(radiance, exposure, picture, d_picture, d_radiance);
  picture_from_radiance(radiance, exposure * std::exp(step), up);
  picture_from_radiance(radiance, exposure * std::exp(-step), down);
  double numeric = 0;
  for (std::size_t i = 0; i < up.data.size(); ++i)
    numeric += static_cast<double>(d_picture.data[i]) * (up.data[i] - down.data[i]) / (2 * step);
  EXPECT_NEAR(d_log, numeric, 5e-3);
  for (const int i : {0, 10, 100}) {
    const double d = 1e-3 * radiance.data[i];
    Image moved = radiance;
    moved.data[i] += static_cast<float>(d);
    picture_from_radiance(moved, exposure, up);
    moved.data[i] = radiance.data[i] - static_cast<float>(d);
    picture_from_radiance(moved, exposure, down);
    EXPECT_NEAR((up.data[i] - down.data[i]) / (2 * d) * d_picture.data[i], d_radiance.data[i],
                1e-2 * std::abs(d_radiance.data[i]) + 1e-3);
  }
  EXPECT_EQ(d_radiance.data[4], 0);
}

TEST(Loss, TargetsAndPicturesShareTheGammaOffset) {
  const Image encoded = noise(16, 16, 8);
  Image radiance = encoded, picture;
  for (float& v : radiance.data) v = std::pow(v, 2.2F) / 3;
  picture_from_radiance(radiance, 3, picture);
  const Image expected = with_gamma_offset(encoded), shown = shown_picture(radiance, 3);
  for (std::size_t i = 0; i < encoded.data.size(); ++i) {
    EXPECT_NEAR(picture.data[i], expected.data[i], 1e-5);
    EXPECT_NEAR(shown.data[i], encoded.data[i], 1e-5);
  }
}

TEST(Loss, TakesNothingFromTheHeapWhenItsBuffersAreThere) {
  if (!counts_allocations()) GTEST_SKIP() << "malloc is not ours to count here";
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  PictureLoss loss(noise(200, 170, 1), noise(200, 170, 3), {1, 0.3, 0.01});
  const Image radiance = noise(200, 170, 2);
  Image picture, dE_dpicture, dE_dradiance;
  std::vector<double> parameters(9000, 0.1);
  const std::vector<double> gradient(9000, -0.2);
  Adam adam(9000);
  std::size_t before = 0;
  for (int iteration = 0; iteration < 5; ++iteration) {
    if (iteration == 1) before = allocations();
    picture_from_radiance(radiance, 1.7, picture);
    loss.evaluate(picture, dE_dpicture);
    radiance_gradient(radiance, 1.7, picture, dE_dpicture, dE_dradiance);
    adam.step(parameters, gradient, 1e-3);
  }
  EXPECT_EQ(allocations(), before);
}

TEST(Loss, WrongSizesAreErrors) {
  EXPECT_THROW(PictureLoss(noise(8, 8, 1), noise(9, 8, 1), {}), Error);
  PictureLoss loss(noise(8, 8, 1), {}, {});
  Image gradient;
  EXPECT_THROW(loss.evaluate(noise(8, 9, 1), gradient), Error);
}

}  // namespace
}  // namespace burin
