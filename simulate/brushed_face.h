// burin/simulate/brushed_face.h - a simulated brushed face: its two roughnesses, and streaks that tilt it. Derived from
// the slopes of microfacets; shares only the parameters with face_grain.h. Frame: board.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "burin/simulate/bench_truth.h"

namespace burin {

/// Parameters of a brushed face for the sampler.
struct BrushedFace {
  double along_x = 1, along_y = 0;  ///< unit, along the brushing
  double alpha_along = 0.1, alpha_across = 0.1;
  Streaks streaks;
  std::uint64_t seed = 0;
};
BrushedFace brushed_face(const BenchTruth& truth);

/// D(h) G1(wi) G1(wo) about this normal.
double brushed_light(const BrushedFace& face, const Eigen::Vector3d& normal, const Eigen::Vector3d& h,
                     const Eigen::Vector3d& wi, const Eigen::Vector3d& wo);

/// The normal with the streaks' tilt across the brushing.
Eigen::Vector3d streaked_normal(const BrushedFace& face, const Eigen::Vector3d& normal, double x_mm, double y_mm);

}  // namespace burin
