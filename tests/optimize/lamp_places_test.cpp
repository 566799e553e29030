// Proves: the angles that are said of lamps are those of their half vectors, places that are proposed share less than
// those there are, keep their distance and stay within the grooves' walls, and what cannot be helped is said so.
#include "burin/optimize/design/lamp_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "burin/optimize/design/collisions.h"

namespace burin {
namespace {

using testing::HasSubstr;

constexpr double kOneDegree = std::numbers::pi / 180;
const Eigen::Vector3d kEye{60, -100, 600};
const LampQuestion kQuestion{{10, 10}, {110, 110}, 0.05, 0.6};

// The lamp whose half vector with the eye leans so far towards there, at the middle of the area.
Eigen::Vector3d lamp_for(double lean_deg, double azimuth_deg) {
  const Eigen::Vector3d middle(60, 60, 0), eye = (kEye - middle).normalized();
  const double t = lean_deg * kOneDegree, a = azimuth_deg * kOneDegree;
  const Eigen::Vector3d h(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
  return middle + 600 * (2 * h.dot(eye) * h - eye);
}

std::vector<ServedGlint> three(double apart_deg) {
  std::vector<ServedGlint> out;
  for (const int k : {0, 1, 2}) {
    const std::string id = std::array<const char*, 3>{"red", "green", "blue"}[static_cast<std::size_t>(k)];
    out.push_back({{"front under " + id, kEye, lamp_for(24, 90 + (k - 1) * apart_deg)}, id, true});
  }
  return out;
}

TEST(LampPlaces, AnglesAreThoseOfTheHalfVectors) {
  const LampAngles at60 = angles_of(three(60), {60, 60}, 0.05), at10 = angles_of(three(10), {60, 60}, 0.05);
  EXPECT_NEAR(at60.least_apart, 60 * kOneDegree, 1e-9);
  EXPECT_NEAR(at10.least_apart, 10 * kOneDegree, 1e-9);
  EXPECT_NEAR(at10.worst_ghost, lobe(24 * kOneDegree, 10 * kOneDegree, 0.05), 1e-9);
  // 120 degrees apart are 60, since a scratch has no sign.
  EXPECT_NEAR(angles_of(three(120), {60, 60}, 0.05).least_apart, 60 * kOneDegree, 1e-9);
}

TEST(LampPlaces, ProposesPlacesThatShareLess) {
  for (const double apart : {3.0, 10.0}) {
    std::vector<ServedGlint> served = three(apart);
    const double before = angles_of(served, {60, 60}, 0.05).worst_ghost;
    ASSERT_GT(before, kGhost);
    const std::vector<LampPlace> places = better_lamps(served, kQuestion);
    ASSERT_EQ(places.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(places[k].light, served[k].light);
      const Eigen::Vector3d way = places[k].position_mm - Eigen::Vector3d(60, 60, 0);
      EXPECT_NEAR(way.norm(), 600, 1);  // whole mm
      EXPECT_GT(way.z(), 600 * std::sin(14 * kOneDegree));
      served[k].glint.light_mm = places[k].position_mm;
      EXPECT_LT(lean_at(served[k].glint, {110, 110, 0}).angle, kQuestion.steepest);
    }
    EXPECT_LT(angles_of(served, {60, 60}, 0.05).worst_ghost, 0.02);
    const std::vector<Finding> said = check_lamps(three(apart), kQuestion);
    ASSERT_EQ(said.size(), 1U);
    EXPECT_EQ(said[0].severity, Finding::Severity::warning);
    EXPECT_THAT(said[0].remedy, HasSubstr("green at ["));
  }
}

TEST(LampPlaces, GoodOnesAreANoteAndWhatMayNotMoveStays) {
  const std::vector<Finding> said = check_lamps(three(60), kQuestion);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].severity, Finding::Severity::note);
  EXPECT_THAT(said[0].what, HasSubstr("at least 60.0 degrees apart (at best 60.0)"));
  std::vector<ServedGlint> gray = three(10);
  for (ServedGlint& one : gray) one.may_move = false;
  EXPECT_TRUE(check_lamps(gray, kQuestion).empty());
  EXPECT_TRUE(better_lamps(gray, kQuestion).empty());
  // Walls that no half vector stays within.
  LampQuestion shallow = kQuestion;
  shallow.steepest = 0.02;
  EXPECT_TRUE(better_lamps(three(10), shallow).empty());
  EXPECT_THAT(check_lamps(three(10), shallow)[0].remedy, HasSubstr("fewer views or lamps"));
}

// The red lamp lights a view in gray as well, seen from elsewhere.
std::vector<ServedGlint> beside_one_in_gray(double apart_deg, bool may_move) {
  std::vector<ServedGlint> out = three(apart_deg);
  out.push_back({{"side", {260, -200, 560}, out[0].glint.light_mm}, "red", may_move});
  return out;
}

TEST(LampPlaces, ALampMovesForAllThatItServesOrStays) {
  std::vector<ServedGlint> served = beside_one_in_gray(10, true);
  ASSERT_GT(angles_of(served, {60, 60}, 0.05).worst_ghost, kGhost);
  const std::vector<LampPlace> places = better_lamps(served, kQuestion);
  ASSERT_EQ(places.size(), 3U);
  for (ServedGlint& one : served)
    for (const LampPlace& place : places)
      if (place.light == one.light) one.glint.light_mm = place.position_mm;
  EXPECT_LT(angles_of(served, {60, 60}, 0.05).worst_ghost, 0.05);  // the view in gray counts
  const std::vector<ServedGlint> fixed = beside_one_in_gray(10, false);
  const std::vector<LampPlace> others = better_lamps(fixed, kQuestion);
  ASSERT_EQ(others.size(), 2U);
  EXPECT_EQ(others[0].light, "green");
  EXPECT_EQ(others[1].light, "blue");
}

TEST(LampPlaces, WhatTwoThatStayShareIsNoneOfTheLampsBusiness) {
  std::vector<ServedGlint> served = three(10);
  for (const char* name : {"left", "right"})  // nearly one half vector
    served.push_back({{name, kEye, lamp_for(24, 200 + (name[0] == 'l' ? 0 : 2))}, name, false});
  const LampAngles angles = angles_of(served, {60, 60}, 0.05);
  EXPECT_LT(std::min(angles.a, angles.b), 3U);
  EXPECT_NEAR(angles.worst_ghost, lobe(24 * kOneDegree, 10 * kOneDegree, 0.05), 1e-6);
  const std::vector<Finding> said = check_lamps(served, kQuestion);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said[0].remedy, HasSubstr("that would be at most"));
}

}  // namespace
}  // namespace burin
