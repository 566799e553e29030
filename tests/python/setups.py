"""A small setup for the tests: a board of 40 mm, two pinhole cameras whose photos lie within it, two lamps."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

import pyburin as burin

Floats = npt.NDArray[np.float64]

BOARD = burin.Board((40, 40), carve_min_mm=(2, 2), carve_max_mm=(38, 38))
LENS = burin.Lens("LENSMODEL_PINHOLE", (230, 230, 23.5, 19.5), 48, 40)
VIEWS = [burin.View.look_at("above", (20, 20, 100), (20, 20, 0)), burin.View.look_at("right", (60, 15, 110), (20, 20, 0))]
LAMP = burin.Light("lamp", (-30, 20, 90), (1e4, 1e4, 1e4))
LAMP_2 = burin.Light("other", (25, 80, 100), (8e3, 9e3, 1e4), falloff_exponent=1.0, axis=(0, -0.5, -1))
MATERIAL = burin.Material(alpha=0.1, depth_um=12)
BENCH = burin.Bench(LENS, VIEWS, [LAMP, LAMP_2], MATERIAL)


def scratches(count: int, seed: int = 1) -> Floats:
    """Random scratches of 3 mm, (count, 2, 2)."""
    random = np.random.default_rng(seed)
    middle = random.uniform(6, 34, (count, 2))
    angle = random.uniform(0, np.pi, count)
    half = 1.5 * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.stack([middle - half, middle + half], axis=1)


def weights(shape: tuple[int, ...]) -> Floats:
    """dE/dradiance of a linear E, as float32 holds it: waves of 18 and 25 pixels, others in each view and channel.

    Waves, and not noise: light that crosses an edge between two pixels has a kink in E as large as their weights differ.
    """
    view, row, column, channel = np.indices(shape)
    waves: Floats = np.cos(0.35 * column + 0.25 * row + view + 2 * channel) + 0.5
    return waves.astype(np.float32).astype(np.float64)
