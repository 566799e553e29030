// burin/scene/response.h - processing after the sensor: camera response function and sharpening, both inverted, and
// demosaiced colors. docs/model.md 5.11, 5.12.
//
// Stored values s (0 to 1) are values of the sRGB curve with one further curve on top. Its inverse, with v the value of
// sRGB alone, is
//
//   logit(v) = offset + (1 + slope) logit(s) + sum over k of bumps[k] sin((k + 1) pi s),
//   logit(v) = log(v / (1 - v)).
//
// An S-curve makes logit(s) - logit(pivot) `contrast` times logit(v) - logit(pivot). It has no bumps, 1 + slope = 1 /
// contrast and offset = -slope logit(pivot). For files of linear values, the curve applies to these in the same way.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "burin/base/image.h"

namespace burin {

/// A camera's curve on top of the sRGB curve (on a linear file: on top of nothing). All zero: none.
struct Response {
  static constexpr std::size_t kBumps = 3;
  double offset = 0, slope = 0;
  std::array<double, kBumps> bumps{};

  /// True for the identity.
  bool is_none() const { return offset == 0 && slope == 0 && bumps == std::array<double, kBumps>{}; }
};

/// The plainly encoded value of a stored one. 0 and 1 stay fixed. Both are from 0 to 1.
double unbent(const Response& response, double stored);

/// The stored value of a plainly encoded one: the inverse of unbent(), by bisection. Only for monotonic responses.
double bent(const Response& response, double plain);

/// True if the stored value increases with light everywhere from 1/255 to 254/255.
bool is_monotonic(const Response& response);

/// The response of an S-curve with that contrast about a pivot from 0 to 1 (both in encoded values).
Response s_curve(double contrast, double pivot);

/// Green sites of a color filter array: pixels with even or odd x + y.
enum class GreenSites { unknown, even, odd };

/// True if that pixel measured green; with unknown sites every pixel did.
inline bool measured_green(GreenSites sites, int x, int y) {
  return sites == GreenSites::unknown || (x + y) % 2 == (sites == GreenSites::even ? 0 : 1);
}

/// An unsharp mask in stored values: s + amount (Y - G Y). Y is the mean of the channels and G a Gaussian. Amount 0:
/// none.
struct Sharpening {
  double amount = 0;
  double sigma_px = 1;  ///< of the Gaussian
};

/// Inverts an unsharp mask: solves s + amount (s - G s) = stored for the mean of the channels and moves all channels
/// alike. Exact except for values clipped after sharpening. `stored` has 1 or 3 channels and is changed in place.
void unsharpened(const Sharpening& sharpening, Image& stored);

/// Replaces every pixel that did not measure green by the mean of its two to four neighbors that did, in all channels
/// (docs/model.md 9.24a). Linear values, changed in place. Unknown sites leave the image unchanged.
void keep_green_sites(GreenSites sites, Image& linear);

}  // namespace burin
