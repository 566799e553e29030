// burin/optimize/design/random.h - random numbers that are the same on every platform (those of <random>'s
// distributions are not).
#pragma once

#include <random>

namespace burin {

/// Uniform in [0, 1).
inline double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

}  // namespace burin
