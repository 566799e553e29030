#include "burin/capture/noise.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "burin/base/median.h"

namespace burin {
namespace {

constexpr int kBins = 28;  // of brightness, half a factor of two each, from 2^-14 of the white level
constexpr std::size_t kLeastInBin = 400;

int bin_of(float v) {
  if (!(v > 0)) return -1;
  const int bin = static_cast<int>(std::floor(2 * (std::log2(v) + 14)));
  return bin < kBins ? bin : -1;
}

// 1 where the pixel and its eight neighbors are unclipped.
std::vector<std::uint8_t> clear_of_clipping(const LinearPhoto& photo) {
  const int w = photo.value.width, h = photo.value.height;
  std::vector<std::uint8_t> clear(photo.clipped.size(), 1);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      if (photo.clipped[static_cast<std::size_t>(y) * w + x])
        for (int yy = std::max(0, y - 1); yy <= std::min(h - 1, y + 1); ++yy)
          for (int xx = std::max(0, x - 1); xx <= std::min(w - 1, x + 1); ++xx)
            clear[static_cast<std::size_t>(yy) * w + xx] = 0;
  return clear;
}

// Variance of the bulk: about the median, outliers cut at 3.5 sigma. The first sigma comes from the quartiles, which
// can be zero for quantized values; `floor` prevents this.
double bulk_variance(std::vector<float>& values, double floor) {
  const auto quantile = [&](double q) { return static_cast<double>(quantile_in_place(values, q)); };
  const double low = quantile(0.25), high = quantile(0.75);
  double center = quantile(0.5), sigma = std::max((high - low) / 1.349, floor);
  double variance = 0;
  for (int round = 0; round < 3; ++round) {
    double sum = 0, sum2 = 0;
    std::size_t n = 0;
    for (const float v : values)
      if (std::abs(v - center) < 3.5 * sigma) {
        sum += v - center;
        sum2 += (v - center) * (v - center);
        ++n;
      }
    if (n < 2) return 0;
    const double mean = sum / static_cast<double>(n);
    variance = sum2 / static_cast<double>(n) - mean * mean;
    center += mean;
    sigma = std::max(std::sqrt(variance), floor);
  }
  return variance / 0.9943;  // share of a normal distribution's variance within 3.5 sigma
}

}  // namespace

double linear_step(const StoredAs& stored, double v) {
  if (!stored.bent_steps.empty()) {
    const double at = std::sqrt(std::clamp(v, 0.0, 1.0)) * static_cast<double>(stored.bent_steps.size() - 1);
    return stored.bent_steps[static_cast<std::size_t>(std::lround(at))];
  }
  if (!stored.srgb) return stored.step;
  v = std::clamp(v, 0.0, 1.0);
  return v <= 0.0031308 ? stored.step / 12.92 : stored.step * (2.4 / 1.055) * std::pow(v, 1.4 / 2.4);
}

double NoiseModel::variance(double v, const StoredAs& kept) const {
  const double step = linear_step(kept, v);
  return photon * std::max(v, 0.0) + read + stored * step * step;
}

namespace {

// JPEG smooths flat areas below their true noise, and errs most in texture. Measurements use the texture of a board. So
// only pixels whose neighborhood spans a few levels count for lossy files.
bool flat(const Image& image, int x, int y, int c, double step) {
  float low = image.at(x, y, c), high = low;
  for (int yy = std::max(0, y - 1); yy <= std::min(image.height - 1, y + 1); ++yy)
    for (int xx = std::max(0, x - 1); xx <= std::min(image.width - 1, x + 1); ++xx) {
      low = std::min(low, image.at(xx, yy, c));
      high = std::max(high, image.at(xx, yy, c));
    }
  return high - low < 6 * step;
}

}  // namespace

std::vector<NoiseSample> noise_between(const LinearPhoto& longer, const LinearPhoto& shorter, double ratio) {
  const Image& a = longer.value;
  const Image& b = shorter.value;
  const auto clear_a = clear_of_clipping(longer), clear_b = clear_of_clipping(shorter);
  std::vector<NoiseSample> samples;
  for (int c = 0; c < a.channels; ++c) {
    std::array<std::vector<float>, kBins> difference;
    std::array<double, kBins> sum_v{};
    std::array<std::size_t, kBins> black{};
    for (std::size_t i = 0; i < clear_a.size(); ++i) {
      if (!clear_a[i] || !clear_b[i]) continue;
      const float va = a.data[i * a.channels + c], vb = b.data[i * a.channels + c];
      const int bin = bin_of(va);
      if (bin < 0) continue;
      if (longer.stored.lossy &&
          flat(a, static_cast<int>(i % a.width), static_cast<int>(i / a.width), c, linear_step(longer.stored, va)))
        continue;
      difference[bin].push_back(vb - static_cast<float>(ratio) * va);
      sum_v[bin] += va;
      black[bin] += vb <= 0;
    }
    for (int bin = 0; bin < kBins; ++bin) {
      const std::size_t n = difference[bin].size();
      // If black cuts off the shorter exposure, its noise appears too small.
      if (n < kLeastInBin || black[bin] * 200 > n) continue;
      const double v = sum_v[bin] / static_cast<double>(n), r2 = ratio * ratio;
      const double step_a = linear_step(longer.stored, v), step_b = linear_step(shorter.stored, ratio * v);
      const double variance = bulk_variance(difference[bin], std::max(step_b / 2, 1e-9));
      if (!(variance > 0)) continue;
      samples.push_back(
          {{ratio * v + r2 * v, 1 + r2, step_b * step_b + r2 * step_a * step_a}, variance, static_cast<double>(n)});
    }
  }
  return samples;
}

std::vector<NoiseSample> noise_within(const LinearPhoto& photo) {
  constexpr int kBlock = 16;
  // [1 -2 1] along x and along y ignores slopes; its variance is 36 times that of independent values. Its results are
  // correlated, so a block of 256 counts as 68, and the tenth percentile of block variances lies at 0.78.
  constexpr double kGain = 36, kIndependent = 68, kTenthPercentile = 0.78;
  const Image& image = photo.value;
  const auto clear = clear_of_clipping(photo);
  std::vector<NoiseSample> samples;
  for (int c = 0; c < image.channels; ++c) {
    std::array<std::vector<float>, kBins> variances;
    std::array<double, kBins> sum_v{};
    for (int y0 = 1; y0 + kBlock < image.height; y0 += kBlock)
      for (int x0 = 1; x0 + kBlock < image.width; x0 += kBlock) {
        double sum = 0, sum2 = 0;
        bool usable = true;
        for (int y = y0; y < y0 + kBlock && usable; ++y)
          for (int x = x0; x < x0 + kBlock && usable; ++x) {
            usable = clear[static_cast<std::size_t>(y) * image.width + x] && image.at(x, y, c) > 0;
            const double e = image.at(x - 1, y - 1, c) - 2 * image.at(x, y - 1, c) + image.at(x + 1, y - 1, c) -
                             2 * image.at(x - 1, y, c) + 4 * image.at(x, y, c) - 2 * image.at(x + 1, y, c) +
                             image.at(x - 1, y + 1, c) - 2 * image.at(x, y + 1, c) + image.at(x + 1, y + 1, c);
            sum += image.at(x, y, c);
            sum2 += e * e;
          }
        if (!usable || !(sum2 > 0)) continue;
        const double mean = sum / (kBlock * kBlock);
        const int bin = bin_of(static_cast<float>(mean));
        if (bin < 0) continue;
        variances[bin].push_back(static_cast<float>(sum2 / (kBlock * kBlock) / kGain));
        sum_v[bin] += mean;
      }
    for (int bin = 0; bin < kBins; ++bin) {
      std::vector<float>& list = variances[bin];
      if (list.size() < 20) continue;
      const double v = sum_v[bin] / static_cast<double>(list.size());
      // Element with n / 10 below it: quantile_in_place(list, 0.1) counts from n - 1, and takes the previous one if n
      // is 20.
      const auto nth = list.begin() + static_cast<std::ptrdiff_t>(list.size() / 10);
      std::nth_element(list.begin(), nth, list.end());
      const double step = linear_step(photo.stored, v);
      samples.push_back(
          {{v, 1, step * step}, *nth / kTenthPercentile, kIndependent * static_cast<double>(list.size()) / 10});
    }
  }
  return samples;
}

NoiseModel fit_noise(std::span<const NoiseSample> samples) {
  if (samples.empty()) return {};
  const NoiseModel least{0, 0, 1.0 / 12};
  // Unknowns: photon, read, and the part of `stored` beyond rounding. Rows are scaled to relative errors. No sample
  // counts for more than a thousand values: the model's own error dominates beyond.
  Eigen::MatrixXd A(samples.size(), 3);
  Eigen::VectorXd b(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const NoiseSample& s = samples[i];
    const double w = std::sqrt(std::min(s.weight, 1000.0)) / s.variance;
    for (int k = 0; k < 3; ++k) A(static_cast<int>(i), k) = w * s.coefficient[k];
    b(static_cast<int>(i)) = w * (s.variance - least.stored * s.coefficient[2]);
  }
  const Eigen::Vector3d scale = A.colwise().norm().transpose().cwiseMax(1e-300);
  A *= scale.cwiseInverse().asDiagonal();
  // With linear files `stored` and `read` are the same constant; all of it then counts as read noise.
  const bool linear = std::all_of(samples.begin(), samples.end(), [&](const NoiseSample& s) {
    const double level = samples[0].coefficient[2] / samples[0].coefficient[1];
    return std::abs(s.coefficient[2] / s.coefficient[1] - level) <= 1e-6 * level;
  });
  // Tries every set of zero unknowns and keeps the best one without a negative unknown.
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  double best_cost = b.squaredNorm();
  for (int set = 1; set < (linear ? 4 : 8); ++set) {
    std::vector<int> columns;
    for (int k = 0; k < 3; ++k)
      if ((set >> k) & 1) columns.push_back(k);
    Eigen::MatrixXd part(A.rows(), static_cast<Eigen::Index>(columns.size()));  // Eigen 5 has no Eigen::all
    for (std::size_t k = 0; k < columns.size(); ++k) part.col(static_cast<Eigen::Index>(k)) = A.col(columns[k]);
    const Eigen::VectorXd x = part.completeOrthogonalDecomposition().solve(b);
    if (!(x.array() >= 0).all()) continue;
    const double cost = (part * x - b).squaredNorm();
    if (cost < best_cost) {
      best_cost = cost;
      best.setZero();
      for (std::size_t k = 0; k < columns.size(); ++k) best[columns[k]] = x[static_cast<int>(k)];
    }
  }
  best = best.cwiseQuotient(scale);
  return {best[0], best[1], least.stored + best[2]};
}

}  // namespace burin
