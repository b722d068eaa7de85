"""Projections of curves whose drawing is known, and of curves that are hard to see."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from hanging import no_hang
from topology.invariants import determinant, signature
from torsade.errors import TorsadeError
from torsade.knots import bend
from torsade.topology import Diagram, canonical_form, is_isomorphic, project, simplify, state
from torsade.topology.codes import from_braid, from_gauss
from torsade.topology.measures import writhe
from torsade.topology.tangle import closures
from torsade.topology.views import total_curvature, turning_number

FloatArray = NDArray[np.float64]


def torus_knot(p: int, q: int, n: int = 120, R: float = 2.0, r: float = 0.7) -> FloatArray:
    """p times around the axis, q times around the tube; right-handed."""
    t = 2 * np.pi * np.arange(n) / n
    around = R + r * np.cos(q * t)
    return np.stack([around * np.cos(p * t), around * np.sin(p * t), -r * np.sin(q * t)], axis=1)


def figure_eight(n: int = 120) -> FloatArray:
    t = 2 * np.pi * np.arange(n) / n
    return np.stack(
        [(2 + np.cos(2 * t)) * np.cos(3 * t), (2 + np.cos(2 * t)) * np.sin(3 * t), np.sin(4 * t)], axis=1
    )


def circle(n: int = 40, centre: tuple[float, float, float] = (0.0, 0.0, 0.0), axis: int = 2) -> FloatArray:
    t = 2 * np.pi * np.arange(n) / n
    x = np.roll(np.stack([np.cos(t), np.sin(t), 0 * t], axis=1), axis + 1, axis=1)
    return x + np.array(centre)


def sphere(k: int, seed: int = 1) -> FloatArray:
    d: FloatArray = np.random.default_rng(seed).normal(size=(k, 3))
    return d


# --- known curves


def test_the_right_handed_trefoil_has_positive_crossings() -> None:
    seen = project([torus_knot(2, 3)], closed=True)
    assert seen.diagram.signs == (1, 1, 1)
    assert is_isomorphic(seen.diagram, from_braid([1, 1, 1]))
    assert [len(seen.diagram.faces[f]) for f in seen.diagram.outer_faces] == [3]
    # Counterclockwise around the axis, seen from outside clockwise.
    assert [seen.diagram.circulation(f) for f in seen.diagram.outer_faces] == [-3]


@pytest.mark.parametrize(
    ("x", "word"),
    [
        (torus_knot(2, 3), [1, 1, 1]),
        (torus_knot(2, 3) * (1, 1, -1), [-1, -1, -1]),
        (torus_knot(2, 5), [1] * 5),
        (torus_knot(3, 4, 200), [1, 2] * 4),
        (torus_knot(3, 5, 240), [1, 2] * 5),
        (figure_eight(), [1, -2, 1, -2]),
    ],
)
def test_one_knot_from_many_directions(x: FloatArray, word: list[int]) -> None:
    known = from_braid(word)
    for d in sphere(40):
        seen = project([x], closed=True, direction=d)
        small = simplify(seen.diagram)
        assert small.n_crossings == known.n_crossings
        assert (determinant(small), signature(small)) == (determinant(known), signature(known))


def test_from_behind_a_knot_is_the_same_knot() -> None:
    x = torus_knot(2, 3)
    front, back = project([x], True, (0, 0, 1)), project([x], True, (0, 0, -1))
    assert front.diagram.signs == back.diagram.signs
    assert is_isomorphic(front.diagram.mirror().reflected(), back.diagram)


def test_links() -> None:
    hopf = project([circle(), circle(centre=(1, 0, 0), axis=1)], closed=True)
    for d in sphere(20):
        assert abs(project([circle(), circle(centre=(1, 0, 0), axis=1)], True, d).diagram.linking[0, 1]) == 1
    assert hopf.diagram.n_strands == 2
    apart = project([circle(), circle(centre=(9, 0, 0)), torus_knot(2, 3) + np.array([0, 9, 0])], closed=True)
    assert apart.diagram.circles == 2
    assert apart.diagram.n_crossings == 3


@pytest.mark.parametrize("name", ["reef", "granny"])
def test_built_in_bends(name: str) -> None:
    """The tangles of reef and granny: their closures are 3_1 # m3_1 and 3_1 # 3_1, up to a mirror image."""
    b = bend(name)
    for d in [None, (0.1, 0, 1), (0, 0.2, 1), (-0.1, 0.1, 1)]:
        seen = project(b.strands, direction=d)
        small = simplify(seen.diagram)
        assert sorted(small.ends) == ["A0", "A1", "B0", "B1"]
        assert small.n_crossings == 6
        assert abs(small.pulled("A1B1").writhe) == (0 if name == "reef" else 6)
        knot = next(k for _, k in closures(small) if k.n_strands == 1)
        assert determinant(knot) == 9
        assert abs(signature(knot)) == (0 if name == "reef" else 4)


# --- what is said about crossings


def test_where_crossings_lie() -> None:
    x = np.array([[-1, 0, 0], [1, 0, 0.0]])
    y = np.array([[0.5, -1, 2], [0.5, 3, 2.0]])
    seen = project([x, y])
    assert seen.diagram.signs == (-1,)  # the upper strand, y, goes north; the lower one goes east
    np.testing.assert_array_equal(seen.strand, [[1, 0]])
    np.testing.assert_array_equal(seen.edge, [[0, 0]])
    np.testing.assert_allclose(seen.parameter, [[0.25, 0.75]])
    np.testing.assert_allclose(seen.height, [[2, 0]])
    assert seen.diagram.ends == ("A0", "B0", "A1", "B1")
    assert (seen.refused, seen.n_led_out) == ((), 0)
    np.testing.assert_array_equal(seen.direction, [0, 0, 1])


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6), st.integers(4, 40), st.integers(1, 3))
def test_against_all_pairs(seed: int, n: int, k: int) -> None:
    """Random polygons: crossings found by looking at each pair of edges alone."""
    rng = np.random.default_rng(seed)
    strands = [rng.normal(size=(n, 3)) for _ in range(k)]
    closed = [bool(rng.integers(2)) for _ in range(k)]
    seen = project(strands, closed)
    d = seen.diagram
    edges = [
        (s, i, x[i], x[(i + 1) % n])
        for s, (x, c) in enumerate(zip(strands, closed, strict=True))
        for i in range(n if c else n - 1)
    ]
    found = set()
    for a, (s, i, p, q) in enumerate(edges):
        for t, j, u, v in edges[a + 1 :]:
            m = np.array([q[:2] - p[:2], u[:2] - v[:2]]).T
            at = np.linalg.solve(m, u[:2] - p[:2])
            if s == t and (abs(i - j) == 1 or (closed[s] and abs(i - j) == n - 1)):
                continue
            if ((at > 0) & (at < 1)).all():
                above = (p + at[0] * (q - p))[2] > (u + at[1] * (v - u))[2]
                found.add(((s, i), (t, j)) if above else ((t, j), (s, i)))
    real = len(seen.strand)
    rows = zip(seen.strand.tolist(), seen.edge.tolist(), strict=True)
    assert {((s[0], e[0]), (s[1], e[1])) for s, e in rows} == found
    assert real == len(found) == d.n_crossings - seen.n_led_out
    assert d.genus == 0
    assert (seen.height[:, 0] > seen.height[:, 1]).all()
    # Every strand meets its crossings in the order of its edges.
    for s, strand in enumerate(d.strands):
        along = [
            seen.edge[q >> 2, 1 - (q & 1)] + seen.parameter[q >> 2, 1 - (q & 1)]
            for q in strand
            if q >> 2 < real
        ]
        assert along == sorted(along)
        assert all(seen.strand[q >> 2, 1 - (q & 1)] == s for q in strand if q >> 2 < real)


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 10**6))
def test_the_outer_face_is_outside(seed: int) -> None:
    """Winding numbers counted from face to face, from 0 outside, are those found around random points."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(12, 3))
    d = project([x], closed=True).diagram
    if not d.n_crossings:
        return
    (outer,) = d.outer_faces
    winding, todo = {outer: 0}, [outer]
    for f in todo:
        for p in d.faces[f]:
            g = d.face_at[d.mate[p]]
            if g not in winding:
                winding[g] = winding[f] + (-1 if d.is_tail(p) else 1)
                todo.append(g)
    middle = x[:, :2].mean(axis=0)
    for _ in range(20):
        point = middle + rng.normal(size=2)
        u, v = (np.vstack([x, x[:1]])[:, :2] - point).T
        steps = (np.diff(np.arctan2(v, u)) + np.pi) % (2 * np.pi) - np.pi
        assert round(steps.sum() / (2 * np.pi)) in winding.values()


# --- ends


def test_ends_in_the_order_in_which_they_leave() -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        angles = np.sort(rng.uniform(-np.pi, np.pi, 8))
        tips = 10 * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
        order = rng.permutation(8)
        strands = [
            np.array([tips[order[2 * k]], [*rng.normal(size=2), k], tips[order[2 * k + 1]]]) for k in range(4)
        ]
        names = {int(order[2 * k + e]): f"{'ABCD'[k]}{e}" for k in range(4) for e in (0, 1)}
        around = [names[k] for k in range(8)]
        first = around.index("A0")
        seen = project(strands)
        assert list(seen.diagram.ends) == around[first:] + around[:first]
        assert seen.n_led_out == 0


def test_strands_that_do_not_cross_lie_side_by_side() -> None:
    lines = [np.array([[x, -1, 0], [x, 1, 0.0]]) for x in (0.0, 1.0, 2.0)]
    seen = project(lines)
    assert seen.diagram.ends == ("A0", "B0", "C0", "C1", "B1", "A1")
    assert seen.diagram.genus == 0


def test_an_end_in_the_midst_is_led_out_above_everything() -> None:
    loop = np.array(
        [[-3, 0, 0], [1, 0, 0], [1, 2, 0], [-1, 2, 0], [-1, -1, 1], [3, -1, 1], [3, 4, 1], [-3, 4, 1.0]]
    )
    inwards = np.array([[-2, 3, 0], [2, 3, 0], [2, -0.5, 0.5], [0, -0.5, 0.5], [0, 1, 0.5]])
    seen = project([np.vstack([loop, inwards])])
    assert len(seen.strand) == 2
    assert seen.n_led_out == 1
    assert seen.diagram.n_crossings == 3
    assert seen.diagram.strands[0][-1] >> 2 == 2
    assert seen.diagram.strands[0][-1] & 1
    assert seen.diagram.ends == ("A0", "A1")
    assert simplify(seen.diagram).n_crossings == 0


def test_an_end_in_a_spiral_is_outside() -> None:
    t = np.linspace(0, 4.5 * np.pi, 60)
    seen = project([np.stack([t * np.cos(t), t * np.sin(t), 0 * t], axis=1)])
    assert (seen.n_led_out, seen.diagram.n_crossings, seen.diagram.genus) == (0, 0, 0)


# --- views that show nothing


def test_degenerate_views_are_refused_and_another_is_taken() -> None:
    square = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0.0]])
    through = np.array([[1, 1, -1], [1, 1, 1], [5, 1, 1], [5, 1, -1.0]])
    seen = project([square, through], closed=True)
    assert seen.refused[0] == "edge 0 of strand 1 is seen end on"
    assert abs(seen.diagram.linking[0, 1]) == 1
    assert seen.direction @ np.array([0, 0, 1]) > 0.99
    again = project([square, through], closed=True)
    assert (again.direction == seen.direction).all()
    assert again.diagram == seen.diagram


@pytest.mark.parametrize(
    ("strands", "says"),
    [
        ([[[-1, 0, 0], [1, 0, 0]], [[0, -1, 1], [0, 0, 1], [0.5, 1, 1]]], "touch or overlap"),
        ([[[-1, 0, 0], [1, 0, 0]], [[0, 0, 1], [2, 0, 1]]], "touch or overlap"),
        ([[[-1, 0, 0], [1, 0, 0]], [[0, -1, 1], [0, 1, 1]], [[-1, -1, 2], [1, 1, 2]]], "three strands meet"),
        ([[[0, 0, 0], [1, 0, 0], [0, 0, 1]]], "touch or overlap"),
    ],
)  # fmt: skip
def test_reasons_for_another_direction(strands: Any, says: str) -> None:
    seen = project([np.array(x, dtype=float) for x in strands])
    assert says in seen.refused[0]
    assert seen.diagram.genus == 0


def test_regular_polygons_and_flat_drawings_are_seen() -> None:
    """Curves made on a grid, where many views are degenerate."""
    steps = [
        (0, 0, 0),
        (3, 0, 0),
        (3, 0, 1),
        (3, 2, 1),
        (1, 2, 1),
        (1, 2, -1),
        (1, -1, -1),
        (2, -1, -1),
        (2, -1, 2),
    ]
    steps += [(2, 1, 2), (2, 1, 0.5), (0, 1, 0.5)]
    grid = np.array(steps, dtype=float)
    drawings = {
        (determinant(d), abs(signature(d)))
        for v in [None, (1, 0, 0), (0, 1, 0), (1, 1, 0), (1, 1, 1)]
        if (d := simplify(project([grid], closed=True, direction=v).diagram)).n_crossings >= 0
    }
    assert len(drawings) == 1


# --- refusals


@pytest.mark.parametrize(
    ("strands", "closed", "direction", "says"),
    [
        ([], False, None, "there is no strand; give at least one"),
        ([np.zeros((4, 2))], False, None, r"strand 0 has nodes of shape \(4, 2\); give \(n, 3\)"),
        ([np.zeros((1, 3))], False, None, "strand 0 has 1 nodes; give at least 2"),
        ([circle(2)], True, None, "strand 0 has 2 nodes; give at least 3"),
        ([circle(5) * (1, np.nan, 1)], True, None, "node 0 of strand 0 is .*; give finite coordinates"),
        ([circle(5)[[0, 1, 1, 2]]], False, None, "nodes 1 and 2 of strand 0 are the same point; remove one"),
        ([np.vstack([circle(5), circle(5)[:1]])], True, None, "nodes 5 and 0 of strand 0 are the same point"),
        ([circle(), circle()], True, None, "edge .* of strand 0 and edge .* of strand 1 meet in space; move"),
        ([np.array([[0, 0, 0], [2, 0, 0], [1, 1, 0], [1, -1, 0.0]])], False, None, "edge 0 .* and edge 2"),
        ([np.array([[0, 0, 0], [2, 0, 0], [1, 0, 0.0]])], False, None, "edge 0 .* and edge 1 .* meet"),
        ([circle(), circle()], (True,), None, "2 strands have 1 closed flags; give one, or one for each"),
        ([circle()], True, (0, 0, 0), "the direction of view is .*; give three finite numbers"),
        ([circle()], True, (0, 1), "give three finite numbers, not all zero"),
    ],
)  # fmt: skip
def test_curves_that_make_no_sense(strands: Any, closed: Any, direction: Any, says: str) -> None:
    with pytest.raises(TorsadeError, match=says) as caught:
        project(strands, closed, direction)
    assert "\n" not in str(caught.value)


# --- size


def test_ten_thousand_nodes() -> None:
    """A random walk, with about 14,000 crossings."""
    rng = np.random.default_rng(0)
    long = np.cumsum(rng.normal(size=(10_000, 3)), axis=0)
    with no_hang():
        seen = project([long])
    assert seen.diagram.n_crossings > 5000
    assert seen.diagram.genus == 0


def test_a_curve_keeps_its_diagram_when_it_is_turned_with_the_eye() -> None:
    x = figure_eight()
    q, _ = np.linalg.qr(sphere(3))
    q *= np.sign(np.linalg.det(q))
    turned = project([x @ q.T], True, q @ np.array([0.1, 0.2, math.sqrt(0.95)])).diagram
    assert canonical_form(turned) == canonical_form(project([x], True, (0.1, 0.2, math.sqrt(0.95))).diagram)


@pytest.mark.parametrize("exponent", [-1020, -540, -535, -500, 333, 500, 515, 1015])
def test_curves_of_any_size_are_seen_alike(exponent: int) -> None:
    """To the last digit, where squares of lengths are no numbers."""
    walk = np.cumsum(np.random.default_rng(5).normal(size=(60, 3)), axis=0)
    seen, other = project([walk], closed=True), project([np.ldexp(walk, exponent)], closed=True)
    assert other.diagram == seen.diagram
    assert (other.parameter == seen.parameter).all()
    assert (other.height == np.ldexp(seen.height, exponent)).all()
    for measure in (writhe, turning_number, total_curvature):
        assert measure(np.ldexp(walk, exponent), True) == measure(walk, True)


@pytest.mark.parametrize("seed", range(3))
def test_what_is_counted_does_not_turn_with_the_drawing(seed: int) -> None:
    """About the line of sight, as long as the ends are led out alike."""
    rng = np.random.default_rng(seed)
    for _ in range(20):
        walks = [np.cumsum(rng.normal(size=(rng.integers(4, 12), 3)), axis=0) for _ in range(3)]
        counted: dict[Any, set[tuple[float, int]]] = {}
        for angle in np.linspace(0, 6, 5):
            c, s = math.cos(angle), math.sin(angle)
            seen = project([x @ [[c, s, 0], [-s, c, 0], [0, 0, 1]] for x in walks])
            found = state(seen.diagram)
            drawn = seen.n_led_out, seen.diagram.ends
            counted.setdefault(drawn, set()).add((round(found.gamma, 9), found.whitney))
        assert all(len(values) == 1 for values in counted.values())


def test_strands_keep_their_order() -> None:
    seen = project([circle(centre=(9, 0, 0)), torus_knot(2, 3), circle(centre=(0, 0, 5))], closed=True)
    assert seen.diagram.n_strands == 3
    assert seen.diagram.strands[0] == ()
    assert isinstance(seen.diagram, Diagram)
    assert from_gauss("").circles == 1
