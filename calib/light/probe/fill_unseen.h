// burin/calib/light/probe/fill_unseen.h - directions that nothing is known of, filled smoothly from their neighbors.
#pragma once

#include <cstdint>
#include <span>

#include "burin/base/image.h"

namespace burin {

/// Fills the pixels of a latitude-longitude picture whose `known` is 0 by the push-pull pyramid (Gortler et al., The
/// Lumigraph, SIGGRAPH 1996), each pixel counting by its solid angle, columns wrapping round. Of logarithms: a lamp at
/// the edge of what is seen must not light what is not. Nothing changes where nothing is known.
void fill_unseen(Image& panorama, std::span<const std::uint8_t> known);

}  // namespace burin
