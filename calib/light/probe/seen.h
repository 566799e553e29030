// burin/calib/light/probe/seen.h - how well a direction of a light probe is known.
#pragma once

#include <cstdint>

namespace burin {

/// Where a direction's light comes from.
enum class Seen : std::uint8_t {
  nowhere,       ///< filled from its neighbors
  photographer,  ///< every view that shows it shows whoever held the camera, or the camera, there
  clipped,       ///< too bright for the shortest exposure of every view that shows it: a lower bound
  well
};

}  // namespace burin
