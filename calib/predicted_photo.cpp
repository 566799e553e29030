#include "burin/calib/predicted_photo.h"

#include <algorithm>
#include <utility>

#include "burin/capture/glare.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/board_face.h"

namespace burin {
namespace {

constexpr int kWindowMargin_px = 6;

}  // namespace

Image predicted_photo(const Bench& bench, const Board& board, const View& view, const Light& light,
                      const Carved& carved, const PredictedPhotoOptions& options) {
  const PixelWindow whole{0, 0, bench.lens.width, bench.lens.height};
  const PixelWindow window = options.window.width > 0 ? options.window : whole;
  RenderOptions render;
  render.channels = options.channels;
  render.material_gradients = false;
  ViewRenderer renderer(make_scene(bench, board, make_camera_view(bench, board, view, window), light), render);
  Image value;
  renderer.forward(carved, value);
  value = blurred(value, bench.sensor.psf_sigma_px);
  if (bench.sensor.glare.share > 0) {
    const auto share = static_cast<float>(bench.sensor.glare.share);
    for (int c = 0; c < value.channels; ++c) {
      Image one(value.width, value.height, 1);
      for (std::size_t i = 0; i < one.data.size(); ++i) one.data[i] = value.data[i * value.channels + c];
      const Image far = glare_of(one, bench.sensor.glare);
      for (std::size_t i = 0; i < one.data.size(); ++i)
        value.data[i * value.channels + c] += share * (far.data[i] - one.data[i]);
    }
  }
  const bool clipped = options.clipped || options.encoding != Encoding::linear;
  for (int y = 0; y < value.height; ++y)
    for (int x = 0; x < value.width; ++x) {
      const double radius2 = vignette_radius2(bench.lens.width, bench.lens.height, x + window.x0, y + window.y0);
      const double factor =
          bench.sensor.gain * options.exposure_factor * vignette_at(bench.sensor.vignette.data(), radius2);
      for (int c = 0; c < value.channels; ++c) {
        float& v = value.at(x, y, c);
        v *= static_cast<float>(factor);
        if (clipped) v = std::clamp(v, 0.0F, 1.0F);
        v = encoded(v, options.encoding);
      }
    }
  return value;
}

PixelWindow carve_window(const Bench& bench, const Board& board, const View& view) {
  return window_of(lens_of(bench, view), view.T_camera_board, surface_of(board, bench), board.carve_min_mm,
                   board.carve_max_mm, kWindowMargin_px);
}

}  // namespace burin
