// burin/render/radiance_chain.h - chain rule from the sums over a pixel's grooves (groove_sums.h) to the derivatives of
// its radiance by all parameters of a photo. docs/model.md 5. Frame: board, mm.
//
// Differentiation is forward over the scratches and backward over the pixel. The effect of lamp, pose and bow on half
// vector, cosines and footprint is chained once per pixel, for any number of pairs.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "burin/render/groove_sums.h"
#include "burin/render/pixel_shading.h"
#include "burin/render/view_renderer.h"
#include "burin/render/view_scene.h"
#include "burin/scene/bend.h"

namespace burin {

using BySceneParameter = std::array<double, static_cast<int>(SceneParameter::grain_s) + 1>;

/// A pixel with a footprint, lit and visible.
struct ChainedPixel {
  const PixelShading& shading;
  const Eigen::Vector3d &normal, &center_mm;
  const std::array<Eigen::Vector2d, 4>& corners_mm;
  double area_mm2;  ///< of the footprint
};

/// Data of one view that the chain needs at each pixel. Scene and camera must outlive it.
struct RadianceChain {
  const ViewScene& scene;
  const CameraView& camera;
  Eigen::Matrix3d R_camera_board;
  bool by_grain;                     ///< derivatives by grain are wanted, also for a face without one
  std::optional<Cylinder> cylinder;  ///< of a bent sheet

  RadianceChain(const ViewScene& of_scene, const CameraView& of_camera, bool with_grain);

  /// Q = direct (light / A + (1 - covered) base), radiance = factor(cos_ho) Q + ambient. Derivatives of one channel.
  void run(const ChainedPixel& pixel, const GrooveSums& sums, double factor, double factor_slope,
           BySceneParameter& out) const;

 private:
  struct GeometryGradient;
  void chain_geometry(const GeometryGradient& g, const Eigen::Vector3d& center,
                      const std::array<Eigen::Vector2d, 4>& corners, BySceneParameter& out) const;
  void chain_bent(const GeometryGradient& g, const std::array<Eigen::Vector2d, 4>& corners,
                  BySceneParameter& out) const;
  void set_pose_and_bow(const GeometryGradient& g, const Eigen::Vector3d& push, const Eigen::Vector3d& turn,
                        const Eigen::Vector3d& by_bow, BySceneParameter& out) const;
};

}  // namespace burin
