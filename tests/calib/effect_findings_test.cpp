// Proves: what refine says of a bench that departs from the paper's model carries the sigmas that bench.json holds, and
// none where board.json told it.
#include "burin/calib/verdict/effect_findings.h"

#include <gtest/gtest.h>

#include <string>

namespace burin {
namespace {

std::string told(const Bench& bench, bool by_board = false) {
  std::string all;
  Board board;
  board.size_mm = {100, 100};
  board.tool_width_um = 400;
  board.said.profile = by_board;
  for (const Finding& f : effect_findings(bench, board)) all += sentence(f) + "\n";
  return all;
}

TEST(EffectFindings, SayHowSureTheyAre) {
  Bench bench;
  GrooveProfile& p = bench.material.profile;
  p.kind = GrooveProfile::Kind::rounded_v;
  p.flank_deg = 22.4;
  bench.material.depth_um = 15;
  p.burr_left_um = 0.99;
  p.burr_right_um = 0.54;
  p.across = 1.2;
  bench.material_sigma.flank_deg = 0.7;
  bench.material_sigma.burr_left_um = 0.3;
  bench.material_sigma.burr_right_um = 0.16;
  bench.material_sigma.across = 0.05;
  bench.machine_errors.backlash_mm = {0.041, 0.06};
  bench.machine_errors.backlash_sigma_mm = Eigen::Vector2d(0.002, 0.003);
  bench.material.base_alpha = 0.155;
  bench.material.grain = FaceGrain::of(30, 0.12, 0.2);
  bench.material_sigma.base_alpha = 0.00155;
  bench.material_sigma.grain = Eigen::Vector2d(0, 0);
  const std::string said = told(bench);
  for (const char* part : {"flanks of 22.4 +- 0.7 degrees", "burrs of 0.99 +- 0.3 (left) and 0.54 +- 0.16 um (right)",
                           "1.20 +- 0.05 times as rough across", "backlash of 0.041 +- 0.002 and 0.060 +- 0.003 mm",
                           "roughness 0.12 +- 0.0012 along 30.0 degrees", "0.2 +- 0.002 across"})
    EXPECT_NE(said.find(part), std::string::npos) << part << " in:\n" << said;
}

// A tip of 100 um is as steep as 22.4 degrees 7.5 um up.
TEST(EffectFindings, GroovesThatEndBeforeTheirFlanksAreArcs) {
  Bench bench;
  bench.material.depth_um = 7;
  bench.material.profile.kind = GrooveProfile::Kind::rounded_v;
  bench.material.profile.flank_deg = 22.4;
  EXPECT_NE(told(bench).find("an arc of a circle"), std::string::npos) << told(bench);
  EXPECT_EQ(told(bench).find("22.4"), std::string::npos) << told(bench);
  bench.material.depth_um = 8;
  EXPECT_EQ(told(bench).find("an arc of a circle"), std::string::npos) << told(bench);
}

// Where the unnamed light stands, as seen from the board's middle, and how bright it is beside the lamp.
TEST(EffectFindings, AStrayLightIsSaidByItsPlace) {
  Bench bench;
  Light& lamp = bench.lights.emplace_back();
  lamp.position_mm = {50, 50, 500};
  lamp.intensity.setConstant(1000);
  bench.stray = lamp;
  bench.stray->position_mm = {50, 550, 500};  // as far up as out of the face: 45 degrees, twice the distance squared
  bench.stray->intensity.setConstant(200);
  const std::string said = told(bench);
  for (const char* part : {"45 degrees from straight above", "towards 90 degrees", "with 7.1 % of the lamp's light"})
    EXPECT_NE(said.find(part), std::string::npos) << part << " in:\n" << said;
}

TEST(EffectFindings, ToldNumbersHaveNoSigma) {
  Bench bench;
  bench.material.profile.burr_left_um = 1.5;
  const std::string said = told(bench, true);
  EXPECT_NE(said.find("burrs of 1.50 (left) and 0.00 um (right), as in board.json"), std::string::npos) << said;
  EXPECT_EQ(said.find("+-"), std::string::npos) << said;
}

}  // namespace
}  // namespace burin
