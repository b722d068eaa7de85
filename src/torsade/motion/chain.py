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
from torsade.motion import lagrangian
from torsade.motion.chain_kernels import FIXED, FREE, PLANE, SPHERE, directions
from torsade.motion.lagrangian import Controls, Shape, System
from torsade.rod import elasticity

__all__ = ["FIXED", "FREE", "PLANE", "SPHERE", "Chain", "Controls", "Shape", "System"]


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
    twisted_length : length over which the fiber twists [m]
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
    twisted_length: float
    angles: bool = False
    rotation_held: bool = False

    @property
    def spheres(self) -> Bools:
        """(n_edges,) edges that keep their length."""
        return np.asarray(self.freedom != FREE)

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
        return lagrangian.moved(self, shape, change)

    def system(self, shape: Shape, controls: Controls) -> System:
        """First and second derivatives of the Lagrangian at a shape."""
        return lagrangian.system(self, shape, controls)


def _directions(edge: Floats) -> tuple[Floats, Floats]:
    """Lengths (n,) and unit tangents (n, 3) of edge vectors."""
    length, tangent = np.empty(len(edge)), np.empty_like(edge)
    directions(edge, length, tangent)
    return length, tangent
