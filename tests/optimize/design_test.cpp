// Proves that a small design converges on two views with the loss and picture quality it states, that a seed gives the
// same bits for one thread and two, that ends stay inside the carve area and above the smallest length, that dropping
// drops what it says, and that wrong input is refused in words. Quality on real pictures is measured by benchmarks.
#include "burin/optimize/design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <string_view>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/design/design_output.h"
#include "burin/optimize/design/picture_pixels.h"
#include "burin/optimize/toolpath/carving_order.h"
#include "burin/optimize/toolpath/carving_time.h"
#include "burin/pictures/picture.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using testing::HasSubstr;

class DesignTest : public testing::Test {
 protected:
  void SetUp() override {
    // Two pictures with nothing in common: a disc, and a ramp with a bar.
    Image disc(64, 64, 1, 0.25F), ramp(64, 64, 1);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        if (std::hypot(x - 31.5, y - 31.5) < 20) disc.at(x, y) = 0.8F;
        ramp.at(x, y) = x > 40 && x < 50 ? 0.8F : 0.3F + 0.4F * y / 63;
      }
    board_.size_mm = {60, 60};
    board_.carve_min_mm = {5, 5};
    board_.carve_max_mm = {55, 55};
    board_.tool_width_um = 400;
    board_.material.alpha = 0.05;
    board_.material.depth_um = 14;
    bench_.material = board_.material;
    bench_.material.base_alpha = 0.05;
    Light lamp;
    lamp.position_mm = {30, -400, 600};
    bench_.lights = {lamp};
    bench_.views = {view("left", {-180, -110, 600}), view("right", {240, -110, 600})};
    spec_.scratches = 2500;
    spec_.views = {{"left", "lamp", {}, 1}, {"right", "lamp", {}, 1}};
    spec_.views[0].target.image = disc;
    spec_.views[1].target.image = ramp;
    options_.pixels = 64;
    options_.iterations = 40;
    options_.rate = 5e-3;  // the pixels are large
  }
  static View view(const std::string& name, const Eigen::Vector3d& center_mm) {
    View v;
    v.name = name;
    // Looks straight down (x right, y down, z forward in the camera); where it looks does not matter to a design.
    Eigen::Matrix3d R;
    R << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    v.T_camera_board.linear() = R;
    v.T_camera_board.translation() = -R * center_mm;
    return v;
  }

  std::string error_of() {
    try {
      design(spec_, board_, bench_, options_, {});
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }

  TemporaryFolder folder_;
  Board board_;
  Bench bench_;
  DesignSpec spec_;
  DesignOptions options_;
};

TEST_F(DesignTest, ConvergesOnTwoViews) {
  options_.start = Start::random;
  options_.loss = {1, 0, 0.01};  // the paper's
  const DesignResult result = design(spec_, board_, bench_, options_, {});
  EXPECT_LT(result.final_loss, 0.2 * result.history.front().loss);
  for (const DesignedView& v : result.views) EXPECT_GT(v.psnr_db, v.start_psnr_db + 3) << v.view;
  // Each picture is its own target rather than the other's.
  for (std::size_t k = 0; k < 2; ++k) EXPECT_GT(result.views[k].ghost[k], 0.8);
}

// Without a search a stroke comes to a view by what little it sends there, which says where to turn.
TEST_F(DesignTest, StrokesThatNobodyPlacedTurnToTheViewsThatTheyAreFaintIn) {
  // Scratches for one are at right angles to those for the other.
  bench_.views = {view("left", {-400, 30, 600}), view("right", {460, 30, 600})};
  bench_.material.alpha = 0.03;
  options_.start = Start::random;
  options_.relocate_every = 0;
  options_.drop_error = 0;
  options_.iterations = 100;
  const DesignResult result = design(spec_, board_, bench_, options_, {});
  EXPECT_LT(result.final_loss, 0.05 * result.history.front().loss);
  for (const DesignedView& v : result.views) EXPECT_GT(v.psnr_db, 20) << v.view;
}

TEST_F(DesignTest, FewScratchesForManyPixelsAreNamedWithWhatWouldSuit) {
  options_.iterations = 0;
  const auto named = testing::Contains(testing::Field(&Finding::what, HasSubstr("pixels to a stroke")));
  EXPECT_THAT(design(spec_, board_, bench_, options_, {}).findings, testing::Not(named));
  options_.pixels = 160;
  spec_.scratches = 1250;  // 160 * 160 * 2 / 1250 = 41; 160 / sqrt(41 / 16) = 100; 0.5 mm at 1.5 minutes of arc: 1.1 m
  const auto few = design(spec_, board_, bench_, options_, {}).findings;
  EXPECT_THAT(few, named);
  EXPECT_THAT(few, testing::Contains(
                       testing::Field(&Finding::remedy, testing::AllOf(HasSubstr("1.1 m"), HasSubstr("--pixels 100 "),
                                                                       HasSubstr("some 3200 scratches")))));
  spec_.scratches = 1;  // in so few pixels nothing would be a picture
  EXPECT_THAT(design(spec_, board_, bench_, options_, {}).findings,
              testing::Contains(testing::Field(&Finding::remedy, testing::Eq("take some 3200 scratches"))));
}

TEST_F(DesignTest, PixelsAreChosenThatStrokesCanFill) {
  options_.pixels = 0;
  options_.iterations = 0;
  spec_.scratches = 600;
  const DesignResult chosen = design(spec_, board_, bench_, options_, {});
  const int side = chosen.views[0].shown.width;
  const double to_a_stroke = 2.0 * side * side / 600;
  EXPECT_LE(to_a_stroke, 40);
  EXPECT_GT(to_a_stroke, 20);
  EXPECT_THAT(chosen.findings, testing::Contains(testing::Field(
                                   &Finding::what, HasSubstr("are made of " + std::to_string(side) + " pixels"))));
  // Those are as good as asked for, and chosen again for the same strokes.
  options_.pixels = side;
  const DesignResult asked = design(spec_, board_, bench_, options_, {});
  EXPECT_EQ(asked.scratches.x0_mm, chosen.scratches.x0_mm);
  options_.pixels = 0;
  options_.from = chosen.scratches;
  options_.drop_error = 0;
  EXPECT_EQ(design(spec_, board_, bench_, options_, {}).views[0].shown.width, side);
}

TEST_F(DesignTest, GuidedStartAndRelocationEachLowerTheLoss) {
  options_.iterations = 20;
  const auto loss = [&](Start start, int relocate_every) {
    options_.start = start;
    options_.relocate_every = relocate_every;
    return design(spec_, board_, bench_, options_, {}).final_loss;
  };
  const double plain = loss(Start::random, 0), moved = loss(Start::random, 4), guided = loss(Start::guided, 0),
               both = loss(Start::guided, 4);
  EXPECT_LT(moved, 0.5 * plain);
  EXPECT_LT(guided, 0.5 * plain);
  EXPECT_LT(both, guided);
}

TEST_F(DesignTest, BalanceTakesFromTheBetterViewForTheWorse) {
  // Much harder than the disc: tiles of all grays.
  Image tiles(64, 64, 1);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) tiles.at(x, y) = 0.2F + 0.1F * static_cast<float>((x / 5 * 7 + y / 5 * 5) % 8);
  spec_.views[1].target.image = tiles;
  spec_.scratches = 1000;  // few, so that the views compete for them
  options_.rate = 0;
  const auto decibels = [&](double balance) {
    options_.balance = balance;
    const DesignResult result = design(spec_, board_, bench_, options_, {});
    const double first = result.views[0].psnr_db, second = result.views[1].psnr_db;
    return std::pair(std::min(first, second), std::max(first, second));
  };
  const auto [worse, better] = decibels(0);
  const auto [worse_balanced, better_balanced] = decibels(3);
  EXPECT_GT(worse_balanced, worse + 0.3);
  EXPECT_LT(better_balanced - worse_balanced, 0.7 * (better - worse));
}

TEST_F(DesignTest, SameSeedSameBitsForAnyNumberOfThreads) {
  options_.iterations = 4;
  const auto with_threads = [&](int threads) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return design(spec_, board_, bench_, options_, {});
  };
  const DesignResult one = with_threads(1), two = with_threads(2);
  EXPECT_EQ(one.scratches.x0_mm, two.scratches.x0_mm);
  EXPECT_EQ(one.scratches.y1_mm, two.scratches.y1_mm);
  EXPECT_EQ(one.final_loss, two.final_loss);
  options_.seed = 2;
  EXPECT_NE(with_threads(1).scratches.x0_mm, one.scratches.x0_mm);
}

TEST_F(DesignTest, ScratchesObeyTheLimits) {
  options_.iterations = 10;
  options_.rate = 5e-3;
  options_.min_length = 0.02;
  options_.max_length_mm = 2;
  options_.drop_error = 0;
  const DesignResult result = design(spec_, board_, bench_, options_, {});
  EXPECT_EQ(result.scratches.size(), 2500U) << dropped_text(result.dropped_by_rule);
  EXPECT_EQ(result.dropped, 0U);
  for (std::size_t i = 0; i < result.scratches.size(); ++i) {
    const Scratches& s = result.scratches;
    const double length = std::hypot(s.x1_mm[i] - s.x0_mm[i], s.y1_mm[i] - s.y0_mm[i]);
    EXPECT_GE(length, 0.02 * 60);
    EXPECT_LE(length, 2 + 1e-9);  // what check_limits() leaves to the rounding of the ends
    for (const double x : {s.x0_mm[i], s.y0_mm[i], s.x1_mm[i], s.y1_mm[i]}) {
      EXPECT_GE(x, 5);
      EXPECT_LE(x, 55);
    }
  }
}

TEST_F(DesignTest, RulesOfPairsCostLessThanDroppingWhatBreaksThem) {
  options_.iterations = 20;
  options_.rate = 0;
  options_.drop_error = 0;
  spec_.scratches = 1200;
  board_.tool_width_um = 100;
  const DesignResult free = design(spec_, board_, bench_, options_, {});
  options_.machine.distance_mm = 0.02;
  options_.machine.max_overlap = 0.3;
  const DesignResult ruled = design(spec_, board_, bench_, options_, {});
  CarvingLimits limits = carving_limits(board_, options_.machine, bench_.material.depth_um, bench_.machine_affine);
  limits.machine.shortest_mm = options_.min_length * 60;
  EXPECT_TRUE(check_limits(ruled.scratches, limits).good());
  // The other way: the free design, mended. A design of no iterations measures what that shows.
  const Mended mended = mend(free.scratches, limits);
  options_.from = mended.scratches;
  options_.iterations = 0;
  const DesignResult dropped = design(spec_, board_, bench_, options_, {});
  ASSERT_EQ(dropped.scratches.size(), mended.scratches.size());
  EXPECT_GT(ruled.scratches.size(), mended.scratches.size());
  for (std::size_t k = 0; k < 2; ++k) EXPECT_GT(ruled.views[k].psnr_db, dropped.views[k].psnr_db + 0.3);
}

TEST_F(DesignTest, DropsByCountByLightOrByError) {
  options_.iterations = 5;
  options_.drop_share = 0.4;
  EXPECT_EQ(design(spec_, board_, bench_, options_, {}).scratches.size(), 1500U);
  options_.drop_share = 0;
  options_.drop_light = 0.03;
  const DesignResult result = design(spec_, board_, bench_, options_, {});
  EXPECT_GT(result.dropped, 0U);
  EXPECT_LT(result.final_loss, 1.5 * result.loss_before_drop);
  options_.drop_light = 0;
  options_.drop_error = 0.01;
  const DesignResult by_error = design(spec_, board_, bench_, options_, {});
  EXPECT_GT(by_error.dropped, 0U);
  // A hundredth of the error is 0.04 dB.
  options_.drop_error = 0;
  const DesignResult all = design(spec_, board_, bench_, options_, {});
  EXPECT_EQ(all.dropped, 0U);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_GT(by_error.views[k].psnr_db, all.views[k].psnr_db - 0.15);
}

TEST_F(DesignTest, ToleranceKeepsThePicturesFurtherAside) {
  options_.iterations = 20;
  options_.report_tolerance = true;
  const DesignResult plain = design(spec_, board_, bench_, options_, {});
  ASSERT_EQ(plain.tolerance.size(), 2U);
  const double range = plain.tolerance[0].eye.sideways.least();
  EXPECT_NE(tolerance_text("left", plain.tolerance[0]).find(" mm sideways"), std::string::npos);
  // Where the report says that 3 dB are lost, they are: seen from there, by a design of no iterations.
  Bench moved = bench_;
  const Eigen::Vector3d eye = moved.views[0].T_camera_board.inverse().translation();
  const Eigen::Vector3d way = eye - Eigen::Vector3d(30, 30, 0);
  const Eigen::Vector3d sideways = Eigen::Vector3d::UnitZ().cross(way).normalized();
  const MoveRange& r = plain.tolerance[0].eye.sideways;
  const double side = r.plus_mm < r.minus_mm ? r.plus_mm : -r.minus_mm;
  moved.views[0] = view(moved.views[0].name, eye + side * sideways);
  DesignOptions look = options_;
  look.report_tolerance = false;
  look.from = plain.scratches;
  look.iterations = 0;
  look.drop_error = 0;
  const DesignResult aside = design(spec_, board_, moved, look, {});
  EXPECT_NEAR(plain.views[0].psnr_db - aside.views[0].psnr_db, kLostDb, 0.3);
  // The map agrees with itself and with the range: nothing lost in the middle, much at twice the range.
  const Image& map = plain.tolerance[0].lost_db;
  EXPECT_NEAR(map.at(map.width / 2, map.height / 2), 0, 1e-6);
  EXPECT_GT(std::max(map.at(0, map.height / 2), map.at(map.width - 1, map.height / 2)), kLostDb);

  options_.tolerance_mm = 2 * range;
  const DesignResult wide = design(spec_, board_, bench_, options_, {});
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_GT(wide.tolerance[k].eye.sideways.least(), 1.3 * plain.tolerance[k].eye.sideways.least());
  write_design_result(wide, spec_, board_, bench_, folder_ / "wide");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "wide" / "tolerance-left.png"));

  options_.tolerance_mm = -1;
  EXPECT_NE(error_of().find("tolerance_mm"), std::string::npos);
}

TEST_F(DesignTest, KeepsToTheHoursThereAreAndSaysWhatFewerWouldShow) {
  options_.iterations = 20;
  options_.carve_curve = true;
  const DesignResult all = design(spec_, board_, bench_, options_, {});
  ASSERT_EQ(all.curve.size(), 10U);
  EXPECT_EQ(all.curve[0].scratches, all.scratches.size());
  EXPECT_NEAR(all.curve[0].psnr_db[0], all.views[0].psnr_db, 0.02);
  EXPECT_NEAR(3600 * all.curve[0].hours,
              carving_time_s(all.scratches, bench_.material.depth_um, options_.carve_machine), 1);
  for (std::size_t k = 1; k < 10; ++k) {
    EXPECT_LT(all.curve[k].hours, all.curve[k - 1].hours);
    EXPECT_LT(all.curve[k].scratches, all.curve[k - 1].scratches);
  }
  EXPECT_LT(all.curve[9].psnr_db[0], all.curve[0].psnr_db[0]);

  options_.carve_hours = 0.5 * all.curve[0].hours;
  const DesignResult half = design(spec_, board_, bench_, options_, {});
  const double takes_s = carving_time_s(half.scratches, bench_.material.depth_um, options_.carve_machine);
  EXPECT_LE(takes_s, 3600 * options_.carve_hours);
  EXPECT_GT(takes_s, 0.9 * 3600 * options_.carve_hours);
  // Made for that time it shows more than the whole design with as much left out.
  const CarvingPoint& cut = all.curve[5];
  EXPECT_GT(half.views[0].psnr_db + half.views[1].psnr_db, cut.psnr_db[0] + cut.psnr_db[1]);
  write_design_result(half, spec_, board_, bench_, folder_ / "half");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "half" / "carving-curve.svg"));
}

TEST_F(DesignTest, GoesOnFromScratchesAndStopsWhenAsked) {
  const DesignResult first = design(spec_, board_, bench_, options_, {});
  options_.from = first.scratches;
  options_.relocate_every = 2;  // a search asks too: the third question is that of iteration 2's
  int calls = 0;
  options_.stop = [&] { return ++calls == 3; };
  const DesignResult second = design(spec_, board_, bench_, options_, {});
  EXPECT_TRUE(second.stopped_early);
  EXPECT_EQ(second.history.size(), 4U);
  EXPECT_LT(second.history.front().loss, 1.5 * first.final_loss);
}

// The pictures of these scratches on the test's bench, without designing anything.
std::vector<double> decibels_of(const Scratches& scratches, const DesignSpec& spec, const Board& board,
                                const Bench& bench, DesignOptions options) {
  options.from = scratches;
  options.iterations = 0;
  options.drop_error = 0;
  std::vector<double> db;
  for (const DesignedView& v : design(spec, board, bench, options, {}).views) db.push_back(v.psnr_db);
  return db;
}

double mean_of_views_db(const DesignResult& result, double DesignedView::*figure) {
  double sum = 0;
  for (const DesignedView& v : result.views) sum += v.*figure / static_cast<double>(result.views.size());
  return sum;
}

// Steps and searches swing, and while places are searched it is only guessed how grooves cut each other. What is
// written is the best that was looked at as it will be carved, and so is every figure on the way.
TEST_F(DesignTest, HoweverEarlyItEndsADesignIsAsGoodAsTheBestThatWasSeenOfIt) {
  double seen_db = 0;
  int looks = 0;
  options_.rate = 0;
  options_.watch = [&](const DesignFrame& frame) {
    if (!frame.psnr_db) return;
    seen_db = std::max(seen_db, *frame.psnr_db);
    ++looks;
  };
  const auto expect_the_best = [&](const DesignResult& result) {
    EXPECT_GT(looks, 0);
    const double mean_db = mean_of_views_db(result, &DesignedView::psnr_db);
    EXPECT_GE(mean_db, seen_db - 0.1);  // light that hardly shows is held for some iterations
    EXPECT_GE(mean_db, mean_of_views_db(result, &DesignedView::start_psnr_db) - 1e-3);
    seen_db = looks = 0;
  };
  for (const Crossings crossings : {Crossings::deepest, Crossings::add})
    for (const int scratches : {900, 4000})
      for (const int iterations : {1, 6, 12, 40}) {
        SCOPED_TRACE(testing::Message() << (crossings == Crossings::add ? "adding, " : "cutting, ") << scratches
                                        << " scratches, " << iterations << " iterations");
        bench_.crossings = crossings;
        spec_.scratches = scratches;
        options_.iterations = iterations;
        options_.seed = static_cast<std::uint64_t>(iterations);
        expect_the_best(design(spec_, board_, bench_, options_, {}));
      }
  // Ended by hand after some iterations, and by a time limit, wherever that is.
  bench_.crossings = Crossings::deepest;
  options_.iterations = 40;
  for (const int after : {1, 4, 7, 13}) {
    SCOPED_TRACE(after);
    int iteration = 0;
    const auto watch = options_.watch;
    options_.watch = [&](const DesignFrame& frame) {
      watch(frame);
      iteration = frame.iteration;
    };
    options_.stop = [&] { return iteration >= after; };
    const DesignResult result = design(spec_, board_, bench_, options_, {});
    EXPECT_TRUE(result.stopped_early);
    expect_the_best(result);
    options_.watch = watch;
  }
  options_.stop = {};
  options_.iterations = 1000000;
  options_.time_limit_s = 2;
  const DesignResult in_time = design(spec_, board_, bench_, options_, {});
  EXPECT_TRUE(in_time.stopped_early);
  expect_the_best(in_time);
}

// The clock counts only if the iterations do not keep up with it: otherwise the same input gives the same bits.
TEST_F(DesignTest, ATimeLimitThatIsFarOffChangesNothing) {
  options_.iterations = 12;
  for (const Crossings crossings : {Crossings::add, Crossings::deepest}) {
    bench_.crossings = crossings;
    options_.time_limit_s = 0;
    const Scratches without = design(spec_, board_, bench_, options_, {}).scratches;
    options_.time_limit_s = 3600;
    const Scratches within = design(spec_, board_, bench_, options_, {}).scratches;
    EXPECT_EQ(within.x0_mm, without.x0_mm);
    EXPECT_EQ(within.y1_mm, without.y1_mm);
  }
}

// Losses of guessed crossings are told from those of grooves as they are cut, and the first is one of these.
TEST_F(DesignTest, LossesSayWhetherGroovesWereLookedAtAsTheyWillBeCut) {
  options_.iterations = 12;
  options_.rate = 0;
  bench_.crossings = Crossings::deepest;
  const DesignResult result = design(spec_, board_, bench_, options_, {});
  const auto& history = result.history;
  ASSERT_EQ(history.size(), 13U);
  EXPECT_TRUE(history[0].as_carved);
  EXPECT_TRUE(history[5].as_carved);
  EXPECT_FALSE(history[4].as_carved);
  for (std::size_t i = 9; i < history.size(); ++i) EXPECT_TRUE(history[i].as_carved) << i;
  EXPECT_LT(result.final_loss, history[0].loss);
  // A design of no iterations looks at its start as it is cut: the same.
  options_.iterations = 0;
  options_.drop_error = 0;
  EXPECT_NEAR(design(spec_, board_, bench_, options_, {}).history[0].loss, history[0].loss, 1e-3 * history[0].loss);
}

// How good a design is counts in the pixels that eyes tell apart, whatever the design looked at.
TEST_F(DesignTest, DesignsOfAnyPixelsAreComparedInThoseThatEyesTellApart) {
  options_.iterations = 3;
  const DesignResult coarse = design(spec_, board_, bench_, options_, {});
  // Eyes 651 mm away: 50 mm are 176 times 1.5 minutes of arc.
  EXPECT_NEAR(coarse.eye_from_m, 0.651, 0.001);
  EXPECT_EQ(coarse.eye_px, 176);
  options_.pixels = coarse.eye_px;
  const std::vector<double> shows = decibels_of(coarse.scratches, spec_, board_, bench_, options_);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(coarse.views[k].eye_psnr_db, shows[k], 0.01) << "view " << k;
    EXPECT_GT(coarse.views[k].psnr_db, coarse.views[k].eye_psnr_db + 0.5) << "coarser pixels forgive more";
  }
  const DesignResult fine = design(spec_, board_, bench_, options_, {});
  // A design fits its own pixels, so other ones of nearly the same size judge it.
  EXPECT_EQ(fine.eye_px, coarse.eye_px + 1);
  options_.pixels = fine.eye_px;
  const std::vector<double> unfitted = decibels_of(fine.scratches, spec_, board_, bench_, options_);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(fine.views[k].eye_psnr_db, unfitted[k], 0.01) << "view " << k;
    EXPECT_LT(fine.views[k].eye_psnr_db, fine.views[k].psnr_db) << "view " << k;
  }
  // From so far away that no picture would be left there are sixteen.
  EXPECT_EQ(pixels_of_eyes({50, 40}, 1e5), 16);
  EXPECT_EQ(pixels_of_eyes({500, 400}, 300), kUsualPixels);
}

TEST_F(DesignTest, AWishToStopIsHeardWithinTheStartAndWithinASweep) {
  std::string stage;
  std::atomic<int> asked{0}, asked_after{0};
  const Progress progress = [&](std::string_view now, double) { stage = now; };
  // Heard at the fifth question of a stage, and never asked again: views are worked on in parallel, so a question may
  // be under way in each.
  const auto stopped_in = [&](const std::string& wanted) {
    asked = asked_after = 0;
    options_.stop = [&, wanted] {
      if (stage != wanted) return false;
      if (++asked > 5) ++asked_after;
      return asked >= 5;
    };
    const DesignResult result = design(spec_, board_, bench_, options_, progress);
    EXPECT_TRUE(result.stopped_early) << wanted;
    EXPECT_LE(asked_after, 2) << wanted;
    EXPECT_EQ(result.scratches.size() + result.dropped, result.started_with) << wanted;
    return result;
  };
  options_.relocate_every = 1;
  options_.start_sweeps = 1;
  const DesignResult placing = stopped_in("placing scratches");
  EXPECT_EQ(placing.history.size(), 2U);
  EXPECT_THAT(placing.findings,
              testing::Contains(testing::Field(&Finding::what, HasSubstr("the start was ended early"))));
  const DesignResult searching = stopped_in("searching places");
  EXPECT_EQ(searching.history.size(), 2U);
  EXPECT_EQ(searching.relocated, 0U);
  // The first iteration has no sweep and asks once; the fourth question is one within the second's sweep.
  const DesignResult iterating = stopped_in("designing");
  EXPECT_EQ(iterating.history.size(), 3U);
  EXPECT_GT(iterating.relocated, 0U);
  EXPECT_LT(iterating.relocated, 200U);  // of 2500
}

// Whichever stage a wish to stop comes in: none begins after it that the scratches do not need, and what there is is
// whole.
TEST_F(DesignTest, AfterAWishToStopNoOtherStageBeginsThatCanWait) {
  bench_.crossings = Crossings::last;  // the order of carving matters
  options_.iterations = 8;
  const double whole_s = carving_time_s(design(spec_, board_, bench_, options_, {}).scratches, bench_.material.depth_um,
                                        options_.carve_machine);
  options_.report_tolerance = true;
  options_.carve_hours = 0.5 * whole_s / 3600;
  const std::set<std::string> can_wait{"searching places",    "dropping weak scratches",
                                       "ordering scratches",  "keeping to the carving time",
                                       "measuring tolerance", "measuring the curve over carving time"};
  std::vector<std::string> stages, after;
  std::string wanted;
  bool wished = false;
  options_.stop = [&] { return wished; };
  const Progress progress = [&](std::string_view stage, double) {
    if (stages.empty() || stages.back() != stage) stages.emplace_back(stage);
    if (wished) after.emplace_back(stage);
    wished = wished || stage == wanted;
  };
  const DesignResult whole = design(spec_, board_, bench_, options_, progress);
  const std::set<std::string> all(stages.begin(), stages.end());
  for (const std::string& stage : can_wait) EXPECT_TRUE(all.contains(stage)) << stage << " is no stage of this design";
  for (const std::string& stage : all) {
    wanted = stage;
    wished = false;
    after.clear();
    const DesignResult result = design(spec_, board_, bench_, options_, progress);
    EXPECT_TRUE(result.stopped_early) << stage;
    EXPECT_GT(result.scratches.size(), 0U) << stage;
    EXPECT_EQ(result.views.size(), 2U) << stage;
    for (const std::string& later : after)
      EXPECT_TRUE(!can_wait.contains(later) || later == stage) << later << " after a wish in " << stage;
    EXPECT_LE(std::count(after.begin(), after.end(), std::string("measuring tolerance")), 1) << stage;
  }
  EXPECT_FALSE(whole.stopped_early);
}

TEST_F(DesignTest, FreeDepthIsReportedAndWritten) {
  options_.iterations = 5;
  options_.optimize_depth = true;
  const DesignResult result = design(spec_, board_, bench_, options_, {});
  ASSERT_TRUE(result.depth_um.has_value());
  EXPECT_NE(*result.depth_um, 14);
  EXPECT_EQ(result.scratches.depth_um.size(), result.scratches.size());
  EXPECT_EQ(result.scratches.depth_um.front(), *result.depth_um);
}

TEST_F(DesignTest, IsMadeForTheFieldsAndCrossingsThatTheBenchHas) {
  bench_.material.depth_um = 9;  // grooves reach little farther than the half vectors lean
  options_.iterations = 20;
  options_.rate = 0;
  Bench measured = bench_;
  measured.depth_field.terms = {0.5, 0, 0, 0, 0, 0};
  measured.alpha_field.terms = {0, -0.3, 0, 0, 0, 0};
  measured.crossings = Crossings::last;
  const DesignResult ignored = design(spec_, board_, bench_, options_, {});
  const DesignResult known = design(spec_, board_, measured, options_, {});
  const std::vector<double> lost = decibels_of(ignored.scratches, spec_, board_, measured, options_);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_GT(known.views[k].psnr_db, lost[k] + 0.5) << "view " << k;
  // What it promised is what these scratches show there.
  const std::vector<double> again = decibels_of(known.scratches, spec_, board_, measured, options_);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(known.views[k].psnr_db, again[k], 0.02) << "view " << k;
}

TEST_F(DesignTest, WhereGroovesCutEachOtherABoardHoldsFewerAndShowsMoreSo) {
  spec_.scratches = 8000;
  options_.iterations = 10;
  options_.rate = 0;
  Bench measured = bench_;
  measured.crossings = Crossings::deepest;
  const DesignResult crowd = design(spec_, board_, bench_, options_, {});
  EXPECT_EQ(crowd.started_with, 8000U);
  const DesignResult fewer = design(spec_, board_, measured, options_, {});
  EXPECT_LT(fewer.started_with, 5000U);
  EXPECT_THAT(fewer.findings, testing::Contains(testing::Field(&Finding::what, HasSubstr("cut each other's rims"))));
  const std::vector<double> lost = decibels_of(crowd.scratches, spec_, board_, measured, options_);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_GT(fewer.views[k].psnr_db, lost[k] + 1) << "view " << k;
  // As many as it holds are as many as were asked for.
  spec_.scratches = 1000;
  EXPECT_EQ(design(spec_, board_, measured, options_, {}).started_with, 1000U);
}

TEST_F(DesignTest, WhereGroovesCutEachOtherStrokesThatAreFewForTheirPixelsMayCrowd) {
  options_.pixels = 128;
  options_.iterations = 20;
  options_.rate = 0;
  bench_.crossings = Crossings::deepest;
  spec_.scratches = 3000;  // they would cover the carve area once
  const DesignResult all = design(spec_, board_, bench_, options_, {});
  EXPECT_EQ(all.started_with, 3000U);
  spec_.scratches = 1500;
  const DesignResult half = design(spec_, board_, bench_, options_, {});
  for (std::size_t k = 0; k < 2; ++k) EXPECT_GT(all.views[k].psnr_db, half.views[k].psnr_db + 1) << "view " << k;
}

TEST_F(DesignTest, WhereGroovesCutEachOtherShorterStrokesInLargerPixelsShowMore) {
  options_.pixels = 0;
  options_.iterations = 0;
  spec_.scratches = 10000;
  bench_.crossings = Crossings::deepest;
  bench_.views = {view("left", {-280, -110, 600}), view("right", {340, -110, 600})};
  const DesignResult chosen = design(spec_, board_, bench_, options_, {});
  options_.pixels = kUsualPixels;
  const DesignResult fine = design(spec_, board_, bench_, options_, {});
  EXPECT_LT(chosen.views[0].shown.width, kUsualPixels);
  // Each as eyes see it that do not tell the finer pixels apart.
  options_.pixels = kUsualPixels / 4;
  options_.drop_error = 0;
  const std::vector<double> shows = decibels_of(chosen.scratches, spec_, board_, bench_, options_),
                            fine_shows = decibels_of(fine.scratches, spec_, board_, bench_, options_);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_GT(shows[k], fine_shows[k] + 1) << "view " << k;
}

TEST_F(DesignTest, WhereTheOrderOfCarvingShowsItIsDesignedForAShortOne) {
  options_.iterations = 20;
  options_.rate = 0;
  const auto air = [&](const Scratches& s, const std::vector<CarvingStep>& order) { return travel_mm(s, order); };
  const DesignResult any = design(spec_, board_, bench_, options_, {});
  EXPECT_GT(air(any.scratches, file_order(any.scratches)), 3 * air(any.scratches, carving_order(any.scratches)));
  bench_.depth_field.terms[5] = 0.2;
  const DesignResult worn = design(spec_, board_, bench_, options_, {});
  // Short when it was settled, half way; since then scratches have moved and weak ones have gone.
  EXPECT_LT(air(worn.scratches, file_order(worn.scratches)), 2 * air(worn.scratches, carving_order(worn.scratches)));
  const std::vector<double> again = decibels_of(worn.scratches, spec_, board_, bench_, options_);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(worn.views[k].psnr_db, again[k], 0.02) << "view " << k;
}

TEST_F(DesignTest, WritesAllItsFiles) {
  options_.iterations = 3;
  const DesignResult result = design(spec_, board_, bench_, options_, {});
  write_design_result(result, spec_, board_, bench_, folder_ / "out");
  for (const char* name : {"scratches.csv", "preview-left.png", "preview-right-start.png", "target-left.png",
                           "achievable-right.png", "contact-sheet.png"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / name)) << name;
  EXPECT_EQ(read_scratches(folder_ / "out" / "scratches.csv").size(), result.scratches.size());
  const Json report = read_json(folder_ / "out" / "design-report.json", "burin/design-report", 1);
  EXPECT_EQ(report["history"].size(), 4U);
  EXPECT_EQ(report["views"][1]["view"], "right");
  EXPECT_EQ(read_picture(folder_ / "out" / "preview-left.png").width, 64);
}

TEST_F(DesignTest, ProgressMayStopTheWork) {
  struct Stop {};
  EXPECT_THROW(design(spec_, board_, bench_, options_,
                      [](std::string_view, double fraction) {
                        if (fraction > 0.3) throw Stop();
                      }),
               Stop);
}

TEST_F(DesignTest, ViewOrLampThatTheBenchLacks) {
  spec_.views[1].view = "top";
  EXPECT_THAT(error_of(), AllOf(HasSubstr("top"), HasSubstr("left")));
  spec_.views[1].view = "right";
  spec_.views[1].light = "sun";
  EXPECT_THAT(error_of(), AllOf(HasSubstr("sun"), HasSubstr("lamp")));
}

TEST_F(DesignTest, MissingOrBrokenTarget) {
  spec_.views[0].target.image = {};
  spec_.views[0].target.picture = folder_ / "nothing.png";
  EXPECT_THAT(error_of(), HasSubstr("nothing.png"));
  write_text("not a picture", folder_ / "broken.png");
  spec_.views[0].target.picture = folder_ / "broken.png";
  EXPECT_THAT(error_of(), HasSubstr("broken.png"));
}

TEST_F(DesignTest, BenchOnWhichNoGrooveGlints) {
  bench_.material.depth_um = 0.2;
  EXPECT_THAT(error_of(),
              AllOf(HasSubstr("no groove can glint"), HasSubstr("degrees too little"), HasSubstr("um deep")));
}

TEST_F(DesignTest, OptionsOutOfRange) {
  options_.loss = {0, 0, 0};
  EXPECT_THAT(error_of(), HasSubstr("loss"));
  options_.loss = {};
  options_.pixels = 2;
  EXPECT_THAT(error_of(), HasSubstr("pixels"));
}

}  // namespace
}  // namespace burin
