"""Kernels of tightening: what touches, what bends too sharply, and the linear systems of Newton's method.

All lengths are in units of the target radius. A closed strand is a control polygon: the quadratic B-spline of
its nodes touches every edge at its middle. On it lie two samples a node, the middle of the edge before and the
point nearest to the node. Constraints are rows: a gap that is positive when the constraint is broken, and its
derivative, which node row.node[k, m] moves by row.share[k, m] along row.direction[k].
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Bools, Floats, Index, Ints
from torsade.rod.neighbours import NONE, near_points

SLOTS = 6
"""Nodes that a constraint depends on: three for each of two samples."""


class Loops(NamedTuple):
    """Closed strands as one list of nodes: neighbours before and after (n,), strand (n,) and its size (n,)."""

    before: Ints
    after: Ints
    strand: Ints
    size: Ints


class Rows(NamedTuple):
    """Linearised constraints: node, share (m, SLOTS), direction (m, 3), gap, weight (m,); contacts come first."""

    node: Ints
    share: Floats
    direction: Floats
    gap: Floats
    weight: Floats


class Matrix(NamedTuple):
    """A symmetric matrix of 3 x 3 blocks in compressed columns; place (n, n) is a block's number in its column."""

    place: Ints
    count: Ints
    start: Ints
    row: Ints
    value: Floats


def samples(x: Floats, loops: Loops, p: Floats) -> None:
    """Points of the B-spline, two a node, into p (2n, 3): where it touches the edge before, and mid-piece."""
    before, after = loops.before, loops.after
    for i in range(x.shape[0]):
        for c in range(3):
            p[2 * i, c] = 0.5 * (x[before[i], c] + x[i, c])
            p[2 * i + 1, c] = 0.125 * (x[before[i], c] + 6.0 * x[i, c] + x[after[i], c])


def touching(p: Floats, loops: Loops, reach: float, apart: Index) -> Ints:
    """Pairs of samples nearer than reach, those of one strand only if more than apart samples lie between."""
    strand, size = loops.strand, loops.size
    pairs = near_points(p, reach)
    kept = NONE
    for k in range(pairs.shape[0]):
        a, b = pairs[k, 0], pairs[k, 1]
        i, j = a // 2, b // 2
        between = b - a
        far = strand[i] != strand[j] or min(between, 2 * size[i] - between) > apart
        if far:
            pairs[kept, 0] = a
            pairs[kept, 1] = b
            kept += 1
    return pairs[:kept]


def contact_energy(p: Floats, pairs: Ints) -> float:
    """Half the sum of squared overlaps of the pairs."""
    total = 0.0
    for k in range(pairs.shape[0]):
        a, b = pairs[k, 0], pairs[k, 1]
        squared = 0.0
        for c in range(3):
            squared += (p[a, c] - p[b, c]) ** 2
        if squared < 4.0:
            total += 0.5 * (2.0 - math.sqrt(squared)) ** 2
    return total


def bends(x: Floats, loops: Loops, edge: Floats, kappa: Floats) -> None:
    """By how much nodes are bent beyond curvature one, into kappa (n,): |second difference| over edge^2.

    edge (n,) is the mean edge of each node's strand, held fixed. An arc of radius one that touches two edges
    at their middles has the second difference edge^2/sqrt(1 + edge^2/4).
    """
    before, after = loops.before, loops.after
    for i in range(x.shape[0]):
        squared = 0.0
        for c in range(3):
            squared += (x[before[i], c] - 2.0 * x[i, c] + x[after[i], c]) ** 2
        l = edge[i] * edge[i]
        kappa[i] = math.sqrt(squared) / l - 1.0 / math.sqrt(1.0 + 0.25 * l)


def contact_rows(p: Floats, pairs: Ints, loops: Loops, weight: float, rows: Rows) -> None:
    """Fill the first rows, one for each pair of samples."""
    before, after = loops.before, loops.after
    node, share, direction, gap = rows.node, rows.share, rows.direction, rows.gap
    for k in range(pairs.shape[0]):
        squared = 0.0
        for c in range(3):
            direction[k, c] = p[pairs[k, 0], c] - p[pairs[k, 1], c]
            squared += direction[k, c] ** 2
        d = math.sqrt(squared)
        for c in range(3):
            direction[k, c] /= d
        gap[k] = 2.0 - d
        rows.weight[k] = weight
        for side in range(2):
            sign = 1.0 - 2.0 * side
            i = pairs[k, side] // 2
            middle = pairs[k, side] % 2 == 1
            node[k, 3 * side] = before[i]
            node[k, 3 * side + 1] = i
            node[k, 3 * side + 2] = after[i]
            share[k, 3 * side] = sign * (0.125 if middle else 0.5)
            share[k, 3 * side + 1] = sign * (0.75 if middle else 0.5)
            share[k, 3 * side + 2] = sign * (0.125 if middle else 0.0)


def bend_rows(
    x: Floats, loops: Loops, edge: Floats, kappa: Floats, margin: float, weight: float, first: Index, rows: Rows
) -> int:
    """Fill rows from first on, one for each node bent to within margin of curvature one; returns their end."""
    before, after = loops.before, loops.after
    node, share, direction = rows.node, rows.share, rows.direction
    k = first
    for i in range(x.shape[0]):
        if kappa[i] < -margin:
            continue
        squared = 0.0
        for c in range(3):
            direction[k, c] = x[before[i], c] - 2.0 * x[i, c] + x[after[i], c]
            squared += direction[k, c] ** 2
        for c in range(3):
            direction[k, c] /= math.sqrt(squared)
        for m in range(SLOTS):
            node[k, m] = i
            share[k, m] = 0.0
        node[k, 0], node[k, 2] = before[i], after[i]
        share[k, 0] = share[k, 2] = -1.0 / edge[i] ** 2
        share[k, 1] = 2.0 / edge[i] ** 2
        rows.gap[k] = kappa[i]
        rows.weight[k] = weight
        k += 1
    return k


def derivative(rows: Rows, d: Floats, out: Floats) -> None:
    """How fast gaps close when nodes move by d (n, 3), into out (m,)."""
    node, share, direction = rows.node, rows.share, rows.direction
    for k in range(out.shape[0]):
        total = 0.0
        for m in range(SLOTS):
            for c in range(3):
                total += share[k, m] * direction[k, c] * d[node[k, m], c]
        out[k] = total


def push(rows: Rows, force: Floats, out: Floats) -> None:
    """Add to out (n, 3) the forces of the constraints on nodes, force (m,) at each."""
    node, share, direction = rows.node, rows.share, rows.direction
    for k in range(force.shape[0]):
        if force[k] != 0.0:
            for m in range(SLOTS):
                for c in range(3):
                    out[node[k, m], c] += force[k] * share[k, m] * direction[k, c]


def mark(loops: Loops, rows: Rows, place: Ints) -> None:
    """Number the blocks of every column of the matrix, from 0 in the order of rows; place is -1 elsewhere."""
    after, node = loops.after, rows.node
    n = place.shape[0]
    for i in range(n):
        for j in range(n):
            place[i, j] = -1
    for i in range(n):
        j = after[i]
        place[i, i] = place[i, j] = place[j, i] = 0
    for k in range(node.shape[0]):
        for a in range(SLOTS):
            for b in range(SLOTS):
                place[node[k, a], node[k, b]] = 0
    for j in range(n):
        count = 0
        for i in range(n):
            if place[j, i] == 0:  # symmetric: read along the row, which lies together in memory
                place[j, i] = count
                count += 1


def columns(place: Ints, start: Ints, row: Ints) -> None:
    """Compressed columns of the marked blocks: start (3n + 1,), row (entries,)."""
    n = place.shape[0]
    at = 0
    start[0] = 0
    for j in range(n):
        for c in range(3):
            for i in range(n):
                if place[j, i] >= 0:
                    for r in range(3):
                        row[at] = 3 * i + r
                        at += 1
            start[3 * j + c + 1] = at


def _add(place: Ints, start: Ints, value: Floats, i: Index, j: Index, r: Index, c: Index, amount: float) -> None:
    value[start[3 * j + c] + 3 * place[j, i] + r] += amount


def tension_matrix(
    x: Floats, loops: Loops, edge: Floats, spacing: float, shift: float, place: Ints, start: Ints, value: Floats
) -> None:
    """Second derivatives of length and of spacing, and shift on the diagonal, into value.

    Length of an edge of tangent t: (1 - t t)/l; spacing stiffness: spacing t t/edge.
    """
    after = loops.after
    n = x.shape[0]
    t = np.empty(3)
    for k in range(value.shape[0]):
        value[k] = 0.0
    for i in range(n):
        j = after[i]
        squared = 0.0
        for c in range(3):
            t[c] = x[j, c] - x[i, c]
            squared += t[c] ** 2
        l = math.sqrt(squared)
        for r in range(3):
            _add(place, start, value, i, i, r, r, shift)
            for c in range(3):
                amount = (spacing / edge[i] - 1.0 / l) * t[r] * t[c] / squared + (1.0 / l if r == c else 0.0)
                _add(place, start, value, i, i, r, c, amount)
                _add(place, start, value, j, j, r, c, amount)
                _add(place, start, value, i, j, r, c, -amount)
                _add(place, start, value, j, i, r, c, -amount)


def constraint_matrix(rows: Rows, active: Bools, place: Ints, start: Ints, value: Floats) -> None:
    """Add the stiffness of the active rows."""
    node, share, direction, weight = rows.node, rows.share, rows.direction, rows.weight
    for k in range(active.shape[0]):
        if not active[k]:
            continue
        for a in range(SLOTS):
            for b in range(SLOTS):
                s = weight[k] * share[k, a] * share[k, b]
                if s != 0.0:
                    for r in range(3):
                        for c in range(3):
                            amount = s * direction[k, r] * direction[k, c]
                            _add(place, start, value, node[k, a], node[k, b], r, c, amount)


def lowest_share(gap: Floats, rate: Floats, weight: Floats, slope: float, curve: float) -> float:
    """Where in [0, 1] slope a + curve a^2/2 + sum weight max(0, gap - a rate)^2/2 is lowest; it is convex."""
    low, high = 0.0, 1.0
    a = 1.0
    for _ in range(40):
        total = slope + a * curve
        for k in range(gap.shape[0]):
            left = gap[k] - a * rate[k]
            if left > 0.0:
                total -= weight[k] * left * rate[k]
        if total > 0.0:
            high = a
        elif a == 1.0:
            return 1.0
        else:
            low = a
        a = 0.5 * (low + high)
    return a


compile_kernels(__name__, inline=("_add",), owning=("touching", "tension_matrix"))
