// burin/optimize/design/random.h - random numbers with the same values on every platform, unlike <random>'s
// distributions.
#pragma once

#include <cstdint>
#include <limits>

#include "burin/base/scattered.h"

namespace burin {

/// 64 random bits per call, from any seed, without initialization cost: SplitMix (Steele, Lea, Flood, OOPSLA 2014). It
/// is a uniform random bit generator of <random>.
class SplitMix64 {
 public:
  using result_type = std::uint64_t;
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  /// The range of its values.
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }
  /// The next 64 bits.
  result_type operator()() { return scattered(state_ += 0x9E3779B97F4A7C15ULL); }

 private:
  std::uint64_t state_;
};

/// Uniform in [0, 1), from 64 random bits.
template <typename Random>
double uniform(Random& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace burin
