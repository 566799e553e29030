"""Design a board in a loop of your own: PyTorch's Adam, any loss, and Burin's discrete search between its steps.

The loss here is that of `burin.design`, so that the two can be compared: ends with 0 if the loop comes within 0.3 dB.
Replace `loss(...)` by any function of `tone(radiance, log_exposure.exp())`: a network's features, for instance.

    python own_loop.py            a small board, half a minute
    python own_loop.py --full     the sample's 10,000 scratches
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from pathlib import Path

import numpy as np

try:
    import torch
    from PIL import Image
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

import pyburin as burin
from pyburin.torch import loss, render

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "small-bench"
PICTURES = {"d0": "moon.png", "d1": "boat.png", "d2": "still-life.png"}


def own_loop(pictures: burin.Targets, scratches: int, iterations: int, seed: int = 1) -> tuple[burin.Floats, burin.Floats]:
    """Ends of the scratches, and PSNR of each view."""
    scene = pictures.scene
    start = burin.guided_start(pictures, scratches, seed=seed)
    ends = torch.nn.Parameter(torch.from_numpy(start.ends_mm))
    log_exposure = torch.nn.Parameter(torch.from_numpy(start.log_exposure))
    pixel_mm = 80 / max(scene.shape[1:3])  # of the sample's carve area
    adam = torch.optim.Adam([{"params": [ends]}, {"params": [log_exposure], "lr": 0.02}], lr=0.3 * pixel_mm)
    best: tuple[float, burin.Floats] = (-math.inf, start.ends_mm)
    for i in range(iterations):
        part = i / max(1, iterations - 1)
        # From 0.3 of a pixel to 0.02, as the last steps only correct.
        adam.param_groups[0]["lr"] = pixel_mm * (0.02 + 0.28 * 0.5 * (1 + math.cos(math.pi * part)))
        radiance = render(scene, ends)
        psnr = float(pictures.psnr_db(radiance.detach().numpy(), log_exposure.detach().numpy()).mean())
        if psnr > best[0]:
            best = psnr, ends.detach().numpy().copy()
        adam.zero_grad()
        loss(pictures, radiance, log_exposure).backward()
        adam.step()
        if i % 2 == 1 and part < 0.95:  # places that no gradient leads to
            found = burin.relocate(pictures, ends.detach().numpy(), log_exposure.detach().numpy(), seed=seed + 1000 + i)
            with torch.no_grad():
                ends.copy_(torch.from_numpy(found.ends_mm))
                for name in ("exp_avg", "exp_avg_sq"):
                    adam.state[ends][name][found.rows] = 0
    radiance = burin.render(scene, ends.detach().numpy())
    last = ends.detach().numpy()
    if float(pictures.psnr_db(radiance).mean()) < best[0]:
        last = best[1]
    last = burin.drop_weak(pictures, last, pictures.fit_exposure(burin.render(scene, last))).ends_mm
    return last, pictures.psnr_db(burin.render(scene, last))


def main() -> int:
    arguments = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    arguments.add_argument("--full", action="store_true", help="the sample's 10,000 scratches on 256 pixels")
    full = arguments.parse_args().full
    pixels, scratches, iterations = (256, 10_000, 160) if full else (64, 1200, 40)
    board, bench = burin.read(SAMPLE / "board.json", SAMPLE / "bench.json")
    targets = {view: np.asarray(Image.open(SAMPLE / "targets" / name).convert("L")) for view, name in PICTURES.items()}
    began = time.monotonic()
    made = burin.design(bench, board, targets, scratches=scratches, pixels=pixels, iterations=iterations)
    there = time.monotonic()
    scene = burin.Scene(bench, board, pixels=pixels)
    ends, psnr = own_loop(burin.Targets(scene, targets), scratches, iterations)
    here = time.monotonic()
    print(f"burin.design: {made.psnr_db:.2f} dB, {len(made.scratches)} scratches, {there - began:.1f} s")
    print(f"own loop:     {psnr.mean():.2f} dB, {len(ends)} scratches, {here - there:.1f} s")
    return 0 if psnr.mean() > made.psnr_db - 0.3 else 1


if __name__ == "__main__":
    sys.exit(main())
