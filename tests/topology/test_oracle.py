"""Against SnapPy, where it is installed: codes and simplified drawings have the complement of their knot."""

from __future__ import annotations

import random
from typing import Any

import pytest

from topology.drawings import closed_knots, scrambled
from torsade.topology import Diagram, simplify
from torsade.topology.codes import from_braid, from_conway, from_dt, from_gauss, from_pd, to_dt, to_pd

snappy = pytest.importorskip("snappy")

CLOSED = closed_knots()
TORUS_KNOTS = {"3_1", "5_1", "7_1", "8_19", "9_1", "10_124"}
HYPERBOLIC = [name for name in CLOSED if name not in TORUS_KNOTS]

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("default"),
]


def complement(d: Diagram) -> Any:
    return snappy.Link([list(row) for row in to_pd(d, first=0)]).exterior()


def same(one: Diagram, other: Diagram) -> bool:
    a, b = complement(one), complement(other)
    for _ in range(20):
        try:
            return bool(a.is_isometric_to(b))
        except RuntimeError:
            a.randomize()
            b.randomize()
    return False


@pytest.mark.parametrize("name", HYPERBOLIC)
def test_all_codes_are_of_one_knot(name: str) -> None:
    entry = CLOSED[name]
    d = from_pd(entry["pd"])
    assert same(d, from_conway(entry["conway"]))
    assert same(d, from_dt(entry["dt"]))
    assert same(d, from_gauss(entry["gauss"]))
    assert same(d, from_braid(entry["braids"][0]))
    assert same(d, from_dt(to_dt(d)))


@pytest.mark.parametrize("name", HYPERBOLIC[::12])
def test_simplified_drawings_are_of_the_same_knot(name: str) -> None:
    rng = random.Random(name)
    d = from_pd(CLOSED[name]["pd"])
    assert same(d, simplify(scrambled(d, 60, rng)))
