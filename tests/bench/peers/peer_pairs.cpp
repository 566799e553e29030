// tests/bench/peers/peer_pairs.cpp - the pairs of the paper's scene (tests/bench/paper_scene.h, 512 x 512 pixels) as
// plain arrays, for programs that are compared with Burin (drjit_pairs.py):
//
//   burin_peer_pairs SCRATCHES VIEWS OUT
//
// OUT gets x0.f64, y0.f64, x1.f64, y1.f64 (mm); pixel.u32 and scratch.u32, of each pair; for view V h_V.f64 (half
// vectors in the board's frame, three a pixel), factor_V.f64 (what the sum of Dhat in mm^2 is multiplied by to become a
// pixel's radiance from its grooves), and glints_V.f64: that radiance by the exact double integral.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "burin/render/brdf.h"
#include "burin/render/exact/scratch_pair.h"
#include "burin/render/fast/pairs.h"
#include "burin/render/pixel_shading.h"
#include "tests/bench/paper_scene.h"

namespace {

using namespace burin;

template <typename T>
void write(const std::filesystem::path& file, const std::vector<T>& values) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

void write_view(const ViewScene& scene, const PixelPairs& pairs, const Scratches& scratches,
                const std::filesystem::path& out, const std::string& name) {
  const FootprintGrid& grid = *scene.grid;
  const std::vector<ScratchFrame> frames = scratch_frames(scratches, scene.tool_width_um, scene.material);
  std::vector<double> h, factor, glints;
  for (std::size_t i = 0; i < grid.center_mm.size(); ++i) {
    const PixelShading shading = shade_pixel(grid.center_mm[i], Eigen::Vector3d::UnitZ(), scene.camera_center_mm,
                                             scene.light, scene.material.base_alpha);
    const double G = shadowing(shading.cos_i, shading.cos_o, scene.material.alpha).G;
    double light = 0;
    for (int c = 0; c < 3; ++c) light += schlick_F(shading.cos_ho, scene.material.f0[c]) * scene.light.intensity[c] / 3;
    const Quad corners =
        footprint_corners_mm(grid, static_cast<int>(i) % grid.width(), static_cast<int>(i) / grid.width());
    const double area = (corners[1] - corners[0]).norm() * (corners[2] - corners[1]).norm();
    for (int k = 0; k < 3; ++k) h.push_back(shading.h[k]);
    factor.push_back(light * shading.direct * G / area);
    double sum = 0;
    for (std::size_t p = pairs.begin[i]; p < pairs.begin[i + 1]; ++p) {
      const ScratchFrame& f = frames[pairs.scratch[p]];
      Quad local = corners;
      for (Eigen::Vector2d& q : local) q = Eigen::Vector2d(f.x.dot(q - f.p0), f.y.dot(q - f.p0));
      sum += footprint_integral(f.groove, local,
                                {f.x.dot(shading.h.head<2>()), f.y.dot(shading.h.head<2>()), shading.h.z()})
                 .Dhat_mm2;
    }
    glints.push_back(factor.back() * sum);
  }
  write(out / ("h_" + name + ".f64"), h);
  write(out / ("factor_" + name + ".f64"), factor);
  write(out / ("glints_" + name + ".f64"), glints);
}

}  // namespace

int main(int count, char** words) {
  if (count != 4) {
    std::fprintf(stderr, "give how many scratches and views, and a folder\n");
    return 2;
  }
  constexpr int kPixels = 512;
  const int views = std::atoi(words[2]);
  const std::filesystem::path out = words[3];
  std::filesystem::create_directories(out);
  const auto grid = paper_grid(kPixels);
  const Scratches scratches = paper_scratches(std::atoi(words[1]));
  const ViewScene first = paper_scene(grid, 0, views);
  const PixelPairs pairs =
      find_pairs(PixelIndex(*grid), kPixels, kPixels, strips_of(scratches, first.tool_width_um, first.material));
  std::vector<std::uint32_t> pixel;
  for (std::uint32_t i = 0; i + 1 < pairs.begin.size(); ++i)
    pixel.insert(pixel.end(), pairs.begin[i + 1] - pairs.begin[i], i);
  write(out / "x0.f64", scratches.x0_mm);
  write(out / "y0.f64", scratches.y0_mm);
  write(out / "x1.f64", scratches.x1_mm);
  write(out / "y1.f64", scratches.y1_mm);
  write(out / "pixel.u32", pixel);
  write(out / "scratch.u32", pairs.scratch);
  for (int v = 0; v < views; ++v) write_view(paper_scene(grid, v, views), pairs, scratches, out, std::to_string(v));
  return 0;
}
