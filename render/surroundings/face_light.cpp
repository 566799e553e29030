#include "burin/render/surroundings/face_light.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace burin {

FaceLight face_light(const ViewScene& scene, const Light& light, int channels, const PlaceLattice& lattice) {
  const FaceTable table = make_face_table(scene, light, channels, lattice);
  const FootprintGrid& grid = *scene.grid;
  const int width = grid.width(), height = grid.height();
  const std::size_t n = static_cast<std::size_t>(width) * height * channels;
  FaceLight out{std::vector<float>(n, 0), std::vector<float>(n, 0)};
  tbb::parallel_for(0, height, [&](int r) {
    const CubicShares y = cubic_shares(r / lattice.row_pixels, lattice.rows, false);
    // All pixels of a row interpolate the same rows of places.
    const std::size_t row = static_cast<std::size_t>(lattice.columns) * channels;
    std::vector<float> value(row, 0), slope(row, 0);
    for (int j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < row; ++k) {
        value[k] += static_cast<float>(y.share[j]) * table.light[(y.first + j) * row + k];
        slope[k] += static_cast<float>(y.share[j]) * table.by_log_alpha[(y.first + j) * row + k];
      }
    for (int c = 0; c < width; ++c) {
      const std::size_t i = static_cast<std::size_t>(r) * width + c;
      const Eigen::Vector3d way = scene.camera_center_mm - grid.center_mm[i];
      if (!grid.center_mm[i].allFinite() || !(way.dot(grid.normal[i]) > 0)) continue;
      const CubicShares x = cubic_shares(c / lattice.column_pixels, lattice.columns, false);
      for (int k = 0; k < 4; ++k)
        for (int ch = 0; ch < channels; ++ch) {
          const std::size_t from = static_cast<std::size_t>(x.first + k) * channels + ch;
          out.light[i * channels + ch] += static_cast<float>(x.share[k]) * value[from];
          out.by_log_alpha[i * channels + ch] += static_cast<float>(x.share[k]) * slope[from];
        }
    }
  });
  return out;
}

}  // namespace burin
