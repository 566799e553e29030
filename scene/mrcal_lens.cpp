#include "burin/scene/mrcal_lens.h"

#include <string>

#include "burin/base/error.h"

#ifdef BURIN_MRCAL

extern "C" {  // mrcal.h has no guard for C++ of its own
#include <mrcal/mrcal.h>
}

namespace burin {
namespace {

using ByPoint = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;

static_assert(sizeof(mrcal_point2_t) == sizeof(Eigen::Vector2d) && sizeof(mrcal_point3_t) == sizeof(Eigen::Vector3d));

std::string known_models() {
  std::string names;
  for (const char* const* name = mrcal_supported_lensmodel_names(); *name; ++name)
    names += (names.empty() ? "" : ", ") + std::string(*name);
  return names;
}

mrcal_lensmodel_t mrcal_model(const std::string& name, const std::string& where) {
  mrcal_lensmodel_t model;
  if (!mrcal_lensmodel_from_name(&model, name.c_str()) || !mrcal_lensmodel_type_is_valid(model.type))
    fail(where, "mrcal knows no lens model \"" + name + "\"", "use one of " + known_models());
  if (model.type == MRCAL_LENSMODEL_CAHVORE)
    fail(where, "mrcal gives neither gradients nor an inverse for " + name,
         "convert it with mrcal-convert-lensmodel, to LENSMODEL_OPENCV8 for instance");
  if (model.type == MRCAL_LENSMODEL_SPLINED_STEREOGRAPHIC) {
    // mrcal accepts any numbers here and aborts the program later.
    const auto& config = model.LENSMODEL_SPLINED_STEREOGRAPHIC__config;
    if ((config.order != 2 && config.order != 3) || config.Nx < config.order + 1 || config.Ny < config.order + 1 ||
        config.fov_x_deg < 1 || config.fov_x_deg >= 360)
      fail(where, "the configuration in \"" + name + "\" makes no spline",
           "order is 2 or 3, Nx and Ny are at least order + 1, fov_x_deg lies between 1 and 359");
  }
  return model;
}

const mrcal_point3_t* as_mrcal(const Eigen::Vector3d* p) { return reinterpret_cast<const mrcal_point3_t*>(p); }
const mrcal_point2_t* as_mrcal(const Eigen::Vector2d* q) { return reinterpret_cast<const mrcal_point2_t*>(q); }
mrcal_point3_t* as_mrcal(Eigen::Vector3d* p) { return reinterpret_cast<mrcal_point3_t*>(p); }
mrcal_point2_t* as_mrcal(Eigen::Vector2d* q) { return reinterpret_cast<mrcal_point2_t*>(q); }

}  // namespace

int mrcal_parameter_count(const std::string& model, const std::string& where) {
  const mrcal_lensmodel_t parsed = mrcal_model(model, where);
  return mrcal_lensmodel_num_params(&parsed);
}

void mrcal_project(const std::string& name, const std::vector<double>& intrinsics,
                   std::span<const Eigen::Vector3d> p_camera, std::span<Eigen::Vector2d> q_px,
                   std::vector<ByPoint>* dq_dp, std::vector<double>* dq_dintrinsics) {
  const mrcal_lensmodel_t model = mrcal_model(name, "lens");
  const std::size_t count = p_camera.size();
  static_assert(sizeof(ByPoint) == 2 * sizeof(mrcal_point3_t));
  auto* dq_dp_out = dq_dp ? reinterpret_cast<mrcal_point3_t*>(dq_dp->data()) : nullptr;
  bool ok = true;
  if (dq_dp && !dq_dintrinsics) {
    // libmrcal 2.2 returns a wrong dq_dp for several points at once without a request for dq_dintrinsics. One point per
    // call is right, and cheaper than unused gradients.
    for (std::size_t i = 0; i < count && ok; ++i)
      ok = ::mrcal_project(as_mrcal(&q_px[i]), dq_dp_out + 2 * i, nullptr, as_mrcal(&p_camera[i]), 1, &model,
                           intrinsics.data());
  } else if (dq_dintrinsics && !dq_dp) {
    std::vector<ByPoint> unused(count);
    ok =
        ::mrcal_project(as_mrcal(q_px.data()), reinterpret_cast<mrcal_point3_t*>(unused.data()), dq_dintrinsics->data(),
                        as_mrcal(p_camera.data()), static_cast<int>(count), &model, intrinsics.data());
  } else {
    ok = ::mrcal_project(as_mrcal(q_px.data()), dq_dp_out, dq_dintrinsics ? dq_dintrinsics->data() : nullptr,
                         as_mrcal(p_camera.data()), static_cast<int>(count), &model, intrinsics.data());
  }
  if (!ok) fail("lens", "mrcal could not project with " + name, "use LENSMODEL_OPENCV4, 5 or 8");
}

void mrcal_unproject(const std::string& name, const std::vector<double>& intrinsics,
                     std::span<const Eigen::Vector2d> q_px, std::span<Eigen::Vector3d> v_camera) {
  const mrcal_lensmodel_t model = mrcal_model(name, "lens");
  if (!::mrcal_unproject(as_mrcal(v_camera.data()), as_mrcal(q_px.data()), static_cast<int>(q_px.size()), &model,
                         intrinsics.data()))
    fail("lens", "mrcal could not unproject with " + name, "use LENSMODEL_OPENCV4, 5 or 8");
}

}  // namespace burin

#else

namespace burin {

int mrcal_parameter_count(const std::string& model, const std::string& where) {
  fail(where, "this build of Burin has no mrcal, which \"" + model + "\" needs",
       "use LENSMODEL_PINHOLE, LENSMODEL_OPENCV4, 5, 8 or 12, or build with mrcal");
}

void mrcal_project(const std::string& model, const std::vector<double>&, std::span<const Eigen::Vector3d>,
                   std::span<Eigen::Vector2d>, std::vector<Eigen::Matrix<double, 2, 3, Eigen::RowMajor> >*,
                   std::vector<double>*) {
  mrcal_parameter_count(model, "lens");
}

void mrcal_unproject(const std::string& model, const std::vector<double>&, std::span<const Eigen::Vector2d>,
                     std::span<Eigen::Vector3d>) {
  mrcal_parameter_count(model, "lens");
}

}  // namespace burin

#endif
