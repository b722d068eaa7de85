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

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Ints
from torsade.assembly import Assembly


def hinge_twist(theta: Floats, reference_twist: Floats, hinges: Ints, m: Floats) -> None:
    """Twist angle m (n_hinges,) [rad] of every hinge from material angles and reference twist."""
    for k in range(hinges.shape[0]):
        m[k] = theta[hinges[k, 1]] - theta[hinges[k, 0]] + reference_twist[k]


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


def add_elastic_forces(
    a: Assembly,
    EA: float,
    B: float,
    C: float,
    present: bool,
    length: Floats,
    tangent: Floats,
    m: Floats,
    force: Floats,
    torque: Floats,
) -> None:
    """Add -dE/dx to force (n_nodes, 3) [N] and -dE/dtheta to torque (n_edges,) [N m].

    Positions vary at fixed material angle about time-parallel directors, so a hinge's twist changes
    with its edges by kb/2 . (de_a/|e_a| + de_b/|e_b|).
    """
    edges, hinges, rest_length, hinge_length = a.edges, a.hinges, a.rest_length, a.hinge_length
    for e in range(length.shape[0]):
        pull = EA * (length[e] / rest_length[e] - 1.0)
        i = edges[e, 0]
        j = edges[e, 1]
        for c in range(3):
            force[i, c] += pull * tangent[e, c]
            force[j, c] -= pull * tangent[e, c]
    for k in range(hinges.shape[0]):
        p = hinges[k, 0]
        q = hinges[k, 1]
        ax, ay, az = tangent[p, 0], tangent[p, 1], tangent[p, 2]
        bx, by, bz = tangent[q, 0], tangent[q, 1], tangent[q, 2]
        cosine = ax * bx + ay * by + az * bz
        s = 1.0 / (1.0 + cosine)
        moment = C * m[k] / hinge_length[k]
        torque[p] += moment
        torque[q] -= moment
        lbar = bend_length(hinge_length[k], present, length[p], length[q])
        bend = -4.0 * B * s * s / lbar
        ease = B * (1.0 - cosine) * s / (lbar * lbar) if present else 0.0
        turn = s * moment
        nx = (ay * bz - az * by) * turn
        ny = (az * bx - ax * bz) * turn
        nz = (ax * by - ay * bx) * turn
        ra = 1.0 / length[p]
        rb = 1.0 / length[q]
        fax = (bend * (bx - cosine * ax) + nx) * ra - ease * ax
        fay = (bend * (by - cosine * ay) + ny) * ra - ease * ay
        faz = (bend * (bz - cosine * az) + nz) * ra - ease * az
        fbx = (bend * (ax - cosine * bx) + nx) * rb - ease * bx
        fby = (bend * (ay - cosine * by) + ny) * rb - ease * by
        fbz = (bend * (az - cosine * bz) + nz) * rb - ease * bz
        i = edges[p, 0]
        j = edges[p, 1]
        n = edges[q, 1]
        force[i, 0] += fax
        force[i, 1] += fay
        force[i, 2] += faz
        force[j, 0] += fbx - fax
        force[j, 1] += fby - fay
        force[j, 2] += fbz - faz
        force[n, 0] -= fbx
        force[n, 1] -= fby
        force[n, 2] -= fbz


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


compile_kernels(__name__, inline=("bend_length",))
