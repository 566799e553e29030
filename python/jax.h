// python/jax.h - Scene::render() and Scene::gradients() as foreign functions of XLA, for pyburin.jax. They run without
// Python, so that no callback can wait for the GIL or for JAX's own threads.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "scene.h"

namespace burin::python {

/// The number by which the functions know a scene, which must live until the process ends.
std::int64_t keep_for_jax(Scene& scene);

/// Addresses of the functions, by name. Both have the attributes `scene` (keep_for_jax()), `given` (bit k: argument k
/// of kJaxArguments is there) and `carved` (0 or 1), and the given arguments in order, float32 or float64, with shapes
/// (N, 4), (N,) three times, (), (L, 3), (L,), (V, 6), (3,).
///   burin_render      result: radiance (V, H, W, C) float32
///   burin_render_vjp  one more argument, dE/dradiance; results: dE by each given argument, of its type and shape
std::map<std::string, void*> jax_handlers();
inline constexpr const char* kJaxArguments[] = {"ends_mm", "width_um",           "depth_um", "alpha", "base_alpha",
                                                "lamp_mm", "lamp_log_intensity", "pose",     "bow_mm"};

}  // namespace burin::python
