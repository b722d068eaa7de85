"""A chain's shape, what is given, and the Lagrangian's derivatives, as named tuples for kernels.

See `torsade.motion.chain` for the unknowns. Loops stand where numpy would say it in a line: they compile in a
tenth of the time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Floats
from torsade.motion.chain_kernels import (
    HINGES,
    LAST_ANGLE,
    NOTHING,
    Derivatives,
    Rules,
    derivatives,
    directions,
    project,
    turn,
    twist_gradient,
)
from torsade.rod.elasticity import hinge_twist

if TYPE_CHECKING:
    from torsade.motion.chain import Chain


class Controls(NamedTuple):
    """What is given, and may be varied.

    Attributes
    ----------
    value : (k,) values of what is held
    load : (n_edges, 3) force that the edge carries, the sum of the dead loads on all nodes beyond it [N]
    torque : twisting moment at the ends [N m], unless their rotation is held
    rotation : how far the last edge's director is turned against the first's, Phi [rad], if it is held
    """

    value: Floats
    load: Floats
    torque: float
    rotation: float


class Shape(NamedTuple):
    """Where a fiber is and what keeps it there.

    Attributes
    ----------
    edge : (n_edges, 3) edge vectors [m]
    theta : (n_edges,) material angles from the reference directors [rad]; not used where they are eliminated
    reference_twist : (n_hinges,) unwrapped twist of the reference directors [rad]
    reaction : (k,) forces with which what is held acts on the fiber [N]
    torque : twisting moment M_t at the ends [N m]
    """

    edge: Floats
    theta: Floats
    reference_twist: Floats
    reaction: Floats
    torque: float

    @property
    def turned(self) -> float:
        """Reference twist R of the whole fiber [rad]."""
        return float(self.reference_twist.sum())


class System(NamedTuple):
    """First and second derivatives of the Lagrangian in the coordinates q of the edges.

    Attributes
    ----------
    residual : (n,) out-of-balance forces
    gap : (k,) or (k + 1,) how far what is held is from its value
    band : (n, w + 1) Hessian, rows as in `torsade.rod.banded`
    border : (n, k) or (n, k + 1) gradients of what is held, and of the rotation
    corner : (k, k) or (k + 1, k + 1) what stands below the Hessian
    basis : (n_edges, 4, d) change of an edge's (e, theta) with its coordinates
    """

    residual: Floats
    gap: Floats
    band: Floats
    border: Floats
    corner: Floats
    basis: Floats

    def lift(self, q: Floats) -> Floats:
        """Change (n_edges, 4) of edges and angles that coordinates q (n,) stand for."""
        return lift(self.basis, q)


def towards(start: Controls, rate: Controls, p: float) -> Controls:
    """The controls at the share p of a way on which they change at a rate."""
    value, load = np.empty_like(start.value), np.empty_like(start.load)
    for i in range(len(value)):
        value[i] = start.value[i] + p * rate.value[i]
    for e in range(len(load)):
        for c in range(3):
            load[e, c] = start.load[e, c] + p * rate.load[e, c]
    return Controls(value, load, start.torque + p * rate.torque, start.rotation + p * rate.rotation)


def lift(basis: Floats, q: Floats) -> Floats:
    """Change (n_edges, 4) of edges and angles that coordinates q (n,) stand for."""
    n, _, d = basis.shape
    out = np.empty((n, 4))
    for e in range(n):
        for c in range(4):
            total = 0.0
            for i in range(d):
                total += basis[e, c, i] * q[e * d + i]
            out[e, c] = total
    return out


def lower(basis: Floats, change: Floats) -> Floats:
    """Coordinates (n,) of the part of a change (n_edges, 4) that is allowed."""
    n, _, d = basis.shape
    out = np.empty(n * d)
    for e in range(n):
        for i in range(d):
            size = total = 0.0
            for c in range(4):
                size += basis[e, c, i] * basis[e, c, i]
                total += basis[e, c, i] * change[e, c]
            out[e * d + i] = total / max(size, 1e-300)
    return out


def moved(chain: Chain, shape: Shape, change: Floats) -> Shape:
    """The shape after a change (n_edges, 4) of its edges and angles; directors are carried along."""
    edge, theta, twist = np.empty_like(shape.edge), shape.theta.copy(), np.empty(len(shape.reference_twist))
    turn(shape.edge, change, chain.freedom, chain.assembly, edge, twist)
    for e in range(len(theta)):
        theta[e] += change[e, 3]
    for h in range(len(twist)):
        twist[h] += shape.reference_twist[h]
    return Shape(edge, theta, twist, shape.reaction, shape.torque)


def system(chain: Chain, shape: Shape, controls: Controls) -> System:
    """First and second derivatives of the Lagrangian at a shape."""
    a = chain.assembly
    n, k = len(chain.mass), len(chain.weight)
    d, held = 2 + int(chain.EA > 0) + int(chain.angles), k + int(chain.rotation_held)
    torque = shape.torque if chain.rotation_held else controls.torque
    stiffness, moment = np.zeros(len(a.hinges)), np.empty(len(a.hinges))
    if chain.angles:
        hinge_twist(shape.theta, shape.reference_twist, a.hinges, moment)
    for h in range(len(a.hinges)):
        stiffness[h] = chain.C / a.hinge_length[h] if chain.angles else 0.0
        moment[h] = stiffness[h] * moment[h] if chain.angles else torque
    out = Derivatives(
        np.empty((n, 4, d)), np.empty(n * d), np.empty((n * d, 2 * d)), np.empty((n * d, held)), np.empty(k)
    )
    rules = Rules(chain.freedom, chain.normal, chain.mass, chain.weight, chain.angles)
    rotation = NOTHING
    if chain.rotation_held:
        rotation = LAST_ANGLE if chain.angles else HINGES
    derivatives(
        a, chain.EA, chain.B, rules, shape.edge, shape.reaction, controls.load, moment, stiffness,
        torque if chain.angles else 0.0, rotation, out,
    )  # fmt: skip
    gap, corner = np.empty(held), np.zeros((held, held))
    for i in range(k):
        gap[i] = controls.value[i] - out.gap[i]
    if chain.rotation_held:
        gap[k], corner[k, k] = _rotation_gap(chain, shape, controls)
    return System(out.residual, gap, out.band, out.border, corner, out.basis)


def _rotation_gap(chain: Chain, shape: Shape, controls: Controls) -> tuple[float, float]:
    """How far the rotation is from what is given, and what stands on the diagonal."""
    if chain.angles:
        return controls.rotation - shape.theta[-1], 0.0
    ease = chain.twisted_length / chain.C
    turned = 0.0
    for change in shape.reference_twist:
        turned += change
    return controls.rotation + turned - shape.torque * ease, -ease


def by_path(chain: Chain, shape: Shape, here: System, rate: Controls) -> tuple[Floats, Floats]:
    """Derivatives of residual (n,) and gap (k,) or (k + 1,) as controls change at these rates."""
    n, _, d = here.basis.shape
    change = np.zeros((n, 4))
    if not chain.rotation_held and rate.torque != 0.0:
        if chain.angles:
            change[n - 1, 3] = -rate.torque
        else:
            length, tangent = np.empty(n), np.empty((n, 3))
            directions(shape.edge, length, tangent)
            twist_gradient(length, tangent, change)
            for e in range(n):
                for c in range(3):
                    change[e, c] *= rate.torque
    for e in range(n):
        for c in range(3):
            change[e, c] -= rate.load[e, c]
    out, gap = np.empty(n * d), np.empty(len(here.gap))
    project(change, here.basis, out)
    for i in range(len(gap)):
        gap[i] = rate.value[i] if i < len(rate.value) else rate.rotation
    return out, gap


compile_kernels(
    __name__,
    splice=("_rotation_gap",),
    owning=("towards", "lift", "lower", "moved", "system", "_rotation_gap", "by_path"),
)
