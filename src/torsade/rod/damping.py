"""Internal damping and the two linear systems of overdamped motion.

Node velocities solve M v = F, where M is the graph Laplacian of internal damping (weight eta A / l on
every edge) plus collision drag (thesis 4.8, 4.11). It is symmetric and positive semi-definite; its null
space is removed by fixing nodes. The system is solved directly within its envelope, or, where contacts
reach too far, by conjugate gradients, warm-started and preconditioned by the tridiagonal part of M along
each fiber. Spins solve a tridiagonal system.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Bools, Floats, Index
from torsade.assembly import Assembly
from torsade.rod.contact import Contacts
from torsade.rod.skyline import Skyline, assemble_skyline, back_substitute, factorise


class MobilityWork(NamedTuple):
    """Scratch arrays of the mobility solve: diagonals and factors (n,), vectors (n_nodes, 3)."""

    diagonal: Floats
    coupling: Floats
    inverse: Floats
    lower: Floats
    r: Floats
    z: Floats
    p: Floats
    q: Floats


def mobility_work(n_nodes: Index, n_edges: Index) -> MobilityWork:
    """Scratch arrays for n_nodes nodes and n_edges edges."""
    return MobilityWork(
        np.empty(n_nodes),
        np.empty(n_edges),
        np.empty(n_nodes),
        np.empty(n_nodes),
        np.empty((n_nodes, 3)),
        np.empty((n_nodes, 3)),
        np.empty((n_nodes, 3)),
        np.empty((n_nodes, 3)),
    )


def apply_drag(a: Assembly, eta_A: float, contacts: Contacts, v: Floats, out: Floats) -> None:
    """out = M v [N], without regard to fixed nodes; v, out (n_nodes, 3)."""
    edges, rest_length = a.edges, a.rest_length
    nodes, weight = contacts.drag_nodes, contacts.drag_weight
    for i in range(out.shape[0]):
        for c in range(3):
            out[i, c] = 0.0
    for e in range(edges.shape[0]):
        i = edges[e, 0]
        j = edges[e, 1]
        w = eta_A / rest_length[e]
        for c in range(3):
            f = w * (v[i, c] - v[j, c])
            out[i, c] += f
            out[j, c] -= f
    for k in range(contacts.count[1]):
        i0 = nodes[k, 0]
        i1 = nodes[k, 1]
        j0 = nodes[k, 2]
        j1 = nodes[k, 3]
        w = 0.25 * weight[k]
        for c in range(3):
            f = w * (v[i0, c] + v[i1, c] - v[j0, c] - v[j1, c])
            out[i0, c] += f
            out[i1, c] += f
            out[j0, c] -= f
            out[j1, c] -= f


def _tridiagonal_part(a: Assembly, eta_A: float, contacts: Contacts, work: MobilityWork) -> None:
    """Diagonal of M and its coupling along each edge."""
    edges, rest_length = a.edges, a.rest_length
    nodes, weight, touching = contacts.drag_nodes, contacts.drag_weight, contacts.edges
    diagonal, coupling = work.diagonal, work.coupling
    for i in range(diagonal.shape[0]):
        diagonal[i] = 0.0
    for e in range(edges.shape[0]):
        w = eta_A / rest_length[e]
        diagonal[edges[e, 0]] += w
        diagonal[edges[e, 1]] += w
        coupling[e] = -w
    for k in range(contacts.count[1]):
        w = 0.25 * weight[k]
        i0 = nodes[k, 0]
        i1 = nodes[k, 1]
        j0 = nodes[k, 2]
        j1 = nodes[k, 3]
        diagonal[i0] += w
        diagonal[i1] += w
        diagonal[j0] += w
        diagonal[j1] += w
        if i0 == i1:
            diagonal[i0] += 2.0 * w
            diagonal[j0] += 2.0 * w
        else:
            coupling[touching[k, 0]] += w
            coupling[touching[k, 1]] += w


def _factorise(a: Assembly, fixed: Bools, work: MobilityWork) -> None:
    """L D L^T of the tridiagonal part, fiber by fiber; rows of fixed nodes are the identity."""
    node_start, edge_start = a.node_start, a.edge_start
    diagonal, coupling, inverse, lower = work.diagonal, work.coupling, work.inverse, work.lower
    for f in range(node_start.shape[0] - 1):
        first = node_start[f]
        to_edge = edge_start[f] - first
        inverse[first] = 1.0 if fixed[first] else 1.0 / diagonal[first]
        lower[first] = 0.0
        for i in range(first + 1, node_start[f + 1]):
            if fixed[i]:
                lower[i] = 0.0
                inverse[i] = 1.0
            else:
                c = 0.0 if fixed[i - 1] else coupling[i - 1 + to_edge]
                m = c * inverse[i - 1]
                lower[i] = m
                inverse[i] = 1.0 / (diagonal[i] - m * c)


def _precondition(a: Assembly, work: MobilityWork) -> None:
    """z = P^-1 r with the factors of the tridiagonal part."""
    node_start = a.node_start
    inverse, lower, r, z = work.inverse, work.lower, work.r, work.z
    for f in range(node_start.shape[0] - 1):
        first = node_start[f]
        last = node_start[f + 1] - 1
        for c in range(3):
            z[first, c] = r[first, c]
        for i in range(first + 1, last + 1):
            m = lower[i]
            for c in range(3):
                z[i, c] = r[i, c] - m * z[i - 1, c]
        for c in range(3):
            z[last, c] *= inverse[last]
        for i in range(last - 1, first - 1, -1):
            m = lower[i + 1]
            s = inverse[i]
            for c in range(3):
                z[i, c] = z[i, c] * s - m * z[i + 1, c]


def _dot(a: Floats, b: Floats) -> float:
    total = 0.0
    for i in range(a.shape[0]):
        total += a[i, 0] * b[i, 0] + a[i, 1] * b[i, 1] + a[i, 2] * b[i, 2]
    return total


def solve_mobility(
    a: Assembly,
    eta_A: float,
    contacts: Contacts,
    sky: Skyline,
    force: Floats,
    fixed: Bools,
    tolerance: float,
    v: Floats,
    work: MobilityWork,
) -> bool:
    """Solve M v = F for the nodes that are not fixed; v holds a guess, and what fixed nodes do.

    Solved directly within the envelope of the reordered matrix where that pays (see `skyline_for`),
    else iteratively. force, v (n_nodes, 3), fixed (n_nodes,) bool. False when there is no solution.
    """
    if sky.values.shape[0] == 0:
        return _conjugate_gradients(a, eta_A, contacts, force, fixed, tolerance, v, work)
    r = work.r
    moving = False
    for i in range(v.shape[0]):
        for c in range(3):
            if fixed[i]:
                r[i, c] = v[i, c]
                moving = moving or v[i, c] != 0.0
            else:
                r[i, c] = force[i, c]
                v[i, c] = 0.0
    if moving:
        q = work.q
        apply_drag(a, eta_A, contacts, v, q)
        for i in range(v.shape[0]):
            if not fixed[i]:
                for c in range(3):
                    r[i, c] -= q[i, c]
    assemble_skyline(a, eta_A, contacts, fixed, sky)
    if not factorise(sky):
        return False
    back_substitute(sky, r, v)
    return True


def _conjugate_gradients(
    a: Assembly,
    eta_A: float,
    contacts: Contacts,
    force: Floats,
    fixed: Bools,
    tolerance: float,
    v: Floats,
    work: MobilityWork,
) -> bool:
    """Solve M v = F from the guess v; False when 20 n + 100 iterations do not suffice.

    Stops when the error, in the norm of the dissipated power v . M v, is below tolerance relative to
    the solution.
    """
    n = force.shape[0]
    r, z, p, q = work.r, work.z, work.p, work.q
    _tridiagonal_part(a, eta_A, contacts, work)
    _factorise(a, fixed, work)
    apply_drag(a, eta_A, contacts, v, q)
    guess_power = abs(_dot(v, q))
    for i in range(n):
        for c in range(3):
            r[i, c] = 0.0 if fixed[i] else force[i, c] - q[i, c]
    _precondition(a, work)
    for i in range(n):
        for c in range(3):
            p[i, c] = z[i, c]
    rz = _dot(r, z)
    for _ in range(20 * n + 100):
        if rz <= tolerance * tolerance * max(abs(_dot(v, force)), guess_power) or rz < 1e-300:
            return True
        apply_drag(a, eta_A, contacts, p, q)
        for i in range(n):
            if fixed[i]:
                for c in range(3):
                    q[i, c] = 0.0
        alpha = rz / _dot(p, q)
        for i in range(n):
            for c in range(3):
                v[i, c] += alpha * p[i, c]
                r[i, c] -= alpha * q[i, c]
        _precondition(a, work)
        previous = rz
        rz = _dot(r, z)
        beta = rz / previous
        for i in range(n):
            for c in range(3):
                p[i, c] = z[i, c] + beta * p[i, c]
    return False


class SpinWork(NamedTuple):
    """Scratch arrays of the spin solve, each (n_edges,)."""

    diagonal: Floats
    upper: Floats
    factor: Floats
    border: Floats


def spin_work(n_edges: Index) -> SpinWork:
    """Scratch arrays for n_edges edges."""
    return SpinWork(np.empty(n_edges), np.empty(n_edges), np.empty(n_edges), np.empty(n_edges))


def _thomas(first: Index, last: Index, upper: Floats, factor: Floats, rhs: Floats) -> None:
    """Solve the symmetric tridiagonal system of edges first..last-1 in place, already factorised."""
    for e in range(first + 1, last):
        rhs[e] -= upper[e - 1] * factor[e - 1] * rhs[e - 1]
    rhs[last - 1] *= factor[last - 1]
    for e in range(last - 2, first - 1, -1):
        rhs[e] = (rhs[e] - upper[e] * rhs[e + 1]) * factor[e]


def solve_spin(
    a: Assembly,
    eta_J: float,
    tangent: Floats,
    torque: Floats,
    spin_weight: Floats,
    fixed: Bools,
    prescribed: Floats,
    omega: Floats,
    work: SpinWork,
) -> None:
    """Spins omega (n_edges,) [rad/s] that balance torque (n_edges,) [N m] by internal damping.

    On edge e: sum over its neighbours f of eta J (omega_e - omega_f t_e . t_f)/lbar, plus spin_weight_e
    omega_e, equals the torque (thesis 4.11). Edges with fixed (n_edges,) turn as prescribed. A fiber
    that nothing holds may spin as a whole; a term of 1e-12 of the damping picks the spin at rest.
    """
    hinges, hinge_length = a.hinges, a.hinge_length
    edge_start, hinge_start = a.edge_start, a.hinge_start
    diagonal, upper = work.diagonal, work.upper
    for e in range(omega.shape[0]):
        diagonal[e] = spin_weight[e]
        upper[e] = 0.0
        omega[e] = torque[e]
    for f in range(edge_start.shape[0] - 1):
        first = edge_start[f]
        last = edge_start[f + 1]
        seam = 0.0
        for k in range(hinge_start[f], hinge_start[f + 1]):
            p = hinges[k, 0]
            q = hinges[k, 1]
            w = eta_J / hinge_length[k]
            cosine = (
                tangent[p, 0] * tangent[q, 0] + tangent[p, 1] * tangent[q, 1] + tangent[p, 2] * tangent[q, 2]
            )
            diagonal[p] += w * (1.0 + 1e-12)
            diagonal[q] += w * (1.0 + 1e-12)
            if q == p + 1:
                upper[p] -= w * cosine
            else:
                seam -= w * cosine
        if seam != 0.0 and (fixed[first] or fixed[last - 1]):
            omega[last - 1] -= seam * prescribed[first] if fixed[first] else 0.0
            omega[first] -= seam * prescribed[last - 1] if fixed[last - 1] else 0.0
            seam = 0.0
        for e in range(first, last):
            if fixed[e]:
                diagonal[e] = 1.0
                omega[e] = prescribed[e]
                if e > first:
                    omega[e - 1] -= upper[e - 1] * prescribed[e]
                    upper[e - 1] = 0.0
                if e < last - 1:
                    omega[e + 1] -= upper[e] * prescribed[e]
                    upper[e] = 0.0
        _solve_chain(first, last, seam, diagonal, upper, work.factor, work.border, omega)


def _solve_chain(
    first: Index,
    last: Index,
    seam: float,
    diagonal: Floats,
    upper: Floats,
    factor: Floats,
    border: Floats,
    omega: Floats,
) -> None:
    """Solve one fiber's system in place; seam couples its last edge to its first (0 if open)."""
    if last - first == 1:
        omega[first] = omega[first] / diagonal[first] if diagonal[first] > 0.0 else 0.0
        return
    gamma = -diagonal[first] if seam != 0.0 else 0.0
    if seam != 0.0:
        diagonal[first] -= gamma
        diagonal[last - 1] -= seam * seam / gamma
    factor[first] = 1.0 / diagonal[first]
    for e in range(first + 1, last):
        factor[e] = 1.0 / (diagonal[e] - upper[e - 1] * upper[e - 1] * factor[e - 1])
    _thomas(first, last, upper, factor, omega)
    if seam != 0.0:
        for e in range(first, last):
            border[e] = 0.0
        border[first] = gamma
        border[last - 1] = seam
        _thomas(first, last, upper, factor, border)
        ratio = seam / gamma
        s = omega[first] + ratio * omega[last - 1]
        s /= 1.0 + border[first] + ratio * border[last - 1]
        for e in range(first, last):
            omega[e] -= s * border[e]


compile_kernels(__name__)
