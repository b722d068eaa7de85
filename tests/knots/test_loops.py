"""Tight loops: those that are shipped are tight, are the knots they are called, and have mirrors."""

from __future__ import annotations

import math

import numpy as np
import pytest

from torsade.curve import edge_lengths, length
from torsade.errors import TorsadeError
from torsade.knots import thickness
from torsade.knots.loops import _shipped, tight_loop
from torsade.knots.loose import listed_ropelength
from torsade.topology.identify import identify_curves
from torsade.topology.table import entries

SHIPPED = [e.name for e in entries() if e.crossings <= 7 and not e.name.startswith("m")]


def test_the_prime_knots_through_seven_crossings_are_shipped() -> None:
    assert sorted(_shipped()) == sorted(SHIPPED)
    assert len(SHIPPED) == 14


@pytest.mark.parametrize("knot", SHIPPED)
def test_shipped_loops_are_tight(knot: str) -> None:
    """Within 0.35 % of the shortest listed; a tube of radius one fits around; names are right."""
    loop = tight_loop(knot)
    assert str(identify_curves([loop.nodes])) == knot
    assert loop.ropelength == pytest.approx(listed_ropelength(knot), rel=3.5e-3)
    assert thickness([loop.nodes]).radius == pytest.approx(1.0, rel=0.02)
    assert not loop.nodes.flags.writeable


def test_a_mirror_image_is_the_reflection() -> None:
    loop, mirror = tight_loop("5_2"), tight_loop("m5_2")
    np.testing.assert_array_equal(mirror.nodes, loop.nodes * [1, 1, -1])
    assert str(identify_curves([mirror.nodes])) == "m5_2"


def test_a_fiber_has_its_length_and_even_nodes() -> None:
    """The unknot is a circle: L/h = 2 pi but for its 64 chords."""
    ring = tight_loop("unknot")
    assert ring.ropelength == pytest.approx(2 * math.pi, rel=1e-3)
    x = ring.fiber(0.01, 40)
    assert x.shape == (40, 3)
    assert length(x, True) == pytest.approx(0.01)
    assert np.ptp(edge_lengths(x, True)) < 1e-4 * 0.01 / 40


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("reef", r"'reef' is a bend, and one closed strand is wanted; give a knot such as 4_1"),
        ("L5a1", r"'L5a1' is a link, and one closed strand is wanted"),
        ("3_9", r"no knot or link is called '3_9'"),
    ],
)
def test_what_is_no_closed_knot_is_refused(name: str, says: str) -> None:
    with pytest.raises(TorsadeError, match=says):
        tight_loop(name)
