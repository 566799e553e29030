// burin/capture/photo_look.h - a reduced photo with the measurements for pre-flight and for the grouping of brackets.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "burin/capture/session.h"
#include "burin/capture/tags/seen_tag.h"
#include "burin/scene/board.h"

namespace burin {

/// A reduced photo with two bytes per pixel. Memory holds 2,000 of them together (limit::kPhotos).
struct SmallPhoto {
  static constexpr std::uint16_t kClipped = 65535, kWhite = 65534;

  int width = 0, height = 0;
  std::vector<std::uint16_t> codes;  ///< row by row: code_of() each pixel

  /// Code of a linear value, 1 being the white level: kWhite times its square root, which keeps the digits of shadows.
  static std::uint16_t code_of(double value);
  /// The value behind a code other than kClipped; its relative error is at most 1e-3 from 0.001 on.
  static double value_of(std::uint16_t code);
};

/// Measurements of one photo for the pre-flight check.
struct PhotoLook {
  SmallPhoto small;             ///< mean of the channels, clipped where a pixel behind it is; at most 800 pixels a side
  double scale = 1;             ///< photo pixels per pixel of `small`
  double clipped_fraction = 0;  ///< share of the photo's pixels
  double bright = 0;            ///< 99.5 % quantile of the pixels
  double noise_floor = 0;       ///< the smallest value worth comparing
  std::optional<double> edge_sigma_px;  ///< width of the sharpest edges as a Gaussian; none if there are too few edges
  int width = 0, height = 0;            ///< size of the photo
  std::vector<TagLook> tags;            ///< tags of the board, sorted by id; without ids seen twice
  std::vector<int> stray_tags;          ///< unlisted ids of the board's family, sorted
};

/// Reads the photo, and searches it for the board's tags if given. Throws Error as read_photo does, and for a tag
/// family unknown to AprilTag. May be called from several threads at once.
PhotoLook look_at(const Photo& photo, const TagSet* tags = nullptr);

/// Comparison of two photos, each divided by its exposure factor, where neither is clipped or too dark.
struct Comparison {
  double correlation = 0;  ///< of the logarithm of their details: near 1 for one pose, at any exposures
  double ratio = 1;        ///< median of b's values over a's at the common scale: 1 if the exposures are correct
  double shift_px = 0;     ///< distance of b's picture from a's, photo pixels; valid if the correlation is high
};

/// Nothing if both hold too few common pixels (5 %), if one is all dark, or if sizes differ.
std::optional<Comparison> compare(const PhotoLook& a, double factor_a, const PhotoLook& b, double factor_b);

}  // namespace burin
