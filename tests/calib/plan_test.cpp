// What is proved: the sigmas that a plan promises are the scatter of solves of such photos (fresh noise on the corners,
// the whole bundle solved again); they never grow with a shot more; a bench without a place at the grooves' cut-off is
// told so and its depth counts as unknown; places come out in words that a ruler can follow.
// Not proved: that light's promised sigmas are those of real photos; docs/results/calibration.md compares them on
// photographed benches.
#include "burin/calib/plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "burin/base/error.h"
#include "burin/calib/geometry/bundle.h"
#include "burin/calib/verdict/candidate_photo.h"

namespace burin {
namespace {

Board small_board() {
  Board board;
  board.size_mm << 120, 100;
  board.carve_min_mm << 25, 25;
  board.carve_max_mm << 95, 75;
  board.tags.sigma_mm = 0.2;
  for (int i = 0; i < 4; ++i) {
    board.tags.list.push_back({i, {12 + 32.0 * i, 10}, 12, 0});
    board.tags.list.push_back({10 + i, {12 + 32.0 * i, 90}, 12, 0});
  }
  return board;
}

Bench small_bench(const Board& board) {
  Bench bench;
  bench.lens.model = "LENSMODEL_OPENCV4";
  bench.lens.width = 1200;
  bench.lens.height = 900;
  bench.lens.intrinsics = {1800, 1800, 599.5, 449.5, 0, 0, 0, 0};
  Light light;
  light.position_mm << 60, 300, 350;
  bench.lights = {light};
  bench.material = board.material;
  return bench;
}

PlanOptions quick_plan() {
  PlanOptions options;
  options.light.pixel_mm = 3;
  return options;
}

double sigma_of(const Plan& plan, const std::string& name, std::size_t shot) {
  for (std::size_t i = 0; i < plan.parameters.size(); ++i)
    if (plan.parameters[i].name == name) return plan.shots[shot].sigma[i];
  ADD_FAILURE() << "no parameter " << name;
  return 0;
}

TEST(Plan, PromisesTheScatterOfSolvesOfSuchPhotos) {
  const Board board = small_board();
  const Bench bench = small_bench(board);
  PlanOptions options = quick_plan();
  options.shots = 6;
  const Plan plan = plan_shots(board, bench, test_strokes(board), options);
  ASSERT_EQ(plan.shots.size(), 6U);

  Bundle exact;
  exact.lens = bench.lens;
  exact.surface.size_mm = board.size_mm;
  for (const Tag& tag : board.tags.list) {
    TagPlacement placement;
    placement.sigma_mm = board.tags.sigma_mm;
    placement.sigma_rad = placement.sigma_mm / (tag.size_mm / 2);
    exact.tags.push_back(placement);
  }
  std::vector<CameraPlace> places;
  for (const PlannedShot& shot : plan.shots) places.push_back(shot.camera);
  append_candidates(exact, board, places, options.corner_sigma_px);
  std::mt19937_64 random(4);
  std::normal_distribution<double> gauss;
  double focal2 = 0, tag2 = 0;
  constexpr int kWorlds = 40;
  for (int world = 0; world < kWorlds; ++world) {
    Bundle noisy = exact;
    for (BundleCorner& c : noisy.corners) c.q_px += c.sigma_px * Eigen::Vector2d(gauss(random), gauss(random));
    solve_bundle(noisy, {});
    const double worst = std::abs(noisy.lens.intrinsics[0] / 1800 - 1);
    focal2 += std::pow(100 * worst, 2) / kWorlds;
    for (const TagPlacement& t : noisy.tags)
      tag2 += t.shift_mm.squaredNorm() / (2.0 * static_cast<double>(noisy.tags.size())) / kWorlds;
  }
  // 40 worlds tell a sigma to 11 %; the promise for the focal length is the larger of fx's and fy's.
  EXPECT_NEAR(std::sqrt(focal2) / sigma_of(plan, "lens focal length", 5), 1, 0.35);
  EXPECT_NEAR(std::sqrt(tag2) / sigma_of(plan, "board.tags", 5), 1, 0.2);
  for (std::size_t i = 0; i < plan.parameters.size(); ++i)
    for (std::size_t shot = 0; shot < plan.shots.size(); ++shot)
      EXPECT_LE(plan.shots[shot].sigma[i],
                (shot == 0 ? plan.parameters[i].before : plan.shots[shot - 1].sigma[i]) * 1.0001)
          << plan.parameters[i].name;
  EXPECT_TRUE(plan.straddles);
  EXPECT_LT(sigma_of(plan, "depth_um", 5), 10);
}

TEST(Plan, SaysWhenTheDepthStaysUnknown) {
  Board board = small_board();
  // Grooves so deep that their walls reach 80 degrees: no half vector leans that far.
  board.tool_width_um = 400;
  board.material.depth_um = 250;
  PlanOptions options = quick_plan();
  options.shots = 3;
  const Plan plan = plan_shots(board, small_bench(board), test_strokes(board), options);
  EXPECT_FALSE(plan.straddles);
  EXPECT_EQ(sigma_of(plan, "depth_um", 2), 30);  // as believed before
  EXPECT_LT(sigma_of(plan, "alpha", 2), 50);
}

// A plan for one depth may leave another unknown: told by planning for each depth alone, with the same shots' number.
TEST(Plan, HoldsForADepthThatIsThirtyPercentOff) {
  const Board board = small_board();
  const Bench believed = small_bench(board);
  PlanOptions options = quick_plan();
  options.shots = 4;
  const Plan plan = plan_shots(board, believed, test_strokes(board), options);
  ASSERT_EQ(plan.at_depth.size(), 3U);
  EXPECT_TRUE(plan.straddles);
  std::size_t depth = 0;
  while (plan.parameters[depth].name != "depth_um") ++depth;
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const PlanAtDepth& at = plan.at_depth[static_cast<std::size_t>(i)];
    EXPECT_NEAR(at.depth_um, (0.7 + 0.3 * i) * believed.material.depth_um, 1e-9);
    EXPECT_TRUE(at.straddles);
    EXPECT_LT(at.sigma[depth], 5) << at.depth_um;
    worst = std::max(worst, at.sigma[depth]);
    // What these very shots tell where that depth is the true one and is believed: planned for it alone, from the same
    // places as designed ones. The same number by another way.
    Bench other = believed;
    other.material.depth_um = at.depth_um;
    PlanOptions alone = quick_plan();
    alone.shots = 1;
    alone.depth_share = 0;
    for (const PlannedShot& shot : plan.shots)
      alone.designed.push_back({"s", shot.camera.center_mm(), believed.lights[shot.light].id});
    const Plan same = plan_shots(board, other, test_strokes(board), alone);
    ASSERT_EQ(same.at_depth.size(), 1U);
    // depth_share 0 believes less of it before; with a sigma of a few percent that is nothing. Cameras on their side
    // are upright here.
    EXPECT_NEAR(same.shots[plan.shots.size() - 1].sigma[depth] / at.sigma[depth], 1, 0.15) << at.depth_um;
  }
  EXPECT_EQ(sigma_of(plan, "depth_um", plan.shots.size() - 1), worst);
}

TEST(Plan, KeepsOneFocus) {
  const Board board = small_board();
  const Bench bench = small_bench(board);
  PlanOptions options = quick_plan();
  options.shots = 6;
  options.focus = FocusRange{400, 470};
  const Plan plan = plan_shots(board, bench, test_strokes(board), options);
  ASSERT_EQ(plan.shots.size(), 6U);
  for (const PlannedShot& shot : plan.shots) {
    EXPECT_GE(shot.camera.distance_mm, 400 - 1e-9);
    EXPECT_LE(shot.camera.distance_mm, 470 + 1e-9);
  }
  // Nearer than the whole board is seen from: nothing but what a person wants.
  options.focus = FocusRange{90, 100};
  EXPECT_THROW(plan_shots(board, bench, test_strokes(board), options), Error);
  options.designed = {{"far", {60, 50, 900}, "lamp"}};
  const Plan designed = plan_shots(board, bench, test_strokes(board), options);
  ASSERT_EQ(designed.shots.size(), 1U);
  EXPECT_EQ(designed.shots[0].view, "far");
  // A place from which tags are too small to be measured is no photo, and no reason to give up.
  options.designed.push_back({"balcony", {60, 50, 20'000}, "lamp"});
  const Plan both = plan_shots(board, bench, test_strokes(board), options);
  EXPECT_EQ(both.shots.size(), 1U);
  EXPECT_EQ(both.unseen, std::vector<std::string>{"balcony"});
}

TEST(DepthOfField, IsThatOfATableForPhotographers) {
  Lens lens;
  lens.width = 6000;
  lens.height = 4000;
  const double focal_px = 50.0 / 36 * 6000;
  lens.intrinsics = {focal_px, focal_px, 2999.5, 1999.5, 0, 0, 0, 0};
  // 50 mm on 24 x 36 at f/8, 0.03 mm: hyperfocal H = f^2 / (N c) + f = 10.47 m; near H s / (H + s), far H s / (H - s),
  // s small beside f's correction: 1 m is sharp from 0.913 to 1.106 m.
  const FocusRange at_1m = depth_of_field(lens, 1000);
  EXPECT_NEAR(at_1m.near_mm, 913, 3);
  EXPECT_NEAR(at_1m.far_mm, 1106, 3);
  // Beyond the hyperfocal distance all is sharp to infinity; nobody is sent there.
  EXPECT_EQ(depth_of_field(lens, 20'000).far_mm, 60'000);
  // The same field of view in fewer pixels is the same lens.
  Lens small = lens;
  small.width = 1500;
  small.height = 1000;
  small.intrinsics[0] = small.intrinsics[1] = focal_px / 4;
  EXPECT_NEAR(depth_of_field(small, 1000).near_mm, at_1m.near_mm, 1e-9);
}

TEST(Plan, RefusesWhatItCannotPlanFor) {
  const Board board = small_board();
  Bench bench = small_bench(board);
  Board bare = board;
  bare.tags.list.clear();
  EXPECT_THROW(plan_shots(bare, bench, test_strokes(board), quick_plan()), Error);
  EXPECT_THROW(plan_shots(board, bench, {}, quick_plan()), Error);
  bench.lights[0].position_mm.z() = -100;
  EXPECT_THROW(plan_shots(board, bench, test_strokes(board), quick_plan()), Error);
  bench.lights.clear();
  EXPECT_THROW(plan_shots(board, bench, test_strokes(board), quick_plan()), Error);
}

TEST(PlaceInWords, CanBeFollowedWithARuler) {
  const Board board = small_board();  // 120 x 100 mm
  EXPECT_EQ(place_in_words(Eigen::Vector3d(0, 0, 620), board), "620 mm above the lower left corner");
  EXPECT_EQ(place_in_words(Eigen::Vector3d(60, 50, 500), board), "500 mm above the board's middle");
  EXPECT_EQ(place_in_words(Eigen::Vector3d(-240, 110, 620), board),
            "620 mm above the face, 240 mm beyond the left edge, 10 mm beyond the upper edge");
  EXPECT_EQ(place_in_words(Eigen::Vector3d(100, 30, 350), board),
            "350 mm above the face, 20 mm in from the right edge, 30 mm in from the lower edge");
}

TEST(InTheWay, IsWhoStandsInTheLightOrInTheSight) {
  const Board board = small_board();  // middle 60, 50; half its diagonal 78 mm
  const Eigen::Vector3d lamp(60, 50, 600);
  EXPECT_TRUE(in_the_way({60, 50, 300}, lamp, board));    // between lamp and board
  EXPECT_TRUE(in_the_way({60, 50, 900}, lamp, board));    // the lamp is before the camera
  EXPECT_TRUE(in_the_way({160, 50, 300}, lamp, board));   // half way down the cone is 39 mm wide, and a hand more
  EXPECT_FALSE(in_the_way({180, 50, 300}, lamp, board));  // 120 mm off its axis: beside it
  EXPECT_FALSE(in_the_way({400, 50, 500}, lamp, board));
}

TEST(CameraPlaces, AllSeeTheWholeBoard) {
  const Board board = small_board();
  const Bench bench = small_bench(board);
  const auto places = camera_places(board, bench.lens, true);
  EXPECT_GT(places.size(), 90U);
  for (const CameraPlace& place : places)
    for (const double x : {0., 120.})
      for (const double y : {0., 100.}) {
        const Eigen::Vector3d p = place.T_camera_board * Eigen::Vector3d(x, y, 0);
        ASSERT_GT(p.z(), 0);
        Eigen::Vector2d q;
        project(bench.lens, {&p, 1}, {&q, 1});
        EXPECT_TRUE(q.x() > 0 && q.y() > 0 && q.x() < 1199 && q.y() < 899) << q.transpose();
      }
  // Words and pose agree.
  EXPECT_NEAR((places[4].center_mm() - Eigen::Vector3d(60, 50, 0)).norm(), places[4].distance_mm, 1e-6);
}

}  // namespace
}  // namespace burin
