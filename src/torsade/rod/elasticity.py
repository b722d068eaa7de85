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


def hinge_twist(theta, reference_twist, hinges, m):
    """Twist angle m (n_hinges,) [rad] of every hinge from material angles and reference twist."""
    for k in range(hinges.shape[0]):
        m[k] = theta[hinges[k, 1]] - theta[hinges[k, 0]] + reference_twist[k]


def stretch_energy(a, EA, length):
    """E_s [J] of edges of the given lengths (n_edges,) [m]."""
    total = 0.0
    for e in range(length.shape[0]):
        strain = length[e] / a.rest_length[e] - 1.0
        total += 0.5 * EA * strain * strain * a.rest_length[e]
    return total


def _bend_length(a, k, present, length):
    """The length [m] over which hinge k bends."""
    if present:
        return 0.5 * (length[a.hinges[k, 0]] + length[a.hinges[k, 1]])
    return a.hinge_length[k]


def bend_energy(a, B, present, length, tangent):
    """E_b [J]; |kb|^2 = 4 (1 - c)/(1 + c) with c = t_a . t_b, without cancellation."""
    total = 0.0
    for k in range(a.hinges.shape[0]):
        p = tangent[a.hinges[k, 0]]
        q = tangent[a.hinges[k, 1]]
        dx = q[0] - p[0]
        dy = q[1] - p[1]
        dz = q[2] - p[2]
        half = 0.5 * (dx * dx + dy * dy + dz * dz)
        total += 0.5 * B * 4.0 * half / (2.0 - half) / _bend_length(a, k, present, length)
    return total


def twist_energy(a, C, m):
    """E_t [J] of hinge twists m (n_hinges,) [rad]."""
    total = 0.0
    for k in range(m.shape[0]):
        total += 0.5 * C * m[k] * m[k] / a.hinge_length[k]
    return total


def add_elastic_forces(a, EA, B, C, present, length, tangent, m, force, torque):
    """Add -dE/dx to force (n_nodes, 3) [N] and -dE/dtheta to torque (n_edges,) [N m].

    Positions vary at fixed material angle about time-parallel directors, so a hinge's twist changes
    with its edges by kb/2 . (de_a/|e_a| + de_b/|e_b|).
    """
    for e in range(length.shape[0]):
        pull = EA * (length[e] / a.rest_length[e] - 1.0)
        _add_edge_force(a.edges[e, 0], a.edges[e, 1], pull, tangent[e], force)
    for k in range(a.hinges.shape[0]):
        p = a.hinges[k, 0]
        q = a.hinges[k, 1]
        ta = tangent[p]
        tb = tangent[q]
        c = ta[0] * tb[0] + ta[1] * tb[1] + ta[2] * tb[2]
        s = 1.0 / (1.0 + c)
        moment = C * m[k] / a.hinge_length[k]
        torque[p] += moment
        torque[q] -= moment
        lbar = _bend_length(a, k, present, length)
        bend = -4.0 * B * s * s / lbar
        ease = B * (1.0 - c) * s / (lbar * lbar) if present else 0.0
        nx = (ta[1] * tb[2] - ta[2] * tb[1]) * s * moment
        ny = (ta[2] * tb[0] - ta[0] * tb[2]) * s * moment
        nz = (ta[0] * tb[1] - ta[1] * tb[0]) * s * moment
        ra = 1.0 / length[p]
        rb = 1.0 / length[q]
        i = a.edges[p, 0]
        j = a.edges[p, 1]
        n = a.edges[q, 1]
        gax = (bend * (tb[0] - c * ta[0]) + nx) * ra - ease * ta[0]
        gay = (bend * (tb[1] - c * ta[1]) + ny) * ra - ease * ta[1]
        gaz = (bend * (tb[2] - c * ta[2]) + nz) * ra - ease * ta[2]
        gbx = (bend * (ta[0] - c * tb[0]) + nx) * rb - ease * tb[0]
        gby = (bend * (ta[1] - c * tb[1]) + ny) * rb - ease * tb[1]
        gbz = (bend * (ta[2] - c * tb[2]) + nz) * rb - ease * tb[2]
        force[i, 0] += gax
        force[i, 1] += gay
        force[i, 2] += gaz
        force[j, 0] += gbx - gax
        force[j, 1] += gby - gay
        force[j, 2] += gbz - gaz
        force[n, 0] -= gbx
        force[n, 1] -= gby
        force[n, 2] -= gbz


def _add_edge_force(i, j, pull, t, force):
    """A tension pull [N] along the unit tangent t draws node i towards node j and j towards i."""
    force[i, 0] += pull * t[0]
    force[i, 1] += pull * t[1]
    force[i, 2] += pull * t[2]
    force[j, 0] -= pull * t[0]
    force[j, 1] -= pull * t[1]
    force[j, 2] -= pull * t[2]


def hinge_curvature(a, tangent, kappa):
    """Curvature kappa = 2 tan(phi/2)/lbar (n_hinges,) [1/m] with respect to rest arclength."""
    for k in range(a.hinges.shape[0]):
        p = tangent[a.hinges[k, 0]]
        q = tangent[a.hinges[k, 1]]
        dx = q[0] - p[0]
        dy = q[1] - p[1]
        dz = q[2] - p[2]
        half = 0.5 * (dx * dx + dy * dy + dz * dz)
        kappa[k] = 2.0 * math.sqrt(half / (2.0 - half)) / a.hinge_length[k]


compile_kernels(__name__)
