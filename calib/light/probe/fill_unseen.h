// burin/calib/light/probe/fill_unseen.h - fills unseen directions smoothly from their neighbors.
#pragma once

#include <cstdint>
#include <span>

#include "burin/base/image.h"

namespace burin {

/// Fills the pixels of a latitude-longitude picture whose `known` is 0 by the push-pull pyramid (Gortler et al., The
/// Lumigraph, SIGGRAPH 1996). Each pixel counts by its solid angle; columns wrap around. Logarithms are averaged: a
/// lamp at the edge of the seen region must not light the unseen one. Does nothing if no pixel is known.
void fill_unseen(Image& panorama, std::span<const std::uint8_t> known);

}  // namespace burin
