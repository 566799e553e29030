// Proves: a tool path for a machine with backlash and uneven screws brings both ends of every scratch where they are
// wanted, whichever way it is carved in the order that the path chose.
#include <gtest/gtest.h>

#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/toolpath_plan.h"
#include "burin/scene/carve.h"
#include "tests/optimize/carving_bench.h"

namespace burin {
namespace {

TEST(Backlash, IsUndoneWhicheverWayAScratchIsCarved) {
  Bench bench;
  bench.machine_affine << 1.004, 0.003, -0.4, -0.002, 0.997, 0.6;
  bench.machine_errors.backlash_mm = {0.06, 0.1};
  bench.machine_errors.screw_sin_mm = {0.02, 0};
  bench.machine_errors.screw_period_mm = {5, 5};
  const Scratches wanted = random_scratches(100, 11, {15, 15}, {185, 85}, 4);
  const Toolpath path = plan_toolpath(wanted, board_200x100(), &bench, machine_profile("grbl"), {});
  EXPECT_TRUE(path.compensated);
  int reversed = 0;
  ASSERT_EQ(path.order.size(), wanted.size());
  for (std::size_t k = 0; k < path.order.size(); ++k) {
    const std::size_t i = path.order[k].scratch;
    Eigen::Vector2d first(wanted.x0_mm[i], wanted.y0_mm[i]), last(wanted.x1_mm[i], wanted.y1_mm[i]);
    if (path.order[k].reversed) {
      std::swap(first, last);
      ++reversed;
    }
    const Eigen::Vector2d from = path.scratches[k].from_mm, to = path.scratches[k].to_mm, way = to - from;
    const auto carved = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
      return bench.machine_affine * displaced(bench.machine_errors, p, way).homogeneous();
    };
    EXPECT_LT((carved(from) - first).norm(), 1e-9);
    EXPECT_LT((carved(to) - last).norm(), 1e-9);
  }
  EXPECT_GT(reversed, 10);
}

}  // namespace
}  // namespace burin
