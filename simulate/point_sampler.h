// burin/simulate/point_sampler.h - what a camera sees of a bench with known truth, by brute force.
//
// At jittered points of every pixel: which thing, groove or plain face lies there, its normal, the point NDF
// (docs/model.md 3) and the radiance (docs/model.md 5). Nothing of the closed footprint integral is used, so that it
// can be judged by this. A pixel's groove light is the mean over its metal of D(h, n) G F cos-terms, its share of plain
// face what the grooves' areas leave (at most all of it covered). Directions change by less than a milliradian over a
// pixel: wi, wo, h and the plain face's light are computed at the pixel's corners and interpolated, which errs by less
// than 1e-5 of them.
//
// A lamp with an area is sampled at points of its own, spread evenly over it; a pixel's points are shared out among
// them.
//
// The sun is a disk; surroundings are drawn from, a direction a point, and light paper as one flat lamp would.
//
// Frame: board, mm. Pixels: the center of the top-left pixel is (0, 0). Radiance: the lamp's intensity / mm^2.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "burin/base/image.h"
#include "burin/base/progress.h"
#include "burin/simulate/bench_truth.h"

namespace burin {

/// Holds what all views share: the grooves by place, things on the board, and the lens's rays. The truth must outlive
/// it.
class PointSampler {
 public:
  /// `carved` must hold width, depth and alpha of every scratch (carved_by).
  PointSampler(const BenchTruth& truth, const Carved& carved);
  ~PointSampler();
  PointSampler(const PointSampler&) = delete;
  PointSampler& operator=(const PointSampler&) = delete;

  /// R, G, B radiance of every pixel, before the lens's blur, stray lights included. Deterministic for any number of
  /// threads.
  Image radiance(const TruthView& view, const Light& light, const Progress& progress = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;

  /// Under a point lamp, with `samples` points a pixel where there are scratches.
  Image radiance_of_point(const TruthView& view, const Light& light, int samples, std::uint64_t seed,
                          const Progress& progress) const;
  /// Under surroundings, `times` as bright: at each point one direction is drawn (around_sampler.h).
  Image radiance_around(const TruthView& view, const Light& light, double times, int samples, std::uint64_t seed,
                        const Progress& progress) const;
};

}  // namespace burin
