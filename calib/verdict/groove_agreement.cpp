#include "burin/calib/verdict/groove_agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <random>
#include <utility>

#include "burin/base/median.h"
#include "burin/calib/photo/carved_states.h"
#include "burin/scene/blur.h"

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

// Shifts each scratch by one distance to a random side. The pictures remain; single grooves do not.
Sent scratches_to_either_side(const Sent& sent, double aside_mm, std::uint64_t seed) {
  Sent out = sent;
  Scratches& s = out.scratches;
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double dx = s.x1_mm[i] - s.x0_mm[i], dy = s.y1_mm[i] - s.y0_mm[i], length_mm = std::hypot(dx, dy);
    if (!(length_mm > 0)) continue;
    const double by = ((random() & 1) != 0 ? aside_mm : -aside_mm) / length_mm;
    s.x0_mm[i] -= by * dy, s.x1_mm[i] -= by * dy;
    s.y0_mm[i] += by * dx, s.y1_mm[i] += by * dx;
  }
  return out;
}

// Each groove keeps its place, and takes the direction and length of one nearby. The light of all together stays.
Sent exchange_directions(const Sent& sent) {
  constexpr double kNear_mm = 8;
  Sent out = sent;
  const Scratches& from = sent.scratches;
  std::vector<std::size_t> order(from.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto cell = [&](std::size_t i) {
    return std::pair(std::floor((from.y0_mm[i] + from.y1_mm[i]) / (2 * kNear_mm)),
                     std::floor((from.x0_mm[i] + from.x1_mm[i]) / (2 * kNear_mm)));
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return cell(a) < cell(b); });
  for (std::size_t n = 0; n < order.size(); ++n) {
    const std::size_t i = order[n], j = order[(n + 1) % order.size()];
    const double x_mm = 0.5 * (from.x0_mm[i] + from.x1_mm[i]), y_mm = 0.5 * (from.y0_mm[i] + from.y1_mm[i]);
    const double half_x_mm = 0.5 * (from.x1_mm[j] - from.x0_mm[j]), half_y_mm = 0.5 * (from.y1_mm[j] - from.y0_mm[j]);
    Scratches& to = out.scratches;
    to.x0_mm[i] = x_mm - half_x_mm, to.x1_mm[i] = x_mm + half_x_mm;
    to.y0_mm[i] = y_mm - half_y_mm, to.y1_mm[i] = y_mm + half_y_mm;
  }
  return out;
}

constexpr double kFinePx = 1;  // sigma of the Gaussian that is taken off

// The pixels less their Gaussian mean, over pixels with a weight.
Image fine_part(const Image& image, const PhotoData& photo) {
  Image value(image.width, image.height, 1), counts = value;
  for (std::size_t i = 0; i < value.data.size(); ++i)
    if (photo.weight[i] > 0) value.data[i] = image.data[i], counts.data[i] = 1;
  const Image smooth = blurred(value, kFinePx), share = blurred(counts, kFinePx);
  for (std::size_t i = 0; i < value.data.size(); ++i)
    value.data[i] = counts.data[i] > 0 ? value.data[i] - smooth.data[i] / share.data[i] : 0;
  return value;
}

struct FineShare {
  double share = 0, sigma = 1;
};

// Least squares of the photo on `own`, weighted by `single`, the contribution of single grooves to it. Sums over
// squares of pixels sample all else: noise, dust, other grooves, model error.
FineShare fine_share(const PhotoData& photo, const Image& own, const Image& single) {
  constexpr double kUsualError = 0.3, kLocalPx = 4;  // what is bright counts no more for that
  constexpr int kSquarePx = 24;
  constexpr std::size_t kFewest = 12;  // squares
  const Image seen_fine = fine_part(photo.photo.value, photo), own_fine = fine_part(own, photo),
              single_fine = fine_part(single, photo), local = blurred(own, kLocalPx);
  std::map<std::pair<int, int>, std::array<double, 2>> squares;
  for (int y = 0, i = 0; y < own.height; ++y)
    for (int x = 0; x < own.width; ++x, ++i) {
      if (!(photo.weight[i] > 0)) continue;
      const double weight =
          single_fine.data[i] / (std::pow(photo.photo.sigma.data[i], 2) + std::pow(kUsualError * local.data[i], 2));
      auto& [seen, foretold] = squares[{y / kSquarePx, x / kSquarePx}];
      seen += weight * seen_fine.data[i];
      foretold += weight * own_fine.data[i];
    }
  double seen = 0, foretold = 0, scatter2 = 0;
  for (const auto& [place, sums] : squares) seen += sums[0], foretold += sums[1];
  if (squares.size() < kFewest || !(foretold > 0)) return {};
  const double share = seen / foretold;
  for (const auto& [place, sums] : squares) scatter2 += std::pow(sums[0] - share * sums[1], 2);
  return {share, std::sqrt(scatter2) / foretold};
}

}  // namespace

std::vector<GrooveAgreement> groove_agreements(const Problem& data, const State& state) {
  const Carved carved = carved_at(data.model, state.of(0));
  std::vector<Image> own(data.photos.size());
  each_photo(data, [&](std::size_t k) {
    own[k] = predict(data.model, data.photos[k], state.of(data.photos[k].photo.light), carved);
  });
  const auto add = [&](const Carved& other, const State& at, std::vector<Sums>& sums) {
    each_photo(data, [&](std::size_t k) {
      const PhotoData& photo = data.photos[k];
      const double error = data.photo_model_error.empty() ? 0 : data.photo_model_error[k];
      const Sums one =
          compare_predictions(photo, error, own[k], predict(data.model, photo, at.of(photo.photo.light), other));
      sums[k].towards += one.towards;
      sums[k].difference += one.difference;
      sums[k].by_noise += one.by_noise;
      sums[k].pixels += one.pixels;
    });
  };
  std::vector<Sums> aside(data.photos.size()), exchanged = aside;
  for (const auto& [x, y] : kAside) {
    State moved = state;
    moved.shared[unknown::machine + 4] += kAside_mm * x;
    moved.shared[unknown::machine + 5] += kAside_mm * y;
    add(carved_at(data.model, moved.of(0)), moved, aside);
  }
  const Sent other_ways = exchange_directions(*data.model.sent);
  ModelData model = data.model;
  model.sent = &other_ways;
  add(carved_at(model, state.of(0)), state, exchanged);
  constexpr double kFarFromNoise = 3;    // RMS of the predictions' difference, in units of the photo's noise
  constexpr std::size_t kFewest = 500;   // pixels, in each of the comparisons
  constexpr double kSigmasOfOneWay = 6;  // nearby grooves may have one direction: then their exchange shows nothing
  std::vector<GrooveAgreement> out;
  for (std::size_t k = 0; k < aside.size(); ++k) {
    const Sums &s = aside[k], &e = exchanged[k];
    GrooveAgreement& agreement = out.emplace_back();
    const auto pixels = static_cast<double>(s.pixels);
    if (s.pixels < kFewest * kAside.size() || !(s.difference > 0)) continue;
    agreement.tells = s.by_noise > kFarFromNoise * kFarFromNoise * pixels;
    agreement.share = s.towards / s.difference;
    agreement.sigmas = std::sqrt(s.difference / static_cast<double>(kAside.size()));
    const double sigmas = std::sqrt(e.difference);
    if (sigmas > kSigmasOfOneWay && e.towards / e.difference < agreement.share) {
      agreement.share = e.towards / e.difference;
      agreement.sigmas = sigmas;
    }
  }
  return out;
}

SingleGrooves compare_single_grooves(const Problem& data, const std::vector<LightView>& views, const Bench& bench,
                                     const State& state) {
  constexpr std::size_t kMostPhotos = 8, kDraws = 2, kFewestPhotos = 3;
  constexpr std::size_t kMostPixels = 40'000'000;  // four photos of 12 megapixels show as much as eight of 3
  constexpr double kAsidePx = 1, kTelling = 0.25;
  std::vector<std::size_t> nearest(views.size());
  std::iota(nearest.begin(), nearest.end(), std::size_t{0});
  std::stable_sort(nearest.begin(), nearest.end(),
                   [&](std::size_t a, std::size_t b) { return pixel_mm(views[a], bench) < pixel_mm(views[b], bench); });
  std::size_t chosen = 0;
  for (std::size_t pixels = 0; chosen < std::min(nearest.size(), kMostPhotos); ++chosen) {
    if (chosen >= kFewestPhotos && pixels >= kMostPixels) break;
    pixels += views[nearest[chosen]].value.data.size();
  }
  nearest.resize(chosen);
  const double aside_mm = kAsidePx * pixel_mm(views[nearest[nearest.size() / 2]], bench);
  ModelData model = data.model;
  model.sample = {};
  const Carved own = carved_at(model, state.of(0));
  std::vector<Carved> aside;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    const Sent moved = scratches_to_either_side(*data.model.sent, aside_mm, draw);
    model.sent = &moved;
    aside.push_back(carved_at(model, state.of(0)));
  }
  model.sent = data.model.sent;
  std::vector<FineShare> shares(nearest.size());
  each_photo(nearest.size(), photos_at_once(model), [&](std::size_t n) {
    const double blur_px = std::exp(state.shared[unknown::log_blur]);
    const std::vector<LightView> view{views[nearest[n]]};
    PhotoData photo = std::move(photos_at(view, 1, *model.board, bench, blur_px).front());
    const Unknowns x = state.of(photo.photo.light);
    light_around(x, own, photo);
    const Image whole = predict(model, photo, x, own);
    Image single = whole;
    for (const Carved& carved : aside) {
      const Image other = predict(model, photo, x, carved);
      for (std::size_t i = 0; i < single.data.size(); ++i) single.data[i] -= other.data[i] / static_cast<float>(kDraws);
    }
    shares[n] = fine_share(photo, whole, single);
  });
  std::vector<double> telling;
  double sigma2 = 0;
  for (const FineShare& one : shares) {
    if (!(one.sigma < kTelling)) continue;
    telling.push_back(one.share);
    sigma2 += one.sigma * one.sigma;
  }
  if (telling.size() < kFewestPhotos) return {telling.size()};
  const auto count = static_cast<double>(telling.size());
  constexpr double kOfMedian = 1.25;  // its standard error over the mean's
  return {telling.size(), median_of(telling), kOfMedian * std::sqrt(sigma2) / count};
}

// Own grooves reach 0.98 to 0.99, a board of the same pictures 0.40 (docs/results/calibration.md).
bool shows_other_grooves(const SingleGrooves& seen) { return seen.share + 2 * seen.sigma < 0.7; }
bool shows_these_grooves(const SingleGrooves& seen) { return seen.share - 2 * seen.sigma > 0.7; }

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
