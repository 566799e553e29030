// burin/calib/photo/normal_matrices.h - the normal equations of a whole problem as numbers; normal_system.h makes them.
// Frame: board, mm. Unknowns are in the order of global_index().
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <vector>

namespace burin {

/// The normal equations of everything at one state, cameras, bow and lens ("geometry") eliminated.
struct NormalSystem {
  std::vector<bool> free;
  Eigen::MatrixXd H, noise_H;  // of all; with the camera's noise alone as weights, poses known
  Eigen::VectorXd g;
  Eigen::VectorXd prior, prior_g;  // the table's priors: diagonal of their information, and their scores
  // Of the geometry's prior, eliminated: its information, and how its scores scatter by the tags' noise. These are one,
  // but where tags weigh more than their noise says (GeometryPrior::weight).
  Eigen::MatrixXd geometry_information, geometry_scatter;
  // Scores by square of the board and by photo; below them the geometry's own.
  Eigen::MatrixXd tiles, photos;
  std::map<int, Eigen::VectorXd> tags;  // scores by tag (paper)
  std::map<std::size_t, Eigen::MatrixXd> H_view;
  std::map<std::size_t, Eigen::VectorXd> g_view;
  Eigen::MatrixXd A, B, gain;                // (geometry, geometry), (unknowns, geometry), B A^-1
  Eigen::VectorXd geometry_g, geometry_off;  // score; how far the geometry is from what the tags say
  double cost = 0;
  std::size_t pixels = 0;
};

}  // namespace burin
