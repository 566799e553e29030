#include "burin/calib/photo/photo_weights.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "burin/base/median.h"
#include "burin/calib/photo/groove_scatter.h"

namespace burin {
namespace {

// One pixel's squares: residual, noise, prediction, its derivatives by log alpha and log depth.
struct PixelSquares {
  double residual, noise, value, by_alpha, by_depth;
};

// The relative error m of the model for which the median of residual^2 / expected^2 is a normal distribution's.
double relative_error(const std::vector<PixelSquares>& pixels, double alpha_jitter, double depth_jitter) {
  constexpr double kNormalMedian = 0.6745;
  // Half of the pixels are beyond the median; a pixel is if beyond - m^2 value > 0.
  std::vector<double> beyond(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const PixelSquares& p = pixels[i];
    beyond[i] = p.residual / (kNormalMedian * kNormalMedian) - p.noise - alpha_jitter * alpha_jitter * p.by_alpha -
                depth_jitter * depth_jitter * p.by_depth;
  }
  const auto too_small = [&](double m) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) count += beyond[i] > m * m * pixels[i].value ? 1 : 0;
    return 2 * count > pixels.size();
  };
  if (pixels.empty() || !too_small(0)) return 0;
  double low = 0, high = 3;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (too_small(middle) ? low : high) = middle;
  }
  return high;
}

// Variance of a photo's noise as a function of brightness, from its pixels' variances. A pixel's own variance depends
// on its noise. Pixels too dark by noise would weigh more than pixels too bright. A dark view would then seem darker
// than it is, by a photon per pixel.
class NoiseByValue {
 public:
  // For a photo with at least one pixel of nonzero weight.
  explicit NoiseByValue(const PhotoData& photo) {
    constexpr std::size_t kMost = 200'000, kGroups = 128;
    const auto counts = [](float weight) { return weight > 0; };
    const auto count = static_cast<std::size_t>(std::count_if(photo.weight.begin(), photo.weight.end(), counts));
    const std::size_t stride = 1 + count / kMost;
    std::vector<std::pair<double, double>> pixels;
    std::size_t seen = 0;
    for (std::size_t i = 0; i < photo.weight.size(); ++i) {
      if (!counts(photo.weight[i]) || seen++ % stride != 0) continue;
      const double sigma = photo.photo.sigma.data[i];
      pixels.emplace_back(photo.photo.value.data[i], sigma * sigma);
    }
    std::sort(pixels.begin(), pixels.end());
    std::vector<double> values, variances;  // of a group
    for (std::size_t g = 0; g < kGroups; ++g) {
      values.clear();
      variances.clear();
      for (std::size_t i = g * pixels.size() / kGroups; i < (g + 1) * pixels.size() / kGroups; ++i) {
        values.push_back(pixels[i].first);
        variances.push_back(pixels[i].second);
      }
      if (values.empty() || (!value_.empty() && !(median_in_place(values) > value_.back()))) continue;
      value_.push_back(median_in_place(values));
      variance_.push_back(median_in_place(variances));
    }
  }

  // The expected variance of a pixel with this value and variance, at its predicted brightness. If it comes from a
  // shorter exposure than others of its brightness, it is noisier, and stays so.
  double expected(double variance, double value, double predicted) const {
    return variance * at(predicted) / at(value);
  }

 private:
  // Constant beyond the darkest and the brightest group.
  double at(double value) const {
    const auto after = static_cast<std::size_t>(std::upper_bound(value_.begin(), value_.end(), value) - value_.begin());
    if (after == 0) return variance_.front();
    if (after == value_.size()) return variance_.back();
    const double share = (value - value_[after - 1]) / (value_[after] - value_[after - 1]);
    return (1 - share) * variance_[after - 1] + share * variance_[after];
  }

  std::vector<double> value_, variance_;
};

// Variances of log alpha and log depth (not negative) for residuals beyond noise and m, by weighted least squares. A
// residual counts up to 1.5 sigmas: dust, fingerprints and tool marks are not groove-to-groove variation.
Eigen::Vector2d groove_variances(const std::vector<std::vector<PixelSquares>>& photos, const std::vector<double>& m,
                                 const Eigen::Vector2d& variances) {
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < photos.size(); ++k)
    for (const PixelSquares& p : photos[k]) {
      const Eigen::Vector2d slopes(p.by_alpha, p.by_depth);
      const double known = p.noise + m[k] * m[k] * p.value, expected = known + variances.dot(slopes);
      constexpr double kMost = 2.25, kMeanOfNormal = 0.77848;  // the mean of min(z^2, kMost) over a normal distribution
      const double weight = 1 / (expected * expected);
      H += weight * slopes * slopes.transpose();
      g += weight * (std::min(p.residual, kMost * expected) / kMeanOfNormal - known) * slopes;
    }
  if (!(H(0, 0) > 0) || !(H(1, 1) > 0)) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d alone = g.cwiseQuotient(H.diagonal()).cwiseMax(0);
  Eigen::Vector2d both = H.ldlt().solve(g);
  if (both.minCoeff() >= 0) return both;
  return both[0] < both[1] ? Eigen::Vector2d(0, alone[1]) : Eigen::Vector2d(alone[0], 0);
}

void weigh(Problem& data, const State& state, bool grooves_differ) {
  const Carved carved = carved_at(data.model, state.of(0));
  data.photo_model_error.assign(data.photos.size(), 0);
  std::vector<GrooveSlopes> predicted(data.photos.size());
  std::vector<std::vector<PixelSquares>> squares(data.photos.size());
  std::vector<std::optional<NoiseByValue>> noise(data.photos.size());
  each_photo(data, [&](std::size_t k) {
    const PhotoData& photo = data.photos[k];
    const Unknowns x = state.of(photo.photo.light);
    GrooveSlopes& p = predicted[k];
    p = grooves_differ ? predict_with_slopes(data.model, photo, x, carved)
                       : GrooveSlopes{predict(data.model, photo, x, carved), {}, {}};
    const auto square = [](double v) { return v * v; };
    if (std::none_of(photo.weight.begin(), photo.weight.end(), [](float w) { return w > 0; })) return;
    noise[k].emplace(photo);
    const std::size_t stride = 1 + p.value.data.size() / 200'000;
    for (std::size_t i = 0; i < p.value.data.size(); i += stride)
      if (photo.weight[i] > 0)
        squares[k].push_back(
            {square(static_cast<double>(p.value.data[i]) - photo.photo.value.data[i]),
             noise[k]->expected(square(photo.photo.sigma.data[i]), photo.photo.value.data[i], p.value.data[i]),
             square(p.value.data[i]), grooves_differ ? square(p.by_log_alpha.data[i]) : 0,
             grooves_differ ? square(p.by_log_depth.data[i]) : 0});
  });
  Eigen::Vector2d variances = Eigen::Vector2d::Zero();
  constexpr int kRounds = 8;
  for (int round = 0; round < (grooves_differ ? kRounds : 1); ++round) {
    if (round > 0) variances = groove_variances(squares, data.photo_model_error, variances);
    each_photo(data, [&](std::size_t k) {
      data.photo_model_error[k] = relative_error(squares[k], std::sqrt(variances[0]), std::sqrt(variances[1]));
    });
  }
  if (grooves_differ) data.slope_error = variances.cwiseSqrt();
  for (std::size_t k = 0; k < data.photos.size(); ++k) {
    PhotoData& photo = data.photos[k];
    const GrooveSlopes& p = predicted[k];
    for (std::size_t i = 0; i < p.value.data.size(); ++i) {
      if (!(photo.weight[i] > 0)) continue;
      const double sigma = photo.photo.sigma.data[i], miss = data.photo_model_error[k] * p.value.data[i];
      const double noise2 = noise[k]->expected(sigma * sigma, photo.photo.value.data[i], p.value.data[i]);
      const double grooves = grooves_differ ? std::hypot(data.slope_error[0] * p.by_log_alpha.data[i],
                                                         data.slope_error[1] * p.by_log_depth.data[i])
                                            : 0;
      photo.weight[i] = static_cast<float>(1 / std::sqrt(noise2 + miss * miss + grooves * grooves));
    }
  }
}

}  // namespace

void weigh_photos(Problem& data, const State& state) { weigh(data, state, false); }

void weigh_photos_and_grooves(Problem& data, const State& state) {
  weigh(data, state, true);
  const GrooveScatter scatter = groove_scatter(data, state);
  // Derivatives do not hold further: larger variation has another cause.
  constexpr double kMostJitter = 0.5;
  const auto jitter = [&](int kind) {
    const double found = std::sqrt(scatter.variance[kind]);
    return found < kMostJitter ? found : 0;
  };
  data.model.alpha_jitter = jitter(0);
  data.model.depth_jitter = jitter(1);
  data.model.alpha_jitter2_sigma = scatter.sigma[0];
  data.model.depth_jitter2_sigma = scatter.sigma[1];
  const Carved carved = carved_at(data.model, state.of(0));
  each_photo(data, [&](std::size_t k) {
    shift_by_grooves(data.model, state.of(data.photos[k].photo.light), carved, data.photos[k]);
  });
}

}  // namespace burin
