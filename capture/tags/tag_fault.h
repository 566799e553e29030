// burin/capture/tags/tag_fault.h - tags seen in a photo but not used, each with its reason. Pixels: the center of the
// top-left pixel is (0, 0).
#pragma once

#include <Eigen/Core>
#include <string>

namespace burin {

/// Reason for not using a tag.
enum class TagFault {
  unlisted,      ///< not in board.json
  unreadable,    ///< too little contrast between its bits
  repeated,      ///< its id is seen more than once in the photo
  at_edge,       ///< at the edge of the photo
  small,         ///< too small in the photo
  clipped,       ///< its paper is clipped
  covered,       ///< a side has no edge
  no_corners,    ///< its sides do not meet
  shifted,       ///< its corners differ from the intersections of its sides
  photo_blurred  ///< much more than the others
};

/// A seen but unused tag.
struct RejectedTag {
  int id = 0;
  Eigen::Vector2d center_px{0, 0};
  TagFault fault = TagFault::unreadable;
  double measured = 0;  ///< repeated: number of sightings; photo_blurred: the width of the photo's edges, px
  double usual = 0;     ///< photo_blurred: the other photos' width, px
};

/// The reason for people: "its white paper is clipped: add a shorter exposure".
std::string in_words(const RejectedTag& tag);

}  // namespace burin
