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


def test_bits_of_cpp(tmp_path: Path) -> None:
    program = os.environ.get("BURIN_RADIANCE")
    if not program:
        pytest.skip("BURIN_RADIANCE names no program: scripts/python-tests builds it")
    board, bench = burin.read(*FILES[:2])
    assert board.carve_max_mm is not None
    random = np.random.default_rng(2)
    ends = random.uniform(board.carve_min_mm, board.carve_max_mm, (400, 2, 2))
    ends[:, 1] = ends[:, 0] + 0.1 * (ends[:, 1] - ends[:, 0])
    file = tmp_path / "scratches.csv"
    np.savetxt(file, ends.reshape(-1, 4), fmt="%.5f", delimiter=",", header="x0_mm,y0_mm,x1_mm,y1_mm", comments="")
    rows = burin.Scratches.read(file)
    assert np.abs(rows.ends_mm - ends).max() < 6e-6
    names, light = [v.name for v in bench.views[:2]], bench.lights[0].id
    raw = subprocess.run([program, *map(str, FILES[:2]), str(file), ",".join(names), light], check=True,
                         capture_output=True).stdout
    scene = burin.Scene(bench, board, names, [light])
    size = int(np.prod(scene.shape))
    radiance = np.frombuffer(raw[: 4 * size], np.float32).reshape(scene.shape)
    plain = burin.render(scene, np.zeros((0, 4)))
    assert (radiance != plain).mean() > 0.01  # the scratches are there
    assert (burin.render(scene, rows.ends_mm) == radiance).all()
    by = burin.render_vjp(scene, rows.ends_mm, np.ones(scene.shape))
    assert np.abs(by.ends_mm).max() > 0
    assert (by.ends_mm.ravel() == np.frombuffer(raw[4 * size:], np.float64)).all()
