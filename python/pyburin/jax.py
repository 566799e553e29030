"""`render` for JAX: gradients, `jit`, `vmap` (one after the other) on the CPU. docs/python.md.

Work runs as a foreign function of XLA, without Python, so that it cannot wait for JAX's own threads. It needs a build
with JAX's headers (`pyburin.has("jax")`).
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from . import _checks, _core
from ._checks import Error
from ._render import Scene

if not hasattr(_core, "jax_handlers"):
    raise ImportError("this build of pyburin has no JAX: with jaxlib and the build's needs installed, run "
                      "pip install --no-build-isolation . in a clone")

import jax
import jax.numpy as jnp

for _name, _handler in _core.jax_handlers().items():
    jax.ffi.register_ffi_target(_name, _handler, platform="cpu")

_NAMES = ("ends_mm", "width_um", "depth_um", "alpha", "base_alpha", "lamp_mm", "lamp_log_intensity", "pose", "bow_mm")
# Scenes that compiled functions may call. They are kept, since nothing says when JAX drops such a function.
_kept: list[tuple[Scene, int]] = []


def _number_of(scene: Scene) -> int:
    for kept, number in _kept:
        if kept is scene:
            return number
    _kept.append((scene, _core.jax_keep(scene._core)))
    return _kept[-1][1]


@partial(jax.custom_vjp, nondiff_argnums=(0, 1, 2, 3))
def _call(number: int, shape: tuple[int, ...], given: int, carved: int, *values: Any) -> Any:
    return jax.ffi.ffi_call("burin_render", jax.ShapeDtypeStruct(shape, jnp.float32), vmap_method="sequential")(
        *values, scene=np.int64(number), given=np.int64(given), carved=np.int64(carved))


def _forward(number: int, shape: tuple[int, ...], given: int, carved: int, *values: Any) -> tuple[Any, Any]:
    return _call(number, shape, given, carved, *values), values


def _backward(number: int, shape: tuple[int, ...], given: int, carved: int, values: Any, dE: Any) -> Any:
    out = [jax.ShapeDtypeStruct(v.shape, v.dtype) for v in values]
    return tuple(jax.ffi.ffi_call("burin_render_vjp", out, vmap_method="sequential")(
        *values, dE, scene=np.int64(number), given=np.int64(given), carved=np.int64(carved)))


_call.defvjp(_forward, _backward)


def render(scene: Scene, ends_mm: Any, *, width_um: Any = None, depth_um: Any = None, alpha: Any = None,
           base_alpha: Any = None, lamp_mm: Any = None, lamp_log_intensity: Any = None, pose: Any = None,
           bow_mm: Any = None, machine_map: Any = None, carve: bool = True) -> jax.Array:
    """`pyburin.render` of JAX arrays, with gradients in reverse mode: (V, H, W, C) float32.

    Arguments: as `pyburin.render`, float32 or float64 (the latter if jax_enable_x64 is set). `scene` and `carve` are
    static. A scene that was used here lives until the process ends.

    Raises
    ------
    Error
        For a shape or type that is wrong, naming the argument.
    jax.errors.JaxRuntimeError
        For values that are wrong, naming the argument.
    """
    if not isinstance(scene, Scene):
        raise Error(f"scene: is {type(scene).__name__}; give a pyburin.Scene")
    _checks.in_this_process()
    carved = 0 if _checks.flag("carve", carve) else 1
    ends = _array("ends_mm", ends_mm)
    if ends.ndim not in (2, 3) or ends.shape[1:] not in ((4,), (2, 2)):
        raise Error(f"ends_mm: has the shape {ends.shape}; give (N, 2, 2) or (N, 4)")
    size, views, lights = ends.shape[0], scene.shape[0], len(scene.lights)
    if machine_map is not None:
        at = _array("machine_map", machine_map)
        if at.shape != (2, 3):
            raise Error(f"machine_map: has the shape {at.shape}; give (2, 3)")
        ends = ends.reshape(-1, 2) @ at[:, :2].T + at[:, 2]
    values, given = [ends.reshape(size, 4)], 1
    shapes: tuple[tuple[int, ...], ...] = ((size,), (size,), (size,), (), (lights, 3), (lights,), (views, 6), (3,))
    others = (width_um, depth_um, alpha, base_alpha, lamp_mm, lamp_log_intensity, pose, bow_mm)
    for k, (name, value, shape) in enumerate(zip(_NAMES[1:], others, shapes), start=1):
        if value is None:
            continue
        array = _array(name, value)
        if k <= 3 and array.ndim == 0:
            array = jnp.broadcast_to(array, shape)
        if array.shape != shape:
            raise Error(f"{name}: has the shape {array.shape}; give {shape}")
        values.append(array)
        given |= 1 << k
    out: jax.Array = _call(_number_of(scene), scene.shape, given, carved, *values)
    return out


def _array(name: str, value: Any) -> jax.Array:
    if not isinstance(value, (jax.Array, np.ndarray, float, int, list, tuple)) or isinstance(value, bool):
        raise Error(f"{name}: is {type(value).__name__}; give a JAX array")
    try:
        out = jnp.asarray(value)
    except (TypeError, ValueError) as error:
        raise Error(f"{name}: is no array of numbers ({error})") from None
    if jnp.issubdtype(out.dtype, jnp.integer):
        out = out.astype(float)
    if out.dtype not in (jnp.float32, jnp.float64):
        raise Error(f"{name}: has the type {out.dtype}; give float32 or float64")
    return out


def tone(radiance: Any, exposure: Any = 1.0, gamma: float = 2.2) -> jax.Array:
    """(exposure radiance)^(1 / gamma), clipped to 0..1, with gradients; below 1e-6 light counts as 1e-6."""
    out: jax.Array = jnp.clip(radiance * exposure, 1e-6, 1.0) ** (1 / gamma)
    return out
