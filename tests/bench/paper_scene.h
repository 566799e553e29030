// The scene of the paper's figures, for benchmarks: board, views, scratches as a design starts with them.
#pragma once

#include <benchmark/benchmark.h>

#include "burin/render/view_renderer.h"

namespace burin {

inline constexpr double kPaperBoard_mm = 300;

/// The paper's board as a picture of so many pixels along an edge.
std::shared_ptr<const FootprintGrid> paper_grid(int pixels);

/// A view of the paper's board (wt = d = 1e-4 of its edge, alpha 0.04), seen as a picture laid on it; `views` of them
/// stand in azimuths 180 degrees over `views` apart.
ViewScene paper_scene(std::shared_ptr<const FootprintGrid> grid, int view = 0, int views = 1);

/// Scratches as `burin design --start random` draws them: anywhere, in any direction, 1.5 to 4.5 % of the board's edge
/// long, ends kept on the board. The same ones every time.
Scratches paper_scratches(int count);

/// dE/dradiance of a mono view: random numbers from -1 to 1.
Image random_weights(int width, int height);

/// Correctness beside time: `image_rms`, the RMS difference of the fast path's image to the double path's over its
/// peak, and `gradient_rms`, that of the ends' gradients over their RMS. Computed once a scene size and width.
void report_correctness(benchmark::State& state, const ViewScene& scene, const Scratches& scratches, SimdWidth simd);

/// `image_rms`, the RMS difference of the first image to the second over its peak, and `gradient_rms`, that of the
/// ends' gradients over their RMS.
void report_differences(benchmark::State& state, const Image (&image)[2], const ScratchGradients (&gradients)[2]);

}  // namespace burin
