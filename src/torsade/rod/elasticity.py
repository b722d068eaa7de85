"""Stretch, bend and twist energies of a discrete rod and their exact forces and torques.

Sums over edges e and hinges k of naturally straight, circular fibers (thesis 2.30, 4.1-4.3; Bergou et
al. 2008, 2010):

    E_s = 1/2 EA  sum_e (|e|/l - 1)^2 l          stretch
    E_b = 1/2 B   sum_k |kb|^2 / lbar            bend,  kb = 2 t_a x t_b / (1 + t_a . t_b)
    E_t = 1/2 C   sum_k m^2 / lbar               twist, m = theta_b - theta_a + reference twist

with EA the stretching, B = E_b I the bending and C = mu J the twisting stiffness. With `bend_present` the
length lbar of the bending energy is the present one, so that curvature is that of the stretched curve.
"""

from __future__ import annotations

import math

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import ONE, Floats, Index, Ints
from torsade.assembly import Assembly


def hinge_twist(theta: Floats, reference_twist: Floats, hinges: Ints, m: Floats) -> None:
    """Twist angle m (n_hinges,) [rad] of every hinge from material angles and reference twist."""
    for k in range(hinges.shape[0]):
        m[k] = theta[np.uintp(hinges[k, 1])] - theta[np.uintp(hinges[k, 0])] + reference_twist[k]


def stretch_energy(a: Assembly, EA: float, length: Floats) -> float:
    """E_s [J] of edges of the given lengths (n_edges,) [m]."""
    total = 0.0
    for e in range(length.shape[0]):
        strain = length[e] / a.rest_length[e] - 1.0
        total += 0.5 * EA * strain * strain * a.rest_length[e]
    return total


def bend_length(rest: float, present: bool, before: float, after: float) -> float:
    """The length [m] over which a hinge bends: at rest, or the mean of its edges as long as they are."""
    return 0.5 * (before + after) if present else rest


def bend_energy(a: Assembly, B: float, present: bool, length: Floats, tangent: Floats) -> float:
    """E_b [J]; |kb|^2 = 4 (1 - c)/(1 + c) with c = t_a . t_b, without cancellation."""
    hinges, hinge_length = a.hinges, a.hinge_length
    total = 0.0
    for k in range(hinges.shape[0]):
        p = hinges[k, 0]
        q = hinges[k, 1]
        dx = tangent[q, 0] - tangent[p, 0]
        dy = tangent[q, 1] - tangent[p, 1]
        dz = tangent[q, 2] - tangent[p, 2]
        half = 0.5 * (dx * dx + dy * dy + dz * dz)
        lbar = bend_length(hinge_length[k], present, length[p], length[q])
        total += 0.5 * B * 4.0 * half / (2.0 - half) / lbar
    return total


def twist_energy(a: Assembly, C: float, m: Floats) -> float:
    """E_t [J] of hinge twists m (n_hinges,) [rad]."""
    total = 0.0
    for k in range(m.shape[0]):
        total += 0.5 * C * m[k] * m[k] / a.hinge_length[k]
    return total


def _joint(
    B: float, C: float, present: bool, length: Floats, t: Floats, m: Floats, rest: Floats,
    p: Index, q: Index, k: Index,
) -> tuple[float, float, float]:  # fmt: skip
    """How hinge k bends, turns and eases the edges p and q that it joins.

    With c = t_p . t_q, bend = -4 B/(1 + c)^2 lbar and turn = C m/(1 + c) lbar; ease, where lbar is the
    present length, is what bending gains from longer edges.
    """
    cosine = t[p, 0] * t[q, 0] + t[p, 1] * t[q, 1] + t[p, 2] * t[q, 2]
    s = 1.0 / (1.0 + cosine)
    r = 1.0 / bend_length(rest[k], present, length[p], length[q])
    bend = -4.0 * B * s * s * r
    turn = s * C * m[k] / rest[k]
    ease = B * (1.0 - cosine) * s * r * r if present else 0.0
    return bend, turn, ease


def _set_edge_force(
    stretch: float, length: Floats, t: Floats, e: Index, p: Index, bend_p: float, turn_p: float,
    q: Index, bend_q: float, turn_q: float, g: Floats,
) -> None:  # fmt: skip
    """g[e] = dE/de of an edge between the edges p and q, with what the hinges to either side do.

    With w = bend_p t_p + bend_q t_q and u = turn_q t_q - turn_p t_p it is
    stretch t + (w - (w . t) t + t x u)/|e|.
    """
    tx, ty, tz = t[e, 0], t[e, 1], t[e, 2]
    px, py, pz = t[p, 0], t[p, 1], t[p, 2]
    qx, qy, qz = t[q, 0], t[q, 1], t[q, 2]
    wx = bend_p * px + bend_q * qx
    wy = bend_p * py + bend_q * qy
    wz = bend_p * pz + bend_q * qz
    ux = turn_q * qx - turn_p * px
    uy = turn_q * qy - turn_p * py
    uz = turn_q * qz - turn_p * pz
    s = 1.0 / length[e]
    along = stretch - s * (wx * tx + wy * ty + wz * tz)
    g[e, 0] = along * tx + s * (wx + ty * uz - tz * uy)
    g[e, 1] = along * ty + s * (wy + tz * ux - tx * uz)
    g[e, 2] = along * tz + s * (wz + tx * uy - ty * ux)


def _edge_forces(
    a: Assembly, f: Index, EA: float, B: float, C: float, present: bool, length: Floats, t: Floats,
    m: Floats, g: Floats,
) -> None:  # fmt: skip
    """dE/de of the edges of fiber f, into g; a ring has as many hinges as edges."""
    rest_length, lbar = a.rest_length, a.hinge_length
    first, n = a.edge_start[f], a.edge_start[f + 1] - a.edge_start[f]
    h, joints = a.hinge_start[f], a.hinge_start[f + 1] - a.hinge_start[f]
    ring = joints == n
    before = h if ring else h - 1
    for k in range(1, n - 1):
        e, b = np.uintp(first + k), np.uintp(before + k)
        bend_p, turn_p, ease_p = _joint(B, C, present, length, t, m, lbar, e - ONE, e, b)
        bend_q, turn_q, ease_q = _joint(B, C, present, length, t, m, lbar, e, e + ONE, b + ONE)
        stretch = EA * (length[e] / rest_length[e] - 1.0) - ease_p - ease_q
        _set_edge_force(stretch, length, t, e, e - ONE, bend_p, turn_p, e + ONE, bend_q, turn_q, g)
    for k in range(0, n, max(1, n - 1)):
        e = np.uintp(first + k)
        p, q = np.uintp(first + (k - 1 + n) % n), np.uintp(first + (k + 1) % n)
        bend_p, turn_p, ease_p, bend_q, turn_q, ease_q = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        if ring or k > 0:
            b = np.uintp(before + k)
            bend_p, turn_p, ease_p = _joint(B, C, present, length, t, m, lbar, p, e, b)
        if ring or k < n - 1:
            b = np.uintp(h + (before - h + k + 1) % joints)
            bend_q, turn_q, ease_q = _joint(B, C, present, length, t, m, lbar, e, q, b)
        stretch = EA * (length[e] / rest_length[e] - 1.0) - ease_p - ease_q
        _set_edge_force(stretch, length, t, e, p, bend_p, turn_p, q, bend_q, turn_q, g)


def add_elastic_forces(
    a: Assembly,
    EA: float,
    B: float,
    C: float,
    present: bool,
    length: Floats,
    tangent: Floats,
    m: Floats,
    edge_force: Floats,
    force: Floats,
    torque: Floats,
) -> None:
    """Add -dE/dx to force (n_nodes, 3) [N] and -dE/dtheta to torque (n_edges,) [N m].

    Positions vary at fixed material angle about time-parallel directors, so a hinge's twist changes
    with its edges by kb/2 . (de_a/|e_a| + de_b/|e_b|). edge_force (n_edges, 3) [N] gets dE/de, with which an
    edge pulls its first node forward and its second one back.
    """
    hinges, hinge_length, node_start, edge_start = a.hinges, a.hinge_length, a.node_start, a.edge_start
    for f in range(edge_start.shape[0] - 1):
        _edge_forces(a, f, EA, B, C, present, length, tangent, m, edge_force)
        node, edge, n = node_start[f], edge_start[f], edge_start[f + 1] - edge_start[f]
        if n == 0:
            continue
        for k in range(1, n):
            i, e = np.uintp(node + k), np.uintp(edge + k)
            for c in range(3):
                force[i, c] += edge_force[e, c] - edge_force[e - ONE, c]
        end = node + n if node + n < node_start[f + 1] else node
        for c in range(3):
            force[node, c] += edge_force[edge, c]
            force[end, c] -= edge_force[edge + n - 1, c]
    for k in range(hinges.shape[0]):
        moment = C * m[k] / hinge_length[k]
        torque[np.uintp(hinges[k, 0])] += moment
        torque[np.uintp(hinges[k, 1])] -= moment


def hinge_curvature(a: Assembly, tangent: Floats, kappa: Floats) -> None:
    """Curvature kappa = 2 tan(phi/2)/lbar (n_hinges,) [1/m] with respect to rest arclength."""
    for k in range(a.hinges.shape[0]):
        p = tangent[a.hinges[k, 0]]
        q = tangent[a.hinges[k, 1]]
        dx = q[0] - p[0]
        dy = q[1] - p[1]
        dz = q[2] - p[2]
        half = 0.5 * (dx * dx + dy * dy + dz * dz)
        kappa[k] = 2.0 * math.sqrt(half / (2.0 - half)) / a.hinge_length[k]


compile_kernels(__name__, inline=("bend_length", "_joint", "_set_edge_force"))
