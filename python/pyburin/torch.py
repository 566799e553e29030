"""`render` for PyTorch: gradients flow to ends, material, lamps, poses and machine through autograd. CPU tensors."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch

from . import _render
from ._checks import Error
from ._render import Scene
from ._targets import Targets

_NAMES = ("ends_mm", "width_um", "depth_um", "alpha", "base_alpha", "lamp_mm", "lamp_log_intensity", "pose", "bow_mm",
          "machine_map")


class _Render(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, scene: Scene, carve: bool, *values: torch.Tensor | None) -> torch.Tensor:
        ctx.scene, ctx.carve = scene, carve
        ctx.given = [v is not None for v in values]
        ctx.save_for_backward(*(v for v in values if v is not None))
        arrays = {n: v.detach().numpy() for n, v in zip(_NAMES, values) if v is not None}
        picture = _render.render(scene, arrays.pop("ends_mm"), carve=carve, **arrays)
        ends = values[0]
        assert ends is not None
        return torch.from_numpy(picture).to(ends.dtype)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, dE_dradiance: torch.Tensor) -> tuple[Any, ...]:
        saved = iter(ctx.saved_tensors)
        values = {n: next(saved) for n, given in zip(_NAMES, ctx.given) if given}
        wanted = dict(zip(_NAMES, ctx.needs_input_grad[2:]))
        # What needs no gradient is given all the same, so that its value counts.
        arrays = {n: v.detach().numpy() for n, v in values.items()}
        by = _render.render_vjp(ctx.scene, arrays.pop("ends_mm"), dE_dradiance.detach().numpy(), carve=ctx.carve,
                                **arrays)
        out = [torch.as_tensor(np.asarray(getattr(by, n))).to(values[n].dtype).reshape(values[n].shape)
               if wanted[n] else None for n in _NAMES]
        return (None, None, *out)


def render(scene: Scene, ends_mm: torch.Tensor, *, width_um: torch.Tensor | None = None,
           depth_um: torch.Tensor | None = None, alpha: torch.Tensor | None = None,
           base_alpha: torch.Tensor | None = None, lamp_mm: torch.Tensor | None = None,
           lamp_log_intensity: torch.Tensor | None = None, pose: torch.Tensor | None = None,
           bow_mm: torch.Tensor | None = None, machine_map: torch.Tensor | None = None,
           carve: bool = True) -> torch.Tensor:
    """`pyburin.render` of tensors, with gradients: (V, H, W, C) of the type of `ends_mm`.

    Arguments: as `pyburin.render`, float32 or float64 tensors on the CPU. Computation on the way back is once
    differentiable. Each call is independent: one scene can stand in a graph many times. Radiance has float32 precision
    even for float64 tensors.

    Raises
    ------
    Error
        Naming the argument that is wrong.
    """
    values = (ends_mm, width_um, depth_um, alpha, base_alpha, lamp_mm, lamp_log_intensity, pose, bow_mm, machine_map)
    for name, value in zip(_NAMES, values):
        if value is None and name != "ends_mm":
            continue
        if not isinstance(value, torch.Tensor):
            raise Error(f"{name}: is {type(value).__name__}; give a torch.Tensor")
        if value.device.type != "cpu" or value.dtype not in (torch.float32, torch.float64):
            raise Error(f"{name}: is {value.dtype} on {value.device}; give float32 or float64 on the CPU")
    out: torch.Tensor = _Render.apply(scene, carve, *values)
    return out


class _Loss(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, targets: Targets, radiance: torch.Tensor, log_exposure: torch.Tensor) -> torch.Tensor:
        loss = targets.loss(radiance.detach().numpy(), log_exposure.detach().numpy())
        ctx.save_for_backward(torch.from_numpy(loss.dE_dradiance).to(radiance.dtype),
                              torch.from_numpy(loss.dE_dlog_exposure).to(log_exposure.dtype))
        return torch.tensor(loss.value, dtype=torch.float64)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, dE: torch.Tensor) -> tuple[Any, ...]:
        by_radiance, by_log_exposure = ctx.saved_tensors
        return None, dE.to(by_radiance.dtype) * by_radiance, dE.to(by_log_exposure.dtype) * by_log_exposure


def loss(targets: Targets, radiance: torch.Tensor, log_exposure: torch.Tensor) -> torch.Tensor:
    """The value of `targets.loss` with gradients by both tensors: a float64 scalar, the loss of `burin design`."""
    if not isinstance(targets, Targets):
        raise Error(f"targets: is {type(targets).__name__}; give pyburin.Targets")
    for name, value in (("radiance", radiance), ("log_exposure", log_exposure)):
        if not isinstance(value, torch.Tensor):
            raise Error(f"{name}: is {type(value).__name__}; give a torch.Tensor")
    out: torch.Tensor = _Loss.apply(targets, radiance, log_exposure)
    return out


def tone(radiance: torch.Tensor, exposure: torch.Tensor | float = 1.0, gamma: float = 2.2) -> torch.Tensor:
    """(exposure radiance)^(1 / gamma), clipped to 0..1, with gradients; below 1e-6 light counts as 1e-6."""
    return (radiance * exposure).clamp(1e-6, 1.0) ** (1 / gamma)
