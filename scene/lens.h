// burin/scene/lens.h - mrcal's lens models: camera coordinates to pixels and back, and `.cameramodel` files.
// Frame: camera (x right, y down, z forward), mm. Pixels: the center of the top-left pixel is (0, 0).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace burin {

/// A lens: mrcal's model name (its configuration included, for splined models), its parameters in mrcal's order
/// (fx fy cx cy, then distortion), and the image size it holds for, in pixels.
struct Lens {
  std::string model = "LENSMODEL_OPENCV8";
  std::vector<double> intrinsics;
  int width = 0, height = 0;
};

/// How the lens of one photo differs from that of all photos of its camera: a stabilizer moves the principal point, and
/// the picture around it; focus and a digital zoom change the focal length. Where the lens of all shows q, and c is its
/// principal point, this photo shows c + shift_px + focal_ratio (q - c).
struct OwnLens {
  Eigen::Vector2d shift_px{0, 0};
  double focal_ratio = 1;
};

/// The lens of a photo that differs so.
Lens with_own(const Lens& lens, const OwnLens& own);

/// Gradient of one pixel position: rows u, v.
using PixelByPoint = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;

/// A lens that nobody calibrated, without distortion: by the focal length, mm, that sees as much on 24 x 36 mm film, as
/// EXIF's FocalLengthIn35mmFilm has it (along the diagonals), and the size of its pictures in pixels.
Lens nominal_lens(double focal_35mm, int width, int height);

/// Projects points in camera coordinates (any length unit) to pixels, q[i] for p_camera[i].
/// If not null, dq_dp gets one 2x3 block a point, and dq_dintrinsics points.size() x 2 x lens.intrinsics.size()
/// numbers, row-major. Points behind the camera give whatever the model gives; check z > 0 first.
/// Throws Error for an unknown model or a wrong number of intrinsics.
void project(const Lens& lens, std::span<const Eigen::Vector3d> p_camera, std::span<Eigen::Vector2d> q_px,
             std::vector<PixelByPoint>* dq_dp = nullptr, std::vector<double>* dq_dintrinsics = nullptr);

/// Directions in camera coordinates seen by pixels, unit length, z forward. NaN where the model cannot be inverted.
void unproject(const Lens& lens, std::span<const Eigen::Vector2d> q_px, std::span<Eigen::Vector3d> v_camera);

/// Number of parameters of a model ("LENSMODEL_OPENCV8": 12). Throws Error for a name that mrcal does not know.
int lens_parameter_count(const std::string& model);

/// Reads a `.cameramodel` as mrcal writes it (its extrinsics are ignored: Burin keeps poses in bench.json).
Lens read_cameramodel(const std::filesystem::path& file);

/// Writes a `.cameramodel` that mrcal's own tools open, with 17 digits; atomically.
void write_cameramodel(const Lens& lens, const std::filesystem::path& file);

}  // namespace burin
