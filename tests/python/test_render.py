"""Pictures: their shape, their bits for any number of threads, any layout of input, and several Python threads at once."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import pyburin as burin
from setups import BENCH, BOARD, scratches, weights


def test_shape_and_light() -> None:
    scene = burin.Scene(BENCH, BOARD, channels=3)
    picture = burin.render(scene, scratches(200))
    assert picture.shape == scene.shape == (2, 40, 48, 3)
    assert picture.dtype == np.float32
    plain = burin.render(scene, np.zeros((0, 2, 2)))
    assert np.isfinite(picture).all() and (plain > 0).all() and (picture != plain).mean() > 0.3  # grooves in the plain face


def test_double_and_float_paths_agree() -> None:
    fast = burin.render(burin.Scene(BENCH, BOARD), scratches(200))
    exact = burin.render(burin.Scene(BENCH, BOARD, double=True), scratches(200))
    assert np.abs(fast - exact).max() < 2e-5 * exact.max()  # float packets: 1e-6 each (docs/model.md 4)


def test_layouts_of_input_give_the_same_bits() -> None:
    scene, ends = burin.Scene(BENCH, BOARD), scratches(100)
    want = burin.render(scene, ends)
    read_only = ends.copy()
    read_only.flags.writeable = False
    wide = np.zeros((100, 2, 4))
    wide[:, :, ::2] = ends
    layouts = [ends.tolist(), ends.reshape(-1, 4), read_only, wide[:, :, ::2], np.asfortranarray(ends),
               ends[::-1].copy()[::-1], ends.astype(">f8")]
    for layout in layouts:
        assert (burin.render(scene, layout) == want).all()


def test_one_number_for_all_scratches_is_an_array_of_it() -> None:
    scene, ends = burin.Scene(BENCH, BOARD), scratches(50)
    for name, value in (("width_um", 300.0), ("depth_um", 8.0), ("alpha", 0.07)):
        one = burin.render(scene, ends, **{name: value})  # type: ignore[arg-type]
        assert (one == burin.render(scene, ends, **{name: np.full(50, value)})).all()  # type: ignore[arg-type]
        assert (one != burin.render(scene, ends)).any()


def test_threads_give_the_same_bits() -> None:
    scene = burin.Scene(BENCH, BOARD)
    sets = [scratches(300, seed) for seed in range(8)]
    dE = weights(scene.shape)
    want = [(burin.render(scene, s), burin.render_vjp(scene, s, dE, depth_um=9.0)) for s in sets]
    burin.set_threads(1)
    alone = [burin.render(scene, s) for s in sets]
    burin.set_threads(None)
    assert all((a == w[0]).all() for a, w in zip(alone, want))
    with ThreadPoolExecutor(8) as pool:  # one scene, eight Python threads, each call many times
        for _ in range(3):
            got = list(pool.map(lambda s: (burin.render(scene, s), burin.render_vjp(scene, s, dE, depth_um=9.0)), sets))
            for (picture, by), (picture_0, by_0) in zip(got, want):
                assert (picture == picture_0).all() and (by.ends_mm == by_0.ends_mm).all()
                assert by.depth_um == by_0.depth_um


def test_gil_is_released() -> None:
    scene, ends = burin.Scene(BENCH, BOARD, pixels=256, double=True), scratches(3000)
    done = threading.Event()

    def work() -> None:
        burin.render(scene, ends)
        done.set()

    worker = threading.Thread(target=work)
    worker.start()
    steps = 0
    while not done.wait(0.0005):  # returns now and then only if the other thread does not hold the GIL
        steps += 1
    worker.join()
    assert steps >= 3


def test_scene_keeps_its_inputs() -> None:
    T = np.array(BENCH.views[0].T_camera_board)
    view = burin.View("v", T)
    scene = burin.Scene(burin.Bench(BENCH.lens, [view], BENCH.lights, BENCH.material), BOARD)
    before = burin.render(scene, scratches(20))
    T[:] = 0
    assert (burin.render(scene, scratches(20)) == before).all()
    with pytest.raises(ValueError):
        np.asarray(view.T_camera_board)[0, 0] = 2  # read-only


def test_window_is_a_part_of_the_photo() -> None:
    all_of_it = burin.render(burin.Scene(BENCH, BOARD, double=True), scratches(100))
    part = burin.render(burin.Scene(BENCH, BOARD, double=True, window_px=(10, 5, 20, 30)), scratches(100))
    assert part.shape == (2, 30, 20, 1)
    assert np.abs(part - all_of_it[:, 5:35, 10:30]).max() <= 1e-6 * all_of_it.max()  # rounding of float


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_forked_child_is_refused() -> None:
    code = """
import os, sys
sys.path.insert(0, sys.argv[1])
from setups import *
scene = burin.Scene(BENCH, BOARD)
burin.render(scene, scratches(50))
child = os.fork()
if child == 0:
    try:
        burin.render(scene, scratches(50))
    except burin.Error as error:
        os._exit(0 if "spawn" in str(error) else 2)
    os._exit(3)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""
    assert subprocess.run([sys.executable, "-c", code, os.path.dirname(__file__)], timeout=60).returncode == 0
