// burin/calib/verdict/green_alone.h - what the answer owes to the colors that a camera made up. docs/model.md 9.24b.
//
// Where a sensor measured green it did not measure red and blue. What is read there is the mean of all three, which
// holds a glint's light in photos that keep their colors. JPEGs keep brightness pixel by pixel but color only on
// average over four, as stored and not as light, so that up to three per cent of the brightest glints' light is lost
// then, and the colors no longer tell of which.
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

/// By how far the answer would move, to first order, over all unknowns (global_index()), if photo k and the paper were
/// read as `read(k)`, a view like views[k], and `paper` have them.
Eigen::VectorXd shift_if_read_otherwise(const std::function<LightView(std::size_t)>& read,
                                        std::vector<LightSample> paper, Problem& data, const Stage& stage,
                                        const State& state);

/// By how far the answer would move, to first order, over all unknowns (global_index()), if photos were read by green
/// alone, in the brightness that the mean of colors has on most pixels: half of it. `views`, one a photo of `data`,
/// were made of `merged`, which is in color.
Eigen::VectorXd half_shift_by_green_alone(std::span<const MergedView> merged, std::span<const LightView> views,
                                          Problem& data, const Stage& stage, const State& state);

}  // namespace burin
