// Proves what a search is told of grooves that cut each other's rims away: where held shares of light stand for cut
// grooves their pictures come out nearly the same, and what a stroke is said to cost those that it crosses is what the
// renderer says it does, grooves cut exactly.
#include "burin/optimize/design/crossing_loss.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "burin/optimize/design/to_metal.h"
#include "tests/optimize/color_rig.h"

namespace burin {
namespace {

class CrossingLossTest : public ColorRig {
 protected:
  void SetUp() override {
    ColorRig::SetUp();
    bench_.crossings = Crossings::deepest;
  }
  Scratches any_scratches(std::size_t count, std::uint64_t seed) {
    return random_start(count, design_limits(board_, bench_, options_), 6, seed);
  }
  Carved cut(const Scratches& s) const { return carve(Designed(s), bench_, board_); }
  Carved whole(const Scratches& s) const { return carve(Designed(s), adding_rims(bench_), board_); }
  double cover(const Scratches& s, const WorkView& v) const {
    double length_mm = 0;
    for (std::size_t i = 0; i < s.size(); ++i)
      length_mm += std::hypot(s.x1_mm[i] - s.x0_mm[i], s.y1_mm[i] - s.y0_mm[i]);
    return area_mm2(whole(s).scratches, bench_, board_) / length_mm / v.pitch_mm;
  }
  static std::vector<Image> radiances(std::vector<WorkView>& views, const Carved& grooves) {
    std::vector<Image> out(views.size());
    for (std::size_t k = 0; k < views.size(); ++k) views[k].renderer.forward(grooves, out[k]);
    return out;
  }
  // What is left of the first rows.
  static Carved of_the_first(const Carved& grooves, std::size_t rows) {
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < grooves.size(); ++i)
      if (grooves.source[i] < rows) kept.push_back(i);
    return in_metal(selected(grooves.scratches, kept));
  }
  // Of white: a third of the pixels' light lies above 0.3.
  static std::vector<double> log_exposure_for(std::vector<WorkView>& views, const Carved& grooves) {
    std::vector<float> all;
    for (WorkView& v : views) {
      v.renderer.forward(grooves, v.radiance);
      all.insert(all.end(), v.radiance.data.begin(), v.radiance.data.end());
    }
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() * 2 / 3), all.end());
    return std::vector<double>(3, std::log(0.3 / all[all.size() * 2 / 3]));
  }
};

TEST_F(CrossingLossTest, HeldSharesStandForCutGrooves) {
  std::vector<WorkView> work = views();
  const Scratches scratches = any_scratches(2500, 7);
  const std::vector<double> log_exposure = log_exposure_for(work, cut(scratches));
  render_all(work, cut(scratches));
  see_crossings(work, log_exposure, radiances(work, whole(scratches)), cover(scratches, work[0]));
  for (WorkView& v : work) {
    Image exact, held;
    v.renderer.forward(cut(scratches), exact);
    v.renderer.forward(whole(scratches), held);
    double without = 0, with = 0, lost = 0, all = 0;
    for (std::size_t i = 0; i < held.data.size(); ++i) {
      without += std::pow(held.data[i] - exact.data[i], 2);
      all += held.data[i];
      lost += held.data[i] - exact.data[i];
    }
    leave_what_crossings_do(v, held);
    for (std::size_t i = 0; i < held.data.size(); ++i) with += std::pow(held.data[i] - exact.data[i], 2);
    EXPECT_GT(lost, 0.15 * all) << "crossings take much here";
    EXPECT_LT(with, 0.2 * without);
    for (const float kept : v.crossings.kept.data) {
      EXPECT_GE(kept, 0.05F);
      EXPECT_LE(kept, 1.0F);
    }
  }
  forget_crossings(work);
  EXPECT_TRUE(work[0].crossings.kept.data.empty());
  EXPECT_TRUE(crossing_cost(work, log_exposure).data.empty());
}

TEST_F(CrossingLossTest, CostIsWhatAStrokeTakesFromThoseItCrosses) {
  for (const float target : {0.95F, 0.3F}) {  // more than is shown, so that what goes is missed; and less
    std::vector<WorkView> work = views();
    for (WorkView& v : work) std::fill(v.target.picture.data.begin(), v.target.picture.data.end(), target);
    const Scratches lying = any_scratches(1500, 7);
    const std::vector<double> log_exposure = log_exposure_for(work, cut(lying));
    render_all(work, cut(lying));
    see_crossings(work, log_exposure, radiances(work, whole(lying)), cover(lying, work[0]));
    const Scratches added = any_scratches(60, 11);
    // Of those that lay there, whatever crosses them.
    const auto error = [&](const Scratches& s) {
      double sum = 0;
      for (WorkView& v : work) {
        v.renderer.forward(of_the_first(cut(s), lying.size()), v.radiance);
        for (std::size_t i = 0; i < v.radiance.data.size(); ++i) {
          const double light = std::exp(log_exposure[0]) * v.radiance.data[i];
          sum += v.spec.weight * v.share * v.balance * std::pow(std::min(1.0, std::pow(light, 1 / 2.2)) - target, 2);
        }
      }
      return sum;
    };
    const double before = error(lying);
    const Image cost = crossing_cost(work, log_exposure);
    const double rise =
        error(joined(lying, added, board_.tool_width_um, bench_.material.depth_um, bench_.material.alpha)) - before;
    double said = 0;
    const double pitch = work[0].pitch_mm;
    for (std::size_t i = 0; i < added.size(); ++i) {
      const Eigen::Vector2d a(added.x0_mm[i], added.y0_mm[i]), b(added.x1_mm[i], added.y1_mm[i]);
      const int steps = 40;
      for (int k = 0; k < steps; ++k) {
        const Eigen::Vector2d p = a + (k + 0.5) / steps * (b - a);
        const int x = std::clamp(static_cast<int>((p.x() - board_.carve_min_mm.x()) / pitch), 0, cost.width - 1);
        const int y = std::clamp(static_cast<int>((board_.carve_max_mm.y() - p.y()) / pitch), 0, cost.height - 1);
        said += cost.at(x, y) * (b - a).norm() / pitch / steps;
      }
    }
    if (target > 0.9F)
      EXPECT_GT(rise, 0);
    else
      EXPECT_LT(rise, 0);
    EXPECT_GT(said / rise, 0.5) << said << " " << rise;
    EXPECT_LT(said / rise, 2) << said << " " << rise;
  }
}

}  // namespace
}  // namespace burin
