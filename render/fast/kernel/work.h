// burin/render/fast/kernel/work.h - data that the stages of a tile kernel share, and SIMD vectors in memory. Only files
// compiled for one instruction set each include it (burin/render/fast/packet_math.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "burin/render/fast/packet_math.h"
#include "burin/render/fast/tile_kernel.h"

namespace burin::kernel {

using packet::MaskOf;

/// One tile's work: the arguments of evaluate().
struct TileWork {
  const TileTask& task;
  const TilePlaces& places;
  TileBuffers& buffers;
  TilePairs& pairs;
  const TileJacobian& jacobian;
};

/// A SIMD vector of consecutive pairs.
struct PairPacket {
  const std::uint32_t* line;  ///< numbers of their runs among the live ones; readable for a whole vector
  std::size_t pair;           ///< the first pair, as counted in the tile
  int at;                     ///< position in the buffers
  int lanes;                  ///< number of lanes in use
};

/// PairPacket for deferred pairs, which are scattered over the tile.
struct ScatteredPacket {
  const std::uint32_t *pair, *line;
  int at, lanes;
};

/// One bit for each lane in use.
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
