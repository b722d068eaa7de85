"""Kernels of tightening: what touches, what bends too sharply, and the linear systems of Newton's method.

All lengths are in units of the target radius. A closed strand is a control polygon: the quadratic B-spline of
its nodes touches every edge at its middle. On it lie two samples a node, the middle of the edge before and
the point nearest to the node. Constraints are rows: a gap that is positive when the constraint is broken, and
its
derivative: moving node row.node[k, m] along row.push[k, m] closes it.
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
    """Closed strands as one list of nodes: neighbours before and after (n,), strand (n,) and its size
    (n,)."""

    before: Ints
    after: Ints
    strand: Ints
    size: Ints


class Rows(NamedTuple):
    """Linearised constraints: node (m, SLOTS), push (m, SLOTS, 3), gap, weight (m,); contacts come first."""

    node: Ints
    push: Floats
    gap: Floats
    weight: Floats
    contacts: int


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
    """By how much nodes are bent beyond curvature one, into kappa (n,).

    Curvature is the second difference of nodes over the square of half their span. An arc of radius one that
    touches two edges of the same length at their middles has sqrt(1 + edge^2/4) of it; edge (n,) is the mean
    edge of each node's strand, held fixed.
    """
    before, after = loops.before, loops.after
    for i in range(x.shape[0]):
        second, span = 0.0, 0.0
        for c in range(3):
            second += (x[before[i], c] - 2.0 * x[i, c] + x[after[i], c]) ** 2
            span += (x[after[i], c] - x[before[i], c]) ** 2
        kappa[i] = 4.0 * math.sqrt(second) / span - math.sqrt(1.0 + 0.25 * edge[i] ** 2)


def contact_rows(p: Floats, pairs: Ints, loops: Loops, weight: float, rows: Rows) -> None:
    """Fill the first rows, one for each pair of samples."""
    before, after = loops.before, loops.after
    node, push, gap = rows.node, rows.push, rows.gap
    for k in range(pairs.shape[0]):
        squared = 0.0
        for c in range(3):
            squared += (p[pairs[k, 0], c] - p[pairs[k, 1], c]) ** 2
        d = math.sqrt(squared)
        gap[k] = 2.0 - d
        rows.weight[k] = weight
        for side in range(2):
            i = pairs[k, side] // 2
            middle = pairs[k, side] % 2 == 1
            m = 3 * side
            node[k, m], node[k, m + 1], node[k, m + 2] = before[i], i, after[i]
            for c in range(3):
                n = (1.0 - 2.0 * side) * (p[pairs[k, 0], c] - p[pairs[k, 1], c]) / d
                push[k, m, c] = (0.125 if middle else 0.5) * n
                push[k, m + 1, c] = (0.75 if middle else 0.5) * n
                push[k, m + 2, c] = (0.125 if middle else 0.0) * n


def bend_rows(
    x: Floats, loops: Loops, kappa: Floats, margin: float, weight: float, first: Index, rows: Rows
) -> Index:
    """Fill rows from first on, one for each node bent to within margin of curvature one; returns their
    end."""
    before, after = loops.before, loops.after
    node, push = rows.node, rows.push
    k = first
    for i in range(x.shape[0]):
        if kappa[i] < -margin:
            continue
        second, span = 0.0, 0.0
        for c in range(3):
            second += (x[before[i], c] - 2.0 * x[i, c] + x[after[i], c]) ** 2
            span += (x[after[i], c] - x[before[i], c]) ** 2
        second = math.sqrt(second)
        for m in range(SLOTS):
            node[k, m] = i
        node[k, 0], node[k, 2] = before[i], after[i]
        for c in range(3):
            bend = 4.0 * (x[before[i], c] - 2.0 * x[i, c] + x[after[i], c]) / (second * span)
            stretch = 8.0 * second * (x[after[i], c] - x[before[i], c]) / (span * span)
            push[k, 0, c] = -bend - stretch
            push[k, 1, c] = 2.0 * bend
            push[k, 2, c] = -bend + stretch
            for m in range(3, SLOTS):
                push[k, m, c] = 0.0
        rows.gap[k] = kappa[i]
        rows.weight[k] = weight
        k += 1
    return k


def derivative(rows: Rows, d: Floats, out: Floats) -> None:
    """How fast gaps close when nodes move by d (n, 3), into out (m,)."""
    node, push = rows.node, rows.push
    for k in range(out.shape[0]):
        total = 0.0
        for m in range(SLOTS):
            for c in range(3):
                total += push[k, m, c] * d[node[k, m], c]
        out[k] = total


def add_forces(rows: Rows, force: Floats, out: Floats) -> None:
    """Add to out (n, 3) the forces of the constraints on nodes, force (m,) at each."""
    node, push = rows.node, rows.push
    for k in range(force.shape[0]):
        if force[k] != 0.0:
            for m in range(SLOTS):
                for c in range(3):
                    out[node[k, m], c] += force[k] * push[k, m, c]


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


def _add(
    place: Ints, start: Ints, value: Floats, i: Index, j: Index, r: Index, c: Index, amount: float
) -> None:
    value[start[3 * j + c] + 3 * place[j, i] + r] += amount


def tension_matrix(
    x: Floats,
    loops: Loops,
    edge: Floats,
    spacing: float,
    shift: float,
    place: Ints,
    start: Ints,
    value: Floats,
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


def bend_matrix(
    x: Floats, loops: Loops, kappa: Floats, weight: float, place: Ints, start: Ints, value: Floats
) -> None:
    """Add what resists turning the second difference of a bent node: force (1 - u u)/size, u its direction.

    It is the part of second derivatives that belongs to the force of the constraint, of one sign.
    """
    before, after = loops.before, loops.after
    u = np.empty(3)
    for i in range(x.shape[0]):
        if kappa[i] <= 0.0:
            continue
        second, span = 0.0, 0.0
        for c in range(3):
            u[c] = x[before[i], c] - 2.0 * x[i, c] + x[after[i], c]
            second += u[c] ** 2
            span += (x[after[i], c] - x[before[i], c]) ** 2
        s = 4.0 * weight * kappa[i] / (span * math.sqrt(second))
        nodes = (before[i], i, after[i])
        shares = (1.0, -2.0, 1.0)
        for a in range(3):
            for b in range(3):
                for r in range(3):
                    for c in range(3):
                        amount = s * shares[a] * shares[b] * ((1.0 if r == c else 0.0) - u[r] * u[c] / second)
                        _add(place, start, value, nodes[a], nodes[b], r, c, amount)


def constraint_matrix(rows: Rows, active: Bools, place: Ints, start: Ints, value: Floats) -> None:
    """Add the stiffness of the active rows."""
    node, push, weight = rows.node, rows.push, rows.weight
    slots = SLOTS
    for k in range(active.shape[0]):
        if not active[k]:
            continue
        if k >= rows.contacts:
            slots = 3
        for b in range(slots):
            for c in range(3):
                s = weight[k] * push[k, b, c]
                if s == 0.0:
                    continue
                column = start[3 * node[k, b] + c]
                for a in range(slots):
                    at = column + 3 * place[node[k, b], node[k, a]]
                    for r in range(3):
                        value[at + r] += s * push[k, a, r]


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


compile_kernels(__name__, inline=("_add",), owning=("touching", "tension_matrix", "bend_matrix"))
