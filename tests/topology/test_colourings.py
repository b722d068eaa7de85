"""Colourings: counts that are known, and what they do under mirror images and sums."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from topology.drawing import (
    braid,
    connected_sum,
    crossings_changed,
    knot_codes,
    mirrored,
    relabelled,
    turned_round,
    with_bigon,
    with_kink,
)
from torsade.errors import TorsadeError
from torsade.topology.invariants import (
    QUANDLES,
    Quandle,
    colouring_polynomial,
    determinant,
    dihedral_colourings,
)

KNOTS = knot_codes()


def convolved(p: tuple[int, ...], q: tuple[int, ...]) -> tuple[int, ...]:
    n = len(p)
    return tuple(sum(p[i] * q[k - i] for i in range(n)) for k in range(n))


def test_sizes_of_classes() -> None:
    """Six 4-cycles of S4, 20 3-cycles and 12 5-cycles of A5 in a class, 24 of the elements of order 7."""
    assert {name: (len(q.elements), len(q.powers)) for name, q in QUANDLES.items()} == {
        "S4 order 4": (6, 4),
        "A5 order 3": (20, 3),
        "A5 order 5": (12, 5),
        "PSL(2,7) order 7": (24, 7),
    }


@pytest.mark.parametrize("p", [2, 3, 5, 7, 11])
def test_dihedral_colourings_are_more_than_trivial_when_p_divides_the_determinant(p: int) -> None:
    for pd in KNOTS.values():
        found = dihedral_colourings(pd, p)
        assert found % p == 0
        assert (found > p) == (determinant(pd) % p == 0)


@pytest.mark.parametrize("p", [3, 5])
def test_dihedral_colourings_one_by_one(p: int) -> None:
    """The quandle of reflections gives the same number by trying colours."""
    turn = tuple((k + 1) % p for k in range(p))
    flip = tuple(-k % p for k in range(p))
    quandle = Quandle(flip, (turn, flip))
    assert len(quandle.elements) == p
    for pd in list(KNOTS.values())[:84]:
        # The longitude lies in the second commutator subgroup, so it goes to 1: to power 0.
        counts = colouring_polynomial(pd, quandle)
        assert counts[1:] == (0,) * (len(counts) - 1)
        assert p * counts[0] == dihedral_colourings(pd, p)


def test_dihedral_colourings_of_links() -> None:
    assert dihedral_colourings([], 3, circles=3) == 27
    assert dihedral_colourings(braid([1, 1])[0], 2) == 4
    assert dihedral_colourings(braid([1, 1])[0], 3) == 3


@pytest.mark.parametrize("name", QUANDLES)
def test_moves_mirrors_and_reversal(name: str) -> None:
    quandle = QUANDLES[name]
    for knot, pd in KNOTS.items():
        rng = random.Random(knot)
        found = colouring_polynomial(pd, quandle)
        same = [turned_round(pd), relabelled(pd, rng), with_kink(pd, rng), with_bigon(pd, rng)]
        assert [colouring_polynomial(other, quandle) for other in same] == [found] * 4, knot
        image = found[:1] + found[:0:-1]
        assert colouring_polynomial(mirrored(pd), quandle) == image
        assert colouring_polynomial(crossings_changed(pd), quandle) == image


@settings(deadline=None, max_examples=30)
@given(st.sampled_from(list(KNOTS)[:84]), st.sampled_from(list(KNOTS)[:84]), st.sampled_from(list(QUANDLES)))
def test_sums(one: str, two: str, name: str) -> None:
    found = [colouring_polynomial(pd, QUANDLES[name]) for pd in (KNOTS[one], KNOTS[two])]
    joined = connected_sum(KNOTS[one], KNOTS[two])
    assert colouring_polynomial(joined, QUANDLES[name]) == convolved(*found)


def test_what_is_refused() -> None:
    with pytest.raises(TorsadeError, match="p is 9; give a prime"):
        dihedral_colourings(KNOTS["3_1"], 9)
    with pytest.raises(TorsadeError, match="2 components; give a knot"):
        colouring_polynomial(braid([1, 1])[0], QUANDLES["A5 order 3"])
    psl27 = QUANDLES["PSL(2,7) order 7"].generators
    involutions = Quandle(psl27[1], psl27)
    with pytest.raises(TorsadeError, match="no power of the meridian"):
        colouring_polynomial(KNOTS["10_61"], involutions)
