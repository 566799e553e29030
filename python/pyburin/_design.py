"""Designs: scratches for pictures. docs/model.md 6, docs/design.md. Frame: board, mm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Mapping

import numpy as np
import numpy.typing as npt

from . import _checks, _core
from ._checks import Error
from ._types import Bench, Board, Scratches, _core_bench, _core_board, _scratches_of


@dataclass(frozen=True)
class LossWeights:
    """Weights of a design's loss (docs/model.md 6): sums over pixels of gamma-encoded pictures, white is 1.

    Attributes
    ----------
    l2 : float
        Squared differences, as in PSNR.
    perceptual : float
        Squared differences after a 3 x 3 Gaussian (the paper's lambda_p).
    gram : float
        Differences of local contrast and direction (the paper's lambda_g, by a fixed filter bank).
    """

    l2: float = 1.0
    perceptual: float = 0.0
    gram: float = 0.0

    def __post_init__(self) -> None:
        for name in ("l2", "perceptual", "gram"):
            object.__setattr__(self, name, _checks.number(f"LossWeights.{name}", getattr(self, name), least=0))
        if self.l2 + self.perceptual + self.gram == 0:
            raise Error("LossWeights.l2: all weights are 0; give one above 0")

    def _list(self) -> list[float]:
        return [self.perceptual, self.l2, self.gram]


@dataclass(frozen=True)
class Frame:
    """One iteration of a design; iteration 0 while the start grows.

    Attributes
    ----------
    iteration : int
    loss : float
        Sum over views; 0 while the start is made.
    view_loss : tuple of float
    seconds : float
        Since the design began.
    psnr_db : float or None
        Mean of the views; None while the start is made.
    """

    iteration: int
    loss: float
    view_loss: tuple[float, ...]
    seconds: float
    psnr_db: float | None


@dataclass(frozen=True, eq=False)
class DesignedView:
    """What one view shows: gamma-encoded pictures of the carve area, row 0 at its upper edge, white is 1.

    Attributes
    ----------
    view, light : str
    target, shown : (H, W, 1) float32
    exposure : float
        `shown` is (exposure radiance)^(1 / 2.2), clipped.
    psnr_db, ssim : float
        Of `shown` against `target`.
    """

    view: str
    light: str
    target: npt.NDArray[np.float32]
    shown: npt.NDArray[np.float32]
    exposure: float
    psnr_db: float
    ssim: float


@dataclass(frozen=True, eq=False)
class Design:
    """A finished or stopped design.

    Attributes
    ----------
    scratches : Scratches
    views : tuple of DesignedView
    psnr_db : float
        Mean of the views.
    loss : float
    iterations : int
    seconds : float
    findings : tuple of str
        What to mind, one sentence each.
    """

    scratches: Scratches
    views: tuple[DesignedView, ...]
    loss: float
    iterations: int
    seconds: float
    findings: tuple[str, ...]

    @property
    def psnr_db(self) -> float:
        return float(np.mean([view.psnr_db for view in self.views]))

    def _repr_html_(self) -> str:
        from ._show import figures, png

        return figures([(f"{v.view}: {v.psnr_db:.1f} dB", png(v.shown)) for v in self.views])


def design(bench: Bench, board: Board, targets: Mapping[str, npt.ArrayLike], *, scratches: int, light: str | None = None,
           pixels: int = 0, iterations: int | None = None, seed: int = 1, seconds: float = 0.0,
           weights: LossWeights = LossWeights(), start_mm: npt.ArrayLike | None = None,
           on_frame: Callable[[Frame], Any] | None = None) -> Design:
    """Scratches that show a picture in each view.

    Parameters
    ----------
    bench : Bench
    board : Board
    targets : mapping from view name to (H, W) or (H, W, 3)
        Pictures, sRGB-encoded, row 0 on top: integers of type uint8, or floats from 0 to 1. Color becomes luminance. A
        picture of another shape than the carve area is cropped about its middle.
    scratches : int
        How many to start with; weak ones are dropped.
    light : str, optional
        Id of the light, or several joined by " + "; default: the bench's first.
    pixels : int
        Of the grid along the carve area's longer side; 0: chosen.
    iterations : int, optional
        Default: 160; 70 if grooves cut each other.
    seed : int
    seconds : float
        A limit on the time; 0: none. The result then depends on the machine's speed.
    weights : LossWeights
        Of the loss.
    start_mm : (N, 2, 2), optional
        Ends of scratches to go on from, instead of a new start.
    on_frame : callable, optional
        Called with a `Frame` after each iteration. If it returns False, the design ends with what there is; what it
        raises is raised. Ctrl-C raises KeyboardInterrupt within a second.

    Raises
    ------
    Error
        Naming the argument that is wrong; for a setup on which no groove can glint.
    """
    if not isinstance(bench, Bench):
        raise Error(f"bench: is {type(bench).__name__}; give a pyburin.Bench")
    if not isinstance(board, Board):
        raise Error(f"board: is {type(board).__name__}; give a pyburin.Board")
    if not isinstance(targets, Mapping) or not targets:
        raise Error("targets: give a dict from view names to pictures, with one or more")
    if on_frame is not None and not callable(on_frame):
        raise Error(f"on_frame: is {type(on_frame).__name__}; give a function of one Frame")
    if not isinstance(weights, LossWeights):
        raise Error(f"weights: is {type(weights).__name__}; give a pyburin.LossWeights")
    _checks.in_this_process()
    light = bench.lights[0].id if light is None else _checks.text("light", light)
    wanted = [_core.DesignTarget(_checks.text("targets", name), light, _picture(f"targets[{name!r}]", picture), 1.0)
              for name, picture in targets.items()]
    start = None if start_mm is None else _checks.ends(start_mm)
    result = _core.design(
        _core_board(board), _core_bench(bench), wanted, _checks.integer("scratches", scratches, 1, 2_000_000),
        _checks.integer("pixels", pixels, 0, 4096),
        None if iterations is None else _checks.integer("iterations", iterations, 0, 1_000_000),
        _checks.integer("seed", seed, 0, 2**63), _checks.number("seconds", seconds, least=0), weights._list(), start,
        None if on_frame is None else lambda i, loss, view_loss, s, db: on_frame(Frame(i, loss, tuple(view_loss), s, db)))
    views = tuple(DesignedView(**view) for view in result["views"])
    return Design(_scratches_of(result["scratches"]), views, result["loss"], result["iterations"], result["seconds"],
                  tuple(result["findings"]))


def _picture(name: str, value: Any) -> npt.NDArray[np.float32]:
    array = _checks.array_of(name, value)
    scale = 1 / 255 if array.dtype == np.uint8 else 1.0
    if array.ndim == 2:
        array = array[..., None]
    out = _checks.floats(name, array, (None, None, None)) * scale
    if out.shape[2] not in (1, 3) or 0 in out.shape or max(out.shape[:2]) > 16_384:
        raise Error(f"{name}: has the shape {out.shape}; give (H, W) or (H, W, 3) with sides of 1 to 16384")
    if out.min() < 0 or out.max() > 1:
        raise Error(f"{name}: has values from {out.min():g} to {out.max():g}; give 0 to 1, or uint8")
    return np.ascontiguousarray(out, dtype=np.float32)
