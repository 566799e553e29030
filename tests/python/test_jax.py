"""pyburin.jax: its bits and gradients are pyburin's; jit, vmap, one core, errors. Skipped without JAX or a build for it."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import pyburin as burin
from setups import BENCH, BOARD, scratches, weights

jax = pytest.importorskip("jax", reason="no JAX here: pip install jax")
if not burin.has("jax"):
    pytest.skip("this build of pyburin has no JAX: scripts/python-tests makes one", allow_module_level=True)
jax.config.update("jax_enable_x64", True)
import jax.numpy as jnp  # noqa: E402

import pyburin.jax as burin_jax  # noqa: E402

GIVEN: dict[str, Any] = {
    "width_um": np.full(30, 380.0), "depth_um": np.linspace(8, 14, 30), "alpha": np.full(30, 0.09), "base_alpha": 0.2,
    "lamp_mm": np.array([(-30.0, 22, 90)]), "lamp_log_intensity": np.array([0.1]), "pose": np.full((2, 6), 0.01),
    "bow_mm": np.array([0.3, -0.2, 0.1]), "machine_map": np.array([[1.002, 0.001, 0.1], [-0.002, 0.999, -0.2]])}


def test_bits_and_every_gradient_are_those_of_numpy() -> None:
    scene, ends, dE = burin.Scene(BENCH, BOARD, channels=3), scratches(30), weights((2, 40, 48, 3))

    def E(ends: Any, given: Any) -> Any:
        return (burin_jax.render(scene, ends, **given) * dE).sum()

    without_map = {k: v for k, v in GIVEN.items() if k != "machine_map"}
    assert (np.asarray(burin_jax.render(scene, ends, **without_map)) == burin.render(scene, ends, **without_map)).all()
    by_ends, by = jax.jit(jax.grad(E, argnums=(0, 1)))(ends, GIVEN)
    want = burin.render_vjp(scene, ends, dE, **GIVEN)
    for name, got in (("ends_mm", by_ends), *by.items()):
        exact = np.asarray(getattr(want, name))
        assert got.shape == exact.shape
        # A machine's map is applied by JAX: the last bits of its product differ, and move light over edges of pixels.
        assert np.abs(np.asarray(got) - exact).max() <= 1e-6 * np.abs(exact).max(), name


def test_float32_arrays_have_float32_gradients() -> None:
    scene, ends = burin.Scene(BENCH, BOARD), scratches(30).astype(np.float32)
    got = jax.grad(lambda e: burin_jax.render(scene, e).sum())(jnp.asarray(ends))
    want = burin.render_vjp(scene, ends, np.ones(scene.shape)).ends_mm
    assert got.dtype == jnp.float32 and np.abs(np.asarray(got) - want).max() <= 1e-6 * np.abs(want).max()


def test_one_number_for_all_scratches() -> None:
    scene, ends = burin.Scene(BENCH, BOARD), scratches(30)
    got = jax.grad(lambda d: burin_jax.render(scene, ends, depth_um=d).sum())(9.0)
    want = burin.render_vjp(scene, ends, np.ones(scene.shape), depth_um=9.0).depth_um
    assert want is not None and abs(float(got) - want) <= 1e-9 * abs(want)


def test_check_grads() -> None:
    """JAX's own differences; radiance is float32, so that steps are 2e-3 mm, and E of a few numbers."""
    scene = burin.Scene(BENCH, BOARD, double=True, window_px=(14, 10, 14, 12))
    ends = jnp.asarray(scratches(8) * 0.3 + 14)
    scale = 1 / float(burin_jax.render(scene, ends).max())
    from jax.test_util import check_grads

    check_grads(lambda e: scale * burin_jax.render(scene, e).sum((1, 2, 3)), (ends,), 1, modes=("rev",), eps=2e-3,
                atol=5e-3, rtol=5e-3)


def test_vmap_and_one_scene_twice_in_a_graph() -> None:
    scene, sets = burin.Scene(BENCH, BOARD), np.stack([scratches(20, s) for s in range(3)])
    batch = jax.vmap(lambda e: burin_jax.render(scene, e))(sets)
    assert all((np.asarray(b) == burin.render(scene, s)).all() for b, s in zip(batch, sets))
    first, second = jax.grad(lambda a, b: (2 * burin_jax.render(scene, a) + burin_jax.render(scene, b)).sum(),
                             argnums=(0, 1))(sets[0], sets[1])
    ones = np.ones(scene.shape)
    assert np.allclose(first, burin.render_vjp(scene, sets[0], 2 * ones).ends_mm, rtol=1e-9, atol=0)
    assert np.allclose(second, burin.render_vjp(scene, sets[1], ones).ends_mm, rtol=1e-9, atol=0)


@pytest.mark.parametrize("name, value", [
    ("ends_mm", np.zeros((3, 3))), ("alpha", np.ones(4)), ("lamp_mm", np.zeros((2, 3))), ("pose", "text"),
    ("bow_mm", np.zeros(3, complex)), ("machine_map", np.zeros(6)), ("carve", 3)])
def test_wrong_shapes_are_refused_by_name(name: str, value: Any) -> None:
    scene = burin.Scene(BENCH, BOARD)
    with pytest.raises(burin.Error, match=name):
        burin_jax.render(**{"scene": scene, "ends_mm": scratches(5), name: value})


@pytest.mark.parametrize("name, value", [("ends_mm", np.full((5, 4), np.nan)), ("alpha", np.full(5, 2.0)),
                                         ("depth_um", np.zeros(5)), ("base_alpha", -1.0), ("lamp_mm", [[np.inf] * 3])])
def test_wrong_values_are_refused_by_name(name: str, value: Any) -> None:
    scene = burin.Scene(BENCH, BOARD)
    with pytest.raises(jax.errors.JaxRuntimeError, match=name):
        burin_jax.render(**{"scene": scene, "ends_mm": scratches(5), name: value}).block_until_ready()


def test_one_core_and_large_arrays_do_not_hang() -> None:
    """Callbacks into Python do: the array's copy waits for the one thread that waits for the callback (jax#24255)."""
    code = """
import os, sys
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
sys.path.insert(0, sys.argv[1])
import jax, jax.numpy as jnp, pyburin.jax
from setups import *
scene = burin.Scene(BENCH, BOARD)
step = jax.jit(jax.value_and_grad(lambda e: pyburin.jax.render(scene, e * 1.0001).sum()))
ends = jnp.asarray(np.tile(scratches(100), (2000, 1, 1)) + np.arange(200_000)[:, None, None] * 1e3)  # most lie far away
for _ in range(3):
    value, by = step(ends)
    ends = ends - 1e-12 * by
print(float(value))
"""
    import os
    subprocess.run([sys.executable, "-c", code, os.path.dirname(__file__)], check=True, timeout=200)
