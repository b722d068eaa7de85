"""Shrinking closed strands around their own thickness: Newton's method on length and stiff constraints.

In units of the target radius, strands are nodes x (n, 3) of control polygons (`tight_kernels`), and what is
made smallest is

    sum of edges + spacing/2 sum (edge - mean)^2/mean + weight/2 sum (overlap)^2 + bending/2 sum (excess)^2:

length, nodes evenly spread, samples of the B-spline that are nearer than two radii, and nodes bent beyond
curvature one. Overlaps are of the order of 1/stiffness, and what is reported is measured afterwards, with all
of them in it. Each step solves the quadratic program of the linearised constraints by active sets: a few
sparse factorisations. The motion of a step is far smaller than the distance of strands, so that none pass
through another.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from torsade.arrays import Bools, Floats, Ints
from torsade.knots import tight_kernels as kernels
from torsade.knots.tight_kernels import Loops, Rows

__all__ = ["Relaxed", "Settings", "loops_of", "relax"]

EXCLUDED = 3.2
"""Samples of a strand with less than so much fiber [radii] between them do not touch: bent no more than by
curvature one, they would need pi at least."""

SPACING = 5.0
"""Stiffness that keeps edges equal, in units of the tension."""

BENDING = 0.8
"""Stiffness against sharp bends, in units of that against overlaps."""

SHIFT = 1e-3
"""Added to the diagonal, so that motion as a whole is determined."""

SAFE = 0.4
"""Longest step, in distances of the nearest strands: two that come towards each other cannot meet."""

HALVINGS = 6
"""Of a step that does not lower the energy."""


class Settings(NamedTuple):
    """How to relax: stiffness of the constraints, longest step [radii], iterations, the residual to reach,
    and how often the active set may change in one step."""

    stiffness: float
    step: float
    iterations: int
    tolerance: float
    changes: int = 12


class Relaxed(NamedTuple):
    """Nodes x (n, 3), the energy there, the residual force per force of tension, and the steps taken.

    contacts (m, 2) are nodes that push each other apart, with forces (m,) in units of the tension; kinks are
    nodes that are bent as sharply as the radius allows.
    """

    x: Floats
    energy: float
    residual: float
    iterations: int
    contacts: Ints
    forces: Floats
    kinks: Ints


class _Scales(NamedTuple):
    """What is held fixed during a step: mean edge of each node's strand (n,), and the stiffnesses of rows."""

    edge: Floats
    contact: float
    bend: float
    apart: int


def loops_of(sizes: Ints) -> Loops:
    """Closed strands of so many nodes each."""
    first = np.repeat(np.cumsum(sizes) - sizes, sizes)
    size = np.repeat(sizes, sizes)
    k = np.arange(len(first)) - first
    return Loops(
        first + (k - 1) % size, first + (k + 1) % size, np.repeat(np.arange(len(sizes)), sizes), size
    )


def relax(x: Floats, loops: Loops, how: Settings) -> Relaxed:
    """Take Newton steps until the residual is reached, nothing gets better, or so many are taken."""
    taken = 0
    while True:
        scales = _scales(x, loops, how.stiffness)
        p, kappa = _sampled(x, loops, scales)
        margin = 0.2 * float(scales.edge.mean())
        rows = _rows(x, p, kappa, loops, scales, margin)
        tension, length_force = _tension(x, loops, scales)
        overlap = rows.weight * np.maximum(rows.gap, 0.0)
        net = tension.copy()
        kernels.add_forces(rows, overlap, net)
        residual = float(np.linalg.norm(net) / np.linalg.norm(length_force))
        energy = _energy(x, loops, scales)
        if residual < how.tolerance or taken == how.iterations:
            break
        d = _step(x, loops, kappa, scales, rows, tension, how.changes)
        nearest = 2.0 - float(rows.gap[: rows.contacts].max(initial=0.0))
        longest = min(how.step, SAFE * nearest)
        share = min(1.0, longest / float(np.sqrt((d * d).sum(axis=1).max())))
        fall = float((net * d).sum())
        for _ in range(HALVINGS):
            lower = _energy(x + share * d, loops, scales) <= energy - 1e-4 * share * fall
            if lower:
                break
            share /= 2
        if not lower:
            break
        x = x + share * d
        taken += 1
    return Relaxed(x, energy, residual, taken, *_touches(rows))


def _touches(rows: Rows) -> tuple[Ints, Floats, Ints]:
    """Pairs of nodes in contact, the forces between them, and kinks."""
    m = rows.contacts
    on = rows.gap > 0
    pairs, place = np.unique(rows.node[:m][on[:m]][:, [1, 4]], axis=0, return_inverse=True)
    forces = np.zeros(len(pairs))
    np.add.at(forces, place, (rows.weight * rows.gap)[:m][on[:m]])
    return pairs, forces, rows.node[m:, 1][on[m:]]


def _scales(x: Floats, loops: Loops, stiffness: float) -> _Scales:
    l = np.sqrt(((x[loops.after] - x) ** 2).sum(axis=1))
    edge = (np.bincount(loops.strand, l) / np.bincount(loops.strand))[loops.strand]
    mean = float(l.mean())
    apart = int(np.ceil(2 * EXCLUDED / mean))
    return _Scales(edge, stiffness * mean / 4, BENDING * stiffness * mean / 4, apart)


def _sampled(x: Floats, loops: Loops, scales: _Scales) -> tuple[Floats, Floats]:
    p, kappa = np.empty((2 * len(x), 3)), np.empty(len(x))
    kernels.samples(x, loops, p)
    kernels.bends(x, loops, scales.edge, kappa)
    return p, kappa


def _energy(x: Floats, loops: Loops, scales: _Scales) -> float:
    p, kappa = _sampled(x, loops, scales)
    pairs = kernels.touching(p, loops, 2.0, scales.apart)
    l = np.sqrt(((x[loops.after] - x) ** 2).sum(axis=1))
    mean = (np.bincount(loops.strand, l) / np.bincount(loops.strand))[loops.strand]
    excess = np.maximum(kappa, 0.0)
    return float(
        l.sum()
        + SPACING / 2 * ((l - mean) ** 2 / scales.edge).sum()
        + scales.contact * kernels.contact_energy(p, pairs)
        + scales.bend / 2 * (excess * excess).sum()
    )


def _tension(x: Floats, loops: Loops, scales: _Scales) -> tuple[Floats, Floats]:
    """Forces (n, 3) of length and spacing together, and of length alone."""
    e = x[loops.after] - x
    l = np.sqrt((e * e).sum(axis=1))
    t = e / l[:, None]
    pull = (1 + SPACING * (l / scales.edge - 1))[:, None] * t
    return pull - pull[loops.before], t - t[loops.before]


def _rows(x: Floats, p: Floats, kappa: Floats, loops: Loops, scales: _Scales, margin: float) -> Rows:
    """Constraints broken, or nearly so."""
    pairs = kernels.touching(p, loops, 2.0 + margin, scales.apart)
    near = float(min(0.5, 5 * margin))
    m = len(pairs) + int((kappa >= -near).sum())
    rows = Rows(
        np.empty((m, kernels.SLOTS), np.int64), np.empty((m, kernels.SLOTS, 3)), np.empty(m), np.empty(m),
        len(pairs),
    )  # fmt: skip
    kernels.contact_rows(p, pairs, loops, scales.contact, rows)
    kernels.bend_rows(x, loops, kappa, near, scales.bend, len(pairs), rows)
    return rows


def _step(
    x: Floats, loops: Loops, kappa: Floats, scales: _Scales, rows: Rows, tension: Floats, changes: int
) -> Floats:
    """The displacement (n, 3) that solves the quadratic program, by changing active sets."""
    n = len(x)
    place = np.empty((n, n), np.int64)
    kernels.mark(loops, rows, place)
    start = np.empty(3 * n + 1, np.int64)
    row = np.empty(9 * int((place >= 0).sum()), np.int64)
    kernels.columns(place, start, row)
    plain, value = np.empty(len(row)), np.empty(len(row))
    kernels.tension_matrix(x, loops, scales.edge, SPACING, SHIFT, place, start, plain)
    kernels.bend_matrix(x, loops, kappa, scales.bend, place, start, plain)
    d, rate, towards = np.zeros((n, 3)), np.zeros(len(rows.gap)), np.empty(len(rows.gap))
    active = rows.gap > 0
    matrix = csc_array((value, row.astype(np.int32), start.astype(np.int32)), shape=(3 * n, 3 * n))
    stiff = csc_array((plain, matrix.indices, matrix.indptr), shape=matrix.shape)
    for _ in range(changes):
        matrix.data[:] = plain
        kernels.constraint_matrix(rows, active, place, start, matrix.data)
        force = tension.copy()
        kernels.add_forces(rows, np.where(active, rows.weight * rows.gap, 0.0), force)
        change = _solve(matrix, force) - d
        kernels.derivative(rows, change, towards)
        stiffened = np.asarray(stiff @ change.ravel()).reshape(n, 3)
        slope = float((d * stiffened).sum() - (tension * change).sum())
        curve = float((change * stiffened).sum())
        share = kernels.lowest_share(rows.gap - rate, towards, rows.weight, slope, curve)
        d += share * change
        rate += share * towards
        now: Bools = rows.gap - rate > 0
        if np.array_equal(now, active):
            break
        active = now
    return d


def _solve(matrix: csc_array, force: Floats) -> Floats:
    factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return np.asarray(factors.solve(force.ravel()).reshape(-1, 3))
