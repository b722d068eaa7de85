"""Tangles: sums, products and closures, and Conway's notation for all knots through ten crossings."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from topology.drawings import closed_knots, needs_knots, table
from topology.invariants import colourings, determinant, signature
from torsade.errors import TorsadeError
from torsade.topology import Diagram, canonical_form, is_isomorphic, simplify
from torsade.topology.codes import from_braid, from_conway, from_gauss, from_pd
from torsade.topology.tangle import (
    close,
    closures,
    connected_sum,
    cut,
    denominator,
    integer,
    numerator,
    rational,
    rotated,
    split,
    summands,
)

CLOSED = closed_knots()
BENDS = table("bends.json")

small = st.integers(-4, 4)


def fraction(twists: list[int]) -> Fraction | None:
    """Conway's continued fraction; None where it is infinite."""
    value: Fraction | None = Fraction(twists[0])
    for n in twists[1:]:
        value = None if value == 0 else n + (1 / value if value is not None else Fraction(0))
    return value


def test_integer_tangles() -> None:
    assert [integer(n).n_crossings for n in (-2, -1, 0, 1, 2)] == [2, 1, 0, 1, 2]
    for n in range(5):
        assert integer(n).is_alternating
        assert canonical_form(integer(n) + integer(2)) == canonical_form(integer(n + 2))
        assert integer(-n) == -integer(n)


def test_the_upper_strand_of_a_positive_tangle_rises_to_the_right() -> None:
    """Corners are SW, SE, NE, NW; the upper strand of the tangle 1 goes from SW to NE."""
    d = integer(1)
    over, _ = d.strands_at[0]
    first, last = d.starts[over], d.mate[d.strands[over][0] ^ 2]
    assert {first + 4, last + 4} == {0, 2}


@pytest.mark.parametrize(
    ("twists", "closure"),
    [((3,), [1, 1, 1]), ((2, 2), [1, -2, 1, -2]), ((5,), [1] * 5), ((3, 1, 2), [1, 1, 1, -2, 1, -2])],
)
def test_rational_knots(twists: tuple[int, ...], closure: list[int]) -> None:
    knot = numerator(rational(*twists))
    assert determinant(knot) == determinant(from_braid(closure)) == abs(fraction(list(twists)) or 0).numerator
    assert abs(signature(knot)) == abs(signature(from_braid(closure)))


@settings(deadline=None)
@given(st.lists(small, min_size=1, max_size=5))
def test_closures_of_rational_tangles_have_the_determinants_of_their_fraction(twists: list[int]) -> None:
    """The numerator of p/q has determinant p, the denominator q (Conway 1970), colourings tell |p| mod p."""
    tangle = rational(*twists)
    value = fraction(twists)
    p, q = (1, 0) if value is None else (value.numerator, value.denominator)
    assert tangle.genus == 0
    for prime in (3, 5, 7):
        assert colourings(numerator(tangle), prime) == (2 if p % prime == 0 else 1)
        assert colourings(denominator(tangle), prime) == (2 if q % prime == 0 else 1)


@settings(deadline=None, max_examples=40)
@given(st.lists(small, min_size=1, max_size=4), st.lists(small, min_size=1, max_size=4))
def test_the_numerator_of_a_sum_adds_fractions(one: list[int], other: list[int]) -> None:
    """det N(a + b) = |p s + q r| for fractions p/q and r/s (Conway 1970)."""
    x, y = fraction(one), fraction(other)
    p, q = (1, 0) if x is None else (x.numerator, x.denominator)
    r, s = (1, 0) if y is None else (y.numerator, y.denominator)
    link = numerator(rational(*one) + rational(*other))
    for prime in (3, 5, 7):
        assert (colourings(link, prime) > 1) == ((p * s + q * r) % prime == 0)


def test_four_quarter_turns_are_none() -> None:
    t = rational(3, 2)
    assert rotated(t, 4) == t
    assert rotated(rotated(t), 3) == t
    assert rotated(t).ends == (t.ends[3], *t.ends[:3])
    assert is_isomorphic(denominator(t), numerator(rotated(t)), unoriented=True)


def test_closures_respect_the_order_of_ends() -> None:
    reef = from_gauss("O1+ U2+ O3+ O4- U5- O6- | U3+ O2+ U1+ U6- O5- U4-", closed=False)
    found = dict(closures(reef))
    assert set(found) == {(("A0", "B0"), ("B1", "A1")), (("A0", "A1"), ("B0", "B1"))}
    knot, link = found[("A0", "B0"), ("B1", "A1")], found[("A0", "A1"), ("B0", "B1")]
    assert (knot.n_strands, link.n_strands) == (1, 2)
    assert [d.n_crossings for d in summands(knot)] == [3, 3]
    assert sorted(signature(d) for d in summands(knot)) == [-2, 2]
    with pytest.raises(TorsadeError, match="cross outside the circle, where the ends are A0 B0 B1 A1"):
        close(reef, [("A0", "B1"), ("B0", "A1")])
    with pytest.raises(TorsadeError, match="do not join all ends; give each of A0 B0 B1 A1 once"):
        close(reef, [("A0", "B1")])
    assert len(list(closures(integer(0) | integer(1)))) == 14


def test_outside_a_closure_is_what_lies_between_its_arcs() -> None:
    for tangle, closed in ((integer(5), numerator), (rational(5, 0), denominator)):
        link = closed(tangle)
        (outer,) = link.outer_faces
        assert sorted(map(len, link.faces)) == [2, 2, 2, 2, 2, 5, 5]
        assert len(link.faces[outer]) == 2
        assert {link.edge_at[p] for p in link.faces[outer]} == {link.edge_at[p] for p in link.outer} | {
            link.edge_at[link.corner(p)] for p in link.outer
        }


@needs_knots
@pytest.mark.parametrize("name", BENDS)
def test_closures_of_bends(name: str) -> None:
    """Linking numbers and component counts of both closures, and colourings of the knots they are."""
    bend = from_pd(BENDS[name]["pd"])
    found = {frozenset(map(frozenset, joins)): d for joins, d in closures(bend)}
    assert len(found) == 2
    for closure in BENDS[name]["closures"]:
        d = found[frozenset(frozenset(pair.split("-")) for pair in closure["joins"].split())]
        assert d.genus == 0
        assert d.n_strands == (1 if closure["type"] == "knot" else 2)
        if closure["type"] == "link":
            assert abs(d.linking[0, 1]) == abs(closure["lk"])
        if "jones_matches" in closure and closure["jones_matches"] == ["0_1"]:
            assert simplify(d).n_crossings == 0
        if "jones_matches" in closure and closure["jones_matches"] == ["3_1#m3_1"]:
            assert [part.n_crossings for part in summands(simplify(d))] == [3, 3]


def test_cutting_and_connecting() -> None:
    trefoil, eight = from_braid([1, 1, 1]), from_braid([1, -2, 1, -2])
    arc = cut(trefoil, 4)
    assert (arc.ends, arc.n_crossings, len(arc.edges)) == (("A0", "A1"), 3, 7)
    assert is_isomorphic(close(arc, [("A0", "A1")]), trefoil)
    both = connected_sum(trefoil, eight, (2, 5))
    assert determinant(both) == 15
    assert signature(both) == -2
    assert both.genus == 0
    parts = summands(both)
    assert is_isomorphic(parts[0], eight)
    assert is_isomorphic(parts[1], trefoil)
    many = trefoil @ eight @ trefoil.mirror() | eight | Diagram.circle()
    assert [d.n_crossings for d in summands(many)] == [4, 4, 3, 3, 0]
    assert [d.n_crossings for d in split(many)] == [10, 4, 0]
    assert (trefoil @ Diagram.circle()).n_crossings == 3
    for hopf in (
        from_gauss("O1+ U2+ | U1+ O2+"),
        from_gauss("O1- U2- | U1- O2-"),
        from_braid([1, 1]).reverse([1]),
    ):
        for both in (hopf @ trefoil, trefoil @ hopf):
            assert sorted(part.writhe for part in summands(both)) == sorted([hopf.writhe, 3])
    assert (Diagram.circle() @ Diagram.circle()) == Diagram.circle()


def test_drawings_side_by_side() -> None:
    d = from_braid([1, 1]) | from_braid([1, 1, 1])
    assert (d.n_strands, len(d.pieces), d.genus) == (3, 2, 0)
    assert canonical_form(d) == canonical_form(from_braid([1, 1, 1]) | from_braid([1, 1]))
    t = integer(1) | integer(2)
    assert (len(t.ends), t.genus, t.ends) == (8, 0, ("A0", "B0", "A1", "B1", "C0", "C1", "D0", "D1"))


def test_refusals() -> None:
    with pytest.raises(TorsadeError, match="the tangle has 0 ends; give one with four"):
        numerator(from_braid([1]))
    with pytest.raises(TorsadeError, match="the diagram has ends A0 A1; give a closed one to cut"):
        cut(cut(from_braid([1])))
    with pytest.raises(TorsadeError, match="there is no edge 7; give one from 0 to 1"):
        cut(from_braid([1]), 7)
    with pytest.raises(TorsadeError, match="close it first"):
        summands(integer(1))
    with pytest.raises(TorsadeError, match="a rational tangle of no twists"):
        rational()


# --- Conway notation


@pytest.mark.parametrize("name", CLOSED)
def test_conway_codes(name: str) -> None:
    """All 249 knots through ten crossings; the codes leave the mirror image open."""
    entry: dict[str, Any] = CLOSED[name]
    knot, drawn = from_conway(entry["conway"]), from_pd(entry["pd"])
    assert (knot.n_crossings, knot.n_strands, knot.genus) == (entry["crossing_number"], 1, 0)
    assert knot.is_alternating == entry["alternating"]
    assert determinant(knot) == determinant(drawn)
    assert abs(signature(knot)) == abs(signature(drawn))
    for p in (3, 5, 7):
        assert colourings(knot, p) == colourings(drawn, p)


@pytest.mark.parametrize(
    ("code", "other"),
    [
        ("[3 1 2]", "312"),
        ("3,21,2-", "[3;21;2-]"),
        ("3;3;2+ + ", "3;3;2++"),
        ("6*2.1.2.1.20", "2:2:20"),
        ("6**1.2.20", ".2.20"),
        ("8*1.1", "8*"),
        ("(3;2)(21;2)", "( 3, 2 ) ( 2 1, 2 )"),
    ],
)
def test_ways_to_write_the_same(code: str, other: str) -> None:
    assert from_conway(code) == from_conway(other)


def test_numbers_of_two_digits_are_set_apart() -> None:
    assert from_conway("12").n_crossings == 3
    assert from_conway("12 1").n_crossings == 13
    assert from_conway("3;3;1-").genus == 0


@pytest.mark.parametrize(
    ("code", "says"),
    [
        ("", "the Conway code is empty; give tangles such as"),
        ("[]", "the Conway code is empty"),
        ("(3;2", "has a '\\(' that is not closed; close it"),
        ("3;", "has its end where a tangle is due; give numbers"),
        ("3x", "has 'x' where it should end; give tangles such as"),
        ("7*2", "the basic polyhedron of the Conway code '7\\*2' is not known; use one of 6\\*"),
        ("2*", "is not known"),
        ("9*2.2.2", "has 3 tangles, and only 2 vertices of 9\\* are numbered here; give a PD or DT code"),
        ("2.2.x", "where a tangle is due"),
    ],
)
def test_bad_conway_codes(code: str, says: str) -> None:
    with pytest.raises(TorsadeError, match=says) as caught:
        from_conway(code)
    assert "\n" not in str(caught.value)
