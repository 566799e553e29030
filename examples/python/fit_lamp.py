"""Find a lamp, the depth and the roughness of grooves from a picture by gradient descent: no files, no PyTorch.

Ends with 0 if it finds the numbers that the picture was rendered with.
"""

from __future__ import annotations

import numpy as np

import pyburin as burin

board = burin.Board(size_mm=(40, 40))
lens = burin.Lens("LENSMODEL_PINHOLE", (150, 150, 31.5, 31.5), 64, 64)
views = [burin.View.look_at("left", (10, 20, 100), (20, 20, 0)), burin.View.look_at("right", (40, 10, 95), (20, 20, 0))]
bench = burin.Bench(lens, views, [burin.Light("lamp", (-30, 20, 90), (1e4, 1e4, 1e4))], burin.Material(alpha=0.1, depth_um=10))
scene = burin.Scene(bench, board)

random = np.random.default_rng(1)
middle, angle = random.uniform(5, 35, (300, 1, 2)), random.uniform(0, np.pi, 300)
along = np.stack([np.cos(angle), np.sin(angle)], axis=1)[:, None]
ends_mm = middle + np.array([[-1.5], [1.5]]) * along  # (300, 2, 2)

truth = np.array([-27.0, 22, 88, np.log(14), np.log(0.12)])  # lamp_mm, log depth_um, log alpha
start = np.array([-30.0, 20, 90, np.log(10), np.log(0.1)])


def render(x: np.ndarray[tuple[int], np.dtype[np.float64]]) -> burin.Pictures:
    return burin.render(scene, ends_mm, lamp_mm=[x[:3]], depth_um=np.exp(x[3]), alpha=np.exp(x[4]))


photo = render(truth)
scale = float((photo.astype(float) ** 2).sum())
x, mean, square = start.copy(), np.zeros(5), np.zeros(5)
for i in range(1, 401):  # Adam
    residual = render(x).astype(float) - photo
    by = burin.render_vjp(scene, ends_mm, 2 * residual / scale, lamp_mm=[x[:3]], depth_um=np.exp(x[3]), alpha=np.exp(x[4]))
    assert by.lamp_mm is not None and by.depth_um is not None and by.alpha is not None
    gradient = np.array([*by.lamp_mm[0], by.depth_um * np.exp(x[3]), by.alpha * np.exp(x[4])])
    mean, square = 0.9 * mean + 0.1 * gradient, 0.99 * square + 0.01 * gradient**2
    rate = np.array([0.2, 0.2, 0.2, 0.01, 0.01]) * (1 + np.cos(np.pi * i / 400)) / 2
    x = x - rate * (mean / (1 - 0.9**i)) / (np.sqrt(square / (1 - 0.99**i)) + 1e-12)
    if i % 100 == 0:
        print(f"step {i}: error {(residual**2).sum() / scale:.2e}, lamp {np.round(x[:3], 2)} mm, "
              f"depth {np.exp(x[3]):.3f} um, alpha {np.exp(x[4]):.4f}")
error = np.abs(x - truth)
print(f"lamp off by {np.linalg.norm(error[:3]):.3f} mm, depth by {100 * error[3]:.2f} %, alpha by {100 * error[4]:.2f} %")
raise SystemExit(0 if error[:3].max() < 0.5 and error[3:].max() < 0.02 else 1)
