"""design(): a disk in one view and a ramp in another, watched, stopped, and refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pyburin as burin

BOARD = burin.Board((60, 60), carve_min_mm=(10, 10), carve_max_mm=(50, 50))
LENS = burin.Lens("LENSMODEL_PINHOLE", (100, 100, 50, 50), 101, 101)
VIEWS = [burin.View.look_at("right", (230, 30, 450), (30, 30, 0)), burin.View.look_at("top", (30, 230, 450), (30, 30, 0))]
BENCH = burin.Bench(LENS, VIEWS, [burin.Light("lamp", (30, 30, 500))], burin.Material(alpha=0.06, depth_um=12))
Y, X = np.mgrid[:64, :64]
TARGETS = {"right": np.where(np.hypot(X - 31.5, Y - 31.5) < 20, 0.8, 0.2), "top": 0.2 + 0.6 * X / 63}


def test_each_view_shows_its_picture() -> None:
    frames: list[burin.Frame] = []
    made = burin.design(BENCH, BOARD, TARGETS, scratches=1200, pixels=64, iterations=12, on_frame=frames.append)
    assert [v.view for v in made.views] == ["right", "top"]
    assert made.psnr_db > 17 and len(made.scratches.ends_mm) > 300
    assert frames[-1].iteration == 12 and frames[-1].loss > 0
    for view, other in zip(made.views, made.views[::-1]):
        own = np.corrcoef(view.shown.ravel(), view.target.ravel())[0, 1]
        assert own > 0.85 and own > np.corrcoef(view.shown.ravel(), other.target.ravel())[0, 1] + 0.3
    # What design() says is shown is what render() shows, at its exposure.
    scene = burin.Scene(BENCH, BOARD, pixels=64)
    shown = burin.tone(burin.render(scene, made.scratches.ends_mm),
                       np.array([v.exposure for v in made.views]).reshape(-1, 1, 1, 1))
    for ours, view in zip(shown, made.views):
        assert np.abs(ours - view.shown).max() < 2e-3  # float, and exposures of the design's own rounding


def test_the_same_seed_gives_the_same_bits() -> None:
    one, other = (burin.design(BENCH, BOARD, TARGETS, scratches=200, pixels=24, iterations=2, seed=3) for _ in range(2))
    assert (one.scratches.ends_mm == other.scratches.ends_mm).all()


def test_stopping_keeps_what_there_is() -> None:
    made = burin.design(BENCH, BOARD, TARGETS, scratches=300, pixels=32, iterations=1000,
                        on_frame=lambda frame: frame.iteration < 3)
    assert len(made.scratches.ends_mm) > 0 and made.iterations < 10


@pytest.mark.parametrize("raised", [ZeroDivisionError, KeyboardInterrupt])
def test_exceptions_of_the_callback_pass(raised: type[BaseException]) -> None:
    def on_frame(frame: burin.Frame) -> None:
        raise raised

    with pytest.raises(raised):
        burin.design(BENCH, BOARD, TARGETS, scratches=300, pixels=32, iterations=1000, on_frame=on_frame)


@pytest.mark.parametrize("changed, word", [
    ({"targets": {}}, "targets"), ({"targets": {"nobody": TARGETS["top"]}}, "nobody"),
    ({"targets": {"top": TARGETS["top"] * 9}}, "targets"), ({"targets": {"top": np.zeros((0, 4))}}, "targets"),
    ({"light": "moon"}, "moon"), ({"scratches": 0}, "scratches"), ({"on_frame": 3}, "on_frame"),
    ({"start_mm": np.zeros((3, 2))}, "ends_mm")])
def test_refusals(changed: dict[str, Any], word: str) -> None:
    sound: dict[str, Any] = {"bench": BENCH, "board": BOARD, "targets": TARGETS, "scratches": 100, "pixels": 24,
                             "iterations": 1}
    with pytest.raises(burin.Error, match=word):
        burin.design(**{**sound, **changed})
