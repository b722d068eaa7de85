"""Newton's method on a chain, at given controls and along a branch, compiled.

What is done here rounds after every operation, as numpy does.
"""

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


def imbalance(chain: Chain, shape: Shape, controls: Controls, here: System) -> float:
    """What is out of balance: forces in units of those that act and B/L^2, gaps in units of L and radians."""
    L = chain.twisted_length
    acting = largest(shape.reaction) + largest(controls.load.ravel())
    unit = acting + abs(shape.torque) / L + chain.B / L**2
    force = norm(here.residual) / math.sqrt(L) / unit
    if not math.isfinite(force):
        return force
    k = len(chain.weight)
    return max(force, GAPS * (largest(here.gap[:k]) / L), GAPS * largest(here.gap[k:]))


def largest(values: Floats) -> float:
    """Largest size of values (n,), and 0 of none."""
    found = 0.0
    for value in values:
        found = max(found, abs(value))
    return found


def norm(values: Floats) -> float:
    """Euclidean norm of values (n,)."""
    return math.sqrt(np.dot(values, values))


def settled(size: float, before: float) -> bool:
    """Whether an imbalance is none, after the one before it."""
    return size < TOLERANCE or (0.5 * before < size < ROUND_OFF and before < ROUND_OFF)


def given(chain: Chain, shape: Shape, controls: Controls) -> Shape:
    """The shape with the twisting moment that is given."""
    torque = shape.torque if chain.rotation_held else controls.torque
    return Shape(shape.edge, shape.theta, shape.reference_twist, shape.reaction, torque)


def step(chain: Chain, shape: Shape, change: Floats, ds: Floats) -> Shape:
    """The shape after a change (n_edges, 4) of its edges and angles and one of multipliers (k,)."""
    k = len(chain.weight)
    after = moved(chain, shape, change)
    torque = shape.torque + ds[k] if chain.rotation_held else shape.torque
    return Shape(after.edge, after.theta, after.reference_twist, shape.reaction + ds[:k], torque)


def solved(
    band: Floats, border: tuple[Floats, Floats, Floats], r: Floats, s: Floats
) -> tuple[Floats, Floats, bool]:
    """Solutions dq (n,), ds (k,) of a bordered system (see `torsade.motion.bordered`), whether there are."""
    factor = np.empty_like(band)
    reduced = np.empty_like(border[0]), np.empty_like(border[2])
    condense(band, 0.0, border, factor, reduced)
    return solve_bordered(band, 0.0, factor, border, reduced, r, s, REFINEMENTS)


def newton(
    chain: Chain, shape: Shape, controls: Controls, most: int, still: Floats
) -> tuple[bool, Shape, System]:
    """Whether there is an equilibrium next to a shape, it, and its derivatives; see `torsade.motion.trust`.

    still (m, n_edges, 4) are motions that the way there does without.
    """
    shape = given(chain, shape, controls)
    here = system(chain, shape, controls)
    before = math.inf
    for _ in range(most):
        size = imbalance(chain, shape, controls, here)
        if settled(size, before):
            return True, shape, here
        if not math.isfinite(size) or size > 1e3 * max(before, 1.0):
            break
        s = np.zeros(len(here.gap) + len(still))
        s[: len(here.gap)] = -here.gap
        dq, ds, regular = solved(here.band, _without(here, still), -here.residual, s)
        if not regular or not norm(dq) / math.sqrt(chain.twisted_length) <= LARGEST_RADIUS:
            break
        shape, before = step(chain, shape, lift(here.basis, dq), ds), size
        here = system(chain, shape, controls)
    return False, shape, here


def _without(here: System, still: Floats) -> tuple[Floats, Floats, Floats]:
    """The border of a system in which some motions are kept from taking part."""
    n, k = here.border.shape
    held = k + len(still)
    border, corner = np.empty((n, held)), np.zeros((held, held))
    border[:, :k] = here.border
    corner[:k, :k] = here.corner
    for m in range(len(still)):
        border[:, k + m] = lower(here.basis, still[m])
    return border, border, corner


def _across(
    chain: Chain, shape: Shape, here: System, rate: Controls, weight: float, along: Tangent
) -> tuple[Floats, Floats, Floats]:
    """The border of a system in which p is unknown, in the plane across a direction.

    rate is that of the controls with p, weight the square of their change from p = 0 to 1.
    """
    by_p, gap_by_p = by_path(chain, shape, here, rate)
    n, k = here.border.shape
    corner = np.zeros((k + 1, k + 1))
    corner[:k, :k] = here.corner
    corner[:k, k] = gap_by_p
    corner[k, k] = along.p * weight
    right, left = np.empty((n, k + 1)), np.empty((n, k + 1))
    right[:, :k] = here.border
    left[:, :k] = here.border
    right[:, k] = by_p
    left[:, k] = lower(here.basis, along.change) / chain.twisted_length
    return right, left, corner


def _direction(
    chain: Chain, shape: Shape, here: System, rate: Controls, size: float, weight: float, along: Tangent
) -> Tangent:
    """The direction of a branch, which goes on along the one before; its p is NaN where there is none."""
    k = len(here.gap)
    s = np.zeros(k + 1)
    s[k] = 1.0
    border = _across(chain, shape, here, rate, weight, along)
    dq, ds, regular = solved(here.band, border, np.zeros(len(here.residual)), s)
    length = hypotenuse(norm(dq) / math.sqrt(chain.twisted_length), size * ds[k]) if regular else math.nan
    return Tangent(lift(here.basis, dq) / length, ds[:k] / length, ds[k] / length)


def hypotenuse(a: float, b: float) -> float:
    """sqrt(a^2 + b^2), rounded once, of numbers whose squares are neither too large nor too small."""
    h = math.sqrt(a * a + b * b)
    p, p_off = _square(a)
    q, q_off = _square(b)
    r, r_off = _square(h)
    if p < q:
        p, q = q, p
    return h + ((p - r) + q + (p_off + q_off - r_off)) / (2.0 * h)


def _square(x: float) -> tuple[float, float]:
    """The square of x, rounded, and what rounding took off (Dekker 1971)."""
    c = 134217729.0 * x
    high = c - (c - x)
    low = x - high
    square = x * x
    return square, low * low - ((square - high * high) - 2.0 * (high * low))


def arrive(
    chain: Chain,
    shape: Shape,
    start: Controls,
    rate: Controls,
    size: float,
    weight: float,
    p: float,
    along: Tangent,
    most: int,
) -> tuple[bool, Shape, System, Tangent]:
    """Newton's method at share p of a path, and the direction of the branch there; arguments as of `correct`.

    Returns whether there is a point, and its shape, system and direction.
    """
    found, end, here = newton(chain, shape, towards(start, rate, p), most, np.empty((0, len(shape.edge), 4)))
    tangent = _direction(chain, end, here, rate, size, weight, along) if found else along
    return found and math.isfinite(tangent.p), end, here, tangent


def correct(
    chain: Chain,
    start: Controls,
    rate: Controls,
    size: float,
    weight: float,
    shape: Shape,
    p: float,
    along: Tangent,
    length: float,
) -> tuple[int, float, Shape, System, Tangent]:
    """Newton's method in the plane across a direction, a length away from a shape at share p of a path.

    Controls change from the start at a rate; size is that of their change from p = 0 to 1, weight its
    square. Returns how many corrections it took, or -1 when there is no point, and p, shape, system and
    direction of the point.
    """
    shape = step(chain, shape, length * along.change, length * along.multipliers)
    p += length * along.p
    controls = towards(start, rate, p)
    shape = given(chain, shape, controls)
    here = system(chain, shape, controls)
    before = math.inf
    for corrections in range(MOST_CORRECTIONS + 1):
        off = imbalance(chain, shape, controls, here)
        if not math.isfinite(off):
            break
        if settled(off, before):
            tangent = _direction(chain, shape, here, rate, size, weight, along)
            return corrections if math.isfinite(tangent.p) else -1, p, shape, here, tangent
        s = np.zeros(len(here.gap) + 1)
        s[:-1] = -here.gap
        border = _across(chain, shape, here, rate, weight, along)
        dq, ds, regular = solved(here.band, border, -here.residual, s)
        if not regular or not np.dot(dq, dq) <= chain.twisted_length:
            break
        shape, before = step(chain, shape, lift(here.basis, dq), ds), off
        p += ds[-1]
        controls = towards(start, rate, p)
        shape = given(chain, shape, controls)
        here = system(chain, shape, controls)
    return -1, p, shape, here, along


_ALL = (
    "imbalance",
    "largest",
    "norm",
    "settled",
    "given",
    "step",
    "solved",
    "newton",
    "_without",
    "_across",
    "_direction",
    "hypotenuse",
    "_square",
    "arrive",
    "correct",
)

compile_kernels(__name__, splice=("_without",), owning=_ALL, exact=_ALL)
