// burin/capture/tags/tag_look.h - the paper of tags that were found: how bright, how much of it clipped.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "burin/base/image.h"
#include "burin/capture/tags/seen_tag.h"
#include "burin/capture/tags/tag_detector.h"

namespace burin {

/// One look a tag, in the order of `found`, with their coarse corners; an id that was found twice is left out, and a
/// tag none of whose white cells lies in the picture. `gray`: one channel, linear, 1 the white level; `clipped`: 1
/// where a pixel is at that level. Throws Error for a family that AprilTag does not know.
std::vector<TagLook> look_at_tags(std::span<const TagDetection> found, const Image& gray,
                                  std::span<const std::uint8_t> clipped, const std::string& family);

}  // namespace burin
