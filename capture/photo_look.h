// burin/capture/photo_look.h - a photo at a glance: small, and what pre-flight and the grouping of brackets need to
// know.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "burin/capture/session.h"
#include "burin/capture/tags/seen_tag.h"
#include "burin/scene/board.h"

namespace burin {

/// A photo made small, two bytes a pixel: those of 2,000 photos are in memory together (limit::kPhotos).
struct SmallPhoto {
  static constexpr std::uint16_t kClipped = 65535, kWhite = 65534;

  int width = 0, height = 0;
  std::vector<std::uint16_t> codes;  ///< row by row: code_of() each pixel

  /// Of a linear value, 1 the white level: kWhite times its square root, so that shadows keep their digits.
  static std::uint16_t code_of(double value);
  /// The value behind a code other than kClipped: within 1e-3 of what it was from 0.001 on.
  static double value_of(std::uint16_t code);
};

/// What the pre-flight looks at in one photo.
struct PhotoLook {
  SmallPhoto small;             ///< mean of the channels, clipped where a pixel behind it is; at most 800 pixels a side
  double scale = 1;             ///< photo pixels per pixel of `small`
  double clipped_fraction = 0;  ///< of the photo's pixels
  double bright = 0;            ///< value that 0.5 % of the pixels exceed
  double noise_floor = 0;       ///< the smallest value worth comparing
  std::optional<double> edge_sigma_px;  ///< width of the sharpest edges as a Gaussian; none if there are too few edges
  int width = 0, height = 0;            ///< of the photo
  std::vector<TagLook> tags;            ///< the board's, sorted by id; of an id that is seen twice, none
  std::vector<int> stray_tags;          ///< ids of its family that it does not list, sorted
};

/// Reads the photo, and looks for the board's tags if one is given. Throws Error as read_photo does, and for a family
/// of tags that AprilTag does not know. May be called from several threads at once.
PhotoLook look_at(const Photo& photo, const TagSet* tags = nullptr);

/// How two photos compare, each divided by its exposure factor, where neither is clipped or lost in the dark.
struct Comparison {
  double correlation = 0;  ///< of their details' logarithm: near 1 for one pose, whatever the exposures
  double ratio = 1;        ///< median of b's values over a's at the common scale: 1 if the exposures are as told
  double shift_px = 0;     ///< how far b's picture lies from a's, photo pixels; of use where correlation is high
};

/// Nothing if the two share too little that both hold (5 % of the pixels), if one is all dark, or if sizes differ.
std::optional<Comparison> compare(const PhotoLook& a, double factor_a, const PhotoLook& b, double factor_b);

}  // namespace burin
