#include "burin/calib/verdict/green_alone.h"

#include <cstddef>
#include <utility>

#include "burin/base/median.h"
#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/board_tiles.h"
#include "burin/calib/photo/normal_system.h"

namespace burin {
namespace {

constexpr int kGreen = 1;

// Green values of the view's valid pixels, scaled to the view's values on smooth parts of the photo.
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

Eigen::VectorXd shift_if_read_otherwise(const std::function<LightView(std::size_t)>& read,
                                        std::vector<LightSample> paper, Problem& data, const Stage& stage,
                                        const State& state) {
  const CellGrid tiles = board_tiles(*data.model.board);
  std::vector<PhotoEquations> otherwise(data.photos.size());
  const std::vector<PhotoEquations> as_is =
      equations_of_photos(data, stage, state, {data.model}, [&](std::size_t k, const PhotoSlopes& slopes) {
        PhotoData photo = data.photos[k];
        photo.photo.value = binned(read(k), photo.bin).value;
        otherwise[k] = photo_equations(data.model, photo, slopes.at, slopes.light, slopes, &tiles);
      }).front();
  const NormalSystem before = normal_system(data, stage, state, Information::curvature, as_is);
  std::swap(data.paper, paper);
  const NormalSystem after = normal_system(data, stage, state, Information::curvature, otherwise);
  std::swap(data.paper, paper);
  return -safe_inverse(before.H, before.free) * (after.g - before.g);
}

Eigen::VectorXd half_shift_by_green_alone(std::span<const MergedView> merged, std::span<const LightView> views,
                                          Problem& data, const Stage& stage, const State& state) {
  const auto green = [&](std::size_t k) {
    LightView out = views[k];
    out.value = green_of(merged[out.merged], out);
    return out;
  };
  return 0.5 * shift_if_read_otherwise(green, data.paper, data, stage, state);
}

}  // namespace burin
