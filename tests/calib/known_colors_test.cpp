// Proves: lamps whose photos are in gray keep the color that the bench knew, with the brightness that was measured;
// what photos in color told stays, and so do lamps of no known color. The same at the end of a refinement of a
// photographed bench whose photos have lost their color.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "burin/calib/refine.h"
#include "burin/calib/verdict/refine_result.h"
#include "burin/capture/photo.h"
#include "tests/calib/rig_bench.h"

namespace burin {
namespace {

Light light_of(const std::string& id, const Eigen::Vector3d& intensity) {
  Light light;
  light.id = id;
  light.intensity = intensity;
  return light;
}

TEST(KnownColors, StayWherePhotosAreInGray) {
  const std::vector<Light> given{light_of("red", {1, 0.2, 0}), light_of("green", {0, 1, 0.5}),
                                 light_of("white", {2, 2, 2}), light_of("dark", {0, 0, 0})};
  Bench bench;
  bench.lights = {light_of("green", {7, 7, 7}), light_of("red", {4, 4, 4}), light_of("white", {3, 3, 3}),
                  light_of("dark", {5, 5, 5}), light_of("new", {6, 6, 6})};
  bench.lights[1].intensity_sigma = Eigen::Vector3d(0.4, 0.4, 0.4);
  const std::vector<Finding> said = keep_colors(given, {0}, bench);  // of green there were photos in color
  EXPECT_EQ(bench.lights[0].intensity, Eigen::Vector3d(7, 7, 7));
  EXPECT_LT((bench.lights[1].intensity - Eigen::Vector3d(10, 2, 0)).norm(), 1e-12);
  EXPECT_LT((*bench.lights[1].intensity_sigma - Eigen::Vector3d(1, 0.2, 0)).norm(), 1e-12);
  for (const std::size_t k : {2, 3, 4})
    EXPECT_EQ(bench.lights[k].intensity, Eigen::Vector3d::Constant(k == 2 ? 3 : k + 2.0));
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said[0].what, testing::HasSubstr("shows red:"));
  EXPECT_TRUE(keep_colors(given, {0, 1}, bench).empty());
}

TEST(KnownColors, OutliveARefinementByPhotosInGray) {
  BURIN_NEEDS_RIG("b-small");
  const Rig rig = read_rig("b-small", {"v01", "v05", "v09"});
  std::vector<MergedView> merged = photos_for_refine(rig.session, rig.board, rig.true_poses);
  for (MergedView& view : merged) {
    Image gray(view.value.width, view.value.height, 1), sigma = gray;
    for (std::size_t i = 0; i < gray.data.size(); ++i) {
      const float* value = &view.value.data[3 * i];
      const float* noise = &view.sigma.data[3 * i];
      gray.data[i] = (value[0] + value[1] + value[2]) / 3;
      sigma.data[i] = std::hypot(noise[0], noise[1], noise[2]) / 3;
    }
    view.value = std::move(gray);
    view.sigma = std::move(sigma);
  }
  Bench start = rig.true_poses;
  start.lights = {light_of(rig.session.photos.front().light, {2.4, 0.5, 0.1})};  // no place is known of it
  RefineOptions options;
  options.finest_pixel_mm = 4;
  options.max_iterations = 5;
  options.crossings = Crossings::add;
  options.fit_geometry = options.fit_fields = options.fit_effects = false;
  const Refinement r = refine(merged, rig.board, rig.sent, start, options);
  const Eigen::Vector3d color = r.bench.lights[0].intensity / r.bench.lights[0].intensity.mean();
  EXPECT_LT((color - Eigen::Vector3d(2.4, 0.5, 0.1)).norm(), 1e-9);
  EXPECT_TRUE(std::any_of(r.findings.begin(), r.findings.end(), [](const Finding& f) {
    return f.what.find("color is as in the bench") != std::string::npos;
  }));
}

}  // namespace
}  // namespace burin
