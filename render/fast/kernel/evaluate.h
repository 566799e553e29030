// burin/render/fast/kernel/evaluate.h - the forward pass of one tile, stage by stage.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "burin/render/fast/kernel/cut_pairs.h"
#include "burin/render/fast/kernel/direct_pairs.h"
#include "burin/render/fast/kernel/lines.h"
#include "burin/render/fast/kernel/live_runs.h"
#include "burin/render/fast/kernel/pieces.h"
#include "burin/render/fast/kernel/shading.h"
#include "burin/render/fast/kernel/work.h"
#include "burin/render/fast/tile_raster.h"

namespace burin::kernel {

/// Makes the buffers long enough for the tile, and empties them.
template <class P, KernelMode kMode>
inline void make_ready(const TileWork& work, std::size_t count) {
  using Raster = TileRaster<P>;
  const TileTask& task = work.task;
  TileBuffers& buffers = work.buffers;
  TilePairs& pairs = work.pairs;
  const std::size_t most = std::max(count, task.most_pairs);
  if (task.keep_light) Raster::grow(pairs.light, most);
  if constexpr (kMode != KernelMode::value)
    for (std::vector<float>* v : {&buffers.area_shift, &buffers.area_turn}) Raster::grow(*v, most);
  if constexpr (kMode == KernelMode::material)
    for (std::vector<float>* v : {&buffers.area_width, &buffers.area_rim}) Raster::grow(*v, most);
  for (PairsSetAside* special : {&buffers.corners, &buffers.ends})
    for (std::vector<std::uint32_t>* v : {&special->pair, &special->line}) Raster::grow(*v, most + TileBuffers::kChunk);
  if (pairs.ends.capacity() < most) pairs.ends.reserve(16 * most);
  std::fill(std::begin(buffers.sums), std::end(buffers.sums), 0.0F);
  pairs.ends.clear();
  buffers.corners.count = buffers.ends.count = 0;
}

template <class P, KernelMode kMode, bool kCurves>
inline void evaluate_mode(const TileWork& work) {
  const TileTask& task = work.task;
  TileBuffers& buffers = work.buffers;
  const std::size_t count = work.places.begin[task.run_count];
  make_ready<P, kMode>(work, count);
  if constexpr (!kCurves)
    if (task.shapes.shared) shade_tile<P, kMode>(task, buffers);
  list_live_runs<P>(task, work.places, count, buffers);
  // One chunk ahead, because data just stored cannot be loaded at once.
  std::uint32_t line = ~0U, made = 0;
  const auto number_chunk = [&](std::size_t chunk) {
    if (chunk < count)
      number_lines<P>(&buffers.starts[chunk / 8], line, buffers.line_of[chunk / TileBuffers::kChunk % 2]);
  };
  number_chunk(0);
  for (std::size_t chunk = 0; chunk < count; chunk += TileBuffers::kChunk) {
    number_chunk(chunk + TileBuffers::kChunk);
    const std::uint32_t* line_of = buffers.line_of[chunk / TileBuffers::kChunk % 2];
    const int n = static_cast<int>(std::min<std::size_t>(TileBuffers::kChunk, count - chunk));
    const auto packet_at = [&](int i) { return PairPacket{line_of + i, chunk + i, i, std::min(kLanesOf<P>, n - i)}; };
    for (int i = 0; i < n; i += kLanesOf<P>) {
      for (; made <= line_of[i + kLanesOf<P> - 1]; made += kLanesOf<P>) {
        // Prefetch for the SIMD vector after the next, because runs are scattered in memory.
        const auto* ahead = reinterpret_cast<const char*>(&task.runs[buffers.live[made]] + 2 * kLanesOf<P>);
        for (std::size_t byte = 0; byte < kLanesOf<P> * sizeof(TileRun); byte += 64) __builtin_prefetch(ahead + byte);
        make_lines<P>(
            task, [&](int k) { return buffers.live[made + k]; }, buffers.line,
            static_cast<int>(made % (2 * kLanesOf<P>)));
      }
      const PairPacket packet = packet_at(i);
      const SetAside aside = task.corners == nullptr ? cross<P, kMode, true, kCurves>(work, packet)
                                                     : cross<P, kMode, false, kCurves>(work, packet);
      const std::uint32_t used = lane_bits(packet.lanes);
      set_aside<P>(buffers.corners, packet, aside.corners & used);
      set_aside<P>(buffers.ends, packet, aside.ends & used);
    }
    evaluate_any_pieces<P, kMode, kCurves>(task, buffers, n);
    for (int i = 0; i < n; i += kLanesOf<P>) finish_crossing<P, kMode>(work, packet_at(i));
    if constexpr (kMode != KernelMode::value) list_direct_ends(buffers, work.pairs);
  }
  finish_set_aside<P, kMode, false, kCurves>(work, buffers.corners);
  finish_set_aside<P, kMode, true, kCurves>(work, buffers.ends);
}

/// Implements TileKernels::evaluate; with kCurves, CurveKernels::evaluate.
template <class P, bool kCurves = false>
inline void evaluate(const TileTask& task, const TilePlaces& places, TileBuffers& buffers, TilePairs& pairs,
                     const TileJacobian& to) {
  const TileWork work{task, places, buffers, pairs, to};
  switch (task.mode) {
    case KernelMode::value:
      return evaluate_mode<P, KernelMode::value, kCurves>(work);
    case KernelMode::ends:
      return evaluate_mode<P, KernelMode::ends, kCurves>(work);
    case KernelMode::material:
      return evaluate_mode<P, KernelMode::material, kCurves>(work);
  }
}

}  // namespace burin::kernel
