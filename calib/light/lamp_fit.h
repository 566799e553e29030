// burin/calib/light/lamp_fit.h - fits lamps, face, ambient light and vignetting to the brightness of paper and plain
// face by least squares. lamp.h supplies the starts; lamp_shapes.h tries other shapes. docs/model.md 9 'Lamp'. Frame:
// board, mm.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "burin/calib/light/lamp_model.h"
#include "burin/calib/light/light_samples.h"
#include "burin/scene/board.h"

namespace burin {

/// Data of a fit, and the model error.
struct LampData {
  std::span<const LightSample> samples;
  const Board* board;
  double f0 = 1, reach_mm = 1;  ///< of the face, mean of the channels; the board's diagonal
  Eigen::Vector2d center_mm{0, 0};
  double model_error = 0.02;     ///< LampOptions::model_error
  std::vector<bool> given_area;  ///< of each lamp: a person gave its area, which is held
};

/// A lamp's parameters, in the arrays that Ceres moves.
struct LampBlocks {
  double position[3] = {0, 0, 1};
  double log_intensity[1] = {0};
  double spot[3] = {0, 0, 0};  ///< aim x, aim y (LampModel::aim_mm), exponent
  /// The ellipse of an area light, mm, across the axis: the symmetric matrix xx, xy, yy that maps the unit disk to it.
  /// All 0: a point.
  double area[3] = {0, 0, 0};

  bool has_area() const { return area[0] != 0 || area[1] != 0 || area[2] != 0; }
  Eigen::Vector3d place() const { return Eigen::Vector3d::Map(position); }
};

/// Distance of a lamp from the board's middle.
inline double distance_mm(const LampData& data, const LampBlocks& lamp) {
  return (lamp.place() - Eigen::Vector3d(data.center_mm.x(), data.center_mm.y(), 0)).norm();
}

/// All fitted parameters.
struct LampParameters {
  std::vector<LampBlocks> lamps;
  double shared[5] = {0, 0, 0, 0, 0};  ///< log base_alpha, ambient, v1, v2, v3
  double grain[2] = {0, 0};            ///< FaceGrain's c and s; both 0: held at 0
  double gloss[2] = {0, 0.3};          ///< PaperGloss; f0 0: held at 0
  /// An unmodeled bare lamp next to each of the others. Its direction from the board's middle (x / z and y / z), and
  /// the logarithm of its radiant intensity over the square of its distance. The distance is held. Point lamps only.
  double stray[3] = {0, 0, 0};
  double stray_distance_mm = 0;  ///< 0: none
};

/// The lamp with the parameters `stray`.
template <typename T>
LampModel<T> stray_of(const T* stray, double distance_mm, const Eigen::Vector2d& center_mm) {
  LampModel<T> out;
  const Eigen::Matrix<T, 3, 1> towards = Eigen::Matrix<T, 3, 1>(stray[0], stray[1], T(1)).normalized();
  out.position_mm = T(distance_mm) * towards;
  out.position_mm[0] += center_mm.x();
  out.position_mm[1] += center_mm.y();
  out.log_intensity = stray[2] + 2 * std::log(distance_mm);
  out.aim_mm = Eigen::Matrix<T, 2, 1>::Zero();
  out.exponent = T(0);
  return out;
}

/// Standard deviations of LampParameters::shared.
using SharedSigma = Eigen::Matrix<double, 5, 1>;

struct LampFit {
  LampParameters blocks;
  double cost = std::numeric_limits<double>::infinity();
  bool usable = false;
  std::vector<Eigen::Matrix3d> position_covariance;  ///< of each lamp, if requested; all -1: not known
  SharedSigma shared_sigma = SharedSigma::Zero();
};

struct LampFitOptions {
  int only_light = -1;     ///< from 0: use this lamp's samples alone
  std::size_t stride = 1;  ///< of the face's samples, one in this many
  bool fit_vignette = true;
  int iterations = 60;
  bool covariance = false;
};

/// Fits from `start`. `spot[i]`: lamp i's aim and exponent move; otherwise they are held. An area moves if it is not 0.
LampFit fit_lamp_parameters(const LampData& data, const LampParameters& start, const std::vector<bool>& spot,
                            const LampFitOptions& options = {});

/// The best fit from several starts, which run in parallel; the first of equally good ones. Not usable if no fit is.
LampFit best_lamp_fit(const LampData& data, std::span<const LampParameters> starts, const std::vector<bool>& spot,
                      const LampFitOptions& options = {});

/// log(photo / model) of one sample at these parameters; empty if the model has no light there.
std::optional<double> log_residual(const LampData& data, const LampParameters& at, const LightSample& sample);

}  // namespace burin
