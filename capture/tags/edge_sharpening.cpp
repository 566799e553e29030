#include "burin/capture/tags/edge_sharpening.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "burin/base/image.h"
#include "burin/base/median.h"
#include "burin/capture/photo.h"

namespace burin {
namespace {

constexpr double kReach_px = 5, kBin_px = 0.125;
constexpr int kBins = static_cast<int>(2 * kReach_px / kBin_px);

double distance_of(int bin) { return (bin + 0.5) * kBin_px - kReach_px; }

// The mean step across the edges of one photo, from 0 (black, inside) to 1 (white, outside), by the distance from the
// edge.
struct Profile {
  std::array<double, kBins> sum{}, weight{};
  int sides = 0;
  double reach_px = kReach_px;  // range of distances from the sides
};

struct Near {
  double distance, value;
};

// Stored brightness of the pixels around one side, without its ends. Empty if one is clipped.
std::vector<Near> pixels_across(const LinearPhoto& photo, Encoding encoding, const Eigen::Vector2d& from,
                                const Eigen::Vector2d& to, const Eigen::Vector2d& middle, double reach) {
  std::vector<Near> out;
  const Eigen::Vector2d along = (to - from).normalized();
  Eigen::Vector2d outward(-along.y(), along.x());
  if (outward.dot(from - middle) < 0) outward = -outward;
  const double length = (to - from).norm(), from_end = 0.15 * length + reach;
  const Eigen::Vector2d low = from.cwiseMin(to).array() - reach - 1, high = from.cwiseMax(to).array() + reach + 1;
  const Image& image = photo.value;
  if (low.minCoeff() < 0 || high.x() > image.width - 1 || high.y() > image.height - 1) return {};
  for (int y = static_cast<int>(low.y()); y <= static_cast<int>(high.y()); ++y)
    for (int x = static_cast<int>(low.x()); x <= static_cast<int>(high.x()); ++x) {
      const Eigen::Vector2d d = Eigen::Vector2d(x, y) - from;
      const double u = d.dot(along), v = d.dot(outward);
      if (u < from_end || u > length - from_end || std::abs(v) >= reach) continue;
      if (photo.clipped[static_cast<std::size_t>(y) * image.width + x]) return {};
      double sum = 0;
      for (int c = 0; c < image.channels; ++c) {
        const float linear = image.at(x, y, c);
        sum += encoding == Encoding::srgb ? linear_to_srgb(linear) : linear;
      }
      out.push_back({v, sum / image.channels});
    }
  return out;
}

void add_side(const std::vector<Near>& pixels, double reach, Profile& profile) {
  std::vector<double> black, white;
  for (const Near& p : pixels) {
    if (p.distance < -0.4 * reach && p.distance > -0.6 * reach) black.push_back(p.value);
    if (p.distance > 0.65 * reach) white.push_back(p.value);
  }
  constexpr std::size_t kFewest = 6;
  if (black.size() < kFewest || white.size() < kFewest) return;
  const double b = median_of(black), w = median_of(white);
  constexpr double kLeastStep = 0.25, kDarkest = 0.06, kBrightest = 0.93;  // stored
  if (w - b < kLeastStep || b < kDarkest || w > kBrightest) return;
  for (const Near& p : pixels) {
    const int bin = static_cast<int>((p.distance + kReach_px) / kBin_px);
    if (bin < 0 || bin >= kBins) continue;
    profile.sum[bin] += (p.value - b) / (w - b);
    profile.weight[bin] += 1;
  }
  ++profile.sides;
}

std::optional<Profile> profile_of(const EdgePhoto& given, int border_cells) {
  Photo plain = given.photo;
  plain.response = {};
  plain.balance.setOnes();
  const LinearPhoto photo = read_photo(plain);
  Profile out;
  std::vector<double> cells;
  for (const TagDetection& tag : given.tags)
    cells.push_back((tag.corner_px[1] - tag.corner_px[0]).norm() / border_cells);
  const double cell = median_of(cells);
  constexpr double kSmallestCell_px = 4.5;
  if (cell < kSmallestCell_px) return std::nullopt;
  out.reach_px = std::min(kReach_px, 0.8 * cell);
  for (const TagDetection& tag : given.tags) {
    const Eigen::Vector2d middle = (tag.corner_px[0] + tag.corner_px[1] + tag.corner_px[2] + tag.corner_px[3]) / 4;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector2d &from = tag.corner_px[i], &to = tag.corner_px[(i + 1) % 4];
      const double own_cell = (to - from).norm() / border_cells;
      if (own_cell < 0.85 * cell || own_cell > 1.2 * cell) continue;
      add_side(pixels_across(photo, plain.encoding, from, to, middle, out.reach_px), out.reach_px, out);
    }
  }
  constexpr int kFewestSides = 8;
  if (out.sides < kFewestSides) return std::nullopt;
  return out;
}

// Mean of a profile between two distances on the white side; NaN without pixels.
double mean_between(const Profile& p, double from_px, double to_px) {
  double sum = 0, weight = 0;
  for (int i = 0; i < kBins; ++i)
    if (distance_of(i) > from_px && distance_of(i) < to_px) {
      sum += p.sum[i];
      weight += p.weight[i];
    }
  return sum / weight;
}

}  // namespace

EdgeSharpening edge_sharpening(std::span<const EdgePhoto> photos, int border_cells) {
  EdgeSharpening out;
  std::vector<double> overshoots;
  for (const EdgePhoto& photo : photos) {
    const auto profile = profile_of(photo, border_cells);
    if (!profile) continue;
    // A blur alone is monotonic: near paper is not brighter than paper further out.
    const double far = mean_between(*profile, 0.65 * profile->reach_px, profile->reach_px);
    double highest = 0;
    for (const double from : {1.0, 1.25, 1.5, 1.75, 2.0})
      highest = std::max(highest, mean_between(*profile, from, from + 0.75));
    if (std::isfinite(far) && std::isfinite(highest)) overshoots.push_back(highest - far);
  }
  out.photos = static_cast<int>(overshoots.size());
  constexpr int kFewestPhotos = 3;
  if (out.photos < kFewestPhotos) return out;
  const MedianAndError usual = median_and_error(overshoots);
  out.overshoot = usual.median;
  out.overshoot_sigma = usual.sigma;
  constexpr double kLeast = 0.006, kSigmas = 3;
  out.is_seen = out.overshoot > kLeast && out.overshoot > kSigmas * out.overshoot_sigma;
  return out;
}

}  // namespace burin
