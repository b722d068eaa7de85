"""Bad input from the real shell: exit code 2, one sentence on the error stream, no traceback."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import torsade as ts

H = 2e-4


def shell(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "torsade", *arguments], capture_output=True, text=True, cwd=cwd, check=False
    )


def refusal(*arguments: str, cwd: Path | None = None) -> str:
    """The sentence after "torsade: " of a command that must be refused."""
    done = shell(*arguments, cwd=cwd)
    assert done.returncode == 2, done
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("torsade: ")
    assert ". " not in done.stderr.strip()
    return done.stderr.removeprefix("torsade: ").strip()


BEND = ("run", "prison-escape")
SUTURE = ("run", "suture")
BATTERY = ("run", "battery", "--knot")
MOVE = ("run", "reidemeister", "--move")
ARCH = ("run", "bend-twist")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((*BEND, "--knot", "reef", "--force", "-15 N"), "give a force above 0 N"),
        ((*BEND, "--knot", "reef", "--force", "15 kg"), "is a mass, not a force"),
        ((*BEND, "--knot", "reef", "--duration", "1 sek"), "unknown unit 'sek'"),
        ((*BEND, "--knot", "reef", "--force", "nan"), "not a finite number"),
        ((*BEND, "--knot", "reef", "--force", "15", "N"), 'did you mean --force "15 N"?'),
        ((*BEND, "--knot", "reef", "--preset", "publishd"), "did you mean 'published'?"),
        ((*BEND, "reef"), "did you mean --knot reef?"),
        ((*SUTURE, "5,-3"), "did you mean --throws '5,-3'?"),
        ((*SUTURE, "--throws", "0"), "'0' is not two numbers; give half turns such as 5,-3"),
        ((*SUTURE, "--throws", "3,,"), "is not two numbers"),
        ((*SUTURE, "--throws", "2.5"), "is not two numbers"),
        ((*SUTURE, "--throws", "99,99"), "give 15 at most"),
        ((*SUTURE, "--throws", "5", "-3"), "did you mean --throws 5,-3?"),
        ((*SUTURE, "--throws", "5,", "-3"), "did you mean --throws 5,-3?"),
        ((*SUTURE, "--throws", "5 -3"), "give half turns such as 5,-3, with a comma"),
        ((*SUTURE, "--throws", "5,-3", "--angle", "30"), "at most 1.571 rad (90 deg)"),
        ((*BATTERY, "31"), "nothing is called '31'; did you mean '3_1'?"),
        ((*BATTERY, "5.2"), "did you mean '5_2'?"),
        ((*BATTERY, "5_2m"), "did you mean 'm5_2'?"),
        ((*BATTERY, "4 6 2"), "is a list of numbers; say which code it is"),
        ((*BATTERY, "K11n34"), "known are the prime knots through 10 crossings"),
        ((*BATTERY, "3_1", "--radius", "2", "mm"), 'did you mean --radius "2 mm"?'),
        ((*BATTERY, "3_1", "--radius", "2", "3"), "'3' belongs to no option"),
        ((*SUTURE,), "throws is missing; give a pair of odd numbers"),
        ((*SUTURE, "--throws", "3,-3", "--skin-stiffness", "-3 N/m"), "give a stiffness above 0 N/m"),
        ((*SUTURE, "--throws", "3,-3", "--out", "no/such/wound.zarr"), "there is no folder"),
        (("run", "pendulum", "270"), "'270' belongs to no option"),
        ((*MOVE[:2], "R2"), "did you mean --move R2?"),
        ((*BEND, "--knot", "reef", "--rho", "1"), "has no inertia"),
        ((*BEND, "--knot", "reff"), "did you mean 'reef'?"),
        (
            ("run", "--knot", "reef"),
            "--knot comes without a protocol; begin with torsade run",
        ),
        (("run", "--knot=reef"), "--knot comes without a protocol; begin"),
        (("run", "--json", "--spec"), "--spec has no value"),
        (("run", "--json", "--spec", "none.toml"), "there is no file 'none.toml'"),
        ((*BEND, "--knot", "reef", "--diameter", "1 mm"), "give --radius, half of it"),
        ((*BEND, "--knot", "reef", "--length", "1 m"), "a built-in knot takes --lead"),
        ((*BEND, "--knot", "reef", "--frames", "9" * 5000), "more digits"),
        ((*BEND, "--knot", "reef", "--materail", "nylon"), "did you mean --material?"),
        ((*BEND, "--knot", "reef", "--force"), "--force has no value"),
        (
            (*BEND, "--knot", "reef", "--direction", "-x"),
            "drives the pulled end B1 towards the clamped end A1",
        ),
        ((*BEND, "--knot", "reef", "--out", "reef"), "give a name that ends in .zarr"),
        ((*BEND, "--knot", "reef", "--out", "no/such/reef.zarr"), "there is no folder"),
        ((*BEND, "--knot", "reef", "--out", ""), "the output is called ''"),
        ((*BEND, "--knot", "reef", "--out", "."), "give a name that ends in .zarr"),
        ((*BEND, "--knot", "reef", "--out", "/", "--resume"), "give a name that ends in .zarr"),
        (("demo", "--out", ""), "--out is empty"),
        ((*BEND, "--knot", "reef", "--resume"), "(--out NAME.zarr)"),
        ((*BEND, "--centerline", "none.csv"), "there is no file 'none.csv'"),
        ((*BEND, "--spec", "none.toml"), "there is no file 'none.toml'"),
        (BEND, "nothing to pull is given"),
        (ARCH, "end_distance is missing; give a distance"),
        ((*ARCH, "--end-distance", "30 cm"), "more than the fiber's length, 0.24 m"),
        ((*ARCH, "--end-distance", "24 cm"), "give a distance from 0 to less than its length"),
        ((*ARCH, "--end-distance", "-1 cm"), "give a length of at least 0 m"),
        ((*ARCH, "--end-distance", "19 cm", "--twist", "1e6 deg"), "there it snaps at"),
        ((*ARCH, "--end-distance", "19 cm", "--twist", "270 dge"), "unknown unit 'dge'"),
        ((*ARCH, "--end-distance", "19 cm", "--force", "1 N"), "give --end-distance"),
        (("run", "prison"), "did you mean 'prison-escape'?"),
        (("run", "tighten", "--knot", "trefoil"), "'trefoil' is a closed knot, and one strand"),
        (("run", "tighten", "--knot", "reef"), "give torsade run prison-escape --knot reef"),
        ((*BEND, "--knot", "overhand"), "give torsade run tighten --knot overhand"),
        (("run", "reef.toml"), "give a file with --spec reef.toml"),
        (("run", "reidemeister"), "move is missing; give a Reidemeister move to make: R1 (a loop)"),
        ((*MOVE, "R4"), "move is 'R4'; choose one of R1, R2, R3"),
        ((*MOVE, "R1", "--force", "1 N"), "there is no option --force; leave it out"),
        ((*MOVE, "R1", "--length", "1 mm"), "give a length of at least 40 radii, 8 mm"),
        (("run", "tighten", "--knot", "overhand", "--until-still", "1 um"), "is a length, not a velocity"),
        (("tighten",), "give torsade run tighten"),
        (("dmeo",), "did you mean 'demo'?"),
        (("plot", "reef.zarr"), "did you mean 'open'?"),
        ((*SUTURE, "--throws", "5,-3", "--skin", "soft"), "--skin-radius or --skin-stiffness or"),
        (("--hlep",), "did you mean '--help'?"),
        (("demo", "--force", "3"), "demo has no option --force"),
    ],
)
def test_options(tmp_path: Path, arguments: Sequence[str], says: str) -> None:
    assert says in refusal(*arguments, cwd=tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("option", "file", "says"),
    [
        ("--plot", "no/such/reef.png", "cannot write 'no/such/reef.png'"),
        ("--plot", "reef.jpg", "ends in .png or .pdf or .svg"),
        ("--picture", "reef.pdf", "ends in .png"),
        ("--picture", ".", "ends in .png"),
    ],
)
def test_pictures_are_refused_before_the_run(tmp_path: Path, option: str, file: str, says: str) -> None:
    pytest.importorskip("pyvista" if option == "--picture" else "matplotlib")
    assert says in refusal(*BEND, "--knot", "reef", option, file, cwd=tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_picture_and_a_plot_need_two_files(tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    same = ("--picture", "reef.png", "--plot", "./reef.png")
    assert "give each a file of its own" in refusal(*BEND, "--knot", "reef", *same, cwd=tmp_path)


def test_the_demo_replaces_nothing_of_others(tmp_path: Path) -> None:
    (tmp_path / "reef.png").write_text("mine")
    assert "'reef.png' exists and may not be the demo's" in refusal("demo", "--out", ".", cwd=tmp_path)
    done = shell(*BEND, "--knot", "reef", "--duration", "1 ms", "--out", "reef.zarr", cwd=tmp_path)
    assert done.returncode == 0
    assert "'reef.zarr' is the result of another run" in refusal("demo", "--out", ".", cwd=tmp_path)
    assert (tmp_path / "reef.png").read_text() == "mine"


def hooked() -> list[np.ndarray]:
    """Two straight strands side by side, a diameter and a half apart."""
    x = np.outer(np.arange(40) * H, [1.0, 0.0, 0.0])
    return [x, x + np.array([0.0, 3 * H, 0.0])]


def bad_nan(strands: list[np.ndarray]) -> list[np.ndarray]:
    strands[1][7, 2] = np.nan
    return strands


def bad_repeat(strands: list[np.ndarray]) -> list[np.ndarray]:
    strands[0] = np.insert(strands[0], 5, strands[0][5], axis=0)
    return strands


def bad_single(strands: list[np.ndarray]) -> list[np.ndarray]:
    return [strands[0], strands[1][:1]]


def bad_overlap(strands: list[np.ndarray]) -> list[np.ndarray]:
    return [strands[0], strands[0] + np.array([0.0, 0.2 * H, 0.0])]


def bad_apart(strands: list[np.ndarray]) -> list[np.ndarray]:
    return [strands[0], strands[1] + np.array([1.0, 0.0, 0.0])]


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (bad_nan, "give a finite number"),
        (bad_repeat, "are the same point"),
        (bad_single, "has only one node; give at least 2"),
        (bad_overlap, "strands 0 and 1 interpenetrate"),
        (bad_apart, "never meets strand A"),
    ],
)
def test_centerlines(tmp_path: Path, spoil: object, says: str) -> None:
    assert callable(spoil)
    ts.write_csv(ts.Centerline(tuple(spoil(hooked()))), tmp_path / "bad.csv")
    assert says in refusal(*BEND, "--centerline", "bad.csv", cwd=tmp_path)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('protocol = "prison-escape"\nknot = "reef"\nforec = "1 N"\n', "did you mean 'force'?"),
        ('protocol = "prison-escape"\nknot = "reef"\nforce = "1 m"\n', "is a length, not a force"),
        ('protocol = "tighten"\ncenterline = "a.csv"\n', "is a specification of tighten"),
        ("protocol = prison-escape\n", "is not TOML"),
    ],
)
def test_specification_files(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "bad.toml").write_text(text)
    assert says in refusal(*BEND, "--spec", "bad.toml", cwd=tmp_path)


def test_an_earlier_result_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "mine.zarr").write_text("something else")
    assert "is not a result of torsade" in refusal(
        *BEND, "--knot", "reef", "--out", "mine.zarr", cwd=tmp_path
    )
    assert (tmp_path / "mine.zarr").read_text() == "something else"


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="needs a folder that even root cannot write")
def test_a_folder_that_cannot_be_written() -> None:
    assert "cannot write '/proc/reef.zarr'" in refusal(*BEND, "--knot", "reef", "--out", "/proc/reef.zarr")


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root can write anywhere")
def test_a_read_only_folder(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    assert "permission denied" in refusal(*BEND, "--knot", "reef", "--out", str(tmp_path / "reef.zarr"))
