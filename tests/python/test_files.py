"""A setup read from files gives the bits that C++ gives (tests/python/radiance.cpp), pictures and gradients.

BURIN_RADIANCE names that program (scripts/python-tests builds it); without it the comparison is skipped.
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import pyburin as burin

RIG = Path(__file__).parents[1] / "data" / "rigs" / "bench-loop"
FILES = RIG / "board.json", RIG / "bench.json", RIG / "scratches.csv"


def test_fields_survive_reading() -> None:
    board, bench = burin.read(*FILES[:2])
    assert board.size_mm[0] > 0 and bench.views and bench.lights
    assert bench.lens.width_px > 0 and bench.material.alpha > 0
    rows = burin.Scratches.read(FILES[2])
    assert rows.ends_mm.ndim == 3 and rows.ends_mm.shape[1:] == (2, 2)


def test_bits_of_cpp() -> None:
    program = os.environ.get("BURIN_RADIANCE")
    if not program:
        pytest.skip("BURIN_RADIANCE names no program: scripts/python-tests builds it")
    board, bench = burin.read(*FILES[:2])
    rows = burin.Scratches.read(FILES[2])
    for view in bench.views[:2]:
        light = bench.lights[0].id
        raw = subprocess.run([program, *map(str, FILES), view.name, light], check=True, capture_output=True).stdout
        scene = burin.Scene(bench, board, [view.name], [light])
        size = int(np.prod(scene.shape))
        radiance = np.frombuffer(raw[: 4 * size], np.float32).reshape(scene.shape)
        assert radiance.max() > 0
        assert (burin.render(scene, rows.ends_mm, width_um=rows.width_um, depth_um=rows.depth_um,
                             alpha=rows.alpha) == radiance).all()
        by = burin.render_vjp(scene, rows.ends_mm, np.ones(scene.shape), width_um=rows.width_um,
                              depth_um=rows.depth_um, alpha=rows.alpha)
        assert (by.ends_mm.ravel() == np.frombuffer(raw[4 * size:], np.float64)).all()
