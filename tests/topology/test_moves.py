"""Reidemeister moves and simplification keep the knot; each move changes the drawing as it must."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from topology.drawings import closed_knots, random_move, scrambled
from topology.invariants import colourings, determinant, signature
from torsade.errors import TorsadeError
from torsade.topology import Diagram, canonical_form, is_isomorphic, moves, simplify
from torsade.topology.codes import from_braid, from_gauss, from_pd
from torsade.topology.diagram import CIRCLE
from torsade.topology.simplify import reduced_by_passes
from torsade.topology.tangle import numerator, rational, summands

CLOSED = closed_knots()
REEF = from_gauss("O1+ U2+ O3+ O4- U5- O6- | U3+ O2+ U1+ U6- O5- U4-", closed=False)
STARTS = [
    from_braid([1, 1, 1]),
    from_braid([1, -2, 1, -2]),
    from_braid([1, -2] * 3),
    from_braid([1, 1, 2, -1, 2, 3, -2, 3]),
    from_braid([1, 2, 1, 2, 1, 2, 1, 2]),
    REEF,
    rational(3, 2, 2),
]
starts = st.sampled_from(STARTS)


def kept(d: Diagram) -> tuple[Any, ...]:
    """What no move changes."""
    return (
        d.ends,
        d.n_strands,
        tuple(map(tuple, d.linking.tolist())),
        *(colourings(d, p) for p in (3, 5, 7)),
    )


@settings(deadline=None)
@given(starts, st.integers(0, 10**6))
def test_moves_keep_the_knot(d: Diagram, seed: int) -> None:
    rng = random.Random(seed)
    known = kept(d)
    for _ in range(12):
        name, after = random_move(d, rng)
        step = after.n_crossings - d.n_crossings
        assert abs(step) == {"R1": 1, "R2": 2, "R3": 0}[name]
        assert abs(after.writhe - d.writhe) == (1 if name == "R1" else 0)
        assert after.genus == 0
        assert kept(after) == known
        circles = len(after.seifert_circles) - len(d.seifert_circles)
        assert circles % 2 == step % 2
        d = after
        if d.n_crossings == 0:
            break


@settings(deadline=None)
@given(starts, st.integers(0, 10**6), st.sampled_from([1, -1]), st.booleans())
def test_kinks_come_and_go(d: Diagram, seed: int, sign: int, left: bool) -> None:
    dart = random.Random(seed).choice(d.ports)
    after = moves.add_kink(d, dart, sign, left)
    assert after.writhe == d.writhe + sign
    (new,) = [p for p in moves.kinks(after) if p >> 2 == d.n_crossings]
    circulation = after.circulation(after.face_at[new])
    assert circulation == (1 if left == d.is_tail(dart) else -1)
    assert canonical_form(moves.remove_kink(after, new)) == canonical_form(d)


@settings(deadline=None)
@given(starts, st.integers(0, 10**6), st.booleans())
def test_bigons_come_and_go(d: Diagram, seed: int, over: bool) -> None:
    dart, other = random.Random(seed).choice(moves.fingers(d))
    after = moves.add_bigon(d, dart, other, over)
    n = d.n_crossings
    (new,) = [p for p in moves.bigons(after) if {p >> 2, after.mate[p] >> 2} == {n, n + 1}]
    assert after.edge_strand[after.edge_at[new]] == d.edge_strand[d.edge_at[dart if over else other]]
    assert canonical_form(moves.remove_bigon(after, new)) == canonical_form(d)


def test_a_triangle_slides_there_and_back() -> None:
    d = from_braid([1, 2, 1, 3, -2])
    for place in moves.triangles(d):
        after = moves.slide_triangle(d, place)
        back = [canonical_form(moves.slide_triangle(after, p)) for p in moves.triangles(after)]
        assert canonical_form(d) in back


def test_a_circle_above_a_crossing_slides_across_it() -> None:
    """The upper strand may be closed and have no other crossings."""
    d = from_gauss("O1- O2+ | U1- O3+ U3+ U2+")
    (place,) = [p for p in moves.triangles(d) if d.edge_strand[d.edge_at[p]] == 0]
    after = moves.slide_triangle(d, place)
    assert (after.n_crossings, after.n_strands, after.genus) == (3, 2, 0)
    assert kept(after) == kept(d)
    assert canonical_form(after) != canonical_form(d)


def test_the_braid_relation_is_the_third_move() -> None:
    for signs in ((1, 1, 1), (1, 1, -1), (-1, 1, 1), (1, -1, -1), (-1, -1, 1), (-1, -1, -1)):
        a, b, c = signs
        d = from_braid([a, 2 * b, c, 1, 1, 2])
        other = from_braid([2 * c, b, 2 * a, 1, 1, 2])
        after = [canonical_form(moves.slide_triangle(d, p)) for p in moves.triangles(d)]
        assert canonical_form(other) in after


def test_the_outer_face_stays_outside() -> None:
    d = from_braid([1, 1, 1])
    (outer,) = d.outer_faces
    inner = next(p for f, face in enumerate(d.faces) for p in face if len(face) == 2 and f != outer)
    after = moves.add_kink(d, inner, 1)
    assert canonical_form(moves.remove_kink(after, moves.kinks(after)[0]), plane=True) == canonical_form(
        d, plane=True
    )
    assert [len(after.faces[f]) for f in after.outer_faces] == [3]


def test_moves_refuse_what_they_cannot_do() -> None:
    d = from_braid([1, 1, 1])
    for act, says in (
        (lambda: moves.remove_kink(d, 0), "port 0 is on no face of one edge"),
        (lambda: moves.remove_bigon(d, 0), "port 0 is no upper dart of a bigon"),
        (lambda: moves.slide_triangle(d, 0), "port 0 is no upper dart of a triangle"),
        (lambda: moves.add_bigon(d, 0, 0), "are not of two edges around one face"),
        (lambda: moves.add_kink(d, 99, 1), "there is no port 99; give one from 0 to 11"),
        (lambda: moves.add_kink(d, 0, 2), "the sign of a kink is 2; give 1 or -1"),
        (lambda: moves.add_kink(d, CIRCLE, 1), "has no circle without crossings"),
    ):
        with pytest.raises(TorsadeError, match=says) as caught:
            act()
        assert "\n" not in str(caught.value)


# --- simplification


@settings(deadline=None, max_examples=60)
@given(starts, st.integers(0, 10**6))
def test_pass_moves_keep_the_knot(d: Diagram, seed: int) -> None:
    big = scrambled(d, 40, random.Random(seed))
    for small in (reduced_by_passes(big), simplify(big, patience=10, seed=seed)):
        assert small.genus == 0
        assert kept(small) == kept(d)
        assert small.n_crossings <= big.n_crossings


def test_knots_come_back_to_their_crossing_numbers() -> None:
    rng = random.Random(11)
    names = rng.sample(list(CLOSED), 60)
    for name in names:
        d = from_pd(CLOSED[name]["pd"])
        small = simplify(scrambled(d, rng.randint(50, 100), rng))
        assert small.n_crossings == CLOSED[name]["crossing_number"], name
        assert (determinant(small), signature(small)) == (determinant(d), signature(d)), name


def test_unknots_and_unlinks_fall_apart() -> None:
    rng = random.Random(5)
    for n in (1, 2, 3):
        d = from_braid(list(range(1, n)) or [], n) if n > 1 else Diagram.circle()
        d = from_braid([1], 2) if n == 1 else d
        assert simplify(scrambled(d, 60, rng)).n_crossings == 0
    unlink = from_braid([1, -1, 2, -2])
    small = simplify(scrambled(unlink, 60, rng))
    assert (small.n_crossings, small.circles) == (0, 3)


twists = st.lists(st.integers(1, 4), min_size=2, max_size=5)


@settings(deadline=None, max_examples=200)
@given(twists, st.data())
def test_hard_unknots(one: list[int], data: st.DataObject) -> None:
    """N(p/q - r/s) with |p s - q r| = 1 is the unknot; many of these drawings have no move that simplifies.

    Kauffman, Lambropoulou, Hard unknots and collapsing tangles (2006). The other fraction is that of
    `one` without its first twist, or with it shared out.
    """
    other = data.draw(st.sampled_from([[*one[1:]], [one[0] + 1, *one[1:]], [1, one[0], *one[1:]]]))
    d = numerator(rational(*one) + -rational(*other))
    assert determinant(d) == 1
    assert simplify(d).n_crossings == 0


def test_a_drawing_that_hangs_on_one_crossing_is_turned_over() -> None:
    trefoil, eight = from_braid([1, 1, 1]), from_braid([1, -2, 1, -2])
    both = trefoil @ moves.add_kink(eight, 0, -1)
    assert simplify(both).n_crossings == 7
    joined = from_braid([1, 1, 1, 2, 3, -4, 3, -4])
    assert reduced_by_passes(joined).n_crossings == 7
    assert [d.n_crossings for d in summands(simplify(joined))] == [4, 3]


def test_ends_stay_where_they_are() -> None:
    rng = random.Random(2)
    for _ in range(10):
        big = scrambled(REEF, 50, rng)
        small = simplify(big)
        assert small.ends == REEF.ends
        assert small.n_crossings == 6
        np.testing.assert_array_equal(small.linking, REEF.linking)


def test_simplification_repeats_itself() -> None:
    big = scrambled(from_braid([1, 1, 1, 2, 2, 2, 1, 1, 2, 2]), 60, random.Random(1))
    assert simplify(big) == simplify(big)
    assert simplify(big, seed=1).n_crossings == simplify(big).n_crossings


def test_alternating_drawings_are_left_alone() -> None:
    d = from_braid([1, -2, 1, -2, 1, -2, 1, -2])
    assert is_isomorphic(simplify(d), d)


def test_a_composite_knot_shows_its_summands() -> None:
    rng = random.Random(9)
    d = from_braid([1, 1, 1]) @ from_braid([1, -2, 1, -2])
    parts = summands(simplify(scrambled(d, 60, rng)))
    assert [part.n_crossings for part in parts] == [4, 3]
