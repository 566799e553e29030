// burin/scene/mrcal_lens.h - lens models that mrcal evaluates because lens.cpp does not implement them: splined,
// CAHVOR, and others.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace burin {

/// Number of parameters of any of mrcal's models. Throws Error with `where` for a model that mrcal does not know, and,
/// in a build without mrcal, for every model.
int mrcal_parameter_count(const std::string& model, const std::string& where);

/// project() and unproject() of burin/scene/lens.h, for checked intrinsics. mrcal_unproject() may return any value if
/// the model has no inverse there.
void mrcal_project(const std::string& model, const std::vector<double>& intrinsics,
                   std::span<const Eigen::Vector3d> p_camera, std::span<Eigen::Vector2d> q_px,
                   std::vector<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>* dq_dp,
                   std::vector<double>* dq_dintrinsics);
void mrcal_unproject(const std::string& model, const std::vector<double>& intrinsics,
                     std::span<const Eigen::Vector2d> q_px, std::span<Eigen::Vector3d> v_camera);

}  // namespace burin
