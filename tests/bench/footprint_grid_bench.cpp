// How long footprints take: the rays of a photo's pixel corners through a distorting lens, once a lens, and where they
// meet the board, once a pose.
#include <benchmark/benchmark.h>

#include <numbers>

#include "burin/scene/footprint_grid.h"

namespace burin {
namespace {

constexpr PixelWindow kPhoto{0, 0, 1400, 1050};

Lens bent_lens() {
  Lens lens;
  lens.width = kPhoto.width;
  lens.height = kPhoto.height;
  lens.intrinsics = {2104.3, 2103.1, 703.7, 521.2, -0.083, 0.071, 0.0006, -0.0004, 0.01, 0, 0, 0};
  return lens;
}

void CornerRaysOfALens(benchmark::State& state) {
  const Lens lens = bent_lens();
  for (auto _ : state) benchmark::DoNotOptimize(corner_rays(lens, kPhoto));
}
BENCHMARK(CornerRaysOfALens)->Unit(benchmark::kMillisecond);

void CameraGridOfAPose(benchmark::State& state) {
  const CornerRays rays = corner_rays(bent_lens(), kPhoto);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(std::numbers::pi - 0.6, Eigen::Vector3d::UnitX()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(0, 0, 900) - T.linear() * Eigen::Vector3d(150, 150, 0);
  for (auto _ : state) benchmark::DoNotOptimize(camera_grid(rays, T, {{300, 300}, {0, 0, 0}}));
}
BENCHMARK(CameraGridOfAPose)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace burin
