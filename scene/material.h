// burin/scene/material.h - what grooves and the plain face reflect.
#pragma once

#include <Eigen/Core>

#include "burin/scene/face_grain.h"
#include "burin/scene/groove_profile.h"

namespace burin {

/// What a groove and the plain face reflect. Shared by all scratches that do not carry their own depth or alpha.
struct Material {
  double alpha = 0.04;                   ///< GGX roughness of the grooves' walls
  double depth_um = 10;                  ///< d in the paper's Eqn. 2
  double base_alpha = 0.15;              ///< GGX roughness of the plain face
  Eigen::Vector3d f0{0.91, 0.92, 0.92};  ///< Fresnel reflectance at normal incidence, R G B
  FaceGrain grain{};                     ///< of a brushed face; base_alpha is the mean of its two roughnesses
  GrooveProfile profile{};               ///< the grooves' cross-section
};

/// Which of Material's numbers a file says itself. What a bench.json leaves out is board.json's
/// (burin/scene/bench_of_board.h), and what that leaves out is Material's default.
struct SaidMaterial {
  bool alpha = true, depth_um = true, base_alpha = true, f0 = true;
  bool grain = false, profile = false;
};

}  // namespace burin
