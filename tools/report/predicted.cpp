#include "tools/report/predicted.h"

#include "burin/capture/simulator/simulated_camera.h"
#include "burin/render/surface.h"
#include "burin/render/view_renderer.h"

namespace burin {
namespace {

constexpr int kWindowMarginPx = 6;

double vignette_at(const Sensor& sensor, const Lens& lens, double x, double y) {
  const double cx = (lens.width - 1) / 2.0, cy = (lens.height - 1) / 2.0;
  const double r2 = ((x - cx) * (x - cx) + (y - cy) * (y - cy)) * 4 /
                    (static_cast<double>(lens.width) * lens.width + static_cast<double>(lens.height) * lens.height);
  const Eigen::Vector3d& v = sensor.vignette;
  return 1 + r2 * (v[0] + r2 * (v[1] + r2 * v[2]));
}

}  // namespace

Image predicted_photo(const Bench& bench, const Board& board, const Scratches& carved, const View& view,
                      const Light& light, int channels, const PixelWindow& window) {
  RenderOptions options;
  options.channels = channels;
  ViewRenderer renderer(make_scene(bench, board, make_camera_view(bench, board, view, window), light), options);
  Image value;
  renderer.forward(carved, value);
  value = blurred(value, bench.sensor.psf_sigma_px);
  for (int y = 0; y < value.height; ++y)
    for (int x = 0; x < value.width; ++x) {
      const double factor = bench.sensor.gain * vignette_at(bench.sensor, bench.lens, x + window.x0, y + window.y0);
      for (int c = 0; c < value.channels; ++c) value.at(x, y, c) *= static_cast<float>(factor);
    }
  return value;
}

PixelWindow carve_window(const Bench& bench, const Board& board, const View& view) {
  return window_of(bench.lens, view.T_camera_board, {board.size_mm, bench.bow_mm}, board.carve_min_mm,
                   board.carve_max_mm, kWindowMarginPx);
}

}  // namespace burin
