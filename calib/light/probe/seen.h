// burin/calib/light/probe/seen.h - classifies a direction of a light probe by the quality of its evidence.
#pragma once

#include <cstdint>

namespace burin {

/// Source of a direction's light.
enum class Seen : std::uint8_t {
  nowhere,       ///< filled from its neighbors
  photographer,  ///< every view of this direction shows the photographer or the camera there
  clipped,       ///< too bright for the shortest exposure of every view that shows it: a lower bound
  well
};

}  // namespace burin
