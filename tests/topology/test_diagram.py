"""Diagrams: counts, faces, signs and orientations of drawings that can be done by hand."""

from __future__ import annotations

import random

import numpy as np
import pytest

from topology.drawings import random_move, scrambled
from topology.invariants import colourings
from torsade.errors import TorsadeError
from torsade.topology import Diagram, is_isomorphic
from torsade.topology.codes import from_braid, from_gauss, from_pd, to_gauss
from torsade.topology.diagram import CIRCLE
from torsade.topology.tangle import integer, rational

TREFOIL = from_pd([(1, 5, 2, 4), (3, 1, 4, 6), (5, 3, 6, 2)])
FIGURE_EIGHT = from_pd([(4, 2, 5, 1), (8, 6, 1, 5), (6, 3, 7, 4), (2, 7, 3, 8)])
HOPF = from_gauss("O1+ U2+ | U1+ O2+")
WHITEHEAD = from_braid([1, -2, 1, -2, -2])
BORROMEAN = from_braid([1, -2] * 3)
REEF = from_gauss("O1+ U2+ O3+ O4- U5- O6- | U3+ O2+ U1+ U6- O5- U4-", closed=False)
ALL = [TREFOIL, FIGURE_EIGHT, HOPF, WHITEHEAD, BORROMEAN, REEF, rational(3, 2, 1), TREFOIL | HOPF]


def test_the_right_handed_trefoil() -> None:
    assert TREFOIL.signs == (1, 1, 1)
    assert sorted(map(len, TREFOIL.faces)) == [2, 2, 2, 3, 3]
    assert sorted(map(len, TREFOIL.seifert_circles)) == [3, 3]
    assert [TREFOIL.edge_name(e) for e in range(6)] == ["A0", "A1", "A2", "A3", "A4", "A5"]
    assert TREFOIL.is_alternating
    assert TREFOIL.is_connected


def test_links_count_half_the_signs_between_strands() -> None:
    """Hopf ±1, Whitehead 0 with writhe ∓1, Borromean rings 0: the errata to chapter 4 of the thesis."""
    np.testing.assert_array_equal(HOPF.linking, [[0, 1], [1, 0]])
    np.testing.assert_array_equal(HOPF.reverse([1]).linking, [[0, -1], [-1, 0]])
    assert HOPF.writhe == 2
    assert (WHITEHEAD.linking[0, 1], WHITEHEAD.writhe) == (0, -1)
    assert not BORROMEAN.linking.any()
    assert BORROMEAN.n_strands == 3


def test_half_linking_of_open_strands() -> None:
    assert integer(1).linking[0, 1] == 0.5
    assert integer(1).pulled("A1B0").linking[0, 1] == -0.5


def test_the_reef_is_a_tangle_with_its_ends_around_it() -> None:
    assert REEF.ends == ("A0", "B0", "B1", "A1")
    assert [REEF.edge_name(e) for e in range(14)] == [f"A{k}" for k in range(7)] + [f"B{k}" for k in range(7)]
    bounded = [f for f in range(len(REEF.faces)) if REEF.is_bounded(f)]
    assert sorted((len(REEF.faces[f]), REEF.circulation(f)) for f in bounded) == [
        (2, -2), (2, -2), (2, 2), (2, 2), (6, 0),
    ]  # fmt: skip
    assert len(REEF.outer_faces) == 4
    assert [REEF.pulled(p).writhe for p in ("A1B1", "A1B0", "A0B0")] == [0, 0, 0]
    assert [len(REEF.pulled(p).seifert_circles) for p in ("A1B1", "A1B0", "A0B0")] == [4, 1, 4]
    assert len(REEF.seifert_arcs) == 2


@pytest.mark.parametrize("pulled", ["A1B1", "A1B0", "A0B1", "A0B0"])
def test_strands_run_towards_their_pulled_ends(pulled: str) -> None:
    d = REEF.pulled(pulled)
    last = [d.ends[d.mate[s[-1] ^ 2]] for s in d.strands]
    assert last == [pulled[:2], pulled[2:]]
    assert d.ends == REEF.ends
    assert is_isomorphic(d.pulled("A1B1"), REEF)
    assert d.pulled(["A1", "B1"]) == d.pulled("B1A1")


@pytest.mark.parametrize("pulled", ["A1", "A1A0", "A1B1B0", "A1C1", "", "A1B1C1"])
def test_one_end_of_each_open_strand_is_pulled(pulled: str) -> None:
    with pytest.raises(TorsadeError, match="give one of each open strand, A0 or A1 and B0 or B1"):
        REEF.pulled(pulled)


def test_refusals_are_one_sentence() -> None:
    with pytest.raises(TorsadeError, match="all are closed"):
        TREFOIL.pulled("A1")
    with pytest.raises(TorsadeError, match=r"strands \[3\] are to be reversed; give numbers from 0 to 0"):
        TREFOIL.reverse([3])
    with pytest.raises(TorsadeError, match="4 ends are named"):
        REEF.renamed(["a", "b", "c", "c"])


@pytest.mark.parametrize("d", ALL, ids=to_gauss)
def test_every_edge_has_two_sides(d: Diagram) -> None:
    darts = sorted(p for face in d.faces for p in face)
    assert darts == list(d.ports)
    assert sum(d.circulation(f) for f in range(len(d.faces))) == 0
    assert all(d.mate[d.mate[p]] == p and d.cw(d.ccw(p)) == p for p in d.ports)
    assert d.genus == 0
    vertices = d.n_crossings + bool(d.ends)
    assert vertices - len(d.edges) + len(d.faces) == 2 * len(d.pieces)


@pytest.mark.parametrize("d", ALL, ids=to_gauss)
def test_ports_say_how_strands_run(d: Diagram) -> None:
    entries = {q for strand in d.strands for q in strand}
    for c, sign in enumerate(d.signs):
        assert {4 * c, 4 * c + 2 + sign} == {q for q in entries if q >> 2 == c}
    assert all(d.edge_strand[d.edge_at[q]] == k for k, strand in enumerate(d.strands) for q in strand)


@pytest.mark.parametrize("d", ALL, ids=to_gauss)
def test_mirrors_and_reversals(d: Diagram) -> None:
    assert d.mirror().signs == tuple(-s for s in d.signs)
    assert d.reflected().signs == tuple(-s for s in d.signs)
    assert d.reverse().signs == d.signs
    assert d.mirror().mirror() == d.reverse().reverse() == d.reflected().reflected() == d
    assert d.mirror().ends == d.reverse().ends == d.reflected().ends[::-1] == d.ends
    assert d.mirror().genus == d.reverse().genus == d.reflected().genus == 0
    for p in (3, 5, 7):
        assert colourings(d.mirror(), p) == colourings(d.reverse(), p) == colourings(d, p)


def test_circles_have_no_crossings_and_no_edges() -> None:
    d = Diagram.circle() | TREFOIL | Diagram.circle()
    assert d.starts[0] == d.starts[2] == CIRCLE
    assert (d.circles, d.n_strands, len(d.pieces), len(d.seifert_circles)) == (2, 3, 1, 4)
    assert not d.is_connected
    assert d.reverse().mirror().circles == 2
    assert Diagram.circle().is_connected


def test_outer_faces_are_chosen_or_given() -> None:
    assert [len(FIGURE_EIGHT.faces[f]) for f in FIGURE_EIGHT.outer_faces] == [3]
    braid = from_braid([1, 1, 1, 1, 1])
    (outer,) = braid.outer_faces
    assert [abs(braid.circulation(f)) for f in range(7) if f == outer] == [5]
    assert braid.circulation(outer) == 5  # the closed braid runs clockwise, seen from outside the other way
    split = TREFOIL | FIGURE_EIGHT
    assert len(split.outer_faces) == 2


def test_smoothing_keeps_its_number_of_curves_under_the_second_move() -> None:
    """Seifert's surface of a knot has 2 - 2 genus = circles - crossings + 1, so their difference is odd."""
    rng = random.Random(3)
    for _ in range(30):
        d = scrambled(FIGURE_EIGHT, 20, rng)
        assert (len(d.seifert_circles) - d.n_crossings) % 2 == 1
        assert sorted(e for loop in d.seifert_circles for e in loop) == list(range(len(d.edges)))
        _, d = random_move(d, rng)
        assert d.genus == 0


def test_values_cannot_be_changed() -> None:
    with pytest.raises(AttributeError):
        TREFOIL.mate = ()  # type: ignore[misc]
    assert repr(TREFOIL) == "<Diagram: 3 crossings, 1 strand>"
    assert repr(REEF) == "<Diagram: 6 crossings, 2 strands, ends A0 B0 B1 A1>"
