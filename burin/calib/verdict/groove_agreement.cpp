#include "burin/calib/verdict/groove_agreement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burin/calib/photo/carved_states.h"
#include "burin/render/median.h"

namespace burin {
namespace {

// Aside by more than the machine's map and the photos' blur could be off, and less than pictures vary over.
constexpr double kAside_mm = 2.5;
constexpr std::array<std::array<double, 2>, 4> kAside{{{1, 0.4}, {-0.4, 1}, {-1, -0.4}, {0.4, -1}}};

struct Sums {
  double towards = 0, difference = 0, by_noise = 0;
  std::size_t pixels = 0;
};

Sums compare_predictions(const PhotoData& photo, const Image& own, const Image& aside) {
  Sums sums;
  for (std::size_t i = 0; i < own.data.size(); ++i) {
    const double w = photo.weight[i];
    if (!(w > 0)) continue;
    const double difference = w * (static_cast<double>(own.data[i]) - aside.data[i]);
    const double middle = 0.5 * (static_cast<double>(own.data[i]) + aside.data[i]);
    // What else is wrong with a pixel (dust, a window's mirror image) counts no more than its prediction does.
    const double most = 2 * std::abs(difference);
    const double off = std::clamp(w * (photo.photo.value.data[i] - middle), -most, most);
    sums.towards += 2 * off * difference;
    sums.difference += difference * difference;
    const double by_noise = difference / w / photo.photo.sigma.data[i];
    if (std::isfinite(by_noise)) sums.by_noise += by_noise * by_noise;
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
      const Image aside = predict(data.model, photo, moved.of(photo.photo.light), carved_aside);
      const Sums one = compare_predictions(photo, own[k], aside);
      sums[k].towards += one.towards;
      sums[k].difference += one.difference;
      sums[k].by_noise += one.by_noise;
      sums[k].pixels += one.pixels;
    });
  }
  constexpr double kFarFromNoise = 3;   // RMS of the predictions' difference, in the photo's noise
  constexpr std::size_t kFewest = 500;  // pixels, in each of the comparisons
  std::vector<GrooveAgreement> out;
  for (const Sums& s : sums) {
    GrooveAgreement& agreement = out.emplace_back();
    const auto pixels = static_cast<double>(s.pixels);
    agreement.tells =
        s.pixels > kFewest * kAside.size() && s.difference > 0 && s.by_noise > kFarFromNoise * kFarFromNoise * pixels;
    if (agreement.tells) agreement.share = s.towards / s.difference;
  }
  return out;
}

std::vector<std::size_t> photos_of_other_grooves(const std::vector<GrooveAgreement>& agreements) {
  // Photos of these grooves have 0.6 to 1 of it once a fit has begun; another board's have less than 0.1.
  constexpr double kOther = 0.25, kOwn = 0.5;
  std::vector<double> shares;
  for (const GrooveAgreement& a : agreements)
    if (a.tells) shares.push_back(a.share);
  const double usual = median_of(shares);
  std::vector<std::size_t> out;
  if (shares.size() < 3 || (usual > kOther && usual < kOwn)) return out;  // a fit that has not got far tells nothing
  for (std::size_t k = 0; k < agreements.size(); ++k)
    if (agreements[k].tells && agreements[k].share < kOther) out.push_back(k);
  return out;
}

}  // namespace burin
