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
from torsade.motion import newton_kernels
from torsade.motion.bordered import Bordered
from torsade.motion.chain import Chain, Controls, Shape, System
from torsade.motion.newton_kernels import LARGEST_RADIUS, MOST_STEPS, Tangent, Way

__all__ = ["minimise", "newton"]


def newton(
    chain: Chain,
    shape: Shape,
    controls: Controls,
    most: int = MOST_STEPS,
    still: Sequence[Floats] | Floats = (),
) -> tuple[Shape, System] | None:
    """The equilibrium next to a shape, stable or not, and its derivatives; None when none is near.

    still are motions (n_edges, 4) that the way there does without: next to a bifurcation the modes of another
    branch, onto which an all but singular system would lead.
    """
    unchanged = Controls(np.zeros_like(controls.value), np.zeros_like(controls.load), 0.0, 0.0)
    way, unmoved = Way(controls, unchanged, 1.0, free=False, onwards=False), upwards(chain)
    found, _, end, here, _ = newton_kernels.newton(
        chain, way, shape, 0.0, unmoved, 0.0, as_modes(still, chain), most
    )
    return (end, here) if found >= 0 else None


def upwards(chain: Chain) -> Tangent:
    """The direction of a path on which nothing moves yet."""
    return Tangent(np.zeros((len(chain.mass), 4)), np.zeros(chain.held), 1.0)


def as_modes(still: Sequence[Floats] | Floats, chain: Chain) -> Floats:
    """Motions as one array (m, n_edges, 4)."""
    shaped = np.reshape(np.asarray(still, dtype=np.float64), (len(still), len(chain.mass), 4))
    return np.ascontiguousarray(shaped)


def minimise(chain: Chain, shape: Shape, controls: Controls, most: int = 200) -> Shape:
    """A shape of least energy under constraints, downhill from the one given.

    Raises
    ------
    TorsadeError
        When no equilibrium is found within so many steps.
    """
    shape = shape if chain.rotation_held else shape._replace(torque=controls.torque)
    radius, shift, before = 0.3 * LARGEST_RADIUS, 0.0, math.inf
    for _ in range(most):
        system = chain.system(shape, controls)
        solver, shift = _convex(chain, system, shift)
        size = newton_kernels.imbalance(chain, shape, controls, system)
        if shift == 0.0 and newton_kernels.settled(size, before):
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


def _length(chain: Chain, dq: Floats) -> float:
    """Root mean square of the angle that edges turn by [rad]."""
    return float(np.linalg.norm(dq)) / math.sqrt(chain.twisted_length)


def _step(chain: Chain, shape: Shape, system: System, dq: Floats, ds: Floats) -> Shape:
    """The shape after a step of coordinates (n,) and multipliers (k,)."""
    return newton_kernels.step(chain, shape, system.lift(dq), ds)


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
    trial = _step(chain, shape, system, dq, ds)
    if merit(trial) <= before - 1e-4 * abs(slope) + noise:
        return trial
    short = np.zeros_like(system.gap)
    short[:k] = chain.gap(trial, controls)
    more, _ = solver.solve(np.zeros_like(dq), short)
    trial = _step(chain, shape, system, dq + more, ds)
    return trial if merit(trial) <= before - 1e-4 * abs(slope) + noise else None
