// burin/scene/lens.h - mrcal's lens models: camera coordinates to pixels and back, and `.cameramodel` files.
// Frame: camera (x right, y down, z forward), mm. Pixels: the center of the top-left pixel is (0, 0).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace burin {

/// A lens: mrcal's model name (with its configuration, for splined models), its parameters in mrcal's order (fx fy cx
/// cy, then distortion), and the image size in pixels.
struct Lens {
  std::string model = "LENSMODEL_OPENCV8";
  std::vector<double> intrinsics;
  int width = 0, height = 0;
};

/// Deviation of one photo's lens from the lens of all photos of its camera. A stabilizer moves the principal point, and
/// the picture with it; focus and digital zoom change the focal length. With the shared lens at q and its principal
/// point c, this photo has c + shift_px + focal_ratio (q - c).
struct OwnLens {
  Eigen::Vector2d shift_px{0, 0};
  double focal_ratio = 1;
};

/// The shared lens with one photo's deviation.
Lens with_own(const Lens& lens, const OwnLens& own);

/// Gradient of one pixel position: rows u, v.
using PixelByPoint = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;

/// An uncalibrated lens without distortion. `focal_35mm` is the focal length, mm, with the same field of view along the
/// diagonal on 24 x 36 mm film (EXIF's FocalLengthIn35mmFilm). `width` and `height` are the picture's size in pixels.
Lens nominal_lens(double focal_35mm, int width, int height);

/// Projects points in camera coordinates (any length unit) to pixels, q[i] for p_camera[i]. If not null, dq_dp gets one
/// 2x3 block per point, and dq_dintrinsics gets points.size() x 2 x lens.intrinsics.size() numbers, row-major. Points
/// behind the camera have undefined results; check z > 0 first. Throws Error for an unknown model or a wrong number of
/// intrinsics.
void project(const Lens& lens, std::span<const Eigen::Vector3d> p_camera, std::span<Eigen::Vector2d> q_px,
             std::vector<PixelByPoint>* dq_dp = nullptr, std::vector<double>* dq_dintrinsics = nullptr);

/// Directions of pixels in camera coordinates, unit length, z forward. NaN if the model has no inverse there.
void unproject(const Lens& lens, std::span<const Eigen::Vector2d> q_px, std::span<Eigen::Vector3d> v_camera);

/// Number of parameters of a model ("LENSMODEL_OPENCV8": 12). Throws Error for a name that mrcal does not know.
int lens_parameter_count(const std::string& model);

/// Reads a `.cameramodel` of mrcal. Its extrinsics are ignored: Burin keeps poses in bench.json.
Lens read_cameramodel(const std::filesystem::path& file);

/// Writes a `.cameramodel` for mrcal's own tools, with 17 digits; atomically.
void write_cameramodel(const Lens& lens, const std::filesystem::path& file);

}  // namespace burin
