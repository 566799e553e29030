#include "jax.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <mutex>
#include <optional>
#include <vector>

#include "burin/base/error.h"
#include "xla/ffi/api/ffi.h"

namespace burin::python {
namespace {

namespace ffi = xla::ffi;

enum Argument { kEnds, kWidth, kDepth, kAlpha, kBaseAlpha, kLamp, kLogIntensity, kPose, kBow, kArguments };

std::mutex scenes_mutex;
std::vector<Scene*> kept_scenes;

Scene& scene_number(std::int64_t number) {
  const std::lock_guard lock(scenes_mutex);
  if (number < 0 || number >= static_cast<std::int64_t>(kept_scenes.size()))
    fail("scene", "is of another process", "trace the function again in this one");
  return *kept_scenes[static_cast<std::size_t>(number)];
}

std::vector<double> numbers_in(const ffi::AnyBuffer& buffer, const char* name) {
  std::vector<double> out(buffer.element_count());
  if (buffer.element_type() == ffi::F32)
    std::copy_n(static_cast<const float*>(buffer.untyped_data()), out.size(), out.begin());
  else if (buffer.element_type() == ffi::F64)
    std::copy_n(static_cast<const double*>(buffer.untyped_data()), out.size(), out.begin());
  else
    fail(name, "is neither float32 nor float64", "convert it");
  if (!std::ranges::all_of(out, [](double v) { return std::isfinite(v); }))
    fail(name, "has a value that is not finite", "replace or drop it");
  return out;
}

using Given = std::array<std::optional<std::vector<double>>, kArguments>;

Given given_in(std::int64_t given, const ffi::RemainingArgs& arguments) {
  Given out;
  std::size_t next = 0;
  for (std::size_t k = 0; k < kArguments; ++k) {
    if ((given >> k & 1) == 0) continue;
    const auto buffer = arguments.get<ffi::AnyBuffer>(next++);
    if (!buffer.has_value()) fail(kJaxArguments[k], "is missing", "call pyburin.jax.render");
    out[k] = numbers_in(*buffer, kJaxArguments[k]);
  }
  return out;
}

void need_size(const Given& given, Argument which, std::size_t size) {
  if (given[which] && given[which]->size() != size) fail(kJaxArguments[which], "has the wrong size", "check its shape");
}

Scratches rows_in(const Given& given) {
  if (!given[kEnds] || given[kEnds]->size() % 4 != 0) fail("ends_mm", "has not 4 numbers per scratch", "give (N, 4)");
  const std::vector<double>& e = *given[kEnds];
  Scratches out;
  const std::size_t size = e.size() / 4;
  for (auto* c : {&out.x0_mm, &out.y0_mm, &out.x1_mm, &out.y1_mm}) c->resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    out.x0_mm[i] = e[4 * i], out.y0_mm[i] = e[4 * i + 1];
    out.x1_mm[i] = e[4 * i + 2], out.y1_mm[i] = e[4 * i + 3];
  }
  for (const Argument which : {kWidth, kDepth, kAlpha}) {
    need_size(given, which, size);
    if (given[which] &&
        !std::ranges::all_of(*given[which], [&](double v) { return v > 0 && (which != kAlpha || v <= 1); }))
      fail(kJaxArguments[which], "has a value out of range", "give numbers above 0, and alpha at most 1");
  }
  out.width_um = given[kWidth].value_or(std::vector<double>{});
  out.depth_um = given[kDepth].value_or(std::vector<double>{});
  out.alpha = given[kAlpha].value_or(std::vector<double>{});
  return out;
}

Changes changes_in(const Given& given, const Scene& scene) {
  need_size(given, kBaseAlpha, 1);
  need_size(given, kLamp, 3 * scene.lights());
  need_size(given, kLogIntensity, scene.lights());
  need_size(given, kPose, 6 * scene.views());
  need_size(given, kBow, 3);
  Changes out;
  if (given[kBaseAlpha]) {
    out.base_alpha = given[kBaseAlpha]->front();
    if (!(*out.base_alpha > 0 && *out.base_alpha <= 1)) fail("base_alpha", "is out of range", "give 0 to 1");
  }
  if (given[kLamp]) {
    out.lamp_mm.emplace();
    for (std::size_t k = 0; k < scene.lights(); ++k)
      out.lamp_mm->push_back(Eigen::Map<const Eigen::Vector3d>(given[kLamp]->data() + 3 * k));
  }
  out.lamp_log_intensity = given[kLogIntensity];
  if (given[kPose]) {
    out.pose.emplace();
    for (std::size_t v = 0; v < scene.views(); ++v)
      out.pose->push_back(Eigen::Map<const Eigen::Vector<double, 6>>(given[kPose]->data() + 6 * v));
  }
  if (given[kBow]) out.bow_mm = Eigen::Map<const Eigen::Vector3d>(given[kBow]->data());
  return out;
}

// What the work throws becomes JAX's error.
template <typename Work>
ffi::Error answer(const Work& work) {
  try {
    work();
    return ffi::Error::Success();
  } catch (const std::exception& error) {
    return ffi::Error::InvalidArgument(error.what());
  }
}

ffi::Error render_for_jax(std::int64_t scene_id, std::int64_t given, std::int64_t carved, ffi::RemainingArgs arguments,
                          ffi::Result<ffi::Buffer<ffi::F32>> radiance) {
  return answer([&] {
    Scene& scene = scene_number(scene_id);
    const Given in = given_in(given, arguments);
    const std::vector<Image> images = scene.render(rows_in(in), changes_in(in, scene), carved != 0);
    float* to = radiance->typed_data();
    for (const Image& image : images) to = std::copy(image.data.begin(), image.data.end(), to);
  });
}

void put(const ffi::RemainingRets& results, std::size_t index, const std::vector<double>& values) {
  auto result = results.get<ffi::AnyBuffer>(index);
  if (!result.has_value() || (*result)->element_count() != values.size())
    fail("gradient", "has the wrong size", "call pyburin.jax.render");
  if ((*result)->element_type() == ffi::F32)
    std::ranges::copy(std::vector<float>(values.begin(), values.end()), static_cast<float*>((*result)->untyped_data()));
  else
    std::ranges::copy(values, static_cast<double*>((*result)->untyped_data()));
}

template <typename V>
std::vector<double> flat(const std::vector<V>& rows) {
  std::vector<double> out;
  for (const V& row : rows) out.insert(out.end(), row.data(), row.data() + row.size());
  return out;
}

ffi::Error vjp_for_jax(std::int64_t scene_id, std::int64_t given, std::int64_t carved, ffi::RemainingArgs arguments,
                       ffi::RemainingRets results) {
  return answer([&] {
    Scene& scene = scene_number(scene_id);
    const Given in = given_in(given, arguments);
    const auto dE = arguments.get<ffi::AnyBuffer>(arguments.size() - 1);
    const std::vector<double> values = numbers_in(*dE, "dE_dradiance");
    const auto pixels = static_cast<std::size_t>(scene.width()) * static_cast<std::size_t>(scene.height()) *
                        static_cast<std::size_t>(scene.channels());
    if (values.size() != pixels * scene.views()) fail("dE_dradiance", "has the wrong size", "call pyburin.jax.render");
    std::vector<Image> images;
    for (std::size_t v = 0; v < scene.views(); ++v) {
      images.emplace_back(scene.width(), scene.height(), scene.channels());
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(v * pixels), pixels, images.back().data.begin());
    }
    const Gradients by = scene.gradients(rows_in(in), changes_in(in, scene), carved != 0, images);
    const ScratchGradients& s = by.scratches;
    std::vector<double> ends;
    for (std::size_t i = 0; i < s.x0_mm.size(); ++i)
      ends.insert(ends.end(), {s.x0_mm[i], s.y0_mm[i], s.x1_mm[i], s.y1_mm[i]});
    const std::array<std::vector<double>, kArguments> all{ends,
                                                          s.width_um,
                                                          s.depth_um,
                                                          s.alpha,
                                                          {by.base_alpha},
                                                          flat(by.lamp_mm),
                                                          by.lamp_log_intensity,
                                                          flat(by.pose),
                                                          {by.bow_mm.x(), by.bow_mm.y(), by.bow_mm.z()}};
    std::size_t next = 0;
    for (std::size_t k = 0; k < kArguments; ++k)
      if (in[k]) put(results, next++, all[k]);
  });
}

XLA_FFI_DEFINE_HANDLER(kRender, render_for_jax,
                       ffi::Ffi::Bind()
                           .Attr<std::int64_t>("scene")
                           .Attr<std::int64_t>("given")
                           .Attr<std::int64_t>("carved")
                           .RemainingArgs()
                           .Ret<ffi::Buffer<ffi::F32>>());
XLA_FFI_DEFINE_HANDLER(kVjp, vjp_for_jax,
                       ffi::Ffi::Bind()
                           .Attr<std::int64_t>("scene")
                           .Attr<std::int64_t>("given")
                           .Attr<std::int64_t>("carved")
                           .RemainingArgs()
                           .RemainingRets());

}  // namespace

std::int64_t keep_for_jax(Scene& scene) {
  const std::lock_guard lock(scenes_mutex);
  kept_scenes.push_back(&scene);
  return static_cast<std::int64_t>(kept_scenes.size()) - 1;
}

std::map<std::string, void*> jax_handlers() {
  return {{"burin_render", reinterpret_cast<void*>(kRender)}, {"burin_render_vjp", reinterpret_cast<void*>(kVjp)}};
}

}  // namespace burin::python
