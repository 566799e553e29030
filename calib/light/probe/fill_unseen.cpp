#include "burin/calib/light/probe/fill_unseen.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace burin {
namespace {

// Means and their weights: weight in the last place.
struct Level {
  int width = 0, height = 0, channels = 0;
  std::vector<double> value, weight;

  Level(int w, int h, int c)
      : width(w),
        height(h),
        channels(c),
        value(static_cast<std::size_t>(w) * h * c, 0),
        weight(static_cast<std::size_t>(w) * h, 0) {}
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * width + (x % width + width) % width;
  }
};

Level halved(const Level& fine) {
  Level out((fine.width + 1) / 2, (fine.height + 1) / 2, fine.channels);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t from = fine.at(x, y), to = out.at(x / 2, y / 2);
      out.weight[to] += fine.weight[from];
      for (int c = 0; c < fine.channels; ++c)
        out.value[to * fine.channels + c] += fine.weight[from] * fine.value[from * fine.channels + c];
    }
  for (std::size_t i = 0; i < out.weight.size(); ++i)
    for (int c = 0; c < out.channels; ++c)
      if (out.weight[i] > 0) out.value[i * out.channels + c] /= out.weight[i];
  return out;
}

// Fills gaps of the finer level from the coarser one, linearly between its pixels.
void pull(const Level& coarse, Level& fine) {
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t to = fine.at(x, y);
      if (fine.weight[to] > 0) continue;
      const double u = (x + 0.5) / 2 - 0.5, v = (y + 0.5) / 2 - 0.5;
      const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
      double sum = 0;
      std::vector<double> value(fine.channels, 0);
      for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
          const double share = (dx ? u - i : 1 - u + i) * (dy ? v - j : 1 - v + j);
          const std::size_t from = coarse.at(i + dx, j + dy);
          if (!(coarse.weight[from] > 0)) continue;
          sum += share;
          for (int c = 0; c < fine.channels; ++c) value[c] += share * coarse.value[from * fine.channels + c];
        }
      if (!(sum > 0)) continue;
      fine.weight[to] = 1e-12;
      for (int c = 0; c < fine.channels; ++c) fine.value[to * fine.channels + c] = value[c] / sum;
    }
}

}  // namespace

void fill_unseen(Image& panorama, std::span<const std::uint8_t> known) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < known.size(); ++i)
    for (int c = 0; known[i] && c < panorama.channels; ++c, ++count) sum += panorama.data[i * panorama.channels + c];
  if (count == 0) return;
  const double dark = std::max(1e-30, 1e-3 * sum / static_cast<double>(count));
  std::vector<Level> levels = {{panorama.width, panorama.height, panorama.channels}};
  for (int y = 0; y < panorama.height; ++y)
    for (int x = 0; x < panorama.width; ++x) {
      const std::size_t i = levels[0].at(x, y);
      if (!known[i]) continue;
      levels[0].weight[i] = std::sin(std::numbers::pi * (y + 0.5) / panorama.height);
      for (int c = 0; c < panorama.channels; ++c)
        levels[0].value[i * panorama.channels + c] = std::log(panorama.at(x, y, c) + dark);
    }
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(halved(levels.back()));
  for (std::size_t k = levels.size() - 1; k > 0; --k) pull(levels[k], levels[k - 1]);
  for (std::size_t i = 0; i < known.size(); ++i)
    for (int c = 0; !known[i] && c < panorama.channels; ++c)
      panorama.data[i * panorama.channels + c] =
          static_cast<float>(std::max(0.0, std::exp(levels[0].value[i * panorama.channels + c]) - dark));
}

}  // namespace burin
