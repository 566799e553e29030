"""The design in the open: loss, guided start, search and pruning for a person's own loop; and what carve() leaves of grooves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pyburin as burin
from setups import scratches
from test_design import BENCH, BOARD, TARGETS

SCENE = burin.Scene(BENCH, BOARD, pixels=48)
PICTURES = burin.Targets(SCENE, TARGETS)


def test_the_loss_is_that_of_design() -> None:
    """design() reports the loss of its result at its own exposures; the same pictures have the same loss here."""
    made = burin.design(BENCH, BOARD, TARGETS, scratches=400, pixels=48, iterations=0)
    radiance = burin.render(SCENE, made.scratches.ends_mm)
    at_best = PICTURES.loss(radiance, PICTURES.fit_exposure(radiance)).value
    assert abs(at_best - made.loss) < 0.01 * made.loss  # its exposures are fitted, too
    assert np.abs(PICTURES.psnr_db(radiance) - [v.psnr_db for v in made.views]).max() < 1e-3


@pytest.mark.parametrize("weights", [burin.LossWeights(), burin.LossWeights(0, 1, 0.01)])
def test_derivatives_of_the_loss(weights: burin.LossWeights) -> None:
    """Central differences; radiance is float32, whose rounding over a step of 2 % of the largest is 1e-5 of the derivative."""
    pictures = burin.Targets(SCENE, TARGETS, weights=weights)
    radiance = burin.render(SCENE, scratches(300) * 1.2 + 6)
    at = pictures.fit_exposure(radiance)
    loss = pictures.loss(radiance, at)
    random = np.random.default_rng(3)
    for place in random.choice(radiance.size, 12, replace=False):
        step = np.zeros(radiance.size, np.float32)
        step[place] = 0.02 * radiance.max()
        step = step.reshape(radiance.shape)
        high, low = (pictures.loss(radiance + s * step, at).value for s in (1, -1))
        up = float((radiance + step).flat[place]) - float((radiance - step).flat[place])
        want = (high - low) / up
        assert abs(loss.dE_dradiance.flat[place] - want) < 0.03 * np.abs(loss.dE_dradiance).max()
    for view in range(2):
        turn = np.eye(2)[view] * 1e-3
        want = (pictures.loss(radiance, at + turn).value - pictures.loss(radiance, at - turn).value) / 2e-3
        assert abs(loss.dE_dlog_exposure[view] - want) < 1e-3 * np.abs(loss.view_loss).max()


def test_start_search_and_pruning_lower_the_error() -> None:
    start = burin.guided_start(PICTURES, 800, seed=2)
    radiance = burin.render(SCENE, start.ends_mm)
    at_start = PICTURES.loss(radiance, start.log_exposure).value
    anywhere = burin.render(SCENE, scratches(800) * 1.2 + 6)
    assert at_start < 0.5 * PICTURES.loss(anywhere, PICTURES.fit_exposure(anywhere)).value
    moved = burin.relocate(PICTURES, start.ends_mm, start.log_exposure, seed=5)
    assert 0 < len(moved.rows) <= 800
    still = np.setdiff1d(np.arange(800), moved.rows)
    assert (moved.ends_mm[still] == start.ends_mm[still]).all()
    after = PICTURES.loss(burin.render(SCENE, moved.ends_mm), moved.log_exposure).value
    assert after < at_start
    fewer = burin.drop_weak(PICTURES, moved.ends_mm, moved.log_exposure, share=0.1)
    assert len(fewer.rows) == 720 and (fewer.ends_mm == moved.ends_mm[fewer.rows]).all()
    dropped = PICTURES.loss(burin.render(SCENE, fewer.ends_mm), fewer.log_exposure).value
    random = np.random.default_rng(1).permutation(800)[:720]
    assert dropped < PICTURES.loss(burin.render(SCENE, moved.ends_mm[random]), moved.log_exposure).value
    again = burin.guided_start(PICTURES, 800, seed=2)
    assert (again.ends_mm == start.ends_mm).all() and (again.log_exposure == start.log_exposure).all()


def test_search_of_grooves_that_cut_each_other() -> None:
    bench = burin.Bench(BENCH.lens, BENCH.views, BENCH.lights, BENCH.material, crossings="deepest")
    scene = burin.Scene(bench, BOARD, pixels=32)
    pictures = burin.Targets(scene, TARGETS)
    start = burin.guided_start(pictures, 200)
    at_start = pictures.loss(burin.render(scene, start.ends_mm), start.log_exposure).value
    moved = burin.relocate(pictures, start.ends_mm, start.log_exposure)
    assert pictures.loss(burin.render(scene, moved.ends_mm), moved.log_exposure).value < at_start


def test_carve_leaves_what_render_shows() -> None:
    ends = scratches(60, 4) * 1.2 + 6
    whole = burin.carve(BENCH, BOARD, ends)
    assert (whole.ends_mm == ends).all() and (whole.scratch == np.arange(60)).all()
    bench = burin.Bench(BENCH.lens, BENCH.views, BENCH.lights, BENCH.material, crossings="last")
    cut = burin.carve(bench, BOARD, ends)
    assert len(cut.scratch) > 60 and set(cut.scratch) <= set(range(60))
    scene = burin.Scene(bench, BOARD, pixels=32)
    of_pieces = burin.render(scene, cut.ends_mm, width_um=cut.width_um, depth_um=cut.depth_um, alpha=cut.alpha, carve=False)
    assert np.abs(of_pieces - burin.render(scene, ends)).max() < 1e-5 * of_pieces.max()


@pytest.mark.parametrize("changed, word", [
    ({"scene": 3}, "scene"), ({"scene": burin.Scene(BENCH, BOARD)}, "scene"), ({"targets": {}}, "targets"),
    ({"targets": {"top": TARGETS["top"]}}, "right"), ({"targets": {**TARGETS, "top": TARGETS["top"] * 9}}, "targets"),
    ({"weights": 1}, "weights"), ({"lift_blacks": -1}, "lift_blacks"),
    ({"scene": burin.Scene(BENCH, BOARD, pixels=(48, 20))}, "pixels")])
def test_refusals(changed: dict[str, Any], word: str) -> None:
    with pytest.raises(burin.Error, match=word):
        burin.Targets(**{"scene": SCENE, "targets": TARGETS, **changed})


@pytest.mark.parametrize("changed, word", [
    ({"targets": SCENE}, "targets"), ({"ends_mm": np.zeros((0, 4))}, "ends_mm"), ({"ends_mm": [[np.nan] * 4]}, "ends_mm"),
    ({"log_exposure": [0]}, "log_exposure"), ({"log_exposure": [0, 1e9]}, "log_exposure"), ({"share": 2}, "share"),
    ({"seed": -1}, "seed")])
def test_refusals_of_the_search(changed: dict[str, Any], word: str) -> None:
    sound: dict[str, Any] = {"targets": PICTURES, "ends_mm": scratches(10), "log_exposure": [0, 0]}
    with pytest.raises(burin.Error, match=word):
        burin.relocate(**{**sound, **changed})
