// burin/simulate/point_sampler.h - radiance of a bench with known ground truth, by brute force.
//
// At jittered points of every pixel, the sampler finds the object, groove or plain face. It evaluates the normal, the
// point NDF (docs/model.md 3) and the radiance (docs/model.md 5). It uses nothing of the closed footprint integral, so
// it can validate it. A pixel's groove light is the mean over its metal of D(h, n) G F cos-terms. Its share of plain
// face is the remainder of the grooves' areas (at most all of it covered). Directions change by less than a milliradian
// over a pixel. So wi, wo, h and the plain face's light are interpolated from the pixel's corners, with a relative
// error below 1e-5.
//
// An area light is sampled at points spread evenly over it; a pixel's points are divided among them.
//
// The sun is a disk. Surroundings are sampled with one direction per point; on paper they act like one flat lamp.
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

/// Data shared by all views: the grooves by place, objects on the board, and the lens's rays. The truth must outlive
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

  /// Radiance under a point lamp, with `samples` points per pixel on scratches.
  Image radiance_of_point(const TruthView& view, const Light& light, int samples, std::uint64_t seed,
                          const Progress& progress) const;
  /// Radiance under surroundings `times` as bright, with one direction per point (around_sampler.h).
  Image radiance_around(const TruthView& view, const Light& light, double times, int samples, std::uint64_t seed,
                        const Progress& progress) const;
};

}  // namespace burin
