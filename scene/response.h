// burin/scene/response.h - what a camera does to its pictures after the sensor: its curve, and its sharpening, both
// undone; and what it made up of colors. docs/model.md 5.11, 5.12.
//
// Stored values s (0 to 1) are those of the sRGB curve bent once more. Undone, with v the value that sRGB alone stores,
//
//   logit(v) = offset + (1 + slope) logit(s) + sum over k of bumps[k] sin((k + 1) pi s),     logit(v) = log(v / (1 -
//   v)).
//
// An S-curve that makes logit(s) - logit(pivot) `contrast` times logit(v) - logit(pivot) has no bumps, 1 + slope = 1 /
// contrast and offset = -slope logit(pivot). Files of linear values bend these in the same way.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "burin/base/image.h"

namespace burin {

/// A camera's curve on top of the sRGB curve (of a linear file: on top of nothing). All zero: none.
struct Response {
  static constexpr std::size_t kBumps = 3;
  double offset = 0, slope = 0;
  std::array<double, kBumps> bumps{};

  bool is_none() const { return offset == 0 && slope == 0 && bumps == std::array<double, kBumps>{}; }
};

/// The value that the plain encoding would have stored for what is stored. 0 and 1 stay. Both lie from 0 to 1.
double unbent(const Response& response, double stored);

/// What is stored of a plainly encoded value: the inverse of unbent(), by bisection. Only of monotonic responses.
double bent(const Response& response, double plain);

/// Whether more light is a larger stored value everywhere from 1/255 to 254/255.
bool is_monotonic(const Response& response);

/// The response that makes an S-curve of that contrast about a pivot from 0 to 1 (both of encoded values).
Response s_curve(double contrast, double pivot);

/// Which pixels of a mosaic of one color a pixel measured green: those whose x + y is even, or odd.
enum class GreenSites { unknown, even, odd };

/// Whether that pixel measured green; every one does where the sites are unknown.
inline bool measured_green(GreenSites sites, int x, int y) {
  return sites == GreenSites::unknown || (x + y) % 2 == (sites == GreenSites::even ? 0 : 1);
}

/// An unsharp mask in stored values: s + amount (Y - G Y), Y the mean of the channels and G a Gaussian. Amount 0: none.
struct Sharpening {
  double amount = 0;
  double sigma_px = 1;  ///< of the Gaussian
};

/// Takes an unsharp mask back: solves s + amount (s - G s) = stored for the mean of the channels and moves all channels
/// alike. Exact but for what was clipped after sharpening. `stored` has 1 or 3 channels and is changed in place.
void unsharpened(const Sharpening& sharpening, Image& stored);

/// Every pixel that did not measure green becomes the mean of the two to four beside it that did, in all channels
/// (docs/model.md 9.24a). Linear values, changed in place. Nothing happens where the sites are unknown.
void keep_green_sites(GreenSites sites, Image& linear);

}  // namespace burin
