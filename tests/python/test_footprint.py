"""footprint_integral against tests/data/ndf-cases.csv: 150 exact cases, by the tolerances of `burin check ndf`
(render/footprint/ndf_cases.h): values 1e-9 relative or 1e-14 of diameter^2 times the lobe's peak, derivatives 1e-8 of the row's largest.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

import pyburin as burin
from setups import Floats

CASES = Path(__file__).parents[1] / "data" / "ndf-cases.csv"


def test_exact_cases() -> None:
    with CASES.open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 150

    def of(*names: str) -> Floats:
        return np.array([[float(row[n]) for n in names] for row in rows])

    corner_names = [f"{axis}{k}" for k in range(4) for axis in "xy"]
    half = of("hx", "hy", "hz")
    corners = of(*(f"{n}_mm" for n in corner_names)).reshape(-1, 4, 2)
    alpha, width, depth, length = of("alpha", "width_um", "depth_um", "L_mm").T
    got = burin.footprint_integral(half, corners, alpha, width, depth, length, derivatives=True)
    plain = burin.footprint_integral(half, corners, alpha, width, depth, length)
    assert (plain.Dhat_mm2 == got.Dhat_mm2).all() and plain.dDhat_dalpha is None

    across = corners[:, :, None] - corners[:, None]
    diameter2 = (across**2).sum(-1).max((1, 2))
    want = of("Dhat_mm2", "area_mm2").T
    assert (np.abs(got.Dhat_mm2 - want[0]) <= np.maximum(1e-9 * want[0], 1e-14 * diameter2 / (np.pi * alpha**2))).all()
    assert (np.abs(got.area_mm2 - want[1]) <= np.maximum(1e-9 * want[1], 1e-14 * diameter2)).all()

    h = half / np.linalg.norm(half, axis=1, keepdims=True)

    def tangential(g: Floats) -> Floats:
        out: Floats = g - (g * h).sum(1, keepdims=True) * h
        return out

    def columns(*names: str) -> Floats:
        return np.column_stack([getattr(got, name) for name in names])

    assert got.dDhat_dhalf is not None and got.dDhat_dcorners_mm is not None and got.darea_dcorners_mm is not None
    ours = np.column_stack([tangential(got.dDhat_dhalf),
                            columns("dDhat_dalpha", "dDhat_dwidth_um", "dDhat_ddepth_um", "dDhat_dlength_mm"),
                            got.dDhat_dcorners_mm.reshape(-1, 8)])
    exact = np.column_stack([tangential(of("dDhat_dhx", "dDhat_dhy", "dDhat_dhz")),
                             of("dDhat_dalpha", "dDhat_dwidth_um", "dDhat_ddepth_um", "dDhat_dL_mm"),
                             of(*(f"dDhat_d{n}" for n in corner_names))])
    floor = 1e-14 * (diameter2 / (np.pi * alpha**2))[:, None]
    assert (np.abs(ours - exact) <= np.maximum(1e-8 * np.abs(exact).max(1, keepdims=True), floor)).all()
    ours = np.column_stack([columns("darea_dwidth_um", "darea_ddepth_um", "darea_dlength_mm"),
                            got.darea_dcorners_mm.reshape(-1, 8)])
    exact = np.column_stack([of("darea_dwidth_um", "darea_ddepth_um", "darea_dL_mm"),
                             of(*(f"darea_d{n}" for n in corner_names))])
    assert (np.abs(ours - exact) <= np.maximum(1e-8 * np.abs(exact).max(1, keepdims=True), 1e-14)).all()


def test_arguments_broadcast() -> None:
    square = np.array([(-0.1, 1), (0.1, 1), (0.1, 1.2), (-0.1, 1.2)])
    alphas = np.array([0.05, 0.1, 0.2])
    depths = np.array([[8.0], [12.0]])
    got = burin.footprint_integral((0.1, 0.02, 1), square, alphas, 400, depths, 5, derivatives=True)
    assert got.Dhat_mm2.shape == (2, 3)
    assert got.dDhat_dcorners_mm is not None and got.dDhat_dcorners_mm.shape == (2, 3, 4, 2)
    one = burin.footprint_integral((0.1, 0.02, 1), square, 0.1, 400, 12, 5)
    assert one.Dhat_mm2.shape == () and one.Dhat_mm2 == got.Dhat_mm2[1, 1]
    with pytest.raises(burin.Error, match="broadcast"):
        burin.footprint_integral((0.1, 0.02, 1), square, alphas, 400, np.ones(2), 5)
