#include "tools/view/board_view.h"

#include <algorithm>
#include <cmath>

#include "burin/optimize/loss/color_metrics.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/board_face.h"
#include "tools/report/rectified.h"

namespace burin {
namespace {

// Multiplies a picture's channels by its gains. For channels with their own exposures, `gains` become the best ones.
void balance(const ViewedPicture& picture, Image& radiance, Eigen::Vector3d& gains) {
  const float brightest = percentile(radiance, 0.995);
  if (picture.each_channel && brightest > 0) {
    Eigen::Vector3d best;
    for (int c = 0; c < 3; ++c)
      best[c] = color_best_exposure(channel_of(radiance, c), channel_of(picture.target, c), 1.0 / brightest);
    if (best.allFinite() && best.mean() > 0) gains = best / best.mean();
  }
  for (std::size_t i = 0; i < radiance.data.size(); ++i)
    radiance.data[i] *= static_cast<float>(gains[static_cast<Eigen::Index>(i % 3)]);
}

}  // namespace

FlatPicture flat_picture(const Board& board, const ViewedBoard& viewed, const ViewedPicture& picture,
                         int long_side_px) {
  const Bench& bench = viewed.bench;
  BoardFrame frame = board_frame(board.carve_min_mm, board.carve_max_mm, long_side_px);
  if (!picture.target.data.empty()) frame.width = picture.target.width, frame.height = picture.target.height;
  ViewScene scene =
      make_board_scene(bench, board, frame.width, frame.height,
                       find_view(bench, picture.view, "the viewer").T_camera_board.inverse().translation(),
                       find_lit(bench, picture.light, "the viewer"));
  RenderOptions options;
  const bool colored = picture.target.channels == 3;
  options.channels = colored ? 3 : 1;
  options.material_gradients = false;
  Image radiance;
  ViewRenderer(std::move(scene), options).forward(viewed.carved, radiance);
  FlatPicture out;
  out.gains = picture.gains;
  if (colored) balance(picture, radiance, out.gains);
  const float brightest = percentile(radiance, 0.995);
  if (brightest > 0) out.exposure = 1 / static_cast<double>(brightest);
  if (brightest > 0 && !picture.target.data.empty())
    out.exposure = color_best_exposure(radiance, picture.target, out.exposure);
  if (!(out.exposure > 0) || !std::isfinite(out.exposure)) out.exposure = 1;
  for (float& v : radiance.data) v = linear_to_srgb(std::clamp(static_cast<float>(out.exposure) * v, 0.0F, 1.0F));
  out.shown = std::move(radiance);
  return out;
}

}  // namespace burin
