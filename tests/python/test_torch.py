"""pyburin.torch: gradcheck in double, no_grad, one scene twice in a graph, steps that descend. Skipped without PyTorch."""

from __future__ import annotations

import numpy as np
import pytest

import pyburin as burin
from setups import BENCH, BOARD, scratches

torch = pytest.importorskip("torch", reason="no PyTorch here: install python3-torch or torch")
burin_torch = pytest.importorskip("pyburin.torch")


def test_gradcheck() -> None:
    """Central differences by gradcheck; radiance is scaled to about 1, and its float32 rounding needs steps of 1e-3 mm."""
    scene = burin.Scene(BENCH, BOARD, double=True, window_px=(14, 10, 14, 12))
    ends = torch.tensor(scratches(8) * 0.3 + 14, requires_grad=True)
    scale = 1 / float(burin.render(scene, ends.detach().numpy()).max())
    assert torch.autograd.gradcheck(lambda e: scale * burin_torch.render(scene, e).sum((1, 2, 3)), (ends,), eps=2e-3,
                                    atol=2e-3, rtol=5e-3)
    lamp = torch.tensor([[-30.0, 20, 90]], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(
        lambda p: scale * burin_torch.render(scene, ends.detach(), lamp_mm=p).sum((1, 2, 3)), (lamp,), eps=0.05,
        atol=1e-4, rtol=5e-3)


def test_one_scene_twice_in_a_graph() -> None:
    scene = burin.Scene(BENCH, BOARD)
    first, second = (torch.tensor(scratches(30, s), requires_grad=True) for s in (1, 2))
    E = (burin_torch.render(scene, first) * 2 + burin_torch.render(scene, second, depth_um=torch.tensor(9.0))).sum()
    E.backward()
    ones = np.ones(scene.shape)
    assert np.array_equal(first.grad.numpy(), burin.render_vjp(scene, first.detach().numpy(), 2 * ones).ends_mm)
    want = burin.render_vjp(scene, second.detach().numpy(), ones, depth_um=9.0).ends_mm
    assert np.array_equal(second.grad.numpy(), want)


def test_no_grad_and_types() -> None:
    scene = burin.Scene(BENCH, BOARD)
    ends = torch.tensor(scratches(30), dtype=torch.float32, requires_grad=True)
    with torch.no_grad():
        assert not burin_torch.render(scene, ends).requires_grad
    picture = burin_torch.render(scene, ends)
    assert picture.dtype == torch.float32 and picture.requires_grad
    picture.sum().backward()
    assert ends.grad.dtype == torch.float32
    with pytest.raises(burin.Error, match="ends_mm"):
        burin_torch.render(scene, scratches(3))
    with pytest.raises(burin.Error, match="alpha"):
        burin_torch.render(scene, ends, alpha=torch.ones(30, dtype=torch.int64))


def test_an_optimizer_descends() -> None:
    scene = burin.Scene(BENCH, BOARD)
    target = torch.from_numpy(burin.render(scene, scratches(40), depth_um=14.0, lamp_mm=[(-28, 23, 88)]))
    depth = torch.tensor(9.0, dtype=torch.float64, requires_grad=True)
    lamp = torch.tensor([[-30.0, 20, 90]], dtype=torch.float64, requires_grad=True)
    ends = torch.tensor(scratches(40))
    step = torch.optim.Adam([{"params": [depth], "lr": 0.2}, {"params": [lamp], "lr": 0.1}])
    losses = []
    for _ in range(60):
        loss = ((burin_torch.render(scene, ends, depth_um=depth, lamp_mm=lamp) - target) ** 2).sum() / (target**2).sum()
        step.zero_grad()
        loss.backward()
        step.step()
        losses.append(float(loss))
    assert losses[-1] < 0.05 * losses[0]
