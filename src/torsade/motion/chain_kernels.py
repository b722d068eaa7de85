"""Kernels of equilibria in edges: an edge's directions of motion, and derivatives of the Lagrangian by them.

See `torsade.motion.chain` for the unknowns and for what is held.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Ints
from torsade.assembly import Assembly
from torsade.rod.banded import reduce_blocks
from torsade.rod.hessian import elastic_derivatives
from torsade.rod.kinematics import reference_twist_change

FIXED, PLANE, SPHERE, FREE = 0, 1, 2, 3
"""What an edge may do: nothing, turn in a plane, turn, turn and stretch."""

NOTHING, HINGES, LAST_ANGLE = 0, 1, 2
"""What the held rotation of the ends depends on."""


class Rules(NamedTuple):
    """What edges may do and what is held of them; see `torsade.motion.chain.Chain`."""

    freedom: Ints
    normal: Floats
    mass: Floats
    weight: Floats
    angles: bool


class Derivatives(NamedTuple):
    """What `derivatives` writes: basis (n_edges, 4, d), residual (n,), band (n, 2 d), border (n, k) and the
    sums that are held, gap (k,)."""

    basis: Floats
    residual: Floats
    band: Floats
    border: Floats
    gap: Floats


def directions(edge: Floats, length: Floats, tangent: Floats) -> None:
    """Lengths (n,) and unit tangents (n, 3) of edge vectors (n, 3)."""
    for e in range(edge.shape[0]):
        length[e] = math.sqrt(edge[e, 0] ** 2 + edge[e, 1] ** 2 + edge[e, 2] ** 2)
        for c in range(3):
            tangent[e, c] = edge[e, c] / length[e]


def twist_gradient(length: Floats, tangent: Floats, out: Floats) -> None:
    """dR/d(e, theta) (n, 4) of the reference twist of the whole fiber."""
    out[:] = 0.0
    half = np.empty(3)
    for e in range(length.shape[0] - 1):
        _cross(tangent[e], tangent[e + 1], half)
        chi = 1.0 + _dot(tangent[e], tangent[e + 1])
        for c in range(3):
            out[e, c] += half[c] / (chi * length[e])
            out[e + 1, c] += half[c] / (chi * length[e + 1])


def turn(edge: Floats, change: Floats, freedom: Ints, a: Assembly, after: Floats, twist: Floats) -> None:
    """Edges (n, 3) after a change (n, 4) of edges and angles, and that of every hinge's reference twist.

    Edges that keep their length turn on their sphere by the angle that the change stands for.
    """
    n = edge.shape[0]
    length, tangent, turned = np.empty(n), np.empty((n, 3)), np.empty((n, 3))
    directions(edge, length, tangent)
    for e in range(n):
        if freedom[e] == FREE:
            for c in range(3):
                after[e, c] = edge[e, c] + change[e, c]
            continue
        angle = math.sqrt(change[e, 0] ** 2 + change[e, 1] ** 2 + change[e, 2] ** 2) / length[e]
        share = 1.0 if angle == 0.0 else math.sin(angle) / angle
        for c in range(3):
            after[e, c] = length[e] * math.cos(angle) * tangent[e, c] + share * change[e, c]
    directions(after, length, turned)
    reference_twist_change(a, tangent, turned, twist)


def derivatives(
    a: Assembly,
    EA: float,
    B: float,
    rules: Rules,
    edge: Floats,
    reaction: Floats,
    load: Floats,
    moment: Floats,
    stiffness: Floats,
    end_torque: float,
    rotation: int,
    out: Derivatives,
) -> None:
    """First and second derivatives of the Lagrangian by the coordinates of edges.

    moment and stiffness (n_hinges,) are those of twist, end_torque is what turns the last edge's angle [N m],
    rotation is what the held rotation of the ends depends on, if it is: `HINGES` or `LAST_ANGLE`.
    """
    n, k = edge.shape[0], rules.weight.shape[0]
    length, tangent = np.empty(n), np.empty((n, 3))
    gradient, own, beside = np.empty((n, 4)), np.empty((n, 4, 4)), np.empty((n - 1, 4, 4))
    directions(edge, length, tangent)
    elastic_derivatives(a, EA, B, False, length, tangent, moment, stiffness, gradient, own, beside)
    for e in range(n):
        for c in range(3):
            gradient[e, c] -= load[e, c]
            for i in range(k):
                gradient[e, c] -= reaction[i] * rules.weight[i, e, c]
    gradient[n - 1, 3] -= end_torque
    extra = np.empty((n, out.basis.shape[2]))
    _span(rules, length, tangent, out.basis)
    _curve(B, rules, edge, gradient, out.basis, extra)
    reduce_blocks(own, beside, out.basis, extra, out.band)
    project(gradient, out.basis, out.residual)
    _hold(rules.weight, edge, out.basis, out.gap, out.border)
    if rotation != NOTHING:
        if rotation == HINGES:
            twist_gradient(length, tangent, gradient)
        else:
            gradient[:] = 0.0
            gradient[n - 1, 3] = -1.0
        project(gradient, out.basis, out.border[:, k])


def _span(rules: Rules, length: Floats, tangent: Floats, basis: Floats) -> None:
    """The directions in which edges may move, basis (n, 4, d): across, along if they stretch, and turning."""
    d = basis.shape[2]
    stretches = d - int(rules.angles) == 3
    first, second, axis = np.empty(3), np.empty(3), np.empty(3)
    basis[:] = 0.0
    for e in range(length.shape[0]):
        freedom, root = rules.freedom[e], math.sqrt(rules.mass[e])
        scale = root if freedom == FREE else length[e] / root
        if freedom == PLANE:
            _cross(rules.normal[e], tangent[e], first)
        else:
            x, y, z = abs(tangent[e, 0]), abs(tangent[e, 1]), abs(tangent[e, 2])
            axis[0] = 1.0 if x <= y and x <= z else 0.0
            axis[1] = 1.0 if y < x and y <= z else 0.0
            axis[2] = 1.0 if z < x and z < y else 0.0
            _cross(axis, tangent[e], first)
            size = math.sqrt(_dot(first, first))
            for c in range(3):
                first[c] /= size
        _cross(tangent[e], first, second)
        for c in range(3):
            basis[e, c, 0] = first[c] * scale if freedom >= PLANE else 0.0
            basis[e, c, 1] = second[c] * scale if freedom >= SPHERE else 0.0
            if stretches:
                basis[e, c, 2] = tangent[e, c] * scale if freedom == FREE else 0.0
        if rules.angles and e > 0:
            basis[e, 3, d - 1] = 1.0 / root


def _curve(B: float, rules: Rules, edge: Floats, gradient: Floats, basis: Floats, extra: Floats) -> None:
    """What the curvature of spheres adds to the Hessian (n, d), and something where nothing may move."""
    d = basis.shape[2]
    turns = d - int(rules.angles)
    for e in range(edge.shape[0]):
        mass = rules.mass[e]
        curved = 0.0 if rules.freedom[e] == FREE else -_dot(edge[e], gradient[e]) / mass
        for i in range(d):
            still = True
            for c in range(4):
                still = still and basis[e, c, i] == 0.0
            extra[e, i] = B / mass**2 if still else curved if i < turns else 0.0


def project(gradient: Floats, basis: Floats, out: Floats) -> None:
    """A gradient (n, 4) by the coordinates (n d,) of edges."""
    n, _, d = basis.shape
    for e in range(n):
        for i in range(d):
            total = 0.0
            for c in range(4):
                total += gradient[e, c] * basis[e, c, i]
            out[e * d + i] = total


def _hold(weight: Floats, edge: Floats, basis: Floats, gap: Floats, border: Floats) -> None:
    """Sums of weight . edge (k,), and what they lose with the coordinates of edges (n d, k)."""
    d = basis.shape[2]
    for i in range(weight.shape[0]):
        gap[i] = 0.0
        for e in range(edge.shape[0]):
            gap[i] += _dot(weight[i, e], edge[e])
            for j in range(d):
                total = 0.0
                for c in range(3):
                    total -= weight[i, e, c] * basis[e, c, j]
                border[e * d + j, i] = total


def _dot(a: Floats, b: Floats) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def _cross(a: Floats, b: Floats, out: Floats) -> None:
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


compile_kernels(
    __name__,
    inline=("_dot", "_cross"),
    owning=("turn", "derivatives", "twist_gradient", "_span"),
)
