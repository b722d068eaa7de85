"""Writhe, linking and average crossing number: published numbers, closed forms, symmetries, brute force."""

from __future__ import annotations

import itertools
import json
import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from topology.curves import (
    around,
    brute_force,
    half_solid_angles,
    hopf_link,
    random_directions,
    random_loop,
    random_polygon,
    ring,
    rotation,
    torus_knot,
)
from torsade import curve
from torsade.arrays import Floats
from torsade.topology import gauss, measures
from torsade.topology.measures import (
    average_crossing_number,
    linking,
    writhe,
    writhe_density,
    writhe_matrix,
)
from torsade.topology.views import directional_crossing_number, directional_writhe

SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).resolve().parents[3] / "shared"))

SMOOTH: dict[str, Callable[[Floats], list[Floats]]] = {
    "trefoil x=": lambda t: [np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)],
    "fig-8": lambda t: [
        (2 + np.cos(2 * t)) * np.cos(3 * t),
        (2 + np.cos(2 * t)) * np.sin(3 * t),
        np.sin(4 * t),
    ],
    "closed coil": lambda t: [
        (3 + np.cos(8 * t)) * np.cos(t),
        (3 + np.cos(8 * t)) * np.sin(t),
        np.sin(8 * t),
    ],
    "saddle": lambda t: [np.cos(t), np.sin(t), 0.5 * np.sin(2 * t)],
}
"""Curves of the reference tables by how their names begin, beside the torus knots."""

MISLABELLED = "x=cos t,y=sin t,z=0.5 sin3t (non-symmetric) + 0.2 cos 2t"
"""The tables give it a writhe of 0.45. The curve of that name is its own mirror image: t → pi - t, x → -x."""

TREFOIL_STICKS = (
    (0.5, 0.5, -0.5), (0.5, -1.0, 0.5), (-1.0, -0.5, -0.5), (0.5, 0.5, 0.5), (-0.5, -1.0, -0.5),
    (-0.5, 0.5, 0.6),
)  # fmt: skip


def smooth_curve(name: str, n: int) -> Floats:
    if name.startswith("T("):
        return torus_knot(int(name[2]), int(name[4]), n)
    (shape,) = [f for begin, f in SMOOTH.items() if name.startswith(begin)]
    return np.stack(shape(around(n)), axis=1)


@pytest.fixture(scope="module")
def vectors() -> Any:
    """The reference tables of writhe and average crossing number."""
    path = SHARED / "data" / "curves" / "writhe_vectors.json"
    if not path.is_file():
        pytest.skip("the reference writhes are not here; give their folder in TORSADE_SHARED")
    return json.loads(path.read_text(encoding="utf-8"))


# --- published numbers and closed forms


def test_reference_polygons(vectors: Any) -> None:
    """writhe_vectors.json, computed independently: sticks, and smooth curves of 100 and 400 nodes.

    The saddle is its own mirror image, so that its writhe is zero; the table has -1.27e-8.
    """
    for name, expected in vectors["polygons"].items():
        x, closed = expected["vertices"], not name.startswith("open")
        assert writhe(x, closed) == pytest.approx(expected["Wr"], abs=1e-12), name
        assert average_crossing_number(x, closed) == pytest.approx(expected["ACN"], abs=1e-12), name
    for name, expected in vectors["smooth"].items():
        for n in (100, 400) if name != MISLABELLED else ():
            x = smooth_curve(name, n)
            found = writhe(x, True), average_crossing_number(x, True)
            off = 1.3e-8 if name.startswith("saddle") else 1e-8
            assert found == pytest.approx(expected[f"polygon_N{n}"], abs=off), (name, n)
    t = around(100)
    itself = np.stack([np.cos(t), np.sin(t), 0.5 * np.sin(3 * t) + 0.2 * np.cos(2 * t)], axis=1)
    assert writhe(itself, True) == pytest.approx(0, abs=1e-14)


def test_reference_limits_of_smooth_curves(vectors: Any) -> None:
    """Polygons converge as 1/n^2; extrapolated, writhe agrees within the error that the tables state for it.

    The average crossing number is not smooth where crossings change sign, and is taken at n = 3200.
    """
    for name, expected in vectors["smooth"].items():
        if name == MISLABELLED:
            continue
        coarse, fine = (smooth_curve(name, n) for n in (800, 1600))
        limit = (4 * writhe(fine, True) - writhe(coarse, True)) / 3
        assert limit == pytest.approx(expected["Wr"], abs=max(1e-6, expected["err"])), name
        found = average_crossing_number(smooth_curve(name, 3200), True)
        assert found == pytest.approx(expected["ACN"], abs=2.5e-4), name


def test_six_stick_trefoil() -> None:
    """Numbers of the reference tables, here too for those who have not got them; left-handed."""
    assert writhe(TREFOIL_STICKS, True) == pytest.approx(-1.0315645500164206, abs=1e-12)
    assert average_crossing_number(TREFOIL_STICKS, True) == pytest.approx(5.061339229401028, abs=1e-12)


def test_three_edges_of_a_cube() -> None:
    """The first and third of three edges see each other under pi/6: 1/12 of a crossing, right-handed."""
    x = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]]
    assert writhe(x, False) == pytest.approx(1 / 12, abs=1e-15)
    assert writhe_density(x, False) == pytest.approx([1 / 24, 0, 1 / 24], abs=1e-15)


@pytest.mark.parametrize("height", [1e-6, 1e-3, 0.5, 1.0, 10.0, 1e4])
def test_two_edges_across_each_other(height: float) -> None:
    """Their differences fill a square of side 2 at this height: Omega = 4 arctan(1/(h sqrt(2 + h^2)))."""
    over, under = [[-1, 0, height], [1, 0, height]], [[0, -1, 0], [0, 1, 0]]
    turns = math.atan(1 / (height * math.sqrt(2 + height**2))) / math.pi
    # The upper edge, along x, is turned counterclockwise to lie along the lower one, along y: right-handed.
    expected = np.array([[0, turns], [turns, 0]])
    # Nodes are known to round-off, which turns the line of sight across the gap by so much more.
    off = 1e-13 * turns + 1e-16 / height
    assert linking([over, under], False) == pytest.approx(expected, abs=off)
    assert linking([over, under[::-1]], False) == pytest.approx(-expected, abs=off)
    assert writhe([over, under], False) == pytest.approx(2 * turns, abs=2 * off)
    assert average_crossing_number([over, under[::-1]], False) == pytest.approx(2 * turns, abs=2 * off)


def test_hopf_and_torus_links() -> None:
    """Lk is half the sum of signs: -1 and -2 for left-handed links; the writhe counts every crossing."""
    assert linking(hopf_link(), True) == pytest.approx(np.array([[0, -1], [-1, 0]]), abs=1e-13)
    assert linking([hopf_link()[0], hopf_link()[1][::-1]], True)[0, 1] == pytest.approx(1, abs=1e-13)
    assert writhe(hopf_link(), True) == pytest.approx(-2, abs=1e-13)
    four = [torus_knot(1, 2, 60), torus_knot(1, 2, 70, np.pi)]
    assert linking(four, True)[0, 1] == pytest.approx(-2, abs=1e-12)
    apart = [ring(), ring() + 3.0]
    assert linking(apart, True) == pytest.approx(np.zeros((2, 2)), abs=1e-14)


def test_three_links_of_a_chain() -> None:
    """Each ring links its neighbours only; the matrix is symmetric and its diagonal zero."""
    x = ring(24)
    chain = [x, x[:, [0, 2, 1]] + np.array([1.5, 0, 0]), x + np.array([3.0, 0, 0])]
    expected = np.array([[0, -1, 0], [-1, 0, 1], [0, 1, 0]])
    assert linking(chain, True) == pytest.approx(expected, abs=1e-13)


def test_planar_curves_have_no_writhe() -> None:
    """In a coordinate plane exactly none; in any other plane, none but round-off."""
    x = random_loop(3, 60) * np.array([1.0, 1.0, 0.0])
    lifted = np.delete(x, slice(20, 40), axis=0)[:7]  # a few nodes, so that no edges cross
    assert writhe(ring(), True) == 0.0
    assert math.copysign(1, writhe(ring(), True)) == 1
    assert average_crossing_number(ring() @ rotation(1).T, True) < 1e-14
    assert writhe(lifted, False) == 0.0
    assert writhe([[0, 0, 0], [1, 0, 0], [3, 0, 0], [4, 0, 0], [5, 0, 0]], False) == 0.0


def test_edges_that_share_a_node_add_nothing() -> None:
    """A triangle, three edges of an open curve in a plane, a single edge, and a fold straight back."""
    assert writhe([[0, 0, 0], [1, 0, 0], [0, 1, 5]], True) == 0.0
    assert writhe([[0, 0, 0], [1, 0, 0]], False) == 0.0
    assert writhe([[0, 0, 0], [1, 0, 0], [0.5, 0, 0]], False) == 0.0


# --- against plain numpy


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("n", [4, 5, 9, 33, 34, 97, 200])
def test_kernel_equals_plain_numpy(n: int, closed: bool) -> None:
    x = random_polygon(n, n)
    total, unsigned, density = brute_force(x, closed)
    assert writhe(x, closed) == pytest.approx(total, abs=1e-12)
    assert average_crossing_number(x, closed) == pytest.approx(unsigned, rel=1e-12)
    assert writhe_density(x, closed) == pytest.approx(density, abs=1e-12)


def test_matrix_of_several_curves_equals_plain_numpy() -> None:
    """Open and closed together: own writhes on the diagonal, half sums over all pairs beside it."""
    curves, closed = [random_polygon(1, 9), random_polygon(2, 40), random_polygon(3, 2)], [True, False, False]
    found = writhe_matrix(curves, closed)
    edges = [(x, np.roll(x, -1, 0)) if c else (x[:-1], x[1:]) for x, c in zip(curves, closed, strict=True)]
    for a, b in itertools.combinations(range(3), 2):
        (p, q), (r, s) = edges[a], edges[b]
        i, j = (k.ravel() for k in np.indices((len(p), len(r))))
        each = half_solid_angles(np.concatenate([p, r]), np.concatenate([q, s]), i, len(p) + j)
        assert found[a, b] == found[b, a] == pytest.approx(each.sum() / (2 * np.pi), abs=1e-12)
    for a in range(3):
        assert found[a, a] == pytest.approx(brute_force(curves[a], closed[a])[0], abs=1e-12)
    assert writhe(curves, closed) == pytest.approx(found.sum(), abs=1e-13)
    off_diagonal = found - np.diag(np.diag(found))
    assert linking(curves, closed) == pytest.approx(off_diagonal, abs=1e-15)
    assert writhe_density(curves, closed).sum() == pytest.approx(found.sum(), abs=1e-12)
    assert len(writhe_density(curves, closed)) == 9 + 39 + 1


def test_klenin_and_langowski() -> None:
    """Their method 1a as printed, with four arcsines of unit normals; it loses half of the digits."""
    x = random_polygon(8, 12)
    p, q = x, np.roll(x, -1, axis=0)
    total = 0.0
    for i, j in itertools.combinations(range(12), 2):
        if (j - i) % 12 in (1, 11):
            continue
        r = [p[j] - p[i], q[j] - p[i], q[j] - q[i], p[j] - q[i]]
        normal = [np.cross(r[k], r[(k + 1) % 4]) for k in range(4)]
        normal = [v / np.linalg.norm(v) for v in normal]
        area = sum(np.arcsin(np.clip(normal[k] @ normal[(k + 1) % 4], -1, 1)) for k in range(4))
        total += area * np.sign(np.cross(q[j] - p[j], q[i] - p[i]) @ (p[j] - p[i]))
    assert writhe(x, True) == pytest.approx(total / (2 * np.pi), abs=1e-7)


def test_arctangent_in_all_quadrants() -> None:
    """The kernel's own arctangent against the library's, within three units in the last place."""
    rng = np.random.default_rng(0)
    angle = np.concatenate(
        [rng.uniform(-np.pi, np.pi, 20_000), rng.choice([-1, 1], 5_000) * 10.0 ** rng.uniform(-300, 0, 5_000)]
    )
    size = 10.0 ** rng.uniform(-3, 3, len(angle))
    y, x = size * np.sin(angle), size * np.cos(angle)
    found = np.array([gauss._arctangent(a, b) for a, b in zip(y, x, strict=True)])
    assert np.all(np.abs(found - np.arctan2(y, x)) <= 3 * np.spacing(np.abs(np.arctan2(y, x))))
    assert gauss._arctangent(0.0, 1.0) == 0.0
    assert gauss._arctangent(1.0, 0.0) == pytest.approx(np.pi / 2)
    assert gauss._arctangent(-0.0, -1.0) == pytest.approx(-np.pi)


# --- symmetries


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(4, 24), closed=st.booleans())
def test_symmetries(seed: int, n: int, closed: bool) -> None:
    """Turning, moving, scaling and reversing change nothing; a mirror changes the sign of writhe alone."""
    x = random_polygon(seed, n)
    here, acn = writhe(x, closed), average_crossing_number(x, closed)
    for y in (x @ rotation(seed).T, x + 7.0, 1e-3 * x, x[::-1], x * 1e80, x * 1e-80):
        assert writhe(y, closed) == pytest.approx(here, abs=1e-9)
        assert average_crossing_number(y, closed) == pytest.approx(acn, abs=1e-9)
    mirrored = x * np.array([1.0, 1.0, -1.0])
    assert writhe(mirrored, closed) == -here
    assert average_crossing_number(mirrored, closed) == acn
    if closed:
        assert writhe(np.roll(x, 3, axis=0), closed) == pytest.approx(here, abs=1e-9)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(3, 20), m=st.integers(3, 20))
def test_links_of_random_polygons_are_whole(seed: int, n: int, m: int) -> None:
    """Lk is an integer, and changes sign with the direction of one curve."""
    x, y = random_polygon(seed, n), random_polygon(seed + 1, m)
    link = linking([x, y], True)[0, 1]
    assert link == pytest.approx(round(link), abs=1e-9)
    assert linking([x, y[::-1]], True)[0, 1] == pytest.approx(-link, abs=1e-9)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_link_changes_only_where_a_strand_passes(seed: int) -> None:
    """A random polygon is moved in small steps through another: between steps nothing passes, or one does."""
    x, y = random_polygon(seed, 8), random_polygon(seed + 1, 8)
    path = np.linspace(0, 8, 41)[:, None] * random_directions(seed, 1)
    assume(abs(linking([x, y + path[0]], True)[0, 1]) < 100)
    for before, after in itertools.pairwise(path):
        jump = linking([x, y + after], True)[0, 1] - linking([x, y + before], True)[0, 1]
        swept = swept_crossings(x, y + before, after - before)
        assert jump == pytest.approx(swept, abs=1e-9)
    assert linking([x, y + path[-1]], True)[0, 1] == pytest.approx(0, abs=1e-9)


def swept_crossings(x: Floats, y: Floats, move: Floats) -> float:
    """Sum of signs of passages of the edges of y, moved, through the edges of x."""
    total = 0.0
    for p, e in zip(x, np.roll(x, -1, axis=0) - x, strict=True):
        for q, f in zip(y, np.roll(y, -1, axis=0) - y, strict=True):
            # p + s e = q + u f + t move
            volume = np.linalg.det(np.stack([e, -f, -move]))
            s, u, t = np.linalg.solve(np.stack([e, -f, -move], axis=1), q - p)
            if 0 < s < 1 and 0 < u < 1 and 0 < t < 1:
                total -= np.sign(volume)
    return total


def test_a_ring_pulled_off_another() -> None:
    """Lk stays while the ring moves freely and jumps by one when it is through."""
    x, y = hopf_link(40)
    moves = [np.array([s, 0.0, 0.0]) for s in (-0.9, -0.5, 0.3, 0.9, 1.1, 2.0)]
    links = [linking([x, y + move], True)[0, 1] for move in moves]
    assert links == pytest.approx([-1, -1, -1, -1, 0, 0], abs=1e-12)


# --- the mean over projections


@pytest.mark.parametrize(
    ("curves", "closed"),
    [
        ([random_polygon(4, 12)], True),
        ([random_polygon(5, 10)], False),
        ([torus_knot(2, 3, 30)], True),
        ([random_polygon(6, 6), random_polygon(7, 7)], [True, False]),
    ],
)
def test_writhe_is_the_mean_over_projections(curves: list[Floats], closed: Any) -> None:
    """Thesis (4.18), within 3 standard errors of the mean; and the like for the number of crossings."""
    views = random_directions(1, 1500)
    signed = np.array([directional_writhe(curves, closed, v) for v in views])
    unsigned = np.array([directional_crossing_number(curves, closed, v) for v in views])
    for seen, exact in (
        (signed, writhe(curves, closed)),
        (unsigned, average_crossing_number(curves, closed)),
    ):
        error = seen.std(ddof=1) / math.sqrt(len(views))
        assert 0 < error < 0.2
        assert abs(seen.mean() - exact) < 3 * error


# --- order, threads, size


def test_bits_do_not_depend_on_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    x = random_loop(1, 1501)
    monkeypatch.setattr(measures, "WORTH_THREADS", 0)
    one = writhe(x, True, threads=1), writhe_density(x, True, threads=1), average_crossing_number(x, True, 1)
    for threads in (2, 3, 7):
        assert writhe(x, True, threads=threads) == one[0]
        assert np.array_equal(writhe_density(x, True, threads=threads), one[1])
        assert average_crossing_number(x, True, threads) == one[2]


def test_density_is_that_of_every_place() -> None:
    """A trefoil has three equal lobes: so has its density, which sums to the writhe."""
    density = writhe_density(torus_knot(2, 3, 300), True)
    assert density == pytest.approx(np.roll(density, 100), abs=1e-12)
    assert density.sum() == pytest.approx(writhe(torus_knot(2, 3, 300), True), abs=1e-12)


@pytest.mark.slow
def test_ten_thousand_nodes() -> None:
    """The polygon of 10,000 nodes is nearer to the smooth trefoil than to seven digits of its writhe."""
    assert writhe(torus_knot(2, 3, 10_000), True) == pytest.approx(-3.51823923, abs=1e-6)


def test_curve_frames_agree() -> None:
    """Fuller: a frame that does not turn comes back turned by 2 pi Wr."""
    x = random_loop(2, 80)
    turned = curve.rotation_minimising_frames(x, closed=True).holonomy
    assert np.exp(1j * turned) == pytest.approx(np.exp(2j * np.pi * writhe(x, True)), abs=1e-9)
