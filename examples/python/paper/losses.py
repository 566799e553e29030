"""The paper's losses on one board: squared differences E_2, perceptual E_p, Gram, and features of a network.

    python losses.py                          two views, 800 scratches, a small network with random weights; a minute
    python losses.py --vgg vgg19.pth          Gram matrices of VGG-19 features, by a file of weights that you have
    python losses.py --full --out pictures    the sample's three pictures, 10,000 scratches, PNG files

Each loss drives the same loop: a guided start, then Adam on both ends of every scratch and on the exposures. The table
has PSNR and each loss by itself, so that a row shows what its loss bought, and what it cost. Ends with 0 if each of
Burin's losses is lowest in its own row, and the network's fell from the start.
"""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path
from typing import Any, Callable

import numpy as np

try:
    import torch
    from PIL import Image
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

import pyburin as burin
from pyburin.torch import loss, render

SAMPLE = Path(__file__).resolve().parents[3] / "samples" / "small-bench"
PICTURES = {"d0": "moon.png", "d1": "boat.png", "d2": "still-life.png"}
VGG_19 = (64, 64, "M", 128, 128, "M", 256, 256, 256, 256, "M", 512, 512, 512, 512, "M", 512)
Features = Callable[[Any], list[Any]]


def network(weights: Path | None) -> Features:
    """Features after the first convolution of each block, of (V, 1, H, W): VGG-19's, or those of random filters."""
    plan = VGG_19 if weights is not None else (8, "M", 16, "M", 32)
    torch.manual_seed(1)
    layers: list[Any] = []
    channels = 3
    for entry in plan:
        if isinstance(entry, str):
            layers.append(torch.nn.MaxPool2d(2))
        else:
            layers += [torch.nn.Conv2d(channels, entry, 3, padding=1), torch.nn.ReLU()]
            channels = entry
    stack = torch.nn.Sequential(*layers)
    if weights is not None:
        stored = torch.load(weights, map_location="cpu")
        stack.load_state_dict({k[len("features."):]: v for k, v in stored.items()
                               if k.startswith("features.") and int(k.split(".")[1]) < len(layers)})
    stack.requires_grad_(False)
    first = [i for i, layer in enumerate(layers) if isinstance(layer, torch.nn.Conv2d)
             and (i == 0 or isinstance(layers[i - 1], torch.nn.MaxPool2d))]

    def features(picture: Any) -> list[Any]:
        out, x = [], picture.float().expand(-1, 3, -1, -1)
        for i, layer in enumerate(layers):
            x = layer(x)
            if i - 1 in first:
                out.append(x)
        return out

    return features


def gram_of(features: list[Any]) -> list[Any]:
    """Gram matrices, (V, C, C), per pixel."""
    return [torch.einsum("vchw,vdhw->vcd", f, f) / f[0, 0].numel() for f in features]


def main() -> int:
    arguments = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    arguments.add_argument("--full", action="store_true", help="three views, 10,000 scratches, 256 pixels, 100 steps")
    arguments.add_argument("--vgg", type=Path, help="torchvision's VGG-19 weights (.pth)")
    arguments.add_argument("--out", type=Path, help="folder for PNG files")
    given = arguments.parse_args()
    pixels, scratches, steps = (256, 10_000, 100) if given.full else (48, 800, 25)
    board, bench = burin.read(SAMPLE / "board.json", SAMPLE / "bench.json")
    names = dict(list(PICTURES.items())[: 3 if given.full else 2])
    wanted = {view: np.asarray(Image.open(SAMPLE / "targets" / name).convert("L")) for view, name in names.items()}
    scene = burin.Scene(bench, board, list(names), pixels=pixels)
    by_weights = {"E_2": burin.Targets(scene, wanted, weights=burin.LossWeights(1)),
                  "E_p": burin.Targets(scene, wanted, weights=burin.LossWeights(0, 1)),
                  "Gram": burin.Targets(scene, wanted, weights=burin.LossWeights(0, 1, 0.01))}
    squares = by_weights["E_2"]
    features = network(given.vgg)
    target = torch.from_numpy(squares.pictures).permute(0, 3, 1, 2)
    target_grams = [g.detach() for g in gram_of(features(target))]

    def network_loss(radiance: Any, log_exposure: Any) -> Any:
        # With an offset in the dark, where the slope of gamma would drown all others, as burin's own losses have it.
        shown = ((radiance * log_exposure.exp().reshape(-1, 1, 1, 1) + 1e-3).clamp(max=1) ** (1 / 2.2)).permute(0, 3, 1, 2)
        texture = sum(((g - t) ** 2).sum() / (t**2).sum() for g, t in zip(gram_of(features(shown)), target_grams))
        return loss(by_weights["E_p"], radiance, log_exposure) * (1 + 0.5 * texture)

    losses: dict[str, Callable[[Any, Any], Any]] = {name: partial(loss, of) for name, of in by_weights.items()}
    losses["network"] = network_loss
    start = burin.guided_start(squares, scratches)
    at_start = {name: float(E(torch.from_numpy(burin.render(scene, start.ends_mm)).double(),
                              torch.from_numpy(start.log_exposure))) for name, E in losses.items()}
    rows: dict[str, dict[str, float]] = {}
    for name, E in losses.items():
        ends = torch.nn.Parameter(torch.from_numpy(start.ends_mm.copy()))
        log_exposure = torch.nn.Parameter(torch.from_numpy(start.log_exposure.copy()))
        adam = torch.optim.Adam([{"params": [ends], "lr": 0.2 * 80 / pixels}, {"params": [log_exposure], "lr": 0.02}])
        for i in range(steps):
            adam.param_groups[0]["lr"] = 0.2 * 80 / pixels * (1 - i / steps)
            adam.zero_grad()
            E(render(scene, ends), log_exposure).backward()
            adam.step()
        with torch.no_grad():
            radiance = render(scene, ends)
            rows[name] = {"PSNR": float(squares.psnr_db(radiance.numpy()).mean()),
                          **{other: float(F(radiance, log_exposure)) for other, F in losses.items()}}
            if given.out is not None:
                given.out.mkdir(parents=True, exist_ok=True)
                shown = burin.tone(radiance.numpy(), log_exposure.exp().numpy().reshape(-1, 1, 1, 1))
                for view, picture in zip(names, shown):
                    (given.out / f"{name}-{view}.png").write_bytes(burin.png(picture))
    print(f"{'loss':<10}" + "".join(f"{column:>12}" for column in next(iter(rows.values()))))
    print(f"{'start':<22}" + "".join(f"{value:>12.4g}" for value in at_start.values()))
    for name, row in rows.items():
        print(f"{name:<10}" + "".join(f"{value:>12.4g}" for value in row.values()))
    lowest = all(rows[name][name] == min(row[name] for row in rows.values()) for name in by_weights)
    return 0 if lowest and rows["network"]["network"] < 0.9 * at_start["network"] else 1


if __name__ == "__main__":
    sys.exit(main())
