// What a photo needs, by float packets (docs/model.md 8.7), against the double twin.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "burin/base/simd_choice.h"
#include "burin/render/exact/exact_sums.h"
#include "burin/render/exact/exact_view.h"
#include "burin/render/radiance_chain.h"
#include "tests/render/small_world.h"

namespace burin {
namespace {

// The small world seen by 150 x 110 pixels of 0.16 mm, its camera and lamp `farther` away.
World finer_world(int count, double farther = 1) {
  World w = small_world(count);
  w.bench.lens.width = 150;
  w.bench.lens.height = 110;
  w.bench.lens.intrinsics = {370 * farther, 365 * farther, 76.3, 51.1, -0.1, 0.05, 0.001, -0.001, 0, 0, 0, 0};
  const Eigen::Vector3d middle(10, 10, 0);
  Light& lamp = w.bench.lights[0];
  lamp.position_mm = middle + farther * (lamp.position_mm - middle);
  lamp.intensity *= farther * farther;
  View view;
  view.T_camera_board = looking_at(middle + farther * Eigen::Vector3d(2, 16, 44), middle);
  w.camera = make_camera_view(w.bench, w.board, view, {0, 0, 150, 110});
  return w;
}

// After changes to the bench.
void see(World& w) {
  View view;
  view.T_camera_board = w.camera.T_camera_board;
  w.camera = make_camera_view(w.bench, w.board, view, w.camera.window);
  w.scene = make_scene(w.bench, w.board, w.camera, w.bench.lights[0]);
}

// As render_with_derivatives() in double, mono, with bands of a cross-section as narrow as `widest_band_um`.
RadianceDerivatives in_double(const World& w, double widest_band_um) {
  const auto parameters = all_parameters();
  const FootprintGrid& grid = *w.scene.grid;
  const ViewPixels pixels = view_pixels(w.scene, 1);
  const ExactPairs pairs = exact_pairs(w.scene, w.scratches, widest_band_um);
  const RadianceChain chain(w.scene, w.camera, true);
  RadianceDerivatives out;
  out.radiance = Image(grid.width(), grid.height(), 1);
  out.d_radiance.assign(parameters.size(), out.radiance);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const PixelShading& p = pixels.shading[i];
    if (!(pixels.area_mm2[i] > 0) || !p.visible) continue;
    out.radiance.data[i] = static_cast<float>(ambient_radiance(w.scene, 1)[0]);
    if (!p.lit) continue;
    const auto corners =
        footprint_corners_mm(grid, static_cast<int>(i % grid.width()), static_cast<int>(i / grid.width()));
    const double area = pixels.area_mm2[i], factor = channel_factors(w.scene, p.cos_ho, 1)[0];
    const GrooveSums sums = exact_sums(w.scene, w.scratches, pairs, i, p, corners, area, true);
    out.radiance.data[i] += static_cast<float>(
        factor * p.direct * (sums.light_mm2 / area + (1 - std::min(1.0, sums.area_mm2 / area)) * p.base));
    BySceneParameter by{};
    chain.run({p, grid.normal[i], grid.center_mm[i], corners, area}, sums, factor,
              channel_factor_slopes(w.scene, p.cos_ho, 1)[0], by);
    for (std::size_t k = 0; k < parameters.size(); ++k) out.d_radiance[k].data[i] = static_cast<float>(by[k]);
  }
  return out;
}

// By how much two pictures differ, RMS, of the second's own.
double difference(const Image& a, const Image& b) {
  return relative_rms({a.data.begin(), a.data.end()}, {b.data.begin(), b.data.end()});
}

// How far slopes may be off: of light and what grooves and lamp do to it; of what moves grooves under their pixels.
struct Bars {
  double light, places;
};
void expect_as(const RadianceDerivatives& exact, const World& w, const std::string& what, const Bars& most,
               const RenderOptions& options = {}) {
  const auto parameters = all_parameters();
  const RadianceDerivatives fast =
      render_with_derivatives(w.scene, w.camera, in_metal(w.scratches), parameters, options);
  EXPECT_LT(difference(fast.radiance, exact.radiance), most.light) << what;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const bool places = parameters[k] >= SceneParameter::machine_00 && parameters[k] <= SceneParameter::bow_2_mm;
    const auto& by = exact.d_radiance[k].data;
    if (std::all_of(by.begin(), by.end(), [](float v) { return v == 0; }))
      EXPECT_EQ(fast.d_radiance[k].data, by) << what << ": parameter " << k;
    else
      EXPECT_LT(difference(fast.d_radiance[k], exact.d_radiance[k]), places ? most.places : most.light)
          << what << ": parameter " << k;
  }
}

// Ends of scratches lie in one pixel of seven; between them slopes by places are good to 1e-5.
constexpr Bars kPaper{3e-4, 5e-3};

TEST(PhotoSlopes, AreThoseOfTheDoubleTwin) {
  World w = finer_world(120);
  see(w);
  expect_as(in_double(w, 15), w, "numbers of their own", kPaper);
  const auto parameters = all_parameters();
  expect_as(render_with_derivatives(w.scene, w.camera, in_metal(w.scratches), parameters, {3, true}), w, "in color",
            kPaper, {3});
  w.scratches.width_um.clear();
  w.scratches.depth_um.clear();
  w.scratches.alpha.clear();
  expect_as(in_double(w, 15), w, "shared ones", kPaper);
  for (const SimdWidth simd : {SimdWidth::generic, SimdWidth::avx2}) {
    RenderOptions options;
    options.simd = simd;
    if (has_kernel(simd)) expect_as(in_double(w, 15), w, "other packets", kPaper, options);
  }
  w.bench.material.grain = FaceGrain::of(25, 0.12, 0.25);
  see(w);
  expect_as(in_double(w, 15), w, "on a brushed face", kPaper);
}

TEST(PhotoSlopes, WhereGroovesCoverTheFaceWhole) {
  World w = finer_world(900);
  for (double& v : w.scratches.width_um) v *= 3;
  see(w);
  expect_as(in_double(w, 15), w, "covered", kPaper);
}

// Deep grooves turn one of their walls away from the half vector, and that limit moves with it. (Of one roughness:
// shadowing follows the cosines at the shared one.)
TEST(PhotoSlopes, OfWallsThatAreTurnedAway) {
  World w = finer_world(120);
  for (double& v : w.scratches.depth_um) v = 280;
  w.scratches.alpha.clear();
  w.bench.lights[0].position_mm = {-40, -34, 14};
  see(w);
  expect_as(in_double(w, 15), w, "deep", {3e-4, 8e-3});
}

TEST(PhotoSlopes, OnABentSheet) {
  World w = finer_world(120);
  w.bench.bow_mm.setZero();
  w.board.bend = Bend{.radius_mm = 60, .axis_deg = 20};
  see(w);
  expect_as(in_double(w, 15), w, "bent", kPaper);
}

// Against bands of 0.4 um (a band is as bright all over, and its edge is where slopes are found). From far away light
// is the same all over a pixel; from near it is found where the groove lies in it, and by the twin in the pixel's
// middle.
TEST(PhotoSlopes, OfOtherCrossSections) {
  struct Case {
    double across, burr_um, tip_um, farther;
  };
  for (const Case& c : {Case{0.7, 0, 0, 20}, Case{1.43, 4, 0, 20}, Case{0.7, 4, 250, 20}, Case{1.43, 4, 250, 1}}) {
    World w = finer_world(60, c.farther);
    GrooveProfile& profile = w.bench.material.profile;
    profile.kind = GrooveProfile::Kind::rounded_v;
    profile.flank_deg = 24;
    profile.burr_width_um = 40;
    profile.burr_left_um = c.burr_um;
    profile.burr_right_um = 0.6 * c.burr_um;
    profile.across = c.across;
    profile.tip_radius_um = c.tip_um;
    see(w);
    expect_as(in_double(w, 0.4), w,
              "across " + std::to_string(c.across) + ", burrs " + std::to_string(c.burr_um) + ", tip " +
                  std::to_string(c.tip_um) + ", " + std::to_string(c.farther),
              c.farther > 1 ? Bars{5e-3, 8e-3} : Bars{2e-2, 4e-2});
  }
}

TEST(PhotoSlopes, OfALampWithAnArea) {
  World w = finer_world(60);
  w.bench.lights[0].size.disk_mm = 4;
  see(w);
  const auto parameters = all_parameters();
  expect_as(render_with_derivatives(w.scene, w.camera, in_metal(w.scratches), parameters, {1, true}), w, "a disk",
            kPaper);
}

// A lamp so near that half vectors turn about over a tile: pair by pair.
TEST(PhotoSlopes, GoPairByPairWhereHalfVectorsBend) {
  World w = finer_world(60);
  w.bench.material.profile.kind = GrooveProfile::Kind::rounded_v;
  w.bench.material.profile.flank_deg = 24;
  w.bench.lights[0].position_mm = {9, 11, 2};
  w.bench.lights[0].falloff_exponent = 0;
  see(w);
  const auto parameters = all_parameters();
  const Carved grooves = in_metal(w.scratches);
  const RadianceDerivatives a = render_with_derivatives(w.scene, w.camera, grooves, parameters),
                            b = render_with_derivatives(w.scene, w.camera, grooves, parameters, {1, true});
  EXPECT_EQ(a.radiance.data, b.radiance.data);
  for (std::size_t k = 0; k < parameters.size(); ++k) EXPECT_EQ(a.d_radiance[k].data, b.d_radiance[k].data) << k;
}

}  // namespace
}  // namespace burin
