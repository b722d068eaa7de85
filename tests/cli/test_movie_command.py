"""`torsade movie` and `--movie`: what they write, what they refuse, what Ctrl-C leaves."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from torsade.cli import main
from torsade.protocols import SnapTwist
from torsade.view import encode, film

pytest.importorskip("pyvista")
pytest.importorskip("imageio_ffmpeg")

RUN = ["run", "snap-twist", "--twist", "60 deg", "--duration", "0.2 ms", "--frames", "4"]


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("results") / "snap.zarr"
    SnapTwist(twist="60 deg", duration="0.2 ms", frames=10).run(out=out)
    return out


def status(*arguments: str) -> int:
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    return int(stopped.value.code or 0)


def test_a_movie_of_a_result(stored: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "snap.mp4"
    options = ["--size", "200x110", "--seconds", "0.5", "--fps", "6", "--frames", "0:-1", "--json"]
    assert status("movie", str(stored), "-o", str(out), *options) == 0
    said = json.loads(capsys.readouterr().out)
    assert said == {"movie": str(out), "size": [192, 112], "seconds": 0.5, "fps": 6.0}
    assert out.read_bytes()[4:8] == b"ftyp"


def test_a_run_makes_its_movie(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the result, whether it is stored or not, in the file that was named."""
    made = []
    monkeypatch.setattr(
        film, "movie", lambda dataset, path, progress: made.append((dataset.sizes["time"], path))
    )
    out = str(tmp_path / "a.mp4")
    assert status(*RUN, "--json", "--movie", out) == 0
    assert made == [(5, out)]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["movie"], "nothing is given; give the result of a run, such as snap.zarr."),
        (["movie", "nothing.zarr"], "'nothing.zarr' does not exist; give a folder NAME.zarr"),
        (["movie", "a.zarr", "--size", "big"], "--size is 'big'; give two whole numbers such as 1280x720."),
        (["movie", "a.zarr", "--frames", "5"], "--frames is '5'; give two whole numbers such as 0:80."),
        (["movie", "a.zarr", "--fps", "-1"], "--fps is '-1'; give a number such as 30."),
        (
            ["movie", "a.zarr", "--colour", "heat"],
            "--colour is 'heat'; give one of strain, stress, energy, strands.",
        ),
        (["movie", "a.zarr", "--out", "a.avi"], "'a.avi'; give a name that ends in .mp4 or .gif."),
        ([*RUN, "--movie", "no/where.mp4"], "cannot write 'no/where.mp4'"),
        (["run", "pendulum", "--movie", "a.mp4"], "pendulum has no fibers that move; give --plot in place"),
        (
            ["run", "bend-twist", "--end-distance", "10 mm", "--length", "20 mm", "--movie", "a.mp4"],
            "bend-twist has no fibers that move; give --plot in place of --movie.",
        ),
    ],
)
def test_refusals(arguments: list[str], says: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert status(*arguments) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_what_an_interrupt_leaves(stored: Path, tmp_path: Path) -> None:
    """Nothing: neither the movie nor what was written of it."""
    command = [sys.executable, "-m", "torsade", "movie", str(stored), "--out", str(tmp_path / "snap.mp4")]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        deadline = time.monotonic() + 120.0
        while not any(tmp_path.iterdir()) and time.monotonic() < deadline:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
    assert process.returncode == 130
    assert error == "torsade: interrupted; no movie is written.\n"
    assert not any(tmp_path.iterdir())


def test_ctrl_c_when_the_movie_is_whole_does_not_deny_it(
    stored: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Heard after the last picture, while the file is given its name."""
    check = encode._check

    def then_stopped(part: Path, path: Path, written: int) -> None:
        check(part, path, written)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(encode, "_check", then_stopped)
    out = tmp_path / "snap.mp4"
    options = ["--size", "200x110", "--seconds", "0.5", "--fps", "6"]
    assert status("movie", str(stored), "-o", str(out), *options) == 130
    assert capsys.readouterr().err == f"torsade: interrupted; {str(out)!r} is complete.\n"
    assert out.read_bytes()[4:8] == b"ftyp"
