"""Boards and benches as frozen dataclasses. Frame: board (x right, y up, z out of the metal), mm."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Sequence

import numpy as np
import numpy.typing as npt

from . import _checks, _core
from ._checks import Error, Floats

PathLike = str | os.PathLike[str]
Vector = Sequence[float] | npt.NDArray[Any]


def _tuple(name: str, value: Any, size: int) -> tuple[float, ...]:
    return tuple(float(v) for v in _checks.floats(name, value, (size,)))


class _Frozen:
    """Sets checked values in a frozen dataclass."""

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)


@dataclass(frozen=True)
class Board(_Frozen):
    """A board: its size, where scratches may lie, and the tool that carves it.

    Parameters
    ----------
    size_mm : (2,)
        Width and height.
    carve_min_mm, carve_max_mm : (2,), optional
        Corners of the area that designs fill; default: the whole board.
    tool_width_um : float
        The tool's width, four times its tip radius (docs/model.md 2).
    bend_radius_mm, bend_axis_deg : float
        A sheet bent to a cylinder after carving: its radius (below 0: hollow) and axis; radius None: flat or bowed.

    Raises
    ------
    Error
        For values that are not finite, not positive, or a carve area outside the board.
    """

    size_mm: Vector
    carve_min_mm: Vector = (0.0, 0.0)
    carve_max_mm: Vector | None = None
    tool_width_um: float = 400.0
    bend_radius_mm: float | None = None
    bend_axis_deg: float = 0.0
    _rest: Any = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        size = _tuple("Board.size_mm", self.size_mm, 2)
        if not (0 < min(size) and max(size) <= 100_000):
            raise Error(f"Board.size_mm: is {size}; give two sides above 0 and at most 100000 mm")
        low = _tuple("Board.carve_min_mm", self.carve_min_mm, 2)
        high = size if self.carve_max_mm is None else _tuple("Board.carve_max_mm", self.carve_max_mm, 2)
        if not all(0 <= a < b <= s for a, b, s in zip(low, high, size)):
            raise Error(f"Board.carve_max_mm: the carve area {low} to {high} is empty or leaves the board {size}")
        radius = self.bend_radius_mm
        if radius is not None:
            radius = _checks.number("Board.bend_radius_mm", radius)
        self._set(size_mm=size, carve_min_mm=low, carve_max_mm=high, bend_radius_mm=radius,
                  tool_width_um=_checks.number("Board.tool_width_um", self.tool_width_um, above=0),
                  bend_axis_deg=_checks.number("Board.bend_axis_deg", self.bend_axis_deg))
        _core_board(self)  # what C++ refuses is refused here


@dataclass(frozen=True)
class Lens(_Frozen):
    """A lens model of mrcal.

    Parameters
    ----------
    model : str
        "LENSMODEL_PINHOLE", "LENSMODEL_OPENCV4", "LENSMODEL_OPENCV5", "LENSMODEL_OPENCV8" or "LENSMODEL_OPENCV12".
    intrinsics : sequence of float
        fx, fy, cx, cy in pixels (the center of the top-left pixel is (0, 0)), then the distortion.
    width_px, height_px : int
        Size of the photos.
    """

    model: str
    intrinsics: Sequence[float]
    width_px: int
    height_px: int

    def __post_init__(self) -> None:
        values = tuple(float(v) for v in _checks.floats("Lens.intrinsics", self.intrinsics, (None,)))
        if len(values) < 4 or not (values[0] > 0 and values[1] > 0):
            raise Error("Lens.intrinsics: begin with fx, fy, cx, cy; both focal lengths must be above 0")
        self._set(model=_checks.text("Lens.model", self.model), intrinsics=values,
                  width_px=_checks.integer("Lens.width_px", self.width_px, 1, 100_000),
                  height_px=_checks.integer("Lens.height_px", self.height_px, 1, 100_000))
        if self.width_px * self.height_px > 110_000_000:
            raise Error("Lens.width_px: the photo has more than 110 million pixels")
        count = _core.lens_parameter_count(self.model)
        if len(values) != count:
            raise Error(f"Lens.intrinsics: has {len(values)} numbers; {self.model} has {count}")


@dataclass(frozen=True, eq=False)
class View(_Frozen):
    """A place of the camera.

    Parameters
    ----------
    name : str
    T_camera_board : (4, 4)
        Takes board coordinates to camera coordinates (x right, y down, z forward), mm. A rotation and a translation.
    """

    name: str
    T_camera_board: npt.ArrayLike

    def __post_init__(self) -> None:
        T = _checks.floats("View.T_camera_board", self.T_camera_board, (4, 4)).copy()
        R = T[:3, :3]
        if np.abs(R @ R.T - np.eye(3)).max() > 1e-6 or np.linalg.det(R) < 0 or (T[3] != (0, 0, 0, 1)).any():
            raise Error("View.T_camera_board: is not a rotation and a translation, with the last row 0, 0, 0, 1")
        T.flags.writeable = False
        self._set(name=_checks.text("View.name", self.name), T_camera_board=T)

    @staticmethod
    def look_at(name: str, eye_mm: Vector, aim_mm: Vector, roll_deg: float = 0.0) -> View:
        """The view of a camera at `eye_mm` (3,) whose line of sight goes through `aim_mm` (3,), both board mm."""
        eye, aim = _checks.floats("eye_mm", eye_mm, (3,)), _checks.floats("aim_mm", aim_mm, (3,))
        ray = eye - aim
        if np.hypot(ray[0], ray[2]) < 1e-9 * max(1.0, float(np.linalg.norm(ray))):
            raise Error("aim_mm: the line from eye_mm to aim_mm has no length or runs along the board's y axis")
        return View(name, _core.look_at(eye, aim, _checks.number("roll_deg", roll_deg)))


@dataclass(frozen=True)
class Light(_Frozen):
    """A near lamp: a point, a disk or a panel. Suns and environment maps come from files (`read`).

    Parameters
    ----------
    id : str
    position_mm : (3,)
    intensity : (3,)
        Radiant intensity, R G B.
    axis : (3,)
        Direction of a spotlight and of an area's normal, from the lamp; made unit.
    falloff_exponent : float
        0: as bright to all sides (docs/model.md 5.5).
    disk_radius_mm, panel_mm, panel_turn_deg
        An area light: a disk's radius, or a panel's sides (2,) and its turn about the axis. At most one of the two.
    kind : str
        "lamp", or "far" for a sun or an environment map that was read from a file.
    """

    id: str = "lamp"
    position_mm: Vector = (0.0, 0.0, 0.0)
    intensity: Vector = (1.0, 1.0, 1.0)
    axis: Vector = (0.0, 0.0, -1.0)
    falloff_exponent: float = 0.0
    disk_radius_mm: float = 0.0
    panel_mm: Vector = (0.0, 0.0)
    panel_turn_deg: float = 0.0
    kind: str = "lamp"

    def __post_init__(self) -> None:
        intensity = _tuple("Light.intensity", self.intensity, 3)
        if min(intensity) < 0:
            raise Error(f"Light.intensity: is {intensity}; give three numbers of at least 0")
        axis = _checks.floats("Light.axis", self.axis, (3,))
        length = float(np.linalg.norm(axis))
        if not length > 0:
            raise Error("Light.axis: has no length")
        if abs(length - 1) > 1e-12:
            axis = axis / length
        panel = _tuple("Light.panel_mm", self.panel_mm, 2)
        disk = _checks.number("Light.disk_radius_mm", self.disk_radius_mm, least=0)
        if min(panel) < 0 or (max(panel) > 0 and (min(panel) == 0 or disk > 0)):
            raise Error("Light.panel_mm: give two sides above 0, or (0, 0); and no disk beside a panel")
        if self.kind not in ("lamp", "far"):
            raise Error(f'Light.kind: is {self.kind!r}; give "lamp"')
        self._set(id=_checks.text("Light.id", self.id), intensity=intensity, axis=tuple(axis.tolist()), panel_mm=panel,
                  position_mm=_tuple("Light.position_mm", self.position_mm, 3), disk_radius_mm=disk,
                  falloff_exponent=_checks.number("Light.falloff_exponent", self.falloff_exponent, least=0),
                  panel_turn_deg=_checks.number("Light.panel_turn_deg", self.panel_turn_deg))


@dataclass(frozen=True)
class Material(_Frozen):
    """What grooves and the plain face reflect (docs/model.md 2 and 3).

    Parameters
    ----------
    alpha, base_alpha : float
        GGX roughness of the grooves' walls and of the plain face, above 0 and at most 1.
    depth_um : float
        Depth of the grooves under the face.
    f0 : (3,)
        Reflectance at normal incidence, R G B, 0 to 1.
    """

    alpha: float = 0.04
    depth_um: float = 10.0
    base_alpha: float = 0.15
    f0: Vector = (0.91, 0.92, 0.92)

    def __post_init__(self) -> None:
        f0 = _tuple("Material.f0", self.f0, 3)
        if not all(0 <= v <= 1 for v in f0):
            raise Error(f"Material.f0: is {f0}; give three numbers from 0 to 1")
        self._set(f0=f0, alpha=_checks.number("Material.alpha", self.alpha, above=0, most=1),
                  depth_um=_checks.number("Material.depth_um", self.depth_um, above=0),
                  base_alpha=_checks.number("Material.base_alpha", self.base_alpha, above=0, most=1))


@dataclass(frozen=True)
class Bench(_Frozen):
    """A setup: lens, viewpoints, lights, material, shape.

    Parameters
    ----------
    lens : Lens
    views : sequence of View
    lights : sequence of Light
    material : Material
    ambient : (3,)
        Radiance of even surroundings, R G B.
    bow_mm : (3,)
        Height of the face, b0 X² + b1 X Y + b2 Y², with X and Y from -1 to 1 over the board.
    crossings : str
        What is left where grooves cross: "add" (their light adds), "last" or "deepest" (docs/model.md 7.6).
    findings : tuple of str
        What a file of an older version lacks; one sentence each.

    A bench that was read from a file keeps what these fields do not say: the cross-section, fields of depth and
    roughness, machine errors. `dataclasses.replace` keeps it, too.
    """

    lens: Lens
    views: Sequence[View]
    lights: Sequence[Light]
    material: Material = Material()
    ambient: Vector = (0.0, 0.0, 0.0)
    bow_mm: Vector = (0.0, 0.0, 0.0)
    crossings: str = "add"
    findings: tuple[str, ...] = ()
    _rest: Any = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        for name, kind in (("lens", Lens), ("material", Material)):
            if not isinstance(getattr(self, name), kind):
                raise Error(f"Bench.{name}: is {type(getattr(self, name)).__name__}; give a pyburin.{kind.__name__}")
        self._set(views=_members("Bench.views", self.views, View, "name", 500),
                  lights=_members("Bench.lights", self.lights, Light, "id", 100),
                  ambient=_tuple("Bench.ambient", self.ambient, 3), bow_mm=_tuple("Bench.bow_mm", self.bow_mm, 3),
                  crossings=_checks.text("Bench.crossings", self.crossings))
        if min(self.ambient) < 0:
            raise Error("Bench.ambient: has a negative number")
        _core_bench(self)  # what C++ refuses is refused here


def _members(name: str, value: Any, kind: type, key: str, most: int) -> tuple[Any, ...]:
    if isinstance(value, (str, bytes)) or not isinstance(value, (list, tuple)):
        raise Error(f"{name}: is {type(value).__name__}; give a list of pyburin.{kind.__name__}")
    if not 1 <= len(value) <= most:
        raise Error(f"{name}: has {len(value)} entries; give 1 to {most}")
    for one in value:
        if not isinstance(one, kind):
            raise Error(f"{name}: has {type(one).__name__}; give pyburin.{kind.__name__}")
    keys = [getattr(one, key) for one in value]
    for one in keys:
        if keys.count(one) > 1:
            raise Error(f"{name}: {one!r} is there twice; give each a name of its own")
    return tuple(value)


def _array(values: Any) -> Floats:
    return np.array(values, dtype=np.float64)


def _core_board(board: Board) -> _core.Board:
    bend = None if board.bend_radius_mm is None else (board.bend_radius_mm, board.bend_axis_deg)
    return _core.make_board(board._rest, _array(board.size_mm), _array(board.carve_min_mm), _array(board.carve_max_mm),
                            board.tool_width_um, bend)


def _core_bench(bench: Bench) -> _core.Bench:
    m, lens = bench.material, bench.lens
    lights = [_core.Light(v.id, v.kind, _array(v.position_mm), _array(v.intensity), _array(v.axis), v.falloff_exponent,
                          v.disk_radius_mm, _array(v.panel_mm), v.panel_turn_deg) for v in bench.lights]
    views = [(v.name, np.ascontiguousarray(v.T_camera_board)) for v in bench.views]
    return _core.make_bench(bench._rest, lens.model, _array(lens.intrinsics), (lens.width_px, lens.height_px), views,
                            lights, _array((m.alpha, m.depth_um, m.base_alpha)), _array(m.f0), _array(bench.ambient),
                            _array(bench.bow_mm), bench.crossings)


def read(board_file: PathLike, bench_file: PathLike) -> tuple[Board, Bench]:
    """Read `board.json` and the `bench.json` of a setup as it holds for that board.

    Raises
    ------
    Error
        For a file that is missing or broken, with file, field and remedy.
    """
    board, bench = _core.read_setup(_path("board_file", board_file), _path("bench_file", bench_file))
    b, f = board.fields(), bench.fields()
    model, intrinsics, width, height = f["lens"]
    lights = [Light(v["id"], v["position_mm"], v["intensity"], v["axis"], v["falloff_exponent"], v["disk_mm"],
                    v["panel_mm"], v["panel_turn_deg"], v["kind"]) for v in f["lights"]]
    return (
        Board(b["size_mm"], b["carve_min_mm"], b["carve_max_mm"], b["tool_width_um"], b["bend_radius_mm"],
              b["bend_axis_deg"], _rest=board),
        Bench(Lens(model, intrinsics, width, height), [View(n, np.reshape(T, (4, 4))) for n, T in f["views"]], lights,
              Material(f["alpha"], f["depth_um"], f["base_alpha"], f["f0"]), f["ambient"], f["bow_mm"], f["crossings"],
              tuple(f["findings"]), _rest=bench),
    )


@dataclass(frozen=True, eq=False)
class Scratches:
    """Scratches in carving order.

    Attributes
    ----------
    ends_mm : (N, 2, 2)
        First and last end of each, x and y on the board.
    width_um, depth_um, alpha : (N,) or None
        None: the tool's width, the material's depth and roughness.
    carved : (N,) of bool or None
        True for those in the metal already.
    """

    ends_mm: Floats
    width_um: Floats | None = None
    depth_um: Floats | None = None
    alpha: Floats | None = None
    carved: npt.NDArray[np.bool_] | None = None

    def __len__(self) -> int:
        return len(self.ends_mm)

    def __repr__(self) -> str:
        own = [n for n in ("width_um", "depth_um", "alpha", "carved") if getattr(self, n) is not None]
        return f"Scratches({len(self)} scratches{', with ' + ', '.join(own) if own else ''})"

    def _repr_html_(self) -> str:
        from ._show import lines_of

        return f"<p>{len(self)} scratches</p>" + lines_of(self.ends_mm)

    @staticmethod
    def read(file: PathLike) -> Scratches:
        """Read `scratches.csv`. Raises Error naming the line of what is wrong."""
        return _scratches_of(_core.read_scratches(_path("file", file)))


def _scratches_of(fields: dict[str, Any]) -> Scratches:
    carved = fields["carved"]
    return Scratches(fields["ends_mm"].reshape(-1, 2, 2), fields["width_um"], fields["depth_um"], fields["alpha"],
                     None if carved is None else carved != 0)


def _path(name: str, value: Any) -> str:
    try:
        return os.fsdecode(value)
    except TypeError:
        raise Error(f"{name}: is {type(value).__name__}; give a path") from None


