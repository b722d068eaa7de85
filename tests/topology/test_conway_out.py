"""Conway notation written: what is read back is the same knot, chirality included."""

from __future__ import annotations

import itertools
from math import gcd

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from topology.invariants import determinant, signature
from torsade.errors import TorsadeError
from torsade.topology import Diagram, identify, named_diagram, simplify
from torsade.topology.codes import from_braid, from_conway, to_conway, to_pd
from torsade.topology.invariants import Laurent, oriented
from torsade.topology.invariants import jones as jones_of_code
from torsade.topology.table import contents
from torsade.topology.tangle import integer, numerator, rational, summands, union


def jones(diagram: Diagram) -> Laurent:
    return jones_of_code(oriented(to_pd(diagram.without_circles()), diagram.circles))


@pytest.mark.parametrize("name", contents()["knots"])
def test_every_knot_of_the_table_is_read_back(name: str) -> None:
    for diagram in (named_diagram(name), named_diagram(name).mirror()):
        again = from_conway(to_conway(diagram))
        assert identify(again).names == identify(diagram).names
        assert again.n_crossings <= diagram.n_crossings + 1


@pytest.mark.parametrize("name", contents()["links"])
def test_every_link_of_the_table_is_read_back(name: str) -> None:
    """Directions of strands are not in the notation."""
    diagram = named_diagram(name)
    again = from_conway(to_conway(diagram))
    assert determinant(again) == determinant(diagram)
    assert identify(again).names == identify(diagram).names


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("3_1", "-3"),
        ("m3_1", "3"),
        ("4_1", "2 2"),
        ("6_2", "3 1 2"),
        ("8_5", "3;3;2"),
        ("8_17", ".2.2"),
        ("8_18", "8*"),
        ("8_19", "3;3;2-"),
        ("9_40", "9*"),
        ("m9_40", "-9*"),
        ("10_123", "10*"),
        ("L6a4", "6*"),
        ("10_80", "(2 1;2) (3;2)"),
        ("unknot", "1"),
    ],
)
def test_usual_notation(name: str, code: str) -> None:
    assert (
        to_conway(named_diagram(name)).replace("-" if name not in ("8_19", "3_1", "m9_40") else "_", "")
        == code
    )


@given(st.lists(st.integers(1, 4), min_size=1, max_size=6), st.booleans())
def test_rational_knots_keep_their_fraction(twists: list[int], left: bool) -> None:
    """Jones polynomial, determinant and signature; the notation has at most as many numbers."""
    begun = numerator(rational(*twists))
    begun = begun.mirror() if left else begun
    code = to_conway(begun)
    again = from_conway(code)
    assert determinant(again) == determinant(begun)
    if begun.n_strands == 1:
        assert (jones(again), signature(again)) == (jones(begun), signature(begun))
    assert len(code.split()) <= max(len(twists), 3)


FRACTIONS = [(p, q) for q in range(2, 10) for p in range(-9, 10) if gcd(p, q) == 1]


@given(st.lists(st.sampled_from(FRACTIONS), min_size=2, max_size=4), st.integers(-3, 3))
@settings(max_examples=60, deadline=None)
def test_rings_of_tangles(fractions: list[tuple[int, int]], n: int) -> None:
    total: Diagram = integer(n)
    for p, q in fractions:
        total = total + _rational(p, q)
    begun = simplify(numerator(total))
    assume(is_prime(begun))
    again = from_conway(to_conway(begun))
    assert determinant(again) == determinant(begun)
    assert again.n_strands == begun.n_strands
    if begun.n_strands == 1:
        assert (jones(again), signature(again)) == (jones(begun), signature(begun))


def is_prime(diagram: Diagram) -> bool:
    """Whether no sum shows in a drawing that hangs together."""
    return diagram.is_connected and len(summands(diagram)) == 1


def _rational(p: int, q: int) -> Diagram:
    """The tangle p/q, by the continued fraction of its absolute value."""
    if p < 0:
        return -_rational(-p, q)
    numbers = []
    while q:
        numbers.append(p // q)
        p, q = q, p % q
    return rational(*reversed(numbers))


@given(st.lists(st.sampled_from([-3, -2, -1, 1, 2, 3]), min_size=1, max_size=9))
@settings(max_examples=60, deadline=None)
def test_braids(word: list[int]) -> None:
    begun = simplify(from_braid(word))
    assume(is_prime(begun) and begun.n_crossings < 9)  # with nine begin polyhedra without notation
    again = from_conway(to_conway(begun))
    assert determinant(again) == determinant(begun)
    if begun.n_strands == 1:
        assert jones(again) == jones(begun)


def test_what_has_no_notation() -> None:
    for diagram, says in (
        (integer(2), "has ends or split pieces"),
        (union(named_diagram("3_1"), named_diagram("4_1")), "has ends or split pieces"),
        (named_diagram("3_1#4_1"), "shows a connected sum"),
        (from_braid([1, -2] * 6), "not found to lie on a basic polyhedron"),
    ):
        with pytest.raises(TorsadeError, match=says):
            to_conway(diagram)


def test_numbers_of_two_digits() -> None:
    for n in (11, -12):
        assert from_conway(to_conway(from_braid([1] * abs(n) if n > 0 else [-1] * -n))).n_crossings == abs(n)


def test_circles_within_a_polyhedron_are_kept() -> None:
    """With 1, -1 in place of 0, whose crossings cancel, every strand meets crossings and is counted."""
    drawn = {"1": "1", "0": "(1,-1)", "0 0": "(1,-1) 0"}
    circles = 0
    for tangles in itertools.product(drawn, repeat=6):
        plain = from_conway("6*" + ".".join(tangles))
        crossed = from_conway("6*" + ".".join(drawn[t] for t in tangles))
        assert len(plain.starts) == len(crossed.starts)
        circles += plain.circles
    assert circles > 200
