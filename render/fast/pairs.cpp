#include "burin/render/fast/pairs.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "burin/base/error.h"
#include "burin/render/fast/strip_runs.h"
#include "burin/render/fast/tile_kernel.h"
#include "burin/render/fast/tile_runs.h"
#include "burin/scene/groove.h"
#include "burin/scene/groove_profile.h"

namespace burin {

void find_spans(const PixelIndex& index, const Strip& strip, std::vector<PixelSpan>& spans) {
  const StripRuns one(index, std::span(&strip, 1));
  std::vector<std::pair<int, int>> pixels;  // row, column
  for (std::size_t t = 0; t < index.tiles().size(); ++t) {
    if (one.runs().count(t) == 0) continue;
    const int left = static_cast<int>(t) % index.tiles_x() * kTile, top = static_cast<int>(t) / index.tiles_x() * kTile;
    FoundPlaces found;
    tile_kernels(SimdWidth::best).find(finding(index, one.runs(), t), found);
    for (std::uint32_t k = 0; k < found.begin[1]; ++k)
      pixels.emplace_back(top + found.place[k] / kTile, left + found.place[k] % kTile);
  }
  std::sort(pixels.begin(), pixels.end());
  const std::size_t before = spans.size();
  for (const auto& [row, column] : pixels) {
    if (spans.size() > before && spans.back().row == row && spans.back().end == column)
      ++spans.back().end;
    else
      spans.push_back({row, column, column + 1});
  }
}

PixelPairs find_pairs(const PixelIndex& index, int width, int height, const std::vector<Strip>& strips) {
  const StripRuns sorted(index, strips);
  const TileRuns& runs = sorted.runs();
  const int tiles_x = index.tiles_x();
  const auto pixel_of = [&](std::size_t t, std::uint16_t place) {
    const std::size_t row = t / tiles_x * kTile + place / kTile, column = t % tiles_x * kTile + place % kTile;
    return row * width + column;
  };
  PixelPairs found;
  found.begin.assign(static_cast<std::size_t>(width) * height + 1, 0);
  sorted.each_tile(index, SimdWidth::best, [&](std::size_t t, const TilePlaces& pairs) {
    for (std::uint32_t k = 0; k < pairs.begin[runs.count(t)]; ++k) ++found.begin[pixel_of(t, pairs.place[k]) + 1];
  });
  for (std::size_t i = 1; i < found.begin.size(); ++i) found.begin[i] += found.begin[i - 1];
  found.scratch.resize(found.begin.back());
  std::vector<std::size_t> next(found.begin.begin(), found.begin.end() - 1);
  // A tile's runs are in scratch order, and each pixel belongs to one tile.
  sorted.each_tile(index, SimdWidth::best, [&](std::size_t t, const TilePlaces& pairs) {
    for (std::uint32_t r = 0; r < runs.count(t); ++r)
      for (std::uint32_t k = pairs.begin[r]; k < pairs.begin[r + 1]; ++k)
        found.scratch[next[pixel_of(t, pairs.place[k])]++] = runs.scratch(t, r);
  });
  return found;
}

void check_scratches(const Scratches& scratches) {
  const std::size_t n = scratches.size();
  const auto check = [n](const std::vector<double>& values, const char* name, bool positive) {
    if (values.size() != n)
      fail("scratches",
           std::string(name) + " has " + std::to_string(values.size()) + " entries for " + std::to_string(n) +
               " scratches",
           "give one a scratch");
    for (std::size_t i = 0; i < n; ++i) {
      if (std::isfinite(values[i]) && (!positive || values[i] > 0)) continue;
      fail("scratches", std::string(name) + " of scratch " + std::to_string(i) + " is " + std::to_string(values[i]),
           positive ? "it must be a number above 0" : "it must be a number");
    }
  };
  check(scratches.x0_mm, "x0_mm", false);
  check(scratches.y0_mm, "y0_mm", false);
  check(scratches.x1_mm, "x1_mm", false);
  check(scratches.y1_mm, "y1_mm", false);
  if (!scratches.width_um.empty()) check(scratches.width_um, "width_um", true);
  if (!scratches.depth_um.empty()) check(scratches.depth_um, "depth_um", true);
  if (!scratches.alpha.empty()) check(scratches.alpha, "alpha", true);
}

std::vector<Strip> strips_of(const Scratches& scratches, double shared_width_um, const Material& material) {
  std::vector<Strip> strips(scratches.size());
  const GrooveProfile& profile = material.profile;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    const double width_um = scratches.width_um.empty() ? shared_width_um : scratches.width_um[s];
    const double depth_um = scratches.depth_um.empty() ? material.depth_um : scratches.depth_um[s];
    double half_um = half_width_um(profile, width_um, depth_um);
    if (!profile.is_paper()) {
      const ProfileReach reach = profile_reach(profile, width_um, depth_um);
      half_um = std::max(-reach.left_um, reach.right_um);
    }
    strips[s] = {{scratches.x0_mm[s], scratches.y0_mm[s]}, {scratches.x1_mm[s], scratches.y1_mm[s]}, 1e-3 * half_um};
  }
  return strips;
}

}  // namespace burin
