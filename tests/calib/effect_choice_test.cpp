// What is proved: no cross-section is credited with what the paper's lacks to its own end. Not proved here: that those
// which are there are found (refine_burrs_test, scripts/random-benches --departures).
#include "burin/calib/photo/effect_choice.h"

#include <gtest/gtest.h>

#include "tests/calib/fitted_grooves.h"

namespace burin {
namespace {

// The paper's grooves, and a fit of them that was stopped on its way.
TEST(CrossSectionChoice, PapersIsComparedAtItsOwnEnd) {
  FittedGrooves f;
  fit_small_grooves(0, 1, f);
  State on_its_way = f.state;
  on_its_way.shared[unknown::log_alpha] += 0.1;
  on_its_way.shared[unknown::log_depth] -= 0.1;
  const ProfileChoice choice = choose_profile(f.s.data, f.stage, on_its_way, false, [](const char*, double) {});
  EXPECT_TRUE(choice.profile.is_paper());
  EXPECT_TRUE(choice.free.empty());
}

}  // namespace
}  // namespace burin
