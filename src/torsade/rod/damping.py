"""Internal damping and the two linear systems of overdamped motion.

Node velocities solve M v = F, where M is the graph Laplacian of internal damping (weight eta A / l on
every edge) plus collision drag (thesis 4.8, 4.11). It is symmetric and positive semi-definite; its null
space is removed by fixing nodes. The system is solved directly, or, where contacts couple too much, by
conjugate gradients, warm-started and preconditioned by the tridiagonal part of M along each fiber. Spins
solve a tridiagonal system.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import ONE, Bools, Floats, Index
from torsade.assembly import Assembly
from torsade.rod.contact import Contacts
from torsade.rod.factor import HELD, Factor, assemble, eliminate, substitute
from torsade.rod.skin import Skin, add_skin_diagonal, add_skin_drag, add_skin_entries, couple_skin


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
    add_skin_entries(a, skin, factor)
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
    add_skin_diagonal(a, skin, work.diagonal, work.coupling)
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


class SpinWork(NamedTuple):
    """Scratch arrays of the spin solve, each (n_edges,)."""

    diagonal: Floats
    upper: Floats
    factor: Floats
    border: Floats


def spin_work(n_edges: Index) -> SpinWork:
    """Scratch arrays for n_edges edges."""
    return SpinWork(np.empty(n_edges), np.empty(n_edges), np.empty(n_edges), np.empty(n_edges))


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
    edge_start, hinge_start = a.edge_start, a.hinge_start
    diagonal, upper = work.diagonal, work.upper
    _spin_matrix(a, eta_J, tangent, spin_weight, diagonal, upper)
    for e in range(omega.shape[0]):
        if fixed[e]:
            diagonal[e] = HELD * (diagonal[e] if diagonal[e] > 0.0 else 1.0)
        omega[e] = diagonal[e] * prescribed[e] if fixed[e] else torque[e]
    for f in range(edge_start.shape[0] - 1):
        first = edge_start[f]
        last = edge_start[f + 1]
        if last == first:  # what has no edges does not spin
            continue
        if last - first == hinge_start[f + 1] - hinge_start[f]:
            _solve_ring(first, last, diagonal, upper, work.factor, work.border, omega)
        else:
            _eliminate_chain(first, last, diagonal, upper, work.factor, omega)
            _substitute_chain(first, last, upper, work.factor, omega)
    for e in range(omega.shape[0]):
        if fixed[e]:
            omega[e] = prescribed[e]


def _spin_matrix(
    a: Assembly, eta_J: float, t: Floats, spin_weight: Floats, diagonal: Floats, upper: Floats
) -> None:
    """Diagonal of the matrix of spins, and upper, which couples an edge to the one after it."""
    edge_start, hinge_start, lbar = a.edge_start, a.hinge_start, a.hinge_length
    for f in range(edge_start.shape[0] - 1):
        first, n = edge_start[f], edge_start[f + 1] - edge_start[f]
        if n == 0:
            continue
        joints = hinge_start[f + 1] - hinge_start[f]
        after = hinge_start[f] + joints - n + 1
        for k in range(n - 1):
            e = np.uintp(first + k)
            q = e + ONE
            c = t[e, 0] * t[q, 0] + t[e, 1] * t[q, 1] + t[e, 2] * t[q, 2]
            upper[e] = -eta_J / lbar[np.uintp(after + k)] * c
        for k in range(1, n - 1):
            e, h = np.uintp(first + k), np.uintp(after + k)
            diagonal[e] = spin_weight[e] + (eta_J / lbar[h - ONE] + eta_J / lbar[h]) * (1.0 + 1e-12)
        last = first + n - 1
        diagonal[first], diagonal[last], upper[last] = spin_weight[first], spin_weight[last], 0.0
        if n > 1:
            diagonal[first] += eta_J / lbar[after] * (1.0 + 1e-12)
            diagonal[last] += eta_J / lbar[after + n - 2] * (1.0 + 1e-12)
        if joints == n:
            w = eta_J / lbar[hinge_start[f]]
            diagonal[first] += w * (1.0 + 1e-12)
            diagonal[last] += w * (1.0 + 1e-12)
            c = t[first, 0] * t[last, 0] + t[first, 1] * t[last, 1] + t[first, 2] * t[last, 2]
            upper[last] = -w * c


def _eliminate_chain(
    first: Index, last: Index, diagonal: Floats, upper: Floats, factor: Floats, rhs: Floats
) -> None:
    """Eliminate edges first..last-1 of a symmetric tridiagonal system from both ends towards the middle.

    Two recurrences that do not wait for each other take half the time of one.
    """
    middle = (first + last) // 2
    left = 0.0
    right = 0.0
    for s in range(middle - first):
        e = first + s
        factor[e] = 1.0 / (diagonal[e] - left)
        share = upper[e] * factor[e]
        left = upper[e] * share
        rhs[e + 1] -= share * rhs[e]
        g = last - 1 - s
        if g > middle:
            factor[g] = 1.0 / (diagonal[g] - right)
            share = upper[g - 1] * factor[g]
            right = upper[g - 1] * share
            rhs[g - 1] -= share * rhs[g]
    pivot = diagonal[middle] - left - right
    factor[middle] = 1.0 / pivot if pivot > 0.0 else 0.0


def _carry_chain(first: Index, last: Index, upper: Floats, factor: Floats, rhs: Floats) -> None:
    """Eliminate another right side, with factors of `_eliminate_chain`."""
    middle = (first + last) // 2
    for s in range(middle - first):
        e = first + s
        rhs[e + 1] -= upper[e] * factor[e] * rhs[e]
        g = last - 1 - s
        if g > middle:
            rhs[g - 1] -= upper[g - 1] * factor[g] * rhs[g]


def _substitute_chain(first: Index, last: Index, upper: Floats, factor: Floats, rhs: Floats) -> None:
    """Replace what is left of a right side by the solution, from the middle to both ends."""
    middle = (first + last) // 2
    rhs[middle] *= factor[middle]
    for s in range(middle - first - 1, -1, -1):
        e = first + s
        rhs[e] = (rhs[e] - upper[e] * rhs[e + 1]) * factor[e]
        g = last - 1 - s
        if g > middle:
            rhs[g] = (rhs[g] - upper[g - 1] * rhs[g - 1]) * factor[g]


def _solve_ring(
    first: Index,
    last: Index,
    diagonal: Floats,
    upper: Floats,
    factor: Floats,
    border: Floats,
    omega: Floats,
) -> None:
    """Solve one closed fiber's system in place: a chain whose last edge is coupled to its first."""
    seam = upper[last - 1]
    gamma = -diagonal[first]
    diagonal[first] -= gamma
    diagonal[last - 1] -= seam * seam / gamma
    _eliminate_chain(first, last, diagonal, upper, factor, omega)
    _substitute_chain(first, last, upper, factor, omega)
    for e in range(first, last):
        border[e] = 0.0
    border[first] = gamma
    border[last - 1] = seam
    _carry_chain(first, last, upper, factor, border)
    _substitute_chain(first, last, upper, factor, border)
    ratio = seam / gamma
    s = omega[first] + ratio * omega[last - 1]
    s /= 1.0 + border[first] + ratio * border[last - 1]
    for e in range(first, last):
        omega[e] -= s * border[e]


compile_kernels(__name__, plain=("mobility_work", "spin_work"))
