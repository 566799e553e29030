#include "burin/calib/photo/stray_light_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "burin/base/median.h"
#include "burin/calib/geometry/information.h"
#include "burin/calib/light/lamp_model.h"
#include "burin/calib/photo/effect_choice.h"
#include "burin/calib/photo/held_out_gains.h"
#include "burin/calib/photo/normal_system.h"
#include "burin/calib/photo/photo_fit.h"

namespace burin {
namespace {

// Residuals of one photo's used pixels, in expected errors; the value per unit of light before vignetting there; and
// the residuals' derivatives by all unknowns of the fit: count of unknowns x pixels.
struct Left {
  std::vector<std::size_t> pixel;
  Eigen::VectorXd residual, per_light;
  Eigen::MatrixXd slopes;
};

// All photos, and the normal equations of the fit's unknowns.
struct LeftOfAll {
  std::vector<Left> photos;
  Eigen::MatrixXd inverse;
  Eigen::VectorXd g;
};

Left left_of(const Problem& data, const PhotoData& photo, const Unknowns& x, const PhotoSlopes& slopes, double error,
             Eigen::Index unknowns) {
  constexpr double kMost = 6;  // expected errors: glints of another lamp reach many, and so do faults of photos
  Left out;
  std::vector<double> residual, per_light;
  for (std::size_t i = 0; i < photo.weight.size(); ++i) {
    if (!(photo.weight[i] > 0)) continue;
    const PixelSeen seen = pixel_seen(photo, x, i, slopes.light);
    const double weight = 1 / std::hypot(photo.photo.sigma.data[i], error * seen.value);
    out.pixel.push_back(i);
    residual.push_back(std::clamp(weight * (photo.photo.value.data[i] - seen.value), -kMost, kMost));
    per_light.push_back(weight * seen.factor);
  }
  const auto n = static_cast<Eigen::Index>(residual.size());
  out.residual = Eigen::VectorXd::Map(residual.data(), n);
  out.per_light = Eigen::VectorXd::Map(per_light.data(), n);
  out.slopes = Eigen::MatrixXd::Zero(unknowns, n);
  for (std::size_t c = 0; c < slopes.columns.size(); ++c) {
    if (slopes.index[c] >= unknown::pose) continue;
    const Eigen::Index row = global_index(slopes.index[c], photo.photo.light);
    for (Eigen::Index i = 0; i < n; ++i)
      out.slopes(row, i) = out.per_light[i] * slopes.columns[c].data[out.pixel[static_cast<std::size_t>(i)]];
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t at = out.pixel[static_cast<std::size_t>(i)];
    out.slopes(unknown::ambient, i) = out.per_light[i] * data.model.f0;
    for (int v = 0; v < 3; ++v)
      out.slopes(unknown::vignette + v, i) =
          out.per_light[i] * slopes.light.data[at] * std::pow(photo.radius2[at], v + 1);
  }
  return out;
}

LeftOfAll left_of_all(const Problem& data, const Stage& stage, const State& state) {
  const Eigen::Index unknowns = global_count(state.lamps.size());
  LeftOfAll out;
  out.photos.resize(data.photos.size());
  constexpr double kLeastError = 0.02;
  const double error = std::max(kLeastError, median_of(data.photo_model_error));
  equations_of_photos(data, stage, state, {data.model}, [&](std::size_t k, const PhotoSlopes& slopes) {
    const PhotoData& photo = data.photos[k];
    out.photos[k] = left_of(data, photo, state.of(photo.photo.light), slopes, error, unknowns);
  });
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(unknowns, unknowns);
  out.g = Eigen::VectorXd::Zero(unknowns);
  for (const Left& photo : out.photos) {
    if (photo.pixel.empty()) continue;  // no weights, and Eigen divides by a product's inner length
    H.selfadjointView<Eigen::Lower>().rankUpdate(photo.slopes);
    out.g += photo.slopes * photo.residual;
  }
  H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
  for (int v = 0; v < 3; ++v) H(unknown::vignette + v, unknown::vignette + v) += std::pow(kVignettePriorSigma[v], -2);
  std::vector<bool> free = free_unknowns(data, stage, state.lamps.size());
  free[kPaperIndex] = false;
  out.inverse = safe_inverse(H, free);
  return out;
}

// A candidate position of a light.
struct Place {
  StrayNumbers numbers{};
  double score = 0;  // evidence of its light: the score along it over the root of its information
};

double angle_between(const Place& a, const Place& b) {
  const auto towards = [](const Place& p) { return Eigen::Vector3d(p.numbers[0], p.numbers[1], 1).normalized(); };
  return std::acos(std::clamp(towards(a).dot(towards(b)), -1.0, 1.0));
}

// Competing explanations of the same light. Each has its own test later.
constexpr std::array kOthers{Group::glare, Group::depth_linear, Group::depth_quadratic, Group::grain, Group::backlash};

Stage with_others(Stage stage) {
  for (const Group group : kOthers) stage.free(group);
  return stage;
}

// `fitted`, with the unknowns that only with_others() had freed reset to `before`.
State without_others(State fitted, const Stage& stage, const State& before) {
  for_each_unknown([&](const UnknownRow& row, int first) {
    if (std::find(kOthers.begin(), kOthers.end(), row.group) == kOthers.end() || stage.frees(row.group)) return;
    std::copy_n(before.block(first), row.size, fitted.block(first));
  });
  return fitted;
}

State with_stray(const State& state, const StrayNumbers& numbers) {
  State out = state;
  std::copy(numbers.begin(), numbers.end(), out.block(unknown::stray));
  return out;
}

// Sets a place's score, and the irradiance that explains most with all other unknowns free.
void weigh(const Problem& data, const State& state, const Carved& carved, const LeftOfAll& left, Place& place) {
  place.numbers[kStrayIrradiance] = 1;
  const State with = with_stray(state, place.numbers);
  struct Sums {
    double pull = 0, information = 0;
    Eigen::VectorXd with_others;
  };
  std::vector<Sums> sums(data.photos.size(), {0, 0, Eigen::VectorXd::Zero(left.g.size())});
  each_photo(data, [&](std::size_t k) {
    const PhotoData& photo = data.photos[k];
    const Left& own = left.photos[k];
    if (own.pixel.empty()) return;
    const Image light = stray_seen(photo, with.of(photo.photo.light), carved);
    Eigen::VectorXd seen(own.residual.size());
    for (Eigen::Index i = 0; i < seen.size(); ++i)
      seen[i] = own.per_light[i] * light.data[own.pixel[static_cast<std::size_t>(i)]];
    sums[k] = {seen.dot(own.residual), seen.squaredNorm(), own.slopes * seen};
  });
  Sums all{0, 0, Eigen::VectorXd::Zero(left.g.size())};
  for (const Sums& s : sums) {
    all.pull += s.pull;
    all.information += s.information;
    all.with_others += s.with_others;
  }
  const Eigen::VectorXd follow = left.inverse * all.with_others;
  const double pull = all.pull - follow.dot(left.g), information = all.information - follow.dot(all.with_others);
  if (!(information > 0)) return;
  place.score = pull / std::sqrt(information);
  place.numbers[kStrayIrradiance] = pull / information;
}

// Directions all over the sky above the face, about `step` apart, as far away as the nearest lamp.
std::vector<Place> sky(const Problem& data, const State& state, double step) {
  constexpr double kLowest = 75, kOwn = 8;  // degrees from the face's normal; from a lamp of the photos
  const Eigen::Vector2d size_mm = data.model.board->size_mm;
  const auto radians = [](double deg) { return deg * std::numbers::pi / 180; };
  std::vector<Place> own;
  double nearness = 0;
  for (std::size_t light = 0; light < state.lamps.size(); ++light) {
    Light lamp;
    lamp.position_mm = Eigen::Vector3d::Map(state.block(unknown::lamp_position, light));
    if (!(lamp.position_mm.z() > 0)) continue;
    own.push_back({stray_numbers(lamp, size_mm)});
    nearness = std::max(nearness, own.back().numbers[kStrayNearness]);
  }
  nearness = std::min(nearness, kMostStrayNearness);
  std::vector<Place> out;
  for (int ring = 0; ring * step <= radians(kLowest); ++ring) {
    const double lean = ring * step;
    const int around = std::max(1, static_cast<int>(std::lround(2 * std::numbers::pi * std::sin(lean) / step)));
    for (int k = 0; k < around; ++k) {
      const double azimuth = 2 * std::numbers::pi * k / around;
      const Place place{{std::tan(lean) * std::cos(azimuth), std::tan(lean) * std::sin(azimuth), nearness, 0, 0}};
      if (std::none_of(own.begin(), own.end(), [&](const Place& o) { return angle_between(o, place) < radians(kOwn); }))
        out.push_back(place);
    }
  }
  return out;
}

// All places of the sky, with scores.
std::vector<Place> likely_places(const Problem& data, const Stage& stage, const State& state, double step,
                                 const Progress& progress) {
  const Carved carved = carved_at(data.model, state.of(0));
  const LeftOfAll left = left_of_all(data, stage, state);
  std::vector<Place> places = sky(data, state, step);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (progress && i % 16 == 0)
      progress("looking for unnamed lights", static_cast<double>(i) / static_cast<double>(places.size()));
    weigh(data, state, carved, left, places[i]);
  }
  return places;
}

// The best places, each a local maximum.
std::vector<Place> best_of(std::vector<Place> places, std::size_t count, double apart) {
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.score > b.score; });
  std::vector<Place> out;
  for (const Place& place : places) {
    if (out.size() == count || !(place.score > 0)) break;
    if (std::none_of(out.begin(), out.end(), [&](const Place& o) { return angle_between(o, place) < apart; }))
      out.push_back(place);
  }
  return out;
}

}  // namespace

std::vector<StrayNumbers> likely_stray_lights(const Problem& data, const Stage& stage, const State& state,
                                              const Progress& progress) {
  constexpr double kStep = 10 * std::numbers::pi / 180;
  constexpr std::size_t kTried = 2;
  constexpr double kLeastScore = 12;
  const std::vector<Place> places = best_of(likely_places(data, stage, state, kStep, progress), kTried, 2 * kStep);
  if (places.empty() || !(places.front().score > kLeastScore)) return {};
  std::vector<StrayNumbers> out;
  out.reserve(places.size());
  for (const Place& place : places) out.push_back(place.numbers);
  return out;
}

double cost_with_stray(const std::vector<StrayNumbers>& places, Problem data, const Stage& stage, const State& state,
                       int iterations, const Progress& progress) {
  Stage with = stage;
  with.free(Group::stray);
  data.has_stray = true;
  double least = std::numeric_limits<double>::infinity();
  for (const StrayNumbers& place : places) {
    State trial = with_stray(state, place);
    solve(data, with, iterations, 1e-4, trial, progress, "fitting unnamed lights");
    if (!grazes(trial.block(unknown::stray))) least = std::min(least, cost_of(data, trial, 1));
  }
  return least;
}

bool fit_stray_light(const std::vector<StrayNumbers>& places, Problem& data, Stage& stage, State& state,
                     const Progress& progress) {
  const Stage others = with_others(stage);
  constexpr double kShare = 0.01;  // of the photos' cost
  const auto fitted = [&](const Stage& with, State trial) {
    constexpr int kIterations = 12;
    solve(data, with, kIterations, 1e-4, trial, progress, "fitting unnamed lights");
    return trial;
  };
  const std::vector<double> before = costs_of_photos(data, fitted(others, state));
  const double whole = std::accumulate(before.begin(), before.end(), 0.0);
  Stage with = others;
  with.free(Group::stray);
  data.has_stray = true;
  State best = state;
  Gain most;
  for (const StrayNumbers& place : places) {
    State trial = fitted(with, with_stray(state, place));
    const Gain gain = gain_between(before, costs_of_photos(data, trial));
    if (!(gain.sum > most.sum) || grazes(trial.block(unknown::stray))) continue;
    most = gain;
    best = std::move(trial);
  }
  data.has_stray = most.sum > kShare * whole && most.sum > most.standard_error;
  if (!data.has_stray) return false;
  // A window, not a lamp: derivatives by size are informative only at a size above 0.
  constexpr double kSpread2 = 0.01;
  with.free(Group::stray_size);
  State wide = best;
  wide.block(unknown::stray_spread2)[0] = kSpread2;
  wide = fitted(with, std::move(wide));
  const Gain wider = gain_between(costs_of_photos(data, best), costs_of_photos(data, wide));
  constexpr double kWideShare = 0.03;  // each of its points takes as long as a lamp
  const bool is_wide = wider.sum > kWideShare * whole && wider.sum > wider.standard_error;
  stage.free(Group::stray).free(Group::stray_size, is_wide);
  // Without the competing explanations, from the place found and from the other unknowns' earlier values.
  const State& found = is_wide ? wide : best;
  State from_there = fitted(stage, without_others(found, stage, state)),
        from_here = fitted(stage, with_stray(state, stray_numbers(found.block(unknown::stray))));
  state = cost_of(data, from_there, 1) < cost_of(data, from_here, 1) ? std::move(from_there) : std::move(from_here);
  return true;
}

std::optional<Eigen::VectorXd> shift_by_stray_size(const Problem& data, const Stage& stage, const State& state) {
  if (!data.has_stray || stage.frees(Group::stray_size)) return std::nullopt;
  const EffectEquations asked = effect_equations(data, stage, state, {Group::stray_size});
  const auto answer = [&](const Stage& with) -> Eigen::VectorXd {
    return -safe_inverse(asked.H, free_unknowns(data, with, state.lamps.size())) * asked.g;
  };
  const Eigen::VectorXd with_size = answer(asked.all);
  if (!(with_size[unknown::stray_spread2] > 0)) return std::nullopt;
  return with_size - answer(stage);
}

}  // namespace burin
