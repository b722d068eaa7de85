"""`torsade info`, `torsade export` and `torsade open`, as from the shell."""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import torsade as ts
from short_runs import SHORT
from torsade import store
from torsade.protocols import PROTOCOLS
from torsade.protocols.driving import Interrupted


def shell(*arguments: str | Path, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "torsade", *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=cwd,
        check=False,
        env={**os.environ, **environment},
    )


def inside(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> tuple[int, str, str]:
    """Exit code, output and errors of a command, in this process."""
    from torsade.cli import main

    with pytest.raises(SystemExit) as left:
        main([str(a) for a in arguments])
    said = capsys.readouterr()
    return int(left.value.code or 0), said.out, said.err


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """An interrupted run."""

    def stop(share: float, note: str) -> None:
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        SHORT["tighten"].run(stop, tmp_path / "a.zarr")
    return tmp_path / "a.zarr.part"


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_info_of_every_protocol(
    protocol: str, stored: Callable[[str], Path], capsys: pytest.CaptureFixture[str]
) -> None:
    path, result = stored(protocol), ts.open(stored(protocol))
    code, out, err = inside(capsys, "info", path, "--json")
    assert (code, err, out.count("\n")) == (0, "", 1)
    about = json.loads(out)
    assert about["protocol"] == protocol
    assert (about["status"], about["complete"], about["frames"]) == ("complete", True, result.frames)
    assert about["spec"] == json.loads(json.dumps(SHORT[protocol].stored()))
    expected = json.loads(json.dumps(PROTOCOLS[protocol].report(result), allow_nan=False))
    assert about["report"] == expected
    assert {v["name"]: (tuple(v["dims"]), tuple(v["shape"])) for v in about["variables"]} == {
        str(name): (v.dims, v.shape) for name, v in result.dataset.variables.items()
    }
    assert all(v["units"] and v["long_name"] for v in about["variables"])
    assert about["dimensions"] == dict(result.dataset.sizes)
    came = about["provenance"]
    names = {"torsade", "python", "numpy", "scipy", "numba", "llvmlite", "xarray", "zarr"}
    assert set(came["versions"]) == names
    assert {"processor", "architecture", "compiled_for", "system", "cores"} <= set(came["machine"])
    assert (came["resumed"], came["wall_s"] > 0, len(came["kernels"])) == ([], True, 16)
    assert came.get("seed") == SHORT[protocol].stored().get("seed")
    assert about["files"] == sum(p.is_file() for p in path.rglob("*"))
    assert about["size_bytes"] == sum(p.stat().st_size for p in path.rglob("*") if p.is_file())
    assert socket.gethostname() not in map(str, came["machine"].values())
    code, out, err = inside(capsys, "info", path)
    assert (code, err) == (0, "")
    for words in (
        f"complete: {result.frames} frame",
        "kernels",
        "numpy",
        "cores",
        "asked for",
        "wall time",
    ):
        assert words in out


def test_info_says_how_far_an_interrupted_run_came_and_how_often_it_was_gone_on_with(
    part: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    about = json.loads(inside(capsys, "info", part.with_suffix(""), "--json")[1])  # the name it will have
    frames = ts.open(part).frames
    assert (about["path"], about["status"], about["complete"]) == (str(part), "interrupted", False)
    assert (about["frames"], about["report"]) == (frames, None)
    store.set_attributes(part, {"status": "running"})  # killed: nobody could say so any more
    assert json.loads(inside(capsys, "info", part, "--json")[1])["status"] == "stopped"
    lock = part.with_name("a.zarr.lock")
    lock.write_text("12 elsewhere\n")
    assert "growing: " in inside(capsys, "info", part)[1]
    lock.unlink()
    SHORT["tighten"].run(out=part.with_suffix(""), resume=True)
    about = json.loads(inside(capsys, "info", part.with_suffix(""), "--json")[1])
    assert (about["status"], [entry["done"] for entry in about["provenance"]["resumed"]]) == (
        "complete",
        [frames],
    )
    assert f"from {frames} frames" in inside(capsys, "info", part.with_suffix(""))[1]


def test_info_of_a_protocol_that_is_not_known_here(
    stored: Callable[[str], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = Path(shutil.copytree(stored("tighten"), tmp_path / "a.zarr"))
    store.set_attributes(path, {"protocol": "of-a-later-version"})
    code, out, _ = inside(capsys, "info", path)
    assert code == 0
    assert "of-a-later-version" in out
    assert json.loads(inside(capsys, "info", path, "--json")[1])["report"] is None


def test_numbers_that_a_report_needs_and_that_are_not_there(
    stored: Callable[[str], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = Path(shutil.copytree(stored("tighten"), tmp_path / "a.zarr"))
    store.set_attributes(path, {"protocol": "snap-twist"})
    code, out, err = inside(capsys, "info", path)
    assert (code, out) == (2, "")
    assert "cannot be read" in err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("to", "ending"), [("vtk", ".pvd"), ("gltf", ".glb"), ("csv", ".csv"), ("npz", ".npz")]
)
def test_an_export_lies_beside_its_result(
    to: str, ending: str, stored: Callable[[str], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = Path(shutil.copytree(stored("snap-twist"), tmp_path / "rod.zarr"))
    code, out, err = inside(capsys, "export", path, "--to", to, "--json")
    assert (code, err) == (0, "")
    told = json.loads(out)
    assert told["files"][0] == str(tmp_path / f"rod{ending}")
    assert all(Path(file).stat().st_size > 100 for file in told["files"])
    code, out, err = inside(capsys, "export", path, "--to", to)
    assert (code, out) == (2, "")
    assert "exists already; give another name, or --overwrite" in err
    assert inside(capsys, "export", path, "--to", to, "--overwrite", "--frames", "-1")[0] == 0
    code, out, _ = inside(capsys, "export", path, "--to", to, "-o", tmp_path / f"b{ending}", "--frames", "3")
    assert code == 0
    assert f"b{ending}" in out


def test_a_growing_run_is_exported_as_far_as_it_is(part: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = inside(capsys, "export", part.with_suffix(""), "--to", "csv", "--json")
    assert code == 0
    files = json.loads(out)["files"]
    assert Path(files[0]) == part.parent / "a.csv"
    assert len(Path(files[0]).read_text().splitlines()) == ts.open(part).frames + 1


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["info"], "no result is given; give a folder that a run wrote, such as reef.zarr"),
        (["info", "none.zarr"], "'none.zarr' does not exist; give a folder NAME.zarr"),
        (["info", "."], "'.' is not a result of torsade"),
        (["info", ""], "is not a result of torsade"),
        (["info", "a\0b"], "does not exist"),
        (["info", "a.zarr", "b.zarr"], "'b.zarr' comes after the result"),
        (["info", "a.zarr", "--jsn"], "info has no option --jsn; did you mean --json?"),
        (["export", "a.zarr"], "export needs a result and what to export to"),
        (["export", "none.zarr", "--to", "vtk"], "'none.zarr' does not exist"),
        (["export", "none.zarr", "--to"], "--to has no value"),
        (["export", "none.zarr", "--too", "vtk"], "did you mean --to?"),
        (["open", "none.zarr"], "'none.zarr' does not exist"),
        (["open", "none.zarr", "--frame", "first"], "--frame is 'first'; give a number such as 10, or -1"),
        (
            ["open", "none.zarr", "--picture", "a.jpg"],
            "cannot draw to 'a.jpg'; give a name that ends in .png",
        ),
    ],
)
def test_what_cannot_be_done_is_said_in_a_sentence(
    arguments: list[str],
    says: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pytest.importorskip("pyvista")
    monkeypatch.chdir(tmp_path)
    code, out, err = inside(capsys, *arguments)
    assert (code, out) == (2, "")
    assert says in err
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_without_a_display_it_is_said_what_to_do(
    stored: Callable[[str], Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    if sys.platform in ("win32", "darwin"):
        pytest.skip("there always is one")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    code, out, err = inside(capsys, "open", stored("tighten"))
    assert (code, out) == (2, "")
    assert err == (
        "torsade: there is no display to open a window on; give --picture FILE.png to draw to a file.\n"
    )
    code, _, err = inside(capsys, "open", stored("pendulum"))
    assert "has no shape to be drawn" in err


@pytest.mark.parametrize(
    ("protocol", "more"), [("tighten", []), ("snap-twist", []), ("snap-twist", ["--frame", "-1"])]
)
def test_a_picture_in_place_of_a_window(
    protocol: str,
    more: list[str],
    stored: Callable[[str], Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    pytest.importorskip("pyvista")
    from matplotlib.image import imread

    code, out, err = inside(capsys, "open", stored(protocol), "--picture", tmp_path / "a.png", *more)
    assert (code, err) == (0, "")
    assert "a.png" in out
    image = imread(tmp_path / "a.png")[:, :, :3]
    assert 0.005 < (image.min(axis=2) < 0.7).mean() < 0.6


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_the_history_of_every_stored_result_is_plotted(
    protocol: str, stored: Callable[[str], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("matplotlib")
    code, out, err = inside(capsys, "open", stored(protocol), "--plot", tmp_path / "a.svg", "--json")
    assert (code, err) == (0, "")
    assert json.loads(out) == {
        "result": str(stored(protocol)),
        "picture": None,
        "plot": str(tmp_path / "a.svg"),
    }
    assert (tmp_path / "a.svg").read_text().count("<path") > 20


def test_the_picture_of_a_rod_that_was_interrupted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("matplotlib")

    def stop(share: float, note: str) -> None:
        if share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        SHORT["snap-twist"].run(stop, tmp_path / "a.zarr")
    assert inside(capsys, "open", tmp_path / "a.zarr", "--picture", tmp_path / "a.png")[0] == 0


def test_the_shell_finds_the_commands(stored: Callable[[str], Path], tmp_path: Path) -> None:
    done = shell("info", stored("bend-twist"), "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["protocol"] == "bend-twist"
    text = shell("--help", cwd=tmp_path).stdout
    for name in ("info", "export", "open"):
        assert name in text
        assert "Examples:" in shell(name, "--help", cwd=tmp_path).stdout
