// burin/capture/tags/tag_detector.h - AprilTags in a photo, with corners accurate to about 0.015 px.
//
// AprilTag finds and decodes the tags on an 8-bit, gamma-compressed copy. Each corner is then measured on the linear
// values (docs/model.md 9, 'Corners'). An edge with one blur, one black and one white level is fitted along each side,
// to the pixels within half a module of the side without its corners. Neighboring sides are intersected. Pixels: the
// center of the top-left pixel is (0, 0). AprilTag's own convention has it at (0.5, 0.5): converted here.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "burin/base/image.h"
#include "burin/capture/tags/tag_fault.h"

namespace burin {

/// One tag in one photo. Corners in AprilTag's order for an upright tag: lower-left, lower-right, upper-right,
/// upper-left, the order of tag_corners_mm().
struct TagDetection {
  int id = 0;
  int hamming = 0;                           ///< number of corrected bits
  double decision_margin = 0;                ///< AprilTag's contrast between bits, of 255
  std::array<Eigen::Vector2d, 4> coarse_px;  ///< AprilTag's own (about 0.04 px RMS)
  std::array<Eigen::Vector2d, 4> corner_px;  ///< refined
  std::array<double, 4> corner_sigma_px{};   ///< per axis, from the noise of the pixels alone
  double blur_px = 0;                        ///< Gaussian width of the edges, the pixel's own square included
  std::array<double, 4> side_blur_px{};      ///< blur of each side; side i runs from corner i to corner i + 1
};

/// Tags found in one photo, and seen but unused ones.
struct TagsInPhoto {
  std::vector<TagDetection> tags;  ///< sorted by id
  std::vector<RejectedTag> rejected;
};

/// Limits for accepted tags.
struct TagDetectorOptions {
  int max_hamming = 1;
  double min_decision_margin = 20;
  double half_resolution_above_mpx = 4;  ///< photos with more megapixels are searched at half their resolution
  double min_side_px = 12;               ///< shorter sides cannot be refined
  /// Largest distance of a refined corner of a clean tag from AprilTag's (or 3 % of a side).
  double max_shift_px = 1.5;
};

/// Finds the tags of one family. It owns AprilTag's tables (tens of MB), so use one detector for all photos. Not for
/// use from two threads at once. Same photo, same result.
class TagDetector {
 public:
  /// Throws Error for a family unknown to libapriltag, with a list of the known ones.
  explicit TagDetector(const std::string& family, const TagDetectorOptions& options = {});
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;
  TagDetector& operator=(TagDetector&&) noexcept;

  /// Tags in a linear picture (1 or 3 channels, any scale). `valid`: width * height, 0 where a pixel is clipped or
  /// unusable; empty if all are good. Returns tags with an id in `ids` (all, if empty), and none with an id seen twice.
  TagsInPhoto detect(const Image& linear, std::span<const std::uint8_t> valid, std::span<const int> ids);

  /// Measures tags that were `found` already, for example in a smaller copy: coarse_px in pixels of this picture.
  TagsInPhoto measure(const Image& linear, std::span<const std::uint8_t> valid, std::span<const int> ids,
                      std::vector<TagDetection> found);

  /// AprilTag alone on an 8-bit picture: unfiltered, coarse corners (corner_px = coarse_px), pixel convention
  /// converted.
  std::vector<TagDetection> detect_coarse(std::span<const std::uint8_t> gray, int width, int height);

  /// AprilTag alone on a linear picture, gamma-compressed, its brightest half percent `brighter` times white.
  std::vector<TagDetection> detect_coarse(const Image& linear, double brighter = 1);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The calling thread's detector of that family, kept until the thread requests another family: its tables take time to
/// make. Throws Error as TagDetector's constructor does.
TagDetector& detector_of_this_thread(const std::string& family);

/// The end of a sentence for a photo without tags of `family`: its actual content, e.g. "it holds 19 tags of family
/// tag36h11" or "it is mirrored: flip it"; empty if there is none.
std::string explain_missing_tags(const Image& linear, std::span<const std::uint8_t> valid, const std::string& family);

/// Bias of TagDetector's line fit at the corners of a square whose sides the lens curves: fitted minus true corners.
/// Subtract it from corner_px. `project_side(i, t)`: pixel of the point at fraction t from corner i to corner i + 1.
template <typename ProjectSide>
std::array<Eigen::Vector2d, 4> curved_side_bias_px(const ProjectSide& project_side, double skip_fraction) {
  // Lines through sampled sides by least squares, as offsets (c0 + c1 u) from the chord, u in [-1, 1].
  constexpr int kSamples = 17;
  std::array<Eigen::Vector2d, 4> p, point, direction, bias;
  for (int i = 0; i < 4; ++i) p[i] = project_side(i, 0.0);
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = p[i], b = p[(i + 1) % 4], along = (b - a).normalized(), across(-along.y(), along.x());
    double s0 = 0, s1 = 0, u2 = 0;
    const double length = (b - a).norm(), reach = 0.5 - skip_fraction;
    for (int k = 0; k < kSamples; ++k) {
      const double u = 2.0 * k / (kSamples - 1) - 1;
      const Eigen::Vector2d d = project_side(i, 0.5 + reach * u) - a;
      s0 += d.dot(across);
      s1 += u * d.dot(across);
      u2 += u * u;
    }
    const double offset = s0 / kSamples, slope = s1 / u2 / (reach * length);
    point[i] = 0.5 * (a + b) + offset * across;
    direction[i] = along + slope * across;
  }
  for (int i = 0; i < 4; ++i) {  // corner i lies on sides i - 1 and i
    const int j = (i + 3) % 4;
    Eigen::Matrix2d m;
    m << direction[j], -direction[i];
    const Eigen::Vector2d t = m.inverse() * (point[i] - point[j]);
    bias[i] = point[j] + t[0] * direction[j] - p[i];
  }
  return bias;
}

/// Fraction of a side left out of the line fit at each end, for a family (0.6 module).
double side_skip_fraction(const std::string& family);

}  // namespace burin
