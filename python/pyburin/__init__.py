"""Differentiable rendering and design of scratch-based reflection art, from Burin's core.

Frames and units: the board's lower-left corner is the origin, x points right, y up, z out of the metal; lengths are mm,
lengths of grooves µm where names say so. All functions take arrays or lists of numbers, copy them, give NumPy arrays,
release the GIL, and raise `Error` (a ValueError) that names the argument. docs/python.md is the manual.
"""

from __future__ import annotations

from typing import Any

from . import _checks, _core
from ._checks import Error, Floats
from ._design import Design, DesignedView, Frame, LossWeights, design
from ._measure import Measured, Parameter, calibrate, capture, plan, read_measured, refine, residuals, simulate
from ._program import Finding, Run, has_program, run
from ._project import Project, ProjectDesign, Toolpath
from ._render import Footprint, Gradients, Pictures, Scene, footprint_integral, render, render_vjp, tone
from ._show import png
from ._targets import Grooves, Loss, Searched, Targets, carve, drop_weak, guided_start, relocate
from ._types import Bench, Board, Lens, Light, Material, Scratches, View, read

__version__ = "0.2.0"
__all__ = [
    "Bench", "Board", "Design", "DesignedView", "Error", "Finding", "Floats", "Footprint", "Frame", "Gradients", "Grooves",
    "Lens", "Light", "Loss", "LossWeights", "Material", "Measured", "Parameter", "Pictures", "Project", "ProjectDesign",
    "Run", "Scene", "Scratches", "Searched", "Targets", "Toolpath", "View", "calibrate", "capture", "carve", "design",
    "drop_weak", "footprint_integral", "guided_start", "has", "plan", "png", "read", "read_measured", "refine",
    "relocate", "render", "render_vjp", "residuals", "run", "set_threads", "simd", "simulate", "tone",
]

_limit: Any = None


def has(part: str) -> bool:
    """Whether a part is there.

    "core": rendering, gradients, designs. "jax": `pyburin.jax`. "calib", "capture", "simulate", "pictures", "tools":
    projects, photos and measurements, which the `burin` program does (on PATH, or named by BURIN_PROGRAM).
    """
    if _checks.text("part", part) == "jax":
        return hasattr(_core, "jax_handlers")
    return part == "core" or (part in ("calib", "capture", "simulate", "pictures", "tools") and has_program())


def set_threads(most: int | None) -> None:
    """Use at most so many threads from now on, the calling one included; None: all cores. Results keep their bits."""
    global _limit
    _limit = None if most is None else _core.ThreadLimit(_checks.integer("most", most, 1, 10_000))


def simd() -> str:
    """The instructions that the float kernels use: "sse2", "avx2", "avx512" or "generic". Last bits depend on them."""
    return _core.simd()
