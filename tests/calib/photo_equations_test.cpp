// What is proved: the gradient that the fit descends along (Jtr) is the derivative of its cost by every unknown, by
// central differences: the renderer's derivatives, their chain through the machine's parametrization, a spot's
// fall-off, the blur, vignetting, glare and the robust loss together. Not proved: that the model is right (the rigs
// prove that, refine_test.cpp).
#include "burin/calib/photo/photo_equations.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "burin/calib/geometry/geometry_prior.h"
#include "burin/calib/photo/carved_states.h"
#include "burin/calib/photo/effect_unknowns.h"
#include "burin/calib/photo/stray_light.h"

namespace burin {
namespace {

struct Scene {
  Board board;
  Bench bench;
  Sent sent;
  ModelData model;
  PhotoData photo;
  Unknowns truth, start;
};

LightView view_through(const Lens& lens) {
  LightView v;
  v.lens = lens;
  v.window = {0, 0, 160, 120};
  v.value = Image(160, 120, 1);
  v.sigma = Image(160, 120, 1, 0.05F);
  v.valid.assign(160 * 120, 1);
  return v;
}

void fill(Scene& s, bool spot) {
  s.board.size_mm << 60, 40;
  s.board.carve_min_mm << 5, 5;
  s.board.carve_max_mm << 55, 35;
  s.board.tool_width_um = 600;
  s.bench.lens.model = "LENSMODEL_PINHOLE";
  s.bench.lens.intrinsics = {420, 425, 80, 60};
  s.bench.lens.width = 160;
  s.bench.lens.height = 120;
  View view;
  view.name = "v";
  // Looks down at the board's middle, tilted by 0.4 rad about the board's x.
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  view.T_camera_board.linear() = R;
  view.T_camera_board.translation() = Eigen::Vector3d(0, 0, 200) - R * Eigen::Vector3d(30, 20, 0);
  s.bench.views = {view};
  s.bench.bow_mm << 0.05, 0.01, -0.03;
  s.bench.lights.resize(1);

  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> x(8, 52), y(8, 32), turn(0, std::numbers::pi);
  for (int i = 0; i < 80; ++i) {
    const double cx = x(random), cy = y(random), a = turn(random);
    s.sent.scratches.x0_mm.push_back(cx - 3 * std::cos(a));
    s.sent.scratches.y0_mm.push_back(cy - 3 * std::sin(a));
    s.sent.scratches.x1_mm.push_back(cx + 3 * std::cos(a));
    s.sent.scratches.y1_mm.push_back(cy + 3 * std::sin(a));
  }
  s.model.board = &s.board;
  s.model.sent = &s.sent;
  s.model.center_mm << 30, 20;
  s.model.f0 = s.board.material.f0.mean();

  Unknowns& t = s.truth;
  t.setZero();
  t[unknown::log_alpha] = std::log(0.12);
  t[unknown::log_depth] = std::log(25);
  t[unknown::log_base_alpha] = std::log(0.3);
  t.segment<6>(unknown::machine) << 1.002, -0.001, 0.0015, 0.998, 0.05, -0.04;
  t[unknown::ambient] = 0.2;
  t.segment<3>(unknown::vignette) << -0.2, -0.05, 0.02;
  t[unknown::log_blur] = std::log(0.8);
  t.segment<3>(unknown::lamp_position) << 60, -60, 180;
  t[unknown::log_intensity] = std::log(4e4);
  if (spot) t.segment<3>(unknown::spot) << 25, 15, 6;
  t[unknown::flank] = 30;

  LightView v = view_through(s.bench.lens);
  t[unknown::glare_share] = 0.02;
  v.scattered = Image(160, 120, 1);
  for (std::size_t i = 0; i < v.scattered.data.size(); ++i)
    v.scattered.data[i] = 0.4F + 0.004F * static_cast<float>(i % 160);
  s.photo = make_photo_data(v, 1, s.board, s.bench, 2);
  s.photo.photo.value = predict(s.model, s.photo, t, carved_at(s.model, t));
  s.start = t;
  s.start[unknown::log_alpha] += 0.05;
  s.start[unknown::log_depth] -= 0.07;
  s.start[unknown::log_base_alpha] += 0.02;
  s.start.segment<2>(unknown::machine + 4) += Eigen::Vector2d(0.02, 0.03);
  s.start.segment<3>(unknown::lamp_position) += Eigen::Vector3d(1, -0.7, 2);
  s.start[unknown::log_blur] += 0.05;
  s.start[unknown::ambient] += 0.01;
  s.start[unknown::glare_share] += 0.01;
}

// What only some benches have is no derivative but a difference (difference_step()): EffectsAreDifferences has it.
bool is_difference(int i) {
  return (i >= unknown::size2 && i < unknown::pose) || (i >= unknown::stray && i <= unknown::stray_spread2) ||
         (i >= unknown::backlash && i <= unknown::log_across && i != unknown::grain && i != unknown::grain + 1);
}

void check_gradient(const Scene& s) {
  FreeUnknowns free{};
  for (int i = 0; i < unknown::count; ++i) free[i] = true;
  const bool spot = s.start[unknown::spot + 2] > 0;
  const CellGrid tiles = cell_grid(s.model.board->size_mm, 10);
  const PhotoEquations e = photo_equations(s.model, s.photo, s.start, CarvedStates(s.model), free, &tiles);
  EXPECT_NEAR(e.cost, photo_cost(s.model, s.photo, s.start, carved_at(s.model, s.start)), 1e-4 * e.cost);
  EXPECT_GT(e.cost, 100);
  EXPECT_LT((e.tile_scores.rowwise().sum() - e.Jtr).norm(), 1e-9 * e.Jtr.norm());
  for (int i = 0; i < unknown::pose; ++i) {
    if ((i >= unknown::spot && !spot) || is_difference(i)) continue;
    // Steps as long as a relative change of 1e-3 in the cost's curvature allows; pixels are float.
    const double step =
        (i >= unknown::machine && i < unknown::machine + 4) ? 1e-4
        : (i >= unknown::lamp_position && i < unknown::log_intensity) || i == unknown::spot || i == unknown::spot + 1
            ? 0.1
            : 2e-3;
    const auto cost_at = [&](double offset) {
      Unknowns x = s.start;
      x[i] += offset;
      return photo_cost(s.model, s.photo, x, carved_at(s.model, x));
    };
    const double difference = (cost_at(step) - cost_at(-step)) / (2 * step);
    // A field of depth or alpha is taken at the pixel's place, not at the middle of its scratch: 3 mm of 60 at most.
    const double tolerance = i >= unknown::depth_field && i < unknown::machine ? 0.05 : 0.005;
    const double scale = std::sqrt(2 * e.cost * e.JtJ(i, i));  // what Jtr could be if all residuals pulled together
    EXPECT_NEAR(e.Jtr[i], difference, tolerance * std::abs(difference) + 1e-3 * scale) << "unknown " << i;
    EXPECT_GT(e.JtJ(i, i), 0) << "unknown " << i;
  }
}

// The cost changes with lens and pose as its gradient says, the photo's grid made anew for each. (That distortion
// makes things larger or smaller as well is left out of its gradient, hence the wider bound.)
TEST(PhotoEquations, LensAndPoseMoveThePicture) {
  Scene s;
  fill(s, false);
  s.bench.lens.model = "LENSMODEL_OPENCV4";
  s.bench.lens.intrinsics = {420, 425, 80, 60, -0.1, 0.05, 0.002, -0.001};
  const Carved carved = carved_at(s.model, s.start);
  const PhotoData far_from_edges = make_photo_data(view_through(s.bench.lens), 1, s.board, s.bench, 8);
  const auto photo_of = [&](const Bench& bench) {
    PhotoData photo = make_photo_data(view_through(bench.lens), 1, s.board, bench, 2);
    photo.photo.value = s.photo.photo.value;
    photo.weight = far_from_edges.weight;  // blur brings in pixels that hold the board's edge
    return photo;
  };
  const PhotoData photo = photo_of(s.bench);
  FreeUnknowns free{};
  const auto parameters = static_cast<int>(free_lens_parameters(s.bench.lens));
  ASSERT_EQ(parameters, 8);
  for (int i = unknown::pose; i < unknown::bow; ++i) free[i] = true;
  for (int i = 0; i < parameters; ++i) free[unknown::lens + i] = true;
  const PhotoEquations e = photo_equations(s.model, photo, s.start, CarvedStates(s.model), free);
  const auto check = [&](int unknown, double step, double tolerance, const std::function<Bench(double)>& moved) {
    const auto cost = [&](double by) { return photo_cost(s.model, photo_of(moved(by)), s.start, carved); };
    const double scale = std::sqrt(2 * e.cost * e.JtJ(unknown, unknown));
    EXPECT_NEAR(e.Jtr[unknown], (cost(step) - cost(-step)) / (2 * step), tolerance * scale) << "unknown " << unknown;
    EXPECT_GT(e.JtJ(unknown, unknown), 0);
  };
  for (int i = 0; i < 6; ++i)
    check(unknown::pose + i, i < 3 ? 1e-5 : 0.002, 3e-3, [&](double by) {
      Bench bench = s.bench;
      bench.views[0].T_camera_board = moved_pose(bench.views[0].T_camera_board, by * Vector6::Unit(i));
      return bench;
    });
  // Steps that move the picture by thousandths of a pixel: of r^4 there is little in so small a picture.
  const std::array<double, 8> steps{1e-5, 1e-5, 1e-5, 1e-5, 5e-4, 1e-2, 5e-4, 5e-4};
  for (int i = 0; i < parameters; ++i)
    check(unknown::lens + i, steps[static_cast<std::size_t>(i)], i < 4 ? 3e-3 : 5e-3, [&](double by) {
      Bench bench = s.bench;
      bench.lens = moved_lens(bench.lens, by * Eigen::VectorXd::Unit(parameters, i));
      return bench;
    });
}

TEST(PhotoEquations, GradientIsTheCostsDerivativeBareLamp) {
  Scene s;
  fill(s, false);
  check_gradient(s);
}

TEST(PhotoEquations, GradientIsTheCostsDerivativeSpot) {
  Scene s;
  fill(s, true);
  check_gradient(s);
}

// A panel that is a spot, turned: the cost changes with its place, its axis and fall-off, which each of its points has
// of its own, its size and its sides as the gradient says.
TEST(PhotoEquations, LampsWithAnAreaKnowTheirSidesAndTheirSpot) {
  Scene s;
  fill(s, true);
  Unknowns x = s.start;
  x[unknown::size2] = 12;
  x.segment<2>(unknown::sides2) << 5, 3;
  x[unknown::spot + 2] = 4;
  FreeUnknowns free{};
  for (int i = 0; i < unknown::pose; ++i) free[i] = true;
  const PhotoEquations e = photo_equations(s.model, s.photo, x, CarvedStates(s.model), free);
  const Carved carved = carved_at(s.model, x);
  for (int i = unknown::lamp_position; i < unknown::pose; ++i) {
    const double step = i < unknown::log_intensity || i == unknown::spot || i == unknown::spot + 1 ? 0.1 : 0.02;
    const auto cost_at = [&](double by) {
      Unknowns moved = x;
      moved[i] += by;
      return photo_cost(s.model, s.photo, moved, carved);
    };
    const double difference = (cost_at(step) - cost_at(-step)) / (2 * step);
    const double scale = std::sqrt(2 * e.cost * e.JtJ(i, i));
    EXPECT_NEAR(e.Jtr[i], difference, 0.02 * std::abs(difference) + 1e-3 * scale) << "unknown " << i;
    EXPECT_GT(e.JtJ(i, i), 0) << "unknown " << i;
  }
}

// A lamp and a window that nobody named: the cost changes with the window's place, light and size as the gradient says,
// and so it does with roughness and with the machine's map, which move both.
TEST(PhotoEquations, AStrayLightKnowsItsPlace) {
  Scene s;
  fill(s, true);
  Unknowns x = s.start;
  const double lamp_light = std::exp(x[unknown::log_intensity]) / x.segment<3>(unknown::lamp_position).squaredNorm();
  x.segment<kStrayNumbers>(unknown::stray) << 0.2, -0.4, 0.25, 0.5 * lamp_light, 0.003;
  FreeUnknowns free{};
  for (int i = 0; i < unknown::pose; ++i) free[i] = true;
  const PhotoEquations e = photo_equations(s.model, s.photo, x, CarvedStates(s.model), free);
  const std::array<std::pair<int, double>, 9> steps{{{unknown::log_alpha, 2e-3},
                                                     {unknown::log_base_alpha, 2e-3},
                                                     {unknown::machine + 4, 2e-3},
                                                     {unknown::lamp_position, 0.1},
                                                     {unknown::stray, 0.002},
                                                     {unknown::stray + 1, 0.002},
                                                     {unknown::stray_nearness, 0.005},
                                                     {unknown::stray_light, 0.01 * lamp_light},
                                                     {unknown::stray_spread2, 2e-4}}};
  for (const auto& [i, step] : steps) {
    const auto cost_at = [&, at = i](double by) {
      Unknowns moved = x;
      moved[at] += by;
      return photo_cost(s.model, s.photo, moved, carved_at(s.model, moved));
    };
    const double difference = (cost_at(step) - cost_at(-step)) / (2 * step);
    const double scale = std::sqrt(2 * e.cost * e.JtJ(i, i));
    EXPECT_GT(e.JtJ(i, i), 0) << "unknown " << i;
    EXPECT_NEAR(e.Jtr[i], difference, 0.03 * std::abs(difference) + 2e-3 * scale) << "unknown " << i;
  }
}

// The scores by backlash, screws, burrs, roughness across grooves and a lamp's size are what predictions a step away
// say.
TEST(PhotoEquations, EffectsAreDifferences) {
  Scene s;
  fill(s, false);
  Unknowns x = s.start;
  x.segment<2>(unknown::backlash) << 0.03, -0.02;
  x.segment<4>(unknown::screw) << 0.01, 0.004, -0.006, 0.012;
  x.segment<2>(unknown::screw_period) << std::log(6), std::log(9);
  x.segment<2>(unknown::burrs) << 1, 0.6;
  x[unknown::burr_width] = std::log(10);
  FreeUnknowns free{};
  for (int i = 0; i < unknown::pose; ++i) free[i] = true;
  const PhotoEquations e = photo_equations(s.model, s.photo, x, CarvedStates(s.model), free);
  const Image here = predict(s.model, s.photo, x, carved_at(s.model, x));
  for (int i = unknown::backlash; i < unknown::pose; ++i) {
    if (!is_difference(i) || i == unknown::flank || i >= unknown::sides2 ||
        (i >= unknown::stray && i <= unknown::stray_spread2))
      continue;
    const double step = difference_step(i, x[i]);
    Unknowns moved = x;
    moved[i] += step;
    const Image there = predict(s.model, s.photo, moved, carved_at(s.model, moved));
    double score = 0, size = 0;
    for (std::size_t p = 0; p < here.data.size(); ++p) {
      const double weight = s.photo.weight[p];
      const double r = weight * (here.data[p] - static_cast<double>(s.photo.photo.value.data[p]));
      const double counts = 1 / (1 + r * r / (s.model.cauchy * s.model.cauchy));
      const double by = weight * (there.data[p] - static_cast<double>(here.data[p])) / step;
      score += counts * r * by;
      size += counts * by * by;
    }
    EXPECT_GT(size, 0) << "unknown " << i;
    EXPECT_NEAR(e.Jtr[i], score, 0.01 * std::sqrt(2 * e.cost * size)) << "unknown " << i;  // pixels are float
    EXPECT_NEAR(e.JtJ(i, i), size, 0.01 * size) << "unknown " << i;
  }
}

TEST(CarvedStates, AnswersAsIfEachStateWereCarvedAnew) {
  Scene s;
  fill(s, false);
  s.sent.scratches.depth_um.assign(s.sent.size(), 20);
  s.sent.scratches.alpha.assign(s.sent.size(), 0.1);
  s.model.crossings = Crossings::deepest;
  s.model.profile.kind = GrooveProfile::Kind::rounded_v;
  s.start[unknown::flank] = 20;
  s.start[unknown::burr_width] = std::log(10);
  s.start.segment<4>(unknown::screw).setConstant(0.01);
  s.start.segment<2>(unknown::screw_period).setConstant(std::log(5));
  const CarvedStates grooves(s.model);
  const auto check = [&](const Unknowns& x, const std::string& what) {
    const Carved kept = *grooves.at(x), anew = carved_at(s.model, x);
    EXPECT_EQ(kept.scratches.x0_mm, anew.scratches.x0_mm) << what;
    EXPECT_EQ(kept.scratches.y1_mm, anew.scratches.y1_mm) << what;
    EXPECT_EQ(kept.scratches.depth_um, anew.scratches.depth_um) << what;
    EXPECT_EQ(kept.scratches.alpha, anew.scratches.alpha) << what;
    EXPECT_EQ(kept.source, anew.source) << what;
  };
  // Whatever carving asks of a state, twice around: more states than are kept.
  for (int round = 0; round < 2; ++round)
    for (int i = 0; i < unknown::ambient; ++i) {
      check(s.start, "start");
      Unknowns moved = s.start;
      moved[i] += difference_step(i, moved[i]);
      check(moved, "unknown " + std::to_string(i));
    }
}

TEST(PhotoEquations, SlopesHoldNearWhereTheyWereTakenAndNotFarAway) {
  for (const bool spot : {false, true}) {
    Scene s;
    fill(s, spot);
    FreeUnknowns free{};
    for (int i = 0; i < unknown::pose; ++i)
      free[i] = (i < unknown::depth_field || i >= unknown::machine) && !is_difference(i);
    const PhotoSlopes slopes =
        photo_slopes(s.model, s.photo, s.start, carved_at(s.model, s.start), CarvedStates(s.model), free);
    const auto seen = [&](const Unknowns& x) { return seen_light(s.model, s.photo, x, carved_at(s.model, x)); };
    Unknowns near = s.start, far = s.start;
    near[unknown::log_alpha] += 0.01;
    near[unknown::log_depth] -= 0.01;
    near[unknown::machine + 4] += 0.002;
    near[unknown::lamp_position] += 0.2;
    near[unknown::log_blur] += 0.01;
    near[unknown::ambient] += 0.02;
    far[unknown::log_alpha] -= 0.5;
    EXPECT_TRUE(slopes_hold(s.model, s.photo, slopes, s.start, seen(s.start)));
    EXPECT_TRUE(slopes_hold(s.model, s.photo, slopes, near, seen(near)));
    EXPECT_FALSE(slopes_hold(s.model, s.photo, slopes, far, seen(far)));
    // A change that the slopes did not foretell.
    EXPECT_FALSE(slopes_hold(s.model, s.photo, slopes, s.start, seen(near)));
    const PhotoEquations kept = photo_equations(s.model, s.photo, near, seen(near), slopes);
    const PhotoEquations taken = photo_equations(s.model, s.photo, near, CarvedStates(s.model), free);
    EXPECT_NEAR(kept.cost, taken.cost, 1e-5 * taken.cost);
    for (int i = 0; i < unknown::pose; ++i) {
      if (is_difference(i)) continue;
      EXPECT_NEAR(kept.Jtr[i], taken.Jtr[i], 0.05 * std::sqrt(2 * taken.cost * taken.JtJ(i, i))) << "unknown " << i;
    }
  }
}

TEST(PhotoEquations, DepthOfScratchesThatCarryTheirOwnKeepsItsRatio) {
  Scene s;
  fill(s, false);
  s.board.material.depth_um = 10;
  s.sent.scratches.depth_um.assign(s.sent.size(), 10);
  s.sent.scratches.depth_um[3] = 20;
  const Carved carved = carved_at(s.model, s.truth);
  EXPECT_NEAR(carved.scratches.depth_um[0], 25, 1e-9);
  EXPECT_NEAR(carved.scratches.depth_um[3], 50, 1e-9);
}

// Binned by 4, a pixel is 2 mm wide; photo-true values are the fine prediction's means. At the state where the
// correction was taken they are met exactly; a little beside it, most of what binning distorts is still made up for.
TEST(PhotoEquations, BinnedPixelsAreCorrectedByThePhotosOwn) {
  Scene s;
  fill(s, false);
  const LightView view = binned(s.photo.photo, 4);  // its value: the mean of the fine prediction at the truth
  PhotoData coarse = make_photo_data(view, 4, s.board, s.bench, 1);
  const auto distance = [&] {
    const Image predicted = predict(s.model, coarse, s.truth, carved_at(s.model, s.truth));
    double sum = 0;
    for (std::size_t i = 0; i < predicted.data.size(); ++i)
      if (coarse.weight[i] > 0) sum += std::pow(predicted.data[i] - view.value.data[i], 2);
    return std::sqrt(sum);
  };
  const double uncorrected = distance();
  ASSERT_GT(uncorrected, 0.01);
  constexpr std::size_t kMaxPixels = 1'000'000;
  correct_binning(s.model, s.photo.photo, s.board, s.bench, s.truth, carved_at(s.model, s.truth), kMaxPixels, coarse);
  EXPECT_LT(distance(), 1e-4 * uncorrected);
  correct_binning(s.model, s.photo.photo, s.board, s.bench, s.start, carved_at(s.model, s.start), kMaxPixels, coarse);
  EXPECT_LT(distance(), 0.5 * uncorrected);
  // Photos too large to be predicted whole are left as they were.
  correct_binning(s.model, s.photo.photo, s.board, s.bench, s.truth, carved_at(s.model, s.truth), 100, coarse);
  EXPECT_TRUE(coarse.correction.empty());
}

}  // namespace
}  // namespace burin
