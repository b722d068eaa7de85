"""Specifications: units, defaults, refusals in one sentence, and TOML files."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import torsade as ts
from torsade.motion.overdamped import PUBLISHED, STANDARD
from torsade.protocols import PrisonEscape, Tighten, load_spec
from torsade.protocols.files import merged


def test_defaults_are_the_thesis_s() -> None:
    bend = PrisonEscape(knot="reef")
    assert (bend.force, bend.duration, bend.frames, bend.material, bend.h) == (15.0, 1.0, 100, "nylon", 2e-4)
    knot = Tighten(centerline="trefoil.csv")
    assert (knot.force, knot.duration, knot.material) == (0.02, 1.0, "optomechanical")
    assert bend.laws == STANDARD
    assert bend.stepping.fixed_step == 0


def test_units_become_si() -> None:
    spec = PrisonEscape(knot="reef", force="1 kgf", duration="20 ms", radius="0.3 mm", E_b="200 MPa")
    assert spec.force == 9.80665
    assert spec.duration == 0.02
    assert (spec.h, spec.fiber_material.E_b) == (3e-4, 2e8)


def test_the_published_preset_and_what_overrides_it() -> None:
    spec = PrisonEscape(knot="reef", preset="published")
    assert spec.laws == PUBLISHED
    assert spec.stepping.fixed_step == 1e-4
    assert spec.node_spacing == pytest.approx(1.38e-4)
    assert PrisonEscape(centerline="a.csv", preset="published").node_spacing is None
    spec = PrisonEscape(knot="reef", preset="published", drag="continuum", eta_f_ratio=3.3, tolerance=1e-4)
    assert (spec.laws.drag, spec.laws.eta_f_ratio, spec.laws.area) == ("continuum", 3.3, "projected")
    assert (spec.stepping.fixed_step, spec.stepping.tolerance) == (0.0, 1e-4)


def test_a_specification_is_frozen_and_survives_json() -> None:
    spec = PrisonEscape(knot="reef", force="10 N")
    with pytest.raises(ValueError, match="frozen"):
        spec.force = 3.0  # type: ignore[misc]
    assert PrisonEscape.model_validate_json(spec.model_dump_json()) == spec


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"knot": "reef", "force": -15}, "force is -15; give a force above 0 N"),
        ({"knot": "reef", "force": "15 kg"}, "force '15 kg' is a mass, not a force"),
        ({"knot": "reef", "force": math.nan}, "force nan is not a finite number"),
        ({"knot": "reef", "force": [1]}, "force [1] is not a number"),
        (
            {"knot": "reef", "preset": "publishd"},
            "did you mean 'published'? choose one of standard, published",
        ),
        ({"knot": "reef", "frames": 0}, "frames is 0; give a number of at least 1"),
        ({"knot": "reef", "frames": True}, "frames is True; give a whole number"),
        (
            {"knot": "reef", "frames": 10**400},
            "frames is a whole number of 401 digits; give a number of at",
        ),
        (
            {"knot": "reef", "frames": 10**5000},
            "frames is a whole number of 5001 digits; give a number",
        ),
        ({"knot": "reef", "exclusion_edges": 10**9}, "give a number of at most 1000000"),
        ({"knot": "reef", "force": True}, "force True is not a number"),
        ({"knot": "reef", "force": 10**400}, "force a whole number of 401 digits is not a finite number"),
        ({"knot": "sqare knot"}, "nothing is called 'sqare knot'; did you mean 'square knot'?"),
        (
            {"knot": "3_1"},
            "'3_1' is a closed knot, and a bend has two strands with ends; choose",
        ),
        ({"knot": "reef", "diameter": "1 mm"}, "give 'radius', half of it"),
        ({"knot": "reef", "length": "1 m"}, "a built-in knot takes 'lead'"),
        ({"knot": "reef", "frames": 1.5}, "frames is 1.5; give a whole number"),
        ({"knot": "reef", "material": "nilon"}, "did you mean 'nylon'?"),
        ({"knot": "reef", "nu": 0.5}, "nu is 0.5; give a number below 0.5"),
        ({"knot": "reef", "forc": 1}, "no field 'forc'; did you mean 'force'?"),
        ({"knot": "reef", "zzz": 1}, "choose among"),
        ({"knot": "reef", "pulled": "A1A0"}, "not one end of each strand"),
        ({"knot": "reef", "direction": "w"}, "choose one of x, -x, y, -y, z, -z, line"),
        ({"knot": "reef", "centerline": "a.csv"}, "are both given; give one of them"),
        ({"knot": "reef", "smooth": "0.1 mm"}, "a built-in knot needs no smoothing; leave smooth out"),
        ({"centerline": "a.csv", "smooth": "-1 mm"}, "smooth is '-1 mm'; give a length of at least 0"),
        ({"knot": "reef", "tolerance": 1e-3, "fixed_step": 1e-4}, "are both given"),
        ({}, "nothing to pull is given"),
        (
            {"knot": "reef", "material": "silicone"},
            "a force of 15 N would stretch this fiber by F/EA = 2.39, and the model holds for 0.5 at most; "
            "give a force of at most 3.14 N, or another material, E or radius",
        ),
    ],
)
def test_bad_fields_are_refused_in_one_sentence(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(ts.TorsadeError) as caught:
        PrisonEscape(**fields)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_tighten_says_what_it_does_not_have() -> None:
    with pytest.raises(ts.TorsadeError, match=r"'trefoil' is a closed knot, .*; give 'open 3_1'"):
        Tighten(knot="trefoil")
    with pytest.raises(ts.TorsadeError, match='nothing to pull is given; give a knot such as "overhand", or'):
        Tighten()
    with pytest.raises(ts.TorsadeError, match="length_unit 'mm' belongs to a centerline"):
        Tighten(knot="overhand", length_unit="mm")
    with pytest.raises(ts.TorsadeError, match="length_unit 'kg' is no unit of length"):
        Tighten(centerline="a.csv", length_unit="kg")


# --- what a specification makes


@pytest.mark.parametrize("suffix", [".csv", ".xyz", ".obj", ".vect", ".npz", ".npy"])
def test_a_centerline_in_any_format(tmp_path: Path, suffix: str) -> None:
    built = PrisonEscape(knot="reef").configuration()
    if suffix == ".npy":  # holds strands of one length
        built = ts.Centerline(tuple(ts.curve.resample(x, n=200) for x in built.strands))
    ts.write_centerline(built, tmp_path / f"reef{suffix}")
    read = PrisonEscape(centerline=str(tmp_path / f"reef{suffix}"), preset="published").configuration()
    for a, b in zip(built.strands, read.strands, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_noisy_centerline_is_smoothed_as_asked_or_not_at_all(tmp_path: Path) -> None:
    path = str(tmp_path / "scan.csv")
    built = PrisonEscape(knot="reef").configuration()
    rng = np.random.default_rng(0)
    ts.write_csv(ts.Centerline(tuple(x + 4e-5 * rng.normal(size=x.shape) for x in built.strands)), path)
    with pytest.raises(ts.TorsadeError):
        PrisonEscape(centerline=path).configuration()
    spec = PrisonEscape(centerline=path, smooth="0.2 mm")
    smooth = spec.configuration()
    assert max(np.linalg.norm(np.diff(x, axis=0), axis=1).max() for x in smooth.strands) <= 0.5 * spec.h
    assert spec.stored()["smooth"] == 2e-4
    with pytest.raises(ts.TorsadeError, match=r'may pull strands through each other; give smooth = "'):
        PrisonEscape(centerline=path, smooth="1.6 mm").configuration()


def test_strands_are_resampled_unless_published(bends: Path) -> None:
    given = len(ts.read_csv(bends / "reef.csv").strands[0])
    spec = PrisonEscape(centerline=str(bends / "reef.csv"))
    x = spec.configuration().strands[0]
    assert np.linalg.norm(np.diff(x, axis=0), axis=1).max() <= 0.5 * spec.h * (1 + 1e-9)
    published = spec.model_copy(update={"preset": "published"})
    assert len(published.configuration().strands[0]) == given


@pytest.mark.parametrize(
    ("protocol", "file", "says"),
    [
        (PrisonEscape, "trefoil.csv", "has 1 strand, and prison-escape pulls two strands; tighten takes one"),
        (Tighten, "reef.csv", "has 2 strands, and tighten pulls one strand by both its ends"),
    ],
)
def test_the_wrong_number_of_strands(bends: Path, protocol: type[Any], file: str, says: str) -> None:
    with pytest.raises(ts.TorsadeError, match=says):
        protocol(centerline=str(bends / file)).run()


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"lead": "2 m", "spacing": "0.02 mm"}, "more than the 100000 that a run can move"),
        ({"frames": 1_000_000}, r"1000001 frames of \d+ nodes take [\d.]+ GB; give at most \d+ frames"),
    ],
)
def test_runs_that_memory_cannot_hold(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(ts.TorsadeError, match=says):
        PrisonEscape(knot="reef", **fields).run()


def test_a_spacing_far_below_the_radius_is_refused_before_memory_is_taken(tmp_path: Path) -> None:
    ts.write_csv(PrisonEscape(knot="reef").configuration(), tmp_path / "reef.csv")
    with pytest.raises(ts.TorsadeError, match="more than the 100000"):
        PrisonEscape(centerline=str(tmp_path / "reef.csv"), spacing="1 nm").run()


def test_strands_that_never_meet_are_refused(tmp_path: Path) -> None:
    x = np.outer(np.linspace(0, 1e-2, 60), [1.0, 0, 0])
    shape = ts.Centerline((x, x + np.array([2e-2, 3e-3, 0])))
    ts.write_csv(shape, tmp_path / "apart.csv")
    with pytest.raises(
        ts.TorsadeError, match="strand B pulled along x never meets strand A; give two strands"
    ):
        PrisonEscape(centerline=str(tmp_path / "apart.csv")).run()


def test_specifications_import_nothing_heavy() -> None:
    script = (
        "import sys, torsade.protocols; print([m for m in ('numba', 'xarray', 'zarr') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


# --- TOML


def test_a_file_with_units(tmp_path: Path) -> None:
    path = tmp_path / "reef.toml"
    path.write_text('protocol = "prison-escape"\nknot = "reef"\nforce = "12 N"\nduration = "50 ms"\n')
    spec = load_spec(path)
    assert isinstance(spec, PrisonEscape)
    assert (spec.force, spec.duration) == (12.0, 0.05)


def test_a_centerline_is_looked_for_beside_the_file(tmp_path: Path) -> None:
    (tmp_path / "mine.csv").write_text("strand,x,y,z\n")
    (tmp_path / "mine.toml").write_text('protocol = "tighten"\ncenterline = "mine.csv"\n')
    spec = load_spec(tmp_path / "mine.toml")
    assert isinstance(spec, Tighten)
    assert spec.centerline == str(tmp_path / "mine.csv")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('protocol = "prison-escape"\nknot = "reef"\nduratoin = "1 s"\n', "did you mean 'duration'?"),
        ('protocol = "prison-escap"\n', "did you mean 'prison-escape'?"),
        ('knot = "reef"\n', "names no protocol; add a line"),
        ("protocol = prison-escape\n", "is not TOML"),
    ],
)
def test_files_that_cannot_be_read(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text)
    with pytest.raises(ts.TorsadeError) as caught:
        load_spec(path)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_named() -> None:
    with pytest.raises(ts.TorsadeError, match=r"there is no file 'none.toml'"):
        load_spec("none.toml")


def test_what_is_given_replaces_what_it_excludes() -> None:
    fields = {"knot": "reef", "lead": "5 mm", "fixed_step": 1e-4, "force": 3}
    assert merged(fields, {"centerline": "a.csv", "tolerance": "1e-3"}) == {
        "force": 3,
        "centerline": "a.csv",
        "tolerance": "1e-3",
    }


def test_tails_are_as_long_as_asked_for() -> None:
    usual, longer = (PrisonEscape(knot="reef", tail=tail).configuration() for tail in (None, "7 mm"))
    for a, b in zip(usual.strands, longer.strands, strict=True):
        more = ts.curve.length(b) - ts.curve.length(a)
        assert more == pytest.approx(7e-3 - 25 * 0.2e-3, rel=1e-3)  # edges are chords
    with pytest.raises(ts.TorsadeError, match="a centerline has the tails that it has; leave tail out"):
        PrisonEscape(centerline="mine.csv", tail="7 mm")
