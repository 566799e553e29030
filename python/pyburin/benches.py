"""An open benchmark: photographed benches with known truth from seeds, and scores of what a program measured of them.

Photos are rendered by an independent point-sampling simulator (`burin simulate`), which shares no formula with the
renderer. Any program can take part: it reads photos and board.json of a `Bench`, never truth.json, and writes a
bench.json (docs/file-formats.md) with its numbers and their sigmas. docs/python.md has the rules.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterable, Mapping, Sequence

from . import _bench_truth, _checks, _program
from ._checks import Error
from ._types import PathLike, _path

DEPARTURES: tuple[str, ...] = tuple(_bench_truth.DEPARTURES)
"""Effects that a clean model leaves out, which a bench may have: "disk", "glare", "screws", ..."""


@dataclass(frozen=True)
class Bench:
    """A photographed bench.

    Attributes
    ----------
    folder : Path
    photos : Path
        Folder of the photos, with EXIF.
    board : Path
        board.json: what a participant knows, priors of roughness and depth among it.
    truth, carved : Path
        truth.json and carved.csv, which only `score` may read.
    """

    folder: Path

    @property
    def photos(self) -> Path:
        return self.folder / "photos"

    @property
    def board(self) -> Path:
        return self.folder / "board.json"

    @property
    def truth(self) -> Path:
        return self.folder / "truth.json"

    @property
    def carved(self) -> Path:
        return self.folder / "carved.csv"


@dataclass(frozen=True)
class Row:
    """One number against its truth.

    Attributes
    ----------
    group : str
        "camera", "lamp", "alpha", "depth", "base", "machine", ...
    name : str
    error : float
        Measured minus true, in the number's unit.
    sigma : float
        The participant's own.
    """

    group: str
    name: str
    error: float
    sigma: float

    @property
    def z(self) -> float:
        """Error over sigma."""
        return self.error / self.sigma


@dataclass(frozen=True)
class Score:
    """What a bench.json says, against the truth.

    Attributes
    ----------
    rows : tuple of Row
        Every number that has a sigma above 0.
    unknown : tuple of str
        Parameters that the file's verdict calls anything but "determined".
    """

    rows: tuple[Row, ...]
    unknown: tuple[str, ...]

    def _repr_html_(self) -> str:
        from ._show import table as html_table

        return html_table([("number", "error", "sigma", "z"),
                           *((r.name, f"{r.error:.4g}", f"{r.sigma:.4g}", f"{r.z:+.2f}") for r in self.rows)])


def draw(seed: int, number: int = 0, *, departures: Sequence[str] = ()) -> dict[str, Any]:
    """The truth (burin/rig-truth) of a random bench: the same for the same seed and number, on every machine.

    Parameters
    ----------
    seed, number : int
    departures : sequence of str
        Of `DEPARTURES`; all of them in this bench.
    """
    seed = _checks.integer("seed", seed, 0, 2**31)
    number = _checks.integer("number", number, 0, 1_000_000)
    names = _departures(departures)
    truth: dict[str, Any] = _bench_truth.draw_bench(seed, number)
    if names:
        _bench_truth.depart(truth, seed, number, names, True)
    return truth


def make(folder: PathLike, truth: Mapping[str, Any], *, samples: int | None = None) -> Bench:
    """Photograph a bench: photos, board.json, carved.csv and truth.json in a new folder. Needs the `burin` program.

    Parameters
    ----------
    folder : path
    truth : mapping
        Of `draw`, perhaps changed.
    samples : int, optional
        Samples per pixel on scratches; default: the truth's 144.

    Raises
    ------
    Error
        For a folder that holds a bench already; with the program's message.
    """
    if not isinstance(truth, Mapping):
        raise Error(f"truth: is {type(truth).__name__}; give what draw() gives")
    bench = Bench(Path(_path("folder", folder)))
    if bench.truth.exists():
        raise Error(f"folder: {bench.folder} holds a bench already; give another, or delete it")
    try:
        text = json.dumps(truth, indent=1)
    except (TypeError, ValueError) as error:
        raise Error(f"truth: has something that JSON cannot hold ({error})") from None
    bench.folder.mkdir(parents=True, exist_ok=True)
    bench.truth.write_text(text)
    more = [] if samples is None else ["--samples", str(_checks.integer("samples", samples, 1, 1_000_000))]
    _program.run("simulate", bench.truth, "--out", bench.folder, *more)
    board = json.loads(bench.board.read_text())
    for key in ("profile", "brushed"):  # a microscope would know them; photos shall show them
        board["material"].pop(key, None)
    bench.board.write_text(json.dumps(board, indent=1))
    return bench


def measure(bench: Bench) -> Path:
    """Burin's own entry: capture, calibrate, refine. The path of its bench.json."""
    if not isinstance(bench, Bench):
        raise Error(f"bench: is {type(bench).__name__}; give a pyburin.benches.Bench")
    session, out = bench.folder / "session", bench.folder / "bench"
    _program.run("capture", bench.photos, "--board", bench.board, "--out", session)
    _program.run("calibrate", session / "session.json", "--out", out)
    _program.run("refine", session / "session.json", "--bench", out / "bench.json")
    return out / "bench.json"


def score(bench: Bench, measured: PathLike) -> Score:
    """Compare a participant's bench.json with the truth.

    Numbers without a sigma do not count, and a sigma must be above 0. Cameras and lamps are compared in the frame of
    the tags as a set; alpha and depth with the geometric mean over the grooves as carved.

    Raises
    ------
    Error
        For a file that is missing or broken, or that lacks a view or light of the truth.
    """
    if not isinstance(bench, Bench):
        raise Error(f"bench: is {type(bench).__name__}; give a pyburin.benches.Bench")
    path = Path(_path("measured", measured))
    try:
        truth, said = json.loads(bench.truth.read_text()), json.loads(path.read_text())
        rows = _bench_truth.compare(truth, said, bench.carved)
        unknown = sorted(k for k, v in said.get("verdict", {}).items() if v["degree"] != "determined")
    except OSError as error:
        raise Error(f"measured: {error}") from None
    except (ValueError, KeyError, TypeError, IndexError, AttributeError, ZeroDivisionError) as error:
        raise Error(f"measured: {path} is no bench.json of this bench ({type(error).__name__}: {error})") from None
    bad = [name for _, name, error, sigma in rows if not (sigma > 0 and math.isfinite(error) and math.isfinite(sigma))]
    if bad:
        raise Error(f"measured: {path} has a sigma that is not above 0, or a number that is not finite: {bad[0]}")
    return Score(tuple(Row(*row) for row in rows), tuple(unknown))


def table(scores: Iterable[Score]) -> str:
    """A table of many benches, one line per group: count, RMS of errors, sigmas and z, the share within two sigmas."""
    groups: dict[str, list[Row]] = {}
    for one in scores:
        if not isinstance(one, Score):
            raise Error(f"scores: has {type(one).__name__}; give what score() gives")
        for row in one.rows:
            groups.setdefault(row.group, []).append(row)
    lines = [f"{'parameter':<12}{'count':>6}{'rms error':>12}{'rms sigma':>12}{'rms z':>8}{'within 2':>10}{'worst z':>9}"]
    for group, rows in groups.items():
        worst = max((r.z for r in rows), key=abs)
        within = 100 * sum(abs(r.z) <= 2 for r in rows) / len(rows)
        lines.append(f"{group:<12}{len(rows):>6}{_rms(r.error for r in rows):>12.3g}{_rms(r.sigma for r in rows):>12.3g}"
                     f"{_rms(r.z for r in rows):>8.2f}{within:>8.1f} %{worst:>9.1f}")
    return "\n".join(lines)


def _rms(values: Iterable[float]) -> float:
    squares = [v * v for v in values]
    return math.sqrt(sum(squares) / len(squares))


def _departures(names: Any) -> list[str]:
    if isinstance(names, (str, bytes)) or not isinstance(names, (list, tuple)):
        raise Error(f"departures: is {type(names).__name__}; give a list of names")
    unknown = [n for n in names if n not in DEPARTURES]
    if unknown:
        raise Error(f"departures: {unknown[0]!r} is not known; give some of {', '.join(DEPARTURES)}")
    for one, other in (("disk", "panel"), ("disk", "softbox"), ("panel", "softbox"), ("flanks", "arc")):
        if one in names and other in names:
            raise Error(f"departures: a bench cannot have both {one} and {other}")
    return list(names)
