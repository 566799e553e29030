#include "burin/optimize/design/crowding.h"

#include <cmath>

namespace burin {

std::optional<std::size_t> fewer_strokes(std::size_t strokes, double a_stroke, double cover) {
  // Pixels per stroke, divided by the coverage of the board. Measured at a coverage of 0.4 to 2: 3 to 6 pixels show
  // most, and 2 lose up to 8 dB.
  constexpr double kTooFew = 4, kEnough = 5;
  if (!(a_stroke < kTooFew * cover)) return std::nullopt;
  // More strokes are shorter ones, so their covered area grows by about the cube root of their number.
  constexpr double kCoverBy = 1.0 / 3;
  const auto fewer = static_cast<std::size_t>(static_cast<double>(strokes) *
                                              std::pow(a_stroke / (kEnough * cover), 1 / (1 + kCoverBy)));
  return fewer > 0 ? std::optional(fewer) : std::nullopt;
}

bool pixels_crowd(double cover) {
  constexpr double kMost = 2;
  return cover > kMost;
}

}  // namespace burin
