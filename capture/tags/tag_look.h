// burin/capture/tags/tag_look.h - brightness and clipped share of the paper of found tags.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "burin/base/image.h"
#include "burin/capture/tags/seen_tag.h"
#include "burin/capture/tags/tag_detector.h"

namespace burin {

/// One look per tag with coarse corners, in the order of `found`. Ids found twice are left out, and so are tags without
/// a white cell in the picture. `gray`: one channel, linear, 1 the white level; `clipped`: 1 where a pixel is at that
/// level. Throws Error for a family unknown to AprilTag.
std::vector<TagLook> look_at_tags(std::span<const TagDetection> found, const Image& gray,
                                  std::span<const std::uint8_t> clipped, const std::string& family);

}  // namespace burin
