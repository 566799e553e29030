#include "burin/scene/lens.h"

extern "C" {  // mrcal.h has no guard for C++ of its own
#include <mrcal/mrcal.h>
}

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/pictures/picture_file.h"
#include "burin/base/files/python_literal.h"
#include "burin/base/limits.h"

namespace burin {
namespace {

static_assert(sizeof(mrcal_point2_t) == sizeof(Eigen::Vector2d) && sizeof(mrcal_point3_t) == sizeof(Eigen::Vector3d));

std::string known_models() {
  std::string names;
  for (const char* const* name = mrcal_supported_lensmodel_names(); *name; ++name)
    names += (names.empty() ? "" : ", ") + std::string(*name);
  return names;
}

/// `where` is the file or part of the program that names the model.
mrcal_lensmodel_t lens_model(const std::string& name, const std::string& where) {
  mrcal_lensmodel_t model;
  if (!mrcal_lensmodel_from_name(&model, name.c_str()) || !mrcal_lensmodel_type_is_valid(model.type))
    fail(where, "mrcal knows no lens model \"" + name + "\"", "use one of " + known_models());
  if (model.type == MRCAL_LENSMODEL_CAHVORE)
    fail(where, "mrcal gives neither gradients nor an inverse for " + name,
         "convert it with mrcal-convert-lensmodel, to LENSMODEL_OPENCV8 for instance");
  if (model.type == MRCAL_LENSMODEL_SPLINED_STEREOGRAPHIC) {
    // mrcal takes any numbers here and aborts the program later.
    const auto& config = model.LENSMODEL_SPLINED_STEREOGRAPHIC__config;
    if ((config.order != 2 && config.order != 3) || config.Nx < config.order + 1 || config.Ny < config.order + 1 ||
        config.fov_x_deg < 1 || config.fov_x_deg >= 360)
      fail(where, "the configuration in \"" + name + "\" makes no spline",
           "order is 2 or 3, Nx and Ny are at least order + 1, fov_x_deg lies between 1 and 359");
  }
  return model;
}

/// The model, after checking that the lens has its number of parameters and that they are numbers.
mrcal_lensmodel_t checked_model(const Lens& lens, const std::string& where) {
  const mrcal_lensmodel_t model = lens_model(lens.model, where);
  const int expected = mrcal_lensmodel_num_params(&model);
  if (lens.intrinsics.size() != static_cast<std::size_t>(expected))
    fail(where, lens.model + " has " + std::to_string(lens.intrinsics.size()) + " intrinsics",
         "it needs " + std::to_string(expected));
  for (const double v : lens.intrinsics)
    if (!std::isfinite(v)) fail(where, "an intrinsic of the lens is not a finite number", "calibrate again");
  return model;
}

const mrcal_point3_t* as_mrcal(const Eigen::Vector3d* p) { return reinterpret_cast<const mrcal_point3_t*>(p); }
const mrcal_point2_t* as_mrcal(const Eigen::Vector2d* q) { return reinterpret_cast<const mrcal_point2_t*>(q); }
mrcal_point3_t* as_mrcal(Eigen::Vector3d* p) { return reinterpret_cast<mrcal_point3_t*>(p); }
mrcal_point2_t* as_mrcal(Eigen::Vector2d* q) { return reinterpret_cast<mrcal_point2_t*>(q); }

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
  const mrcal_lensmodel_t model = checked_model(lens, "lens");
  const std::size_t count = p_camera.size(), parameters = lens.intrinsics.size();
  if (q_px.size() != count)
    fail("lens", "room for " + std::to_string(q_px.size()) + " pixels for " + std::to_string(count) + " points",
         "give one each");
  if (dq_dp) dq_dp->resize(count);
  if (dq_dintrinsics) dq_dintrinsics->assign(count * 2 * parameters, 0);
  if (count == 0) return;
  static_assert(sizeof(PixelByPoint) == 2 * sizeof(mrcal_point3_t));
  auto* dq_dp_out = dq_dp ? reinterpret_cast<mrcal_point3_t*>(dq_dp->data()) : nullptr;

  bool ok = true;
  if (dq_dp && !dq_dintrinsics) {
    // libmrcal 2.2 returns a wrong dq_dp for several points at once unless dq_dintrinsics is asked for too. One point a
    // call is right, and cheaper than gradients that nobody wants.
    for (std::size_t i = 0; i < count && ok; ++i)
      ok = mrcal_project(as_mrcal(&q_px[i]), dq_dp_out + 2 * i, nullptr, as_mrcal(&p_camera[i]), 1, &model,
                         lens.intrinsics.data());
  } else if (dq_dintrinsics && !dq_dp) {
    std::vector<PixelByPoint> unused(count);
    ok = mrcal_project(as_mrcal(q_px.data()), reinterpret_cast<mrcal_point3_t*>(unused.data()), dq_dintrinsics->data(),
                       as_mrcal(p_camera.data()), static_cast<int>(count), &model, lens.intrinsics.data());
  } else {
    ok = mrcal_project(as_mrcal(q_px.data()), dq_dp_out, dq_dintrinsics ? dq_dintrinsics->data() : nullptr,
                       as_mrcal(p_camera.data()), static_cast<int>(count), &model, lens.intrinsics.data());
  }
  if (!ok) fail("lens", "mrcal could not project with " + lens.model, "use LENSMODEL_OPENCV4, 5 or 8");
}

void unproject(const Lens& lens, std::span<const Eigen::Vector2d> q_px, std::span<Eigen::Vector3d> v_camera) {
  const mrcal_lensmodel_t model = checked_model(lens, "lens");
  const std::size_t count = q_px.size();
  if (v_camera.size() != count)
    fail("lens", "room for " + std::to_string(v_camera.size()) + " directions for " + std::to_string(count) + " pixels",
         "give one each");
  if (count == 0) return;
  if (!mrcal_unproject(as_mrcal(v_camera.data()), as_mrcal(q_px.data()), static_cast<int>(count), &model,
                       lens.intrinsics.data()))
    fail("lens", "mrcal could not unproject with " + lens.model, "use LENSMODEL_OPENCV4, 5 or 8");

  // The inverse is iterative: where it stopped elsewhere (outside of the model's range), say so instead of lying.
  constexpr double kTolerance_px = 1e-4;  // mrcal's own solve ends at about 2e-8 px where it succeeds
  std::vector<Eigen::Vector2d> back(count);
  mrcal_project(as_mrcal(back.data()), nullptr, nullptr, as_mrcal(v_camera.data()), static_cast<int>(count), &model,
                lens.intrinsics.data());
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

int lens_parameter_count(const std::string& model) {
  const mrcal_lensmodel_t parsed = lens_model(model, "lens");
  return mrcal_lensmodel_num_params(&parsed);
}

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
  checked_model(lens, file.string());
  if (!(lens.intrinsics[0] > 0) || !(lens.intrinsics[1] > 0))
    json.fail_field("intrinsics", "has a focal length that is not greater than 0", "correct its first two numbers");
  return lens;
}

void write_cameramodel(const Lens& lens, const std::filesystem::path& file) {
  checked_model(lens, file.string());
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
