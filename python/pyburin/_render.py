"""Pictures of scratches, and exact gradients. docs/model.md 4 and 5. Frame: board, mm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Sequence

import numpy as np
import numpy.typing as npt

from . import _checks, _core
from ._checks import Error, Floats
from ._types import Bench, Board, _core_bench, _core_board

Pictures = npt.NDArray[np.float32]
_MOST_PIXELS = 70_000_000


class Scene:
    """Views of a board under lights, laid out once and rendered again and again.

    Several threads can render one scene at once. A scene keeps copies: later changes of its inputs do not reach it.

    Parameters
    ----------
    bench : Bench
    board : Board
    views : sequence of str, optional
        Names of the bench's views; default: all.
    lights : sequence of str, optional
        Ids of the bench's lights, which shine at once; default: its first.
    pixels : int or (int, int), optional
        None: the photo's pixels. Otherwise a grid laid on the carve area, row 0 at its upper edge, as designs have it:
        (height, width), or the longer side.
    window_px : (int, int, int, int), optional
        Of a photo: first column, first row, width, height; default: all of it.
    channels : int
        1: the mean of R, G, B; 3: R, G, B.
    double : bool
        Compute in double, pair by pair: tens of times slower. Pictures are float32 all the same.

    Attributes
    ----------
    shape : (int, int, int, int)
        V, H, W, C of what `render` gives.

    Raises
    ------
    Error
        For names that the bench does not have, a camera behind the board, a light that reaches nothing.
    """

    def __init__(self, bench: Bench, board: Board, views: Sequence[str] | None = None,
                 lights: Sequence[str] | None = None, *, pixels: int | tuple[int, int] | None = None,
                 window_px: tuple[int, int, int, int] | None = None, channels: int = 1, double: bool = False) -> None:
        if not isinstance(bench, Bench):
            raise Error(f"bench: is {type(bench).__name__}; give a pyburin.Bench")
        if not isinstance(board, Board):
            raise Error(f"board: is {type(board).__name__}; give a pyburin.Board")
        _checks.in_this_process()
        self._views = _names("views", views, [v.name for v in bench.views], most=500)
        self._lights = _names("lights", lights, [bench.lights[0].id], most=100)
        window = _window(bench, board, pixels, window_px)
        channels = _checks.integer("channels", channels, 1, 3)
        if channels == 2:
            raise Error("channels: is 2; give 1 or 3")
        self._shape = (len(self._views), window[3], window[2], channels)
        if self._shape[0] * self._shape[1] * self._shape[2] > _MOST_PIXELS:
            raise Error(f"pixels: {self._shape[:3]} are more than {_MOST_PIXELS}; give fewer pixels or views")
        self._double = _checks.flag("double", double)
        self._bench, self._board, self._on_board = bench, board, pixels is not None
        self._core = _core.Scene(_core_bench(bench), _core_board(board), self._views, self._lights, pixels is not None,
                                 window, channels, self._double)

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """V, H, W, C of what `render` gives."""
        return self._shape

    @property
    def views(self) -> tuple[str, ...]:
        """Names of the views, in the order of the pictures."""
        return tuple(self._views)

    @property
    def lights(self) -> tuple[str, ...]:
        """Ids of the lights, in the order of `lamp_mm`."""
        return tuple(self._lights)

    def __repr__(self) -> str:
        return f"Scene(shape={self._shape}, views={self._views}, lights={self._lights}, double={self._double})"

    def _repr_html_(self) -> str:
        """The plain face of each view."""
        from ._show import figures, png

        radiance = render(self, np.zeros((0, 4)))
        white = float(radiance.max()) or 1.0
        return figures([(name, png(tone(picture, 1 / white))) for name, picture in zip(self._views, radiance)])

    def __reduce__(self) -> Any:
        raise TypeError("a Scene cannot be pickled or copied; make one in each process")


@dataclass(frozen=True, eq=False)
class Gradients:
    """dE by each argument that was given; None for the others. Shapes are the arguments' own; units E per argument's."""

    ends_mm: Floats
    width_um: Floats | None = None
    depth_um: Floats | None = None
    alpha: Floats | None = None
    base_alpha: float | None = None
    lamp_mm: Floats | None = None
    lamp_log_intensity: Floats | None = None
    pose: Floats | None = None
    bow_mm: Floats | None = None
    machine_map: Floats | None = None


def render(scene: Scene, ends_mm: npt.ArrayLike, *, width_um: npt.ArrayLike | None = None,
           depth_um: npt.ArrayLike | None = None, alpha: npt.ArrayLike | None = None,
           base_alpha: float | None = None, lamp_mm: npt.ArrayLike | None = None,
           lamp_log_intensity: npt.ArrayLike | None = None, pose: npt.ArrayLike | None = None,
           bow_mm: npt.ArrayLike | None = None, machine_map: npt.ArrayLike | None = None,
           carve: bool = True) -> Pictures:
    """Radiance that each view sees, (V, H, W, C) float32, in the unit of the lights' intensity / mm².

    The same input gives the same bits, for any number of threads.

    Parameters
    ----------
    scene : Scene
    ends_mm : (N, 2, 2) or (N, 4)
        Ends of the scratches, x and y on the board, in carving order.
    width_um, depth_um, alpha : (N,) or a number, optional
        Tool width, depth and roughness; default: the board's and the bench's.
    base_alpha : float, optional
        Roughness of the plain face.
    lamp_mm : (L, 3), optional
        Positions of the scene's lights.
    lamp_log_intensity : (L,), optional
        Factors exp(.) on their intensities.
    pose : (V, 6), optional
        Small motions of the cameras: a rotation vector on the left of T_camera_board, then mm added to its translation.
    bow_mm : (3,), optional
        The face's bow.
    machine_map : (2, 3), optional
        [A | b], applied to all ends first: A p + b, mm.
    carve : bool
        Apply what the bench knows of its grooves: fields of depth and roughness, crossings. False: grooves lie in the
        metal as given.

    Raises
    ------
    Error
        Naming the argument that is wrong.
    """
    call = _Call(scene, ends_mm, width_um, depth_um, alpha, base_alpha, lamp_mm, lamp_log_intensity, pose, bow_mm,
                 machine_map, carve)
    return scene._core.render(*call.arguments())


def render_vjp(scene: Scene, ends_mm: npt.ArrayLike, dE_dradiance: npt.ArrayLike, *,
               width_um: npt.ArrayLike | None = None, depth_um: npt.ArrayLike | None = None,
               alpha: npt.ArrayLike | None = None, base_alpha: float | None = None,
               lamp_mm: npt.ArrayLike | None = None, lamp_log_intensity: npt.ArrayLike | None = None,
               pose: npt.ArrayLike | None = None, bow_mm: npt.ArrayLike | None = None,
               machine_map: npt.ArrayLike | None = None, carve: bool = True) -> Gradients:
    """The gradient of a number E through `render`, given dE/dradiance (V, H, W, C), by each argument that is given.

    Other parameters: as `render`. Gradients by lamps, poses and bow need near lamps alone; those by pose and bow need a
    photo's pixels. Crossings that come or go as scratches move have no derivative.

    Raises
    ------
    Error
        Naming the argument that is wrong or has no derivative here.
    """
    call = _Call(scene, ends_mm, width_um, depth_um, alpha, base_alpha, lamp_mm, lamp_log_intensity, pose, bow_mm,
                 machine_map, carve)
    dE = _checks.pictures("dE_dradiance", dE_dradiance, scene.shape)
    ends, *others = call.arguments()
    return call.gradients(scene._core.render_vjp(ends, dE, *others))


class _Call:
    """Arguments of one call, checked."""

    def __init__(self, scene: Scene, ends_mm: Any, width_um: Any, depth_um: Any, alpha: Any, base_alpha: Any,
                 lamp_mm: Any, lamp_log_intensity: Any, pose: Any, bow_mm: Any, machine_map: Any, carve: Any) -> None:
        if not isinstance(scene, Scene):
            raise Error(f"scene: is {type(scene).__name__}; give a pyburin.Scene")
        _checks.in_this_process()
        views, lights = scene.shape[0], len(scene.lights)
        self.given = _checks.ends(ends_mm)
        self.by_pairs = _checks.array_of("ends_mm", ends_mm).ndim == 3
        self.machine_map = None if machine_map is None else _checks.floats("machine_map", machine_map, (2, 3))
        self.ends = self.given if self.machine_map is None else _mapped(self.given, self.machine_map)
        size = len(self.ends)
        self.scalars = {name for name, v in (("width_um", width_um), ("depth_um", depth_um), ("alpha", alpha))
                        if v is not None and _checks.array_of(name, v).ndim == 0}
        self.columns = (_checks.column("width_um", width_um, size), _checks.column("depth_um", depth_um, size),
                        _checks.column("alpha", alpha, size, most=1.0))
        self.base_alpha = None if base_alpha is None else _checks.number("base_alpha", base_alpha, above=0, most=1)
        self.lamp_mm = None if lamp_mm is None else _checks.floats("lamp_mm", lamp_mm, (lights, 3))
        self.log_intensity = (None if lamp_log_intensity is None
                              else _checks.floats("lamp_log_intensity", lamp_log_intensity, (lights,)))
        if self.log_intensity is not None and np.abs(self.log_intensity).max() > 100:
            raise Error("lamp_log_intensity: has a value beyond 100")
        self.pose = None if pose is None else _checks.floats("pose", pose, (views, 6))
        self.bow_mm = None if bow_mm is None else _checks.floats("bow_mm", bow_mm, (3,))
        self.carve = _checks.flag("carve", carve)

    def arguments(self) -> tuple[Any, ...]:
        return (self.ends, *self.columns, self.base_alpha, self.lamp_mm, self.log_intensity, self.pose, self.bow_mm,
                self.carve)

    def gradients(self, by: dict[str, Any]) -> Gradients:
        ends = by["ends_mm"]
        if self.machine_map is not None:
            moved = ends.reshape(-1, 2)  # by each mapped place
            places = np.column_stack([self.given.reshape(-1, 2), np.ones(len(moved))])
            by["machine_map"] = moved.T @ places
            ends = (moved @ self.machine_map[:, :2]).reshape(-1, 4)
        by["ends_mm"] = ends.reshape(-1, 2, 2) if self.by_pairs else ends
        for name in self.scalars:
            by[name] = by[name].sum()
        return Gradients(**by)


def tone(radiance: npt.ArrayLike, exposure: npt.ArrayLike = 1.0, gamma: float = 2.2) -> npt.NDArray[Any]:
    """(exposure radiance)^(1 / gamma), clipped to 0..1: the picture that designs and PSNR compare.

    `exposure` is a number, or broadcasts against `radiance`: shape (V, 1, 1, 1) for one a view.
    """
    light = np.asarray(radiance) * np.asarray(exposure)
    out: npt.NDArray[Any] = np.clip(light, 0, 1) ** (1 / _checks.number("gamma", gamma, above=0))
    return out


@dataclass(frozen=True, eq=False)
class Footprint:
    """Results of `footprint_integral`: Dhat and covered area in mm², and derivatives if they were asked for.

    Derivatives by the half vector take its three components as free; only their part tangential to it has a meaning
    (docs/model.md 4.20).
    """

    Dhat_mm2: Floats
    area_mm2: Floats
    dDhat_dhalf: Floats | None = None
    dDhat_dcorners_mm: Floats | None = None
    dDhat_dalpha: Floats | None = None
    dDhat_dwidth_um: Floats | None = None
    dDhat_ddepth_um: Floats | None = None
    dDhat_dlength_mm: Floats | None = None
    darea_dcorners_mm: Floats | None = None
    darea_dwidth_um: Floats | None = None
    darea_ddepth_um: Floats | None = None
    darea_dlength_mm: Floats | None = None


def footprint_integral(half: npt.ArrayLike, corners_mm: npt.ArrayLike, alpha: npt.ArrayLike, width_um: npt.ArrayLike,
                       depth_um: npt.ArrayLike, length_mm: npt.ArrayLike, *, derivatives: bool = False) -> Footprint:
    """The integral of the groove's NDF over a pixel's footprint (docs/model.md 4.1), in double; frame: scratch, mm.

    All arguments broadcast against each other in their leading shape (...).

    Parameters
    ----------
    half : (..., 3)
        Half vectors in the scratch's frame (x across, y along, z out of the metal), of any length above 0.
    corners_mm : (..., 4, 2)
        Corners of convex quadrilaterals in order, either way round.
    alpha, width_um, depth_um, length_mm : (...)
        Roughness (at most 1), tool width, depth and length of the scratch; all above 0.
    derivatives : bool
        Compute all derivatives, too.

    Raises
    ------
    Error
        Naming the argument that is wrong.
    """
    h = _checks_any("half", half, (3,))
    corners = _checks_any("corners_mm", corners_mm, (4, 2))
    numbers = {name: _checks_any(name, v, ()) for name, v in
               (("alpha", alpha), ("width_um", width_um), ("depth_um", depth_um), ("length_mm", length_mm))}
    if not ((h != 0).any(-1)).all():
        raise Error("half: has a vector without length")
    for name, values in numbers.items():
        if not (values > 0).all() or (name == "alpha" and not (values <= 1).all()):
            raise Error(f"{name}: has a value that is not above 0{' and at most 1' if name == 'alpha' else ''}")
    try:
        shape = np.broadcast_shapes(h.shape[:-1], corners.shape[:-2], *(v.shape for v in numbers.values()))
    except ValueError:
        raise Error("half, corners_mm, alpha, width_um, depth_um, length_mm: leading shapes do not broadcast") from None
    rows = np.empty((*shape, 15))
    rows[..., :3] = h
    rows[..., 3:11] = corners.reshape(*corners.shape[:-2], 8)
    for k, values in enumerate(numbers.values()):
        rows[..., 11 + k] = values
    out = _core.footprint_integrals(rows.reshape(-1, 15), _checks.flag("derivatives", derivatives))
    out = out.reshape(*shape, out.shape[1])
    if not derivatives:
        return Footprint(out[..., 0], out[..., 1])
    pairs = (*shape, 4, 2)
    return Footprint(out[..., 0], out[..., 1], out[..., 2:5], out[..., 5:13].reshape(pairs), out[..., 13], out[..., 14],
                     out[..., 15], out[..., 16], out[..., 17:25].reshape(pairs), out[..., 25], out[..., 26],
                     out[..., 27])


def _checks_any(name: str, value: Any, tail: tuple[int, ...]) -> Floats:
    """Any leading shape before `tail`."""
    lead = max(_checks.array_of(name, value).ndim - len(tail), 0)
    return _checks.floats(name, value, (*(None,) * lead, *tail))


def _mapped(ends: Floats, machine_map: Floats) -> Floats:
    return np.ascontiguousarray((ends.reshape(-1, 2) @ machine_map[:, :2].T + machine_map[:, 2]).reshape(-1, 4))


def _names(name: str, value: Any, default: list[str], most: int) -> list[str]:
    if value is None:
        return default
    if isinstance(value, (str, bytes)) or not isinstance(value, (list, tuple)):
        raise Error(f"{name}: is {type(value).__name__}; give a list of names")
    out = [_checks.text(f"{name}[{i}]", v) for i, v in enumerate(value)]
    if not 1 <= len(out) <= most:
        raise Error(f"{name}: has {len(out)} names; give 1 to {most}")
    return out


def _window(bench: Bench, board: Board, pixels: Any, window_px: Any) -> list[int]:
    if pixels is None:
        width, height = bench.lens.width_px, bench.lens.height_px
        if window_px is None:
            return [0, 0, width, height]
        x, y, w, h = (_checks.integer("window_px", v, 0, 100_000) for v in _four(window_px))
        if not (w > 0 and h > 0 and x + w <= width and y + h <= height):
            raise Error(f"window_px: {(x, y, w, h)} is empty or leaves the photo of {width} x {height} pixels")
        return [x, y, w, h]
    if window_px is not None:
        raise Error("window_px: is of a photo; leave out pixels, or window_px")
    if isinstance(pixels, (list, tuple)):
        if len(pixels) != 2:
            raise Error("pixels: give (height, width), or one number")
        h, w = (_checks.integer("pixels", v, 1, 16_384) for v in pixels)
        return [0, 0, w, h]
    longest = _checks.integer("pixels", pixels, 1, 16_384)
    assert board.carve_max_mm is not None
    sides = np.subtract(board.carve_max_mm, board.carve_min_mm)
    w, h = (max(1, round(float(v))) for v in longest * sides / sides.max())
    return [0, 0, w, h]


def _four(value: Any) -> Sequence[Any]:
    if not isinstance(value, (list, tuple)) or len(value) != 4:
        raise Error("window_px: give first column, first row, width, height")
    return value
