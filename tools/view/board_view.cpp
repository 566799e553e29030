#include "tools/view/board_view.h"

#include <algorithm>
#include <cmath>

#include "burin/optimize/loss/picture_metrics.h"
#include "burin/render/board_face.h"
#include "burin/render/view_renderer.h"
#include "tools/report/rectified.h"

namespace burin {

FlatPicture flat_picture(const Board& board, const ViewedBoard& viewed, const ViewedPicture& picture,
                         int long_side_px) {
  const Bench& bench = viewed.bench;
  BoardFrame frame = board_frame(board.carve_min_mm, board.carve_max_mm, long_side_px);
  if (!picture.target.data.empty()) frame.width = picture.target.width, frame.height = picture.target.height;
  ViewScene scene;
  scene.grid =
      share(board_grid(board.carve_min_mm, board.carve_max_mm, frame.width, frame.height, face_of(board, bench)));
  scene.camera_center_mm = find_view(bench, picture.view, "the viewer").T_camera_board.inverse().translation();
  scene.light = find_light(bench, picture.light, "the viewer");
  scene.material = bench.material;
  scene.tool_width_um = board.tool_width_um;
  scene.ambient = bench.ambient;
  RenderOptions options;
  options.channels = 1;
  options.material_gradients = false;
  Image radiance;
  ViewRenderer(std::move(scene), options).forward(viewed.carved, radiance);
  FlatPicture out;
  const float brightest = percentile(radiance, 0.995);
  if (brightest > 0) out.exposure = 1 / static_cast<double>(brightest);
  if (brightest > 0 && !picture.target.data.empty())
    out.exposure = best_exposure(radiance, picture.target, out.exposure);
  if (!(out.exposure > 0) || !std::isfinite(out.exposure)) out.exposure = 1;
  for (float& v : radiance.data) v = linear_to_srgb(std::clamp(static_cast<float>(out.exposure) * v, 0.0F, 1.0F));
  out.shown = std::move(radiance);
  return out;
}

}  // namespace burin
