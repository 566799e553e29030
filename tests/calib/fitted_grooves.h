// tests/calib/fitted_grooves.h - photos predicted from known grooves, with noise and perhaps what the model lacks, and
// what a fit makes of them. For tests only.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "burin/calib/photo/photo_fit.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/photo/photo_weights.h"
#include "burin/capture/glare.h"
#include "tests/calib/small_grooves.h"

namespace burin {

struct FittedGrooves {
  SmallGrooves s;
  Stage stage;
  State state;
};

/// Into each photo, glare of that share, and what glare of share 1 would show.
inline void add_glare(double share, SmallGrooves& s) {
  const Glare glare{share, 4, 60};
  for (PhotoData& photo : s.data.photos) {
    Image& value = photo.photo.value;
    photo.photo.scattered = glare_of(value, glare);
    for (std::size_t i = 0; i < value.data.size(); ++i)
      value.data[i] += static_cast<float>(share) * (photo.photo.scattered.data[i] - value.data[i]);
  }
}

/// What a camera that shows value^bend makes of a photo's light, with its noise: 0.2 % of the brightest.
inline void see_by_camera(double bend, std::mt19937_64& random, std::normal_distribution<float>& normal,
                          PhotoData& photo) {
  float brightest = 0;
  for (const float v : photo.photo.value.data) brightest = std::max(brightest, v);
  for (std::size_t i = 0; i < photo.weight.size(); ++i) {
    float& value = photo.photo.value.data[i];
    if (value > 0) value = brightest * std::pow(value / brightest, static_cast<float>(bend));
    photo.photo.sigma.data[i] = 0.002F * brightest;
    value += photo.photo.sigma.data[i] * normal(random);
    if (photo.weight[i] > 0) photo.weight[i] = 1 / photo.photo.sigma.data[i];
  }
}

/// Into `out`: six photos of a lamp with that radius (0: a point) by a camera that shows value^bend, fitted with a
/// point and a straight camera; into the last photo another lamp shines, `stray` times as bright; a share `glare` of
/// the light is scattered. `out` must stay where it is: its problem points into it.
inline void fit_small_grooves(double disk_mm, double bend, FittedGrooves& out, double stray = 0, double glare = 0) {
  SmallGrooves& s = out.s;
  fill_small_grooves(s, 11);
  s.data.size_sought = {true};
  for (int k = 0; k < 6; ++k) s.data.photos.push_back(make_photo_data(add_view(s, k), 1, s.board, s.bench, 2));
  State truth = s.truth;
  truth.block(unknown::size2)[0] = std::pow(disk_mm / size_unit_mm(s.board), 2);
  std::mt19937_64 random(5);
  std::normal_distribution<float> normal;
  for (PhotoData& photo : s.data.photos) {
    photo.photo.value = predict(s.data.model, photo, truth.of(0), carved_at(s.data.model, truth.of(0)));
    if (stray > 0 && &photo == &s.data.photos.back()) {
      Unknowns other = truth.of(0);
      other[unknown::lamp_position] -= 60;
      other[unknown::log_intensity] += std::log(stray);
      const Image more = predict(s.data.model, photo, other, carved_at(s.data.model, other));
      for (std::size_t i = 0; i < more.data.size(); ++i) photo.photo.value.data[i] += more.data[i];
    }
  }
  if (glare > 0) add_glare(glare, s);
  for (PhotoData& photo : s.data.photos) see_by_camera(bend, random, normal, photo);
  out.stage.hold({Group::lamp, Group::machine, Group::vignette});
  out.state = s.truth;
  for (int round = 0; round < 2; ++round) {
    weigh_photos(s.data, out.state);
    solve(s.data, out.stage, 12, 1e-7, out.state, {}, "");
  }
}

}  // namespace burin
