// Proves: the time of a job is the sum of its moves by the laws of motion, in whatever order it is carved, and the
// budget's quick estimate stands near the time of the path that is written.
#include "burin/optimize/toolpath/carving_time.h"

#include <gtest/gtest.h>

#include <random>

#include "burin/optimize/toolpath.h"

namespace burin {
namespace {

Scratches two() { return {{10, 40}, {0, 0}, {20, 30}, {0, 0}, {}, {}, {}}; }

TEST(CarvingTime, IsTheSumOfTheMoves) {
  MachineProfile m = machine_profile("grbl");
  m.dwell_s = 0.25;
  const CarvingTime time = carving_time(two(), {{0, false}, {1, true}}, 10, m);
  const auto along = [&](double mm, double feed) { return move_time_s(mm, feed, m.acceleration_mm_s2); };
  EXPECT_NEAR(time.metal_s, 2 * along(10, m.carve_feed_mm_min), 1e-12);
  EXPECT_NEAR(time.air_s, 2 * along(10, m.rapid_mm_min), 1e-12);  // to (10, 0), and from (20, 0) to (30, 0)
  const double z = m.safe_z_mm + 0.01;
  EXPECT_NEAR(time.down_s,
              2 * (0.25 + move_time_s(z, m.plunge_feed_mm_min, m.acceleration_z_mm_s2) +
                   move_time_s(z, m.rapid_z_mm_min, m.acceleration_z_mm_s2)),
              1e-12);
  EXPECT_NEAR(time.total_s(), time.metal_s + time.air_s + time.down_s, 1e-12);
  // The other way round the second time: ten millimeters more of air.
  EXPECT_NEAR(carving_time(two(), {{0, false}, {1, false}}, 10, m).air_s,
              along(10, m.rapid_mm_min) + along(20, m.rapid_mm_min), 1e-12);
}

TEST(CarvingTime, DepthsOfTheirOwnCount) {
  const MachineProfile m = machine_profile("grbl");
  Scratches deep = two();
  deep.depth_um = {1000, 2000};
  EXPECT_GT(carving_time(deep, file_order(deep), 10, m).down_s, carving_time(two(), file_order(two()), 10, m).down_s);
}

TEST(CarvingTime, BudgetStandsNearThePathThatIsWritten) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(5, 195), reach(-4, 4);
  Scratches s;
  for (int i = 0; i < 4000; ++i) {
    const double x = place(random), y = place(random);
    s.x0_mm.push_back(x), s.y0_mm.push_back(y);
    s.x1_mm.push_back(x + reach(random)), s.y1_mm.push_back(y + reach(random));
  }
  Board board;
  board.size_mm = board.carve_max_mm = {200, 200};
  const MachineProfile m = machine_profile("grbl");
  const double written = plan_toolpath(s, board, nullptr, m).duration_s;
  const double budget = carving_time_s(s, board.material.depth_um, m);
  EXPECT_GT(budget, 0.99 * written);
  EXPECT_LT(budget, 1.03 * written);
}

}  // namespace
}  // namespace burin
