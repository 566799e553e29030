// burin/scene/material.h - reflection of grooves and of the plain face.
#pragma once

#include <Eigen/Core>

#include "burin/scene/face_grain.h"
#include "burin/scene/groove_profile.h"

namespace burin {

/// Reflection parameters of the grooves and the plain face. Scratches without their own depth or alpha share them.
struct Material {
  double alpha = 0.04;                   ///< GGX roughness of the grooves' walls
  double depth_um = 10;                  ///< d in the paper's Eqn. 2
  double base_alpha = 0.15;              ///< GGX roughness of the plain face
  Eigen::Vector3d f0{0.91, 0.92, 0.92};  ///< Fresnel reflectance at normal incidence, R G B
  FaceGrain grain{};                     ///< of a brushed face; base_alpha is the mean of its two roughnesses
  GrooveProfile profile{};               ///< the grooves' cross-section
};

/// Presence of Material's numbers in a file. A number missing in bench.json comes from board.json
/// (burin/scene/bench_of_board.h); a number missing there takes Material's default.
struct SaidMaterial {
  bool alpha = true, depth_um = true, base_alpha = true, f0 = true;
  bool grain = false, profile = false;
};

}  // namespace burin
