#include "burin/calib/light/lamp_colors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "burin/base/median.h"

namespace burin {

std::optional<Eigen::Vector3d> white_paper(const MergedView& view, const TagDetection& tag, WhiteBy by) {
  if (view.value.channels != 3) return std::nullopt;
  std::array<Eigen::Vector2d, 4> corner;
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (int i = 0; i < 4; ++i) {
    corner[i] = ((tag.corner_px[i].array() + 0.5) / view.bin - 0.5).matrix();
    low = low.cwiseMin(corner[i]);
    high = high.cwiseMax(corner[i]);
  }
  const auto inside = [&](double x, double y) {
    int left = 0;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector2d side = corner[(i + 1) % 4] - corner[i];
      left += side.x() * (y - corner[i].y()) - side.y() * (x - corner[i].x()) > 0 ? 1 : 0;
    }
    return left == 0 || left == 4;
  };
  std::vector<std::pair<float, std::size_t>> pixels;
  for (int y = std::max(0, static_cast<int>(low.y())); y <= std::min<double>(view.value.height - 1, high.y()); ++y)
    for (int x = std::max(0, static_cast<int>(low.x())); x <= std::min<double>(view.value.width - 1, high.x()); ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * view.value.width + x;
      if (!view.valid[i] || !inside(x, y)) continue;
      const float* rgb = &view.value.data[3 * i];
      pixels.emplace_back(by == WhiteBy::green ? rgb[1] : rgb[0] + rgb[1] + rgb[2], i);
    }
  constexpr std::size_t kFewest = 60;
  if (pixels.size() < kFewest) return std::nullopt;
  std::sort(pixels.begin(), pixels.end(), std::greater<>());
  Eigen::Vector3d sum(0, 0, 0);
  const std::size_t fifth = pixels.size() / 5, first = by == WhiteBy::green ? 0 : fifth / 2;
  for (std::size_t k = first; k < first + fifth; ++k)
    for (int c = 0; c < 3; ++c) sum[c] += view.value.data[3 * pixels[k].second + static_cast<std::size_t>(c)];
  return sum;
}

std::vector<Eigen::Vector3d> paper_light(const MergedView& view, const TagsInPhoto& tags) {
  std::vector<Eigen::Vector3d> out;
  for (const TagDetection& tag : tags.tags)
    if (const auto sum = white_paper(view, tag, WhiteBy::mean); sum && sum->mean() > 0)
      out.push_back(*sum / sum->mean());
  return out;
}

namespace {

// Share of ambient light in the light on paper in the board's middle (model.md 5.6).
double ambient_share(const Light& light, const Board& board, const Bench& bench) {
  const Eigen::Vector3d way = light.position_mm - Eigen::Vector3d(board.size_mm.x() / 2, board.size_mm.y() / 2, 0);
  const double distance = way.norm(), beam = std::max(0.0, -light.axis.dot(way) / distance);
  const double spot = light.falloff_exponent == 0 ? 1 : std::pow(beam, light.falloff_exponent);
  const double lamp = light.intensity.mean() * spot * std::max(0.0, way.z()) / (distance * distance * distance);
  const double ambient = std::numbers::pi * std::max(0.0, bench.ambient.mean());
  return ambient > 0 ? ambient / (lamp + ambient) : 0;
}

}  // namespace

void color_lamps(std::span<const Bracket> brackets, std::span<const std::vector<Eigen::Vector3d>> paper,
                 const Board& board, Bench& bench) {
  for (Light& light : bench.lights) {
    std::array<std::vector<double>, 3> values;
    for (std::size_t b = 0; b < brackets.size(); ++b)
      if (brackets[b].light == light.id)
        for (const Eigen::Vector3d& rgb : paper[b])
          for (std::size_t c = 0; c < 3; ++c) values[c].push_back(rgb[static_cast<Eigen::Index>(c)]);
    if (values[0].empty()) continue;
    const double ambient = ambient_share(light, board, bench);
    Eigen::Vector3d color;
    for (std::size_t c = 0; c < 3; ++c)
      color[static_cast<Eigen::Index>(c)] = std::max(0.0, median_of(values[c]) - ambient);
    if (!(color.mean() > 0)) continue;
    const double brightness = light.intensity.mean();
    light.intensity = brightness / color.mean() * color;
  }
}

}  // namespace burin
