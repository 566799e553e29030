"""Measurement from photos, by the `burin` program: sessions in, parameters with sigmas out. docs/calibration.md."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterator, Mapping

import numpy as np
import numpy.typing as npt

from . import _program
from ._checks import Error, Floats
from ._program import Finding, Run, file_in, options
from ._types import Bench, Board, PathLike, _path, read


@dataclass(frozen=True, eq=False)
class Parameter:
    """One measured or assumed parameter of a setup, as bench.json has it (docs/file-formats.md, Verdicts).

    Attributes
    ----------
    name : str
        "alpha", "depth_um", "light.lamp.position_mm", ...
    value : float, array or None
        None for "lens", "poses", "board.tags", which are many numbers: see `Measured.bench`.
    sigma : float, array or None
        Standard deviation of `value`, of its shape; None: none is known.
    degree : str
        "determined", "weakly" or "not_determined" by the photos.
    source : str
        "measured", "given" or "assumed".
    verdict_sigma, unit : float or None, str
        The largest standard deviation of the parameter's numbers, and its unit ("%", "mm", "px", "degrees", "").
    reason, next_photo : str
        In words; empty if there is none.
    """

    name: str
    value: float | Floats | None
    sigma: float | Floats | None
    degree: str
    source: str
    verdict_sigma: float | None
    unit: str
    reason: str
    next_photo: str


@dataclass(frozen=True, eq=False)
class Measured(Mapping[str, Parameter]):
    """A setup measured from photos. `measured["alpha"]` is a `Parameter`.

    Attributes
    ----------
    board, bench : Board, Bench
        For `Scene`.
    parameters : dict of Parameter
    findings : tuple of Finding
    hold_out : dict or None
        hold-out.json (docs/file-formats.md), if it was wanted.
    file : Path
        bench.json.
    """

    board: Board
    bench: Bench
    parameters: dict[str, Parameter]
    findings: tuple[Finding, ...]
    hold_out: dict[str, Any] | None
    file: Path

    def __getitem__(self, name: str) -> Parameter:
        return self.parameters[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.parameters)

    def __len__(self) -> int:
        return len(self.parameters)

    def _repr_html_(self) -> str:
        from ._show import table

        return table([("parameter", "value", "sigma", "degree", "source"),
                      *((p.name, "" if p.value is None else p.value, "" if p.sigma is None else p.sigma, p.degree, p.source)
                        for p in self.parameters.values())])

    def residuals(self) -> npt.NDArray[Any]:
        """Corner residuals of `calibrate`: a structured array that pandas.DataFrame takes (docs/file-formats.md)."""
        return residuals(self.file.parent / "residuals.vnl")


def read_measured(board_file: PathLike, bench_file: PathLike, run: Run | None = None) -> Measured:
    """The parameters of a bench.json that `calibrate` or `refine` wrote.

    Raises
    ------
    Error
        For a file that is missing or broken; for a board that the setup was not measured on.
    """
    board, bench = read(board_file, bench_file)
    file = Path(_path("bench_file", bench_file))
    fields = json.loads(file.read_text())
    parameters = {name: _parameter(name, fields, verdict) for name, verdict in fields.get("verdict", {}).items()}
    held_out = file.parent / "hold-out.json"
    findings = run.findings if run is not None else ()
    return Measured(board, bench, parameters, findings, json.loads(held_out.read_text()) if held_out.exists() else None,
                    file)


def capture(photos: PathLike, *, board: PathLike, out: PathLike, **more: Any) -> Path:
    """A session from a folder of photos: the path of its session.json. `more`: options of `burin capture`."""
    _program.run("capture", file_in("photos", photos), "--board", file_in("board", board), "--out", _path("out", out),
                 *options(more))
    return Path(_path("out", out)) / "session.json"


def calibrate(session: PathLike, *, out: PathLike, hold_out: str | bool | None = None, **more: Any) -> Measured:
    """Lens, camera poses, warp, tags and lamp from a session's photos.

    Parameters
    ----------
    session : path
        session.json of `capture`.
    out : path
        Folder for bench.json, camera.cameramodel and residuals.vnl.
    hold_out : str or True, optional
        Cross-validate: views ("v03,v07"), a share ("0.25"), folds ("5"); True: four folds.
    more
        Options of `burin calibrate`: camera, camera_as_seed, lens_model, response.

    Raises
    ------
    Error
        With the program's message.
    """
    done = _program.run("calibrate", file_in("session", session), "--out", _path("out", out),
                        *options({**more, "hold_out": hold_out}))
    return read_measured(board_of(session), Path(_path("out", out)) / "bench.json", done)


def refine(session: PathLike, *, bench: PathLike, out: PathLike, hold_out: str | bool | None = None,
           **more: Any) -> Measured:
    """Roughness, depth, lamp and machine from photos, in addition to `calibrate`'s bench.json.

    Parameters
    ----------
    session, bench : path
        session.json, and the bench.json to complete.
    out : path
        Folder for the completed bench.json.
    hold_out : str or True, optional
        Cross-validate the pixels, as in `calibrate`; True: a quarter of the views.
    more
        Options of `burin refine`: crossings, keep_lamp, pixel_mm.
    """
    done = _program.run("refine", file_in("session", session), "--bench", file_in("bench", bench), "--out",
                        _path("out", out), *options({**more, "hold_out": hold_out}))
    return read_measured(board_of(session), Path(_path("out", out)) / "bench.json", done)


def plan(board: PathLike, *, out: PathLike, **more: Any) -> dict[str, Any]:
    """Photos to take: plan.json (docs/file-formats.md). `more`: options of `burin plan`: bench, design, shots, ..."""
    _program.run("plan", file_in("board", board), "--out", _path("out", out), *options(more))
    found: dict[str, Any] = json.loads((Path(_path("out", out)) / "plan.json").read_text())
    return found


def simulate(truth: PathLike, *, out: PathLike, **more: Any) -> Path:
    """Synthetic photos of a setup with known ground truth: the path of session.json.

    `more`: options of `burin simulate`: scratches, views, samples.
    """
    _program.run("simulate", file_in("truth", truth), "--out", _path("out", out), *options(more))
    return Path(_path("out", out)) / "session.json"


def residuals(file: PathLike) -> npt.NDArray[Any]:
    """residuals.vnl as a structured array: view, tag, corner, x_px, y_px, dx_px, dy_px, sigma_px, used, photo.

    `pandas.DataFrame(burin.residuals(file))` is a table of it.

    Raises
    ------
    Error
        For a file that is missing or broken.
    """
    path = Path(_path("file", file))
    try:
        lines = path.read_text().splitlines()
    except OSError as error:
        raise Error(f"file: {path}: {error.strerror}") from None
    kind = np.dtype([("view", "U64"), ("tag", int), ("corner", int), ("x_px", float), ("y_px", float), ("dx_px", float),
                     ("dy_px", float), ("sigma_px", float), ("used", bool), ("photo", "U256")])
    rows: list[tuple[Any, ...]] = []
    for number, line in enumerate(lines, start=1):
        if line.startswith("#") or not line.strip():
            continue
        words = line.split(maxsplit=9)
        try:
            rows.append((words[0], int(words[1]), int(words[2]), *map(float, words[3:8]), words[8] == "1", words[9]))
        except (ValueError, IndexError):
            raise Error(f"file: {path}, line {number}: is no row of residuals") from None
    return np.array(rows, dtype=kind)


def board_of(session: PathLike) -> Path:
    """The board.json of a session."""
    file = Path(_path("session", session))
    file = file / "session.json" if file.is_dir() else file
    try:
        return file.parent / str(json.loads(file.read_text())["board"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise Error(f"session: {file} names no board ({error})") from None


def _parameter(name: str, fields: dict[str, Any], verdict: dict[str, Any]) -> Parameter:
    holder, key = _place(name, fields)
    value = _numbers(holder.get(key))
    sigma = None if value is None else _numbers(holder.get(_sigma_key(key)))
    next_photo = verdict.get("next_photo", {})
    return Parameter(name, value, sigma, verdict.get("degree", ""), verdict.get("source", ""), verdict.get("sigma"),
                     verdict.get("unit", ""), verdict.get("reason", ""),
                     next_photo.get("words", "") if isinstance(next_photo, dict) else "")


# Where bench.json has a parameter: the object that holds it, and its key there.
def _place(name: str, fields: dict[str, Any]) -> tuple[dict[str, Any], str]:
    if name.startswith("light."):
        light, _, key = name[len("light."):].rpartition(".")
        return next((v for v in fields.get("lights", ()) if v.get("id") == light), {}), key
    room, _, key = name.rpartition(".")
    if room:
        return fields.get(room, {}), key
    return (fields["material"], name) if name in fields.get("material", {}) else (fields, name)


def _sigma_key(key: str) -> str:
    for unit in ("_mm", "_um", "_px", "_deg"):
        if key.endswith(unit):
            return key[: -len(unit)] + "_sigma" + unit
    return key + "_sigma"


def _numbers(value: Any) -> float | Floats | None:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value)
    try:
        out = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        return None
    return out if out.ndim > 0 and np.isfinite(out).all() else None
