#!/usr/bin/env python3
"""Measure what one pyburin call costs more than the same work in C++, for 40,000 scratches in two views.

    python_overhead.py RADIANCE [--repeats N] [--rounds N]

RADIANCE is the program burin_python_radiance (scripts/python-tests builds it). Both use one thread, and its CPU time counts. C++ and
Python take turns; the least time of all rounds counts for each, as other work on the machine only adds to times. --beside puts the
scratches beside the board: less to render, the same to hand over.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any, Callable

import numpy as np

import pyburin as burin

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "small-bench"


def least_ms(work: Callable[[], Any], repeats: int) -> float:
    least = float("inf")
    for _ in range(repeats):
        begin = time.thread_time()
        work()
        least = min(least, time.thread_time() - begin)
    return 1000 * least


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("radiance", type=Path)
    arguments.add_argument("--repeats", type=int, default=30)
    arguments.add_argument("--rounds", type=int, default=4)
    arguments.add_argument("--beside", action="store_true")
    given = arguments.parse_args()
    burin.set_threads(1)
    random = np.random.default_rng(1)
    middle, angle = random.uniform(22, 98, (40_000, 1, 2)), random.uniform(0, np.pi, 40_000)
    ends = middle + np.array([[-1.0], [1.0]]) * np.stack([np.cos(angle), np.sin(angle)], 1)[:, None] + (1000 if given.beside else 0)
    board, bench = burin.read(SAMPLE / "board.json", SAMPLE / "bench.json")
    names, light = [v.name for v in bench.views[:2]], bench.lights[0].id
    scene = burin.Scene(bench, board, names, [light])
    dE = np.ones(scene.shape, np.float32)
    least = {"C++ render": np.inf, "C++ gradient": np.inf, "render": np.inf, "gradient": np.inf}
    with tempfile.TemporaryDirectory() as folder:
        rows = Path(folder) / "scratches.csv"
        np.savetxt(rows, ends.reshape(-1, 4), fmt="%.5f", delimiter=",", header="x0_mm,y0_mm,x1_mm,y1_mm", comments="")
        ends = burin.Scratches.read(rows).ends_mm
        for _ in range(given.rounds):
            said = subprocess.run([given.radiance, SAMPLE / "board.json", SAMPLE / "bench.json", rows, ",".join(names),
                                   light, str(given.repeats)], check=True, capture_output=True).stderr.split()
            now = {"C++ render": float(said[0]), "C++ gradient": float(said[1]),
                   "render": least_ms(lambda: burin.render(scene, ends), given.repeats),
                   "gradient": least_ms(lambda: burin.render_vjp(scene, ends, dE), given.repeats)}
            least = {k: min(v, now[k]) for k, v in least.items()}
    least["render over C++"] = least["render"] - least["C++ render"]
    least["gradient over C++"] = least["gradient"] - least["C++ gradient"]
    print(json.dumps({"scratches": 40_000, "shape": scene.shape, "ms": {k: round(v, 3) for k, v in least.items()}}))


if __name__ == "__main__":
    main()
