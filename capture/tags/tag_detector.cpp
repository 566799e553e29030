#include "burin/capture/tags/tag_detector.h"

#include <apriltag/apriltag.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/limits.h"
#include "burin/base/median.h"
#include "burin/capture/tags/tag_family.h"

namespace burin {
namespace {

constexpr double kSkipModules = 0.6;     // at each end of a side: the neighboring side's blur reaches that far
constexpr double kStripModules = 0.5;    // half-width of the strip of pixels around a side
constexpr double kSeedStripPx = 12;      // for the first, rough estimate of a side
constexpr double kMaxStripPx = 4;        // wider strips add paper, not edge (but for blurred photos: kStripBlurs)
constexpr double kStripBlurs = 4;        // half-width of the strip in units of the edge's blur, if larger
constexpr double kMinStripPx = 1.5;      // narrower ones hold too few pixels
constexpr double kRoughSides = 0.03;     // of a side: AprilTag's error in large photos, searched at half resolution
constexpr double kAprilTagCenter = 0.5;  // AprilTag has a pixel's center at +0.5, Burin at 0

constexpr const char* kFamilyField = "board.json: tags.family";

// libapriltag's decoding table has one entry per code and correctable pattern of wrong bits. For the large families,
// two corrected bits would take gigabytes.
int affordable_bits(const apriltag_family_t& family, int wanted) {
  const double n = family.nbits;
  int bits = std::min(wanted, 2);
  while (bits > 0 && family.ncodes * (bits == 2 ? 1 + n + n * (n - 1) / 2 : 1 + n) > 4e6) --bits;
  return bits;
}

struct Gray {
  int width, height;
  std::vector<float> value;
  float at(int x, int y) const { return value[static_cast<std::size_t>(y) * width + x]; }
};

Gray to_gray(const Image& image) {
  Gray g{image.width, image.height, {}};
  g.value.resize(static_cast<std::size_t>(image.width) * image.height);
  const int n = image.channels;
  for (std::size_t i = 0; i < g.value.size(); ++i) {
    float sum = 0;
    for (int c = 0; c < n; ++c) sum += image.data[i * n + c];
    g.value[i] = sum / static_cast<float>(n);
  }
  return g;
}

// 255 (v / white)^(1 / 2.2): AprilTag thresholds locally; gamma restores the contrast of shadowed tags.
std::vector<std::uint8_t> compressed(const Gray& gray, double white) {
  static const std::vector<std::uint8_t> curve = [] {
    std::vector<std::uint8_t> table(65536);
    for (std::size_t i = 0; i < table.size(); ++i)
      table[i] = static_cast<std::uint8_t>(std::lround(255 * std::pow(static_cast<double>(i) / 65535, 1 / 2.2)));
    return table;
  }();
  std::vector<std::uint8_t> out(gray.value.size());
  const float scale = static_cast<float>(65535 / white);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float v = gray.value[i] * scale;
    out[i] = v < 65535.0F ? (v > 0 ? curve[static_cast<std::size_t>(v)] : std::uint8_t{0})
                          : std::uint8_t{255};  // NaN: white
  }
  return out;
}

double bright_end(const Gray& gray) {
  std::vector<float> finite;
  finite.reserve(gray.value.size() / 4 + 1);
  for (std::size_t i = 0; i < gray.value.size(); i += 4)
    if (std::isfinite(gray.value[i])) finite.push_back(gray.value[i]);
  if (finite.empty()) return 1;
  return std::max<double>(quantile_in_place(finite, 0.995), 1e-12);
}

// One measured side of a tag: points q with (q - mid) . across = offset + slope * (q - mid) . along.
struct Side {
  Eigen::Vector2d mid, along, across;
  double offset = 0, slope = 0;
  Eigen::Matrix2d covariance;  // of (offset, slope)
  double blur_px = 0;
};

enum class SideFault { none, clipped, no_edge };

/// A pixel of the strip along a side: t along it, s across it, from its middle.
struct StripPixel {
  double s, t, value;
};

/// The current estimate of an edge: s = offset + slope t, blurred by a Gaussian of `blur` px.
struct EdgeEstimate {
  double offset = 0, slope = 0, blur = 0.8;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  // of (offset, slope)
};

/// The pixels within `reach` along the side and `half_strip` across the edge, and the number of unusable ones.
std::vector<StripPixel> strip_pixels(const Gray& gray, std::span<const std::uint8_t> valid, const Side& side,
                                     const EdgeEstimate& edge, double reach, double half_strip, int& unusable) {
  std::vector<StripPixel> pixels;
  unusable = 0;
  const double rx = std::abs(side.along.x()) * reach + half_strip + 2,
               ry = std::abs(side.along.y()) * reach + half_strip + 2;
  const int x0 = std::max(0, static_cast<int>(std::floor(side.mid.x() - rx))),
            x1 = std::min(gray.width - 1, static_cast<int>(std::ceil(side.mid.x() + rx)));
  const int y0 = std::max(0, static_cast<int>(std::floor(side.mid.y() - ry))),
            y1 = std::min(gray.height - 1, static_cast<int>(std::ceil(side.mid.y() + ry)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const Eigen::Vector2d d = Eigen::Vector2d(x, y) - side.mid;
      const double t = d.dot(side.along), s = d.dot(side.across);
      if (std::abs(t) > reach || std::abs(s - edge.offset - edge.slope * t) > half_strip) continue;
      const std::size_t i = static_cast<std::size_t>(y) * gray.width + x;
      if ((!valid.empty() && !valid[i]) || !std::isfinite(gray.value[i])) {
        ++unusable;
        continue;
      }
      pixels.push_back({s, t, gray.value[i]});
    }
  return pixels;
}

/// Fits I(s, t) = (k0 + k1 t) + ((w0 + w1 t) - (k0 + k1 t)) Phi((s - offset - slope t) / blur) to pixels by
/// Gauss-Newton with Huber-like weights. False if there is no edge.
bool fit_edge(const std::vector<StripPixel>& pixels, double reach, EdgeEstimate& edge) {
  constexpr int kIterations = 10;
  // Initial levels: the means of the two halves.
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (const StripPixel& p : pixels) {
    const int h = p.s - edge.offset - edge.slope * p.t > 0 ? 1 : 0;
    sum[h] += p.value;
    ++count[h];
  }
  if (count[0] < 6 || count[1] < 6) return false;
  double k0 = sum[0] / count[0], w0 = sum[1] / count[1], k1 = 0, w1 = 0;
  if (!(std::abs(w0 - k0) > 0.05 * std::max(std::abs(w0), std::abs(k0)))) return false;

  double scale = 0.25 * std::abs(w0 - k0);  // of the residuals, for the weights
  Eigen::Matrix<double, 7, 7> JtJ;
  double chi2 = 0, weight_sum = 0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    JtJ.setZero();
    Eigen::Matrix<double, 7, 1> Jtr = Eigen::Matrix<double, 7, 1>::Zero();
    chi2 = weight_sum = 0;
    std::vector<double> absolute;
    absolute.reserve(pixels.size());
    for (const StripPixel& p : pixels) {
      const double u = (p.s - edge.offset - edge.slope * p.t) / edge.blur, tn = p.t / reach;
      const double Phi = 0.5 * std::erfc(-u / std::sqrt(2.0)),
                   phi = std::exp(-0.5 * u * u) / std::sqrt(2 * std::numbers::pi);
      const double k = k0 + k1 * tn, w = w0 + w1 * tn, c = w - k;
      const double r = p.value - (k + c * Phi);
      Eigen::Matrix<double, 7, 1> J;
      J << -c * phi / edge.blur, -c * phi / edge.blur * p.t, -c * phi * u, 1 - Phi, (1 - Phi) * tn, Phi, Phi * tn;
      const double weight = std::abs(r) < 2 * scale ? 1 : 2 * scale / std::abs(r);
      JtJ += weight * J * J.transpose();
      Jtr += weight * r * J;
      chi2 += weight * r * r;
      weight_sum += weight;
      absolute.push_back(std::abs(r));
    }
    const Eigen::Matrix<double, 7, 1> step = JtJ.ldlt().solve(Jtr);
    if (!step.allFinite()) return false;
    edge.offset += std::clamp(step[0], -0.7, 0.7);
    edge.slope += std::clamp(step[1], -0.1, 0.1);
    edge.blur = std::clamp(edge.blur + std::clamp(step[2], -0.4, 0.4), 0.25, 20.0);
    k0 += step[3];
    k1 += step[4];
    w0 += step[5];
    w1 += step[6];
    scale = std::max(1.48 * median_in_place(absolute), 1e-4 * std::abs(w0 - k0));
    if (iteration > 2 && std::abs(step[0]) < 1e-4 && std::abs(step[1]) * reach < 1e-4) break;
  }
  const double variance = chi2 / std::max(1.0, weight_sum - 7);
  edge.covariance = (variance * JtJ.inverse()).topLeftCorner<2, 2>();
  return true;
}

/// Measures the side from a to b. The strip of the edge fit follows the line estimate, so pixels on both sides stay
/// balanced.
SideFault fit_side(const Gray& gray, std::span<const std::uint8_t> valid, const Eigen::Vector2d& a,
                   const Eigen::Vector2d& b, double modules_per_side, Side& side) {
  const double length = (b - a).norm(), module = length / modules_per_side;
  const double reach = length / 2 - kSkipModules * module;
  side.mid = 0.5 * (a + b);
  side.along = (b - a) / length;
  side.across = {-side.along.y(), side.along.x()};

  constexpr int kPasses = 3;
  EdgeEstimate edge;
  const double widest = std::max(kMinStripPx, kStripModules * module), limit = std::max(3.0, kRoughSides * length);
  for (int pass = 0; pass < kPasses; ++pass) {
    const double half_strip =
        std::clamp(pass == 0 ? kSeedStripPx : std::max(kMaxStripPx, kStripBlurs * edge.blur), kMinStripPx, widest);
    if (pass == 0) edge.blur = std::max(0.8, half_strip / 5);
    int unusable = 0;
    const std::vector<StripPixel> pixels = strip_pixels(gray, valid, side, edge, reach, half_strip, unusable);
    if (unusable > static_cast<int>(pixels.size()) / 8) return SideFault::clipped;
    if (pixels.size() < 16 || !fit_edge(pixels, reach, edge)) return SideFault::no_edge;
    if (std::abs(edge.offset) > limit || std::abs(edge.slope) > 0.3) return SideFault::no_edge;
  }
  if (!edge.covariance.allFinite()) return SideFault::no_edge;
  side.offset = edge.offset;
  side.slope = edge.slope;
  side.blur_px = edge.blur;
  side.covariance = edge.covariance;
  return SideFault::none;
}

// The intersection of two sides, and its sigma.
bool intersect(const Side& a, const Side& b, Eigen::Vector2d& q, double& sigma) {
  // n . q = m for each line, with n = across - slope along
  const Eigen::Vector2d na = a.across - a.slope * a.along, nb = b.across - b.slope * b.along;
  Eigen::Matrix2d N;
  N << na.transpose(), nb.transpose();
  if (std::abs(N.determinant()) < 0.1) return false;
  q = N.inverse() * Eigen::Vector2d(na.dot(a.mid) + a.offset, nb.dot(b.mid) + b.offset);
  // d(n . q) = d offset + t d slope at t = (q - mid) . along
  auto variance = [&q](const Side& s) {
    const Eigen::Vector2d g(1, (q - s.mid).dot(s.along));
    return g.dot(s.covariance * g);
  };
  const Eigen::Matrix2d M = N.inverse();
  const Eigen::Matrix2d C = M * Eigen::Vector2d(variance(a), variance(b)).asDiagonal() * M.transpose();
  sigma = std::sqrt(0.5 * C.trace());
  return std::isfinite(sigma) && q.allFinite();
}

// Nothing if the corners were refined, else the reason.
std::optional<TagFault> refine(const Gray& gray, std::span<const std::uint8_t> valid, double modules,
                               const TagDetectorOptions& options, TagDetection& tag) {
  std::array<Side, 4> sides;
  double blur = 0;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d &a = tag.coarse_px[i], &b = tag.coarse_px[(i + 1) % 4];
    if ((b - a).norm() < options.min_side_px) return TagFault::small;
    switch (fit_side(gray, valid, a, b, modules, sides[i])) {
      case SideFault::clipped:
        return TagFault::clipped;
      case SideFault::no_edge:
        return TagFault::covered;
      case SideFault::none:
        break;
    }
    tag.side_blur_px[i] = sides[i].blur_px;
    blur += sides[i].blur_px / 4;
  }
  for (int i = 0; i < 4; ++i) {
    if (!intersect(sides[(i + 3) % 4], sides[i], tag.corner_px[i], tag.corner_sigma_px[i])) return TagFault::no_corners;
    const double side = (tag.coarse_px[(i + 1) % 4] - tag.coarse_px[i]).norm();
    if ((tag.corner_px[i] - tag.coarse_px[i]).norm() > std::max({options.max_shift_px, kRoughSides * side, 1.5 * blur}))
      return TagFault::shifted;
  }
  tag.blur_px = blur;
  return std::nullopt;
}

// Measures found tags: corners of the usable ones, and reasons for the others.
template <typename Wanted>
TagsInPhoto measured_tags(const Gray& gray, std::span<const std::uint8_t> valid, std::vector<TagDetection> found,
                          const Wanted& wanted, const TagDetectorOptions& options, double modules) {
  TagsInPhoto out;
  std::map<int, int> times;
  for (const TagDetection& tag : found) ++times[tag.id];
  for (TagDetection& tag : found) {
    const auto& p = tag.coarse_px;
    const Eigen::Vector2d center = 0.25 * (p[0] + p[1] + p[2] + p[3]);
    auto reject = [&](TagFault fault) { out.rejected.push_back({tag.id, center, fault}); };
    if (!wanted(tag.id)) {
      reject(TagFault::unlisted);
      continue;
    }
    if (tag.decision_margin < options.min_decision_margin) {
      reject(TagFault::unreadable);
      continue;
    }
    if (times[tag.id] > 1) {
      reject(TagFault::repeated);
      out.rejected.back().measured = times[tag.id];
      continue;
    }
    double low = 1e9, side = 0;
    for (int c = 0; c < 4; ++c) {
      low = std::min({low, p[c].x(), p[c].y(), gray.width - 1 - p[c].x(), gray.height - 1 - p[c].y()});
      side = std::max(side, (p[(c + 1) % 4] - p[c]).norm());
    }
    if (low < std::max(2.0, 0.5 * side / modules)) {
      reject(TagFault::at_edge);
      continue;
    }
    if (const auto fault = refine(gray, valid, modules, options, tag)) {
      reject(*fault);
      continue;
    }
    out.tags.push_back(tag);
  }
  std::sort(out.tags.begin(), out.tags.end(), [](const TagDetection& a, const TagDetection& b) { return a.id < b.id; });
  return out;
}

}  // namespace

double side_skip_fraction(const std::string& family) {
  return kSkipModules / make_tag_family(family, kFamilyField)->width_at_border;
}

struct TagDetector::State {
  TagDetectorOptions options;
  TagFamily family;  // outlives the detector, which points at it
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector{apriltag_detector_create(),
                                                                                apriltag_detector_destroy};
};

TagDetector::TagDetector(const std::string& family, const TagDetectorOptions& options)
    : state_(new State{options, make_tag_family(family, kFamilyField)}) {
  apriltag_detector_add_family_bits(state_->detector.get(), state_->family.get(),
                                    affordable_bits(*state_->family, options.max_hamming));
  state_->detector->nthreads = 1;  // the same result on every machine
}

TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;

std::vector<TagDetection> TagDetector::detect_coarse(std::span<const std::uint8_t> gray, int width, int height) {
  if (std::min(width, height) < limit::kLeastPhotoSide) return {};  // libapriltag reads past the rows of smaller images
  if (std::max(width, height) > limit::kPhotoSide)                  // and ends the program for larger ones
    fail("a photo of " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
         "has a side of more than " + std::to_string(limit::kPhotoSide) + ", which no tag can be searched in",
         "make it smaller with another program (docs/limits.md)");
  const bool half = 1e-6 * width * height > state_->options.half_resolution_above_mpx;
  state_->detector->quad_decimate = half ? 2.0F : 1.0F;
  // At half resolution AprilTag's corners are uncertain by half a pixel (its convention changed with 3.4.3). Edges
  // refined in the photo itself are not.
  state_->detector->refine_edges = half;
  // AprilTag only reads; its image type has no const.
  image_u8_t image = {width, height, width, const_cast<std::uint8_t*>(gray.data())};
  zarray_t* found = apriltag_detector_detect(state_->detector.get(), &image);
  std::vector<TagDetection> tags;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* d = nullptr;
    zarray_get(found, i, static_cast<void*>(&d));
    TagDetection tag;
    tag.id = d->id;
    tag.hamming = d->hamming;
    tag.decision_margin = d->decision_margin;
    for (int c = 0; c < 4; ++c) tag.coarse_px[c] = {d->p[c][0] - kAprilTagCenter, d->p[c][1] - kAprilTagCenter};
    tag.corner_px = tag.coarse_px;
    tags.push_back(tag);
  }
  apriltag_detections_destroy(found);
  std::sort(tags.begin(), tags.end(), [](const TagDetection& a, const TagDetection& b) {
    return std::tuple(a.id, a.coarse_px[0].x(), a.coarse_px[0].y()) <
           std::tuple(b.id, b.coarse_px[0].x(), b.coarse_px[0].y());
  });
  return tags;
}

std::vector<TagDetection> TagDetector::detect_coarse(const Image& linear, double brighter) {
  const Gray gray = to_gray(linear);
  return detect_coarse(compressed(gray, bright_end(gray) / brighter), gray.width, gray.height);
}

TagsInPhoto TagDetector::detect(const Image& linear, std::span<const std::uint8_t> valid, std::span<const int> ids) {
  const TagDetectorOptions& options = state_->options;
  const Gray gray = to_gray(linear);
  const double white = bright_end(gray), modules = state_->family->width_at_border;

  // A highlight may be a hundred times brighter than paper: search again with more brightness until every tag of the
  // board is found.
  std::vector<TagDetection> found;
  std::set<int> have;
  auto wanted = [&ids](int id) { return ids.empty() || std::find(ids.begin(), ids.end(), id) != ids.end(); };
  for (const double exposure : {1.0, 8.0, 64.0}) {
    for (const TagDetection& tag : detect_coarse(compressed(gray, white / exposure), gray.width, gray.height)) {
      const Eigen::Vector2d center = 0.25 * (tag.coarse_px[0] + tag.coarse_px[1] + tag.coarse_px[2] + tag.coarse_px[3]);
      if (tag.hamming > options.max_hamming) continue;
      if (tag.decision_margin < options.min_decision_margin && exposure < 64) continue;
      // A tag found in a darker copy is already known; another tag with its id is an ambiguity and must be kept.
      const bool known = std::any_of(found.begin(), found.end(), [&](const TagDetection& f) {
        const double side = (f.coarse_px[1] - f.coarse_px[0]).norm();
        return f.id == tag.id &&
               (0.25 * (f.coarse_px[0] + f.coarse_px[1] + f.coarse_px[2] + f.coarse_px[3]) - center).norm() < side;
      });
      if (!known) found.push_back(tag);
      if (wanted(tag.id)) have.insert(tag.id);
    }
    if (!ids.empty() && have.size() == ids.size()) break;
    if (ids.empty() && !have.empty()) break;
    if (exposure > 1 && have.size() >= 4) break;
  }

  return measured_tags(gray, valid, std::move(found), wanted, options, modules);
}

TagsInPhoto TagDetector::measure(const Image& linear, std::span<const std::uint8_t> valid, std::span<const int> ids,
                                 std::vector<TagDetection> found) {
  const auto wanted = [&ids](int id) { return ids.empty() || std::find(ids.begin(), ids.end(), id) != ids.end(); };
  return measured_tags(to_gray(linear), valid, std::move(found), wanted, state_->options,
                       state_->family->width_at_border);
}

std::string explain_missing_tags(const Image& linear, std::span<const std::uint8_t> valid, const std::string& family) {
  // Exact codes only: with error correction the small families find tags in any texture.
  TagDetectorOptions strict;
  strict.max_hamming = 0;
  strict.min_decision_margin = 40;
  std::size_t best = 2;  // two "tags" may be chance
  std::string name;
  for (const char* other : tag_families()) {
    if (other == family) continue;
    TagDetector detector(other, strict);
    const std::size_t n = detector.detect(linear, valid, {}).tags.size();
    if (n > best) {
      best = n;
      name = other;
    }
  }
  if (!name.empty()) return "it holds " + counted(static_cast<std::size_t>(best), "tag") + " of family " + name;
  Image mirrored = linear;
  for (int y = 0; y < linear.height; ++y)
    for (int x = 0; x < linear.width; ++x)
      for (int c = 0; c < linear.channels; ++c) mirrored.at(linear.width - 1 - x, y, c) = linear.at(x, y, c);
  if (TagDetector(family, strict).detect(mirrored, {}, {}).tags.size() > 2) return "it is mirrored: flip it back";
  return {};
}

TagDetector& detector_of_this_thread(const std::string& family) {
  thread_local std::string made_for;
  thread_local std::optional<TagDetector> detector;
  if (!detector || made_for != family) {
    detector.emplace(family);
    made_for = family;
  }
  return *detector;
}

}  // namespace burin
