// Proves: what is told for a place comes to lie there, whichever way and however uneven the screws; carve() brings
// compensated grooves' ends where they are wanted, and bends grooves between them as the screws do.
#include "burin/scene/machine_errors.h"

#include <gtest/gtest.h>

#include "burin/scene/carve.h"

namespace burin {
namespace {

MachineErrors worn() {
  MachineErrors e;
  e.backlash_mm = {0.05, 0.09};
  e.screw_sin_mm = {0.010, -0.017};
  e.screw_cos_mm = {0.006, -0.006};
  e.screw_period_mm = {5, 8};
  return e;
}

TEST(MachineErrors, WhatIsToldForAPlaceComesToLieThere) {
  for (const Eigen::Vector2d& way : {Eigen::Vector2d(1, 0.2), Eigen::Vector2d(-3, 4), Eigen::Vector2d(-1, -1)})
    for (double x = 0; x < 12; x += 0.7) {
      const Eigen::Vector2d wanted(x, 20 - 1.3 * x);
      EXPECT_LT((displaced(worn(), told_for(worn(), wanted, way), way) - wanted).norm(), 1e-12);
    }
}

TEST(MachineErrors, ToAndFroLieBacklashApart) {
  const Eigen::Vector2d p(30, 40), way(1, -2);
  EXPECT_LT((displaced(worn(), p, -way) - displaced(worn(), p, way) - Eigen::Vector2d(0.05, -0.09)).norm(), 1e-12);
}

TEST(MachineErrors, CompensatedGroovesLieWhereTheyAreWanted) {
  Board board;
  board.size_mm = {100, 50};
  Bench bench;
  bench.machine_affine << 1.004, 0.002, 0.15, -0.001, 0.997, -0.2;
  bench.machine_errors = worn();
  Scratches s;
  s.x0_mm = {20, 70};
  s.y0_mm = {10, 40};
  s.x1_mm = {27, 64};
  s.y1_mm = {13, 38};
  const Carved carved = carve(compensated(Designed(s), bench, board), bench, board);
  ASSERT_GT(carved.size(), 4U);  // bent: in pieces
  double most_off = 0;
  for (std::size_t k = 0; k < carved.size(); ++k) {
    const std::size_t i = carved.source[k];
    const Eigen::Vector2d p0(s.x0_mm[i], s.y0_mm[i]), p1(s.x1_mm[i], s.y1_mm[i]);
    const Eigen::Vector2d from(carved.scratches.x0_mm[k], carved.scratches.y0_mm[k]),
        to(carved.scratches.x1_mm[k], carved.scratches.y1_mm[k]);
    if (carved.begin[k].at == 0) {
      EXPECT_LT((from - p0).norm(), 1e-9);
    }
    if (carved.end[k].at == 1) {
      EXPECT_LT((to - p1).norm(), 1e-9);
    }
    most_off = std::max(most_off, (to - p0 - carved.end[k].at * (p1 - p0)).norm());
    if (k > 0 && carved.source[k - 1] == carved.source[k]) {
      EXPECT_LT((from - Eigen::Vector2d(carved.scratches.x1_mm[k - 1], carved.scratches.y1_mm[k - 1])).norm(), 1e-12);
    }
  }
  EXPECT_GT(most_off, 0.005);  // the screws bend them by some hundredths of a millimeter
  EXPECT_LT(most_off, 0.06);
}

TEST(MachineErrors, AMachineWithoutErrorsCarvesWholeGrooves) {
  EXPECT_TRUE(MachineErrors().none());
  EXPECT_EQ(pieces_for(MachineErrors(), {0, 0}, {100, 0}), 1);
  EXPECT_EQ(pieces_for(worn(), {0, 0}, {5, 0}), 8);
}

}  // namespace
}  // namespace burin
