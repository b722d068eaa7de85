"""No strand passes through another: what a step may do, and how close strands are."""

from __future__ import annotations

import math

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Index, Ints
from torsade.assembly import Assembly
from torsade.rod.distance import segment_distance


def largest_move(x0: Floats, x1: Floats) -> float:
    """Largest distance [m] any node has moved between x0 and x1 (n_nodes, 3)."""
    largest = 0.0
    for i in range(x0.shape[0]):
        dx = x1[i, 0] - x0[i, 0]
        dy = x1[i, 1] - x0[i, 1]
        dz = x1[i, 2] - x0[i, 2]
        largest = max(largest, dx * dx + dy * dy + dz * dz)
    return math.sqrt(largest)


def _relative_move(x0: Floats, x1: Floats, i: Index, j: Index) -> float:
    """How far [m] node i moves as seen from node j, squared."""
    total = 0.0
    for c in range(3):
        d = x1[i, c] - x0[i, c] - x1[j, c] + x0[j, c]
        total += d * d
    return total


def passes_through(x0: Floats, x1: Floats, i0: Index, i1: Index, j0: Index, j1: Index, move: float) -> bool:
    """Whether the segments i0 i1 and j0 j1 may cross while nodes move straight from x0 to x1.

    Conservative: the distance shrinks by at most move [m] over the whole step, so an interval of the
    step is safe when the distance at its middle exceeds half its share. Intervals are halved up to
    2^-10 of the step; what is not safe by then, or nearer than 1e-9 of the edges, counts as a crossing.
    """
    points = np.empty((4, 3))
    k = 0
    depth = 0
    while True:
        middle = (k + 0.5) * 0.5**depth
        for n, node in enumerate((i0, i1, j0, j1)):
            for c in range(3):
                points[n, c] = (1.0 - middle) * x0[node, c] + middle * x1[node, c]
        size = 0.0
        for c in range(3):
            size += abs(points[1, c] - points[0, c]) + abs(points[3, c] - points[2, c])
        distance = segment_distance(points[0], points[1], points[2], points[3])
        if distance > 0.5 * move * 0.5**depth + 1e-9 * size:
            k += 1
            while k % 2 == 0 and depth > 0:
                k //= 2
                depth -= 1
            if depth == 0 and k == 1:
                return False
        elif depth == 10:
            return True
        else:
            k *= 2
            depth += 1


def first_crossing(
    a: Assembly,
    pairs: Ints,
    rows: Ints,
    count: Index,
    x0: Floats,
    x1: Floats,
    length: Floats,
    mid: Floats,
    largest: float,
) -> Index:
    """First of pairs[rows[:count]] of edges that pass through each other as nodes move from x0 to x1, or -1.

    Nodes move straight, by `largest` [m] at most. Edge lengths (n_edges,) and midpoints (n_edges, 3) at x0
    bound the distance from below, first with the largest move, then with that of the nodes at hand; only
    where that is not enough is the motion followed.
    """
    edges = a.edges
    for n in range(count):
        k = np.uintp(rows[n])
        e = np.uintp(pairs[k, 0])
        f = np.uintp(pairs[k, 1])
        dx = mid[f, 0] - mid[e, 0]
        dy = mid[f, 1] - mid[e, 1]
        dz = mid[f, 2] - mid[e, 2]
        squared = dx * dx + dy * dy + dz * dz
        half = 0.5 * (length[e] + length[f])
        safe = 2.0 * largest + half
        if squared > safe * safe:
            continue
        i0 = edges[e, 0]
        i1 = edges[e, 1]
        j0 = edges[f, 0]
        j1 = edges[f, 1]
        move = max(
            max(_relative_move(x0, x1, i0, j0), _relative_move(x0, x1, i0, j1)),
            max(_relative_move(x0, x1, i1, j0), _relative_move(x0, x1, i1, j1)),
        )
        move = math.sqrt(move)
        safe = move + half
        if squared <= safe * safe and passes_through(x0, x1, i0, i1, j0, j1, move):
            crossed: Index = rows[n]
            return crossed
    return -1


compile_kernels(__name__, inline=("_relative_move",), owning=("passes_through",))
