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
from ._render import Footprint, Gradients, Pictures, Scene, footprint_integral, render, render_vjp, tone
from ._show import png
from ._targets import Grooves, Loss, Searched, Targets, carve, drop_weak, guided_start, relocate
from ._types import Bench, Board, Lens, Light, Material, Scratches, View, read

__version__ = "0.1.0"
__all__ = [
    "Bench", "Board", "Design", "DesignedView", "Error", "Floats", "Footprint", "Frame", "Gradients", "Grooves",
    "Lens", "Light", "Loss", "LossWeights", "Material", "Pictures",
    "Scene", "Scratches", "Searched", "Targets", "View", "carve", "design",
    "drop_weak", "footprint_integral", "guided_start", "has", "png", "read",
    "relocate", "render", "render_vjp", "set_threads", "simd", "tone",
]

_limit: Any = None


def has(part: str) -> bool:
    """Whether a part is there.

    "core": rendering, gradients, designs. "jax": `pyburin.jax`. "calib", "capture": none yet.
    """
    if _checks.text("part", part) == "jax":
        return hasattr(_core, "jax_handlers")
    return part == "core"


def set_threads(most: int | None) -> None:
    """Use at most so many threads from now on, the calling one included; None: all cores. Results keep their bits."""
    global _limit
    _limit = None if most is None else _core.ThreadLimit(_checks.integer("most", most, 1, 10_000))


def simd() -> str:
    """The instructions that the float kernels use: "sse2", "avx2", "avx512" or "generic". Last bits depend on them."""
    return _core.simd()
