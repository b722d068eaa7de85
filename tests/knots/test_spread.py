"""Spreading: nothing passes through, mirror images stay mirror images, and the linear algebra."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from torsade.knots.band import solve_band
from torsade.knots.lift import lifted
from torsade.knots.spread import LARGEST_MOVE, NEAREST, Laws, Strands, room_to_move, spread
from torsade.segments import segment_distance
from torsade.topology import named_diagram
from torsade.topology.measures import linking

FloatArray = NDArray[np.float64]

LAWS = Laws(tension=1.0, stiffness=1.0, hard_stiffness=100.0, springs=20.0, distance=2.25, bend_radius=2.4)


def strands_of(curves: list[FloatArray], closed: bool = True) -> Strands:
    first = np.concatenate([[0], np.cumsum([len(x) for x in curves])]).astype(np.int64)
    number = np.repeat(np.arange(len(curves)), np.diff(first))
    held = np.zeros(first[-1], dtype=np.bool_)
    if not closed:
        held[[*first[:-1], *(first[1:] - 1)]] = True
    return Strands(first, np.full(len(curves), closed), number, held)


def start(name: str) -> tuple[Strands, FloatArray]:
    diagram = named_diagram(name)
    curves = lifted(diagram, list(range(diagram.n_strands)), {})
    return strands_of(curves), np.concatenate(curves)


def edges(s: Strands) -> NDArray[np.int64]:
    """Nodes of all edges of closed strands, shape (n, 2)."""
    rows = []
    for a, b in zip(s.first[:-1], s.first[1:], strict=True):
        nodes = np.arange(a, b)
        rows.append(np.column_stack([nodes, np.roll(nodes, -1)]))
    return np.concatenate(rows)


def distances(s: Strands, x: FloatArray) -> tuple[NDArray[np.int64], NDArray[np.int64], FloatArray]:
    """Pairs of edges that share no node, and how far apart they are."""
    e = edges(s)
    i, j = np.triu_indices(len(e), k=1)
    apart = (e[i][:, :, None] != e[j][:, None, :]).all(axis=(1, 2))
    i, j = i[apart], j[apart]
    return i, j, segment_distance(x[e[i, 0]], x[e[i, 1]], x[e[j, 0]], x[e[j, 1]])


@pytest.mark.parametrize("name", ["4_1", "8_19", "L6a4"])
def test_nothing_passes_through(name: str) -> None:
    """In every step any two edges that share no node approach each other by less than their distance."""
    s, x = start(name)
    e = edges(s)
    nearest = np.inf
    for step in range(120):
        laws = LAWS if step > 20 else LAWS._replace(tension=0.0)
        i, j, apart = distances(s, x)
        before = x.copy()
        spread(laws, s, x, 1, 0.0)
        moved = np.linalg.norm(x - before, axis=1)
        assert moved.max() <= LARGEST_MOVE
        of_edge = moved[e].max(axis=1)
        assert np.all(of_edge[i] + of_edge[j] < apart)
        nearest = min(nearest, float(((apart - of_edge[i] - of_edge[j]) / apart).min()))
    assert nearest < 0.5  # the bound was put to the test


def test_room_is_less_than_half_of_every_distance() -> None:
    """Against all pairs, on a tangled random loop."""
    x = np.random.default_rng(3).normal(size=(60, 3)) * 2
    s = strands_of([x])
    i, j, apart = distances(s, x)
    a, b = np.triu_indices(60, k=1)
    room = np.empty(60)
    room_to_move(s, x, np.column_stack([a, b]), room)
    e = edges(s)
    least = np.full(60, np.inf)
    for two in (e[i], e[j]):
        for k in range(2):
            np.minimum.at(least, two[:, k], apart)
    assert np.all(room < least / 2)
    np.testing.assert_allclose(room, np.minimum(LARGEST_MOVE, 0.45 * (least - NEAREST)), rtol=1e-9)


def test_linking_numbers_stay() -> None:
    s, x = start("L8n1")
    before = np.array(linking(np.split(x, s.first[1:-1]), closed=True))
    spread(LAWS, s, x, 400, 1e-4)
    after = np.array(linking(np.split(x, s.first[1:-1]), closed=True))
    np.testing.assert_allclose(after, before, atol=1e-9)
    assert np.abs(before - np.diag(np.diag(before))).max() > 0.9


def test_a_mirror_image_stays_one_and_results_repeat() -> None:
    s, x = start("7_6")
    y, z = x * [1.0, 1.0, -1.0], x.copy()
    counts = [spread(LAWS, s, nodes, 300, 1e-4) for nodes in (x, y, z)]
    assert len(set(counts)) == 1
    np.testing.assert_array_equal(x, y * [1.0, 1.0, -1.0])
    np.testing.assert_array_equal(x, z)


def test_a_loop_becomes_a_circle_of_the_radius_allowed() -> None:
    angle = 2 * np.pi * np.arange(40) / 40
    x = np.column_stack([9 * np.cos(angle), 5 * np.sin(angle), np.sin(2 * angle)])
    spread(LAWS, strands_of([x]), x, 4000, 1e-6)
    r = np.linalg.norm(x - x.mean(axis=0), axis=1)
    np.testing.assert_allclose(r, r.mean(), rtol=0.02)
    assert 0.8 * LAWS.bend_radius < r.mean() < LAWS.bend_radius


@pytest.mark.parametrize(("n", "closed"), [(6, True), (17, True), (6, False), (17, False)])
def test_the_band_solver(n: int, closed: bool) -> None:
    """Against a dense solution; nodes before and after are left alone."""
    rng = np.random.default_rng(n)
    pad = 2
    size = n + 2 * pad
    next1, next2 = rng.normal(size=size), rng.normal(size=size)
    if not closed:
        next1[pad + n - 1] = next2[pad + n - 2] = next2[pad + n - 1] = 0.0
    diagonal = 6 + rng.random(size)
    matrix = np.diag(diagonal[pad : pad + n])
    for k, coupling in ((1, next1), (2, next2)):
        for i in range(n):
            j = (i + k) % n
            matrix[i, j] += coupling[pad + i]
            matrix[j, i] += coupling[pad + i]
    y = rng.normal(size=(size, 3))
    given = y.copy()
    solve_band(pad, pad + n, diagonal, next1, next2, np.empty(size), np.empty(size), y)
    np.testing.assert_allclose(y[pad : pad + n], np.linalg.solve(matrix, given[pad : pad + n]), rtol=1e-10)
    np.testing.assert_array_equal(y[:pad], given[:pad])
    np.testing.assert_array_equal(y[pad + n :], given[pad + n :])
