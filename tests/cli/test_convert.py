"""`torsade convert` and files of other formats where curves are read, as from the shell."""

from __future__ import annotations

import json
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import torsade as ts

H = 2e-4


def shell(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "torsade", *arguments], capture_output=True, text=True, cwd=cwd, check=False
    )


def trefoil(noise: float = 0.0, size: float = 1.0) -> ts.Centerline:
    (x,) = ts.topology.braid_curves([1, 1, 1])
    return ts.Centerline((size * (x + noise * np.random.default_rng(0).normal(size=x.shape)),), (True,))


def test_numbers_are_kept_from_format_to_format(tmp_path: Path) -> None:
    knot = ts.knots.bend("reef")
    ts.write_csv(knot, tmp_path / "0.csv")
    names = ["0.csv", "1.xyz", "2.obj", "3.vect", "4.npz", "5.npy", "6.csv"]
    for before, after in pairwise(names):
        done = shell("convert", before, after, cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "6.csv").read_bytes() == (tmp_path / "0.csv").read_bytes()


def test_the_table_says_what_was_read_and_written(tmp_path: Path) -> None:
    ts.write_centerline(trefoil(0.05), tmp_path / "scan.obj")
    arguments = ("--length-unit", "mm", "--smooth", "0.5 mm", "--spacing", "0.25 mm")
    done = shell("convert", "scan.obj", "knot.vect", *arguments, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "read from                 scan.obj\n" in done.stdout
    assert "strands                   1, in mm" in done.stdout
    assert "smoothed over             0.5 mm; the knot is the same" in done.stdout
    assert "closed, " in done.stdout
    assert "read 200 nodes, " in done.stdout
    assert "written to                knot.vect" in done.stdout
    (x,) = ts.read_centerline(tmp_path / "knot.vect").strands
    assert ts.curve.edge_lengths(x, True).max() <= 0.25e-3
    assert str(ts.topology.identify_curves([x])) == "3_1"


def test_json_agrees_with_the_files(tmp_path: Path) -> None:
    given = trefoil(0.05)
    ts.write_centerline(given, tmp_path / "scan.npz")
    done = shell("convert", "scan.npz", "a.vtk", "--smooth", "0.4", "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    found = json.loads(done.stdout)
    assert (found["input"], found["output"], found["smoothed_m"]) == ("scan.npz", "a.vtk", 0.4)
    assert found["read"] == [
        {"nodes": 200, "length_m": ts.curve.length(given.strands[0], True), "closed": True}
    ]
    assert found["written"][0]["nodes"] == 200
    assert found["written"][0]["length_m"] < found["read"][0]["length_m"]
    assert (tmp_path / "a.vtk").stat().st_size > 1000


def test_every_few_nodes(tmp_path: Path) -> None:
    ts.write_centerline(trefoil(), tmp_path / "a.xyz")
    assert shell("convert", "a.xyz", "b.csv", "--every", "4", cwd=tmp_path).returncode == 0
    assert len(ts.read_csv(tmp_path / "b.csv").strands[0]) == 50


def test_an_earlier_file_is_replaced_only_when_asked_to(tmp_path: Path) -> None:
    ts.write_centerline(trefoil(), tmp_path / "a.xyz")
    (tmp_path / "b.csv").write_text("mine")
    done = shell("convert", "a.xyz", "b.csv", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert "'b.csv' exists already; give another name, or --overwrite to replace it" in done.stderr
    assert (tmp_path / "b.csv").read_text() == "mine"
    assert shell("convert", "a.xyz", "b.csv", "--overwrite", cwd=tmp_path).returncode == 0
    assert ts.read_csv(tmp_path / "b.csv").closed == (True,)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((), "convert takes two files; give one to read and one to write"),
        (("a.xyz",), "convert takes two files"),
        (("a.xyz", "b.csv", "c.csv"), "'c.csv' comes after both files"),
        (("none.xyz", "b.csv"), "there is no file 'none.xyz'"),
        (("a.xyz", "b.stl"), "ends in '.stl', which is no format of curves; give one of .csv"),
        (("a.xyz", "b"), "'b' has no suffix"),
        (("a.xyz", "no/such/b.csv"), "cannot write 'no/such/b.csv'"),
        (("a.xyz", "b.csv", "--smooth", "-1 mm"), "the smoothing length is -0.001 m"),
        (("a.xyz", "b.csv", "--smooth", "1 kg"), "is a mass, not a length"),
        (("a.xyz", "b.csv", "--smooth"), "--smooth has no value"),
        (("a.xyz", "b.csv", "--spacing", "6"), "with nodes so far apart strands would pass through"),
        (("a.xyz", "b.csv", "--every", "0"), "every is 0; give a whole number from 1"),
        (("a.xyz", "b.csv", "--every", "-2"), "--every is '-2'; give a whole number"),
        (("a.xyz", "b.csv", "--length-unit", "furlong"), "unknown unit 'furlong'"),
        (("a.xyz", "b.csv", "--smoth", "1"), "did you mean --smooth?"),
        (("--smoth", "1", "a.xyz", "b.csv"), "did you mean --smooth?"),
        (("a.xyz", "b.csv", "--json", "--json", "--smooth", "1", "--smooth", "2"), "more than once"),
    ],
)
def test_refusals(tmp_path: Path, arguments: tuple[str, ...], says: str) -> None:
    ts.write_centerline(trefoil(), tmp_path / "a.xyz")
    done = shell("convert", *arguments, cwd=tmp_path)
    assert done.returncode == 2, done
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    assert done.stderr.count("\n") == 1
    assert says in done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["a.xyz"]


def test_no_command_of_that_name(tmp_path: Path) -> None:
    assert "did you mean 'convert'?" in shell("covert", cwd=tmp_path).stderr


@pytest.mark.parametrize("suffix", [".xyz", ".obj", ".vect", ".npz", ".npy"])
def test_topology_reads_every_format(tmp_path: Path, suffix: str) -> None:
    ts.write_centerline(trefoil(), tmp_path / f"knot{suffix}")
    done = shell("topology", f"knot{suffix}", "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["names"] == ["3_1"]


def test_a_noisy_scan_is_pulled_once_it_is_smoothed(tmp_path: Path) -> None:
    (x,) = ts.knots.strand("overhand", H).strands
    scan = 1e3 * (x + 0.2 * H * np.random.default_rng(0).normal(size=x.shape))
    ts.write_centerline(ts.Centerline((scan,)), tmp_path / "scan.xyz")
    command = ("run", "tighten", "--centerline", "scan.xyz", "--length-unit", "mm", "--radius", "0.2 mm")
    rest = ("--duration", "2 ms", "--frames", "1", "--json")
    rough = shell(*command, *rest, cwd=tmp_path)
    assert rough.returncode == 2
    assert "smooth" in rough.stderr
    done = shell(*command, "--smooth", "0.2 mm", *rest, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["length_m"][0] == pytest.approx(ts.curve.length(x), rel=0.02)
