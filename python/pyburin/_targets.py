"""Loss and discrete search of designs, for loops of a person's own. docs/model.md 6, docs/python.md. Frame: board, mm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from . import _checks, _core
from ._checks import Error, Floats
from ._design import LossWeights, _picture
from ._render import Pictures, Scene
from ._types import Bench, Board, _core_bench, _core_board

_MOST = 2_000_000


@dataclass(frozen=True, eq=False)
class Loss:
    """A loss and its derivatives.

    Attributes
    ----------
    value : float
        Sum over views.
    view_loss : (V,)
    dE_dradiance : (V, H, W, 1) float32
    dE_dlog_exposure : (V,)
    """

    value: float
    view_loss: Floats
    dE_dradiance: Pictures
    dE_dlog_exposure: Floats


@dataclass(frozen=True, eq=False)
class Searched:
    """Scratches after a search.

    Attributes
    ----------
    ends_mm : (N, 2, 2)
    log_exposure : (V,)
        Logarithms of the exposures, one per view.
    rows : (M,) of int
        `relocate`: the scratches that moved. `drop_weak`: the scratches that stay, by their old numbers.
    """

    ends_mm: Floats
    log_exposure: Floats
    rows: npt.NDArray[np.int64]


class Targets:
    """Pictures that the views of a scene are to show, prepared for loss and search.

    Parameters
    ----------
    scene : Scene
        On a grid of the carve area (`pixels=`), with one channel.
    targets : mapping from view name to (H, W) or (H, W, 3)
        One picture for each view of the scene, as in `design`.
    weights : LossWeights
    lift_blacks : float
        Share of the lift of blacks where no scratch is dark, from 0 to 1, as in `burin design`.

    Raises
    ------
    Error
        Naming the argument that is wrong; for a setup on which no groove can glint.
    """

    def __init__(self, scene: Scene, targets: Mapping[str, npt.ArrayLike], *, weights: LossWeights = LossWeights(),
                 lift_blacks: float = 1.0) -> None:
        if not isinstance(scene, Scene):
            raise Error(f"scene: is {type(scene).__name__}; give a pyburin.Scene")
        if not isinstance(targets, Mapping) or set(targets) != set(scene.views):
            raise Error(f"targets: give a dict with a picture for each view of the scene: {', '.join(scene.views)}")
        if not isinstance(weights, LossWeights):
            raise Error(f"weights: is {type(weights).__name__}; give a pyburin.LossWeights")
        if not scene._on_board or scene.shape[3] != 1:
            raise Error("scene: has a photo's pixels or several channels; give one made with pixels= and channels=1")
        _checks.in_this_process()
        light = " + ".join(scene.lights)
        wanted = [_core.DesignTarget(v, light, _picture(f"targets[{v!r}]", targets[v]), 1.0) for v in scene.views]
        pixels = max(scene.shape[1:3])
        self._scene = scene
        self._core = _core.Targets(_core_board(scene._board), _core_bench(scene._bench), wanted, pixels,
                                   weights._list(), _checks.number("lift_blacks", lift_blacks, least=0, most=1))
        self._pictures = self._core.pictures()
        if self._pictures.shape != scene.shape:
            raise Error(f"scene: has {scene.shape[1]} x {scene.shape[2]} pixels; the carve area's shape has "
                        f"{self._pictures.shape[1]} x {self._pictures.shape[2]}: give pixels={pixels}")

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self._scene

    @property
    def pictures(self) -> Pictures:
        """The targets on the scene's pixels, (V, H, W, 1), gamma-encoded, white is 1."""
        return self._pictures.copy()

    @property
    def findings(self) -> tuple[str, ...]:
        """What to mind of the pictures, one sentence each."""
        return tuple(self._core.findings())

    def __repr__(self) -> str:
        return f"Targets(shape={self._scene.shape}, views={self._scene.views})"

    def __reduce__(self) -> Any:
        raise TypeError("Targets cannot be pickled or copied; make them in each process")

    def loss(self, radiance: npt.ArrayLike, log_exposure: npt.ArrayLike) -> Loss:
        """The loss of `render`'s radiance (V, H, W, 1) at exposures exp(`log_exposure`) (V,), with exact derivatives.

        It equals the loss of `burin design` with the same weights.
        """
        out = self._core.loss(self._radiance(radiance), self._exposures(log_exposure))
        return Loss(float(out["view_loss"].sum()), out["view_loss"], out["dE_dradiance"], out["dE_dlog_exposure"])

    def fit_exposure(self, radiance: npt.ArrayLike, log_exposure: npt.ArrayLike | None = None) -> Floats:
        """Logarithms of the exposures, (V,), at which radiance (V, H, W, 1) is closest to the targets."""
        light = self._radiance(radiance)
        return self._core.fitting(light, self._guess(light, log_exposure))

    def psnr_db(self, radiance: npt.ArrayLike, log_exposure: npt.ArrayLike | None = None) -> Floats:
        """PSNR of each view, (V,), at the exposure that suits it best, as `design` reports it."""
        light = self._radiance(radiance)
        return self._core.psnr_db(light, self._guess(light, log_exposure))

    def _radiance(self, value: Any) -> Pictures:
        return _checks.pictures("radiance", value, self._scene.shape)

    def _guess(self, radiance: Pictures, value: Any) -> Floats:
        """`value`, or the exposures with the targets' mean light."""
        if value is not None:
            return self._exposures(value)
        wanted = (self._pictures.astype(float) ** 2.2).mean((1, 2, 3))
        given = radiance.mean((1, 2, 3), dtype=float)
        if not (given > 0).all():
            raise Error("radiance: a view is black, which no exposure brightens")
        out: Floats = np.log(np.maximum(wanted, 1e-6) / given)
        return out

    def _exposures(self, value: Any) -> Floats:
        views = self._scene.shape[0]
        out = _checks.floats("log_exposure", value, (views,))
        if np.abs(out).max() > 100:
            raise Error("log_exposure: has a value beyond 100")
        return out

    def _ends(self, value: Any) -> Floats:
        out = _checks.ends(value)
        if not 1 <= len(out) <= _MOST:
            raise Error(f"ends_mm: has {len(out)} scratches; give 1 to {_MOST}")
        return out


def guided_start(targets: Targets, scratches: int, *, seed: int = 1) -> Searched:
    """Scratches placed one by one where they lower the pictures' error most, and one search for better places.

    As `burin design` starts. The same seed gives the same bits. Ctrl-C ends it.
    """
    return _searched(_of(targets)._core.start(_checks.integer("scratches", scratches, 1, _MOST),
                                              _checks.integer("seed", seed, 0, 2**63)))


def relocate(targets: Targets, ends_mm: npt.ArrayLike, log_exposure: npt.ArrayLike, *, share: float = 0.02,
             seed: int = 1) -> Searched:
    """A better place for each scratch, where there is one: moves that gradients cannot make.

    Parameters
    ----------
    targets : Targets
    ends_mm : (N, 2, 2) or (N, 4)
        Scratches as `carve` takes them. Ends outside the carve area are moved into it.
    log_exposure : (V,)
        Logarithms of the exposures.
    share : float
        Share of the scratches, of least effect, which may change to another view.
    seed : int
        Give another one each time.
    """
    _of(targets)
    return _searched(targets._core.search(targets._ends(ends_mm), targets._exposures(log_exposure),
                                          _checks.number("share", share, least=0, most=1),
                                          _checks.integer("seed", seed, 0, 2**63)))


def drop_weak(targets: Targets, ends_mm: npt.ArrayLike, log_exposure: npt.ArrayLike, *, error: float = 0.01,
              share: float = 0.0) -> Searched:
    """The scratches without those of least effect.

    Parameters
    ----------
    targets : Targets
    ends_mm : (N, 2, 2) or (N, 4)
    log_exposure : (V,)
    error : float
        Share by which the squared error may grow, 0 to 1.
    share : float
        Or the share of the scratches to drop, if above 0.
    """
    _of(targets)
    return _searched(targets._core.drop(targets._ends(ends_mm), targets._exposures(log_exposure),
                                        _checks.number("error", error, least=0, most=0.999),
                                        _checks.number("share", share, least=0, most=0.999)))


@dataclass(frozen=True, eq=False)
class Grooves:
    """Grooves in the metal.

    Attributes
    ----------
    ends_mm : (M, 2, 2)
    width_um, depth_um, alpha : (M,) or None
        None: the tool's width, the material's depth and roughness.
    scratch : (M,) of int
        The row of the scratch that each groove, or piece of a groove, belongs to.
    """

    ends_mm: Floats
    width_um: Floats | None
    depth_um: Floats | None
    alpha: Floats | None
    scratch: npt.NDArray[np.int64]


def carve(bench: Bench, board: Board, ends_mm: npt.ArrayLike, *, width_um: npt.ArrayLike | None = None,
          depth_um: npt.ArrayLike | None = None, alpha: npt.ArrayLike | None = None) -> Grooves:
    """The grooves that a setup's machine leaves of scratches: fields of depth and roughness, wear, crossings.

    Parameters: as `render`. `render(scene, scratches)` is the picture of these grooves.
    """
    if not isinstance(bench, Bench):
        raise Error(f"bench: is {type(bench).__name__}; give a pyburin.Bench")
    if not isinstance(board, Board):
        raise Error(f"board: is {type(board).__name__}; give a pyburin.Board")
    _checks.in_this_process()
    ends = _checks.ends(ends_mm)
    size = len(ends)
    out = _core.carve(_core_board(board), _core_bench(bench), ends, _checks.column("width_um", width_um, size),
                      _checks.column("depth_um", depth_um, size), _checks.column("alpha", alpha, size, most=1.0))
    return Grooves(out["ends_mm"].reshape(-1, 2, 2), out["width_um"], out["depth_um"], out["alpha"],
                   out["source"].astype(np.int64))


def _of(targets: Any) -> Targets:
    if not isinstance(targets, Targets):
        raise Error(f"targets: is {type(targets).__name__}; give pyburin.Targets")
    _checks.in_this_process()
    return targets


def _searched(out: Any) -> Searched:
    ends, log_exposure, rows = out
    return Searched(ends.reshape(-1, 2, 2), log_exposure, rows.astype(np.int64))
