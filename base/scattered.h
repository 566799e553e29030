// burin/base/scattered.h - random numbers by index, independent of the order of calls.
#pragma once

#include <cstdint>

namespace burin {

/// A hash that spreads neighboring numbers over all 64 bits: SplitMix64's finalizer (Steele, Lea, Flood, OOPSLA 2014).
constexpr std::uint64_t scattered(std::uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ULL;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebULL;
  return v ^ (v >> 31);
}

}  // namespace burin
