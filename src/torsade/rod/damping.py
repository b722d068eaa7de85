"""Internal damping and the linear system of velocities in overdamped motion.

Node velocities solve M v = F, where M is the graph Laplacian of internal damping (weight eta A / l on
every edge) plus collision drag (thesis 4.8, 4.11). It is symmetric and positive semi-definite; its null
space is removed by fixing nodes. The system is solved directly, or, where contacts couple too much, by
conjugate gradients, warm-started and preconditioned by the tridiagonal part of M along each fiber.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Bools, Floats, Index
from torsade.assembly import Assembly
from torsade.rod.contact import Contacts
from torsade.rod.factor import Factor, assemble, eliminate, substitute
from torsade.rod.skin import Skin, add_skin_drag, add_skin_entries, couple_skin


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


def power_of_drag(a: Assembly, eta_A: float, contacts: Contacts, v: Floats, chosen: Bools) -> float:
    """Power [W] that chosen nodes (n_nodes,) spend on drag at velocities v (n_nodes, 3): their v . M v."""
    edges, rest_length = a.edges, a.rest_length
    nodes, weight = contacts.drag_nodes, contacts.drag_weight
    power = 0.0
    for e in range(edges.shape[0]):
        i = np.uintp(edges[e, 0])
        j = np.uintp(edges[e, 1])
        if chosen[i] or chosen[j]:
            w = eta_A / rest_length[e]
            for c in range(3):
                own = (v[i, c] if chosen[i] else 0.0) - (v[j, c] if chosen[j] else 0.0)
                power += w * (v[i, c] - v[j, c]) * own
    for k in range(contacts.count[1]):
        i0 = np.uintp(nodes[k, 0])
        i1 = np.uintp(nodes[k, 1])
        j0 = np.uintp(nodes[k, 2])
        j1 = np.uintp(nodes[k, 3])
        if chosen[i0] or chosen[i1] or chosen[j0] or chosen[j1]:
            w = 0.25 * weight[k]
            for c in range(3):
                own = (v[i0, c] if chosen[i0] else 0.0) + (v[i1, c] if chosen[i1] else 0.0)
                own -= (v[j0, c] if chosen[j0] else 0.0) + (v[j1, c] if chosen[j1] else 0.0)
                power += w * (v[i0, c] + v[i1, c] - v[j0, c] - v[j1, c]) * own
    return power


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
    factor: Factor | tuple[()],
    skin: Skin | tuple[()],
    force: Floats,
    fixed: Bools,
    tolerance: float,
    v: Floats,
    work: MobilityWork,
) -> bool:
    """Solve M v = F for the nodes that are not fixed; v holds a guess, and what fixed nodes do.

    Solved directly in a pattern that serves, or, with () in its place, by conjugate gradients (the length of
    a tuple is known to the compiler, which leaves the other way out).
    force, v (n_nodes, 3), fixed (n_nodes,) bool. False when there is no solution.
    """
    if len(factor) == 0:
        return _conjugate_gradients(a, eta_A, contacts, skin, force, fixed, tolerance, v, work)
    assemble(a, eta_A, contacts, fixed, factor)
    add_skin_entries(a, skin, factor.diagonal, factor.value, factor.edge_slot)
    diagonal, prescribed = factor.diagonal, work.r
    for i in range(v.shape[0]):
        for c in range(3):
            prescribed[i, c] = v[i, c]
            v[i, c] = force[i, c]
    for i in range(v.shape[0]):
        if fixed[i]:
            for c in range(3):
                v[i, c] = diagonal[i] * prescribed[i, c]
    if not eliminate(factor, v):
        return False
    substitute(factor, v)
    couple_skin(a, skin, factor, force, fixed, v)
    for i in range(v.shape[0]):
        if fixed[i]:
            for c in range(3):
                v[i, c] = prescribed[i, c]
    return True


def _conjugate_gradients(
    a: Assembly,
    eta_A: float,
    contacts: Contacts,
    skin: Skin | tuple[()],
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
    add_skin_entries(a, skin, work.diagonal, work.coupling, ())
    _factorise(a, fixed, work)
    apply_drag(a, eta_A, contacts, v, q)
    add_skin_drag(a, skin, v, q)
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
        add_skin_drag(a, skin, p, q)
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


compile_kernels(__name__, plain=("mobility_work",))
