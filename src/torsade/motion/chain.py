"""Equilibria of one fiber as a problem in its edges: what may move, what is held, what balances.

The energies of the discrete rod depend on nodes through edge vectors alone, x_n - x_0 = sum of the edges
before node n. Taken as unknowns, edges need no constraint to keep their length: an inextensible one moves
on a sphere, which holds |e| = l exactly, and its Lagrange multiplier has gone into the sphere's
curvature,

    H = Q^T (d2E) Q - (e . dE/de)/l,

the columns of Q being directions across e, scaled so that |dq|^2 = sum l |dt|^2.

Hessians are then banded, eigenvalues are forces [N] that converge as edges become short (those of a
straight hinged column under thrust P are B n^2 pi^2/L^2 - P), and what is held at nodes is a few rows of
sums of edges.

Twist is either a material angle on every edge, or eliminated: in an open fiber without torques between
its ends the twisting moment M_t is the same at all hinges, m = M_t lbar/C, and the shape is that of least
bending energy plus M_t times the reference twist R of the whole, given M_t; with the ends' rotation Phi
given, M_t = C (Phi + R)/L is one more unknown.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade.arrays import Bools, Floats, Ints
from torsade.assembly import Assembly
from torsade.motion import chain_kernels
from torsade.motion.chain_kernels import (
    FIXED,
    FREE,
    HINGES,
    LAST_ANGLE,
    NOTHING,
    PLANE,
    SPHERE,
    Derivatives,
    Rules,
)
from torsade.rod import elasticity

__all__ = ["FIXED", "FREE", "PLANE", "SPHERE", "Chain", "Controls", "Shape", "System"]


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

    def towards(self, other: Controls, p: float) -> Controls:
        """The controls at the share p of the way to others."""
        rate = self.to(other)
        return Controls(
            self.value + p * rate.value,
            self.load + p * rate.load,
            self.torque + p * rate.torque,
            self.rotation + p * rate.rotation,
        )

    def to(self, other: Controls) -> Controls:
        """How much others are more than these."""
        return Controls(
            other.value - self.value,
            other.load - self.load,
            other.torque - self.torque,
            other.rotation - self.rotation,
        )


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
        n, _, d = self.basis.shape
        return np.asarray(np.einsum("ecd,ed->ec", self.basis, q.reshape(n, d)))

    def lower(self, change: Floats) -> Floats:
        """Coordinates (n,) of the part of a change (n_edges, 4) that is allowed."""
        size = np.maximum(np.einsum("ecd,ecd->ed", self.basis, self.basis), 1e-300)
        return np.asarray(np.einsum("ecd,ec->ed", self.basis, change) / size).ravel()


class Chain(NamedTuple):
    """What an open fiber is made of, what its edges may do and what is held.

    Attributes
    ----------
    assembly : the fiber; edges without rest length stand for directions of its ends
    EA, B, C : stiffness in stretch [N], bending [N m^2] and twist [N m^2]
    freedom : (n_edges,) FIXED, PLANE, SPHERE or FREE
    normal : (n_edges, 3) unit normal of the plane that an edge stays in
    mass : (n_edges,) length that an edge's motion counts for [m]
    weight : (k, n_edges, 3) sum over edges of weight . e is held
    angles : whether material angles are unknowns
    rotation_held : whether the ends' rotation is held, or the twisting moment given
    """

    assembly: Assembly
    EA: float
    B: float
    C: float
    freedom: Ints
    normal: Floats
    mass: Floats
    weight: Floats
    angles: bool = False
    rotation_held: bool = False

    @property
    def spheres(self) -> Bools:
        """(n_edges,) edges that keep their length."""
        return np.asarray(self.freedom != FREE)

    @property
    def twisted_length(self) -> float:
        """Length over which the fiber twists [m]."""
        return float(self.assembly.hinge_length.sum())

    @property
    def held(self) -> int:
        """Number of constraints, the rotation among them."""
        return len(self.weight) + int(self.rotation_held)

    def total_twist(self, shape: Shape) -> float:
        """Twist Tw of the whole fiber [rad]."""
        if self.angles:
            return float(shape.theta[-1] - shape.theta[0] + shape.turned)
        return shape.torque * self.twisted_length / self.C

    def rotation(self, shape: Shape) -> float:
        """Rotation Phi of the last edge's director against the first's [rad]."""
        return self.total_twist(shape) - shape.turned

    def hinge_twist(self, shape: Shape) -> Floats:
        """Twist m of every hinge (n_hinges,) [rad]."""
        a = self.assembly
        if not self.angles:
            return np.asarray(shape.torque / self.C * a.hinge_length)
        m = np.empty(len(a.hinges))
        elasticity.hinge_twist(shape.theta, shape.reference_twist, a.hinges, m)
        return m

    def gap(self, shape: Shape, controls: Controls) -> Floats:
        """How far what is held is from its value (k,) [m]."""
        return np.asarray(np.einsum("kec,ec->k", self.weight, shape.edge) - controls.value)

    def potential(self, shape: Shape, controls: Controls) -> float:
        """Stored energy less the work of loads [J]; with M_t given and angles eliminated, M_t R for twist."""
        a = self.assembly
        length, tangent = _directions(shape.edge)
        total = float(elasticity.bend_energy(a, self.B, False, length, tangent))
        if self.EA > 0:
            rest = np.where(a.rest_length > 0, a.rest_length, length)
            total += float(0.5 * self.EA * (a.rest_length * (length / rest - 1.0) ** 2).sum())
        total -= float(np.einsum("ec,ec->", controls.load, shape.edge))
        if self.angles:
            total += float(elasticity.twist_energy(a, self.C, self.hinge_twist(shape)))
            return total if self.rotation_held else total - controls.torque * float(shape.theta[-1])
        if self.rotation_held:
            twist = controls.rotation + shape.turned
            return total + 0.5 * self.C * twist**2 / self.twisted_length
        return total + controls.torque * shape.turned

    def moved(self, shape: Shape, change: Floats) -> Shape:
        """The shape after a change (n_edges, 4) of its edges and angles; directors are carried along."""
        edge, twist = np.empty_like(shape.edge), np.empty(len(self.assembly.hinges))
        chain_kernels.turn(shape.edge, change, self.freedom, self.assembly, edge, twist)
        return shape._replace(
            edge=edge, theta=shape.theta + change[:, 3], reference_twist=shape.reference_twist + twist
        )

    def system(self, shape: Shape, controls: Controls) -> System:
        """First and second derivatives of the Lagrangian at a shape."""
        a = self.assembly
        n, k = len(a.edges), len(self.weight)
        d = (3 if self.EA > 0 else 2) + int(self.angles)
        torque = shape.torque if self.rotation_held else controls.torque
        if self.angles:
            stiffness = self.C / a.hinge_length
            moment = stiffness * self.hinge_twist(shape)
        else:
            stiffness, moment = np.zeros(len(a.hinges)), np.full(len(a.hinges), torque)
        out = Derivatives(
            np.empty((n, 4, d)),
            np.empty(n * d),
            np.empty((n * d, 2 * d)),
            np.empty((n * d, self.held)),
            np.empty(k),
        )
        rules = Rules(self.freedom, self.normal, self.mass, self.weight, self.angles)
        rotation = (LAST_ANGLE if self.angles else HINGES) if self.rotation_held else NOTHING
        end_torque = torque if self.angles else 0.0
        chain_kernels.derivatives(
            a,
            self.EA,
            self.B,
            rules,
            shape.edge,
            shape.reaction,
            controls.load,
            moment,
            stiffness,
            end_torque,
            rotation,
            out,
        )
        gap = controls.value - out.gap
        corner = np.zeros((self.held, self.held))
        if self.rotation_held:
            short, corner[k, k] = self._rotation_gap(shape, controls)
            gap = np.append(gap, short)
        return System(out.residual, gap, out.band, out.border, corner, out.basis)

    def by_path(self, shape: Shape, system: System, path: Controls) -> tuple[Floats, Floats]:
        """Derivative of residual (n,) and gap (k,) as controls change at the rates `path`."""
        change = np.zeros((len(shape.edge), 4))
        change[:, :3] = -path.load
        if not self.rotation_held and path.torque != 0.0:
            if self.angles:
                change[-1, 3] = -path.torque
            else:
                change += path.torque * self.twist_gradient(*_directions(shape.edge))
        below = np.append(path.value, path.rotation) if self.rotation_held else path.value
        return np.einsum("ec,ecd->ed", change, system.basis).ravel(), below

    def _rotation_gap(self, shape: Shape, controls: Controls) -> tuple[float, float]:
        """How far the rotation is from what is given, and what stands on the diagonal."""
        if self.angles:
            return controls.rotation - float(shape.theta[-1]), 0.0
        ease = self.twisted_length / self.C
        return controls.rotation + shape.turned - shape.torque * ease, -ease

    def twist_gradient(self, length: Floats, tangent: Floats) -> Floats:
        """dR/d(e, theta) (n_edges, 4) of the reference twist of the whole fiber."""
        out = np.empty((len(length), 4))
        chain_kernels.twist_gradient(length, tangent, out)
        return out


def _directions(edge: Floats) -> tuple[Floats, Floats]:
    """Lengths (n,) and unit tangents (n, 3) of edge vectors."""
    length, tangent = np.empty(len(edge)), np.empty_like(edge)
    chain_kernels.directions(edge, length, tangent)
    return length, tangent
