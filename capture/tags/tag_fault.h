// burin/capture/tags/tag_fault.h - tags that a photo shows and that are not used, and why. Pixels: the center of the
// top-left pixel is (0, 0).
#pragma once

#include <Eigen/Core>
#include <string>

namespace burin {

/// Why a tag is not used.
enum class TagFault {
  unlisted,      ///< board.json does not have it
  unreadable,    ///< its bits hardly stand apart
  repeated,      ///< its id is seen more than once in the photo
  at_edge,       ///< of the photo
  small,         ///< in the photo
  clipped,       ///< its paper
  covered,       ///< a side has no edge
  no_corners,    ///< its sides do not meet
  shifted,       ///< its corners lie elsewhere than its sides meet
  photo_blurred  ///< much more than the others
};

/// A tag that was seen but is not used.
struct RejectedTag {
  int id = 0;
  Eigen::Vector2d center_px{0, 0};
  TagFault fault = TagFault::unreadable;
  double measured = 0;  ///< repeated: how often it is seen; photo_blurred: the width of the photo's edges, px
  double usual = 0;     ///< photo_blurred: the other photos' width, px
};

/// Why, for people: "its white paper is clipped: add a shorter exposure".
std::string in_words(const RejectedTag& tag);

}  // namespace burin
