#include "burin/calib/verdict/green_alone.h"

#include <cstddef>

#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/board_tiles.h"
#include "burin/calib/photo/normal_system.h"
#include "burin/render/median.h"

namespace burin {
namespace {

constexpr int kGreen = 1;

// The view's valid pixels, each with the green of its photo times what makes the two alike where photos are smooth.
Image green_of(const MergedView& photo, const LightView& view) {
  const int width = view.window.width, height = view.window.height;
  Image green(width, height, 1);
  std::vector<double> ratios;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float value = green.at(x, y) =
          photo.value.at(x + view.window.x0 - photo.x0, y + view.window.y0 - photo.y0, kGreen);
      if (view.valid[static_cast<std::size_t>(y) * width + x] && value > 0)
        ratios.push_back(view.value.at(x, y) / value);
    }
  const float ratio = ratios.empty() ? 1 : static_cast<float>(median_of(std::move(ratios)));
  for (float& value : green.data) value *= ratio;
  return green;
}

}  // namespace

Eigen::VectorXd half_shift_by_green_alone(std::span<const MergedView> merged, std::span<const LightView> views,
                                          const Problem& data, const Stage& stage, const State& state) {
  const CellGrid tiles = board_tiles(*data.model.board);
  std::vector<PhotoEquations> by_green(data.photos.size());
  const std::vector<PhotoEquations> by_mean =
      equations_of_photos(data, stage, state, {data.model}, [&](std::size_t k, const PhotoSlopes& slopes) {
        LightView green = views[k];
        green.value = green_of(merged[green.merged], green);
        PhotoData photo = data.photos[k];
        photo.photo.value = binned(green, photo.bin).value;
        by_green[k] = photo_equations(data.model, photo, slopes.at, slopes.light, slopes, &tiles);
      }).front();
  const NormalSystem mean = normal_system(data, stage, state, Information::curvature, by_mean);
  const NormalSystem green = normal_system(data, stage, state, Information::curvature, by_green);
  return -0.5 * safe_inverse(mean.H, mean.free) * (green.g - mean.g);
}

}  // namespace burin
