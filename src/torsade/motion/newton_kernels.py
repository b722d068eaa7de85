"""Newton's method on a chain, at given controls and along a branch, as one compiled loop."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Floats
from torsade.motion.chain import Chain
from torsade.motion.lagrangian import (
    Controls,
    Shape,
    System,
    by_path,
    lift,
    lower,
    moved,
    system,
    towards,
)
from torsade.rod.banded import condense, solve_bordered

TOLERANCE, ROUND_OFF = 1e-10, 1e-7
"""Out-of-balance force, in units of those that act, at which a shape is at equilibrium: below the first, or
below the second when it falls no further."""

GAPS = 1e3
"""How much more exact gaps are, in units of L: ends near a fiber's length apart say its slope squared."""

LARGEST_RADIUS = 1.0
"""Longest step, as the root mean square of the angle that edges turn by [rad]."""

MOST_STEPS, MOST_CORRECTIONS = 12, 8
"""At given controls, and along a branch."""

REFINEMENTS = 2


class Tangent(NamedTuple):
    """Direction of a branch: change of edges and angles (n_edges, 4), of multipliers (k,) and of p."""

    change: Floats
    multipliers: Floats
    p: float


class Way(NamedTuple):
    """Controls along a path, and what is looked for on it.

    Attributes
    ----------
    start, rate : controls at p = 0, and how they change with p
    size : how far controls change from p = 0 to 1
    free : whether p is unknown, in the plane across a direction, or given
    onwards : whether the direction of the branch is wanted where it is met
    """

    start: Controls
    rate: Controls
    size: float
    free: bool
    onwards: bool


def imbalance(chain: Chain, shape: Shape, controls: Controls, here: System) -> float:
    """What is out of balance: forces in units of those that act and B/L^2, gaps in units of L and radians."""
    L = chain.twisted_length
    acting = 0.0
    for force in controls.load:
        acting = max(acting, largest(force))
    unit = largest(shape.reaction) + acting + abs(shape.torque) / L + chain.B / L**2
    off = norm(here.residual) / math.sqrt(L) / unit
    if not math.isfinite(off):
        return off
    for i in range(len(here.gap)):
        off = max(off, GAPS * abs(here.gap[i]) / (L if i < len(chain.weight) else 1.0))
    return off


def largest(values: Floats) -> float:
    """Largest size of values (n,), and 0 of none."""
    found = 0.0
    for value in values:
        found = max(found, abs(value))
    return found


def norm(values: Floats) -> float:
    """Euclidean norm of values (n,)."""
    squares = 0.0
    for value in values:
        squares += value * value
    return math.sqrt(squares)


def settled(off: float, before: float) -> bool:
    """Whether an imbalance is none, after the one before it."""
    return off < TOLERANCE or (0.5 * before < off < ROUND_OFF and before < ROUND_OFF)


def step(chain: Chain, shape: Shape, change: Floats, ds: Floats) -> Shape:
    """The shape after a change (n_edges, 4) of its edges and angles and one of multipliers (k,)."""
    after, reaction = moved(chain, shape, change), shape.reaction.copy()
    for i in range(len(reaction)):
        reaction[i] += ds[i]
    torque = shape.torque + ds[len(reaction)] if chain.rotation_held else shape.torque
    return Shape(after.edge, after.theta, after.reference_twist, reaction, torque)


def newton(
    chain: Chain, way: Way, shape: Shape, p: float, along: Tangent, length: float, still: Floats, most: int
) -> tuple[int, float, Shape, System, Tangent]:
    """Newton's method on a path, from a shape at share p moved by a length along a direction.

    still (m, n_edges, 4) are motions that the way there does without, at given p; most is how many shapes are
    looked at. Returns how many corrections it took, or -1 when there is no point, and p, shape, system and
    direction of the point.
    """
    L, before = chain.twisted_length, math.inf
    change, ds = np.empty_like(along.change), np.empty_like(along.multipliers)
    for e in range(len(change)):
        for c in range(4):
            change[e, c] = length * along.change[e, c]
    for i in range(len(ds)):
        ds[i] = length * along.multipliers[i]
    dp = length * along.p if way.free else 0.0
    for corrections in range(most):
        p += dp
        controls = towards(way.start, way.rate, p)
        shape = step(chain, shape, change, ds)
        if not chain.rotation_held:
            shape = Shape(shape.edge, shape.theta, shape.reference_twist, shape.reaction, controls.torque)
        here = system(chain, shape, controls)
        off = imbalance(chain, shape, controls, here)
        done = settled(off, before)
        if done and not way.onwards:
            return corrections, p, shape, here, along
        if not math.isfinite(off) or off > 1e3 * max(before, 1.0):
            break
        dq, ds, regular = _solved(chain, way, shape, here, along, still, done)
        turned = norm(dq) / math.sqrt(L)
        change = lift(here.basis, dq)
        dp = ds[len(here.gap)] if way.free or done else 0.0
        if done:
            size = math.hypot(turned, way.size * dp)
            multipliers = np.empty_like(here.gap)
            for i in range(len(multipliers)):
                multipliers[i] = ds[i] / size
            for e in range(len(change)):
                for c in range(4):
                    change[e, c] /= size
            met = regular and math.isfinite(dp / size)
            return corrections if met else -1, p, shape, here, Tangent(change, multipliers, dp / size)
        if not regular or not turned <= LARGEST_RADIUS:
            break
        before = off
    return -1, p, shape, here, along


def _solved(
    chain: Chain, way: Way, shape: Shape, here: System, along: Tangent, still: Floats, done: bool
) -> tuple[Floats, Floats, bool]:
    """The next correction dq (n,), ds (k,), whether there is one; or the direction of the branch, if done."""
    across = way.free or done
    n, k = here.border.shape
    held = k + (1 if across else len(still))
    right, left, corner = np.empty((n, held)), np.empty((n, held)), np.zeros((held, held))
    for i in range(n):
        for j in range(k):
            right[i, j] = left[i, j] = here.border[i, j]
    for i in range(k):
        for j in range(k):
            corner[i, j] = here.corner[i, j]
    for m in range(held - k):
        row = lower(here.basis, along.change if across else still[m])
        for i in range(n):
            right[i, k + m] = left[i, k + m] = row[i]
    r, s = np.zeros(n), np.zeros(held)
    if across:
        by_p, gap_by_p = by_path(chain, shape, here, way.rate)
        for i in range(n):
            right[i, k] = by_p[i]
            left[i, k] /= chain.twisted_length
        for i in range(k):
            corner[i, k] = gap_by_p[i]
        corner[k, k] = along.p * way.size**2
        s[k] = 1.0
    if not done:
        for i in range(n):
            r[i] = -here.residual[i]
        for i in range(held):
            s[i] = -here.gap[i] if i < k else 0.0
    border = right, left, corner
    factor, reduced = np.empty_like(here.band), (np.empty((n, held)), np.empty((held, held)))
    condense(here.band, 0.0, border, factor, reduced)
    return solve_bordered(here.band, 0.0, factor, border, reduced, r, s, REFINEMENTS)


compile_kernels(__name__, splice=("_solved",), owning=("imbalance", "step", "newton", "_solved"))
