#include "burin/capture/green_sites.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "burin/base/median.h"
#include "burin/capture/photo.h"

namespace burin {
namespace {

constexpr int kBlock_px = 64;

// Adds the logarithm of a ratio of fine detail: that of pixels with even x + y over that of the others. Detail is the
// squared difference between a pixel and the mean of its four neighbors. Adds nothing if the block is as smooth as its
// file's levels.
void add_block(const Image& stored, int x0, int y0, std::vector<double>& log_ratios) {
  std::array<double, 2> sum{};
  for (int y = y0; y < y0 + kBlock_px; ++y)
    for (int x = x0; x < x0 + kBlock_px; ++x) {
      const double around = stored.at(x - 1, y) + stored.at(x + 1, y) + stored.at(x, y - 1) + stored.at(x, y + 1);
      const double detail = stored.at(x, y) - around / 4;
      sum[(x + y) % 2] += detail * detail;
    }
  constexpr double kLeast = 1.5 / 255 / 255;  // per pixel: above the rounding error
  if (sum[0] + sum[1] > kLeast * kBlock_px * kBlock_px && sum[0] > 0 && sum[1] > 0)
    log_ratios.push_back(std::log(sum[0] / sum[1]));
}

// False for a photo without colors.
bool add_photo(const Photo& photo, std::vector<double>& log_ratios) {
  Photo plain = photo;
  plain.green_sites = GreenSites::unknown;
  const LinearPhoto read = read_photo(plain);
  const Image& v = read.value;
  if (v.channels != 3) return false;
  Image stored(v.width, v.height, 1);
  tbb::parallel_for(0, v.height, [&](int y) {
    for (int x = 0; x < v.width; ++x)
      stored.at(x, y) =
          (linear_to_srgb(v.at(x, y, 0)) + linear_to_srgb(v.at(x, y, 1)) + linear_to_srgb(v.at(x, y, 2))) / 3;
  });
  for (int y = 1; y + kBlock_px < v.height; y += kBlock_px)
    for (int x = 1; x + kBlock_px < v.width; x += kBlock_px) add_block(stored, x, y, log_ratios);
  return true;
}

constexpr double kLeastDetail = 0.04, kSigmas = 6;

GreenSitesFound judged(const std::vector<double>& log_ratios) {
  constexpr std::size_t kFewestBlocks = 16;
  GreenSitesFound found;
  if (log_ratios.size() < kFewestBlocks) return found;
  const MedianAndError ratio = median_and_error(log_ratios);
  found.detail = std::abs(ratio.median);
  found.detail_sigma = ratio.sigma;
  if (found.detail > kLeastDetail && found.detail > kSigmas * found.detail_sigma)
    found.sites = ratio.median > 0 ? GreenSites::even : GreenSites::odd;
  return found;
}

}  // namespace

GreenSitesFound find_green_sites(std::span<const Photo> photos) {
  constexpr std::size_t kMostPhotos = 4;
  std::vector<const Photo*> used;
  for (const Photo& photo : photos)
    if (photo.encoding != Encoding::raw) used.push_back(&photo);
  std::vector<double> log_ratios;
  GreenSitesFound found;
  const std::size_t count = std::min(kMostPhotos, used.size());
  for (std::size_t i = 0; i < count; ++i) {
    if (!add_photo(*used[i * used.size() / count], log_ratios)) break;
    found = judged(log_ratios);
    // A large photo without a filter array suffices as evidence; one with it needs a second that agrees.
    const bool none = found.detail_sigma > 0 && found.detail + kSigmas * found.detail_sigma < kLeastDetail;
    if (none || (i > 0 && found.sites != GreenSites::unknown)) break;
  }
  return found;
}

}  // namespace burin
