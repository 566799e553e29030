// burin/render/fast/kernel/live_runs.h - the runs of a tile with pairs, and the run of each pair.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "burin/render/fast/kernel/work.h"
#include "burin/render/fast/tile_raster.h"

namespace burin::kernel {

/// Adds the pairs selected by `bits`. No test for an empty mask, because mispredicted branches cost more.
template <class P>
[[gnu::always_inline]] inline void set_aside(PairsSetAside& aside, const PairPacket& packet, std::uint32_t bits) {
  packet::pack_numbers<P>(&aside.line[aside.count], &aside.pair[aside.count], packet.line,
                          static_cast<std::uint32_t>(packet.pair), bits);
  aside.count += static_cast<std::size_t>(std::popcount(bits));
}

/// Lists the runs with pairs, and repeats the last over one more SIMD vector. Marks the first pair of each.
template <class P>
inline void list_live_runs(const TileTask& task, const TilePlaces& places, std::size_t count, TileBuffers& buffers) {
  TileRaster<P>::grow(buffers.live, std::max<std::size_t>(task.run_count, task.most_runs));
  TileRaster<P>::grow(buffers.starts, std::max(count, task.most_pairs) / 8 + TileBuffers::kChunk);
  std::fill_n(buffers.starts.data(), count / 8 + TileBuffers::kChunk, std::uint8_t{0});
  std::uint32_t n = 0;
  for (std::uint32_t r = 0; r < task.run_count; ++r) {
    const std::uint32_t begin = places.begin[r], lives = places.begin[r + 1] > begin ? 1 : 0;
    buffers.live[n] = r;
    buffers.starts[begin / 8] |= static_cast<std::uint8_t>(lives << begin % 8);
    n += lives;
  }
  std::fill_n(buffers.live.data() + n, kLanesOf<P>, n > 0 ? buffers.live[n - 1] : 0);
}

/// Number of set bits among bits 0 .. k of a byte.
struct CountsOfBits {
  std::uint8_t of[256][8] = {};

  constexpr CountsOfBits() {
    for (int byte = 0; byte < 256; ++byte)
      for (int k = 0; k < 8; ++k)
        of[byte][k] = static_cast<std::uint8_t>((k > 0 ? of[byte][k - 1] : 0) + (byte >> k & 1));
  }
};
inline constexpr CountsOfBits kCountsOfBits{};

/// Numbers the runs of a chunk's pairs among the live ones, from the marks of first pairs. `line` is the number of the
/// last pair before the chunk, and on return of its last pair.
template <class P>
BURIN_FLATTEN inline void number_lines(const std::uint8_t* starts, std::uint32_t& line, std::uint32_t* to) {
  for (int i = 0; i < TileBuffers::kChunk; i += 8) {
    std::uint8_t count[8];  // a copy, because bytes may alias the numbers
    std::memcpy(count, kCountsOfBits.of[starts[i / 8]], sizeof(count));
    for (int k = 0; k < 8; ++k) to[i + k] = line + count[k];
    line += count[7];
  }
}

}  // namespace burin::kernel
