// burin/render/pixel_shading.h - the factors of docs/model.md 5 that depend on the pixel alone and not on scratches.
// Frame: board, mm. Directions are unit vectors at the footprint's center.
#pragma once

#include <Eigen/Core>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/surface.h"

namespace burin {

/// radiance_c = F_c(cos_ho) intensity_c direct [ sum Dhat G / area + (1 - covered) base ] + ambient_c F0_c
struct PixelShading {
  bool visible = false;  ///< the camera is above the face here
  bool lit = false;      ///< the lamp is above the face too and its beam reaches here; else direct and base are 0
  Eigen::Vector3d wi{0, 0, 1}, wo{0, 0, 1}, h{0, 0, 1};
  Eigen::Vector3d h_face{0, 0, 1};                     ///< h in the frame of R_face_board
  Eigen::Vector3d wi_face{0, 0, 1}, wo_face{0, 0, 1};  ///< set only if the face has a grain
  double distance_i_mm = 1, distance_o_mm = 1;
  double cos_i = 0, cos_o = 0, cos_ho = 0;  ///< n.wi, n.wo, h.wo; n.h is h_face.z()
  double spot = 1;                          ///< max(0, axis . (-wi))^exponent
  double direct = 0;                        ///< spot / (4 cos_o distance_i^2), 1 / mm^2
  double base = 0;                          ///< D(h, z; base_alpha) G(wi, wo; base_alpha), with its grain
};

/// A lamp or a camera on or behind the face gives visible or lit = false, never a NaN. `x_axis` replaces the x
/// direction of R_face_board by the flat board's x direction at the pixel (FootprintGrid::x_axis).
PixelShading shade_pixel(const Eigen::Vector3d& center_mm, const Eigen::Vector3d& normal,
                         const Eigen::Vector3d& camera_center_mm, const Light& light, double base_alpha,
                         const FaceGrain& grain = {}, const Eigen::Vector3d* x_axis = nullptr);

/// Smith's G(wi, wo; alpha) of docs/model.md 3.2 with its derivatives. Both cosines must be positive.
struct Shadowing {
  double G = 0, dG_dalpha = 0, dG_dcos_i = 0, dG_dcos_o = 0;
};
Shadowing shadowing(double cos_i, double cos_o, double alpha);

/// D(h, z; base_alpha) of the plain face with its derivatives. cos_h must be positive.
struct BaseLobe {
  double D = 0, dD_dalpha = 0, dD_dcos_h = 0;
};
BaseLobe base_lobe(double cos_h, double alpha);

/// d(base) / d(base_alpha) of a lit pixel, for any grain of the face.
double base_slope(const PixelShading& pixel, double base_alpha, const FaceGrain& grain);

/// Throws Error for values of a lamp, material or camera that are not finite numbers or out of range.
void check_scene_values(const Eigen::Vector3d& camera_center_mm, const Light& light, const Material& material,
                        double tool_width_um, const Eigen::Vector3d& ambient);

}  // namespace burin
