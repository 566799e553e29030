// burin/calib/verdict/green_alone.h - influence of demosaiced colors on the estimates. docs/model.md 9.24b.
//
// A pixel that measured green did not measure red and blue. Its brightness is the mean of all three channels, which
// contains a glint's whole light in photos with full color resolution. JPEGs keep brightness per pixel, but color only
// as an average of stored values over four pixels. Up to 3 % of the brightest glints' light is then lost, and the
// colors no longer show at which glints.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "burin/calib/light/light_samples.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/capture/photo.h"

namespace burin {

/// First-order shift of all unknowns (global_index()) for another reading of the photos: `read(k)` replaces views[k],
/// and `paper` replaces the paper's samples.
Eigen::VectorXd shift_if_read_otherwise(const std::function<LightView(std::size_t)>& read,
                                        std::vector<LightSample> paper, Problem& data, const Stage& stage,
                                        const State& state);

/// Half of the first-order shift of all unknowns (global_index()) if photos are read by green alone. The green values
/// are scaled to the mean of the channels on most pixels. `views`, one per photo of `data`, come from `merged`, which
/// is in color.
Eigen::VectorXd half_shift_by_green_alone(std::span<const MergedView> merged, std::span<const LightView> views,
                                          Problem& data, const Stage& stage, const State& state);

}  // namespace burin
