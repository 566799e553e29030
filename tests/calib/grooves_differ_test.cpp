// What is proved, on photos predicted from grooves that each have a roughness and a depth of their own: the slopes by
// which their scatter is found are the prediction's derivatives, and so are each groove's; the scatter is found, and is
// not taken from errors that pixels have alone; the mean light of many such
// boards is predicted better with it than by equal grooves; and a field over the board is told apart from such
// accidents: none is chosen where there is none, a gradient of depth is found where there is one. Not proved: that real
// grooves differ as normal distributions do.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "burin/calib/photo/field_choice.h"
#include "burin/calib/photo/photo_fit.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/photo/photo_weights.h"
#include "tests/calib/small_grooves.h"

namespace burin {
namespace {

void fill(SmallGrooves& s) {
  fill_small_grooves(s, 11);
  for (int k = 0; k < 6; ++k) s.data.photos.push_back(make_photo_data(add_view(s, k), 1, s.board, s.bench, 2));
}

// Grooves of their own: log-normal factors, and depth_gradient from left to right.
Carved uneven(const SmallGrooves& s, double alpha_jitter, double depth_jitter, double depth_gradient,
              std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Carved grooves = carved_at(s.data.model, s.truth.of(0));
  Scratches& carved = grooves.scratches;
  for (std::size_t i = 0; i < carved.size(); ++i) {
    const double u = 0.5 * (carved.x0_mm[i] + carved.x1_mm[i]) / s.board.size_mm.x() - 0.5;
    carved.alpha.push_back(0.08 * std::exp(alpha_jitter * normal(random)));
    carved.depth_um.push_back(18 * std::exp(depth_jitter * normal(random)) * (1 + depth_gradient * u));
  }
  return grooves;
}

// Photographs the board with noise of a hundredth of each photo's brightest pixel.
void photograph(SmallGrooves& s, const Carved& carved, std::mt19937_64& random) {
  std::normal_distribution<float> normal;
  for (PhotoData& photo : s.data.photos) {
    photo.photo.value = predict(s.data.model, photo, s.truth.of(0), carved);
    float brightest = 0;
    for (const float v : photo.photo.value.data) brightest = std::max(brightest, v);
    for (std::size_t i = 0; i < photo.weight.size(); ++i) {
      photo.photo.sigma.data[i] = 0.002F * brightest;
      photo.photo.value.data[i] += photo.photo.sigma.data[i] * normal(random);
      if (photo.weight[i] > 0) photo.weight[i] = 1 / photo.photo.sigma.data[i];
    }
  }
}

TEST(GroovesDiffer, SlopesAreThePredictionsDerivatives) {
  SmallGrooves s;
  fill(s);
  const PhotoData& photo = s.data.photos[3];
  const Unknowns x = s.truth.of(0);
  const GrooveSlopes p = predict_with_slopes(s.data.model, photo, x, carved_at(s.data.model, x));
  for (const int index : {unknown::log_alpha, unknown::log_depth}) {
    constexpr double kStep = 0.01;
    Unknowns more = x, less = x;
    more[index] += kStep;
    less[index] -= kStep;
    const Image above = predict(s.data.model, photo, more, carved_at(s.data.model, more));
    const Image below = predict(s.data.model, photo, less, carved_at(s.data.model, less));
    const Image& slope = index == unknown::log_alpha ? p.by_log_alpha : p.by_log_depth;
    double off = 0, size = 0;
    for (std::size_t i = 0; i < slope.data.size(); ++i) {
      const double difference = (static_cast<double>(above.data[i]) - below.data[i]) / (2 * kStep);
      off += std::pow(difference - slope.data[i], 2);
      size += difference * difference;
    }
    EXPECT_GT(size, 0);
    EXPECT_LT(std::sqrt(off / size), 0.01) << index;
  }
}

TEST(GroovesDiffer, TheirScatterIsFound) {
  for (const auto& [alpha, depth] : {std::pair(0.1, 0.0), {0.0, 0.04}, {0.06, 0.03}, {0.0, 0.0}}) {
    SmallGrooves s;
    fill(s);
    std::mt19937_64 random(5);
    photograph(s, uneven(s, alpha, depth, 0, random), random);
    weigh_photos_and_grooves(s.data, s.truth);
    // Where grooves cross, a pixel's slope is a sum and its scatter less than that. The two are not quite told apart.
    EXPECT_NEAR(s.data.model.alpha_jitter, alpha, 0.3 * alpha + 0.015);
    EXPECT_NEAR(s.data.model.depth_jitter, depth, 0.3 * depth + 0.015);
  }
}

TEST(GroovesDiffer, ErrorsOfSinglePixelsAreNoScatterOfGrooves) {
  SmallGrooves s;
  fill(s);
  std::mt19937_64 random(5);
  photograph(s, uneven(s, 0.06, 0, 0, random), random);
  // As if every pixel saw grooves of another depth: the same squares, nothing in common.
  constexpr double kError = 0.03;
  std::normal_distribution<double> normal;
  const Unknowns x = s.truth.of(0);
  for (PhotoData& photo : s.data.photos) {
    const GrooveSlopes p = predict_with_slopes(s.data.model, photo, x, carved_at(s.data.model, x));
    for (std::size_t i = 0; i < p.by_log_depth.data.size(); ++i)
      photo.photo.value.data[i] += static_cast<float>(kError * normal(random) * p.by_log_depth.data[i]);
  }
  weigh_photos_and_grooves(s.data, s.truth);
  EXPECT_NEAR(s.data.slope_error[1], kError, 0.3 * kError);
  EXPECT_LT(s.data.model.depth_jitter, 0.012);
  EXPECT_NEAR(s.data.model.alpha_jitter, 0.06, 0.02);
  EXPECT_GT(s.data.model.depth_jitter2_sigma, 0);
  EXPECT_LT(s.data.model.depth_jitter2_sigma, kError * kError);
}

TEST(GroovesDiffer, GradientsOfGroovesAreThePredictionsBackwards) {
  SmallGrooves s;
  fill(s);
  for (const bool last_rules : {false, true}) {
    s.data.model.crossings = last_rules ? Crossings::last : Crossings::add;
    const PhotoData& photo = s.data.photos[3];
    const Unknowns x = s.truth.of(0);
    const Carved pieces = carved_pieces(s.data.model, x);
    ASSERT_EQ(pieces.source.size(), pieces.size());
    // E: the values of the pixels in use, each by a weight of its own.
    std::mt19937_64 random(3);
    std::normal_distribution<float> normal;
    Image weights(photo.photo.value.width, photo.photo.value.height, 1);
    for (std::size_t i = 0; i < weights.data.size(); ++i)
      if (photo.weight[i] > 0) weights.data[i] = normal(random);
    const std::vector<GrooveGradients> gradients = groove_gradients(photo, x, pieces, {&weights, 1});
    ASSERT_EQ(gradients.size(), 1U);
    const auto E = [&](const Carved& carved) {
      const Image value = predict(s.data.model, photo, x, carved);
      double sum = 0;
      for (std::size_t i = 0; i < value.data.size(); ++i) sum += static_cast<double>(weights.data[i]) * value.data[i];
      return sum;
    };
    for (const bool of_depth : {false, true}) {  // by all grooves at once, each by an amount of its own
      constexpr double kStep = 0.003;
      Carved more = pieces, less = pieces;
      double expected = 0, size = 0;
      for (std::size_t i = 0; i < more.size(); ++i) {
        const double by = normal(random);
        std::vector<double>&above = of_depth ? more.scratches.depth_um : more.scratches.alpha,
        &below = of_depth ? less.scratches.depth_um : less.scratches.alpha;
        above[i] *= std::exp(kStep * by);
        below[i] *= std::exp(-kStep * by);
        const double term = by * (of_depth ? gradients[0].by_log_depth[i] : gradients[0].by_log_alpha[i]);
        expected += term;
        size += term * term;
      }
      EXPECT_NEAR((E(more) - E(less)) / (2 * kStep), expected, 0.01 * std::sqrt(size)) << of_depth << last_rules;
    }
  }
}

TEST(GroovesDiffer, MeanLightIsNotThatOfEqualGrooves) {
  SmallGrooves s;
  fill(s);
  std::mt19937_64 random(7);
  PhotoData& photo = s.data.photos[2];
  const Unknowns x = s.truth.of(0);
  constexpr int kBoards = 400;
  std::vector<double> mean(photo.weight.size(), 0);
  for (int board = 0; board < kBoards; ++board) {
    const Image value = predict(s.data.model, photo, x, uneven(s, 0.2, 0, 0, random));
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += value.data[i] / kBoards;
  }
  const auto sums = [&] {  // of prediction less mean; and of what is bright, so that the plain face is not all
    const Image value = predict(s.data.model, photo, x, carved_at(s.data.model, x));
    double off = 0;
    for (std::size_t i = 0; i < mean.size(); ++i)
      if (photo.weight[i] > 0) off += value.data[i] - mean[i];
    return off;
  };
  const double equal = sums();
  s.data.model.alpha_jitter = 0.2;
  shift_by_grooves(s.data.model, x, carved_at(s.data.model, x), photo);
  EXPECT_LT(std::abs(sums()), 0.25 * std::abs(equal));
}

TEST(GroovesDiffer, FieldsAreToldApartFromAccidents) {
  for (const double gradient : {0.0, -0.1}) {
    SmallGrooves s;
    fill(s);
    std::mt19937_64 random(9);
    photograph(s, uneven(s, 0.08, 0.02, gradient, random), random);
    Stage stage;
    stage.hold({Group::lamp, Group::machine, Group::ambient, Group::vignette});
    State state = s.truth;
    for (int round = 0; round < 2; ++round) {
      weigh_photos_and_grooves(s.data, state);
      solve(s.data, stage, 10, 1e-7, state, {}, "");
    }
    const FreeField choice = choose_depth_field(s.data, stage, state);
    EXPECT_EQ(choice.linear, gradient != 0);
    EXPECT_FALSE(choice.quadratic);
    if (gradient == 0) continue;
    stage.free(choice);
    solve(s.data, stage, 10, 1e-7, state, {}, "");
    EXPECT_NEAR(state.shared[unknown::depth_field], gradient, 0.3 * std::abs(gradient));
    EXPECT_NEAR(state.shared[unknown::depth_field + 1], 0, 0.3 * std::abs(gradient));
  }
}

}  // namespace
}  // namespace burin
