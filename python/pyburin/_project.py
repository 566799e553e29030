"""A board's project, from pictures to a measured setup, by the `burin` program. docs/python.md, docs/first-board.md."""

from __future__ import annotations

import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Sequence

from . import _checks, _program
from ._checks import Error
from ._measure import Measured, read_measured
from ._program import Finding, Run, file_in, options
from ._types import PathLike, Scratches, Vector, _path


@dataclass(frozen=True, eq=False)
class ProjectDesign:
    """A round's design.

    Attributes
    ----------
    scratches : Scratches
    psnr_db, ssim : dict from view name to float
        Of the predicted pictures on the design's own pixels.
    eye_psnr_db : dict from view name to float
        The figure to compare designs by: on the pixels that eyes at the viewpoint tell apart.
    previews : dict from view name to Path
        PNG files.
    report : dict
        design-report.json (docs/file-formats.md).
    findings : tuple of Finding
    """

    scratches: Scratches
    psnr_db: dict[str, float]
    ssim: dict[str, float]
    eye_psnr_db: dict[str, float]
    previews: dict[str, Path]
    report: dict[str, Any]
    findings: tuple[Finding, ...]

    def _repr_html_(self) -> str:
        from ._show import figures

        return figures([(f"{view}: {self.eye_psnr_db[view]:.1f} dB", file.read_bytes())
                        for view, file in self.previews.items()])


@dataclass(frozen=True)
class Toolpath:
    """A round's tool path, replayed and checked.

    Attributes
    ----------
    files : tuple of Path
        G-code, in the order of carving.
    page : Path
        The page to read before carving.
    data : dict
        Results of the check by name, such as the time to carve.
    findings : tuple of Finding
    good : bool
        No finding is an error.
    """

    files: tuple[Path, ...]
    page: Path
    data: dict[str, Any]
    findings: tuple[Finding, ...]

    @property
    def good(self) -> bool:
        return not any(f.level == "error" for f in self.findings)


class Project:
    """A folder of `burin new`, with its rounds of design, carving and photos.

    All work is done by the `burin` program (`has("calib")`), which keeps records and locks: command line and Python can
    take turns.
    """

    def __init__(self, folder: PathLike) -> None:
        self._folder = Path(_path("folder", folder))
        if not (self._folder / "board.json").is_file() or not (self._folder / "design.json").is_file():
            raise Error(f"folder: {self._folder} has no board.json and design.json; Project.new() makes a project")

    @staticmethod
    def open(folder: PathLike) -> Project:
        """The project in a folder."""
        return Project(folder)

    @staticmethod
    def new(folder: PathLike, *, pictures: Sequence[PathLike], board_mm: Vector = (200, 150),
            machine: str = "grbl-spring", **more: Any) -> Project:
        """A new project, with a quick preview.

        Parameters
        ----------
        folder : path
            Must not exist.
        pictures : sequence of paths
            One to nine pictures, one viewpoint each.
        board_mm : (2,)
            Width and height of the sheet.
        machine : str
            A built-in machine or a burin/machine file.
        more
            Options of `burin new`: camera, lamp, stand, fit, keep, count.
        """
        if isinstance(pictures, (str, bytes)) or not isinstance(pictures, (list, tuple)) or not 1 <= len(pictures) <= 9:
            raise Error("pictures: give a list of one to nine paths")
        size = _checks.floats("board_mm", board_mm, (2,))
        path = _path("folder", folder)
        _program.run("new", path, "--pictures", *(file_in(f"pictures[{i}]", p) for i, p in enumerate(pictures)),
                     "--board", f"{size[0]:g}x{size[1]:g}", "--machine", _checks.text("machine", machine),
                     *options(more))
        return Project(path)

    @property
    def folder(self) -> Path:
        """The project's folder."""
        return self._folder

    def __repr__(self) -> str:
        return f"Project({str(self._folder)!r})"

    def status(self) -> dict[str, Any]:
        """All stages, their inputs and conditions: the data of `burin status --json`."""
        return _program.done(_program.ask(["status", str(self._folder)])).data

    @property
    def next_step(self) -> str:
        """What to do next, in words."""
        return str(self.status().get("next", ""))

    @property
    def out_of_date(self) -> list[str]:
        """Results whose inputs changed: "round-01/design"."""
        return [str(s.get("stage")) for s in self.status().get("stages", ())
                if s.get("condition") != "not begun" and not s.get("up_to_date")]

    def trace(self, file: PathLike) -> dict[str, Any]:
        """The inputs of a result, by content: the data of `burin trace --json`."""
        return _program.done(_program.ask(["trace", file_in("file", file), "--project", str(self._folder)])).data

    def design(self, **more: Any) -> ProjectDesign:
        """Design the next board, with its tool path: `burin loop` as far as it goes without photos.

        `more`: options of `burin loop`, which loop.toml keeps: count, iterations, time, seed, travel, ...
        A project with a truth.json also simulates its photos and measures them.
        """
        done = self._loop(more)
        return self._design_of(self._round(), done)

    def toolpath(self) -> Toolpath:
        """The last round's tool path, after a replay of its G-code (`burin check carve`).

        A fault of the G-code is a finding of the level "error", and `good` is False.
        """
        folder = self._round()
        done = _program.done(_program.ask(["check", "carve", str(self._folder)], most_exit_code=1))
        files = sorted(p for p in folder.glob("board*.*") if p.suffix in (".gcode", ".ngc", ".nc") and "frame" not in p.name)
        return Toolpath(tuple(files), folder / "carve-check.html", done.data, done.findings)

    def measure(self, photos: PathLike | None = None, **more: Any) -> Measured:
        """Measure the setup from photos of the carved board: capture, calibrate, refine and report.

        Parameters
        ----------
        photos : path, optional
            A folder of photos, copied into the round's; None: they are there.
        more
            Options of `burin loop`: accept_unknown, view, lamp, again, ...
        """
        folder = self._round()
        if photos is not None:
            source = Path(file_in("photos", photos))
            if not source.is_dir():
                raise Error(f"photos: {source} is no folder")
            if source.resolve() != (folder / "photos").resolve():
                shutil.copytree(source, folder / "photos", dirs_exist_ok=True)
        done = self._loop(more)
        if not (folder / "bench.json").is_file():
            raise Error(f"photos: {folder / 'photos'} gave no measurement: {self.next_step}")
        return read_measured(folder / "board.json", folder / "bench.json", done)

    def _loop(self, more: dict[str, Any]) -> Run:
        return _program.run("loop", self._folder, *options(more))

    def _round(self) -> Path:
        rounds = sorted(p for p in self._folder.glob("round-*") if (p / "scratches.csv").is_file())
        if not rounds:
            raise Error(f"folder: {self._folder} has no design yet; call design()")
        return rounds[-1]

    def _design_of(self, folder: Path, done: Run) -> ProjectDesign:
        report = json.loads((folder / "design" / "design-report.json").read_text())
        views = {v["view"]: v for v in report["views"]}

        def of(key: str) -> dict[str, float]:
            return {name: float(v[key]) for name, v in views.items()}

        return ProjectDesign(Scratches.read(folder / "scratches.csv"), of("psnr_db"), of("ssim"), of("eye_psnr_db"),
                             {name: folder / "design" / v["preview"] for name, v in views.items()}, report, done.findings)
