"""Fibers by name: which knot they are, how they lie, and which ends they are pulled by."""

from __future__ import annotations

import math

import numpy as np
import pytest

import torsade as ts
from torsade.knots import bend, strand, tie
from torsade.topology import identify_open, identify_strands, project, state

H = 2e-4


@pytest.mark.parametrize(
    ("name", "pulled"),
    [
        ("Reef knot", "A1B1"),
        ("thief", "A1B0"),
        ("what-knot", "A1B0"),
        ("weaver", "A1B1"),
        ("bowline13", "A0B0"),
    ],
)
def test_a_name_says_what_is_pulled(name: str, pulled: str) -> None:
    assert bend(name).pulled == pulled
    assert bend(name, pulled="a0b0").pulled == "A0B0"


def test_pulls_set_signs() -> None:
    """Pulled by A1 and B0 one strand runs the other way: signs between the two change."""
    reef, thief = (state(bend("reef", pulled=ends)) for ends in ("A1B1", "A1B0"))
    assert sum(reef.charges) == sum(thief.charges) == 0
    granny, grief = (state(bend("granny", pulled=ends)) for ends in ("A1B1", "A1B0"))
    assert sum(granny.charges) == -sum(grief.charges) == 6


@pytest.mark.parametrize("name", ["reef", "carrick", "5,-3", "mirror granny", "alpine23", "X[B0,A1,B1,A0]"])
def test_two_strands_by_name_or_code(name: str) -> None:
    knot = bend(name)
    assert knot.closed == (False, False)
    assert knot.clearance >= 2.1 * knot.radius * (1 - 1e-9)
    assert knot.h_kappa <= 0.5 + 1e-9
    (clamped, pulled) = (knot.strands["AB".index(e[0])][-int(e[1])] for e in ("A1", "B1"))
    assert clamped is not None
    assert pulled is not None


@pytest.mark.parametrize("spacing", [0.25, 0.5, 1.0])
def test_the_overhand_is_a_trefoil_with_its_ends_on_one_line(spacing: float) -> None:
    (x,) = strand("overhand", H, spacing=spacing * H).strands
    l = np.linalg.norm(np.diff(x, axis=0), axis=1)
    assert l.max() <= spacing * H * (1 + 1e-9)
    assert np.ptp(l) < 2e-2 * l.mean()
    np.testing.assert_allclose(x[[0, 1, -2, -1], 1:], 0.0, atol=1e-9)
    assert x[0, 0] < x[1, 0] < 0 < x[-2, 0] < x[-1, 0]
    assert identify_open(x, 40).fractions["3_1"] > 0.9


@pytest.mark.parametrize(
    ("name", "knot"),
    [("figure-eight", "4_1"), ("overhand-7", "7_1"), ("stevedore", "6_1"), ("open m5_2", "m5_2")],
)
def test_knots_in_one_strand(name: str, knot: str) -> None:
    shape = strand(name, H)
    (one,) = identify_strands(project(shape.strands, shape.closed).diagram)
    assert one.names == (knot,)
    assert shape.strands[0][-1, 0] - shape.strands[0][0, 0] > 52 * H


@pytest.mark.parametrize("name", ["3_1", "m5_2#3_1", "L5a1", "T(3,4)", "unknot", "{1,-2,1,-2}"])
def test_closed_knots_and_links(name: str) -> None:
    knot = tie(name, "1 mm", length=None)
    assert all(knot.closed)
    assert knot.clearance >= 2.1e-3 * (1 - 1e-9)


def test_sizes_scale_with_the_radius() -> None:
    for one, two in (
        (bend("reef", "0.4 mm"), bend("reef", "0.2 mm")),
        (strand("overhand", 2.0), strand("overhand", 1.0)),
    ):
        np.testing.assert_allclose(one.strands[0], 2 * two.strands[0], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("make", "arguments", "says"),
    [
        (bend, {"name": "zepelin"}, "did you mean 'zeppelin'"),
        (
            bend,
            {"name": "reef", "pulled": "A1A0"},
            "one of each of two open strands|one each of two open strands|clamped",
        ),
        (bend, {"name": "reef", "lead": "0.1 mm"}, "lead is 0.0001 m; give 0.001 to 2 m"),
        (bend, {"name": "reef", "radius": "1 kg"}, "radius '1 kg' is a mass, not a length"),
        (
            bend,
            {"name": "overhand"},
            "'overhand' is a knot in one strand, and a bend has two .* --knot overhand",
        ),
        (bend, {"name": "3_1"}, "'3_1' is a closed knot, and a bend has two strands with ends"),
        (
            strand,
            {"name": "reef"},
            "'reef' is a bend, and one strand .* prison-escape --knot reef",
        ),
        (strand, {"name": "5_2"}, "give 'open 5_2' for it cut open"),
        (strand, {"name": "overhand", "radius": -1.0}, "radius is -1 m"),
        (strand, {"name": "overhand", "spacing": 1.0}, "spacing is 1 m"),
        (tie, {"name": "3_1", "lead": 1.0}, "a lead is given, but all strands are closed"),
    ],
)
def test_refusals(make: object, arguments: dict[str, object], says: str) -> None:
    with pytest.raises(ts.TorsadeError, match=says) as caught:
        make(**arguments)  # type: ignore[operator]
    assert "\n" not in str(caught.value)


def test_the_overhand_is_tightened() -> None:
    result = ts.protocols.Tighten(knot="overhand", duration="0.1 s", frames=4).run()
    report = ts.protocols.Tighten.report(result)
    assert result.dataset.attrs["knot"] == "overhand"
    assert np.all(np.diff(report["end_to_end_m"]) > 0)
    assert math.isfinite(report["h_kappa_max"][-1])
    assert report["h_kappa_max"][-1] > 0.2
