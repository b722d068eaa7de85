"""Least energy under constraints: Newton steps with exact Hessians, shortened until they can be trusted.

A step solves the Newton system of the Lagrangian. Where its Hessian is not positive on the tangent space
of the constraints, or the step is longer than the radius trusted, a multiple of the metric is added until
both hold (Levenberg and Marquardt's way, with the inertia of the bordered matrix as the test). A step is
taken when it lowers energy + weight * |gap|; one that fails only because constraints are curved is
corrected to second order (Fletcher) before it is shortened.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from torsade.arrays import Floats
from torsade.errors import TorsadeError
from torsade.motion.bordered import Bordered
from torsade.motion.chain import Chain, Controls, Shape, System

__all__ = ["imbalance", "minimise", "newton", "settled", "step"]

TOLERANCE, ROUND_OFF = 1e-10, 1e-7
"""Out-of-balance force, in units of those that act, at which a shape is at equilibrium: below the first, or
below the second when it falls no further."""

GAPS = 1e3
"""How much more exact gaps are, in units of L: ends near a fiber's length apart say its slope squared."""

LARGEST_RADIUS = 1.0
"""Longest step, as the root mean square of the angle that edges turn by [rad]."""


def imbalance(chain: Chain, shape: Shape, controls: Controls, system: System) -> float:
    """What is out of balance: forces in units of those that act and B/L^2, gaps in units of L and radians."""
    L = chain.twisted_length
    k = len(chain.weight)
    acting = float(np.abs(shape.reaction).max(initial=0.0)) + float(np.abs(controls.load).max(initial=0.0))
    unit = acting + abs(shape.torque) / L + chain.B / L**2
    force = float(np.linalg.norm(system.residual)) / math.sqrt(L) / unit
    gap = float(np.abs(system.gap[:k]).max(initial=0.0)) / L
    return max(force, GAPS * gap, GAPS * float(np.abs(system.gap[k:]).max(initial=0.0)))


def settled(size: float, before: float) -> bool:
    """Whether an imbalance is none, after the one before it."""
    return size < TOLERANCE or (0.5 * before < size < ROUND_OFF and before < ROUND_OFF)


def step(chain: Chain, shape: Shape, system: System, dq: Floats, ds: Floats) -> Shape:
    """The shape after a step of coordinates (n,) and multipliers (k,)."""
    k = len(chain.weight)
    moved = chain.moved(shape, system.lift(dq))
    torque = shape.torque + float(ds[k]) if chain.rotation_held else shape.torque
    return moved._replace(reaction=shape.reaction + ds[:k], torque=torque)


def newton(
    chain: Chain, shape: Shape, controls: Controls, most: int = 12, still: Sequence[Floats] | Floats = ()
) -> tuple[Shape, System] | None:
    """The equilibrium next to a shape, stable or not, and its derivatives; None when none is near.

    still are motions (n_edges, 4) that the way there does without: next to a bifurcation the modes of another
    branch, onto which an all but singular system would lead.
    """
    shape = _given(chain, shape, controls)
    before = math.inf
    for _ in range(most):
        system = chain.system(shape, controls)
        size = imbalance(chain, shape, controls, system)
        if settled(size, before):
            return shape, system
        if not math.isfinite(size) or size > 1e3 * max(before, 1.0):
            return None
        try:
            dq, ds = _without(system, still).solve(
                -system.residual, np.append(-system.gap, np.zeros(len(still)))
            )
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(dq).all() or _length(chain, dq) > LARGEST_RADIUS:
            return None
        shape, before = step(chain, shape, system, dq, ds), size
    return None


def _without(system: System, still: Sequence[Floats] | Floats) -> Bordered:
    """The Newton system in which some motions are kept from taking part."""
    if len(still) == 0:
        return Bordered(system.band, system.border, system.corner)
    border = np.column_stack([system.border, *(system.lower(mode) for mode in still)])
    corner = np.zeros((border.shape[1], border.shape[1]))
    k = len(system.gap)
    corner[:k, :k] = system.corner
    return Bordered(system.band, border, corner)


def minimise(chain: Chain, shape: Shape, controls: Controls, most: int = 200) -> Shape:
    """A shape of least energy under constraints, downhill from the one given.

    Raises
    ------
    TorsadeError
        When no equilibrium is found within so many steps.
    """
    shape = _given(chain, shape, controls)
    radius, shift, before = 0.3 * LARGEST_RADIUS, 0.0, math.inf
    for _ in range(most):
        system = chain.system(shape, controls)
        solver, shift = _convex(chain, system, shift)
        size = imbalance(chain, shape, controls, system)
        if shift == 0.0 and settled(size, before):
            return shape
        before = size if shift == 0.0 else math.inf
        solver, shift, dq, ds = _within(chain, system, solver, shift, radius)
        weight = 2.0 * float(np.abs(shape.reaction + ds[: len(chain.weight)]).max(initial=0.0))
        weight += chain.B / chain.twisted_length**2
        taken = _descend(chain, shape, controls, system, solver, dq, ds, weight)
        if taken is None:
            radius = 0.25 * min(radius, _length(chain, dq))
            if radius < 1e-13:
                break
        else:
            shape = taken
            radius = min(max(radius, 2.0 * _length(chain, dq)), LARGEST_RADIUS)
            shift = 0.0 if shift * chain.twisted_length**2 < 1e-3 * chain.B else 0.25 * shift
    raise TorsadeError(
        "no equilibrium was found; give a shape nearer to one, or loads that the fiber can bear."
    )


def _given(chain: Chain, shape: Shape, controls: Controls) -> Shape:
    """The shape with the twisting moment that is given."""
    return shape if chain.rotation_held else shape._replace(torque=controls.torque)


def _length(chain: Chain, dq: Floats) -> float:
    """Root mean square of the angle that edges turn by [rad]."""
    return float(np.linalg.norm(dq)) / math.sqrt(chain.twisted_length)


def _convex(chain: Chain, system: System, shift: float) -> tuple[Bordered, float]:
    """The Newton system with the least shift tried that makes it convex between constraints."""
    unit = chain.B / chain.twisted_length**2
    while True:
        solver = Bordered(system.band, system.border, system.corner, shift=shift)
        if solver.negative <= chain.held:
            return solver, shift
        shift = max(4.0 * shift, 0.1 * unit)


def _within(
    chain: Chain, system: System, solver: Bordered, shift: float, radius: float
) -> tuple[Bordered, float, Floats, Floats]:
    """A step no longer than the radius: shifted further, and cut when constraints alone ask for more."""
    unit = chain.B / chain.twisted_length**2
    dq, ds = solver.solve(-system.residual, -system.gap)
    for _ in range(8):
        if _length(chain, dq) <= 1.01 * radius:
            break
        shift = max(3.0 * shift, unit)
        solver = Bordered(system.band, system.border, system.corner, shift=shift)
        dq, ds = solver.solve(-system.residual, -system.gap)
    return solver, shift, dq * min(1.0, radius / max(_length(chain, dq), 1e-300)), ds


def _descend(
    chain: Chain,
    shape: Shape,
    controls: Controls,
    system: System,
    solver: Bordered,
    dq: Floats,
    ds: Floats,
    weight: float,
) -> Shape | None:
    """The shape after the step, or after its correction; None when neither lowers the merit."""
    k = len(chain.weight)

    def merit(now: Shape) -> float:
        off = float(np.abs(chain.gap(now, controls)).sum())
        if chain.rotation_held and chain.angles:
            off += abs(float(now.theta[-1]) - controls.rotation)
        return chain.potential(now, controls) + weight * off

    before = merit(shape)
    noise = 1e-13 * (abs(before) + chain.B / chain.twisted_length)
    slope = -float(system.residual @ dq) + weight * float(np.abs(system.gap[:k]).sum())
    trial = step(chain, shape, system, dq, ds)
    if merit(trial) <= before - 1e-4 * abs(slope) + noise:
        return trial
    short = np.zeros_like(system.gap)
    short[:k] = chain.gap(trial, controls)
    more, _ = solver.solve(np.zeros_like(dq), short)
    trial = step(chain, shape, system, dq + more, ds)
    return trial if merit(trial) <= before - 1e-4 * abs(slope) + noise else None
