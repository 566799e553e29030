"""Malformed calls: each raises pyburin.Error that names the argument; none crashes, hangs or gives NaN.

1,000 random calls, in which one argument of a sound call is replaced by something unsound, and cases by hand.
"""

from __future__ import annotations

from typing import Any, Callable

import numpy as np
import pytest

import pyburin as burin
from setups import BENCH, BOARD, LAMP, LENS, MATERIAL, VIEWS, scratches

SCENE = burin.Scene(BENCH, BOARD)
N = 20
PICTURE = np.linspace(0, 1, 24 * 24).reshape(24, 24)

# A sound call of each function, and the arguments that can be spoilt.
CALLS: list[tuple[Callable[..., Any], dict[str, Any]]] = [
    (burin.render, {"scene": SCENE, "ends_mm": scratches(N), "width_um": np.full(N, 400.0), "depth_um": 10.0,
                    "alpha": np.full(N, 0.1), "base_alpha": 0.2, "lamp_mm": np.array([(-30.0, 20, 90)]),
                    "lamp_log_intensity": np.zeros(1), "pose": np.zeros((2, 6)), "bow_mm": np.zeros(3),
                    "machine_map": np.eye(2, 3), "carve": True}),
    (burin.render_vjp, {"scene": SCENE, "ends_mm": scratches(N), "dE_dradiance": np.ones(SCENE.shape),
                        "depth_um": np.full(N, 10.0), "bow_mm": np.zeros(3), "pose": np.zeros((2, 6))}),
    (burin.footprint_integral, {"half": (0.1, 0, 1), "corners_mm": [(0, 0), (1, 0), (1, 1), (0, 1)], "alpha": 0.1,
                                "width_um": 400.0, "depth_um": 10.0, "length_mm": 5.0, "derivatives": True}),
    (burin.Scene, {"bench": BENCH, "board": BOARD, "views": ["above"], "lights": ["lamp"], "channels": 1,
                   "double": False}),
    (burin.Board, {"size_mm": (40, 40), "carve_min_mm": (1, 1), "carve_max_mm": (39, 39), "tool_width_um": 400.0,
                   "bend_radius_mm": 100.0}),
    (burin.Light, {"position_mm": (0, 0, 90), "intensity": (1, 1, 1), "axis": (0, 0, -1), "falloff_exponent": 1.0,
                   "panel_mm": (3, 4)}),
    (burin.Material, {"alpha": 0.1, "depth_um": 10.0, "base_alpha": 0.2, "f0": (0.9, 0.9, 0.9)}),
    (burin.Lens, {"model": "LENSMODEL_PINHOLE", "intrinsics": (100, 100, 20, 20), "width_px": 41, "height_px": 41}),
    (burin.View, {"name": "v", "T_camera_board": VIEWS[0].T_camera_board}),
    (burin.View.look_at, {"name": "v", "eye_mm": (0, 0, 100), "aim_mm": (0, 1, 0)}),
    (burin.Bench, {"lens": LENS, "views": VIEWS, "lights": [LAMP], "material": MATERIAL, "ambient": (0, 0, 0),
                   "bow_mm": (0, 0, 0), "crossings": "add"}),
    (burin.Targets, {"scene": burin.Scene(BENCH, BOARD, views=["above"], pixels=24), "targets": {"above": PICTURE},
                     "weights": burin.LossWeights(), "lift_blacks": 0.5}),
    (burin.relocate, {"targets": burin.Targets(burin.Scene(BENCH, BOARD, views=["above"], pixels=24), {"above": PICTURE}),
                      "ends_mm": scratches(N), "log_exposure": np.zeros(1), "share": 0.1, "seed": 3}),
    (burin.carve, {"bench": BENCH, "board": BOARD, "ends_mm": scratches(N), "alpha": np.full(N, 0.1)}),
    (burin.design, {"bench": BENCH, "board": BOARD, "targets": {"above": PICTURE}, "scratches": 100, "pixels": 24,
                    "iterations": 1, "seed": 1, "seconds": 0.0}),
]


class Strange:
    """Is no number, and says nothing useful."""

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise RuntimeError("no")


def unsound(value: Any, random: np.random.Generator) -> Any:
    """Something that no argument can take in the place of `value`."""
    anything = [Strange(), object(), {}, {1: 2}, b"x", lambda: 0, np.array(["a"]), np.array([None]),
                np.array([1 + 2j]), [[1, 2], [3]], [], np.zeros((0, 7)), np.datetime64("2026-01-01")]
    if isinstance(value, str):
        return anything[random.integers(len(anything))] if random.random() < 0.7 else 7
    if isinstance(value, (bool, dict, burin.Bench, burin.Board, burin.Scene, burin.Lens, burin.Material, burin.LossWeights,
                          burin.Targets)):
        anything = anything[:2] + anything[5:] + [None, 3, "text"]
        return anything[random.integers(len(anything))]
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":  # lists of views, of names
        return [Strange(), {}, 3, b"x", [object()], [3], [], "x", [*value, *value, 4]][random.integers(9)]
    if isinstance(value, int):
        return (anything + [-1, 2**70, 1.5, float("nan")])[random.integers(len(anything) + 4)]
    numbers = array.astype(float)
    broken = numbers.copy().reshape(-1)
    broken[random.integers(broken.size)] = random.choice([np.nan, np.inf, -np.inf])
    spoilt = [broken.reshape(numbers.shape), np.stack([numbers] * 3, -1), numbers.astype(complex), numbers.astype(str),
              numbers > 0, numbers.astype(object)]
    if numbers.size > 1:
        spoilt += [numbers[:-1] if numbers.shape[0] != N else numbers[:, :-1] if numbers.ndim > 1 else numbers[:-1],
                   np.concatenate([numbers, numbers], -1), numbers.ravel()[:1]]
    return (anything + spoilt)[random.integers(len(anything) + len(spoilt))]


@pytest.mark.parametrize("seed", range(1000))
def test_random_calls(seed: int) -> None:
    random = np.random.default_rng(seed)
    function, sound = CALLS[seed % len(CALLS)]
    name = list(sound)[random.integers(len(sound))]
    value = unsound(sound[name], random)
    try:
        result = function(**{**sound, name: value})
    except burin.Error as error:
        assert name in str(error), (name, value, str(error))
    else:  # footprint_integral broadcasts: other shapes, empty ones among them, may be sound
        assert function is burin.footprint_integral, f"{function}: {name}={value!r} is taken"
        assert np.isfinite(result.Dhat_mm2).all()


def test_sound_calls_work() -> None:
    for function, sound in CALLS:
        if function is not burin.design:
            function(**sound)


@pytest.mark.parametrize("name, value", [
    ("alpha", 0.0), ("alpha", -1.0), ("alpha", 1.5), ("depth_um", 0.0), ("width_um", -400.0), ("base_alpha", 0.0),
    ("lamp_mm", [(0, 0, -5)]), ("lamp_log_intensity", [1e5]),
    ("depth_um", np.zeros(N)), ("ends_mm", np.zeros(4)), ("ends_mm", scratches(N)[:, :1]), ("alpha", [])])
def test_values_out_of_range(name: str, value: Any) -> None:
    with pytest.raises(burin.Error):
        burin.render(**{"scene": SCENE, "ends_mm": scratches(N), name: value})


def test_lists_of_different_lengths() -> None:
    with pytest.raises(burin.Error, match="depth_um"):
        burin.render(SCENE, scratches(N), depth_um=[10.0] * (N - 1))
    with pytest.raises(burin.Error, match="ends_mm"):
        burin.render(SCENE, [[(1, 2), (3, 4)], [(1, 2)]])


def test_a_dark_or_hidden_setup_is_refused() -> None:
    behind = burin.View.look_at("behind", (20, 20, -100), (20, 21, 0))
    with pytest.raises(burin.Error, match="behind"):
        burin.Scene(burin.Bench(LENS, [behind], [LAMP], MATERIAL), BOARD)
    with pytest.raises(burin.Error, match="lamp"):
        burin.Scene(burin.Bench(LENS, VIEWS, [burin.Light("lamp", (20, 20, -1))], MATERIAL), BOARD)
    with pytest.raises(burin.Error, match="nobody"):
        burin.Scene(BENCH, BOARD, ["nobody"])


def test_a_scratch_without_length_is_dark() -> None:
    ends = scratches(N)
    ends[3, 1] = ends[3, 0]
    assert np.isfinite(burin.render(SCENE, ends)).all()
    by = burin.render_vjp(SCENE, ends, np.ones(SCENE.shape), depth_um=9.0)
    assert np.isfinite(by.ends_mm).all()


def test_a_file_that_is_gone(tmp_path: Any) -> None:
    with pytest.raises(burin.Error, match="gone.json"):
        burin.read(tmp_path / "gone.json", tmp_path / "bench.json")
    with pytest.raises(burin.Error, match="gone.csv"):
        burin.Scratches.read(tmp_path / "gone.csv")
    with pytest.raises(burin.Error, match="file"):
        burin.Scratches.read(3)  # type: ignore[arg-type]
