"""Inputs that were found to crash, to hang or to be refused in a way nobody can read; they stay mended."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))

from fuzz.samples import FIELDS
from fuzz.targets import TARGETS, tried


def spec(protocol: str, **changed: object) -> bytes:
    return f"{protocol}\n{json.dumps(FIELDS[protocol] | changed)}".encode()


def track(times: object, angles: object) -> bytes:
    """A pendulum's track."""
    rows = [f"{t!r},{a!r},240" for t, a in np.column_stack([times, angles]).tolist()]
    return ("pendulum\ntime_s,angle_deg,length_mm\n" + "\n".join(rows) + "\n").encode()


HEADER = "{'descr': '<f8', 'fortran_order': False, 'shape': (True, 3), }"

FOUND = {
    "powers of powers fill the memory": ("names", b"length\n1 " + b"(" * 12 + b"Tm" + b")^9" * 12),
    "percent of percent of percent": ("names", b"number\n1 " + b"(" * 20 + b"%" + b")^9" * 20),
    "a name of hyphens": ("names", b"strand\n.5r" + b"-" * 100_000),
    "mirrored without end": ("names", b"name\n" + b"mirror " * 700 + b"reef"),
    "mirrored without end, by underscores": ("names", b"name\n" + b"Mirror_" * 700 + b"reef"),
    "cut open without end": ("names", b"strand\n" + b"open " * 900 + b"3_1"),
    "cut open and mirrored without end": ("names", b"name\n" + b"open_mirror-" * 400 + b"3_1"),
    "a sum of very many": ("names", b"name\n" + b"#".join([b"3_1"] * 20_000)),
    "a torus knot of 5000 digits": ("names", b"name\nT(" + b"9" * 5000 + b",2)"),
    "an overhand knot of 5000 digits": ("names", b"name\noverhand-" + b"9" * 5000),
    "zeros of 5000 digits": ("codes", b"code\n[2 " + b"0" * 5000 + b" 3]"),
    "a number of 30 digits of another script": ("codes", ("code\n[2 " + 9 * "٠" + 20 * "٩" + "]").encode()),
    "a number behind zeros": ("codes", b"code\n[2 " + b"0" * 20 + b"7" + b"0" * 30 + b"]"),
    "a crossing of many labels": ("codes", b"code\nX[" + b"A4," * 5000 + b"A5]"),
    "TOML nested without end": ("specs", b"toml\na = " + b"[" * 5000),
    "a unit of a hundred letters that are none": ("names", b"rate\n2 1/m1s" + b"\xff" * 90 + b"s"),
    "mirrored, with letters that are two in lower case": ("names", ("name\nmirror m" + "İ" * 20).encode()),
    "a file beside the design with a name that is too long": (
        "specs",
        b'toml\nprotocol = "tighten"\ncenterline = "' + b"9" * 400 + b'"\n',
    ),
    "a circle between the vertices of a polyhedron": ("codes", b"code\n[8*-2:2 0:.0 0.0.0 0]"),
    "a bend with a thousand hyphens": ("names", b"strand\nreef" + b"-" * 1000),
    "a hundred thousand headings": ("tables", b"trials\nlengths_mm" + b",eg" * 100_000),
    "TOML with a number of 5000 digits": ("specs", b"toml\nseed = " + b"9" * 5000),
    "TOML with a key of 100 000 parts": ("specs", b"toml\n1" + b".2" * 100_000 + b" = 3"),
    "a command of 100 000 words": ("shell", b"torsade\nrun\ntighten\n" + b"--unt10 s\n" * 100_000),
    "a file whose name is longer than a sentence": ("shell", b"torsade\nrun\n--spec\n--sp" + b"(" * 900),
    "a field of many letters": ("specs", spec("tighten", **{"a" * 5000: 1})),
    "a protocol of many letters": ("specs", b'toml\nprotocol = "' + b"x" * 5000 + b'"'),
    "a section of no area": ("specs", spec("prison-escape", radius="1e-170 m")),
    "a section beyond all bounds": ("specs", spec("tighten", radius=1e200)),
    "a stiffness of nothing": ("specs", spec("pendulum", radius="1e-100 m")),
    "a mass beyond all bounds": ("specs", spec("pendulum", mass=1e300, mass_radius=1e10)),
    "a shape of truth values": ("arrays", b"members\n" + json.dumps([["x.npy", HEADER, 96, True]]).encode()),
    "masses beyond all bounds": ("tables", b"buckling\nmass_g,length_mm\n1e308,1e308\n"),
    "masses of nothing": ("tables", b"weights\nmass_g,length_mm\n1e-300,1e308\n"),
    "samples of no length": ("tables", b"buckling\nmass_g,length_mm\n1e308,1e-300\n"),
    "samples as long as no number": ("tables", b"buckling\nmass_g,length_mm\n1e155,1e77\n"),
    "a curvature beyond all bounds": ("tables", b"trials\npieces,limit_curvature_per_m\n3,1e155\n"),
    "a pendulum in nanoseconds": ("tables", track(np.linspace(0, 2e-9, 40), (-1.0) ** np.arange(40))),
    "a pendulum of very many points": (
        "tables",
        track(np.linspace(0, 9, 21_000), np.sin(np.arange(21_000.0))),
    ),
    "a pendulum over ages": ("tables", track(np.cumsum(np.exp(np.arange(40.0))), np.arange(40.0) % 2)),
    "a command of many letters": ("shell", b"torsade\n" + b"x" * 5000),
    "an option of many letters": ("shell", b"torsade\nrun\ntighten\n--" + b"x" * 5000 + b"=1"),
    "an option that cannot be shown": ("shell", b"torsade\nrun\n--\x0ewist\n1"),
    "an option that steers the terminal": ("shell", b"torsade\ntopology\nreef\n--\x1b[31mred"),
    "a folder whose name is too long": ("shell", b"torsade\nfigure\n4-5\n--out\n" + b"x" * 5000),
    "a file whose name is too long": ("shell", b"torsade\nconvert\na.xyz\n" + b"x" * 5000 + b".csv"),
    "a demo in a folder of many letters": ("shell", b"torsade\ndemo\n--out\n" + b"[" * 1000),
    "a movie of a folder without a name": ("shell", b"torsade\nmovie\n."),
    "a file whose name is no text": ("shell", b"torsade\nconvert\na.xyz\nb\xff.csv"),
}
"""By what is wrong: what is fuzzed, and the input as `fuzz.targets.tried` takes it."""


@pytest.mark.parametrize("wrong", FOUND)
def test_what_was_found_is_mended(tmp_path: Path, wrong: str) -> None:
    target, data = FOUND[wrong]
    tried(TARGETS[target], data, tmp_path)
