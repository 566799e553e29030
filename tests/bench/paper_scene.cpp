#include "tests/bench/paper_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>

namespace burin {
namespace {

struct Differences {
  double image = 0, gradient = 0;
};

Differences differences(const Image (&image)[2], const ScratchGradients (&g)[2]) {
  double peak = 0, error2 = 0, gradient_error2 = 0, size2 = 0;
  for (std::size_t i = 0; i < image[0].data.size(); ++i) {
    peak = std::max<double>(peak, image[1].data[i]);
    error2 += std::pow(static_cast<double>(image[0].data[i]) - image[1].data[i], 2);
  }
  for (const auto end :
       {&ScratchGradients::x0_mm, &ScratchGradients::y0_mm, &ScratchGradients::x1_mm, &ScratchGradients::y1_mm})
    for (std::size_t s = 0; s < (g[0].*end).size(); ++s) {
      gradient_error2 += std::pow((g[0].*end)[s] - (g[1].*end)[s], 2);
      size2 += std::pow((g[1].*end)[s], 2);
    }
  return {std::sqrt(error2 / static_cast<double>(image[0].data.size())) / peak, std::sqrt(gradient_error2 / size2)};
}

void report(benchmark::State& state, const Differences& d) {
  state.counters["image_rms"] = d.image;
  state.counters["gradient_rms"] = d.gradient;
}

}  // namespace

std::shared_ptr<const FootprintGrid> paper_grid(int pixels) {
  constexpr double kBoard = kPaperBoard_mm;
  return share(board_grid({0, 0}, {kBoard, kBoard}, pixels, pixels, {{kBoard, kBoard}, {0, 0, 0}}));
}

ViewScene paper_scene(std::shared_ptr<const FootprintGrid> grid, int view, int views) {
  constexpr double kBoard = kPaperBoard_mm;
  ViewScene scene;
  scene.grid = std::move(grid);
  const double azimuth = std::numbers::pi * view / views, r = 900;
  const Eigen::Vector3d middle(kBoard / 2, kBoard / 2, 0);
  scene.camera_center_mm = middle + r * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 1) / std::sqrt(2);
  scene.light.position_mm = middle + r * Eigen::Vector3d(-std::sin(azimuth), std::cos(azimuth), 1) / std::sqrt(2);
  scene.light.intensity = {1e6, 1e6, 1e6};
  scene.material = {0.04, 30, 0.15, {0.91, 0.92, 0.92}};
  scene.tool_width_um = 30;
  return scene;
}

Scratches paper_scratches(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> where(0, kPaperBoard_mm), turn(0, std::numbers::pi),
      half_length(0.0075 * kPaperBoard_mm, 0.0225 * kPaperBoard_mm);
  Scratches s;
  for (auto* ends : {&s.x0_mm, &s.y0_mm, &s.x1_mm, &s.y1_mm}) ends->reserve(count);
  for (int i = 0; i < count; ++i) {
    const double x = where(random), y = where(random), a = turn(random), half = half_length(random);
    const auto on_board = [](double v) { return std::clamp(v, 0.0, kPaperBoard_mm); };
    s.x0_mm.push_back(on_board(x - half * std::cos(a)));
    s.y0_mm.push_back(on_board(y - half * std::sin(a)));
    s.x1_mm.push_back(on_board(x + half * std::cos(a)));
    s.y1_mm.push_back(on_board(y + half * std::sin(a)));
  }
  return s;
}

Image random_weights(int width, int height) {
  Image weights(width, height, 1);
  std::mt19937 random(3);
  for (float& v : weights.data) v = std::uniform_real_distribution<float>(-1, 1)(random);
  return weights;
}

void report_correctness(benchmark::State& state, const ViewScene& scene, const Scratches& scratches, SimdWidth simd) {
  static std::map<std::pair<std::size_t, SimdWidth>, Differences> known;
  const auto [at, is_new] = known.try_emplace({scratches.size(), simd});
  if (is_new) {
    const Image weights = random_weights(scene.grid->width(), scene.grid->height());
    Image image[2];
    ScratchGradients g[2];
    for (const bool use_double : {false, true}) {
      ViewRenderer renderer(scene, {1, use_double, false, simd});
      renderer.forward_with_jacobian(in_metal(scratches), image[use_double]);
      g[use_double].resize(scratches.size());
      renderer.backward(weights, g[use_double]);
    }
    at->second = differences(image, g);
  }
  report(state, at->second);
}

void report_differences(benchmark::State& state, const Image (&image)[2], const ScratchGradients (&gradients)[2]) {
  report(state, differences(image, gradients));
}

}  // namespace burin
