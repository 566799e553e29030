"""Projects, measurements and benches by the `burin` program: BURIN_PROGRAM names it, or PATH has it; else these are skipped."""

from __future__ import annotations

import json
import os
import signal
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pyburin as burin
from pyburin import benches

ROOT = Path(__file__).parents[2]
PHOTOS = ROOT / "tests" / "data" / "rigs" / "b-small"
PICTURES = [ROOT / "samples" / "small-bench" / "targets" / name for name in ("moon.png", "boat.png")]
needs_program = pytest.mark.skipif(not burin.has("calib"), reason="no burin program: set BURIN_PROGRAM, or put it on PATH")


@needs_program
def test_a_project_from_pictures_to_its_tool_path(tmp_path: Path) -> None:
    project = burin.Project.new(tmp_path / "p", pictures=PICTURES, board_mm=(60, 60), count=200)
    assert project.next_step and project.out_of_date == []
    made = project.design(iterations=2, travel="unknown")
    assert set(made.psnr_db) == {"moon", "boat"} == set(made.previews) and min(made.psnr_db.values()) > 8
    assert all(p.read_bytes()[:4] == b"\x89PNG" for p in made.previews.values()) and "base64" in made._repr_html_()
    path = project.toolpath()
    assert path.good and path.files and path.page.is_file() and "G" in path.files[0].read_text()
    assert any(f.level == "warning" for f in path.findings)
    # What the program predicted is what pyburin renders of the same files, on the same pixels.
    board, bench = burin.read(project.folder / "board.json", project.folder / "bench.json")
    height, width = made.report["pixels"][1], made.report["pixels"][0]
    scene = burin.Scene(bench, board, pixels=(height, width))
    radiance = burin.render(scene, made.scratches.ends_mm, width_um=made.scratches.width_um, depth_um=made.scratches.depth_um,
                            alpha=made.scratches.alpha)
    assert radiance.max() > 0
    with pytest.raises(burin.Error, match="photos"):
        project.measure(tmp_path / "nothing")
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(burin.Error):
        project.measure(empty)
    assert burin.Project.open(project.folder).trace(path.files[0])


@needs_program
def test_calibration_from_photos(tmp_path: Path) -> None:
    """The session of tests/data/rigs/b-small: its truth, which the program never reads, lies within 4 sigmas."""
    measured = burin.calibrate(PHOTOS / "session.json", out=tmp_path / "bench")
    truth = json.loads((PHOTOS / "truth.json").read_text())
    lamp = measured["light.lamp.position_mm"]
    assert lamp.degree == "determined" and lamp.source == "measured" and lamp.unit == "mm"
    true_lamp = np.array(next(v for v in truth["lights"] if v["id"] == "lamp")["position_mm"])
    assert lamp.value is not None and lamp.sigma is not None
    assert (np.abs(np.asarray(lamp.value) - true_lamp) < 4 * np.asarray(lamp.sigma) + 0.1).all()  # tags' frame: 0.1 mm
    assert measured["lens"].value is None and measured["lens"].verdict_sigma
    assert [v.name for v in measured.bench.views] == [v["view"] for v in truth["views"]][:len(measured.bench.views)]
    assert "light.lamp.position_mm" in measured._repr_html_()
    rows = measured.residuals()
    used = rows[rows["used"]]
    assert len(used) > 100 and np.sqrt((used["dx_px"] ** 2).mean()) < 0.05
    assert any("tag 22" in f.text for f in measured.findings)
    scene = burin.Scene(measured.bench, measured.board, [measured.bench.views[0].name])
    assert burin.render(scene, np.zeros((0, 4))).max() > 0


@needs_program
def test_a_benchmark_of_one_bench(tmp_path: Path) -> None:
    """Few pixels' worth of samples: what is scored here is the machinery, by a bench.json that is the truth but for one number."""
    truth = benches.draw(5, 1, departures=["disk"])
    assert truth == benches.draw(5, 1, departures=["disk"]) and "disk_mm" in truth["lights"][0]
    truth["views"] = truth["views"][:1]
    truth["camera"]["imagersize"] = [240, 185]
    truth["camera"]["intrinsics"][:4] = [v / 4 for v in truth["camera"]["intrinsics"][:4]]
    truth["samples_plain"], truth["scratches"]["random"]["count"] = 1, 400
    bench = benches.make(tmp_path / "b", truth, samples=1)
    assert len(list(bench.photos.iterdir())) == 2
    with pytest.raises(burin.Error, match="folder"):
        benches.make(tmp_path / "b", truth)
    alpha = truth["material"]["alpha"]
    said: dict[str, Any] = {"views": [], "lights": [], "sensor": {}, "machine": {"affine": truth["machine"]["affine"]},
                            "material": {"alpha": 1.1 * alpha, "alpha_sigma": 0.02 * alpha, "depth_um": 9.0, "base_alpha": 0.1},
                            "verdict": {"depth_um": {"degree": "not_determined"}}}
    file = tmp_path / "bench.json"
    file.write_text(json.dumps(said))
    got = benches.score(bench, file)
    assert [r.name for r in got.rows] == ["alpha"] and got.unknown == ("depth_um",)
    # The mean over 400 grooves that scatter by at most 12 % is within 2 % of the drawn number.
    assert abs(got.rows[0].error - 0.1 * alpha) < 0.02 * alpha and 4 <= got.rows[0].z <= 6
    assert "alpha" in benches.table([got]) and "alpha" in got._repr_html_()
    said["material"]["alpha_sigma"] = 0
    file.write_text(json.dumps(said))
    with pytest.raises(burin.Error, match="sigma"):
        benches.score(bench, file)
    file.write_text("[]")
    with pytest.raises(burin.Error, match="bench.json"):
        benches.score(bench, file)


def test_draws_differ() -> None:
    assert benches.draw(1, 0) != benches.draw(1, 1)
    for changed in ({"seed": -1}, {"number": 1.5}, {"departures": "disk"}, {"departures": ["moon"]},
                    {"departures": ["disk", "panel"]}):
        arguments: dict[str, Any] = {"seed": 1, **changed}
        with pytest.raises(burin.Error, match=list(changed)[0]):
            benches.draw(**arguments)


@needs_program
def test_errors_are_the_program_s_own(tmp_path: Path) -> None:
    with pytest.raises(burin.Error, match="gone.json"):
        burin.run("design", "gone.json", "--out", tmp_path / "d")
    with pytest.raises(burin.Error, match="no-such-command"):
        burin.run("no-such-command")
    with pytest.raises(burin.Error, match="session"):
        burin.calibrate(tmp_path / "session.json", out=tmp_path)


@needs_program
@pytest.mark.skipif(signal.getsignal(signal.SIGINT) == signal.SIG_IGN, reason="runs where SIGINT is ignored")
def test_ctrl_c_ends_the_program(tmp_path: Path) -> None:
    """An hour's design (a million iterations) ends within seconds, and leaves no process behind."""
    threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        burin.run("design", ROOT / "samples" / "small-bench" / "design.json", "--iterations", "1000000", "--count", "300",
                  "--pixels", "32", "--out", tmp_path / "d")


def test_without_the_program(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("BURIN_PROGRAM", str(tmp_path / "gone"))
    monkeypatch.setenv("PATH", str(tmp_path))
    assert not burin.has("calib") and burin.has("core")
    with pytest.raises(burin.Error, match="BURIN_PROGRAM"):
        burin.run("status")


def test_wrong_arguments(tmp_path: Path) -> None:
    with pytest.raises(burin.Error, match="folder"):
        burin.Project(tmp_path)
    with pytest.raises(burin.Error, match="pictures"):
        burin.Project.new(tmp_path / "p", pictures=[])
    with pytest.raises(burin.Error, match="pictures"):
        burin.Project.new(tmp_path / "p", pictures=[tmp_path / "gone.png"])
    with pytest.raises(burin.Error, match="residuals.vnl"):
        burin.residuals(tmp_path / "residuals.vnl")
    (tmp_path / "r.vnl").write_text("# view tag\nv00 20 zero\n")
    with pytest.raises(burin.Error, match="line 2"):
        burin.residuals(tmp_path / "r.vnl")


def test_png_is_read_by_others(tmp_path: Path) -> None:
    """tkinter's and Pillow's readers are not everywhere: the file is unpacked here by the PNG specification."""
    import struct
    import zlib

    picture = np.linspace(0, 1, 5 * 7 * 3).reshape(5, 7, 3)
    data = burin.png(picture)
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">II", data[16:24]) == (7, 5)
    start = data.index(b"IDAT")
    size = struct.unpack(">I", data[start - 4:start])[0]
    rows = np.frombuffer(zlib.decompress(data[start + 4:start + 4 + size]), np.uint8).reshape(5, 22)
    assert (rows[:, 0] == 0).all() and np.abs(rows[:, 1:].reshape(5, 7, 3) - 255 * picture).max() <= 0.5
    for wrong in (np.zeros((0, 3)), np.zeros((3, 3, 2)), np.full((2, 2), np.nan), "text"):
        with pytest.raises(burin.Error, match="picture"):
            burin.png(wrong)
