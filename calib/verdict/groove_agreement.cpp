#include "burin/calib/verdict/groove_agreement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burin/base/median.h"
#include "burin/calib/photo/carved_states.h"

namespace burin {
namespace {

// A shift beyond errors of the machine's map and the photos' blur, and below the size of structures in pictures.
constexpr double kAside_mm = 2.5;
constexpr std::array<std::array<double, 2>, 4> kAside{{{1, 0.4}, {-0.4, 1}, {-1, -0.4}, {0.4, -1}}};

struct Sums {
  double towards = 0, difference = 0, by_noise = 0;
  std::size_t pixels = 0;
};

// The fit's weights are lower at pixels with a bright own prediction, and would accept a photo that is dark there. This
// comparison weighs both predictions equally.
Sums compare_predictions(const PhotoData& photo, double model_error, const Image& own, const Image& aside) {
  Sums sums;
  for (std::size_t i = 0; i < own.data.size(); ++i) {
    const double noise = photo.photo.sigma.data[i];
    if (!(photo.weight[i] > 0) || !(noise > 0)) continue;
    const double own_value = own.data[i], aside_value = aside.data[i];
    const double w = 1 / std::hypot(noise, model_error * std::hypot(own_value, aside_value) / std::sqrt(2.0));
    const double difference = w * (own_value - aside_value);
    // Other effects on a pixel (dust, a window's mirror image) are clamped to its prediction and its noise.
    const double most = 2 * std::abs(difference) + 3 * w * noise;
    const double off = std::clamp(w * (photo.photo.value.data[i] - 0.5 * (own_value + aside_value)), -most, most);
    sums.towards += 2 * off * difference;
    sums.difference += difference * difference;
    const double by_noise = (own_value - aside_value) / noise;
    sums.by_noise += by_noise * by_noise;
    ++sums.pixels;
  }
  return sums;
}

}  // namespace

std::vector<GrooveAgreement> groove_agreements(const Problem& data, const State& state) {
  std::vector<Sums> sums(data.photos.size());
  const Carved carved = carved_at(data.model, state.of(0));
  std::vector<Image> own(data.photos.size());
  each_photo(data, [&](std::size_t k) {
    own[k] = predict(data.model, data.photos[k], state.of(data.photos[k].photo.light), carved);
  });
  for (const auto& [x, y] : kAside) {
    State moved = state;
    moved.shared[unknown::machine + 4] += kAside_mm * x;
    moved.shared[unknown::machine + 5] += kAside_mm * y;
    const Carved carved_aside = carved_at(data.model, moved.of(0));
    each_photo(data, [&](std::size_t k) {
      const PhotoData& photo = data.photos[k];
      const double error = data.photo_model_error.empty() ? 0 : data.photo_model_error[k];
      const Image aside = predict(data.model, photo, moved.of(photo.photo.light), carved_aside);
      const Sums one = compare_predictions(photo, error, own[k], aside);
      sums[k].towards += one.towards;
      sums[k].difference += one.difference;
      sums[k].by_noise += one.by_noise;
      sums[k].pixels += one.pixels;
    });
  }
  constexpr double kFarFromNoise = 3;   // RMS of the predictions' difference, in units of the photo's noise
  constexpr std::size_t kFewest = 500;  // pixels, in each of the comparisons
  std::vector<GrooveAgreement> out;
  for (const Sums& s : sums) {
    GrooveAgreement& agreement = out.emplace_back();
    const auto pixels = static_cast<double>(s.pixels);
    if (s.pixels < kFewest * kAside.size() || !(s.difference > 0)) continue;
    agreement.tells = s.by_noise > kFarFromNoise * kFarFromNoise * pixels;
    agreement.share = s.towards / s.difference;
    agreement.sigmas = std::sqrt(s.difference / static_cast<double>(kAside.size()));
  }
  return out;
}

std::vector<std::size_t> photos_of_other_grooves(const std::vector<GrooveAgreement>& agreements) {
  // docs/results/calibration.md has the measurements. Most photos together decide about another board; a single photo
  // needs a lower share and stronger evidence.
  constexpr double kOtherBoard = 0.4, kOwnBoard = 0.6, kOtherPhoto = 0.25, kLeastSigmas = 3, kSigmasInAll = 8;
  std::vector<double> shares;
  std::vector<std::size_t> all, out;
  double sigmas2 = 0;
  for (std::size_t k = 0; k < agreements.size(); ++k) {
    if (agreements[k].sigmas < kLeastSigmas) continue;
    shares.push_back(agreements[k].share);
    all.push_back(k);
    sigmas2 += agreements[k].sigmas * agreements[k].sigmas;
  }
  if (all.size() < 3 || sigmas2 < kSigmasInAll * kSigmasInAll) return {};
  const double usual = median_of(shares);
  if (usual < kOtherBoard) return all;
  if (usual < kOwnBoard) return {};  // a fit far from convergence gives no evidence
  for (const std::size_t k : all)
    if (agreements[k].tells && agreements[k].share < kOtherPhoto) out.push_back(k);
  return out;
}

}  // namespace burin
