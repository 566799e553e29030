"""The `burin` program from Python: photos, calibration, tool paths and projects run in it, with --json. docs/python.md."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Sequence

from . import _checks
from ._checks import Error
from ._types import PathLike, _path


@dataclass(frozen=True)
class Finding:
    """A diagnostic.

    Attributes
    ----------
    level : str
        "note": nothing to do. "warning": the result may be worse. "error": do not carve the result.
    text : str
        One sentence with the remedy.
    code : str
        Kind of an error (docs/json.md); else empty.
    """

    level: str
    text: str
    code: str = ""


@dataclass(frozen=True)
class Run:
    """A finished command of the program.

    Attributes
    ----------
    command : str
    data : dict
        Its results by name; those with a unit are {"value", "unit", "sigma"} (docs/json.md).
    findings : tuple of Finding
    files : tuple of Path
        The files that it wrote.
    next : tuple of tuple of str
        Further commands, each as arguments that run as they are.
    """

    command: str
    data: dict[str, Any]
    findings: tuple[Finding, ...]
    files: tuple[Path, ...]
    next: tuple[tuple[str, ...], ...]


def program() -> Path | None:
    """The `burin` program: the environment's BURIN_PROGRAM, else the one on PATH; None if there is neither."""
    named = os.environ.get("BURIN_PROGRAM") or shutil.which("burin")
    return Path(named) if named and os.access(named, os.X_OK) else None


def run(*arguments: str | os.PathLike[str], cwd: PathLike | None = None) -> Run:
    """Run a command of the `burin` program, as in docs/commands.md: run("design", "design.json", "--out", "round-01").

    Parameters
    ----------
    arguments : str or path
    cwd : path, optional
        The working directory.

    Ctrl-C ends the program, too.

    Raises
    ------
    Error
        With the program's own message; if there is no program.
    """
    words = [_path(f"arguments[{i}]", a) for i, a in enumerate(arguments)]
    return done(ask(words, cwd), Path(_path("cwd", cwd)) if cwd is not None else Path())


def done(answer: dict[str, Any], folder: Path = Path()) -> Run:
    """The program's JSON object as a `Run`; `folder`: of relative paths in it."""

    return Run(str(answer.get("command", "")), dict(answer.get("data", {})), findings_of(answer),
               tuple(folder / str(f) for f in answer.get("files", ())),
               tuple(tuple(str(word) for word in line) for line in answer.get("next", ())))


def findings_of(answer: dict[str, Any]) -> tuple[Finding, ...]:
    """The diagnostics of the program's JSON object, and those of a page (`burin check carve`)."""
    all_of_them = [*answer.get("diagnostics", ()), *answer.get("data", {}).get("findings", ())]
    return tuple(Finding(str(d["severity"]), _sentence(d), str(d.get("code", ""))) for d in all_of_them)


def _sentence(diagnostic: dict[str, Any]) -> str:
    place = ": ".join(str(diagnostic[key]) for key in ("file", "field") if diagnostic.get(key))
    words = "; ".join(str(diagnostic[key]) for key in ("message", "remedy") if diagnostic.get(key))
    return f"{place}: {words}" if place else words


def ask(words: Sequence[str], cwd: PathLike | None = None, most_exit_code: int = 0) -> dict[str, Any]:
    """The program's JSON object. Exit codes above `most_exit_code` are errors."""
    if not words:
        raise Error("arguments: give a command, such as \"status\"")
    found = program()
    if found is None:
        raise Error("burin: there is no such program on PATH; install Burin, or set BURIN_PROGRAM to its file")
    folder = None if cwd is None else _path("cwd", cwd)
    try:
        process = subprocess.Popen([str(found), *words, "--json"], cwd=folder, stdin=subprocess.DEVNULL, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, errors="replace")
    except (OSError, ValueError) as error:
        raise Error(f"burin {words[0]}: cannot be started ({error})") from None
    with process:
        try:
            out, problems = process.communicate()
        except BaseException:  # Ctrl-C
            process.terminate()
            raise
    try:
        answer = json.loads(out)
    except json.JSONDecodeError:
        answer = {}
    errors = [f.text for f in findings_of(answer) if f.level == "error"] if isinstance(answer, dict) else []
    if not 0 <= process.returncode <= most_exit_code or not isinstance(answer, dict) or not answer:
        words_of_it = "; ".join(errors) or problems.strip() or f"ended with exit code {process.returncode}"
        raise Error(f"burin {words[0]}: {words_of_it}")
    return answer


def has_program() -> bool:
    """Whether commands can run."""
    return program() is not None


def options(given: dict[str, Any]) -> list[str]:
    """`--name value` for each keyword that is neither None nor False; `_` becomes `-`."""
    out: list[str] = []
    for name, value in given.items():
        if value is None or value is False:
            continue
        out.append("--" + name.replace("_", "-"))
        if value is True:
            continue
        values = value if isinstance(value, (list, tuple)) else [value]
        for one in values:
            if not isinstance(one, (str, int, float, os.PathLike)):
                raise Error(f"{name}: is {type(one).__name__}; give a string, a number or a path")
            out.append(os.fspath(one) if isinstance(one, os.PathLike) else str(one))
    return out


def file_in(name: str, value: Any) -> str:
    """A path that exists."""
    path = _path(name, value)
    if not os.path.exists(path):
        raise Error(f"{name}: {path} does not exist")
    _checks.text(name, path)
    return path
