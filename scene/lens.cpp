#include "burin/scene/lens.h"

#include <Eigen/LU>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/python_literal.h"
#include "burin/base/image.h"
#include "burin/base/limits.h"
#include "burin/scene/mrcal_lens.h"

namespace burin {
namespace {

/// Number of distortion parameters of a model that this file implements; -1 for a model of mrcal.
int written_out(const std::string& model) {
  if (model == "LENSMODEL_PINHOLE") return 0;
  for (const int distortions : {4, 5, 8, 12})
    if (model == "LENSMODEL_OPENCV" + std::to_string(distortions)) return distortions;
  return -1;
}

int parameter_count(const std::string& model, const std::string& where) {
  const int distortions = written_out(model);
  return distortions >= 0 ? 4 + distortions : mrcal_parameter_count(model, where);
}

/// Throws Error unless the lens has its model's number of parameters and they are finite. `where` is the file or part
/// of the program that names the lens.
void check_lens(const Lens& lens, const std::string& where) {
  const int expected = parameter_count(lens.model, where);
  if (lens.intrinsics.size() != static_cast<std::size_t>(expected))
    fail(where, lens.model + " has " + std::to_string(lens.intrinsics.size()) + " intrinsics",
         "it needs " + std::to_string(expected));
  for (const double v : lens.intrinsics)
    if (!std::isfinite(v)) fail(where, "an intrinsic of the lens is not a finite number", "calibrate again");
}

/// OpenCV's distortion k of a point on the plane z = 1, and its derivatives by the point and by k. A pinhole has none.
struct Distorted {
  Eigen::Vector2d at{0, 0};
  Eigen::Matrix2d by_point = Eigen::Matrix2d::Identity();
  std::array<Eigen::Vector2d, 12> by_k{};
};

Distorted distorted(const std::array<double, 12>& k, const Eigen::Vector2d& p) {
  const double x = p.x(), y = p.y(), r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
  const double a1 = 2 * x * y, a2 = r2 + 2 * x * x, a3 = r2 + 2 * y * y;
  const double above = 1 + k[0] * r2 + k[1] * r4 + k[4] * r6, below = 1 / (1 + k[5] * r2 + k[6] * r4 + k[7] * r6);
  const double radial = above * below;
  Distorted out;
  out.at = {x * radial + k[2] * a1 + k[3] * a2 + k[8] * r2 + k[9] * r4,
            y * radial + k[2] * a3 + k[3] * a1 + k[10] * r2 + k[11] * r4};
  // d/d(r^2) of the radial factor, and of the thin prism.
  const double slope = below * (k[0] + 2 * k[1] * r2 + 3 * k[4] * r4 - radial * (k[5] + 2 * k[6] * r2 + 3 * k[7] * r4));
  const double prism_x = k[8] + 2 * k[9] * r2, prism_y = k[10] + 2 * k[11] * r2;
  out.by_point << radial + 2 * x * x * slope + 2 * k[2] * y + 6 * k[3] * x + 2 * x * prism_x,
      2 * x * y * slope + 2 * k[2] * x + 2 * k[3] * y + 2 * y * prism_x,
      2 * x * y * slope + 2 * k[2] * x + 2 * k[3] * y + 2 * x * prism_y,
      radial + 2 * y * y * slope + 6 * k[2] * y + 2 * k[3] * x + 2 * y * prism_y;
  out.by_k = {
      below * r2 * p,           below * r4 * p,           {a1, a3}, {a2, a1}, below * r6 * p, -radial * below * r2 * p,
      -radial * below * r4 * p, -radial * below * r6 * p, {r2, 0},  {r4, 0},  {0, r2},        {0, r4}};
  return out;
}

std::array<double, 12> distortions_of(const Lens& lens) {
  std::array<double, 12> k{};
  std::copy(lens.intrinsics.begin() + 4, lens.intrinsics.end(), k.begin());
  return k;
}

std::string digits17(double value) {
  std::array<char, 40> buffer;
  return {buffer.data(), std::to_chars(buffer.begin(), buffer.end(), value, std::chars_format::general, 17).ptr};
}

}  // namespace

Lens with_own(const Lens& lens, const OwnLens& own) {
  Lens out = lens;
  for (std::size_t i = 0; i < 2; ++i) {
    out.intrinsics[i] *= own.focal_ratio;
    out.intrinsics[2 + i] += own.shift_px[static_cast<Eigen::Index>(i)];
  }
  return out;
}

void project(const Lens& lens, std::span<const Eigen::Vector3d> p_camera, std::span<Eigen::Vector2d> q_px,
             std::vector<PixelByPoint>* dq_dp, std::vector<double>* dq_dintrinsics) {
  check_lens(lens, "lens");
  const std::size_t count = p_camera.size(), parameters = lens.intrinsics.size();
  if (q_px.size() != count)
    fail("lens", "room for " + std::to_string(q_px.size()) + " pixels for " + std::to_string(count) + " points",
         "give one each");
  if (dq_dp) dq_dp->resize(count);
  if (dq_dintrinsics) dq_dintrinsics->assign(count * 2 * parameters, 0);
  if (count == 0) return;
  if (written_out(lens.model) < 0)
    return mrcal_project(lens.model, lens.intrinsics, p_camera, q_px, dq_dp, dq_dintrinsics);

  const std::array<double, 12> k = distortions_of(lens);
  const Eigen::Vector2d f(lens.intrinsics[0], lens.intrinsics[1]), c(lens.intrinsics[2], lens.intrinsics[3]);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d& p = p_camera[i];
    const Eigen::Vector2d plane = p.head<2>() / p.z();
    const Distorted d = distorted(k, plane);
    q_px[i] = d.at.cwiseProduct(f) + c;
    if (dq_dp) {
      PixelByPoint by_point;
      by_point.leftCols<2>() = f.asDiagonal() * d.by_point / p.z();
      by_point.col(2) = -by_point.leftCols<2>() * plane;
      (*dq_dp)[i] = by_point;
    }
    if (!dq_dintrinsics) continue;
    for (std::size_t row = 0; row < 2; ++row) {
      double* const out = dq_dintrinsics->data() + (2 * i + row) * parameters;
      const auto axis = static_cast<Eigen::Index>(row);
      out[row] = d.at[axis];
      out[2 + row] = 1;
      for (std::size_t j = 4; j < parameters; ++j) out[j] = f[axis] * d.by_k[j - 4][axis];
    }
  }
}

namespace {

/// Newton's iteration from the undistorted point. Not a number where it ends beyond the fold of a strong distortion, or
/// nowhere.
Eigen::Vector3d inverse(const std::array<double, 12>& k, const Eigen::Vector2d& at) {
  Eigen::Vector2d p = at;
  for (int i = 0; i < 50; ++i) {
    const Distorted d = distorted(k, p);
    const Eigen::Vector2d step = d.by_point.inverse() * (at - d.at);
    p += step;
    if (!(step.norm() > 1e-15 * (1 + p.norm()))) break;
  }
  const Eigen::Matrix2d slope = distorted(k, p).by_point;
  if (!(slope.determinant() > 0 && slope.trace() > 0))
    return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  return {p.x(), p.y(), 1};
}

}  // namespace

void unproject(const Lens& lens, std::span<const Eigen::Vector2d> q_px, std::span<Eigen::Vector3d> v_camera) {
  check_lens(lens, "lens");
  const std::size_t count = q_px.size();
  if (v_camera.size() != count)
    fail("lens", "room for " + std::to_string(v_camera.size()) + " directions for " + std::to_string(count) + " pixels",
         "give one each");
  if (count == 0) return;
  if (written_out(lens.model) < 0) {
    mrcal_unproject(lens.model, lens.intrinsics, q_px, v_camera);
  } else {
    const std::array<double, 12> k = distortions_of(lens);
    const Eigen::Vector2d f(lens.intrinsics[0], lens.intrinsics[1]), c(lens.intrinsics[2], lens.intrinsics[3]);
    for (std::size_t i = 0; i < count; ++i) v_camera[i] = inverse(k, (q_px[i] - c).cwiseQuotient(f));
  }

  // Both inverses are iterative. NaN marks a pixel outside the model's range, with a result that does not project back.
  constexpr double kTolerance_px = 1e-4;
  std::vector<Eigen::Vector2d> back(count);
  project(lens, v_camera, back);
  for (std::size_t i = 0; i < count; ++i) {
    const double length = v_camera[i].norm();
    if (length > 0 && (back[i] - q_px[i]).norm() < kTolerance_px)
      v_camera[i] /= length;
    else
      v_camera[i].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
}

Lens nominal_lens(double focal_35mm, int width, int height) {
  const double focal_px = focal_35mm * std::hypot(width, height) / std::hypot(36.0, 24.0);
  return {
      "LENSMODEL_OPENCV5", {focal_px, focal_px, (width - 1) / 2.0, (height - 1) / 2.0, 0, 0, 0, 0, 0}, width, height};
}

int lens_parameter_count(const std::string& model) { return parameter_count(model, "lens"); }

Lens read_cameramodel(const std::filesystem::path& file) {
  const std::string text = read_bytes(file, limit::kLensBytes, "a lens model");
  const Json content = PythonLiteral(text, file.string()).value();
  JsonObject json(content, file.string());
  Lens lens;
  lens.model = json.text("lensmodel");
  lens.intrinsics = json.numbers("intrinsics", -1);
  const std::vector<double> size = json.numbers("imagersize", 2);
  for (const double pixels : size)
    if (!(pixels >= 1 && pixels <= 1e6 && pixels == std::floor(pixels)))
      json.fail_field("imagersize", "is " + json.raw("imagersize").dump(), "write width and height in whole pixels");
  lens.width = static_cast<int>(size[0]);
  lens.height = static_cast<int>(size[1]);
  require_picture_size(lens.width, lens.height, limit::kPhotoPixels, file.string() + ": imagersize", "a photo");
  check_lens(lens, file.string());
  if (!(lens.intrinsics[0] > 0) || !(lens.intrinsics[1] > 0))
    json.fail_field("intrinsics", "has a focal length that is not greater than 0", "correct its first two numbers");
  return lens;
}

void write_cameramodel(const Lens& lens, const std::filesystem::path& file) {
  check_lens(lens, file.string());
  if (lens.width <= 0 || lens.height <= 0)
    fail(file.string(), "the lens has no image size", "set its width and height in pixels");
  // mrcal's own C writer keeps six decimals.
  std::string text = "{\n    'lensmodel':  '" + lens.model +
                     "',\n\n    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....\n    'intrinsics': [ ";
  for (const double v : lens.intrinsics) text += digits17(v) + ", ";
  text +=
      "],\n\n    # extrinsics are rt_fromref; Burin keeps poses in bench.json\n    'extrinsics': [ 0, 0, 0, 0, 0, 0, "
      "],\n\n";
  text += "    'imagersize': [ " + std::to_string(lens.width) + ", " + std::to_string(lens.height) + ", ],\n}\n";
  write_text(text, file);
}

}  // namespace burin
