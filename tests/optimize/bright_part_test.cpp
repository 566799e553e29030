// Proves that what a design leaves out of its iterations does not show: the bright grooves' picture with the others'
// held light is the whole picture, to a rounding when just seen and to a thousandth after steps of Adam's size, its
// gradient is the whole gradient to one per cent; and that nothing is left out where the face or another light would
// show it.
#include "burin/optimize/design/bright_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "burin/optimize/design/design_start.h"
#include "tests/optimize/color_rig.h"

namespace burin {
namespace {

class BrightPartTest : public ColorRig {
 protected:
  // Scratches of every direction, as many to each third of half a turn.
  Scratches any_scratches(std::size_t count) {
    return random_start(count, design_limits(board_, bench_, options_), 3, 7);
  }
  static double peak(const Image& image) { return *std::max_element(image.data.begin(), image.data.end()); }
  static double rms_apart(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i) sum += std::pow(static_cast<double>(a.data[i]) - b.data[i], 2);
    return std::sqrt(sum / static_cast<double>(a.data.size()));
  }
};

TEST_F(BrightPartTest, PictureAndGradientAreThoseOfAllGrooves) {
  std::vector<WorkView> work = views();
  ASSERT_EQ(work.size(), 3U);
  const Carved grooves = in_metal(any_scratches(3000));
  std::mt19937_64 random(3);
  for (WorkView& v : work) {
    Image whole;
    v.renderer.forward_with_jacobian(grooves, whole);
    Image dE_dradiance(whole.width, whole.height, 1);
    for (float& d : dE_dradiance.data) d = std::uniform_real_distribution<float>(-1, 1)(random);
    const ScratchGradients all = v.renderer.backward(dE_dradiance);

    BrightPart part;
    part.apart = true;
    render_view(v, part, bench_, grooves, true);
    EXPECT_GT(part.rows.size(), 100U);
    EXPECT_LT(part.rows.size(), 2000U) << "a lamp's own are bright, and few others";
    EXPECT_LT(rms_apart(v.radiance, whole), 1e-7 * peak(whole));
    ScratchGradients own;
    own.resize(grooves.size());
    view_backward(v, part, {bench_, board_}, grooves, dE_dradiance, own);
    double off = 0, size = 0;
    for (std::size_t i = 0; i < grooves.size(); ++i) {
      off += std::pow(own.x0_mm[i] - all.x0_mm[i], 2) + std::pow(own.y1_mm[i] - all.y1_mm[i], 2);
      size += std::pow(all.x0_mm[i], 2) + std::pow(all.y1_mm[i], 2);
    }
    EXPECT_GT(off, 0) << "nothing was left out";
    EXPECT_LT(std::sqrt(off / size), 0.01);
  }
}

TEST_F(BrightPartTest, OthersLightHoldsWhileGroovesMoveALittle) {
  std::vector<WorkView> work = views();
  const Scratches before = any_scratches(3000);
  Scratches after = before;
  std::mt19937_64 random(5);
  // Three steps of 0.15 pixels each, all in one direction.
  std::uniform_real_distribution<double> step(-0.45 * work[0].pitch_mm, 0.45 * work[0].pitch_mm);
  for (auto* column : {&after.x0_mm, &after.y0_mm, &after.x1_mm, &after.y1_mm})
    for (double& end : *column) end += step(random);
  for (WorkView& v : work) {
    BrightPart part;
    part.apart = true;
    render_view(v, part, bench_, in_metal(before), false);
    const Image was = v.radiance;
    render_view(v, part, bench_, in_metal(after), false);
    const Image held = v.radiance;
    v.renderer.forward(in_metal(after), v.radiance);
    EXPECT_GT(rms_apart(was, v.radiance), 0.02 * peak(v.radiance)) << "what is bright did move";
    EXPECT_LT(rms_apart(held, v.radiance), 1e-3 * peak(v.radiance));
  }
}

TEST_F(BrightPartTest, NothingIsToldApartWhereFaceOrOtherLightsShowIt) {
  for (const WorkView& v : views()) EXPECT_TRUE(bright_part_shows(v, bench_, board_));
  bench_.material.base_alpha = 0.3;  // bright from everywhere: what grooves cover of it shows
  for (const WorkView& v : views()) EXPECT_FALSE(bright_part_shows(v, bench_, board_));
  bench_.material.base_alpha = board_.material.base_alpha;
  // Lamps that all have some light of every color: a channel's bright grooves are those of all.
  mix_lamps();
  const Scratches grooves = any_scratches(1000);
  for (const WorkView& v : views()) EXPECT_GT(bright_rows(v, bench_, grooves).size(), 600U);
  bench_.lights[0].size.disk_mm = 20;
  for (const WorkView& v : views()) EXPECT_FALSE(bright_part_shows(v, bench_, board_));
}

}  // namespace
}  // namespace burin
