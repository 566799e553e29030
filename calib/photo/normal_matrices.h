// burin/calib/photo/normal_matrices.h - the matrices of a whole problem's normal equations; normal_system.h computes
// them. Frame: board, mm. Unknowns are in the order of global_index().
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <vector>

namespace burin {

/// The normal equations at one state, with cameras, bow and lens ("geometry") eliminated.
struct NormalSystem {
  std::vector<bool> free;
  Eigen::MatrixXd H, noise_H;  // of all; weighted by the camera's noise alone, with known poses
  Eigen::VectorXd g;
  Eigen::VectorXd prior, prior_g;  // the table's priors: diagonal of their information, and their scores
  // Contribution of the geometry's prior after elimination: its information, and the scatter of its scores by the tags'
  // noise. Both are equal unless tags weigh more than their noise (GeometryPrior::weight).
  Eigen::MatrixXd geometry_information, geometry_scatter;
  // Scores by square of the board and by photo; below them the geometry's own.
  Eigen::MatrixXd tiles, photos;
  std::map<int, Eigen::VectorXd> tags;  // scores by tag (paper)
  std::map<std::size_t, Eigen::MatrixXd> H_view;
  std::map<std::size_t, Eigen::VectorXd> g_view;
  Eigen::MatrixXd A, B, gain;                // (geometry, geometry), (unknowns, geometry), B A^-1
  Eigen::VectorXd geometry_g, geometry_off;  // score; deviation of the geometry from the tags' estimate
  double cost = 0;
  std::size_t pixels = 0;
};

}  // namespace burin
