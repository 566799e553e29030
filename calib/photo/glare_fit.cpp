#include "burin/calib/photo/glare_fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "burin/capture/glare.h"

namespace burin {
namespace {

double diagonal_px(const Lens& lens) { return std::hypot(lens.width, lens.height); }

Glare glare_of_reach(const Lens& lens, double share_of_diagonal) {
  constexpr double kCore = 0.0025;  // of the diagonal: nearer light is the blur's
  return {0, kCore * diagonal_px(lens), share_of_diagonal * diagonal_px(lens)};
}

}  // namespace

Glare usual_glare(const Lens& lens) { return glare_of_reach(lens, 0.35); }

std::vector<Glare> possible_glares(const Lens& lens) {
  std::vector<Glare> out;
  for (const double reach : {0.12, 0.35, 0.9}) out.push_back(glare_of_reach(lens, reach));
  return out;
}

void add_scattered_light(std::span<const MergedView> merged, const Glare& glare, std::vector<LightView>& views) {
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t k) {
    LightView& view = views[k];
    const MergedView& photo = merged[view.merged];
    const Image seen = mean_of_channels(photo.value);
    const Image far = glare_of(seen, photo.x0, photo.y0,
                               photo.whole.data.empty() ? coarse_for_glare(seen) : photo.whole, glare, photo.bin);
    view.scattered = Image(view.window.width, view.window.height, 1);
    for (int y = 0; y < view.window.height; ++y)
      for (int x = 0; x < view.window.width; ++x)
        view.scattered.at(x, y) = far.at(x + view.window.x0 - photo.x0, y + view.window.y0 - photo.y0);
  });
}

void take_glare_from_paper(const std::vector<LightView>& views, double share, const Bench& bench,
                           std::vector<LightSample>& paper) {
  for (LightSample& sample : paper) {
    const LightView& view = views[sample.light_view];
    const std::array<Eigen::Vector3d, 1> p{bench.views[view.view].T_camera_board * sample.p_board};
    std::array<Eigen::Vector2d, 1> q;
    project(view.lens, p, q);
    const int x = std::clamp(static_cast<int>(std::lround(q[0].x())) - view.window.x0, 0, view.window.width - 1);
    const int y = std::clamp(static_cast<int>(std::lround(q[0].y())) - view.window.y0, 0, view.window.height - 1);
    sample.value -= share * (view.scattered.at(x, y) - sample.value);
  }
}

}  // namespace burin
