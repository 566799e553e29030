"""Every gradient of render_vjp against central differences of render, in double.

Differences at a step and at half of it are extrapolated (Richardson), which leaves errors of the fourth order. Radiance is float32, so
a difference of E = sum(w * radiance) has rounding noise: 2^-24 of each pixel, random in sign, over the step. Steps are chosen so that
both stay below the tolerance of 1e-3 of the largest derivative of the argument.

E has kinks where edges of grooves and pixels cross. An end's step meets few of them. A pose or a machine's map moves all grooves over
all pixels, so that some kinks lie within any step that rounding allows: 5e-3 and 1e-2 for these two.
"""

from __future__ import annotations

import dataclasses
import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pyburin as burin
from setups import BENCH, BOARD, Floats, scratches, weights

ENDS = scratches(60)
STEPS = {"ends_mm": 2e-3, "width_um": 1.0, "depth_um": 0.05, "alpha": 2e-4, "base_alpha": 2e-4, "lamp_mm": 0.05,
         "lamp_log_intensity": 2e-3, "pose": 2e-4, "bow_mm": 5e-3, "machine_map": 2e-5}

KINKS = {"pose": 5e-3, "machine_map": 1e-2}


def values(size: int, lights: int) -> dict[str, Any]:
    random = np.random.default_rng(5)
    return {
        "ends_mm": ENDS,
        "width_um": random.uniform(300, 500, size),
        "depth_um": random.uniform(8, 14, size),
        "alpha": random.uniform(0.07, 0.12, size),
        "base_alpha": 0.2,
        "lamp_mm": np.array([(-30.0, 22, 90), (25, 80, 100)])[:lights],
        "lamp_log_intensity": np.array([0.1, -0.2])[:lights],
        "pose": random.normal(0, 1, (2, 6)) * (0.03, 0.03, 0.03, 1, 1, 1),
        "bow_mm": np.array([0.3, -0.2, 0.1]),
        "machine_map": np.array([[1.002, 0.001, 0.1], [-0.002, 0.999, -0.2]]),
    }


def check(scene: burin.Scene, given: dict[str, Any], names: list[str], tolerance: float = 1e-3) -> None:
    dE = weights(scene.shape)

    def E(**changed: Any) -> float:
        arguments = {**given, **changed}
        return float((dE * burin.render(scene, arguments.pop("ends_mm"), **arguments)).sum())

    arguments = dict(given)
    by = burin.render_vjp(scene, arguments.pop("ends_mm"), dE, **arguments)
    random = np.random.default_rng(7)
    for name in names:
        at: Floats = np.asarray(given[name], dtype=float)
        gradient = np.asarray(getattr(by, name), dtype=float)
        assert gradient.shape == at.shape, name
        # All of a few numbers; of many, those that matter most and some others.
        order = np.argsort(-np.abs(gradient).ravel())
        places = order if at.size <= 12 else np.concatenate([order[:6], random.choice(order, 6, replace=False)])
        for place in places:
            step: Floats = np.zeros(at.shape)
            step.flat[place] = STEPS[name]
            wide, near = ((E(**{name: at + f * step}) - E(**{name: at - f * step})) / (2 * f * STEPS[name])
                          for f in (1, 0.5))
            by_hand = (4 * near - wide) / 3
            error = abs(by_hand - gradient.ravel()[place])
            # Pose's turns (per rad) and shifts (per mm) have each their own scale.
            scale = np.abs(gradient.reshape(-1, 6)[:, (place % 6) // 3 * 3:][:, :3]).max() if name == "pose" else \
                np.abs(gradient).max()
            assert error < max(tolerance, KINKS.get(name, 0)) * scale, (name, int(place), by_hand, gradient.ravel()[place])


def test_all_at_once_of_a_photo() -> None:
    given = values(len(ENDS), 1)
    check(burin.Scene(BENCH, BOARD, double=True, channels=3), given, list(given))


def test_float_packets_have_the_gradient_of_double() -> None:
    """Packets are accurate to 1e-6 (docs/model.md 4); sums over pixels of either sign lose two digits at most."""
    given = values(len(ENDS), 1)
    ends = given.pop("ends_mm")
    scenes = [burin.Scene(BENCH, BOARD, double=double) for double in (False, True)]
    fast, exact = (burin.render_vjp(scene, ends, weights(scene.shape), **given) for scene in scenes)
    for name in ("ends_mm", *given):
        one, other = (np.asarray(getattr(by, name)) for by in (fast, exact))
        assert np.abs(one - other).max() < 1e-4 * np.abs(other).max(), name


def test_two_lights() -> None:
    scene = burin.Scene(BENCH, BOARD, lights=["lamp", "other"], double=True)
    given = values(len(ENDS), 2)
    check(scene, given, list(given))


def test_pixels_on_the_board() -> None:
    scene = burin.Scene(BENCH, BOARD, pixels=40, double=True)
    given = {k: v for k, v in values(len(ENDS), 1).items() if k not in ("pose", "bow_mm")}
    check(scene, given, list(given))


def test_grooves_that_cut_each_other() -> None:
    """Through carve(): pieces move with the ends of both scratches that cross.

    A cut's end is a step in space, so differences have kinks of their own: 1 % of the largest.
    """
    bench = burin.Bench(BENCH.lens, BENCH.views, BENCH.lights, BENCH.material, crossings="last")
    check(burin.Scene(bench, BOARD, double=True), {"ends_mm": ENDS}, ["ends_mm"], 1e-2)


def test_grooves_whose_rims_are_cut() -> None:
    """As above; each lane of a rim ends where a deeper groove begins."""
    bench = burin.Bench(BENCH.lens, BENCH.views, BENCH.lights, BENCH.material, crossings="deepest")
    given = {"ends_mm": ENDS, "depth_um": values(len(ENDS), 1)["depth_um"]}
    check(burin.Scene(bench, BOARD, double=True), given, ["ends_mm"], 2e-2)


def test_a_bent_sheet() -> None:
    board = burin.Board(BOARD.size_mm, BOARD.carve_min_mm, BOARD.carve_max_mm, bend_radius_mm=80, bend_axis_deg=30)
    given = values(len(ENDS), 1)
    check(burin.Scene(BENCH, board, double=True), given, list(given))
    flat = burin.render(burin.Scene(BENCH, BOARD), ENDS)
    assert np.abs(burin.render(burin.Scene(BENCH, board), ENDS) - flat).max() > 0.1 * flat.max()


def far_bench() -> tuple[burin.Board, burin.Bench]:
    """The tests' setup with a sun beside its lamp: suns come from files."""
    sample = Path(__file__).parents[2] / "samples" / "small-bench"
    fields = json.loads((sample / "bench.json").read_text())
    fields["camera"] = str(sample / "camera.cameramodel")
    sun_in_file = {"direction": [-0.5, 0.1, 0.85], "irradiance": [1, 1, 1], "diameter_deg": 0.53}
    fields["lights"].append({"id": "sun", "sun": sun_in_file})
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "bench.json"
        file.write_text(json.dumps(fields))
        _, bench = burin.read(sample / "board.json", file)
    sun = next(light for light in bench.lights if light.id == "sun")
    return BOARD, dataclasses.replace(bench, lens=BENCH.lens, views=BENCH.views, material=BENCH.material, lights=[BENCH.lights[0], sun])


def test_under_the_sun_and_a_room() -> None:
    """Lights that come from files: ends, width, depth and roughness have gradients, lamps and poses are refused by name."""
    board, bench = far_bench()
    for lights in (["sun"], ["sun", "lamp"]):
        scene = burin.Scene(bench, board, lights=lights, double=True)
        given = {k: v for k, v in values(len(ENDS), 1).items() if k in ("ends_mm", "width_um", "depth_um", "alpha", "base_alpha")}
        check(scene, given, list(given))
        with pytest.raises(burin.Error, match="lamp_mm"):
            burin.render_vjp(scene, ENDS, np.ones(scene.shape), lamp_mm=np.zeros((len(lights), 3)))


def test_a_machine_map_is_the_same_as_mapped_ends() -> None:
    scene = burin.Scene(BENCH, BOARD)
    given, dE = values(len(ENDS), 1)["machine_map"], weights(scene.shape)
    mapped = ENDS @ given[:, :2].T + given[:, 2]
    assert np.allclose(burin.render(scene, ENDS, machine_map=given), burin.render(scene, mapped), rtol=1e-6, atol=0)
    by, by_mapped = burin.render_vjp(scene, ENDS, dE, machine_map=given), burin.render_vjp(scene, mapped, dE).ends_mm
    assert np.allclose(by.ends_mm, by_mapped @ given[:, :2], rtol=1e-9, atol=1e-9)
    places = np.concatenate([ENDS, np.ones((len(ENDS), 2, 1))], axis=2)
    assert by.machine_map is not None
    assert np.allclose(by.machine_map, np.einsum("nei,nej->ij", by_mapped, places), rtol=1e-9, atol=1e-9)


def test_one_number_has_the_sum_of_the_gradient() -> None:
    scene = burin.Scene(BENCH, BOARD)
    dE = weights(scene.shape)
    one = burin.render_vjp(scene, ENDS, dE, depth_um=9.0)
    each = burin.render_vjp(scene, ENDS, dE, depth_um=np.full(len(ENDS), 9.0))
    assert each.depth_um is not None and one.depth_um == each.depth_um.sum()
    assert one.alpha is None and one.pose is None


def test_what_has_no_derivative_is_refused_by_name() -> None:
    scene = burin.Scene(BENCH, BOARD, pixels=20)
    with pytest.raises(burin.Error, match="pose"):
        burin.render_vjp(scene, ENDS, np.zeros(scene.shape), pose=np.zeros((2, 6)))
