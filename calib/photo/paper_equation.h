// burin/calib/photo/paper_equation.h - one sample of a tag's paper: its weighted residual, and its derivatives by all
// unknowns of a problem. docs/model.md 5 and 9.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "burin/calib/light/lamp_model.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// Residual of paper: its mean brightness per tag and photo, with board.json's albedo times one common factor.
struct PaperResidual {
  const LightSample* sample;
  double albedo, weight;
  PaperCoat coat;
  std::vector<LampPoint> points;  ///< of an area light, with its size at the start of the fit
  double stray = 0;               ///< radiance under an unmodeled light, at the start of the fit

  template <typename T>
  bool operator()(const T* ambient, const T* vignette, const T* position, const T* log_intensity, const T* aim,
                  const T* falloff, const T* log_paper, T* residual) const {
    using std::exp;
    LampModel<T> lamp;
    lamp.position_mm = Eigen::Matrix<T, 3, 1>(position[0], position[1], position[2]);
    lamp.log_intensity = log_intensity[0];
    lamp.aim_mm = Eigen::Matrix<T, 2, 1>(aim[0], aim[1]);
    lamp.exponent = falloff[0];
    const T radiance = exp(log_paper[0]) *
                       (paper_radiance(lamp, ambient[0], albedo, *sample, points, {T(coat.f0), T(coat.alpha)}) + stray);
    residual[0] = weight * (vignette_at(vignette, sample->radius2) * radiance - sample->value);
    return true;
  }
};

inline constexpr double kPaperError = 0.005;  // relative: unevenness of paper beyond noise
inline constexpr double kPaperLoss = 3;       // Cauchy scale, in expected errors

PaperResidual paper_residual(const Problem& problem, const State& state, const LightSample& sample);

struct PaperEquation {
  double residual = 0;
  Eigen::VectorXd row;  ///< derivatives, in the order of global_index(); 0 for held unknowns
};
PaperEquation paper_equation(const Problem& data, const State& state, const LightSample& sample,
                             const std::vector<bool>& free);

}  // namespace burin
