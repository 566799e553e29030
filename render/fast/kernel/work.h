// burin/render/fast/kernel/work.h - what the stages of a tile kernel share: what they work on, packets in memory.
// Included only by files that are compiled for one instruction set each (burin/render/fast/packet_math.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "burin/render/fast/packet_math.h"
#include "burin/render/fast/tile_kernel.h"

namespace burin::kernel {

using packet::MaskOf;

/// One tile's work, as evaluate() was asked for it.
struct TileWork {
  const TileTask& task;
  const TilePlaces& places;
  TileBuffers& buffers;
  TilePairs& pairs;
  const TileJacobian& jacobian;
};

/// A packet of pairs that lie one after the other.
struct PairPacket {
  const std::uint32_t* line;  ///< their runs' numbers among the live ones; readable for a whole packet
  std::size_t pair;           ///< the first of them, as counted in the tile
  int at;                     ///< where they stand in the buffers
  int lanes;                  ///< how many of the packet they are
};

/// The same for pairs that were set aside: they lie anywhere in the tile.
struct ScatteredPacket {
  const std::uint32_t *pair, *line;
  int at, lanes;
};

/// A bit for each lane in use.
inline std::uint32_t lane_bits(int lanes) { return lanes >= 32 ? ~0U : (1U << lanes) - 1; }

template <class P>
[[gnu::always_inline]] inline P load(const float* from) {
  return P::load_unaligned(from);
}
template <class P>
[[gnu::always_inline]] inline void save(float* to, const P& v) {
  v.store_unaligned(to);
}
template <class P>
[[gnu::always_inline]] inline P inverse(const P& x) {
  return footprint::Arithmetic<P>::inverse(x);
}

/// Adds lanes 0 .. n - 1 of light and area to the pixels' sums.
template <class P>
[[gnu::always_inline]] inline void add_to_pixels(const P& light, const P& area, const std::uint16_t* place, int n,
                                                 float* sums) {
  alignas(64) float both[2 * kLanesOf<P>];
  packet::interleave(light, area, both);
  using Two = float __attribute__((vector_size(8)));
  for (int k = 0; k < n; ++k) {
    Two sum, add;
    std::memcpy(&sum, sums + 2 * place[k], sizeof(Two));
    std::memcpy(&add, both + 2 * k, sizeof(Two));
    sum += add;
    std::memcpy(sums + 2 * place[k], &sum, sizeof(Two));
  }
}

}  // namespace burin::kernel
